//! A comparison in words and columns.

use super::next::Next;
use super::report::Report;
use super::verdict::short;
use crate::antialias::SampleReport;
use crate::{say, terminal};
use anyhow::Result;
use comfy_table::{Attribute, Cell, CellAlignment, Color};
use compare::{PairReport, Verdict};
use std::collections::BTreeSet;
use suite::text::escaped;

/// Pixels of the worst that are listed for each cause of a pair.
const LISTED: usize = 4;

/// Prints what the three renderers' comparison found.
pub(super) fn print(report: &Report, next: &Next) -> Result<()> {
    let adapter = match (&report.adapter, &report.gpu_not_run) {
        (Some(name), _) => format!("{name} ({})", report.driver.as_deref().unwrap_or("driver unknown")),
        (None, Some(why)) => format!("NOT RUN: {why}"),
        (None, None) => "left out by --no-gpu".to_owned(),
    };
    say!(
        "{}, technique {}, {}x{}, {} triangles\ngpu: {adapter}",
        escaped(report.model),
        report.technique,
        report.size[0],
        report.size[1],
        report.triangles
    )?;
    if let Some(approximation) = &report.approximation {
        say!("{}", approximation.line())?;
    }
    if let Some(masks) = &report.masks {
        say!("{}", masks.line())?;
    }
    if report.samples.len() > 1 {
        say!("{} samples a pixel, each judged by itself: pixels count once for each", report.samples.len())?;
    }
    pairs(report.pairs, next)?;
    shifts(report)?;
    if let Some(shaded) = &report.shaded {
        let verdict = if shaded.verdict == Verdict::Differ { "DIFFER" } else { "agree" };
        let at = shaded.first.map_or(String::new(), |[x, y]| format!(", first at ({x}, {y}){}", sample(shaded.sample)));
        say!("picture shaded by the GPU: {} of {} pixels differ{at}: {verdict}", shaded.differ, shaded.covered)?;
    }
    if let Some(strict) = &report.strict {
        match &strict.first {
            None => say!("strict: the GPU has the rasterizer's bits in every number of every pixel")?,
            Some(first) => say!("strict: raster | gpu: {first}: DIFFER")?,
        }
    }
    if report.undecided > 0 {
        say!("the ray caster left {} pixels undecided", report.undecided)?;
    }
    if let Some(note) = report.masks.as_ref().and_then(|masks| masks.note.as_deref()) {
        say!("note: {note}")?;
    }
    say!("{}", report.line())
}

/// Names a pixel's sample, where it has several.
fn sample(sample: Option<usize>) -> String {
    sample.map_or(String::new(), |sample| format!(" sample {sample}"))
}

/// Says how `pixel` is shown the samples that hold the worst pixels.
fn shifts(report: &Report) -> Result<()> {
    let listed = report.pairs.iter().flat_map(|pair| &pair.worst).filter_map(|pixel| pixel.sample);
    for sample in listed.collect::<BTreeSet<_>>() {
        let SampleReport { position, lens_shift: [right, up] } = report.samples[sample];
        say!("sample {sample}, at {position:?} of its pixel: `pixel … --lens-shift {right} {up}` explains one")?;
    }
    Ok(())
}

/// What the table's columns are, for those who see it for the first time.
const HEADINGS: &str = concat!(
    "  covered: pixels that either of the two shows\n",
    "  off: the farthest that a point of an agreeing pixel lies from its pixel's ray",
);

/// Prints a row a pair, then what is to be known of each, its causes and worst pixels.
///
/// # Errors
/// Where standard output takes no more.
pub(super) fn pairs(pairs: &[PairReport], next: &Next) -> Result<()> {
    let mut table = terminal::narrow_table();
    table.set_header(["reference | candidate", "covered", "differ", "off, px", "allowed", "verdict"]);
    for pair in pairs {
        let (text, colour) = match pair.verdict {
            Verdict::Agree => ("agree", Color::Green),
            Verdict::NoVerdict => ("NO VERDICT", Color::Red),
            Verdict::Differ => ("DIFFER", Color::Red),
        };
        // Of pixels that agree; where none does there is nothing to say.
        let of_agreeing = |x: f64| if pair.agree > 0 { short(x) } else { "—".to_owned() };
        let number = |text: String| Cell::new(text).set_alignment(CellAlignment::Right);
        table.add_row([
            Cell::new(format!("{} | {}", escaped(&pair.reference), escaped(&pair.candidate))),
            number(pair.covered.to_string()),
            number(pair.differing().to_string()),
            number(of_agreeing(pair.max_px)),
            number(of_agreeing(pair.bound_px)),
            Cell::new(text).fg(colour).add_attribute(Attribute::Bold),
        ]);
    }
    terminal::table(&table)?;
    say!("{HEADINGS}")?;
    for pair in pairs {
        say!("{} | {}: bound: {}", escaped(&pair.reference), escaped(&pair.candidate), pair.bounds)?;
        let c = pair.coverage;
        say!("  {} pixels that both show, {} that one alone does, {} that neither does", c.full, c.partial, c.none)?;
        if pair.agree > 0 {
            // A renderer that gives no curvatures uses nothing of their interval.
            let share = |x: f64| if x > 0.0 { format!("{:.1} %", 100.0 * x) } else { "—".to_owned() };
            let [s, n, k] = [pair.position_share, pair.normal_share, pair.curvature_share].map(share);
            let [normals, curvatures] = [pair.shares.normal.count(), pair.shares.curvature.count()];
            let given = if curvatures < normals { format!(" (given at {curvatures} pixels)") } else { String::new() };
            say!("  of the proven intervals S uses {s}, the normal {n}, curvatures {k}{given}")?;
            say!("  in depth the farthest is off by {} model units", short(pair.max_along))?;
        }
        if let Some(edges) = &pair.edges {
            say!(
                "  {} pixels record a trim edge, off by at most {} px (≤ {}; largest bound {})",
                edges.recorded,
                short(edges.max_px),
                short(edges.bound_px),
                short(edges.greatest_bound_px)
            )?;
        }
        for (reason, count) in pair.reasons() {
            say!("  {count} pixels without a verdict: {}", reason.label())?;
        }
        if pair.ambiguous > 0 {
            say!("  {} pixels where f32 leaves a decision open: any of its answers is right", pair.ambiguous)?;
        }
        if pair.unconverged > 0 {
            say!("  {} pixels where {} did not converge", pair.unconverged, escaped(&pair.candidate))?;
        }
        if let Some(same) = pair.identical {
            say!("  {} of {} pixels at the same (u, v) agree in every bit", same.identical, same.alike)?;
        }
        if !pair.causes.is_empty() {
            say!("  what each cause means: docs/gbuffer.md#when-it-differs")?;
        }
        for (cause, count) in &pair.causes {
            say!("  {count} pixels: {}", cause.label())?;
            for pixel in pair.worst.iter().filter(|pixel| pixel.cause == *cause).take(LISTED) {
                say!("    ({}, {}){}: {}", pixel.x, pixel.y, sample(pixel.sample), pixel.detail)?;
            }
            if let Some(pixel) = pair.worst.iter().find(|pixel| pixel.cause == *cause) {
                say!("    next: {}", escaped(&next.command(pixel)))?;
            }
        }
    }
    Ok(())
}

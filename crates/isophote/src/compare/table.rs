//! A comparison in words and columns.

use super::report::Report;
use crate::antialias::SampleReport;
use crate::text::escaped;
use crate::{say, terminal};
use anyhow::Result;
use comfy_table::{Attribute, Cell, Color, Table, presets::UTF8_FULL_CONDENSED};
use compare::{PairReport, Verdict};
use std::collections::BTreeSet;

/// Pixels of the worst that are listed for each cause of a pair.
const LISTED: usize = 4;

/// Prints what the three renderers' comparison found.
pub(super) fn print(report: &Report) -> Result<()> {
    let adapter = match (&report.adapter, &report.gpu_not_run) {
        (Some(name), _) => format!("{name} ({})", report.driver.as_deref().unwrap_or("driver unknown")),
        (None, Some(why)) => format!("NOT RUN: {why}"),
        (None, None) => "none".to_owned(),
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
    pairs(report.pairs)?;
    shifts(report)?;
    if let Some(shaded) = &report.shaded {
        let verdict = if shaded.verdict == Verdict::Differ { "DIFFER" } else { "agree" };
        let at = shaded.first.map_or(String::new(), |[x, y]| format!(", first at ({x}, {y}){}", sample(shaded.sample)));
        say!("picture shaded by the GPU: {} of {} pixels differ{at}: {verdict}", shaded.differ, shaded.covered)?;
    }
    if report.undecided > 0 {
        say!("the ray caster left {} pixels undecided", report.undecided)?;
    }
    if let Some(note) = report.masks.as_ref().and_then(|masks| masks.note.as_deref()) {
        say!("note: {note}")?;
    }
    let shaded =
        report.shaded.as_ref().map_or(0, |shaded| if shaded.verdict == Verdict::Differ { shaded.differ } else { 0 });
    say!("{}", verdict(report.pairs, report.gpu_not_run.as_deref(), shaded))
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
    "  both/one/neither: pixels that both show, one alone, or neither of the two\n",
    "  off, px: the farthest that a point lies from its pixel's ray, and what is allowed there; in depth: model units\n",
    "  S / n / k: the share of the proven intervals of position, normal and curvature that is used",
);

/// Prints a row a pair, then their causes and worst pixels.
///
/// # Errors
/// Where standard output takes no more.
pub(super) fn pairs(pairs: &[PairReport]) -> Result<()> {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "reference",
        "candidate",
        "covered",
        "agree",
        "differ",
        "both/one/neither",
        "off, px (allowed)",
        "in depth",
        "S / n / k, %",
        "verdict",
    ]);
    for pair in pairs {
        let (text, colour) = match pair.verdict {
            Verdict::Agree => ("agree", Color::Green),
            Verdict::NoVerdict => ("NO VERDICT", Color::Red),
            Verdict::Differ => ("DIFFER", Color::Red),
        };
        let c = pair.coverage;
        // Of pixels that agree; where none does there is nothing to say.
        let of_agreeing = |text: String| if pair.agree > 0 { text } else { "—".to_owned() };
        let shares =
            [pair.position_share, pair.normal_share, pair.curvature_share].map(|x| format!("{:.1}", 100.0 * x));
        table.add_row([
            Cell::new(escaped(&pair.reference)),
            Cell::new(escaped(&pair.candidate)),
            Cell::new(pair.covered),
            Cell::new(pair.agree),
            Cell::new(pair.differing()),
            Cell::new(format!("{}/{}/{}", c.full, c.partial, c.none)),
            Cell::new(of_agreeing(format!("{} (≤ {})", short(pair.max_px), short(pair.bound_px)))),
            Cell::new(of_agreeing(short(pair.max_along))),
            Cell::new(of_agreeing(shares.join(" / "))),
            Cell::new(text).fg(colour).add_attribute(Attribute::Bold),
        ]);
    }
    terminal::table(&table)?;
    say!("{HEADINGS}")?;
    for pair in pairs {
        say!("{} | {}: bound: {}", escaped(&pair.reference), escaped(&pair.candidate), pair.bounds)?;
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
        for (cause, count) in &pair.causes {
            say!("  {count} pixels: {}", cause.label())?;
            for pixel in pair.worst.iter().filter(|pixel| pixel.cause == *cause).take(LISTED) {
                say!("    ({}, {}){}: {}", pixel.x, pixel.y, sample(pixel.sample), pixel.detail)?;
            }
        }
    }
    Ok(())
}

/// A number of four digits that keeps them where it is small.
fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e4).contains(&size) => format!("{x:.4}"),
        size if size.is_finite() => format!("{x:.1e}"),
        _ => "without bound".to_owned(),
    }
}

/// The answer in a sentence: how many pixels were compared, how many differ, how far off the farthest is, and how far it may be.
/// `gpu_not_run` is why the GPU was not compared, `shaded` how many pixels of its own picture differ.
pub(super) fn verdict(pairs: &[PairReport], gpu_not_run: Option<&str>, shaded: usize) -> String {
    let covered: usize = pairs.iter().map(|pair| pair.covered).sum();
    let differing: usize = pairs.iter().map(PairReport::differing).sum();
    let unbounded: usize = pairs.iter().map(|pair| pair.unbounded).sum();
    let farthest = pairs.iter().filter(|pair| pair.agree > 0).max_by(|a, b| a.max_px.total_cmp(&b.max_px));
    let off = farthest.map_or(String::new(), |pair| {
        let (off, bound) = (short(pair.max_px), short(pair.bound_px));
        format!("; of those that agree the farthest is {off} px off, where {bound} px are allowed")
    });
    let open = if unbounded > 0 { format!("; {unbounded} have no verdict") } else { String::new() };
    let comparisons = if pairs.len() == 1 { "1 comparison".to_owned() } else { format!("{} comparisons", pairs.len()) };
    let counts = format!("{differing} of {covered} pixels differ in {comparisons}{off}{open}");
    let silent = pairs.iter().find(|pair| pair.covered > 0 && pair.verdict == Verdict::NoVerdict);
    if differing > 0 {
        let causes = pairs.iter().filter_map(|pair| Some((pair, pair.main_cause()?)));
        let main = causes.max_by_key(|(pair, cause)| pair.causes[cause]);
        let mostly = main.map_or(String::new(), |(_, cause)| format!(", mostly by {}", cause.label()));
        return format!("DIFFER: {counts}{mostly}");
    }
    if shaded > 0 {
        return format!("DIFFER: {counts}; {shaded} pixels of the picture that the GPU shaded itself differ");
    }
    if let Some(why) = gpu_not_run {
        return format!("NOT ALL COMPARED: the GPU did not run: {why}; without it {counts}");
    }
    if covered == 0 {
        return "NO VERDICT: no renderer shows anything, so nothing was compared".to_owned();
    }
    match silent {
        Some(pair) => {
            let why = pair.explanation.as_deref().unwrap_or("too many pixels have none");
            format!("NO VERDICT: {why} ({} | {})", pair.reference, pair.candidate)
        }
        None => format!("AGREE: {counts}"),
    }
}

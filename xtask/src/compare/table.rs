//! A comparison in words and columns.

use super::rendered::Report;
use crate::antialias::SampleReport;
use crate::{say, terminal};
use anyhow::Result;
use comfy_table::{Attribute, Cell, Color, Table, presets::UTF8_FULL_CONDENSED};
use compare::{PairReport, Verdict};
use std::collections::BTreeSet;

/// Pixels of the worst that the table lists for each pair.
const LISTED: usize = 8;

/// Prints what the three renderers' comparison found.
pub(super) fn print(report: &Report) -> Result<()> {
    let adapter = match (&report.adapter, &report.gpu_not_run) {
        (Some(name), _) => format!("{name} ({})", report.driver.as_deref().unwrap_or("driver unknown")),
        (None, Some(why)) => format!("NOT RUN: {why}"),
        (None, None) => "none".to_owned(),
    };
    say!(
        "{}, technique {}, {}x{}, {} triangles\ngpu: {adapter}",
        report.model,
        report.technique,
        report.size[0],
        report.size[1],
        report.triangles
    )?;
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
    Ok(())
}

/// Names a pixel's sample, where it has several.
fn sample(sample: Option<usize>) -> String {
    sample.map_or(String::new(), |sample| format!(" sample {sample}"))
}

/// Says how `pixel` is shown the samples that hold the worst pixels.
fn shifts(report: &Report) -> Result<()> {
    let listed = report.pairs.iter().flat_map(|pair| pair.worst.iter().take(LISTED)).filter_map(|pixel| pixel.sample);
    for sample in listed.collect::<BTreeSet<_>>() {
        let SampleReport { position, lens_shift: [right, up] } = report.samples[sample];
        say!("sample {sample}, at {position:?} of its pixel: `pixel … --lens-shift {right} {up}` explains one")?;
    }
    Ok(())
}

/// Prints a row a pair, then their causes and worst pixels.
pub(super) fn pairs(pairs: &[PairReport]) -> Result<()> {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "reference",
        "candidate",
        "covered",
        "agree",
        "differ",
        "full/partial/none",
        "across px (bound)",
        "along",
        "S / n / k of interval",
        "verdict",
    ]);
    for pair in pairs {
        let (text, colour) = match pair.verdict {
            Verdict::Agree => ("agree", Color::Green),
            Verdict::Differ => ("DIFFER", Color::Red),
            Verdict::NoVerdict => ("NO VERDICT", Color::Red),
        };
        let c = pair.coverage;
        table.add_row([
            Cell::new(&pair.reference),
            Cell::new(&pair.candidate),
            Cell::new(pair.covered),
            Cell::new(pair.agree),
            Cell::new(pair.differing()),
            Cell::new(format!("{}/{}/{}", c.full, c.partial, c.none)),
            Cell::new(format!("{:.5} (≤ {:.5})", pair.max_px, pair.bound_px)),
            Cell::new(format!("{:.2e}", pair.max_along)),
            Cell::new(format!("{:.2} / {:.2} / {:.2}", pair.position_share, pair.normal_share, pair.curvature_share)),
            Cell::new(text).fg(colour).add_attribute(Attribute::Bold),
        ]);
    }
    terminal::table(&table)?;
    for pair in pairs {
        say!("{} | {}: bound: {}", pair.reference, pair.candidate, pair.bounds)?;
        if let Some(edges) = &pair.edges {
            say!(
                "  {} pixels record a trim edge, off by at most {:.5} px (≤ {:.5}; largest bound {:.5})",
                edges.recorded,
                edges.max_px,
                edges.bound_px,
                edges.greatest_bound_px
            )?;
        }
        for (reason, count) in pair.reasons() {
            say!("  {count} pixels without a verdict: {}", reason.label())?;
        }
        if pair.ambiguous > 0 {
            say!("  {} pixels where f32 leaves a decision open: any of its answers is right", pair.ambiguous)?;
        }
        if pair.unconverged > 0 {
            say!("  {} pixels where {} did not converge", pair.unconverged, pair.candidate)?;
        }
        if let Some(same) = pair.identical {
            say!("  {} of {} pixels at the same (u, v) agree in every bit", same.identical, same.alike)?;
        }
        if let Some(explanation) = &pair.explanation {
            say!("  {explanation}")?;
        }
        for (cause, count) in &pair.causes {
            say!("  {count} pixels: {}", cause.label())?;
        }
        for pixel in pair.worst.iter().take(LISTED) {
            let (of, cause) = (sample(pixel.sample), pixel.cause.label());
            say!("    ({}, {}){of} {cause}: {}", pixel.x, pixel.y, pixel.detail)?;
        }
    }
    Ok(())
}

//! A study as lines: the heads of its columns, and the cells of a row, for the terminal and for the page.

use super::error::Spread;
use super::row::{Outcome, Row};
use crate::cost::Cost;

/// Heads of the columns.
pub const HEADS: [&str; 17] = [
    "technique",
    "goal",
    "triangles",
    "chord, px",
    "offset, px",
    "99 %",
    "at",
    "normal, deg",
    "99 %",
    "vertex normal, deg",
    "99 %",
    "missing / extra / other face",
    "prepare, ms",
    "CPU, ms",
    "GPU, ms",
    "processor, ms",
    "held, MB; sent, kB",
];

/// Columns that say which row it is.
pub const KEYS: usize = 2;

/// The other columns, in parts that a terminal shows below each other: triangles and offsets, normals and coverage, costs.
pub const PARTS: [std::ops::Range<usize>; 3] = [KEYS..7, 7..12, 12..17];

/// The cells of a row; a row that failed has its reason in the third.
pub fn cells(row: &Row) -> Vec<String> {
    let none = || "—".to_owned();
    let mut cells = vec![row.technique.to_owned(), row.goal.to_string()];
    let m = match &row.outcome {
        Outcome::Failed(why) => {
            cells.push(format!("failed: {why}"));
            cells.resize(HEADS.len(), none());
            return cells;
        }
        Outcome::Measured(measured) => measured,
    };
    let place = |spread: &Spread| {
        spread.at.map_or_else(none, |at| format!("{},{} face {}", at.pixel[0], at.pixel[1], at.face.0))
    };
    let vertex = |of: fn(&Spread) -> f64| m.vertex_normal_deg.as_ref().map_or_else(none, |spread| number(of(spread)));
    let cost = |of: &dyn Fn(&Cost) -> Option<f64>| m.gpu.as_ref().and_then(of).map_or_else(none, number);
    let errors = &m.errors;
    cells.extend([
        m.triangles.to_string(),
        m.chord_px.map_or_else(none, number),
        number(errors.offset_px.greatest),
        number(errors.offset_px.percentile_99),
        place(&errors.offset_px),
        number(errors.normal_deg.greatest),
        number(errors.normal_deg.percentile_99),
        vertex(|spread| spread.greatest),
        vertex(|spread| spread.percentile_99),
        format!("{} / {} / {}", errors.missing, errors.extra, errors.other_face),
        number(m.prepare_ms),
        m.cpu.as_ref().map_or_else(none, |cost| number(cost.frame_ms)),
        cost(&|cost| Some(cost.frame_ms)),
        cost(&|cost| cost.processor_ms),
        m.gpu.as_ref().map_or_else(none, |cost| {
            let held = cost.bytes_held.map_or_else(none, |bytes| number(bytes as f64 / 1e6));
            format!("{held}; {}", cost.bytes_uploaded.map_or_else(none, |bytes| number(bytes as f64 / 1e3)))
        }),
    ]);
    cells
}

/// Three significant digits.
pub fn number(x: f64) -> String {
    match x.abs() {
        size if size >= 100.0 => format!("{x:.0}"),
        size if size >= 10.0 => format!("{x:.1}"),
        size if size >= 1.0 => format!("{x:.2}"),
        size if size >= 0.01 || size == 0.0 => format!("{x:.3}"),
        _ => format!("{x:.1e}"),
    }
}

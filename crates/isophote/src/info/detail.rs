//! One model in detail: each face with its degrees, control points, knots and box.

use super::approximation::ApproximationInfo;
use super::overview::{Overview, degenerate_edges};
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use formats::{Document, Note};
use nurbs::{Direction, Hull, KnotVector};
use scene::{FaceId, escaped};
use serde::Serialize;

/// Of `testdata/schema/info-1.json`.
const SCHEMA_VERSION: u32 = 1;

/// Rows that the table prints before it only counts the rest; JSON always lists all.
const TABLE_ROWS: usize = 64;

#[derive(Serialize)]
struct FaceInfo {
    face: usize,
    /// Its own name, or that of what it is a part of.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    /// In sRGB: `#rrggbb`.
    #[serde(skip_serializing_if = "Option::is_none")]
    colour: Option<String>,
    /// The layers that it is on, or that what it is a part of is on.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    layers: Vec<String>,
    /// What its surface is in the file.
    kind: String,
    /// Its number in the file: another one where faces before it were left out or cut.
    number_in_file: usize,
    surface: usize,
    degree: [usize; 2],
    control_points: [usize; 2],
    spans: [usize; 2],
    rational: bool,
    reversed: bool,
    knots_u: KnotInfo,
    knots_v: KnotInfo,
    hull: [[f64; 3]; 2],
    /// Sides that are a single point: `u0`, `u1`, `v0`, `v1`.
    degenerate_edges: Vec<&'static str>,
    trim_loops: usize,
}

#[derive(Serialize)]
struct KnotInfo {
    count: usize,
    domain: [f64; 2],
    clamped: bool,
    /// Distinct knots inside the domain with their multiplicities.
    interior: Vec<(f64, usize)>,
}

/// One model.
#[derive(Serialize)]
pub struct ModelInfo {
    schema_version: u32,
    model: String,
    #[serde(flatten)]
    overview: Overview,
    /// What of the file is not drawn as it stands there, and what was approximated.
    notes: Vec<String>,
    faces: Vec<FaceInfo>,
    hull: [[f64; 3]; 2],
    /// Absent where none was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    approximation: Option<ApproximationInfo>,
}

/// All of a model.
pub fn describe(document: &Document, approximation: Option<ApproximationInfo>) -> ModelInfo {
    let model = &document.model;
    ModelInfo {
        schema_version: SCHEMA_VERSION,
        model: model.name().to_owned(),
        overview: Overview::of(document),
        notes: document.notes.iter().map(Note::to_string).collect(),
        faces: (0..model.faces().len()).map(|id| face(document, id)).collect(),
        hull: corners(model.hull()),
        approximation,
    }
}

fn corners(hull: Hull) -> [[f64; 3]; 2] {
    [hull.min.to_array(), hull.max.to_array()]
}

fn face(document: &Document, id: usize) -> FaceInfo {
    let (model, said) = (&document.model, &document.attributes[id]);
    let face = &model.faces()[id];
    let surface = model.surface(FaceId(id as u32));
    let [ku, kv] = [Direction::U, Direction::V].map(|d| surface.knots(d));
    FaceInfo {
        face: id,
        name: said.name.as_ref().map(|name| name.to_string()),
        colour: said.colour.map(|colour| colour.to_string()),
        layers: said.layers.iter().map(|layer| layer.to_string()).collect(),
        kind: said.surface.to_string(),
        number_in_file: model.number_in_file(FaceId(id as u32)),
        surface: face.surface,
        degree: surface.degree(),
        control_points: surface.control_counts(),
        spans: [ku.spans().count(), kv.spans().count()],
        rational: surface.weights().is_some(),
        reversed: face.reversed,
        knots_u: knots(ku),
        knots_v: knots(kv),
        hull: corners(surface.hull()),
        degenerate_edges: degenerate_edges(surface),
        trim_loops: face.loops.len(),
    }
}

fn knots(knots: &KnotVector) -> KnotInfo {
    let (start, end) = knots.domain();
    let interior = knots.knots().chunk_by(|a, b| a == b).filter(|run| start < run[0] && run[0] < end);
    KnotInfo {
        count: knots.knots().len(),
        domain: [start, end],
        clamped: knots.is_clamped(),
        interior: interior.map(|run| (run[0], run.len())).collect(),
    }
}

/// The model for people, in lines.
pub fn text(document: &Document) -> String {
    let info = describe(document, None);
    let mut lines = vec![];
    let point = |p: [f64; 3]| format!("({})", p.map(|x| significant(x, size_of(info.hull))).join(", "));
    let patches = info.overview.bezier_patches;
    lines.push(format!(
        "{}: {} faces, {patches} Bézier patches, hash {}",
        escaped(&info.model),
        info.faces.len(),
        info.overview.hash
    ));
    let unit = info.overview.unit.as_ref().map_or(String::new(), |unit| format!(", in units of one {}", escaped(unit)));
    lines.push(format!("box {} to {}{unit}", point(info.hull[0]), point(info.hull[1])));
    lines.extend(info.overview.lines());
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "face",
        "surface",
        "degree",
        "control points",
        "knots in u",
        "knots in v",
        "kind",
        "degenerate",
        "trims",
        "box",
    ]);
    for f in info.faces.iter().take(TABLE_ROWS) {
        let kind = if f.rational { "rational" } else { "polynomial" };
        let kind = if f.reversed { format!("{kind}, reversed") } else { kind.to_owned() };
        let is_renumbered = f.face != f.number_in_file;
        let face =
            if is_renumbered { format!("{} ({} in the file)", f.face, f.number_in_file) } else { f.face.to_string() };
        let said: Vec<&str> = [&f.name, &f.colour].into_iter().flatten().map(String::as_str).collect();
        let face = if said.is_empty() { face } else { format!("{face}\n{}", escaped(&said.join(", "))) };
        table.add_row([
            face,
            f.kind.clone(),
            format!("{} × {}", f.degree[0], f.degree[1]),
            format!("{} × {}", f.control_points[0], f.control_points[1]),
            knot_text(&f.knots_u),
            knot_text(&f.knots_v),
            kind,
            f.degenerate_edges.join(" "),
            f.trim_loops.to_string(),
            format!("{}\n{}", point(f.hull[0]), point(f.hull[1])),
        ]);
    }
    lines.push(table.to_string());
    if info.faces.len() > TABLE_ROWS {
        lines.push(format!("… and {} more (--format json lists all)", info.faces.len() - TABLE_ROWS));
    }
    lines.join("\n")
}

/// The greatest side of a box.
fn size_of([min, max]: [[f64; 3]; 2]) -> f64 {
    (0..3).map(|axis| max[axis] - min[axis]).fold(0.0, f64::max)
}

/// A coordinate to a millionth of `size`, or to seven digits where it is much larger or smaller than 1.
fn significant(x: f64, size: f64) -> String {
    if x == 0.0 || x.abs() < 1e-6 * size {
        return "0".to_owned();
    }
    if !(1e-3..1e7).contains(&size) || 1e7 <= x.abs() {
        return format!("{x:.6e}");
    }
    let decimals = (6.0 - size.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{x:.decimals$}")
}

fn knot_text(knots: &KnotInfo) -> String {
    let repeated = knots.interior.iter().map(|(_, m)| *m).max().unwrap_or(0);
    let ends = if knots.clamped { "clamped" } else { "unclamped" };
    format!(
        "{} on [{}, {}]\n{ends}, {} inside, multiplicity ≤ {}",
        knots.count,
        knots.domain[0],
        knots.domain[1],
        knots.interior.len(),
        repeated.max(1)
    )
}

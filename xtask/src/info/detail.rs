//! `info`: what a model consists of.

mod approximation;

use crate::format::Format;
use crate::view::ModelArgs;
use crate::{number, say, terminal};
use anyhow::Result;
use approximation::{ApproximationInfo, approximated};
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use formats::{Document, Note};
use nurbs::{Direction, Hull, KnotVector, Surface};
use scene::{FaceId, Model, escaped};
use serde::Serialize;

/// A side counts as collapsed to a point when its control points stay within this share of the surface's box.
const COLLAPSED_SHARE: f64 = 1e-12;

/// Rows that the table prints before it only counts the rest; JSON always lists all.
const TABLE_ROWS: usize = 64;

/// Show what a model consists of: faces, degrees, control points, knots, boxes, degenerate edges
#[derive(Debug, Args)]
pub struct InfoArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// List the built-in models instead
    #[arg(long)]
    list: bool,
    /// Say how many bicubic patches stand for the model within this distance, model units, and how far off they are at most
    #[arg(long, value_name = "TOL", value_parser = number::positive, allow_hyphen_values = true)]
    approximate: Option<f64>,
    /// For people or for machines
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

#[derive(Serialize)]
struct FaceInfo {
    face: usize,
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

#[derive(Serialize)]
struct ModelInfo {
    model: String,
    hash: String,
    /// The unit of all lengths; absent where the file names none.
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<String>,
    /// What of the file is not drawn as it stands there, and what was approximated.
    notes: Vec<String>,
    faces: Vec<FaceInfo>,
    hull: [[f64; 3]; 2],
    bezier_patches: usize,
    /// Absent where no face has loops.
    trimming: Option<TrimmingInfo>,
    /// Absent where none was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    approximation: Option<ApproximationInfo>,
}

/// Runs the command.
///
/// # Errors
/// Where the model cannot be read.
pub fn run(args: &InfoArgs) -> Result<()> {
    if args.list {
        for (name, description) in models::all() {
            say!("{name:20} {description}")?;
        }
        return Ok(());
    }
    let document = args.model.document()?;
    let model = &document.model;
    let approximation = args.approximate.map(|tolerance| approximated(model, tolerance)).transpose()?;
    match args.format {
        Format::Json => terminal::json_lines(&ModelInfo { approximation, ..describe(&document) })?,
        Format::Table => {
            say!("{}", text(&document))?;
            if let Some(ApproximationInfo { tolerance, patches, bicubic_patches, bound, .. }) = approximation {
                say!(
                    "within {tolerance:e}: {bicubic_patches} bicubic patches stand for {patches} Bézier patches, at most {bound:.3e} off"
                )?;
            }
        }
    }
    Ok(())
}

/// The trimming of a model in a few numbers.
#[derive(Serialize)]
struct TrimmingInfo {
    /// Faces with loops that cut something away.
    trimmed_faces: usize,
    trim_curves: usize,
    /// The longest gap inside a loop that was closed, model units.
    largest_gap_in_a_loop: f64,
    shared_edges: usize,
    /// Where the curves of a shared edge run farthest apart.
    widest_edge: Option<EdgeInfo>,
}

#[derive(Serialize)]
struct EdgeInfo {
    edge: i64,
    faces: Vec<u32>,
    /// Model units.
    gap: f64,
}

fn trimming(model: &Model) -> TrimmingInfo {
    let regions = || (0..model.faces().len()).filter_map(|id| model.region(FaceId(id as u32)));
    let edges = model.shared_edges();
    let widest = edges.iter().max_by(|a, b| a.gap.total_cmp(&b.gap));
    TrimmingInfo {
        trimmed_faces: regions().filter(|region| !region.is_whole()).count(),
        trim_curves: model.faces().iter().flat_map(|face| &face.loops).map(|boundary| boundary.trims.len()).sum(),
        largest_gap_in_a_loop: regions().map(|region| region.largest_gap()).fold(0.0, f64::max),
        shared_edges: edges.len(),
        widest_edge: widest.map(|edge| EdgeInfo {
            edge: edge.edge,
            faces: edge.faces.iter().map(|face| face.0).collect(),
            gap: edge.gap,
        }),
    }
}

fn describe(document: &Document) -> ModelInfo {
    let model = &document.model;
    let sides: Vec<Vec<&str>> = model.surfaces().iter().map(degenerate_edges).collect();
    let faces: Vec<FaceInfo> = (0..model.faces().len()).map(|id| face(model, id, &sides)).collect();
    let bezier_patches = faces.iter().map(|f| f.spans[0] * f.spans[1]).sum();
    ModelInfo {
        model: model.name().to_owned(),
        hash: model.hash(),
        unit: document.unit.as_ref().map(|unit| unit.name.clone()),
        notes: document.notes.iter().map(Note::to_string).collect(),
        faces,
        hull: corners(model.hull()),
        bezier_patches,
        trimming: model.is_trimmed().then(|| trimming(model)),
        approximation: None,
    }
}

fn corners(hull: Hull) -> [[f64; 3]; 2] {
    [hull.min.to_array(), hull.max.to_array()]
}

fn face(model: &Model, id: usize, sides: &[Vec<&'static str>]) -> FaceInfo {
    let face = &model.faces()[id];
    let surface = model.surface(FaceId(id as u32));
    let [ku, kv] = [Direction::U, Direction::V].map(|d| surface.knots(d));
    FaceInfo {
        face: id,
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
        degenerate_edges: sides[face.surface].clone(),
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

/// The sides whose Bézier control points all coincide.
fn degenerate_edges(surface: &Surface) -> Vec<&'static str> {
    let patches = surface.bezier_patches();
    let [[u0, u1], [v0, v1]] = surface.domain();
    let [p, q] = surface.degree();
    let least = surface.hull().diagonal() * COLLAPSED_SHARE;
    let collapsed = |direction: Direction, end: f64, row: usize, side: usize| {
        let points = patches.iter().filter(|patch| patch.domain[direction as usize][side] == end).flat_map(|patch| {
            patch.control.iter().enumerate().filter_map(move |(index, c)| {
                let on_side = if direction == Direction::U { index / (q + 1) == row } else { index % (q + 1) == row };
                on_side.then(|| c.truncate() / c.w)
            })
        });
        Hull::of(points).diagonal() <= least + 1e-15
    };
    let sides = [
        ("u0", collapsed(Direction::U, u0, 0, 0)),
        ("u1", collapsed(Direction::U, u1, p, 1)),
        ("v0", collapsed(Direction::V, v0, 0, 0)),
        ("v1", collapsed(Direction::V, v1, q, 1)),
    ];
    sides.into_iter().filter_map(|(name, is)| is.then_some(name)).collect()
}

/// The model for people, in lines.
pub fn text(document: &Document) -> String {
    let info = describe(document);
    let mut lines = vec![];
    let point = |p: [f64; 3]| format!("({})", p.map(|x| significant(x, size_of(info.hull))).join(", "));
    lines.push(format!(
        "{}: {} faces, {} Bézier patches, hash {}",
        escaped(&info.model),
        info.faces.len(),
        info.bezier_patches,
        info.hash
    ));
    let unit = info.unit.as_ref().map_or(String::new(), |unit| format!(", in units of one {}", escaped(unit)));
    lines.push(format!("box {} to {}{unit}", point(info.hull[0]), point(info.hull[1])));
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "face",
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
        table.add_row([
            face,
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
    if let Some(t) = &info.trimming {
        lines.push(format!(
            "{} trimmed faces, {} trim curves; largest gap closed in a loop {:.1e}",
            t.trimmed_faces, t.trim_curves, t.largest_gap_in_a_loop
        ));
        if let Some(widest) = &t.widest_edge {
            let faces: Vec<String> = widest.faces.iter().map(u32::to_string).collect();
            lines.push(format!(
                "{} shared edges; the curves of edge {}, faces {}, run farthest apart: {:.1e}",
                t.shared_edges,
                widest.edge,
                faces.join(" and "),
                widest.gap
            ));
        }
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

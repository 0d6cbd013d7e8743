//! A model in a few numbers: what stands above its table, and all that is said of it where many are listed.

use formats::{Document, NoteKind};
use nurbs::{Direction, Hull, Surface};
use scene::{FaceId, Model, escaped};
use serde::Serialize;
use std::collections::BTreeMap;

/// A side counts as collapsed to a point when its control points stay within this share of the surface's box.
const COLLAPSED_SHARE: f64 = 1e-12;

/// A model in a few numbers. Lengths are in its unit.
#[derive(Debug, Serialize)]
pub struct Overview {
    /// [`Model::hash`].
    pub hash: String,
    /// The unit of all lengths; absent where the file names none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The greatest tolerance of a face; 0 where the file states none.
    pub tolerance: f64,
    face_count: usize,
    /// Bézier patches of all faces.
    pub bezier_patches: usize,
    /// Faces by what their surfaces are in the file.
    surfaces: BTreeMap<String, usize>,
    /// Faces by the degrees of their surfaces.
    degrees: BTreeMap<String, usize>,
    rational_faces: usize,
    /// Sides of faces' surfaces that are a single point.
    degenerate_edge_count: usize,
    named_faces: usize,
    coloured_faces: usize,
    /// Faces by the layers that they are on; one that is on several counts with each.
    layers: BTreeMap<String, usize>,
    /// Absent where no face has loops.
    trimming: Option<TrimmingInfo>,
    /// What is to be known of how the file was read.
    notes_by_kind: Vec<NoteCount>,
}

/// The notes of one kind.
#[derive(Debug, Serialize)]
struct NoteCount {
    kind: String,
    count: usize,
    first: String,
}

impl Overview {
    /// That of a document.
    pub fn of(document: &Document) -> Self {
        let model = &document.model;
        let collapsed: Vec<usize> = model.surfaces().iter().map(|surface| degenerate_edges(surface).len()).collect();
        let mut overview = Self {
            hash: model.hash(),
            unit: document.unit.as_ref().map(|unit| unit.name.clone()),
            tolerance: model.faces().iter().map(|face| face.tolerance).fold(0.0, f64::max),
            face_count: model.faces().len(),
            bezier_patches: 0,
            surfaces: BTreeMap::new(),
            degrees: BTreeMap::new(),
            rational_faces: 0,
            degenerate_edge_count: 0,
            named_faces: document.attributes.iter().filter(|said| said.name.is_some()).count(),
            coloured_faces: document.attributes.iter().filter(|said| said.colour.is_some()).count(),
            layers: BTreeMap::new(),
            trimming: model.is_trimmed().then(|| trimming(model)),
            notes_by_kind: vec![],
        };
        for (face, said) in model.faces().iter().zip(&document.attributes) {
            let surface = &model.surfaces()[face.surface];
            let [p, q] = surface.degree();
            let spans = [Direction::U, Direction::V].map(|direction| surface.knots(direction).spans().count());
            overview.bezier_patches += spans[0] * spans[1];
            *overview.surfaces.entry(said.surface.to_string()).or_default() += 1;
            *overview.degrees.entry(format!("{p} × {q}")).or_default() += 1;
            overview.rational_faces += usize::from(surface.weights().is_some());
            overview.degenerate_edge_count += collapsed[face.surface];
        }
        for layer in document.attributes.iter().flat_map(|said| said.layers.iter()) {
            match overview.layers.get_mut(&**layer) {
                Some(count) => *count += 1,
                None => _ = overview.layers.insert(layer.to_string(), 1),
            }
        }
        for kind in [NoteKind::LeftOut, NoteKind::Healed, NoteKind::Approximated] {
            let mut notes = document.notes.iter().filter(|note| note.kind == kind);
            let Some(first) = notes.next() else { continue };
            let (kind, first) = (kind.to_string(), first.to_string());
            overview.notes_by_kind.push(NoteCount { kind, count: 1 + notes.count(), first });
        }
        overview
    }

    /// All of it, in lines.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!("surfaces: {}; degrees: {}", counts(&self.surfaces), counts(&self.degrees))];
        lines.push(format!("{}; {}", self.parts().join(", "), self.tolerance_text()));
        if !self.layers.is_empty() {
            lines.push(format!("layers: {}", layer_counts(&self.layers)));
        }
        if let Some(trimming) = &self.trimming {
            lines.push(format!("largest gap closed in a loop {:.1e}", trimming.largest_gap_in_a_loop));
            if let Some(EdgeInfo { edge, faces, gap }) = &trimming.widest_edge {
                let faces: Vec<String> = faces.iter().map(u32::to_string).collect();
                lines.push(format!(
                    "{} shared edges; the curves of edge {edge}, faces {}, run farthest apart: {gap:.1e}",
                    trimming.shared_edges,
                    faces.join(" and ")
                ));
            }
        }
        let note = |note: &NoteCount| format!("{}: {}, first: {}", note.kind, note.count, escaped(&note.first));
        lines.extend(self.notes_by_kind.iter().map(note));
        lines
    }

    /// All of it, in one line.
    pub fn line(&self) -> String {
        let mut parts = vec![format!("{} faces: {}", self.face_count, counts(&self.surfaces))];
        parts.push(format!("degrees {}", counts(&self.degrees)));
        parts.extend(self.parts());
        let widest =
            self.trimming.as_ref().and_then(|trimming| Some((trimming.shared_edges, trimming.widest_edge.as_ref()?)));
        parts.extend(widest.map(|(count, edge)| format!("{count} shared edges up to {:.1e} apart", edge.gap)));
        parts.push(format!("unit {}", escaped(self.unit.as_deref().unwrap_or("not stated"))));
        parts.push(self.tolerance_text());
        parts.extend(self.notes_by_kind.iter().map(|note| format!("{} {}", note.count, note.kind)));
        parts.join("; ")
    }

    fn tolerance_text(&self) -> String {
        let is_stated = 0.0 < self.tolerance;
        if is_stated { format!("tolerance {:.1e}", self.tolerance) } else { "tolerance not stated".to_owned() }
    }

    fn parts(&self) -> Vec<String> {
        let trimming = self.trimming.as_ref();
        let number = |of: fn(&TrimmingInfo) -> usize| trimming.map_or(0, of);
        vec![
            format!("{} rational", self.rational_faces),
            format!("{} trimmed", number(|trimming| trimming.trimmed_faces)),
            format!("{} trim curves", number(|trimming| trimming.trim_curves)),
            format!("{} holes", number(|trimming| trimming.holes)),
            format!("{} degenerate edges", self.degenerate_edge_count),
            format!("{} named", self.named_faces),
            format!("{} coloured", self.coloured_faces),
            format!("{} layers", self.layers.len()),
        ]
    }
}

/// How many layers are listed for people.
const LAYERS_SHOWN: usize = 12;

/// Layers with how many faces are on each, the fullest first.
fn layer_counts(layers: &BTreeMap<String, usize>) -> String {
    let mut all: Vec<(&String, &usize)> = layers.iter().collect();
    all.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    let text = |(layer, count): &(&String, &usize)| format!("{count} on \"{}\"", escaped(layer));
    let shown: Vec<String> = all.iter().take(LAYERS_SHOWN).map(text).collect();
    let more = all.len().saturating_sub(LAYERS_SHOWN);
    let more = if 0 < more { format!(", and {more} more (--format json lists all)") } else { String::new() };
    shown.join(", ") + &more
}

/// What occurs how often, the most frequent first.
fn counts(counts: &BTreeMap<String, usize>) -> String {
    let mut all: Vec<(&String, &usize)> = counts.iter().collect();
    all.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    all.iter().map(|(what, count)| format!("{count} {what}")).collect::<Vec<_>>().join(", ")
}

/// The trimming of a model in a few numbers.
#[derive(Debug, Serialize)]
pub struct TrimmingInfo {
    /// Faces with loops that cut something away.
    trimmed_faces: usize,
    trim_curves: usize,
    /// Loops that the file does not call outer ones.
    holes: usize,
    /// The longest gap inside a loop that was closed, model units.
    largest_gap_in_a_loop: f64,
    shared_edges: usize,
    /// Where the curves of a shared edge run farthest apart.
    widest_edge: Option<EdgeInfo>,
}

#[derive(Debug, Serialize)]
pub struct EdgeInfo {
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
        holes: model.faces().iter().flat_map(|face| &face.loops).filter(|boundary| !boundary.outer).count(),
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

/// The sides whose Bézier control points all coincide.
pub fn degenerate_edges(surface: &Surface) -> Vec<&'static str> {
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

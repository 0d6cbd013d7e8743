//! All lines of a model in one picture.

use crate::border::borders;
use crate::cut::runs;
use crate::equation::equations;
use crate::family::Family;
use crate::frame::Frame;
use crate::join::joined;
use crate::place::{Eye, Place};
use crate::trace::{Chord, Traced, trace};
use crate::wire::Wire;
use nurbs::{BezierPatch, DerivativeBounds};
use rayon::prelude::*;
use scene::{Camera, FaceId, Model, Viewport};

/// How far a chord may be from its line, pixels.
pub const TOLERANCE: f64 = 0.05;

/// At a silhouette or a border the surface ends, and the line's own place may be a hair behind it: there it is enough that
/// something so near is seen, pixels.
pub(crate) const BESIDE: f64 = 0.125;

/// A line, or a part of one: all of it is seen, or none.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Number of its family.
    pub family: usize,
    /// Number of its level in the family.
    pub index: usize,
    /// Whether it is seen. Else something hides it.
    pub is_seen: bool,
    /// In order, two at least. What closes ends where it began.
    pub places: Vec<Place>,
}

impl Line {
    /// The faces that it is on, in order along it.
    pub fn faces(&self) -> Vec<FaceId> {
        let mut faces: Vec<FaceId> = self.places.iter().map(|place| place.face).collect();
        faces.dedup();
        faces
    }
}

/// A line that was not followed everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unfinished {
    /// Number of its family.
    pub family: usize,
    /// Number of its level in the family.
    pub index: usize,
    /// On which face.
    pub face: FaceId,
    /// Pieces of the face's patches in which it may run and is not drawn.
    pub pieces: usize,
}

/// What was drawn.
#[derive(Debug, Clone)]
pub struct Drawing {
    /// What was asked for.
    pub families: Vec<Family>,
    /// Lines by family, level and the order in which they were found.
    pub lines: Vec<Line>,
    /// Empty where no line is lost.
    pub unfinished: Vec<Unfinished>,
    /// What is drawn beside the surface; [`draw`] leaves it empty.
    pub wires: Vec<Wire>,
}

/// A surface in patches, each with bounds of its derivatives.
struct Patches {
    patches: Vec<(BezierPatch, DerivativeBounds)>,
    bounds: DerivativeBounds,
}

/// Draws families of lines on a model, each line as far as it is in the picture and has material.
///
/// A line that is smaller in the picture than [`TOLERANCE`] may be missing. Where a line crosses itself or is undecidable in f64,
/// and where [`Drawing::unfinished`] says so, there are gaps.
pub fn draw(model: &Model, camera: &Camera, viewport: Viewport, families: &[Family], eye: &impl Eye) -> Drawing {
    let frame = Frame { camera: *camera, viewport, tolerance: TOLERANCE };
    let surfaces: Vec<Patches> = model.surfaces().par_iter().map(Patches::new).collect();
    let within = frame.joint() * camera.pixel_at(viewport, model.hull());
    let mut drawing = Drawing { families: families.to_vec(), lines: vec![], unfinished: vec![], wires: vec![] };
    for (number, family) in families.iter().enumerate() {
        // Of each face the chords of each level.
        let traced: Vec<Vec<Traced>> = (0..model.faces().len())
            .into_par_iter()
            .map(|face| {
                let id = FaceId(face as u32);
                surfaces[model.faces()[face].surface].traced(model, id, family, &frame)
            })
            .collect();
        let ends = matches!(family, Family::Borders | Family::Trims | Family::Silhouettes);
        let beside = if ends { BESIDE } else { 0.0 };
        let ids = || (0..).map(FaceId);
        for index in 0..family.count() {
            let unfinished = ids().zip(&traced).map(|(face, of)| (face, of[index].unfinished));
            let unfinished = unfinished.filter(|(_, pieces)| 0 < *pieces);
            drawing.unfinished.extend(unfinished.map(|(face, pieces)| Unfinished {
                family: number,
                index,
                face,
                pieces,
            }));
        }
        let levels: Vec<Vec<Line>> = (0..family.count())
            .into_par_iter()
            .map(|index| {
                let on_faces =
                    |(face, of): (FaceId, &Vec<Traced>)| material(model, face, &of[index].chords, &frame, eye);
                let is_border = matches!(family, Family::Borders | Family::Trims);
                let whole = |(face, of): (FaceId, &Vec<Traced>)| pieces(model, face, &of[index].chords);
                let pieces: Vec<Vec<Place>> = if is_border {
                    ids().zip(&traced).flat_map(whole).collect()
                } else {
                    ids().zip(&traced).flat_map(on_faces).collect()
                };
                let mut lines = joined(pieces, within, model);
                // Rounding makes lines of no length where a plane meets a pole.
                lines.retain(|line| line.iter().any(|place| within < place.position.distance(line[0].position)));
                let seen =
                    lines.par_iter().flat_map_iter(|line| runs(line, model, &frame, |place| eye.sees(place, beside)));
                seen.map(|(is_seen, places)| Line { family: number, index, is_seen, places }).collect()
            })
            .collect();
        drawing.lines.extend(levels.into_iter().flatten());
    }
    drawing
}

impl Patches {
    fn new(surface: &nurbs::Surface) -> Self {
        let patches: Vec<_> = surface
            .bezier_patches()
            .into_iter()
            .map(|patch| (patch.derivative_bounds(), patch))
            .map(|(b, p)| (p, b))
            .collect();
        let bounds = patches.iter().fold(DerivativeBounds::default(), |all, (_, bounds)| all.max(*bounds));
        Self { patches, bounds }
    }

    /// The chords of each level of a family on a face of this surface.
    fn traced(&self, model: &Model, face: FaceId, family: &Family, frame: &Frame) -> Vec<Traced> {
        let mut levels = vec![Traced::default(); family.count()];
        let is_drawn = match family {
            Family::Borders => true,
            Family::Trims => model.trimmed_region(face).is_some(),
            _ => false,
        };
        if is_drawn {
            levels[0] = borders(model, face, &self.bounds, frame);
            return levels;
        }
        let domain = model.surface(face).domain();
        let region = model.trimmed_region(face).map(scene::Region::hull);
        for (patch, bounds) in &self.patches {
            let mut rectangle = patch.domain;
            if let Some(region) = region {
                for axis in 0..2 {
                    let [low, high] = rectangle[axis];
                    rectangle[axis] = [low.max(region.min[axis]), high.min(region.max[axis])];
                }
            }
            if !rectangle.iter().all(|[low, high]| low < high) || frame.excludes(patch.hull()) {
                continue;
            }
            let patch = patch.part(rectangle);
            for equation in equations(family, &patch, domain, &frame.camera) {
                let mut found = trace(&equation, &patch, bounds, frame);
                levels[equation.index].chords.append(&mut found.chords);
                levels[equation.index].unfinished += found.unfinished;
            }
        }
        levels
    }
}

fn pieces(model: &Model, face: FaceId, chords: &[Chord]) -> Vec<Vec<Place>> {
    chords.iter().map(|chord| chord.ends.map(|uv| Place::new(model, face, uv)).to_vec()).collect()
}

/// The parts of a face's chords that have material.
fn material(model: &Model, face: FaceId, chords: &[Chord], frame: &Frame, eye: &impl Eye) -> Vec<Vec<Place>> {
    let pieces = pieces(model, face, chords);
    if model.trimmed_region(face).is_none() {
        return pieces;
    }
    let parts = pieces.iter().flat_map(|piece| runs(piece, model, frame, |place| eye.has_material(face, place.uv)));
    parts.filter(|(has_material, _)| *has_material).map(|(_, places)| places).collect()
}

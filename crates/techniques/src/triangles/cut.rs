//! Fragments of a face that loops bound, before the depth test: those whose face does not cover the pixel leave it to what
//! lies behind. They wait for each other, since the program runs fastest on many that follow each other on a face.

use pipeline::fragment::{TangentPlane, tangent_plane, tangent_planes};
use pipeline::{BOUNDED, Parameters, Sight};
use raster::Drawing;
use raster::depth::DepthTile;
use raster::geometry::Attributes;

/// How many may wait: enough to fill the program's lanes, and few enough that what they hide is soon known to be hidden.
const MOST: usize = 64;

/// Fragments that wait, in drawing order and all of one face.
#[derive(Default)]
pub struct Waiting {
    face: u32,
    samples: Vec<Sample>,
    places: Vec<Parameters>,
    planes: Vec<TangentPlane>,
}

/// Where a fragment would stand, and the depth of its triangle there.
struct Sample {
    at: [i32; 2],
    depth: f32,
    owner: u32,
}

impl Waiting {
    /// Adds a fragment of `face` at pixel `at` with its triangle's depth, which goes to `tile` with its owner if the face covers its
    /// centre.
    pub fn add(
        &mut self,
        drawing: &Drawing,
        tile: &mut DepthTile,
        face: u32,
        place: Parameters,
        (at, depth, owner): ([i32; 2], f32, u32),
    ) {
        if face != self.face || self.samples.len() == MOST {
            self.decide(drawing, tile);
            self.face = face;
        }
        self.samples.push(Sample { at, depth, owner });
        self.places.push(place);
    }

    /// Decides about all that wait.
    pub fn decide(&mut self, drawing: &Drawing, tile: &mut DepthTile) {
        if !self.samples.is_empty() {
            tangent_planes(drawing.scene, self.face, &self.places, &mut self.planes);
        }
        for ((&Sample { at: [x, y], depth, owner }, place), plane) in
            self.samples.iter().zip(&self.places).zip(&self.planes)
        {
            // That of a skirt's triangle says nothing of the place that it shows.
            if plane.on_skirt || tile.passes(x, y, depth) {
                let at = [x as f32 + 0.5, y as f32 + 0.5];
                if let Some(depth) = covers(drawing, self.face, *place, plane, at, depth) {
                    tile.test(x, y, depth, owner);
                }
            }
        }
        self.samples.clear();
        self.places.clear();
        self.planes.clear();
    }
}

/// The depth of a fragment of a face, interpolated at picture position `at` with its triangle's `depth`; `None` where it is cut away.
pub fn drawn(drawing: &Drawing, face: u32, place: Parameters, at: [f32; 2], depth: f32) -> Option<f32> {
    if !is_bounded(drawing, face) {
        return Some(depth).filter(|&depth| depth > 0.0);
    }
    covers(drawing, face, place, &tangent_plane(drawing.scene, face, place), at, depth)
}

/// Whether a triangle of a face, with these attributes, is of its skirt or touches the border before one, from where interpolation may
/// step onto it by a rounding error.
pub fn reaches_skirt(drawing: &Drawing, Attributes { face, span, uv, .. }: &Attributes) -> bool {
    let face = &drawing.scene.faces()[*face as usize];
    let is_at_border = |&uv| is_at_border(Parameters { span: *span, uv }, [face.spans_u, face.spans_v]);
    face.flags & BOUNDED != 0 && uv.iter().any(is_at_border)
}

/// Whether a place is on the border of the domain, which has so many spans in u and in v, or beyond it.
pub fn is_at_border(Parameters { span, uv }: Parameters, spans: [u32; 2]) -> bool {
    (0..2).any(|k| (uv[k] <= 0.0 && span[k] == 0) || (uv[k] >= 1.0 && span[k] + 1 == spans[k]))
}

/// Whether a fragment of a face is on its skirt: there it shows the surface's own point, wherever it settles.
pub fn is_on_skirt(drawing: &Drawing, face: u32, place: Parameters) -> bool {
    let face = &drawing.scene.faces()[face as usize];
    face.flags & BOUNDED != 0 && pipeline::fragment::is_on_skirt(face, place)
}

/// Where a fragment of a face, interpolated at picture position `at`, shows it.
pub fn shown(drawing: &Drawing, face: u32, place: Parameters, at: [f32; 2]) -> Parameters {
    if is_bounded(drawing, face) {
        Sight::new(&drawing.views[face as usize], at).place(drawing.scene, face, place)
    } else {
        place
    }
}

fn covers(
    drawing: &Drawing,
    face: u32,
    place: Parameters,
    plane: &TangentPlane,
    at: [f32; 2],
    depth: f32,
) -> Option<f32> {
    Sight::new(&drawing.views[face as usize], at).shows(drawing.scene, face, place, plane, depth)
}

/// Whether some fragments of a face may be cut away.
pub fn is_bounded(drawing: &Drawing, face: u32) -> bool {
    drawing.scene.faces()[face as usize].flags & BOUNDED != 0
}

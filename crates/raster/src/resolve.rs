//! What is seen: the fragment program at the places that a technique has found.

use crate::drawing::Drawing;
use crate::rect::{Rect, TILE};
use crate::visibility::{Run, Seen, Visibility};
use gbuffer::Hit;
use glam::DVec3;
use nurbs::Normal;
use pipeline::fragment::{Fragment, fragment, fragment_row};
use pipeline::{Parameters, edge};

/// What a tile shows.
pub struct Tile {
    /// Hits, row × [`TILE`] + column; empty where nothing is seen in it.
    pub hits: Vec<Option<Hit>>,
    /// Pixels (x, y) of the picture in which a search has not converged.
    pub undecided: Vec<(usize, usize)>,
}

/// Draws a tile.
pub fn tile(drawing: &Drawing, visibility: &dyn Visibility, rect: Rect) -> Tile {
    let mut hits = vec![];
    let mut fragments: Vec<Fragment> = vec![];
    let undecided = visibility.tile(rect, &mut |run: &Run| {
        if hits.is_empty() {
            hits = vec![None; TILE * TILE];
        }
        fragment_row(drawing.scene, run.face, &run.places, drawing.options.curvature, &mut fragments);
        for (i, (&pixel, fragment)) in run.pixels.iter().zip(&fragments).enumerate() {
            let (x, y) = rect.position(pixel);
            let at = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            hits[usize::from(pixel)] = Some(hit(drawing, fragment, at, run.normals.get(i).copied()));
        }
        fragments.clear();
    });
    Tile { hits, undecided }
}

/// What is seen at a sample at picture position `at`.
pub fn sample(drawing: &Drawing, seen: &Seen, at: [f64; 2]) -> Hit {
    let fragment = fragment(drawing.scene, seen.face, seen.place, drawing.options.curvature);
    hit(drawing, &fragment, at, seen.normal)
}

/// What is seen at picture position `at`, with the interpolated normal in place of the fragment's where there is one.
fn hit(drawing: &Drawing, fragment: &Fragment, at: [f64; 2], interpolated: Option<[f32; 3]>) -> Hit {
    let edge = if drawing.scene.has_edges() {
        let view = &drawing.views[fragment.face as usize];
        let place = Parameters { span: fragment.span, uv: fragment.uv };
        let whole = drawing.scene.whole(fragment.face, place);
        let edge = edge::edge(drawing.scene, view, fragment.face, whole, at.map(|t| t as f32));
        // As a GPU records it.
        edge::unpacked(edge::packed(edge)).1
    } else {
        None
    };
    let fragment = &Fragment { edge, ..*fragment };
    let mut hit = drawing.scene.hit(fragment, &drawing.camera.ray(drawing.viewport, at[0], at[1]));
    if let Some([x, y, z]) = interpolated {
        let length = (x * x + y * y + z * z).sqrt();
        hit.normal = if length > 0.0 {
            Normal::Regular(DVec3::from_array([x / length, y / length, z / length].map(f64::from)))
        } else {
            Normal::Undefined
        };
    }
    hit
}

//! Where a trim edge passes by a pixel's centre: in f64, from the unsplit loops, in the picture itself.
//!
//! The picture about a point is nearly a linear map of (u, v). The nearest place by the map at the hit is looked for, the
//! map is made anew there, and so on until the place stays; the nearest of all these in the picture itself is the answer.

use crate::trim::{Classifier, PictureMap};
use gbuffer::EDGE_REACH_PX;
use glam::{DMat2, DVec2};
use nurbs::Surface;
use scene::{Camera, Viewport};

/// How far maps look, and how far off by the first one a place may be, pixels: it may come nearer when the map is made anew;
/// what is farther is on another sheet of the surface.
const MAP_REACH_PX: f64 = 2.0 * EDGE_REACH_PX;

/// Maps at most; each squares the error of the last but at a cusp.
const MAPS: usize = 12;

/// A place that moves by less than this has been found, pixels.
const STILL_PX: f64 = 1e-9;

/// The offset from picture position `center` to the nearest place of the trim edges of a face
/// ([`scene::Region::edges`]), pixels, right and down, looked for from parameters `uv` on; `None` where none is within
/// [`EDGE_REACH_PX`], or the face is seen edge-on there.
///
/// No bound where the picture is far from linear over two pixels; elsewhere to 10⁻⁶ pixel.
pub(crate) fn offset(
    classifier: &Classifier,
    surface: &Surface,
    uv: DVec2,
    camera: &Camera,
    viewport: Viewport,
    center: DVec2,
) -> Option<DVec2> {
    let first = map(surface, camera, viewport, center, uv)?;
    let mut next = classifier.nearest_edge(&first, MAP_REACH_PX);
    let mut nearest: Option<DVec2> = None;
    for _ in 0..MAPS {
        let Some(uv) = next.filter(|uv| first.at(*uv).length() <= MAP_REACH_PX) else { break };
        let Some(here) = map(surface, camera, viewport, center, uv) else { break };
        if nearest.is_none_or(|nearest| here.offset.length() < nearest.length()) {
            nearest = Some(here.offset);
        }
        next = classifier.nearest_edge(&here, MAP_REACH_PX);
        if next.is_some_and(|uv| here.at(uv).distance(here.offset) <= STILL_PX) {
            break;
        }
    }
    nearest.filter(|offset| offset.length() <= EDGE_REACH_PX)
}

/// The picture about a point as a linear map; `None` where the point is behind the eye.
fn map(surface: &Surface, camera: &Camera, viewport: Viewport, center: DVec2, uv: DVec2) -> Option<PictureMap> {
    let d = surface.first_derivatives(uv.x, uv.y);
    let offset = camera.picture(viewport, d.s)? - center;
    let along = |derivative| camera.picture_derivative(viewport, d.s, derivative);
    Some(PictureMap { uv, offset, slopes: DMat2::from_cols(along(d.su), along(d.sv)) })
}

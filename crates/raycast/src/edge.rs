//! Where a trim edge passes by a pixel's centre: in f64, from the unsplit loops, in the picture itself.
//!
//! The picture about a point of the edge is nearly a linear map of (u, v). The nearest place by that map is looked for, the
//! map is made anew there, and so on until the place stays: then it is the nearest in the picture and not by a map.

use crate::trim::PictureMap;
use crate::{Caster, Classifier};
use gbuffer::{EDGE_REACH_PX, Hit};
use glam::{DMat2, DVec2};
use nurbs::Surface;
use scene::{Camera, Viewport};

/// How far the first map looks, pixels: the nearest place may come nearer when the map is made anew.
const FIRST_REACH_PX: f64 = 2.0 * EDGE_REACH_PX;

/// Maps at most; each squares the error of the last but at a cusp.
const MAPS: usize = 12;

/// A place that moves by less than this has been found, pixels.
const STILL_PX: f64 = 1e-9;

impl Caster<'_> {
    /// The offset from picture position `center` to the nearest place of the trim edges of a hit's face
    /// ([`scene::Region::edges`]), pixels, right and down; `None` where none is within [`EDGE_REACH_PX`], or the face is
    /// whole, or seen edge-on at the hit.
    ///
    /// No bound where the picture is far from linear over two pixels; elsewhere to 10⁻⁶ pixel.
    pub(crate) fn edge(&self, hit: &Hit, camera: &Camera, viewport: Viewport, center: DVec2) -> Option<DVec2> {
        let classifier = self.classifiers[hit.face.0 as usize].as_ref()?;
        let surface = self.model.surface(hit.face);
        let map = |uv: DVec2| map(surface, camera, viewport, center, uv);
        let (mut uv, mut offset) = step(classifier, &map(hit.uv)?, FIRST_REACH_PX, &map)?;
        for _ in 0..MAPS {
            let (next, next_offset) = step(classifier, &map(uv)?, FIRST_REACH_PX, &map)?;
            let moved = next_offset.distance(offset);
            (uv, offset) = (next, next_offset);
            if moved <= STILL_PX {
                break;
            }
        }
        (offset.length() <= EDGE_REACH_PX).then_some(offset)
    }
}

/// The place that is nearest by a map, and its offset in the picture.
fn step(
    classifier: &Classifier,
    by: &PictureMap,
    reach: f64,
    map: &impl Fn(DVec2) -> Option<PictureMap>,
) -> Option<(DVec2, DVec2)> {
    let uv = classifier.nearest_edge(by, reach)?;
    Some((uv, map(uv)?.offset))
}

/// The picture about a point as a linear map; `None` where the point is behind the eye.
fn map(surface: &Surface, camera: &Camera, viewport: Viewport, center: DVec2, uv: DVec2) -> Option<PictureMap> {
    let d = surface.first_derivatives(uv.x, uv.y);
    let offset = camera.picture(viewport, d.s)? - center;
    let along = |derivative| camera.picture_derivative(viewport, d.s, derivative);
    Some(PictureMap { uv, offset, slopes: DMat2::from_cols(along(d.su), along(d.sv)) })
}

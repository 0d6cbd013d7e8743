//! How far a picture is off: in pixels, in degrees, and at its outlines.

use crate::angles::angle_deg;
use gbuffer::GBuffer;
use scene::{Camera, FaceId};
use serde::Serialize;

/// A pixel and the face that it shows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Place {
    /// (x, y) from the upper left.
    pub pixel: [usize; 2],
    /// The face.
    pub face: FaceId,
}

/// A kind of error over the pixels that have it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Of how many pixels it is known.
    pub pixels: usize,
    /// 99 of 100 are at most this.
    pub percentile_99: f64,
    /// The greatest.
    pub greatest: f64,
    /// Where it is; absent of no pixels.
    pub at: Option<Place>,
}

/// The errors of a picture against the ray caster's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// From a pixel's centre to where the point of the surface at its own (u, v) is seen, pixels.
    pub offset_px: Spread,
    /// Between the normal there and the ray caster's, degrees, where both show one face.
    pub normal_deg: Spread,
    /// Pixels that the ray caster covers and the picture does not.
    pub missing: usize,
    /// Pixels that the picture covers and the ray caster does not.
    pub extra: usize,
    /// Pixels that show another face than the ray caster.
    pub other_face: usize,
}

/// What a spread is made of.
fn spread(mut values: Vec<(f64, Place)>) -> Spread {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let at = |share: f64| values.get(((values.len() as f64 - 1.0) * share) as usize).map_or(0.0, |(value, _)| *value);
    Spread {
        pixels: values.len(),
        percentile_99: at(0.99),
        greatest: at(1.0),
        at: values.last().map(|(_, place)| *place),
    }
}

/// The normals of a picture against the ray caster's.
pub fn normals(picture: &GBuffer, exact: &GBuffer) -> Spread {
    let width = picture.viewport().width();
    let angle = |(k, (a, b)): (usize, (Option<&gbuffer::Hit>, Option<&gbuffer::Hit>))| {
        let a = a?;
        Some((angle_deg(a, b?)?, Place { pixel: [k % width, k / width], face: a.face }))
    };
    spread(picture.pixels().zip(exact.pixels()).enumerate().filter_map(angle).collect())
}

/// All errors of a picture of the same size and camera as `exact`.
pub fn errors(picture: &GBuffer, exact: &GBuffer, camera: &Camera) -> Errors {
    let viewport = picture.viewport();
    let (mut missing, mut extra, mut other_face, mut offsets) = (0, 0, 0, vec![]);
    for (k, pair) in picture.pixels().zip(exact.pixels()).enumerate() {
        let pixel = [k % viewport.width(), k / viewport.width()];
        match pair {
            (None, Some(_)) => missing += 1,
            (Some(_), None) => extra += 1,
            (Some(a), Some(b)) if a.face != b.face => other_face += 1,
            _ => {}
        }
        if let (Some(hit), _) = pair
            && let Some(seen) = camera.picture(viewport, hit.position)
        {
            let off = (seen.x - pixel[0] as f64 - 0.5).hypot(seen.y - pixel[1] as f64 - 0.5);
            offsets.push((off, Place { pixel, face: hit.face }));
        }
    }
    Errors { offset_px: spread(offsets), normal_deg: normals(picture, exact), missing, extra, other_face }
}

//! A path in a surface's own parameters as a spline in those of its patch, within a distance that is measured on the surface.

use super::inverse::Inverter;
use super::patch::Patch;
use super::path::Path;
use glam::DVec2;
use nurbs::{Halving, KnotVector, NurbsError, QUINTIC, Quintics, quintics};
use scene::Trim;

/// Halvings of one part.
const HALVINGS: u32 = 12;

/// The most parts of one path.
const MOST_PARTS: usize = 4096;

/// What is fitted is fitted to this share of the file's tolerance, and not coarser or finer than these shares of its size.
const FIT: f64 = 0.01;
const COARSEST_FIT: f64 = 1e-8;
const FINEST_FIT: f64 = 1e-10;

/// The distance within which what has that size is fitted in a file of that tolerance.
pub(crate) fn fitting(tolerance: f64, size: f64) -> f64 {
    (FIT * tolerance).clamp(FINEST_FIT * size, COARSEST_FIT * size)
}

/// How far a curve or a surface in the file's place may be from it where halving does not come as near as is tried: the file's
/// tolerance, or the coarsest fit.
pub(crate) fn acceptable(tolerance: f64, size: f64) -> f64 {
    tolerance.max(COARSEST_FIT * size)
}

/// A trim, and how far from the path it was found to be, model units.
pub(crate) struct Fitted {
    pub trim: Trim,
    pub error: f64,
}

/// The trim of a path within `tolerance`, model units along the surface; where halving does not reach it, as near as it
/// comes.
///
/// # Errors
/// Where parameters are not finite.
pub(crate) fn fit(path: &Path, inverter: &Inverter, patch: &Patch, tolerance: f64) -> Result<Fitted, NurbsError> {
    if path.iso.is_some() {
        let [start, end] = path.ends().map(|uv| patch.parameters(uv));
        let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0])?;
        return Ok(Fitted { trim: Trim::new(knots, vec![start, end], None), error: path.straightened });
    }
    let at = |s: f64| patch.parameters(path.at(inverter, s, tolerance));
    let point = |uv: DVec2| patch.surface.point(uv.x, uv.y);
    let off = |a: DVec2, b: DVec2| point(a).distance(point(b));
    let halving = Halving { tolerance, depth: HALVINGS, parts: MOST_PARTS };
    let Quintics { knots, points, error } = quintics(&path.breaks(), at, off, halving);
    Ok(Fitted { trim: Trim::new(KnotVector::new(QUINTIC, knots)?, points, None), error })
}

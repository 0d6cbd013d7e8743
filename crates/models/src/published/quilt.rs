//! Quilts: a family of models by the number of their patches, which fill one picture alike.

use crate::construction::{clamped, surface};
use glam::DVec3;
use libm::{cos, sin};
use nurbs::Surface;

/// Names of the quilts, and of how many patches along x and along y each is sewn.
pub const QUILTS: &[(&str, [usize; 2])] = &[
    ("quilt-100", [10, 10]),
    ("quilt-300", [20, 15]),
    ("quilt-1000", [40, 25]),
    ("quilt-3000", [60, 50]),
    ("quilt-10000", [100, 100]),
    ("quilt-30000", [200, 150]),
    ("quilt-100000", [400, 250]),
];

/// How far a patch is stuffed, in its own lengths.
const STUFFING: f64 = 0.35;

/// A rolling sheet of 2 × 1.5, in bicubic Bézier patches that are each a face and share their borders to the bit; each is
/// puffed up inside, so that a crease runs along every seam.
pub(super) fn quilt([columns, rows]: [usize; 2]) -> Vec<Surface> {
    let sheet = |x: f64, y: f64| DVec3::new(2.0 * x, 1.5 * y, 0.16 * sin(5.0 * x + 1.0) * cos(4.0 * y));
    let puff = STUFFING * (2.0 / columns as f64).min(1.5 / rows as f64);
    let patch = |k: usize| {
        let (i, j) = (k / rows, k % rows);
        // A point of the border has the same numbers whichever patch asks.
        let at = |a: usize, b: usize| {
            sheet((3 * i + a) as f64 / (3 * columns) as f64, (3 * j + b) as f64 / (3 * rows) as f64)
        };
        let control = |l: usize| {
            let (a, b) = (l / 4, l % 4);
            let inside = (1..3).contains(&a) && (1..3).contains(&b);
            at(a, b) + if inside { DVec3::Z * puff } else { DVec3::ZERO }
        };
        surface(clamped(3, &[]), clamped(3, &[]), (0..16).map(control).collect(), None)
    };
    (0..columns * rows).map(patch).collect()
}

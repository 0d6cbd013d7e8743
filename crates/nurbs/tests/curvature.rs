//! Curvatures where one principal curvature is far greater than the other.

use glam::DVec3;
use nurbs::{KnotVector, Surface};

/// z = ½ (a x² + c y²) over |x| ≤ 1, |y| ≤ 2⁻¹⁷: its principal curvatures at the origin are a and c.
fn paraboloid(a: f64, c: f64) -> Surface {
    let knots = KnotVector::new(2, vec![-1.0, -1.0, -1.0, 1.0, 1.0, 1.0]).unwrap();
    // x² in Bernstein form over -1 to 1 is 1, -1, 1.
    let (at, square) = ([-1.0, 0.0, 1.0], [1.0, -1.0, 1.0]);
    let point = |k: usize| {
        let (x, y) = (k / 3, k % 3);
        DVec3::new(at[x], at[y] / 131072.0, 0.5 * (a * square[x] + c * square[y] / 17179869184.0))
    };
    Surface::new(knots.clone(), knots, (0..9).map(point).collect(), None).unwrap()
}

#[test]
fn the_smaller_curvature_does_not_cancel() {
    for (a, c) in
        [(1.01, -3.7e10), (1.01, 3.7e10), (-1.01, 3.7e10), (-1.01, -3.7e10), (0.0, 2.0), (-3.0, 0.0), (2.0, 2.0)]
    {
        let k = paraboloid(a, c).inspect(0.0, 0.0).curvature.unwrap();
        for (found, expected) in [(k.k1, f64::max(a, c)), (k.k2, f64::min(a, c))] {
            assert!((found - expected).abs() <= 1e-14 * expected.abs(), "{a} and {c}: {found}");
        }
    }
}

//! A path in a surface's own parameters as a spline in those of its patch, within a distance that is measured.
//!
//! Each part of the path is interpolated by a quintic at six nodes, and measured between them on the surface; where it
//! is too far off, the part is halved. Parts meet with their ends, and no smoother: a trim needs no more.

use super::inverse::Inverter;
use super::patch::Patch;
use super::path::Path;
use glam::DVec2;
use nurbs::{KnotVector, NurbsError};
use scene::Trim;

/// Degree of the interpolation.
const DEGREE: usize = 5;

/// Lobatto's nodes on 0 to 1, ½ − ½ cos(k π / 5): interpolation there is nearly as good as the best of its degree.
const NODES: [f64; 6] = [0.0, 0.095491502812526, 0.345491502812526, 0.654508497187474, 0.904508497187474, 1.0];

/// Halvings of one part.
const HALVINGS: u32 = 12;

/// The most parts of one path.
const MOST_PARTS: usize = 4096;

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
        return Ok(Fitted { trim: Trim::new(knots, vec![start, end], None), error: 0.0 });
    }
    let at = |s: f64| patch.parameters(path.at(inverter, s, tolerance));
    let point = |uv: DVec2| patch.surface.point(uv.x, uv.y);
    let to_bezier = to_bezier();
    let mut error: f64 = 0.0;
    let (mut knots, mut points) = (vec![0.0; DEGREE + 1], vec![]);
    let mut waiting: Vec<(f64, f64, u32)> = path.breaks().windows(2).rev().map(|w| (w[0], w[1], HALVINGS)).collect();
    while let Some((a, b, halvings)) = waiting.pop() {
        let values = NODES.map(|x| at(if x == 1.0 { b } else { a + (b - a) * x }));
        let control: [DVec2; 6] = std::array::from_fn(|i| (0..=DEGREE).map(|j| values[j] * to_bezier[i][j]).sum());
        let between = (0..DEGREE).map(|k| 0.5 * (NODES[k] + NODES[k + 1]));
        let off = |x: f64| point(bezier(&control, x)).distance(point(at(a + (b - a) * x)));
        let worst = between.map(off).fold(0.0, f64::max);
        let room = knots.len() / DEGREE + waiting.len() < MOST_PARTS;
        if tolerance < worst && 0 < halvings && room {
            let middle = 0.5 * (a + b);
            waiting.extend([(middle, b, halvings - 1), (a, middle, halvings - 1)]);
            continue;
        }
        error = error.max(worst);
        points.pop();
        points.extend([values[0], control[1], control[2], control[3], control[4], values[DEGREE]]);
        knots.extend([b; DEGREE]);
    }
    knots.push(1.0);
    Ok(Fitted { trim: Trim::new(KnotVector::new(DEGREE, knots)?, points, None), error })
}

fn bezier(control: &[DVec2; 6], x: f64) -> DVec2 {
    let mut d = *control;
    for r in 1..=DEGREE {
        for i in 0..=DEGREE - r {
            d[i] = d[i].lerp(d[i + 1], x);
        }
    }
    d[0]
}

/// The matrix from values at [`NODES`] to Bézier points: the inverse of Bernstein's polynomials there.
fn to_bezier() -> [[f64; 6]; 6] {
    const BINOMIAL: [f64; 6] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    let basis = |x: f64, i: usize| BINOMIAL[i] * x.powi(i as i32) * (1.0 - x).powi((DEGREE - i) as i32);
    // Gauss and Jordan, with the unit matrix beside; Bernstein's matrix is totally positive, so that no pivot is zero.
    let mut rows: [[f64; 12]; 6] = std::array::from_fn(|j| {
        std::array::from_fn(|i| if i < 6 { basis(NODES[j], i) } else { f64::from(u8::from(i == j + 6)) })
    });
    for k in 0..6 {
        let pivot = rows[k][k];
        rows[k].iter_mut().for_each(|x| *x /= pivot);
        for j in 0..6 {
            if j != k {
                let factor = rows[j][k];
                let row = rows[k];
                rows[j].iter_mut().zip(row).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    rows.map(|row| std::array::from_fn(|i| row[i + 6]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quintic_is_interpolated_by_itself() {
        let control =
            [[0.0, 1.0], [2.0, -1.0], [0.5, 0.25], [3.0, 7.0], [-1.0, 0.0], [1.0, 1.0]].map(DVec2::from_array);
        let values = NODES.map(|x| bezier(&control, x));
        for (row, expected) in to_bezier().iter().zip(control) {
            let found: DVec2 = row.iter().zip(values).map(|(m, v)| v * *m).sum();
            assert!(found.distance(expected) < 1e-13, "{found} {expected}");
        }
    }
}

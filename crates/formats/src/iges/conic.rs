//! Conic arcs (104): from the six coefficients of an implicit curve to one with axes and a parameter.

use crate::brep::curve::Curve;
use crate::brep::frame::Frame;
use crate::brep::path::Piece;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// A determinant below this share of the product of its terms is zero: the curve is a parabola.
const FLAT: f64 = 1e-12;

/// A x² + B x y + C y² + D x + E y + F = 0 at height z, from a start to an end: the eleven parameters of the entity in order.
///
/// An ellipse runs counter-clockwise, and whole where start and end are the same. `None` where the coefficients make no
/// curve with an inside, or where the curve has no length.
pub(super) fn conic(values: &[f64]) -> Option<Piece> {
    let &[a, b, c, d, e, f, z, x1, y1, x2, y2] = values else { return None };
    let (start, end) = (DVec2::new(x1, y1), DVec2::new(x2, y2));
    // The directions in which the quadratic form is its own, the greater part first.
    let angle = 0.5 * libm::atan2(b, a - c);
    let first = DVec2::from_angle(angle);
    let form = |v: DVec2| a * v.x * v.x + b * v.x * v.y + c * v.y * v.y;
    let axes = [first, first.perp()];
    let parts = axes.map(form);
    let linear = axes.map(|axis| DVec2::new(d, e).dot(axis));
    let frame = |origin: DVec2, x: DVec2, y: DVec2| {
        let (x, y) = (x.extend(0.0), y.extend(0.0));
        let z_axis = x.cross(y);
        let origin = origin.extend(z);
        origin.is_finite().then_some(Frame { origin, x, y, z: z_axis })
    };
    let greatest = a.abs().max(b.abs()).max(c.abs());
    if parts[0].abs().min(parts[1].abs()) <= FLAT * greatest {
        let (along, across) = if parts[0].abs() < parts[1].abs() { (0, 1) } else { (1, 0) };
        return parabola(
            [axes[along], axes[across]],
            parts[across],
            [linear[along], linear[across]],
            f,
            frame,
            start,
            end,
        );
    }
    // About its centre, the curve is Σ partsᵢ xᵢ² = level.
    let center = [0, 1].map(|i| -linear[i] / (2.0 * parts[i]));
    let level = parts[0] * center[0] * center[0] + parts[1] * center[1] * center[1] - f;
    let origin = axes[0] * center[0] + axes[1] * center[1];
    let squares = parts.map(|part| level / part);
    let radius = |square: f64| square.abs().sqrt();
    if 0.0 < squares[0] && 0.0 < squares[1] {
        let radii = DVec2::new(radius(squares[0]), radius(squares[1]));
        let curve = Curve::Ellipse { frame: frame(origin, axes[0], axes[1])?, radii };
        let from = curve.parameter(start.extend(z));
        let mut to = if start == end { from } else { curve.parameter(end.extend(z)) };
        if to <= from {
            to += TAU;
        }
        return piece(curve, [from, to]);
    }
    let real = usize::from(squares[0] <= 0.0);
    if squares[real] <= 0.0 {
        return None;
    }
    let toward = if (start - origin).dot(axes[real]) < 0.0 { -axes[real] } else { axes[real] };
    let radii = DVec2::new(radius(squares[real]), radius(squares[1 - real]));
    forward(start.extend(z), end.extend(z), axes[1 - real], |y| {
        Some(Curve::Hyperbola { frame: frame(origin, toward, y)?, radii })
    })
}

/// part y² + linear\[0\] x + linear\[1\] y + f = 0 along two axes.
fn parabola(
    [along, across]: [DVec2; 2],
    part: f64,
    linear: [f64; 2],
    f: f64,
    frame: impl Fn(DVec2, DVec2, DVec2) -> Option<Frame>,
    start: DVec2,
    end: DVec2,
) -> Option<Piece> {
    let y = -linear[1] / (2.0 * part);
    let x = -(f - part * y * y) / linear[0];
    // x = bend y² about the vertex.
    let bend = -part / linear[0];
    let toward = if bend < 0.0 { -along } else { along };
    let origin = along * x + across * y;
    let focal = 0.25 / bend.abs();
    let height = frame(origin, toward, across)?.origin.z;
    forward(start.extend(height), end.extend(height), across, |y| {
        (0.0 < focal && focal.is_finite()).then_some(Curve::Parabola { frame: frame(origin, toward, y)?, focal })
    })
}

/// An open conic from a start to an end, with the axis across it turned so that it runs forwards.
fn forward(start: DVec3, end: DVec3, across: DVec2, curve: impl Fn(DVec2) -> Option<Curve>) -> Option<Piece> {
    let own = curve(across)?;
    let range = [own.parameter(start), own.parameter(end)];
    if range[0] < range[1] { piece(own, range) } else { piece(curve(-across)?, range.map(|t| -t)) }
}

fn piece(curve: Curve, range: [f64; 2]) -> Option<Piece> {
    let is_run = range[0] < range[1] && curve.point(range[0]).is_finite() && curve.point(range[1]).is_finite();
    is_run.then_some(Piece { curve, range })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A conic that was turned and moved: every point satisfies its equation, and its ends are start and end.
    #[test]
    fn points_satisfy_the_equation() {
        let (turn, shift) = (DVec2::from_angle(0.4), DVec2::new(2.0, -1.0));
        // Along own axes: x²/9 + y²/4 = 1, x²/9 − y²/4 = 1, y² = 8 x, each from one own point to another.
        type Own = fn(f64) -> DVec2;
        let cases: [([f64; 4], Own); 3] = [
            ([1.0 / 9.0, 0.25, 0.0, -1.0], |t| DVec2::new(3.0 * t.cos(), 2.0 * t.sin())),
            ([1.0 / 9.0, -0.25, 0.0, -1.0], |t| DVec2::new(-3.0 * t.cosh(), 2.0 * t.sinh())),
            ([0.0, 1.0, -8.0, 0.0], |t| DVec2::new(2.0 * t * t, 4.0 * t)),
        ];
        for ([p, q, l, f], point) in cases {
            // p x'² + q y'² + l x' + f with x' = turnᵀ (x − shift).
            let (c, s) = (turn.x, turn.y);
            let (a, b, cc) = (p * c * c + q * s * s, 2.0 * (p - q) * c * s, p * s * s + q * c * c);
            let (d0, e0) = (l * c, l * s);
            let (d, e) = (d0 - 2.0 * a * shift.x - b * shift.y, e0 - 2.0 * cc * shift.y - b * shift.x);
            let ff = f - d0 * shift.x - e0 * shift.y
                + a * shift.x * shift.x
                + b * shift.x * shift.y
                + cc * shift.y * shift.y;
            for [t0, t1] in [[-0.5, 1.2], [1.2, 0.1]] {
                let [start, end] = [t0, t1].map(|t| turn.rotate(point(t)) + shift);
                let piece = conic(&[a, b, cc, d, e, ff, 5.0, start.x, start.y, end.x, end.y]).unwrap();
                assert!(piece.point(0.0).distance(start.extend(5.0)) < 1e-13, "{piece:?}");
                assert!(piece.point(1.0).distance(end.extend(5.0)) < 1e-13, "{piece:?}");
                for k in 0..=20 {
                    let x = piece.point(f64::from(k) / 20.0);
                    let value = a * x.x * x.x + b * x.x * x.y + cc * x.y * x.y + d * x.x + e * x.y + ff;
                    assert!(value.abs() < 1e-12, "{value}");
                }
            }
        }
        assert_eq!(
            conic(&[1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0]).map(|_| ()),
            None,
            "an empty ellipse"
        );
    }
}

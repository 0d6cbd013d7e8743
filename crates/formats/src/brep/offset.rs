//! Surfaces at a distance from others along S_u × S_v, with the same parameters (ISO 10303-42, `offset_surface`).
//!
//! Exact where that is a surface of the same kind. A swept curve stays swept, with a curve beside it ([`parallel`]), and a
//! spline becomes a net of quintics ([`net`]). How far these are off is proven, or else measured.
//!
//! [`parallel`]: super::parallel
//! [`net`]: super::net

use super::across::{Across, Ramp};
use super::curve::Curve;
use super::effort::Effort;
use super::fit::{acceptable, fitting};
use super::frame::Frame;
use super::net::net;
use super::off::Off;
use super::parallel::{Offset, OffsetError, along};
use super::shape::{Profile, Shape};

/// How many control points an offset has: halving may make many of one.
pub(crate) fn size(shape: &Shape) -> usize {
    match shape {
        Shape::Spline { surface, .. } => surface.points().len(),
        _ => 1,
    }
}

/// The surface at `distance` along S_u × S_v; `tolerance` is the file's. `ends` are those of its parameters, where the file says them.
///
/// # Errors
/// Each of [`OffsetError`].
pub(crate) fn offset(
    shape: &Shape,
    distance: f64,
    ends: Option<[[f64; 2]; 2]>,
    tolerance: f64,
    effort: &Effort,
) -> Result<Offset<Shape>, OffsetError> {
    let exact = |made: Shape| Offset { made, off: Off::default() };
    let even = Ramp::even(distance);
    match shape {
        Shape::Plane(frame) => Ok(exact(Shape::Plane(Frame { origin: frame.origin + frame.z * distance, ..*frame }))),
        Shape::Revolved { frame, profile: Profile::Curve(curve) } => {
            let Offset { made, off } =
                along(curve, &Across::Outward(*frame), even, ends.map(|[_, v]| v), tolerance, effort)?;
            Ok(Offset { made: Shape::Revolved { frame: *frame, profile: Profile::Curve(made) }, off })
        }
        Shape::Revolved { frame, profile } => {
            let (frame, profile) = revolved(frame, profile, distance).ok_or(OffsetError::Nothing)?;
            Ok(exact(Shape::Revolved { frame, profile }))
        }
        Shape::Extruded { curve, vector } => {
            let across = Across::Beside(*vector);
            let Offset { made, off } = match curve {
                Curve::Line { origin, direction } => {
                    let by = across.unit(curve, 0.0).ok_or(OffsetError::NoDirection(0.0))? * distance;
                    Offset { made: Curve::Line { origin: *origin + by, direction: *direction }, off: Off::default() }
                }
                curve => along(curve, &across, even, ends.map(|[u, _]| u), tolerance, effort)?,
            };
            Ok(Offset { made: Shape::Extruded { curve: made, vector: *vector }, off })
        }
        Shape::Spline { surface, closed } => {
            let size = surface.hull().diagonal().max(distance.abs());
            let within = [fitting(tolerance, size), acceptable(tolerance, size)];
            let Offset { made, off } = net(surface, distance, within, effort)?;
            Ok(Offset { made: Shape::Spline { surface: made, closed: *closed }, off })
        }
    }
}

/// What turns at a distance from a line or an arc that turns; `None` where that is none.
fn revolved(frame: &Frame, profile: &Profile, distance: f64) -> Option<(Frame, Profile)> {
    match profile {
        Profile::Line { radius, slope } => {
            // The normal is across the line, outward: (cos φ, −sin φ) for slope tan φ.
            let [sin, cos] = [slope / slope.hypot(1.0), slope.hypot(1.0).recip()];
            let origin = frame.origin - frame.z * (distance * sin);
            let radius = radius + distance * cos;
            let profile = Profile::Line { radius, slope: *slope };
            (0.0 < radius || *slope != 0.0).then_some((Frame { origin, ..*frame }, profile))
        }
        Profile::Arc { major, minor, range, is_closed } => {
            let minor = minor + distance;
            let profile = Profile::Arc { major: *major, minor, range: *range, is_closed: *is_closed };
            (0.0 < minor && (minor < *major || !is_closed)).then_some((*frame, profile))
        }
        Profile::Curve(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};
    use nurbs::{KnotVector, SpaceCurve, Surface};

    const DISTANCE: f64 = 0.25;
    const TOLERANCE: f64 = 1e-6;

    /// How far an offset is from where differences say, at places of a rectangle.
    fn farthest(shape: &Shape, made: &Shape, [[u0, u1], [v0, v1]]: [[f64; 2]; 2]) -> f64 {
        let off = |k: usize| {
            let [a, b] = [(k % 8) as f64 / 8.0 + 0.05, (k / 8) as f64 / 8.0 + 0.05];
            let uv = DVec2::new(u0 + (u1 - u0) * a, v0 + (v1 - v0) * b);
            let d = |du: f64, dv: f64| shape.point(uv + DVec2::new(du, dv));
            const H: f64 = 1e-5;
            let normal = (d(H, 0.0) - d(-H, 0.0)).cross(d(0.0, H) - d(0.0, -H)).normalize();
            made.point(uv).distance(shape.point(uv) + DISTANCE * normal)
        };
        (0..64).map(off).fold(0.0, f64::max)
    }

    fn frame() -> Frame {
        Frame::new(DVec3::new(1.0, 2.0, 3.0), Some(DVec3::new(1.0, 1.0, 2.0)), Some(DVec3::Y)).unwrap()
    }

    fn spline(points: [[f64; 3]; 5]) -> Curve {
        let knots = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.4, 1.0, 1.0, 1.0, 1.0]).unwrap();
        Curve::spline(SpaceCurve::new(knots, &points.map(DVec3::from_array), None).unwrap(), TOLERANCE)
    }

    /// A rational surface of several spans, with nothing straight in it.
    fn wave() -> Surface {
        let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0]).unwrap();
        let at = |k: usize| {
            let (i, j) = ((k / 4) as f64, (k % 4) as f64);
            DVec3::new(2.0 * i, 2.0 * j + 0.3 * (i * j).sin(), (1.3 * i + 0.7 * j).sin())
        };
        let weights = (0..16).map(|k| 1.0 + 0.2 * f64::from(k % 3)).collect();
        Surface::new(knots.clone(), knots, (0..16).map(at).collect(), Some(weights)).unwrap()
    }

    #[test]
    fn an_offset_is_that_far_along_the_normal() {
        let frame = frame();
        let revolved = |profile| Shape::Revolved { frame, profile };
        let line = |radius, slope| revolved(Profile::Line { radius, slope });
        let round = [Profile::sphere(2.0), Profile::torus(3.0, 1.0, true), Profile::torus(1.0, 2.0, true)];
        let round = round.map(revolved);
        let straight = Curve::Line { origin: DVec3::X, direction: DVec3::new(1.0, 2.0, 0.0) };
        let plane = Shape::Extruded { curve: straight, vector: DVec3::new(0.0, 1.0, 3.0) };
        for shape in [Shape::Plane(frame), line(2.0, 0.0), line(2.0, -0.5), plane].iter().chain(&round) {
            let Offset { made, off } = offset(shape, DISTANCE, None, TOLERANCE, &Effort::new(0)).unwrap();
            assert!(off.most == 0.0 && farthest(shape, &made, [[0.1, 5.0], [-0.9, 0.6]]) < 1e-9, "{shape:?}");
        }
    }

    #[test]
    fn an_offset_of_splines_is_as_near_as_it_says() {
        let vector = DVec3::new(0.3, 0.0, 2.0);
        let flat = spline([[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [3.0, 2.0, 0.5], [4.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
        let ellipse = Curve::Ellipse { frame: frame(), radii: DVec2::new(3.0, 1.0) };
        let meridian = spline([[3.0, 0.0, 0.0], [4.0, 0.0, 1.0], [2.0, 0.0, 2.0], [3.0, 0.0, 3.0], [1.0, 0.0, 4.0]]);
        let about = Frame::new(DVec3::ZERO, None, None).unwrap();
        let shapes = [
            Shape::Extruded { curve: flat, vector },
            Shape::Extruded { curve: ellipse, vector: frame().z },
            Shape::Revolved { frame: about, profile: Profile::Curve(meridian) },
            Shape::spline(wave(), TOLERANCE),
        ];
        for shape in shapes {
            let Offset { made, off } = offset(&shape, DISTANCE, None, TOLERANCE, &Effort::new(0)).unwrap();
            let rectangle = shape.natural().map(|[a, b]| if a.is_finite() { [a, b] } else { [0.0, 1.0] });
            let found = farthest(&shape, &made, rectangle);
            // Differences of 1e-5 are good to 1e-9.
            assert!(0.0 < off.most && off.most <= 1e-6 && found <= off.most + 2e-9, "{off:?} {found:e} {shape:?}");
            // How far the last one turns is not known closely enough.
            assert_eq!(off.is_measured, matches!(shape, Shape::Spline { .. }), "{shape:?}");
        }
    }

    /// Where the file's tolerance is finer than halving comes, the offset is as near as the coarsest fit asks.
    #[test]
    fn an_offset_of_waves_is_made_though_not_as_near_as_is_tried() {
        let knots = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0]).unwrap();
        let at = |k: usize| DVec3::new((k / 6) as f64, (k % 6) as f64, 0.75 * ((7 * k) as f64).sin());
        let waves = Surface::new(knots.clone(), knots, (0..36).map(at).collect(), None).unwrap();
        let (size, shape) = (waves.hull().diagonal(), Shape::spline(waves, 0.0));
        let Offset { made, off } = offset(&shape, DISTANCE, None, 0.0, &Effort::new(0)).unwrap();
        let found = farthest(&shape, &made, shape.natural());
        assert!(fitting(0.0, size) < off.most, "{off:?}");
        assert!(off.most <= 1e-8 * size && found <= off.most + 2e-9, "{off:?} {found:e}");
    }

    /// A surface that turns gently, and whose offset is known at 10,000 places by differences.
    #[test]
    fn an_offset_of_a_gentle_surface_is_proven_to_be_near() {
        let knots = || KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).unwrap();
        let at = |k: usize| DVec3::new((k / 3) as f64, (k % 3) as f64, 0.1 * ((k * k) as f64).sin());
        let shape = Shape::spline(Surface::new(knots(), knots(), (0..9).map(at).collect(), None).unwrap(), TOLERANCE);
        let Offset { made, off } = offset(&shape, DISTANCE, None, TOLERANCE, &Effort::new(0)).unwrap();
        let found = farthest(&shape, &made, shape.natural());
        assert!(!off.is_measured && off.most <= 1e-6 && found <= off.most + 2e-9, "{off:?} {found:e}");
    }

    /// A dome's profile comes to the axis; its offset does, too.
    #[test]
    fn the_offset_of_a_dome_meets_the_axis() {
        let dome = spline([[2.0, 0.0, 0.0], [2.0, 0.0, 1.0], [1.5, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 0.0, 2.0]]);
        let about = Frame::new(DVec3::ZERO, None, None).unwrap();
        let shape = Shape::Revolved { frame: about, profile: Profile::Curve(dome) };
        let Offset { made, .. } = offset(&shape, DISTANCE, None, TOLERANCE, &Effort::new(0)).unwrap();
        assert!(made.point(DVec2::new(0.3, 1.0)).distance(DVec3::new(0.0, 0.0, 2.0 + DISTANCE)) < 1e-9);
    }

    #[test]
    fn what_has_no_offset_is_an_error() {
        let line = Curve::Line { origin: DVec3::X, direction: DVec3::new(0.0, 1.0, 1.0) };
        let endless = Shape::Revolved { frame: frame(), profile: Profile::Curve(line) };
        assert!(matches!(offset(&endless, 1.0, None, TOLERANCE, &Effort::new(0)), Err(OffsetError::Endless)));
        let ball = Shape::Revolved { frame: frame(), profile: Profile::sphere(1.0) };
        assert!(matches!(offset(&ball, -1.5, None, TOLERANCE, &Effort::new(0)), Err(OffsetError::Nothing)));
        // A roof: its normals differ along the ridge.
        let knots = |inner: &[f64]| KnotVector::new(1, [&[0.0, 0.0], inner, &[1.0, 1.0]].concat()).unwrap();
        let row = |i: usize, z: f64| [0.0, 1.0].map(|y| DVec3::new(i as f64, y, z));
        let roof = [row(0, 0.0), row(1, 1.0), row(2, 0.0)].concat();
        let roof = Surface::new(knots(&[0.5]), knots(&[]), roof, None).unwrap();
        let error = offset(&Shape::spline(roof, TOLERANCE), 0.1, None, TOLERANCE, &Effort::new(0)).unwrap_err();
        assert!(matches!(error, OffsetError::Rough { off, .. } if 0.01 < off), "{error}");
        let point = Surface::new(knots(&[]), knots(&[]), vec![DVec3::X; 4], None).unwrap();
        let error =
            offset(&Shape::Spline { surface: point, closed: [false; 2] }, 0.1, None, TOLERANCE, &Effort::new(0))
                .unwrap_err();
        assert!(matches!(error, OffsetError::NoNormal(..)), "{error}");
    }
}

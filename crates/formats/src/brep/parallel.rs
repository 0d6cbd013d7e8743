//! Curves at a distance from others, with the same parameters (ISO 10303-42, `offset_curve_3d`).
//!
//! Lines and arcs stay what they are. All others are interpolated by quintics, within a distance that is proven ([`bound`]), or else
//! measured.
//!
//! [`bound`]: super::bound

use super::across::{Across, Ramp};
use super::bound::curve_bound;
use super::curve::Curve;
use super::effort::{BOUND, Effort, Spent};
use super::fit::{acceptable, fitting};
use super::off::{Interpolated, Off, nearest};
use glam::{DVec2, DVec3};
use nurbs::{Halving, KnotVector, NurbsError, QUINTIC, Quintics, SpaceCurve, quintics};
use std::cell::Cell;

/// Halvings of one part, and the most parts, of a curve.
const HALVINGS: u32 = 12;
const MOST_PARTS: usize = 4096;

/// The sine of an angle below which two directions are one.
const PARALLEL: f64 = 1e-9;

/// What stands at a distance from something.
#[derive(Debug)]
pub(crate) struct Offset<T> {
    pub made: T,
    /// How far it is off; 0 where it is exact.
    pub off: Off,
}

/// Why nothing is made at a distance.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum OffsetError {
    #[error("at that distance nothing is left of it, or it meets itself")]
    Nothing,
    #[error("what it is the offset of has no ends")]
    Endless,
    #[error("what it is the offset of has no direction across at parameter {0}")]
    NoDirection(f64),
    #[error("what it is the offset of has no normal at ({0}, {1})")]
    NoNormal(f64, f64),
    #[error(
        "it comes no nearer to what it should be than {off:.1e}, above {tolerance:.1e}: what it is the offset of has a crease, or too many parts"
    )]
    Rough { off: f64, tolerance: f64 },
    #[error("{0}")]
    Costly(#[from] Spent),
    #[error("{0}")]
    Nurbs(#[from] NurbsError),
}

/// The curve at a distance along `reference` × T, T being its tangent; `tolerance` is the file's. `range` are the curve's ends where
/// it has none of its own.
///
/// # Errors
/// Each of [`OffsetError`] but [`OffsetError::NoNormal`].
pub(crate) fn sideways(
    curve: &Curve,
    reference: DVec3,
    ramp: Ramp,
    range: Option<[f64; 2]>,
    tolerance: f64,
    effort: &Effort,
) -> Result<Offset<Curve>, OffsetError> {
    let across = Across::Beside(-reference);
    match curve {
        Curve::Line { origin, direction } => {
            let across = across.unit(curve, 0.0).ok_or(OffsetError::NoDirection(0.0))?;
            let (origin, direction) = (origin + across * ramp.start, direction + across * ramp.slope);
            Ok(Offset { made: Curve::Line { origin, direction }, off: Off::default() })
        }
        Curve::Ellipse { frame, radii }
            if radii.x == radii.y
                && ramp.slope == 0.0
                && reference.cross(frame.z).length() <= PARALLEL * reference.length() =>
        {
            let radius = radii.x - ramp.start * reference.dot(frame.z).signum();
            let made = Curve::Ellipse { frame: *frame, radii: DVec2::splat(radius) };
            if 0.0 < radius { Ok(Offset { made, off: Off::default() }) } else { Err(OffsetError::Nothing) }
        }
        curve => along(curve, &across, ramp, range, tolerance, effort),
    }
}

/// The curve at a distance across; `range` are its ends where it has none of its own.
///
/// # Errors
/// As [`sideways`].
pub(crate) fn along(
    curve: &Curve,
    across: &Across,
    ramp: Ramp,
    range: Option<[f64; 2]>,
    tolerance: f64,
    effort: &Effort,
) -> Result<Offset<Curve>, OffsetError> {
    let whole = curve.domain().or(curve.period().map(|period| [0.0, period]));
    let range = whole.or(range).ok_or(OffsetError::Endless)?;
    let [start, end] = range;
    let (lost, spent) = (Cell::new(None), Cell::new(Ok(())));
    let at = |t: f64| {
        if let Err(no_more) = effort.spend(1) {
            spent.set(Err(no_more));
            return curve.point(t);
        }
        let across = across.unit(curve, t);
        if across.is_none() {
            lost.set(Some(t));
        }
        curve.point(t) + across.unwrap_or(DVec3::ZERO) * ramp.at(t)
    };
    let breaks: Vec<f64> = [start].into_iter().chain(curve.breaks(range)).chain([end]).collect();
    let size = nurbs::Hull::of(breaks.iter().map(|t| curve.point(*t))).diagonal();
    let size = size.max(ramp.at(start).abs());
    let most = acceptable(tolerance, size);
    let (made, off) = nearest(most, |share| {
        let halving = Halving { tolerance: share * fitting(tolerance, size), depth: HALVINGS, parts: MOST_PARTS };
        let Quintics { knots, points, error } = quintics(&breaks, at, |a, b| a.distance(b), halving);
        spent.get()?;
        if let Some(t) = lost.get() {
            return Err(OffsetError::NoDirection(t));
        }
        if most < error {
            return Err(OffsetError::Rough { off: error, tolerance: most });
        }
        let ends: Vec<f64> = knots[QUINTIC..knots.len() - QUINTIC].iter().step_by(QUINTIC).copied().collect();
        effort.spend(BOUND * ends.len())?;
        let mut bounds = ends.windows(2).map(|part| curve_bound(curve, [part[0], part[1]], across, ramp));
        let bound = bounds.try_fold(0.0f64, |most, bound| Some(most.max(bound?)));
        let spline = SpaceCurve::new(KnotVector::new(QUINTIC, knots)?, &points, None)?;
        let made = Curve::Spline { spline, is_closed: curve.period().is_some() };
        Ok(Interpolated { made, measured: error, bound })
    })?;
    Ok(Offset { made, off })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::frame::Frame;

    const TOLERANCE: f64 = 1e-6;

    fn arch() -> Curve {
        let points = [[0.0, 0.0], [1.0, 2.0], [3.0, 2.0], [4.0, 0.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let knots = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0]).unwrap();
        Curve::spline(SpaceCurve::new(knots, &points, None).unwrap(), TOLERANCE)
    }

    /// How far a curve is from where differences say.
    fn farthest(curve: &Curve, made: &Curve, reference: DVec3, ramp: Ramp) -> f64 {
        let off = |k: u32| {
            const H: f64 = 1e-6;
            let t = 0.05 + 1.9 * f64::from(k) / 50.0;
            let tangent = curve.point(t + H) - curve.point(t - H);
            made.point(t).distance(curve.point(t) + ramp.at(t) * reference.cross(tangent).normalize())
        };
        (0..=50).map(off).fold(0.0, f64::max)
    }

    #[test]
    fn a_curve_runs_beside_another_at_its_distance() {
        let frame = Frame::new(DVec3::ONE, Some(DVec3::new(0.0, 1.0, 1.0)), None).unwrap();
        let line = Curve::Line { origin: DVec3::ONE, direction: DVec3::X * 3.0 };
        let ellipse = |x, y| Curve::Ellipse { frame, radii: DVec2::new(x, y) };
        let ramps = [Ramp::even(0.25), Ramp { start: 0.1, slope: -0.3 }];
        for curve in [line, ellipse(2.0, 2.0), ellipse(3.0, 2.0), arch()] {
            let reference = if matches!(curve, Curve::Ellipse { .. }) { frame.z } else { DVec3::Z };
            for (reference, ramp) in [reference, -reference].into_iter().flat_map(|r| ramps.map(|ramp| (r, ramp))) {
                let Offset { made, off } = sideways(&curve, reference, ramp, None, TOLERANCE, &Effort::new(0)).unwrap();
                let found = farthest(&curve, &made, reference, ramp);
                assert!(off.most <= 1e-6 && found <= off.most + 1e-9, "{off:?} {found:e} {curve:?}");
                assert!(!off.is_measured, "{curve:?}");
                assert_eq!(made.period(), curve.period());
            }
        }
    }

    #[test]
    fn a_curve_without_a_way_across_is_an_error() {
        let even = Ramp::even(1.0);
        let line = Curve::Line { origin: DVec3::ZERO, direction: DVec3::Z };
        assert!(matches!(
            sideways(&line, DVec3::Z, even, None, TOLERANCE, &Effort::new(0)),
            Err(OffsetError::NoDirection(_))
        ));
        let corner = Curve::polyline(&[DVec3::ZERO, DVec3::X, DVec3::ONE], TOLERANCE).unwrap();
        assert!(matches!(
            sideways(&corner, DVec3::Z, even, None, TOLERANCE, &Effort::new(0)),
            Err(OffsetError::Rough { .. })
        ));
        let parabola = Curve::Parabola { frame: Frame::new(DVec3::ZERO, None, None).unwrap(), focal: 1.0 };
        assert!(matches!(
            sideways(&parabola, DVec3::Z, even, None, TOLERANCE, &Effort::new(0)),
            Err(OffsetError::Endless)
        ));
    }

    #[test]
    fn a_curve_without_ends_runs_beside_another_between_those_that_are_given() {
        let frame = Frame::new(DVec3::ONE, Some(DVec3::new(0.0, 1.0, 1.0)), None).unwrap();
        let parabola = Curve::Parabola { frame, focal: 0.5 };
        let hyperbola = Curve::Hyperbola { frame, radii: DVec2::new(2.0, 1.0) };
        for curve in [parabola, hyperbola] {
            let ramp = Ramp::even(0.25);
            let Offset { made, off } =
                sideways(&curve, frame.z, ramp, Some([-0.5, 2.5]), TOLERANCE, &Effort::new(0)).unwrap();
            assert_eq!(made.domain(), Some([-0.5, 2.5]));
            let found = farthest(&curve, &made, frame.z, ramp);
            assert!(!off.is_measured && off.most <= 1e-6 && found <= off.most + 1e-9, "{off:?} {found:e}");
        }
    }
}

//! What two borders are to each other over a stretch: distance, angle, difference of curvatures, each bounded both ways.
//!
//! **Angle.** Between the tangent planes, turned so that 0 is smooth and 180° is a surface folded back: where the faces lie on
//! different sides of the edge, their normals S_u × S_v are to agree; where on the same side, to be opposite. How a file turns
//! its faces does not matter. It is 2 asin(|n_A − n_B| / 2), which has no blind spot at 90°.
//!
//! **Curvature.** The normal curvature of each surface across its own border, signed with its normal turned as above. The
//! relative difference is |κ_A − κ_B| / max(|κ_A|, |κ_B|, κ_flat): 0 is equal, 1 is a curved surface beside a flat one, 2 an
//! inflection with equal radii. Below κ_flat both count as flat.

use crate::border::Along;
use crate::taylor::{Peak, Taylor, UNIT, difference, dot};
use crate::tube::Tube;
use serde::Serialize;

/// Elementary functions of the platform, and what is computed after a bound, are within this share of the truth.
const ELEMENTARY: f64 = 16.0 * UNIT;

/// What is measured at an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Criterion {
    /// G0: distance, model units.
    Gap,
    /// G1: angle, radians.
    Angle,
    /// G2: relative difference of the normal curvatures across the edge.
    Curvature,
    /// The same difference, not relative: 1 / model units.
    Difference,
}

impl Criterion {
    /// How many there are; `criterion as usize` counts them.
    pub const COUNT: usize = 4;
}

/// The greatest values over a stretch. Infinite bounds, and nothing seen, where a normal or a direction may vanish.
pub type Measured = [Peak; Criterion::COUNT];

/// What is known where there is no bound.
pub const UNKNOWN: Peak = Peak { upper: f64::INFINITY, lower: f64::NEG_INFINITY, at: 0.0 };

/// Of a tube; `is_opposite` where the faces lie on different sides of the edge, `flat` is κ_flat.
pub fn measured(tube: &Tube, is_opposite: bool, flat: f64) -> Measured {
    let mut found = [UNKNOWN; Criterion::COUNT];
    found[Criterion::Gap as usize] = through(dot(&tube.apart, &tube.apart).peak(), f64::sqrt);
    let sign = if is_opposite { 1.0 } else { -1.0 };
    let [a, b] = [0, 1].map(|k| &tube.sides[k]);
    let (Some(normal_a), Some(normal_b)) = (a.surface.normal(), b.surface.normal()) else { return found };
    let apart = difference(&normal_a.0, &normal_b.0.map(|x| x.scaled(sign)));
    let angle = |squared: f64| 2.0 * libm::asin((0.5 * squared.sqrt()).min(1.0));
    found[Criterion::Angle as usize] = through(dot(&apart, &apart).peak(), angle);
    let curvature = |side: &Along, normal| side.surface.curvature_across(side.direction, normal);
    let (Some(a), Some(b)) = (curvature(a, &normal_a), curvature(b, &normal_b)) else { return found };
    let b = b.scaled(sign);
    let apart = a - b;
    let absolute = of_size(apart);
    found[Criterion::Difference as usize] = absolute;
    found[Criterion::Curvature as usize] = relative(apart, absolute, [a, b], flat);
    found
}

/// The peak of a growing function of one that is not negative.
fn through(peak: Peak, growing: impl Fn(f64) -> f64) -> Peak {
    let upper = if peak.upper.is_finite() { growing(peak.upper.max(0.0)) } else { f64::INFINITY };
    Peak { upper: upper * (1.0 + ELEMENTARY), lower: growing(peak.lower.max(0.0)) * (1.0 - ELEMENTARY), at: peak.at }
}

fn of_size(f: Taylor) -> Peak {
    f.peak().of_either((-f).peak())
}

/// |a − b| / max(|a|, |b|, flat) is at most each of the three quotients.
fn relative(apart: Taylor, absolute: Peak, [a, b]: [Taylor; 2], flat: f64) -> Peak {
    let by_flat = Peak { upper: absolute.upper / flat, ..absolute };
    let quotient = |f: Taylor| f.reciprocal().map(|inverse| of_size(apart * inverse));
    let least = |best: Peak, other: Peak| if other.upper < best.upper { other } else { best };
    let best = [a, b].into_iter().filter_map(quotient).fold(by_flat, least);
    let size = |f: &Taylor, sign: f64| {
        let (value, radius) = f.value(best.at);
        value.abs() + sign * radius
    };
    let most = size(&a, 1.0).max(size(&b, 1.0)).max(flat);
    let lower = (size(&apart, -1.0) / most).max(0.0) * (1.0 - ELEMENTARY);
    Peak { upper: best.upper * (1.0 + ELEMENTARY), lower, at: best.at }
}

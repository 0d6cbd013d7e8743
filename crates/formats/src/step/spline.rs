//! The parameters of B-splines: of simple and of complex instances, with knots in the file or without.

use super::fault::{Fault, fault};
use super::value::{Entity, Parameters, Value};

/// The parameters of a B-spline: of a simple instance behind one another, of a complex one in parts.
pub(super) struct Spline<'e, 'b> {
    /// From the degree on.
    pub base: Parameters<'e, 'b>,
    /// Multiplicities and knots, one after the other for both directions; absent where the kind says them.
    knots: Option<Parameters<'e, 'b>>,
    pub weights: Option<Parameters<'e, 'b>>,
    kind: Kind,
    directions: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    WithKnots,
    Uniform,
    QuasiUniform,
    Bezier,
}

/// The parameters of a B-spline `what` (CURVE or SURFACE); `None` where it is none.
pub(super) fn spline_parameters<'e, 'b>(entity: &'e Entity<'b>, what: &str) -> Option<Spline<'e, 'b>> {
    let directions = if what == "CURVE" { 1 } else { 2 };
    let kinds = [
        (format!("B_SPLINE_{what}_WITH_KNOTS"), Kind::WithKnots),
        (format!("UNIFORM_{what}"), Kind::Uniform),
        (format!("QUASI_UNIFORM_{what}"), Kind::QuasiUniform),
        (format!("BEZIER_{what}"), Kind::Bezier),
    ];
    let (name, kind) = kinds.iter().find(|(name, _)| entity.is(name))?;
    // Degrees, points, form, closed, self-intersecting: 5 for a curve, 7 for a surface.
    let own = 3 + 2 * directions;
    let part = entity.part(name)?;
    let (base, knots, weights) = match entity.part(&format!("B_SPLINE_{what}")) {
        Some(base) => (base, part, entity.part(&format!("RATIONAL_B_SPLINE_{what}"))),
        None => (part.from(1), part.from(1 + own), None),
    };
    Some(Spline { base, knots: (*kind == Kind::WithKnots).then_some(knots), weights, kind: *kind, directions })
}

impl Spline<'_, '_> {
    /// All knots of a direction, for so many control points.
    pub fn knots(&self, axis: usize, degree: usize, points: usize) -> Result<Vec<f64>, Fault> {
        let wrong = |why: String| fault(self.base.number, why);
        // What is wrong with the degree is said when the knot vector is made.
        let (p, n) = (degree.min(nurbs::MAX_DEGREE), points);
        let count = |k: usize| k as f64;
        Ok(match self.kind {
            Kind::WithKnots => {
                let knots = self.knots.expect("this kind has them");
                let (multiplicities, values) = (knots.counts(axis)?, knots.numbers(self.directions + axis)?);
                if multiplicities.len() != values.len() {
                    return Err(wrong(format!("{} multiplicities for {} knots", multiplicities.len(), values.len())));
                }
                let total = multiplicities.iter().fold(0usize, |sum, m| sum.saturating_add(*m));
                if total != n + degree + 1 {
                    return Err(wrong(format!(
                        "{total} knots where degree {degree} and {n} points ask for {}",
                        n + degree + 1
                    )));
                }
                multiplicities.iter().zip(values).flat_map(|(m, k)| std::iter::repeat_n(k, *m)).collect()
            }
            Kind::Uniform => (0..n + p + 1).map(|k| count(k) - count(p)).collect(),
            Kind::QuasiUniform => (0..n + p + 1).map(|k| count(k.clamp(p, n.max(p)) - p)).collect(),
            Kind::Bezier => {
                if p == 0 || n % p != 1 % p {
                    return Err(wrong(format!("{n} control points make no Bézier pieces of degree {degree}")));
                }
                let pieces = (n - 1) / p;
                let inner = (1..pieces).flat_map(|k| std::iter::repeat_n(count(k), p));
                let ends = [0, pieces].map(|k| vec![count(k); p + 1]);
                ends[0].iter().copied().chain(inner).chain(ends[1].iter().copied()).collect()
            }
        })
    }
}

impl<'b> Parameters<'_, 'b> {
    /// A list of lists.
    pub fn rows<T>(self, at: usize, item: impl Fn(&Value<'b>) -> Option<T>) -> Result<Vec<Vec<T>>, Fault> {
        let row = |row: &Value<'b>| row.as_list()?.iter().map(&item).collect::<Option<Vec<T>>>();
        let rows = self.list(at)?.iter().map(row).collect::<Option<_>>();
        rows.ok_or_else(|| self.wrong(at, "a table"))
    }
}

//! Knot vectors: clamped, unclamped or periodic by wrapping, always legal once built.

use crate::{MAX_DEGREE, MAX_KNOTS, NurbsError};

/// A nondecreasing sequence of n + p + 1 knots for n control points of degree p.
///
/// The domain is \[u_p, u_n\]. Interior knots have multiplicity at most p (so a surface is continuous), the two
/// ends of the domain at most p + 1. Holding a `KnotVector` is the proof of this.
#[derive(Debug, Clone, PartialEq)]
pub struct KnotVector {
    degree: usize,
    knots: Vec<f64>,
    /// 1 / (U[k+r+1] − U[k+1−j+r]) for every span k of the domain, j = 1..=p, r = 0..j; zero where the span is empty.
    reciprocals: Vec<f64>,
    /// The spans of the domain, empty ones too, over its length.
    spans_per_unit: f64,
}

impl KnotVector {
    /// Checks `knots` (all n + p + 1 of them) for `degree`.
    ///
    /// # Errors
    /// Any of the knot variants of [`NurbsError`], naming the index and the values.
    pub fn new(degree: usize, knots: Vec<f64>) -> Result<Self, NurbsError> {
        if degree == 0 || degree > MAX_DEGREE {
            return Err(NurbsError::Degree { degree });
        }
        let (count, least) = (knots.len(), 2 * (degree + 1));
        if count < least {
            return Err(NurbsError::TooFewKnots { count, degree, least });
        }
        if count > MAX_KNOTS {
            return Err(NurbsError::TooManyKnots { count });
        }
        if let Some(index) = knots.iter().position(|k| !k.is_finite()) {
            return Err(NurbsError::KnotNotFinite { index, value: knots[index] });
        }
        if let Some(index) = (1..count).find(|&i| knots[i] < knots[i - 1]) {
            return Err(NurbsError::NotSorted { index, previous: knots[index - 1], next: knots[index] });
        }
        let (start, end) = (knots[degree], knots[count - degree - 1]);
        if start >= end || !(end - start).is_finite() || !(knots[count - 1] - knots[0]).is_finite() {
            return Err(NurbsError::EmptyDomain { start, end });
        }
        let mut index = 0;
        for run in knots.chunk_by(|a, b| a == b) {
            let inside = start < run[0] && run[0] < end;
            let greatest = if inside { degree } else { degree + 1 };
            if run.len() > greatest {
                return Err(NurbsError::Multiplicity { index, value: run[0], multiplicity: run.len(), greatest });
            }
            index += run.len();
        }
        let reciprocals = reciprocals(degree, &knots)?;
        let spans_per_unit = (count - 2 * degree - 1) as f64 / (end - start);
        Ok(Self { degree, knots, reciprocals, spans_per_unit })
    }

    /// One period of a periodic spline, unrolled: `period` holds the n + 1 knots of n spans and is repeated
    /// until the vector has the n + 2 p + 1 knots for n + p wrapped control points.
    ///
    /// # Errors
    /// As [`Self::new`]; a period needs at least two knots.
    pub fn periodic(degree: usize, period: &[f64]) -> Result<Self, NurbsError> {
        if degree == 0 || degree > MAX_DEGREE {
            return Err(NurbsError::Degree { degree });
        }
        if period.len() < 2 {
            return Err(NurbsError::TooFewKnots { count: period.len(), degree, least: 2 });
        }
        let spans = (period.len() - 1) as isize;
        let length = period[period.len() - 1] - period[0];
        let knot = |i: isize| period[i.rem_euclid(spans) as usize] + length * i.div_euclid(spans) as f64;
        let p = degree as isize;
        // The last knot of the period itself, not first + length, which may round elsewhere.
        let knots = (-p..=spans + p).map(|i| if i == spans { period[period.len() - 1] } else { knot(i) }).collect();
        Self::new(degree, knots)
    }

    /// Degree p, 1 to [`MAX_DEGREE`].
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All n + p + 1 knots.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Number of control points, n.
    pub fn control_count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// The domain \[u_p, u_n\].
    pub fn domain(&self) -> (f64, f64) {
        (self.knots[self.degree], self.knots[self.control_count()])
    }

    /// Length of the domain.
    pub fn length(&self) -> f64 {
        let (start, end) = self.domain();
        end - start
    }

    /// Whether both ends have multiplicity p + 1, so that the spline passes through its end control points.
    pub fn is_clamped(&self) -> bool {
        let (n, p, u) = (self.control_count(), self.degree, &self.knots);
        u[0] == u[p] && u[n] == u[n + p]
    }

    /// The span k with U\[k\] ≤ t < U\[k+1\] (Piegl & Tiller, A2.1): at a knot the span above it, at the end of the
    /// domain the last nonempty span. Parameters outside the domain get the first or last span.
    #[inline]
    pub fn find_span(&self, t: f64) -> usize {
        let (start, end) = (self.degree, self.control_count());
        // Where knots are about equally spaced, this is it.
        let guess = start + (((t - self.knots[start]) * self.spans_per_unit) as usize).min(end);
        if guess < end && self.knots[guess] <= t && t < self.knots[guess + 1] {
            return guess;
        }
        if t >= self.knots[end] {
            return self.last_span();
        }
        // Of equal knots this counts all: the span begins at the last of them. The search has no branch to mispredict.
        let mut low = start + self.knots[start + 1..end].partition_point(|k| *k <= t);
        // Below the domain of a vector whose first domain knot is repeated: move up to the nonempty span.
        while self.knots[low] == self.knots[low + 1] {
            low += 1;
        }
        low
    }

    /// As [`Self::find_span`]; sooner where the answer is `guess`, which may be any number.
    #[inline(always)]
    pub(crate) fn span_from(&self, guess: usize, t: f64) -> usize {
        let is_inside = self.degree <= guess && guess < self.control_count();
        if is_inside && self.knots[guess] <= t && t < self.knots[guess + 1] { guess } else { self.find_span(t) }
    }

    fn last_span(&self) -> usize {
        let mut span = self.control_count() - 1;
        while self.knots[span] == self.knots[span + 1] {
            span -= 1;
        }
        span
    }

    /// The nonempty spans of the domain, as indices k with U\[k\] < U\[k+1\], ascending.
    pub fn spans(&self) -> impl Iterator<Item = usize> + '_ {
        (self.degree..self.control_count()).filter(|&k| self.knots[k] < self.knots[k + 1])
    }

    /// The first knot of a span and the span's length, U\[k+1\] − U\[k\].
    pub fn span(&self, k: usize) -> (f64, f64) {
        (self.knots[k], self.knots[k + 1] - self.knots[k])
    }

    /// How often `t` occurs among the knots.
    pub fn multiplicity(&self, t: f64) -> usize {
        self.knots.iter().filter(|&&k| k == t).count()
    }

    /// The reciprocal knot differences of the inverse triangle on `span`, by column j and row r.
    pub(crate) fn span_reciprocals(&self, span: usize) -> &[f64] {
        let size = self.degree * (self.degree + 1) / 2;
        let start = (span - self.degree) * size;
        &self.reciprocals[start..start + size]
    }
}

fn reciprocals(degree: usize, knots: &[f64]) -> Result<Vec<f64>, NurbsError> {
    let spans = degree..knots.len() - degree - 1;
    let mut table = Vec::with_capacity(spans.len() * degree * (degree + 1) / 2);
    for k in spans {
        let empty = knots[k] == knots[k + 1];
        for j in 1..=degree {
            for r in 0..j {
                let (start, end) = (knots[k + 1 + r - j], knots[k + r + 1]);
                let reciprocal = if empty { 0.0 } else { 1.0 / (end - start) };
                if !reciprocal.is_finite() {
                    return Err(NurbsError::SpanUnderflow { start, end });
                }
                table.push(reciprocal);
            }
        }
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn span_at_a_knot_is_the_one_above_and_at_the_end_the_last() {
        let u = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 3.0, 3.0, 3.0]).unwrap();
        assert_eq!(u.find_span(0.0), 2);
        assert_eq!(u.find_span(1.0), 4);
        assert_eq!(u.find_span(2.0), 5);
        assert_eq!(u.find_span(3.0), 5);
        assert_eq!(u.find_span(-1.0), 2);
        assert_eq!(u.find_span(9.0), 5);
        assert_eq!(u.spans().collect::<Vec<_>>(), [2, 4, 5]);
    }

    #[test]
    fn illegal_knots_are_named() {
        let new = KnotVector::new;
        assert_eq!(new(0, vec![0.0, 1.0]), Err(NurbsError::Degree { degree: 0 }));
        assert_eq!(new(16, vec![0.0; 40]), Err(NurbsError::Degree { degree: 16 }));
        assert_eq!(
            new(1, vec![0.0, 0.0, 2.0, 1.0, 3.0]),
            Err(NurbsError::NotSorted { index: 3, previous: 2.0, next: 1.0 })
        );
        assert!(matches!(new(1, vec![0.0, f64::NAN, 1.0, 1.0]), Err(NurbsError::KnotNotFinite { index: 1, .. })));
        assert!(matches!(new(1, vec![1.0; 4]), Err(NurbsError::EmptyDomain { .. })));
        assert!(matches!(new(2, vec![0.0; 5]), Err(NurbsError::TooFewKnots { least: 6, .. })));
        assert_eq!(
            new(1, vec![0.0, 0.0, 1.0, 1.0, 2.0, 2.0]),
            Err(NurbsError::Multiplicity { index: 2, value: 1.0, multiplicity: 2, greatest: 1 })
        );
        assert!(matches!(
            new(1, vec![0.0, 0.0, f64::MIN_POSITIVE / 1e10, 1.0, 1.0]),
            Err(NurbsError::SpanUnderflow { .. })
        ));
    }

    #[test]
    fn a_period_unrolls_to_wrapped_knots() {
        let u = KnotVector::periodic(2, &[0.0, 1.0, 3.0, 4.0]).unwrap();
        assert_eq!(u.knots(), [-3.0, -1.0, 0.0, 1.0, 3.0, 4.0, 5.0, 7.0]);
        assert_eq!(u.domain(), (0.0, 4.0));
        assert!(!u.is_clamped());
    }
}

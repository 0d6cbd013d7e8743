//! The basis functions of one span with the local error of every operation, and their derivatives backwards.
//!
//! Column j of the inverse triangle holds the functions of degree j; read backwards it is de Boor's algorithm on the
//! derivatives of a result by the N_r. The names are those of `eval::basis`.

use super::error::{Adjoint, Budget, DIVISORS, Error, FLUSH, NARROWING, NEIGHBOUR};
use super::place::OnSpan;
use crate::eval::Span;

/// Values of functions and how far the program may be from them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Functions<const CAPACITY: usize> {
    pub value: [f64; CAPACITY],
    /// Coarse.
    pub radius: [f64; CAPACITY],
    /// Made by the operations that end here.
    pub local: [Error; CAPACITY],
}

impl<const CAPACITY: usize> Functions<CAPACITY> {
    const ZERO: Self = Self { value: [0.0; CAPACITY], radius: [0.0; CAPACITY], local: [Error::ZERO; CAPACITY] };
}

/// Column j − 1 to column j.
#[derive(Debug, Clone, Copy)]
struct Column<const CAPACITY: usize> {
    /// right − t and t − left.
    right: [f64; CAPACITY],
    left: [f64; CAPACITY],
    reciprocal: [f64; CAPACITY],
    /// Relative.
    reciprocal_error: [Error; CAPACITY],
    /// value × reciprocal, with its remainder as local error.
    term: Functions<CAPACITY>,
    /// The new values' local errors.
    local: [Error; CAPACITY],
}

impl<const CAPACITY: usize> Column<CAPACITY> {
    const ZERO: Self = Self {
        right: [0.0; CAPACITY],
        left: [0.0; CAPACITY],
        reciprocal: [0.0; CAPACITY],
        reciprocal_error: [Error::ZERO; CAPACITY],
        term: Functions::ZERO,
        local: [Error::ZERO; CAPACITY],
    };
}

/// The basis on a span. `functions[a]` are the derivatives of order a.
pub(super) struct Basis<const CAPACITY: usize> {
    pub functions: [Functions<CAPACITY>; 3],
    degree: usize,
    /// Column j at j − 1.
    columns: [Column<CAPACITY>; CAPACITY],
    /// N' of degree p − 1, on which N'' rests.
    lower: Functions<CAPACITY>,
    /// What derivatives are multiplied by, a power of two.
    gain: f64,
}

/// Derivatives of the results by N, N' and N''.
pub(super) type BasisAdjoint<const CAPACITY: usize> = [[Adjoint; CAPACITY]; 3];

/// a − b, whether f32 rounds it, and by how much.
fn difference(a: f64, b: f64) -> (f64, f64) {
    let exact = a - b;
    let is_exact = f64::from(exact as f32) == exact && !(exact != 0.0 && exact.abs() < FLUSH);
    (exact, if is_exact { 0.0 } else { NEIGHBOUR * exact.abs() + FLUSH })
}

impl<const CAPACITY: usize> Basis<CAPACITY> {
    /// `None` where a knot difference is outside the range for which WGSL states the accuracy of a division.
    pub fn new(span: &Span, degree: usize, on: &OnSpan, second: bool) -> Option<Self> {
        let (knots, gain) = (span.knots, f64::from(span.gain));
        let mut basis = Self {
            functions: [Functions::ZERO; 3],
            degree,
            columns: [Column::ZERO; CAPACITY],
            lower: Functions::ZERO,
            gain,
        };
        let (t, t_error) = (on.t.middle(), Error { rounding: on.t.radius(), packing: on.lost });
        basis.functions[0].value[0] = 1.0;
        for j in 1..=degree {
            let from = basis.functions[0];
            let column = &mut basis.columns[j - 1];
            let mut to = Functions::<CAPACITY>::ZERO;
            // The first product of column 1 is 1 × reciprocal: exact.
            let first_product = if j == 1 { 0.0 } else { NEIGHBOUR };
            for r in 0..j {
                let [right, left] = [knots[degree + r], knots[degree + r - j]].map(f64::from);
                let [right_packing, left_packing] = [right, left].map(narrowed_knot);
                let (width, width_rounding) = difference(right, left);
                if !(width - width_rounding >= DIVISORS[0] && width <= DIVISORS[1]) {
                    return None;
                }
                let reciprocal = 1.0 / width;
                let relative = Error {
                    rounding: width_rounding / width + reciprocal_accuracy(reciprocal, width_rounding > 0.0),
                    packing: narrowing_of_reciprocal(right_packing + left_packing, width),
                };
                column.reciprocal[r] = reciprocal;
                column.reciprocal_error[r] = relative;
                let relative = relative.total();
                let (value, radius) = (from.value[r], from.radius[r]);
                let term = value * reciprocal;
                let beyond = radius * reciprocal * relative + FLUSH * (1.0 + reciprocal + value.abs());
                let term_radius = radius * reciprocal + term * relative + beyond;
                // Each use of the product may be fused or not: its rounding is charged there.
                let product = first_product * (term + term_radius) + FLUSH;
                column.term.value[r] = term;
                column.term.radius[r] = term_radius + product;
                column.term.local[r] = Error::both(beyond);
                let mut grow = |at: usize, (distance, rounding): (f64, f64), packing: f64| {
                    let error = Error::rounding(rounding) + t_error + Error { rounding: 0.0, packing };
                    let far = distance.abs() + error.total();
                    let part = far * (term + term_radius + product);
                    let local = Error::rounding(far * product + NEIGHBOUR * part + FLUSH * (2.0 + far + term))
                        + error * (term + term_radius + product);
                    to.value[at] += distance * term;
                    to.local[at] += local;
                    to.radius[at] += local.total() + distance.abs() * term_radius;
                };
                let ahead = difference(right, t);
                let behind = difference(t, left);
                grow(r, ahead, right_packing);
                grow(r + 1, behind, left_packing);
                column.right[r] = ahead.0;
                column.left[r] = behind.0;
            }
            for r in 1..j {
                let addition = NEIGHBOUR * (to.value[r] + to.radius[r]) + FLUSH;
                to.local[r] += Error::rounding(addition);
                to.radius[r] += addition;
            }
            column.local = to.local;
            basis.functions[0] = to;
            if second && j + 1 == degree {
                basis.lower = differences(&basis.columns[j - 1].term, j, gain, first_product);
            }
        }
        let last = &basis.columns[degree - 1];
        basis.functions[1] = differences(&last.term, degree, gain, if degree == 1 { 0.0 } else { NEIGHBOUR });
        if second && degree > 1 {
            let mut term = Functions::<CAPACITY>::ZERO;
            for r in 0..degree {
                let (reciprocal, relative) = (last.reciprocal[r], last.reciprocal_error[r].total());
                let (value, radius) = (basis.lower.value[r], basis.lower.radius[r]);
                let beyond = radius * reciprocal * relative + FLUSH * (1.0 + reciprocal + value.abs());
                term.value[r] = value * reciprocal;
                term.radius[r] = radius * reciprocal + term.value[r].abs() * relative + beyond;
                term.local[r] = Error::both(beyond);
            }
            basis.functions[2] = differences(&term, degree, gain, NEIGHBOUR);
            // Kept for the way back.
            basis.columns[degree - 1].term.local = std::array::from_fn(|r| last_remainder(last, &term, r));
        }
        Some(basis)
    }

    /// Charges the errors of all operations of this direction to the results.
    pub fn sweep(&self, adjoints: &BasisAdjoint<CAPACITY>, second: bool, budget: &mut Budget) {
        let p = self.degree;
        let [value, first, curved] = adjoints;
        let mut of_value = *value;
        // By the N' of degree p − 1.
        let mut of_lower = [Adjoint::ZERO; CAPACITY];
        for r in 0..=p {
            budget.charge(&first[r], self.functions[1].local[r]);
        }
        let second = second && p > 1;
        if second {
            for r in 0..=p {
                budget.charge(&curved[r], self.functions[2].local[r]);
            }
        }
        for j in (1..=p).rev() {
            let column = &self.columns[j - 1];
            for r in 0..=j {
                budget.charge(&of_value[r], column.local[r]);
            }
            for r in 0..j {
                // de Boor's step, and the derivatives that rest on this column.
                let mut of_term = Adjoint::combined(&of_value[r], column.right[r], &of_value[r + 1], column.left[r]);
                let factor = j as f64 * self.gain;
                if j == p {
                    of_term.add(&first[r + 1], factor);
                    of_term.add(&first[r], -factor);
                }
                if second && j + 1 == p {
                    of_term.add(&of_lower[r + 1], factor);
                    of_term.add(&of_lower[r], -factor);
                }
                budget.charge(&of_term, column.term.local[r]);
                let mut of_reciprocal = of_term;
                for x in &mut of_reciprocal.0 {
                    *x *= column.term.value[r];
                }
                if second && j == p {
                    let of_curved = Adjoint::combined(&curved[r + 1], factor, &curved[r], -factor);
                    budget.charge(&of_curved, column.term.local[r]);
                    of_reciprocal.add(&of_curved, self.lower.value[r] * column.reciprocal[r]);
                    of_lower[r] = Adjoint::ZERO;
                    of_lower[r].add(&of_curved, column.reciprocal[r]);
                    budget.charge(&of_lower[r], self.lower.local[r]);
                }
                budget.charge(&of_reciprocal, column.reciprocal_error[r]);
                of_value[r] = Adjoint::ZERO;
                of_value[r].add(&of_term, column.reciprocal[r]);
            }
        }
    }
}

/// The greater of the remainders of the two terms that share a reciprocal.
fn last_remainder<const CAPACITY: usize>(last: &Column<CAPACITY>, curved: &Functions<CAPACITY>, r: usize) -> Error {
    Error::both(last.term.local[r].rounding.max(curved.local[r].rounding))
}

/// p × gain × (term_{r−1} − term_r), `product` being the relative rounding of a term, which each difference may fuse or not.
pub(super) fn differences<const CAPACITY: usize>(
    term: &Functions<CAPACITY>,
    degree: usize,
    gain: f64,
    product: f64,
) -> Functions<CAPACITY> {
    let mut d = Functions::<CAPACITY>::ZERO;
    let p = degree as f64 * gain;
    let last = if degree.is_power_of_two() { 0.0 } else { NEIGHBOUR };
    for r in 0..=degree {
        let mut size = 0.0;
        let mut radius = 0.0;
        for (at, sign) in [(r.wrapping_sub(1), p), (r, -p)] {
            if at < degree {
                d.value[r] += sign * term.value[at];
                size += p * (term.value[at].abs() + term.radius[at]);
                radius += p * term.radius[at];
            }
        }
        let subtraction = if r > 0 && r < degree { NEIGHBOUR } else { 0.0 };
        let far = d.value[r].abs() + radius;
        let local = product * size + (subtraction + last) * (1.0 + NEIGHBOUR) * far + FLUSH * (4.0 + 4.0 * p);
        d.local[r] = Error::rounding(local);
        d.radius[r] = radius + local;
    }
    d
}

/// Accuracy of 1 / width, relative: 2.5 ulp, where exactly known those of the lattice of f32 that lie inside.
pub(super) fn reciprocal_accuracy(reciprocal: f64, is_rounded: bool) -> f64 {
    let bits = reciprocal.to_bits();
    let power = f64::from_bits(bits & !((1 << 52) - 1));
    if is_rounded {
        return DIVISORS_ACCURACY;
    }
    if power == reciprocal {
        // Below a power of two the lattice is finer, and its spacing is the ulp: two steps below, or one above.
        return NEIGHBOUR;
    }
    2.5 * NEIGHBOUR * power / reciprocal
}

/// 2.5 ulp, relative, of a quotient whose divisor was rounded.
pub(super) const DIVISORS_ACCURACY: f64 = 2.5 * NEIGHBOUR * (1.0 + 2.0 * NEIGHBOUR);

/// How far the narrowing of packing moves a knot. The ends of the span, 0 and 1, are exact.
fn narrowed_knot(knot: f64) -> f64 {
    if knot == 0.0 || knot == 1.0 { 0.0 } else { NARROWING * knot.abs() + FLUSH }
}

/// Relative error of 1 / width where the width is off by up to `error`.
pub(super) fn narrowing_of_reciprocal(error: f64, width: f64) -> f64 {
    error / (width - error)
}

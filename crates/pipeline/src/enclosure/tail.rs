//! What the fragment program does with the sums: quotient, normal, curvatures. The text of `eval`, on a tape.

use super::error::NEIGHBOUR;
use super::tape::{Number, Tape, plain, product};
use crate::eval::{COLLAPSED, PARALLEL};

/// Two products, in any order, relative; and as much again.
pub(super) const THRESHOLD: f64 = 4.0 * NEIGHBOUR;

/// What the program decides on a normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regularity {
    /// There is one.
    Regular,
    /// There is none.
    Degenerate,
    /// f32 may decide either way.
    Either,
}

/// The results on the tape; `None` where nothing is known.
pub(super) struct Tail {
    pub position: Option<[Number; 3]>,
    pub regularity: Regularity,
    pub normal: Option<[Number; 3]>,
    pub curvature: Option<Curvature>,
}

/// Principal curvatures, or what they are made of.
pub(super) enum Curvature {
    /// k1 and k2.
    Apart([Number; 2]),
    /// At an umbilic, where the root of a sum of squares has no derivative: mean, x and b of mean ± √(x² + b²).
    Umbilic([Number; 3]),
}

/// Position and derivatives.
struct Derivatives {
    first: [[Number; 3]; 2],
    /// S_uu, S_uv, S_vv.
    second: Option<[[Number; 3]; 3]>,
}

impl Tail {
    /// Records the program behind the sums. `sums` are A, A_u, A_v, A_uu, A_uv, A_vv, the last three where curvatures
    /// are wanted; `rational` says whether w is among their components.
    pub fn new(tape: &mut Tape, sums: &[Option<[Number; 4]>; 6], rational: bool) -> Self {
        let mut tail = Self { position: None, regularity: Regularity::Either, normal: None, curvature: None };
        // What is not known from some operation on stays `None`.
        let _ = tail.record(tape, sums, rational);
        tail
    }

    /// Goes as far as anything is known.
    fn record(&mut self, tape: &mut Tape, sums: &[Option<[Number; 4]>; 6], rational: bool) -> Option<()> {
        let xyz = |x: [Number; 4]| [x[0], x[1], x[2]];
        let (derivatives, position) = if rational {
            let w = tape.reciprocal(sums[0]?[3])?;
            let s = scaled(tape, xyz(sums[0]?), w)?;
            self.position = Some(s);
            (quotients(tape, sums, s, w)?, s)
        } else {
            let second = match (sums[3], sums[4], sums[5]) {
                (Some(uu), Some(uv), Some(vv)) => Some([xyz(uu), xyz(uv), xyz(vv)]),
                _ => None,
            };
            (Derivatives { first: [xyz(sums[1]?), xyz(sums[2]?)], second }, xyz(sums[0]?))
        };
        self.position = Some(position);
        let [su, sv] = derivatives.first;
        let cross = tape.cross(su, sv)?;
        let squared = [tape.dot(cross, cross)?, tape.dot(su, su)?, tape.dot(sv, sv)?];
        self.regularity = regularity(squared);
        if self.regularity == Regularity::Degenerate {
            return None;
        }
        let length = tape.root(squared[0])?;
        let [x, y, z] = cross;
        let n = [tape.quotient(x, length)?, tape.quotient(y, length)?, tape.quotient(z, length)?];
        self.normal = Some(n);
        self.curvature = Some(curvature(tape, [su, sv], derivatives.second?, n, squared[1])?);
        Some(())
    }
}

fn scaled(tape: &mut Tape, a: [Number; 3], w: Number) -> Option<[Number; 3]> {
    let mut one = |x: Number| tape.sum(&[product(x, w)]);
    Some([one(a[0])?, one(a[1])?, one(a[2])?])
}

/// Piegl & Tiller, Eq. (4.20).
fn quotients(tape: &mut Tape, sums: &[Option<[Number; 4]>; 6], s: [Number; 3], w: Number) -> Option<Derivatives> {
    let [a_u, a_v] = [sums[1]?, sums[2]?];
    let mut first = [s; 2];
    for (derivative, a) in first.iter_mut().zip([a_u, a_v]) {
        for c in 0..3 {
            let numerator = tape.sum(&[plain(a[c]), product(s[c], a[3]).of_three().times(-1.0)])?;
            derivative[c] = tape.sum(&[product(numerator, w)])?;
        }
    }
    let [su, sv] = first;
    let (Some(a_uu), Some(a_uv), Some(a_vv)) = (sums[3], sums[4], sums[5]) else {
        return Some(Derivatives { first, second: None });
    };
    let mut second = [s; 3];
    let parts = [(a_uu, su, a_u, su, a_u), (a_uv, sv, a_u, su, a_v), (a_vv, sv, a_v, sv, a_v)];
    for (derivative, (a, x, x_weight, y, y_weight)) in second.iter_mut().zip(parts) {
        for c in 0..3 {
            let numerator = tape.sum(&[
                plain(a[c]),
                product(x[c], x_weight[3]).of_three().times(-1.0),
                product(y[c], y_weight[3]).of_three().times(-1.0),
                product(s[c], a[3]).of_three().times(-1.0),
            ])?;
            derivative[c] = tape.sum(&[product(numerator, w)])?;
        }
    }
    Some(Derivatives { first, second: Some(second) })
}

/// The outcomes of `eval::is_regular`.
fn regularity([n_squared, su_squared, sv_squared]: [Number; 3]) -> Regularity {
    let above = |x: Number, threshold: f64| {
        let error = x.radius + THRESHOLD * threshold;
        if x.value - error > threshold {
            Regularity::Regular
        } else if x.value + error <= threshold {
            Regularity::Degenerate
        } else {
            Regularity::Either
        }
    };
    let collapsed = f64::from(COLLAPSED) * f64::from(COLLAPSED);
    let parallel = f64::from(PARALLEL) * f64::from(PARALLEL);
    // The threshold of the third is itself inexact: its error goes to the other side.
    let area = su_squared.value * sv_squared.value;
    let area_error = (su_squared.value + su_squared.radius) * (sv_squared.value + sv_squared.radius) - area;
    let third = Number { radius: n_squared.radius + parallel * area_error, ..n_squared };
    let outcomes = [above(su_squared, collapsed), above(sv_squared, collapsed), above(third, parallel * area)];
    if outcomes.contains(&Regularity::Degenerate) {
        Regularity::Degenerate
    } else if outcomes.contains(&Regularity::Either) {
        Regularity::Either
    } else {
        Regularity::Regular
    }
}

/// `eval::curvature`.
fn curvature(
    tape: &mut Tape,
    [su, sv]: [[Number; 3]; 2],
    [suu, suv, svv]: [[Number; 3]; 3],
    n: [Number; 3],
    su_squared: Number,
) -> Option<Curvature> {
    let length = tape.root(su_squared)?;
    let e1 = [tape.quotient(su[0], length)?, tape.quotient(su[1], length)?, tape.quotient(su[2], length)?];
    let e2 = tape.cross(n, e1)?;
    let g = tape.dot(sv, e2)?;
    let across = tape.dot(sv, e1)?;
    let shear = tape.quotient(across, length)?;
    let l = tape.dot(suu, n)?;
    let m = tape.dot(suv, n)?;
    let nn = tape.dot(svv, n)?;
    let a = tape.quotient(l, su_squared)?;
    let above = tape.sum(&[plain(m), product(shear, l).times(-1.0)])?;
    let below = tape.sum(&[product(length, g)])?;
    let b = tape.quotient(above, below)?;
    let shear_squared = tape.sum(&[product(shear, shear)])?;
    let above = tape.sum(&[plain(nn), product(shear, m).times(-2.0), product(shear_squared, l).of_three()])?;
    let below = tape.sum(&[product(g, g)])?;
    let c = tape.quotient(above, below)?;
    let sum = tape.sum(&[plain(a), plain(c)])?;
    let mean = tape.scaled(sum, 0.5)?;
    let difference = tape.sum(&[plain(a), plain(c).times(-1.0)])?;
    let x = tape.scaled(difference, 0.5)?;
    Some(match tape.hypotenuse(x, b) {
        Some(half) => Curvature::Apart([
            tape.sum(&[plain(mean), plain(half)])?,
            tape.sum(&[plain(mean), plain(half).times(-1.0)])?,
        ]),
        None => Curvature::Umbilic([mean, x, b]),
    })
}

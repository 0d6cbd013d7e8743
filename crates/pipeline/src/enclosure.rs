//! What the fragment program may return at given parameters of a span, whatever WGSL allows an adapter to do.
//!
//! The program's third reading, beside `eval` and its twin in WGSL: the same operations in the same order, in f64, each
//! with a bound of what f32 may make of it; then backwards, to learn what each of these errors can do to each result.
//!
//! **Model.** An adapter may
//! 1. round each `+ − ×` to either neighbour of the exact result (an exact result stays exact), be off by up to 2.5 ulp
//!    in a division, take a square root as 1 / inverseSqrt with 2 ulp of that and 2.5 ulp of the division, or anything
//!    better;
//! 2. skip the rounding of any product that is added to or subtracted from something (fma), at each use by itself;
//! 3. add the terms of a sum in any order and any tree, multiply the factors of a product in any order, and pull a
//!    factor that all terms of a sum share out of it;
//! 4. replace a subnormal operand or result by zero, at each use by itself.
//!
//! It may not expand (distribute) a product over a sum, compute one of the program's named values twice in two ways, or
//! turn a product with a reciprocal into a division: none of these is a reassociation. √0 is taken to be 0. A result is
//! claimed only where nothing overflows and no divisor leaves 2⁻¹²⁶ … 2¹²⁶, for there WGSL promises nothing.
//!
//! **Proof.** Take each operation's rounding, and the remainder of that operation beyond first order, as a local error
//! e: then the errors of all values obey the linearised program exactly, and |d result| ≤ Σ |∂ result / ∂ value| e with
//! the derivatives at the exact values (`tape` says it with formulas). Remainders need only coarse radii of the
//! operands, carried along by ball arithmetic. All roundings are bounded relative to the exact value, 2⁻²³ for a
//! neighbour, so that reordering and pulling out factors change no bound; sums in any order by the greatest partial sum
//! that any order can have.
//!
//! Midpoints and bounds are computed in f64, whose own roundings are those of the same program 2³⁰ times smaller: the
//! bounds are widened by 2⁻²⁰ of themselves and 2⁻³⁰ of the coarse radius, which covers them.
//!
//! Each rule is certified by a machine (`certificates/` of this crate): Gappa proves it, and that half of it is too little.
//!
//! We do without an interval crate. Plain intervals lose a factor of ten here, where each basis function occurs in
//! twelve results and each result in the next; `inari` would build GMP and MPFR besides.

mod basis;
#[cfg(test)]
mod certificates;
mod error;
mod place;
mod tail;
mod tape;
mod tensor;

pub use place::{Known, OnSpan, Parameter};
pub use tail::Regularity;

use crate::layout::{FaceRecord, RATIONAL, REVERSED};
use crate::packed::PackedScene;
use basis::Basis;
use error::{Adjoint, Budget, Error, FLUSH, NEIGHBOUR, OUTPUTS};
use nurbs::MAX_ORDER;
use tail::{Curvature, Tail};
use tape::{Number, Tape};
use tensor::{ORDERS, Sums};

/// A normal whose half-width exceeds this in a coordinate is not bounded: a pole is near.
pub const USELESS: f64 = 0.25;

/// What bounds are widened by, of themselves: roundings of the second order, and what f64 loses of a bound.
const WIDENING: f64 = 1.0 / (1 << 20) as f64;

/// An operation in f64 loses of a midpoint this share of what one in f32 may lose.
const COARSE: f64 = 1.0 / (1u64 << 30) as f64;

/// An interval of one number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The exact value for the packed face.
    pub middle: f64,
    /// What roundings may add or take.
    pub half_width: f64,
    /// What the narrowing of knots and control points may have moved the exact value by.
    pub packing: f64,
}

impl Interval {
    /// |x − middle| as a share of the half-width: at most 1 inside, infinite for a NaN.
    pub fn share(&self, x: f64) -> f64 {
        let error = (x - self.middle).abs();
        if error == 0.0 {
            0.0
        } else if error.is_nan() {
            f64::INFINITY
        } else {
            error / self.half_width
        }
    }

    /// The interval of −x.
    fn negated(self) -> Self {
        Self { middle: -self.middle, ..self }
    }

    /// The interval of x × factor, a power of two.
    pub fn scaled(self, factor: f64) -> Self {
        let size = factor.abs();
        Self { middle: self.middle * factor, half_width: self.half_width * size, packing: self.packing * size }
    }
}

/// What the program may return on one pair of knot spans, in the face's local units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosure {
    /// Where it is.
    pub on: [OnSpan; 2],
    /// S; `None` where f32 may overflow or the weight vanish.
    pub position: Option<[Interval; 3]>,
    /// Whether there is a normal.
    pub regularity: Regularity,
    /// The unit normal of the face, where there is one; `None` where it has no useful bound.
    pub normal: Option<[Interval; 3]>,
    /// k1 and k2 of the face, where there is a normal; `None` where not asked for or without a bound.
    pub curvature: Option<[Interval; 2]>,
}

/// The enclosures at one place, one for each pair of spans that it may lie on.
#[derive(Debug, Clone, Copy)]
pub struct Enclosures {
    pairs: [Option<Enclosure>; 4],
}

impl Enclosures {
    /// All of them, at least one.
    pub fn iter(&self) -> impl Iterator<Item = &Enclosure> {
        self.pairs.iter().flatten()
    }

    /// Whether f32, or parameters that are not known to the bit, leave a decision open.
    pub fn is_ambiguous(&self) -> bool {
        self.iter().count() > 1 || self.iter().any(|e| e.regularity == Regularity::Either)
    }
}

/// Encloses what the fragment program of `scene` may return at a place of a face.
pub fn enclose(scene: &PackedScene, face: u32, known: &Known, curvature: bool) -> Enclosures {
    let f = &scene.faces()[face as usize];
    let mut pairs = [None; 4];
    for (at, (k, l)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
        if let (Some(u), Some(v)) = (known.0[0][k], known.0[1][l]) {
            pairs[at] = Some(match f.degree_u.max(f.degree_v) {
                0..=3 => on_spans::<4>(scene, face, [u, v], curvature),
                4..=5 => on_spans::<6>(scene, face, [u, v], curvature),
                _ => on_spans::<MAX_ORDER>(scene, face, [u, v], curvature),
            });
        }
    }
    Enclosures { pairs }
}

/// The enclosure on one pair of spans.
fn on_spans<const CAPACITY: usize>(scene: &PackedScene, face: u32, on: [OnSpan; 2], second: bool) -> Enclosure {
    let f = &scene.faces()[face as usize];
    let unknown = Enclosure { on, position: None, regularity: Regularity::Either, normal: None, curvature: None };
    let [span_u, span_v] = scene.spans(f, on.map(|on| on.span));
    let Some(nu) = Basis::<CAPACITY>::new(&span_u, f.degree_u as usize, &on[0], second) else {
        return unknown;
    };
    let Some(nv) = Basis::<CAPACITY>::new(&span_v, f.degree_v as usize, &on[1], second) else {
        return unknown;
    };
    let rational = f.flags & RATIONAL != 0;
    let (components, orders) = (if rational { 4 } else { 3 }, if second { 6 } else { 3 });
    let sums = Sums::new(f, scene.points(), [span_u.first, span_v.first], [&nu, &nv], components, orders);
    let mut tape = Tape::new();
    let mut leaves = [None; 6];
    for order in 0..orders {
        let (value, radius) = (sums.value[order], sums.radius[order]);
        let [x, y, z, w] = std::array::from_fn(|c| tape.leaf(value[c], radius[c]));
        leaves[order] = x.zip(y).zip(z.zip(w)).map(|((x, y), (z, w))| [x, y, z, w]);
    }
    let tail = Tail::new(&mut tape, &leaves, rational);
    let run = Run { basis: [&nu, &nv], sums: &sums, tape: &tape, leaves: &leaves, second };
    run.enclosure(f, &tail, unknown)
}

/// The program run forward at one place, ready to be read backwards.
struct Run<'r, const CAPACITY: usize> {
    basis: [&'r Basis<CAPACITY>; 2],
    sums: &'r Sums<CAPACITY>,
    tape: &'r Tape,
    leaves: &'r [Option<[Number; 4]>; 6],
    second: bool,
}

impl<const CAPACITY: usize> Run<'_, CAPACITY> {
    /// Bounds of the errors of up to eight values on the tape.
    fn bounds(&self, results: [Option<Number>; OUTPUTS]) -> [Error; OUTPUTS] {
        let mut budget = Budget::ZERO;
        let mut adjoints = [Adjoint::ZERO; tape::NODES];
        self.tape.sweep(&results, &mut budget, &mut adjoints);
        let of_sums: [[Adjoint; 4]; ORDERS.len()] = std::array::from_fn(|order| match &self.leaves[order] {
            Some(leaves) => leaves.map(|leaf| adjoints[leaf.index]),
            None => [Adjoint::ZERO; 4],
        });
        let of_basis = self.sums.sweep(&of_sums, &mut budget);
        for (basis, adjoint) in self.basis.iter().zip(&of_basis) {
            basis.sweep(adjoint, self.second, &mut budget);
        }
        std::array::from_fn(|k| {
            let coarse = results[k].map_or(0.0, |number| number.radius) * COARSE;
            let bound = budget.of(k) * (1.0 + WIDENING);
            Error { rounding: bound.rounding + coarse, packing: bound.packing + coarse }
        })
    }

    fn enclosure(&self, f: &FaceRecord, tail: &Tail, unknown: Enclosure) -> Enclosure {
        let Tail { position, regularity, normal, curvature } = tail;
        let Some(position) = *position else { return unknown };
        let mut results = [None; OUTPUTS];
        let some = |x: [Number; 3]| x.map(Some);
        results[..3].copy_from_slice(&some(position));
        if let Some(normal) = *normal {
            results[3..6].copy_from_slice(&some(normal));
        }
        if let Some(Curvature::Apart([k1, k2])) = *curvature {
            results[6..].copy_from_slice(&[Some(k1), Some(k2)]);
        }
        let bounds = self.bounds(results);
        let interval = |k: usize| results[k].map(|number| interval(number.value, bounds[k]));
        let mut normal = all([interval(3), interval(4), interval(5)]);
        let mut curvature = match curvature {
            Some(Curvature::Umbilic(parts)) => Some(self.umbilic(*parts)),
            _ => all([interval(6), interval(7)]),
        };
        normal = normal.filter(|n| n.iter().all(|x| x.half_width < USELESS));
        curvature = curvature.filter(|k| normal.is_some() && k.iter().all(|x| x.half_width.is_finite()));
        if f.flags & REVERSED != 0 {
            normal = normal.map(|n| n.map(Interval::negated));
            curvature = curvature.map(|[k1, k2]| [k2.negated(), k1.negated()]);
        }
        let position = all([interval(0), interval(1), interval(2)]);
        Enclosure { position, regularity: *regularity, normal, curvature, ..unknown }
    }

    /// k1 and k2 near an umbilic: a distance changes by no more than its ends move.
    fn umbilic(&self, parts: [Number; 3]) -> [Interval; 2] {
        let mut results = [None; OUTPUTS];
        results[..3].copy_from_slice(&parts.map(Some));
        let bounds = self.bounds(results);
        let [mean, x, b] = parts;
        let half = x.value.hypot(b.value);
        let moved = Error {
            rounding: bounds[1].rounding.hypot(bounds[2].rounding),
            packing: bounds[1].packing.hypot(bounds[2].packing),
        };
        let own = tape::hypotenuse_rounding(half + moved.total());
        [mean.value + half, mean.value - half].map(|k| {
            let addition = NEIGHBOUR * (k.abs() + bounds[0].total() + moved.total() + own) + FLUSH;
            interval(k, bounds[0] + moved + Error::rounding(own + addition))
        })
    }
}

fn interval(middle: f64, error: Error) -> Interval {
    Interval { middle, half_width: error.rounding, packing: error.packing }
}

fn all<const N: usize>(parts: [Option<Interval>; N]) -> Option<[Interval; N]> {
    let mut whole = [Interval { middle: 0.0, half_width: 0.0, packing: 0.0 }; N];
    for (to, from) in whole.iter_mut().zip(parts) {
        *to = from?;
    }
    Some(whole)
}

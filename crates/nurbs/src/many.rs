//! Many points of a surface at once: S, S_u, S_v and the normal, for lists and for grids of parameters.
//!
//! Points of one span go through the sums together, eight at a time, on vectors as wide as the processor has ([`lanes`]).
//! Each lane adds the same numbers in the same order as [`Surface::first_derivatives`] does, so the bits are the same.

use crate::basis::{Basis, basis};
use crate::differential::PARALLEL;
use crate::{Direction, FirstDerivatives, MAX_ORDER, Normal, Surface};
use glam::{DVec2, DVec3};
use lanes::{Kernel, Lanes, Level, run};

/// How many points go together.
const WIDTH: usize = 8;

/// How many points of a list are sorted by their spans together.
const BLOCK: usize = 1024;

/// Where this many points and more of a list follow each other on one span, as a rule, it is not sorted.
const FEW: usize = 2 * WIDTH;

/// Bits of a span's index in a key that points are sorted by: [`crate::MAX_KNOTS`] is below 2²¹.
const SPAN_BITS: u32 = 21;

/// Squares of lengths between this and its reciprocal are held by f64 with all their digits.
const LEAST_SQUARE: f64 = 1e-200;

/// A point of a surface with its tangent plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evaluation {
    /// Position and first derivatives.
    pub derivatives: FirstDerivatives,
    /// Unit normal along S_u × S_v, or its limit: by the rule of [`Surface::inspect`].
    pub normal: Normal,
}

impl Surface {
    /// S, S_u, S_v and the normal at (u, v).
    ///
    /// The derivatives are those of [`Self::first_derivatives`], to the bit. Where the normal is regular it is S_u × S_v of
    /// these, normalised; elsewhere it is that of [`Self::inspect`].
    #[inline]
    pub fn evaluate(&self, u: f64, v: f64) -> Evaluation {
        let span = [self.knots(Direction::U).find_span(u), self.knots(Direction::V).find_span(v)];
        let derivatives = self.first_derivatives_on(span[0], span[1], u, v);
        let FirstDerivatives { su, sv, .. } = derivatives;
        let cross = su.cross(sv);
        let squares = [su, sv, cross].map(|x| x.dot(x));
        let normal = if Regular::new(self).holds(squares) {
            Normal::Regular(cross.normalize())
        } else {
            self.inspect_on(span[0], span[1], u, v).normal
        };
        Evaluation { derivatives, normal }
    }

    /// Appends [`Self::evaluate`] at each of a list of (u, v) to `out`: the same answers, to the bit, sooner.
    ///
    /// Points of one span are gathered, so the order of the list matters little.
    pub fn evaluate_many(&self, at: &[DVec2], out: &mut Vec<Evaluation>) {
        self.evaluate_list(Level::new(), at, out);
    }

    /// Appends [`Self::evaluate`] at each pair of a grid to `out`, row-major in u: index `i * v.len() + j`.
    ///
    /// The same answers, to the bit; basis functions and sums over v are made once for all u of a span.
    pub fn evaluate_grid(&self, u: &[f64], v: &[f64], out: &mut Vec<Evaluation>) {
        self.evaluate_product(Level::new(), u, v, out);
    }

    fn evaluate_list(&self, level: Level, at: &[DVec2], out: &mut Vec<Evaluation>) {
        match self.degree() {
            [3, 3] => run(level, List::<4> { surface: self, degree: [3, 3], at, out }),
            [2, 2] => run(level, List::<3> { surface: self, degree: [2, 2], at, out }),
            degree => run(level, List::<MAX_ORDER> { surface: self, degree, at, out }),
        }
    }

    fn evaluate_product(&self, level: Level, u: &[f64], v: &[f64], out: &mut Vec<Evaluation>) {
        match self.degree() {
            [3, 3] => run(level, Product::<4> { surface: self, degree: [3, 3], u, v, out }),
            [2, 2] => run(level, Product::<3> { surface: self, degree: [2, 2], u, v, out }),
            degree => run(level, Product::<MAX_ORDER> { surface: self, degree, u, v, out }),
        }
    }
}

/// What makes a normal surely regular: twice what the rule of [`Surface::inspect`] asks for, on squares that f64 holds.
struct Regular {
    /// The least |S_u|² and |S_v|².
    least: [f64; 2],
}

impl Regular {
    #[inline(always)]
    fn new(surface: &Surface) -> Self {
        let least = 2.0 * surface.collapsed_below();
        let square = |x: f64| (x * x).max(LEAST_SQUARE);
        Self { least: [Direction::U, Direction::V].map(|direction| square(least / surface.knots(direction).length())) }
    }

    /// For |S_u|², |S_v|² and |S_u × S_v|². Where it does not hold, a closer look may still find the normal regular.
    #[inline(always)]
    fn holds(&self, [u, v, cross]: [f64; 3]) -> bool {
        let sine = 2.0 * PARALLEL;
        let is_held = u.max(v).max(cross) <= 1.0 / LEAST_SQUARE && cross >= LEAST_SQUARE;
        is_held && u > self.least[0] && v > self.least[1] && cross > sine * sine * (u * v)
    }
}

/// A number of each of the points that go together.
type Several = Lanes<f64, WIDTH>;

/// The basis functions of one direction.
type Functions<const C: usize> = Basis<C, Several>;

/// Sums over v of the rows of a net, with N_v and with N'_v: by component and row.
struct Rows<const C: usize> {
    value: [[Several; C]; 4],
    first: [[Several; C]; 4],
}

/// Homogeneous S, S_u and S_v, by component.
struct Sums([[Several; 4]; 3]);

/// A list of parameters.
struct List<'a, const C: usize> {
    surface: &'a Surface,
    degree: [usize; 2],
    at: &'a [DVec2],
    out: &'a mut Vec<Evaluation>,
}

/// A grid of parameters.
struct Product<'a, const C: usize> {
    surface: &'a Surface,
    degree: [usize; 2],
    u: &'a [f64],
    v: &'a [f64],
    out: &'a mut Vec<Evaluation>,
}

/// What a point is before it is known, so that answers can come in any order.
const UNKNOWN: Evaluation = Evaluation {
    derivatives: FirstDerivatives { s: DVec3::ZERO, su: DVec3::ZERO, sv: DVec3::ZERO },
    normal: Normal::Undefined,
};

impl<const C: usize> Kernel for List<'_, C> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { surface, degree, at, out } = self;
        let net = Net::new(surface, degree);
        let mut keys = [0u64; BLOCK];
        for block in at.chunks(BLOCK) {
            let first = out.len();
            out.resize(first + block.len(), UNKNOWN);
            let keys = &mut keys[..block.len()];
            let mut span = [0; 2];
            for (i, (key, uv)) in keys.iter_mut().zip(block).enumerate() {
                span = [
                    surface.knots(Direction::U).span_from(span[0], uv.x),
                    surface.knots(Direction::V).span_from(span[1], uv.y),
                ];
                *key = ((span[0] as u64) << SPAN_BITS | span[1] as u64) << BLOCK.ilog2() | i as u64;
            }
            let of_span = |key: u64| key >> BLOCK.ilog2();
            let is_same = |a: &u64, b: &u64| of_span(*a) == of_span(*b);
            if keys.chunk_by(is_same).count() * FEW > keys.len() {
                keys.sort_unstable();
            }
            for same in keys.chunk_by(is_same) {
                let spans = of_span(same[0]);
                let span = [(spans >> SPAN_BITS) as usize, (spans & ((1 << SPAN_BITS) - 1)) as usize];
                for group in same.chunks(WIDTH) {
                    // The last stands in for those that are missing.
                    let index: [usize; WIDTH] =
                        std::array::from_fn(|i| (group[i.min(group.len() - 1)] % BLOCK as u64) as usize);
                    let uv = index.map(|i| block[i]);
                    let nu: Functions<C> =
                        basis::<C, false, _>(surface.knots(Direction::U), degree[0], span[0], Lanes(uv.map(|uv| uv.x)));
                    let nv: Functions<C> =
                        basis::<C, false, _>(surface.knots(Direction::V), degree[1], span[1], Lanes(uv.map(|uv| uv.y)));
                    let sums = net.tensor(span, &nu, &nv);
                    let is_regular = net.finish(sums, out, index.map(|i| first + i));
                    for i in (0..WIDTH).filter(|&i| !is_regular[i]) {
                        out[first + index[i]] = surface.evaluate(uv[i].x, uv[i].y);
                    }
                }
            }
        }
    }
}

impl<const C: usize> Kernel for Product<'_, C> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { surface, degree, u, v, out } = self;
        let net = Net::new(surface, degree);
        let first = out.len();
        out.resize(first + u.len() * v.len(), UNKNOWN);
        let [spans_u, spans_v] = [(Direction::U, u), (Direction::V, v)].map(|(direction, t)| {
            let knots = surface.knots(direction);
            t.iter().map(|&t| knots.find_span(t)).collect::<Vec<usize>>()
        });
        let by_u: Vec<Basis<C>> = u
            .iter()
            .zip(&spans_u)
            .map(|(&u, &span)| basis::<C, false, _>(surface.knots(Direction::U), degree[0], span, u))
            .collect();
        let mut start = 0;
        for columns in spans_v.chunk_by(|a, b| a == b) {
            for from in (start..start + columns.len()).step_by(WIDTH) {
                let count = WIDTH.min(start + columns.len() - from);
                let column: [usize; WIDTH] = std::array::from_fn(|i| from + i.min(count - 1));
                let nv: Functions<C> = basis::<C, false, _>(
                    surface.knots(Direction::V),
                    degree[1],
                    columns[0],
                    Lanes(column.map(|j| v[j])),
                );
                let mut i = 0;
                for same in spans_u.chunk_by(|a, b| a == b) {
                    let rows = net.rows([same[0], columns[0]], &nv);
                    for row in i..i + same.len() {
                        let sums = net.sums(&rows, &by_u[row]);
                        let place = first + row * v.len();
                        let is_regular = net.finish(sums, out, column.map(|j| place + j));
                        for j in (0..WIDTH).filter(|&j| !is_regular[j]) {
                            out[place + column[j]] = surface.evaluate(u[row], v[column[j]]);
                        }
                    }
                    i += same.len();
                }
            }
            start += columns.len();
        }
    }
}

/// A surface's net, and what its points are made of besides.
struct Net<'a> {
    points: &'a [[f64; 4]],
    columns: usize,
    degree: [usize; 2],
    origin: DVec3,
    is_rational: bool,
    regular: Regular,
}

impl<'a> Net<'a> {
    #[inline(always)]
    fn new(surface: &'a Surface, degree: [usize; 2]) -> Self {
        Self {
            points: surface.homogeneous(),
            columns: surface.control_counts()[1],
            degree,
            origin: surface.origin(),
            is_rational: surface.weights().is_some(),
            regular: Regular::new(surface),
        }
    }

    /// The components that are not known beforehand.
    #[inline(always)]
    fn components(&self) -> usize {
        if self.is_rational { 4 } else { 3 }
    }

    /// The points of a span.
    #[inline(always)]
    fn span(&self, span: [usize; 2]) -> &'a [[f64; 4]] {
        let [p, q] = self.degree;
        let first = (span[0] - p) * self.columns + span[1] - q;
        &self.points[first..first + p * self.columns + q + 1]
    }

    /// Both sums, of points that have nothing in common but the span.
    #[inline(always)]
    fn tensor<const C: usize>(&self, span: [usize; 2], nu: &Functions<C>, nv: &Functions<C>) -> Sums {
        let [p, q] = self.degree;
        let net = self.span(span);
        let mut sums = [[Several::ZERO; 4]; 3];
        for c in 0..self.components() {
            let [mut sum, mut sum_u, mut sum_v] = [Several::ZERO; 3];
            for i in 0..p + 1 {
                let points = &net[i * self.columns..][..q + 1];
                let [mut row, mut row_v] = [Several::ZERO; 2];
                for j in 0..q + 1 {
                    row = row + nv.value[j] * points[j][c];
                    row_v = row_v + nv.first[j] * points[j][c];
                }
                sum = sum + nu.value[i] * row;
                sum_u = sum_u + nu.first[i] * row;
                sum_v = sum_v + nu.value[i] * row_v;
            }
            (sums[0][c], sums[1][c], sums[2][c]) = (sum, sum_u, sum_v);
        }
        Sums(sums)
    }

    /// The sums over v, of points that have v in common with others.
    #[inline(always)]
    fn rows<const C: usize>(&self, span: [usize; 2], nv: &Functions<C>) -> Rows<C> {
        let [p, q] = self.degree;
        let net = self.span(span);
        let mut rows = Rows { value: [[Several::ZERO; C]; 4], first: [[Several::ZERO; C]; 4] };
        for c in 0..self.components() {
            for i in 0..p + 1 {
                let points = &net[i * self.columns..][..q + 1];
                let [mut row, mut row_v] = [Several::ZERO; 2];
                for j in 0..q + 1 {
                    row = row + nv.value[j] * points[j][c];
                    row_v = row_v + nv.first[j] * points[j][c];
                }
                rows.value[c][i] = row;
                rows.first[c][i] = row_v;
            }
        }
        rows
    }

    /// The sums over u of these, at one u.
    #[inline(always)]
    fn sums<const C: usize>(&self, rows: &Rows<C>, Basis { value, first, .. }: &Basis<C>) -> Sums {
        let mut sums = [[Several::ZERO; 4]; 3];
        for c in 0..self.components() {
            for i in 0..self.degree[0] + 1 {
                sums[0][c] = sums[0][c] + rows.value[c][i] * value[i];
                sums[1][c] = sums[1][c] + rows.value[c][i] * first[i];
                sums[2][c] = sums[2][c] + rows.first[c][i] * value[i];
            }
        }
        Sums(sums)
    }

    /// The quotients and the normals, to the places that `place` names; whether each normal is surely regular.
    #[inline(always)]
    fn finish(&self, Sums([a, a_u, a_v]): Sums, out: &mut [Evaluation], place: [usize; WIDTH]) -> [bool; WIDTH] {
        let [mut s, mut su, mut sv] = [a, a_u, a_v].map(|[x, y, z, _]| [x, y, z]);
        if self.is_rational {
            // As [`FirstDerivatives::from_homogeneous`].
            let w = Lanes::splat(1.0) / a[3];
            for c in 0..3 {
                s[c] = s[c] * w;
                su[c] = (su[c] - s[c] * a_u[3]) * w;
                sv[c] = (sv[c] - s[c] * a_v[3]) * w;
            }
        }
        let dot = |a: [Several; 3], b: [Several; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let cross = [su[1] * sv[2] - sv[1] * su[2], su[2] * sv[0] - sv[2] * su[0], su[0] * sv[1] - sv[0] * su[1]];
        let squares = [dot(su, su), dot(sv, sv), dot(cross, cross)];
        let scale = Lanes::splat(1.0) / squares[2].sqrt();
        let normal = cross.map(|x| x * scale);
        for c in 0..3 {
            s[c] = s[c] + self.origin[c];
        }
        for i in 0..WIDTH {
            let at = |x: &[Several; 3]| DVec3::new(x[0].0[i], x[1].0[i], x[2].0[i]);
            out[place[i]] = Evaluation {
                derivatives: FirstDerivatives { s: at(&s), su: at(&su), sv: at(&sv) },
                normal: Normal::Regular(at(&normal)),
            };
        }
        std::array::from_fn(|i| self.regular.holds(squares.map(|x| x.0[i])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{KnotVector, NormalStatus};
    use lanes::levels;
    use proptest::prelude::*;

    /// A knot vector on 0 … 1 with repeated and uneven knots.
    fn knots(p: usize, inner: &[(f64, usize)]) -> KnotVector {
        let mut all = vec![0.0; p + 1];
        let mut sorted: Vec<(f64, usize)> = inner.to_vec();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        sorted.dedup_by(|a, b| a.0 == b.0);
        all.extend(sorted.iter().flat_map(|&(t, times)| std::iter::repeat_n(t, times.min(p))));
        all.extend(vec![1.0; p + 1]);
        KnotVector::new(p, all).unwrap()
    }

    /// A surface over these knots; its first row is a pole where asked for.
    fn surface([u, v]: [KnotVector; 2], noise: &[f64], rational: bool, pole: bool) -> Surface {
        let columns = v.control_count();
        let count = u.control_count() * columns;
        let at = |k: usize| noise[k % noise.len()];
        let points = (0..count).map(|k| (k, k / columns, k % columns)).map(|(k, i, j)| match i {
            0 if pole => DVec3::ZERO,
            _ => DVec3::new(i as f64 + 0.3 * at(3 * k), j as f64 + 0.3 * at(3 * k + 1), at(3 * k + 2)),
        });
        let points: Vec<DVec3> = points.collect();
        let weights = rational.then(|| (0..count).map(|k| 1.0 + 0.9 * at(7 * k + 5)).collect());
        Surface::new(u, v, points, weights).unwrap()
    }

    fn bits(all: &[Evaluation]) -> Vec<[u64; 13]> {
        let of_one = |e: &Evaluation| {
            let d = e.derivatives;
            let normal = e.normal.unit().unwrap_or(DVec3::MAX);
            let mut bits = [e.normal.status() as u64; 13];
            for (k, x) in [d.s, d.su, d.sv, normal].into_iter().flat_map(|x| x.to_array()).enumerate() {
                bits[k] = x.to_bits();
            }
            bits
        };
        all.iter().map(of_one).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(120))]

        #[test]
        fn every_width_gives_the_bits_of_one_by_one(
            degree in [1usize..7, 1usize..7],
            cubic: bool,
            inner in prop::collection::vec((0.01f64..0.99, 1usize..4), 0..5),
            noise in prop::collection::vec(-1.0f64..1.0, 40..60),
            rational: bool,
            pole: bool,
            shares in prop::collection::vec([-0.1f64..1.1, -0.1f64..1.1], 0..200),
        ) {
            let degree = if cubic { [3; 2] } else { degree };
            let surface = surface(degree.map(|p| knots(p, &inner)), &noise, rational, pole);
            // Corners, knots, what is outside, and nothing.
            let mut at: Vec<DVec2> = shares.iter().map(|&uv| uv.into()).collect();
            at.extend([[0.0, 0.0], [0.0, 1.0], [1.0, 0.5], [0.0, 0.5], [f64::NAN, 0.5]].map(DVec2::from));
            at.extend(inner.iter().map(|&(t, _)| DVec2::new(t, 0.5)));
            let one_by_one: Vec<Evaluation> = at.iter().map(|uv| surface.evaluate(uv.x, uv.y)).collect();
            for level in levels() {
                let mut list = vec![];
                surface.evaluate_list(level, &at, &mut list);
                prop_assert_eq!(bits(&list), bits(&one_by_one), "{:?}", level);
                let (u, v): (Vec<f64>, Vec<f64>) = at.iter().map(|uv| (uv.x, uv.y)).unzip();
                let mut grid = vec![];
                surface.evaluate_product(level, &u[..at.len().min(9)], &v, &mut grid);
                let pairs = u[..at.len().min(9)].iter().flat_map(|&u| v.iter().map(move |&v| (u, v)));
                let expected: Vec<Evaluation> = pairs.map(|(u, v)| surface.evaluate(u, v)).collect();
                prop_assert_eq!(bits(&grid), bits(&expected), "{:?}", level);
            }
            for (uv, e) in at.iter().zip(&one_by_one).filter(|(uv, _)| !uv.is_nan()) {
                prop_assert_eq!(e.derivatives, surface.first_derivatives(uv.x, uv.y));
                let closer = surface.inspect(uv.x, uv.y).normal;
                prop_assert_eq!(e.normal.status(), closer.status());
                if let (Some(a), Some(b)) = (e.normal.unit(), closer.unit()) {
                    prop_assert!(a.distance(b) < 1e-9, "{a} and {b} at {uv}");
                }
            }
        }
    }

    #[test]
    fn a_long_list_in_no_order_keeps_its_order() {
        let surface = surface([knots(3, &[(0.2, 1), (0.5, 2)]), knots(2, &[(0.7, 1)])], &[0.3, -0.2, 0.9], true, true);
        let share = |i: usize, step: f64| (i as f64 * step).fract();
        let at: Vec<DVec2> = (0..3 * BLOCK + 5).map(|i| DVec2::new(share(i, 0.618034), share(i, 0.754878))).collect();
        let mut out = vec![surface.evaluate(0.5, 0.5)];
        surface.evaluate_many(&at, &mut out);
        assert_eq!(out.len(), at.len() + 1);
        for (uv, e) in at.iter().zip(&out[1..]) {
            assert_eq!(*e, surface.evaluate(uv.x, uv.y));
        }
        assert_eq!(surface.evaluate(0.0, 0.3).normal.status(), NormalStatus::Limit);
    }

    /// Knots of 1e-150 make squares of derivatives that leave f64: the closer look takes over.
    #[test]
    fn derivatives_whose_squares_leave_f64_have_a_normal() {
        let tiny = 1e-150;
        let knots = KnotVector::new(1, vec![0.0, 0.0, tiny, tiny]).unwrap();
        let points = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::new(1.0, 1.0, 0.0)];
        let surface = Surface::new(knots.clone(), knots, points, None).unwrap();
        let mut out = vec![];
        surface.evaluate_many(&[DVec2::splat(0.5 * tiny); 3], &mut out);
        let normals = out.iter().map(|e| e.normal.unit().unwrap());
        assert!(normals.into_iter().all(|n| n.distance(DVec3::Z) < 1e-15), "{out:?}");
    }
}

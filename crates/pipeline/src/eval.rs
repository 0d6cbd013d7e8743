//! Evaluation of a face in f32: span, basis, surface. Twin of `shaders/eval.wgsl`.
//!
//! The same function names, statements and operand order stand in both. `CAPACITY` is the size of the private
//! arrays: [`MAX_ORDER`](nurbs::MAX_ORDER) in the general program, the degree plus one in a specialised one.
//! Sums of a tensor product run over v first and are multiplied by N_u once, so that no compiler finds a factor
//! to pull out. Ranges are half-open: of a constant degree such loops are unrolled, others are not.

use crate::layout::{FaceRecord, RATIONAL, SPAN_HEAD};
use crate::vector::{Vec3, cross, dot, scale, subtract};
use lanes::Lanes;

/// Below this sine S_u and S_v count as parallel: their cross product then is mostly rounding error in f32.
pub const PARALLEL: f32 = 1.0 / 1048576.0;

/// Below this length a first derivative counts as collapsed: in local units by a span's parameter, times the span's gain.
pub const COLLAPSED: f32 = 1.0 / 1048576.0;

/// Values and derivatives of the basis functions that are not zero on a span.
#[derive(Debug, Clone, Copy)]
pub struct Basis<const CAPACITY: usize, const N: usize> {
    /// N_r.
    pub value: [Lanes<f32, N>; CAPACITY],
    /// N'_r.
    pub first: [Lanes<f32, N>; CAPACITY],
    /// N''_r; zeros unless asked for.
    pub second: [Lanes<f32, N>; CAPACITY],
}

/// Position and derivatives in local coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Derivatives<const N: usize> {
    /// S.
    pub s: Vec3<N>,
    /// S_u.
    pub su: Vec3<N>,
    /// S_v.
    pub sv: Vec3<N>,
    /// S_uu; zeros, as the next two, unless second derivatives were asked for.
    pub suu: Vec3<N>,
    /// S_uv.
    pub suv: Vec3<N>,
    /// S_vv.
    pub svv: Vec3<N>,
}

/// A span of one direction, as packed. Its knots are moved and scaled so that the span is 0 … 1: any two of them between which
/// a basis function lies are at least 1 apart, so that no difference of knots cancels, however short the span is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span<'a> {
    /// Where it starts, in parameters of the whole domain.
    pub start: f32,
    /// The first of the degree + 1 control points that it rests on.
    pub first: usize,
    /// Its length, in parameters of the whole domain.
    pub length: f32,
    /// A power of two by which derivatives are multiplied, so that those of the basis functions are about as large as the
    /// functions: a short span beside long ones changes little along itself.
    pub gain: f32,
    /// 1 / (length × gain): takes a derivative by the span's parameter, times the gain, to one by that of the whole domain.
    pub per_whole: f32,
    /// 2 × degree knots: degree that end with 0, and degree that begin with 1.
    pub knots: &'a [f32],
}

impl<'a> Span<'a> {
    /// Span `k` of a table ([`FaceRecord`]) that starts at `table` among the knots.
    #[inline(always)]
    pub fn new(knots: &'a [f32], table: usize, spans: usize, degree: usize, k: usize) -> Self {
        let record = &knots[table + spans + 1 + k * (SPAN_HEAD + 2 * degree)..][..SPAN_HEAD + 2 * degree];
        Self {
            start: knots[table + k],
            first: record[0] as usize,
            length: record[1],
            gain: record[2],
            per_whole: record[3],
            knots: &record[SPAN_HEAD..],
        }
    }

    /// The parameter of the whole domain that one of the span stands for.
    #[inline(always)]
    pub fn whole(&self, t: f32) -> f32 {
        self.start + self.length * t
    }

    /// The span's parameter for one of the whole domain: 0 … 1, also where rounding would leave it.
    #[inline(always)]
    pub fn local(&self, t: f32) -> f32 {
        ((t - self.start) / self.length).clamp(0.0, 1.0)
    }
}

/// The span k with start\[k\] ≤ t < start\[k+1\] by binary search; at the end of the domain the last one (Kanai 2007, Sec. 3.1).
///
/// `starts` are where the spans start, and 1; `t` is in 0 … 1.
#[inline(always)]
pub fn find_span(starts: &[f32], t: f32) -> usize {
    let mut low = 0;
    let mut high = starts.len() - 1;
    while high - low > 1 {
        let middle = (low + high) / 2;
        if t < starts[middle] {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

/// The inverse triangle with first and, where asked, second derivatives (Kanai 2007, Eqs. 2, 3 and 6 with the minus
/// sign of the Japanese text; Piegl & Tiller, A2.2 and Eq. 2.7).
///
/// `knots` are those of [`Span::knots`]. Derivatives are by t, times `gain`; second ones times its square.
#[inline(always)]
pub fn basis<const CAPACITY: usize, const N: usize>(
    knots: &[f32],
    degree: usize,
    t: Lanes<f32, N>,
    gain: f32,
    second: bool,
) -> Basis<CAPACITY, N> {
    let mut b = Basis {
        value: [Lanes::<f32, N>::ZERO; CAPACITY],
        first: [Lanes::<f32, N>::ZERO; CAPACITY],
        second: [Lanes::<f32, N>::ZERO; CAPACITY],
    };
    let mut term = [Lanes::<f32, N>::ZERO; CAPACITY];
    let mut reciprocal = [0.0f32; CAPACITY];
    b.value[0] = Lanes::splat(1.0);
    for j in 1..degree + 1 {
        let mut saved = Lanes::<f32, N>::ZERO;
        for r in 0..j {
            let right = knots[degree + r];
            let left = knots[degree + r - j];
            reciprocal[r] = 1.0 / (right - left);
            term[r] = b.value[r] * reciprocal[r];
            b.value[r] = saved + (Lanes::splat(right) - t) * term[r];
            saved = (t - left) * term[r];
        }
        b.value[j] = saved;
        if second && j + 1 == degree {
            b.second = differences::<CAPACITY, N>(&term, j, gain);
        }
    }
    b.first = differences::<CAPACITY, N>(&term, degree, gain);
    if second {
        // N' of degree p − 1 stands in b.second (zeros for p = 1): differences once more.
        for r in 0..degree {
            term[r] = b.second[r] * reciprocal[r];
        }
        b.second = differences::<CAPACITY, N>(&term, degree, gain);
    }
    b
}

/// N'_r = p (term_{r−1} − term_r), times `gain`.
#[inline(always)]
fn differences<const CAPACITY: usize, const N: usize>(
    term: &[Lanes<f32, N>; CAPACITY],
    degree: usize,
    gain: f32,
) -> [Lanes<f32, N>; CAPACITY] {
    let mut d = [Lanes::<f32, N>::ZERO; CAPACITY];
    let p = degree as f32 * gain;
    d[0] = -term[0] * p;
    for r in 1..degree {
        d[r] = (term[r - 1] - term[r]) * p;
    }
    d[degree] = term[degree - 1] * p;
    d
}

/// S and its derivatives by the parameters of a face's spans whose control points begin at `first`.
#[inline(always)]
pub fn surface<const CAPACITY: usize, const N: usize>(
    face: &FaceRecord,
    degree: [usize; 2],
    points: &[[f32; 4]],
    first: [usize; 2],
    nu: &Basis<CAPACITY, N>,
    nv: &Basis<CAPACITY, N>,
    second: bool,
) -> Derivatives<N> {
    let zero = [Lanes::<f32, N>::ZERO; 4];
    let [mut a, mut a_u, mut a_v, mut a_uu, mut a_uv, mut a_vv] = [zero; 6];
    // The twin adds vec4s. Here each component runs through both sums by itself, so that its running sums stay in
    // registers; their order, and so every bit, is the same. Without a quotient nobody reads w.
    let components = if face.flags & RATIONAL != 0 { 4 } else { 3 };
    for c in 0..components {
        for i in 0..degree[0] + 1 {
            let start = face.points as usize + (first[0] + i) * face.count_v as usize + first[1];
            let points = &points[start..=start + degree[1]];
            let [mut row, mut row_v, mut row_vv] = [Lanes::<f32, N>::ZERO; 3];
            for j in 0..degree[1] + 1 {
                let point = points[j][c];
                row = row + nv.value[j] * point;
                row_v = row_v + nv.first[j] * point;
                if second {
                    row_vv = row_vv + nv.second[j] * point;
                }
            }
            a[c] = a[c] + nu.value[i] * row;
            a_u[c] = a_u[c] + nu.first[i] * row;
            a_v[c] = a_v[c] + nu.value[i] * row_v;
            if second {
                a_uu[c] = a_uu[c] + nu.second[i] * row;
                a_uv[c] = a_uv[c] + nu.first[i] * row_v;
                a_vv[c] = a_vv[c] + nu.value[i] * row_vv;
            }
        }
    }
    let xyz = |x: [Lanes<f32, N>; 4]| [x[0], x[1], x[2]];
    let mut d = Derivatives { s: xyz(a), su: xyz(a_u), sv: xyz(a_v), suu: xyz(a_uu), suv: xyz(a_uv), svv: xyz(a_vv) };
    if face.flags & RATIONAL != 0 {
        // Piegl & Tiller, Eq. (4.20).
        let w = Lanes::splat(1.0) / a[3];
        d.s = scale(d.s, w);
        d.su = scale(subtract(d.su, scale(d.s, a_u[3])), w);
        d.sv = scale(subtract(d.sv, scale(d.s, a_v[3])), w);
        if second {
            let two = Lanes::splat(2.0);
            d.suu = scale(subtract(subtract(d.suu, scale(d.su, two * a_u[3])), scale(d.s, a_uu[3])), w);
            d.suv = scale(
                subtract(subtract(subtract(d.suv, scale(d.sv, a_u[3])), scale(d.su, a_v[3])), scale(d.s, a_uv[3])),
                w,
            );
            d.svv = scale(subtract(subtract(d.svv, scale(d.sv, two * a_v[3])), scale(d.s, a_vv[3])), w);
        }
    }
    d
}

/// S_u × S_v, its squared length, and the squared lengths of S_u and S_v.
#[inline(always)]
pub fn normal_terms<const N: usize>(d: &Derivatives<N>) -> (Vec3<N>, Lanes<f32, N>, Lanes<f32, N>, Lanes<f32, N>) {
    let n = cross(d.su, d.sv);
    (n, dot(n, n), dot(d.su, d.su), dot(d.sv, d.sv))
}

/// Whether a normal can be taken from these terms.
#[inline(always)]
pub fn is_regular(n_squared: f32, su_squared: f32, sv_squared: f32) -> bool {
    su_squared > COLLAPSED * COLLAPSED
        && sv_squared > COLLAPSED * COLLAPSED
        && n_squared > PARALLEL * PARALLEL * (su_squared * sv_squared)
}

/// Principal curvatures, greater first, with unit normal `n`, in the frame e1 = S_u / |S_u|, e2 = n × e1.
///
/// There the shape operator is symmetric, so the difference of the two has no cancellation at umbilics.
#[inline(always)]
pub fn curvature<const N: usize>(d: &Derivatives<N>, n: Vec3<N>, su_squared: Lanes<f32, N>) -> [Lanes<f32, N>; 2] {
    let length = su_squared.sqrt();
    let e1 = d.su.map(|x| x / length);
    let e2 = cross(n, e1);
    let g = dot(d.sv, e2);
    let shear = dot(d.sv, e1) / length;
    let l = dot(d.suu, n);
    let m = dot(d.suv, n);
    let nn = dot(d.svv, n);
    let a = l / su_squared;
    let b = (m - shear * l) / (length * g);
    let c = (nn - (shear + shear) * m + shear * shear * l) / (g * g);
    let mean = (a + c) * 0.5;
    let x = (a - c) * 0.5;
    let half = (x * x + b * b).sqrt();
    [mean + half, mean - half]
}

/// Unit vector from the eye to a local point: `eye` is a position and 1, or the direction itself and 0.
#[inline(always)]
pub fn view_direction(eye: [f32; 4], s: [f32; 3]) -> [f32; 3] {
    if eye[3] == 0.0 {
        return [eye[0], eye[1], eye[2]];
    }
    let d = subtract::<1>(s.map(Lanes::splat), [eye[0], eye[1], eye[2]].map(Lanes::splat));
    let length = dot(d, d).sqrt();
    d.map(|x| (x / length).0[0])
}

//! Which mistake explains wrong numbers: each hypothesis is computed in f64 and compared with what was shown.

use crate::Cause;
use gbuffer::Hit;
use glam::{DVec3, DVec4};
use nurbs::{Direction, Surface, basis_derivatives};
use scene::Model;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// A hypothesis holds where it gives the shown position to this share of the face's size: far above f32's rounding,
/// far below what two unrelated answers would share.
const MATCH_SHARE: f64 = 1e-5;

/// A position within this many times its tolerance is called rounding: no mistake of the program is that small.
pub const NEARLY: f64 = 16.0;

/// How many pixels of a comparison may search all faces for the one whose numbers they show.
const FACE_SEARCHES: usize = 256;

/// Explains positions; remembers which other face explained the last one.
pub(crate) struct Attribution<'m> {
    model: &'m Model,
    searches: AtomicUsize,
    /// 1 + how many faces on from the pixel's own the numbers of the last such pixel were, cyclically; 0 for none.
    offset: AtomicUsize,
}

impl<'m> Attribution<'m> {
    pub fn new(model: &'m Model) -> Self {
        Self { model, searches: AtomicUsize::new(0), offset: AtomicUsize::new(0) }
    }

    /// The cause of a position that is `excess` times its tolerance away from S at its own (u, v).
    ///
    /// In this order: u and v exchanged, quotient missing, another span, net transposed, another face; then the
    /// domain's end (whose span is a case of its own), not finite, nearly right, unexplained.
    pub fn of_position(&self, hit: &Hit, excess: f64) -> Cause {
        let surface = self.model.surface(hit.face);
        let [[u0, u1], [v0, v1]] = surface.domain();
        let at_end = hit.uv.x == u1 || hit.uv.y == v1;
        if !hit.position.is_finite() || !hit.uv.is_finite() {
            return if at_end { Cause::Span } else { Cause::NotFinite };
        }
        let near = |s: DVec3| s.distance(hit.position) <= MATCH_SHARE * surface.hull().diagonal();
        let [local_u, local_v] = [(hit.uv.x - u0) / (u1 - u0), (hit.uv.y - v0) / (v1 - v0)];
        if near(surface.point(u0 + (u1 - u0) * local_v, v0 + (v1 - v0) * local_u)) && (local_u - local_v).abs() > 1e-4 {
            return Cause::Parameters;
        }
        if is_numerator(surface, hit) {
            return Cause::Rational;
        }
        if excess <= NEARLY {
            return Cause::Rounding;
        }
        if other_spans(surface, hit).any(near) {
            return Cause::Span;
        }
        if transposed(surface, hit).into_iter().flatten().any(near) {
            return Cause::ControlNet;
        }
        if self.another_face(hit, [local_u, local_v]) {
            return Cause::Face;
        }
        if at_end { Cause::Span } else { Cause::Position }
    }

    fn another_face(&self, hit: &Hit, [local_u, local_v]: [f64; 2]) -> bool {
        let count = self.model.faces().len();
        let matches = |step: usize| {
            let id = (hit.face.0 as usize + step) % count;
            let surface = &self.model.surfaces()[self.model.faces()[id].surface];
            let [[u0, u1], [v0, v1]] = surface.domain();
            let s = surface.point(u0 + (u1 - u0) * local_u, v0 + (v1 - v0) * local_v);
            s.distance(hit.position) <= MATCH_SHARE * surface.hull().diagonal()
        };
        let remembered = self.offset.load(Relaxed);
        if remembered > 0 && matches(remembered) {
            return true;
        }
        if self.searches.fetch_add(1, Relaxed) >= FACE_SEARCHES {
            return false;
        }
        let found = (1..count).find(|&step| matches(step));
        if let Some(step) = found {
            self.offset.store(step, Relaxed);
        }
        found.is_some()
    }
}

/// Positions on the neighbouring spans' polynomials.
fn other_spans<'a>(surface: &'a Surface, hit: &'a Hit) -> impl Iterator<Item = DVec3> + 'a {
    let [ku, kv] = [Direction::U, Direction::V].map(|direction| surface.knots(direction));
    let spans = |knots: &nurbs::KnotVector, t: f64| {
        let (span, all) = (knots.find_span(t), knots.spans().collect::<Vec<_>>());
        let position = all.iter().position(|&k| k == span).expect("a found span is one of them");
        all[position.saturating_sub(1)..(position + 2).min(all.len())].to_vec()
    };
    let (us, vs) = (spans(ku, hit.uv.x), spans(kv, hit.uv.y));
    let own = [ku.find_span(hit.uv.x), kv.find_span(hit.uv.y)];
    us.into_iter()
        .flat_map(move |k| vs.clone().into_iter().map(move |l| [k, l]))
        .filter(move |span| *span != own)
        .map(|[k, l]| surface.first_derivatives_on(k, l, hit.uv.x, hit.uv.y).s)
}

/// Whether the position is the numerator of S, about the surface's origin and up to a power of two.
fn is_numerator(surface: &Surface, hit: &Hit) -> bool {
    if surface.weights().is_none() {
        return false;
    }
    let s = surface.point(hit.uv.x, hit.uv.y) - surface.origin();
    let shown = hit.position - surface.origin();
    let weight = sum(surface, hit, |i, j, _, columns| Some(i * columns + j)).expect("its own net is complete").w;
    let ratio = shown.length() / (s.length() * weight);
    let power = ratio.log2();
    let parallel = shown.cross(s).length() <= MATCH_SHARE * shown.length() * s.length();
    parallel
        && shown.dot(s) > 0.0
        && (power - power.round()).abs() <= MATCH_SHARE
        && (ratio * weight - 1.0).abs() > MATCH_SHARE
}

/// S with the control net read by columns, in the two strides that a slip may use.
fn transposed(surface: &Surface, hit: &Hit) -> [Option<DVec3>; 2] {
    let position = |a: DVec4| surface.origin() + a.truncate() / a.w;
    [
        sum(surface, hit, |i, j, rows, _| Some(j * rows + i)).map(position),
        sum(surface, hit, |i, j, _, columns| Some(j * columns + i)).map(position),
    ]
}

/// Σ N_i N_j c[index(i, j, rows, columns)], or `None` where an index leaves the net.
fn sum(surface: &Surface, hit: &Hit, index: impl Fn(usize, usize, usize, usize) -> Option<usize>) -> Option<DVec4> {
    let [ku, kv] = [Direction::U, Direction::V].map(|direction| surface.knots(direction));
    let (k, l) = (ku.find_span(hit.uv.x), kv.find_span(hit.uv.y));
    let nu = basis_derivatives(ku, k, hit.uv.x, 0);
    let nv = basis_derivatives(kv, l, hit.uv.y, 0);
    let [rows, columns] = surface.control_counts();
    let mut total = DVec4::ZERO;
    for i in 0..=ku.degree() {
        for j in 0..=kv.degree() {
            let at = index(k - ku.degree() + i, l - kv.degree() + j, rows, columns)?;
            total += nu[0][i] * nv[0][j] * DVec4::from_array(*surface.homogeneous().get(at)?);
        }
    }
    Some(total)
}

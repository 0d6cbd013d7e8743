//! Which mistake explains wrong numbers: each hypothesis is computed in f64 and compared with what was shown.

use crate::Cause;
use gbuffer::Hit;
use glam::{DVec3, DVec4};
use nurbs::{Direction, KnotVector, Surface, basis_derivatives};
use scene::Model;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// A hypothesis holds where it gives the shown position to this share of the face's size: far above f32's rounding,
/// far below what two unrelated answers would share.
const MATCH_SHARE: f64 = 1e-5;

/// A value within this many half-widths of its interval is called rounding: no mistake of the program is that small.
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

    /// The cause of a position that is `excess` half-widths away from S at its own (u, v).
    ///
    /// In this order: not finite (or, where nothing of the hit is a number, a slip beyond the knots), u and v exchanged
    /// (a net read by columns gives the same point on a face whose two knot vectors are alike, with the opposite
    /// normal), quotient missing, nearly right, another span (by its knots, or at the same share of it), net transposed, another face, the domain's end (whose
    /// span is a case of its own), unexplained.
    pub fn of_position(&self, hit: &Hit, excess: f64) -> Cause {
        let surface = self.model.surface(hit.face);
        if !hit.position.is_finite() || !hit.uv.is_finite() {
            // Past the knots every basis function is lost, and with them the normal; one that is sound clears the span.
            let is_lost = hit.position.to_array().iter().all(|x| !x.is_finite())
                && !hit.normal.unit().is_some_and(DVec3::is_finite);
            let is_slip = hit.uv.is_finite() && is_lost && on_outermost_span(surface, hit);
            return if is_slip { Cause::Span } else { Cause::NotFinite };
        }
        let [[u0, u1], [v0, v1]] = surface.domain();
        let near = |s: DVec3| s.distance(hit.position) <= MATCH_SHARE * surface.hull().diagonal();
        let [local_u, local_v] = [(hit.uv.x - u0) / (u1 - u0), (hit.uv.y - v0) / (v1 - v0)];
        let exchanged = surface.inspect(u0 + (u1 - u0) * local_v, v0 + (v1 - v0) * local_u);
        if near(exchanged.derivatives.s) {
            let reversed = self.model.faces()[hit.face.0 as usize].reversed;
            let opposite = match (hit.normal.unit(), exchanged.normal.unit()) {
                (Some(shown), Some(n)) => (shown.dot(n) < 0.0) != reversed,
                _ => false,
            };
            return if opposite { Cause::ControlNet } else { Cause::Parameters };
        }
        if is_numerator(surface, hit) {
            return Cause::Rational;
        }
        if excess <= NEARLY {
            return Cause::Rounding;
        }
        if other_spans(surface, hit).chain(slipped_spans(surface, hit)).any(near) {
            return Cause::Span;
        }
        if transposed(surface, hit).into_iter().flatten().any(near) {
            return Cause::ControlNet;
        }
        if self.another_face(hit, [local_u, local_v]) {
            return Cause::Face;
        }
        if hit.uv.x == u1 || hit.uv.y == v1 { Cause::Span } else { Cause::Position }
    }

    fn another_face(&self, hit: &Hit, [local_u, local_v]: [f64; 2]) -> bool {
        let count = self.model.faces().len();
        let matches = |step: usize| {
            let id = (hit.face.0 as usize + step) % count;
            let surface = &self.model.surfaces()[self.model.faces()[id].surface];
            let [[u0, u1], [v0, v1]] = surface.domain();
            let s = surface.point(u0 + (u1 - u0) * local_u, v0 + (v1 - v0) * local_v);
            let own = self.model.surface(hit.face).origin();
            s.distance(hit.position) <= MATCH_SHARE * surface.hull().diagonal()
                || power_of_two(hit.position - own, s - surface.origin()).is_some()
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

/// Whether the parameters are on a first or last span, from which a slip leaves the knot vector.
fn on_outermost_span(surface: &Surface, hit: &Hit) -> bool {
    [(Direction::U, hit.uv.x), (Direction::V, hit.uv.y)].into_iter().any(|(direction, t)| {
        let knots = surface.knots(direction);
        let (first, last) = (knots.spans().next(), knots.spans().last());
        [first, last].contains(&Some(knots.find_span(t)))
    })
}

/// Positions by the basis functions and the part of the net that belong to neighbouring spans, nonempty or not, as a
/// program that is one off in its span reads them: past the end of a row it finds the next row.
fn other_spans<'a>(surface: &'a Surface, hit: &'a Hit) -> impl Iterator<Item = DVec3> + 'a {
    let steps = [-1isize, 0, 1];
    let pairs = steps.into_iter().flat_map(move |k| steps.into_iter().map(move |l| [k, l]));
    pairs.filter(|step| *step != [0, 0]).filter_map(move |step| {
        let a = sum(surface, hit, step, |i, j, _, columns| i * columns + j)?;
        Some(surface.origin() + a.truncate() / a.w)
    })
}

/// Positions on the neighbouring spans that are not empty, at the same shares of them: what a program that is one off in its
/// span reads by parameters local to it.
fn slipped_spans<'a>(surface: &'a Surface, hit: &'a Hit) -> impl Iterator<Item = DVec3> + 'a {
    let places = |direction: Direction, t: f64| {
        let knots = surface.knots(direction);
        let all = knots.knots();
        let spans: Vec<usize> = knots.spans().collect();
        let own = spans.iter().position(|&span| span == knots.find_span(t)).expect("a parameter is on a span");
        let share = (t - all[spans[own]]) / (all[spans[own] + 1] - all[spans[own]]);
        let near = own.saturating_sub(1)..(own + 2).min(spans.len());
        near.map(|k| all[spans[k]] + share * (all[spans[k] + 1] - all[spans[k]])).collect::<Vec<f64>>()
    };
    let (us, vs) = (places(Direction::U, hit.uv.x), places(Direction::V, hit.uv.y));
    us.into_iter().flat_map(move |u| vs.clone().into_iter().map(move |v| surface.point(u, v)))
}

/// The whole power p for which a = 2ᵖ b, if there is one.
fn power_of_two(a: DVec3, b: DVec3) -> Option<f64> {
    let power = (a.length() / b.length()).log2();
    let parallel = a.distance(b * power.round().exp2()) <= MATCH_SHARE * a.length();
    (power.is_finite() && parallel).then(|| power.round())
}

/// Whether the position is the numerator of S: about the surface's origin and up to a power of two, as our program has
/// it, or about the world's, as others may.
fn is_numerator(surface: &Surface, hit: &Hit) -> bool {
    if surface.weights().is_none() {
        return false;
    }
    let numerator = sum(surface, hit, [0, 0], |i, j, _, columns| i * columns + j).expect("its own net is complete");
    let of_world = numerator.truncate() + numerator.w * surface.origin();
    power_of_two(hit.position - surface.origin(), numerator.truncate()).is_some()
        || hit.position.distance(of_world) <= MATCH_SHARE * surface.hull().diagonal()
}

/// S with the control net read by columns, in the two strides that a slip may use.
fn transposed(surface: &Surface, hit: &Hit) -> [Option<DVec3>; 2] {
    let position = |a: DVec4| surface.origin() + a.truncate() / a.w;
    [
        sum(surface, hit, [0, 0], |i, j, rows, _| j * rows + i).map(position),
        sum(surface, hit, [0, 0], |i, j, _, columns| j * columns + i).map(position),
    ]
}

/// Σ N_i N_j c[index(i, j, rows, columns)] on the span `step` away from the hit's own, or `None` where an index leaves
/// the knots or the net.
fn sum(
    surface: &Surface,
    hit: &Hit,
    step: [isize; 2],
    index: impl Fn(usize, usize, usize, usize) -> usize,
) -> Option<DVec4> {
    let [ku, kv] = [Direction::U, Direction::V].map(|direction| surface.knots(direction));
    let moved = |knots: &KnotVector, t: f64, step: isize| {
        let span = knots.find_span(t).checked_add_signed(step)?;
        (span >= knots.degree() && span + knots.degree() < knots.knots().len()).then_some(span)
    };
    let (k, l) = (moved(ku, hit.uv.x, step[0])?, moved(kv, hit.uv.y, step[1])?);
    let nu = basis_derivatives(ku, k, hit.uv.x, 0);
    let nv = basis_derivatives(kv, l, hit.uv.y, 0);
    let [rows, columns] = surface.control_counts();
    let mut total = DVec4::ZERO;
    for i in 0..=ku.degree() {
        for j in 0..=kv.degree() {
            let at = index(k - ku.degree() + i, l - kv.degree() + j, rows, columns);
            total += nu[0][i] * nv[0][j] * DVec4::from_array(*surface.homogeneous().get(at)?);
        }
    }
    Some(total)
}

//! Ray ∩ piece by Newton's method, at a fragment of technique `exact`. Twin of `shaders/exact/newton.wgsl`.
//!
//! The ray of a pixel is two planes ([`Sight`]): S(u, v) is on it where its offset from the pixel, in pixels, vanishes
//! in x and in y. The offset is the projection of S less the pixel's position, so its size means the same whatever the
//! distance, the focal length and the scale of the face.
//!
//! * **Seeds.** The ray enters and leaves the piece's hull; at both places the piece, taken as flat, says (u, v). Where
//!   the two are within a quarter of the piece they are one seed, half way. A piece is nearly flat, so a ray that
//!   meets it twice (a fold) runs along its hull, and meets it once from either end. Where a search ends at a place
//!   that is seen edge-on, [`again`] says where the ray may meet the piece again, and more searches begin there; where it ends
//!   behind the eye, without an answer, or without a hit of a piece that is large or twisted, at [`RESTARTS`], from
//!   where the first [`APPROACHES`] steps take the offset times w.
//! * **Steps.** Newton's step on the 2 × 2 system; where its columns are nearly parallel (a silhouette, a pole), a
//!   step of Levenberg and Marquardt. No step is longer than the piece, or half of it where the
//!   piece is seen edge-on, none leaves it by more than [`BEYOND`](super::place::BEYOND) of it: at
//!   that border the search slides along. A
//!   step that brings the offset no nearer to zero is halved, up to [`HALVINGS`] times. Behind the eye the offset is taken
//!   times w, which has the same zeros and no pole: from there the search comes forward, and never goes back.
//! * **End.** Where the step is so short that it is as good as exact: it is taken and not evaluated, for what it leaves
//!   is quadratic in it and bounded by how far a piece turns ([`LAST_BEND_PX`]) and recedes; on a twisted piece only an
//!   offset that was evaluated counts. Or where the tangent plane, followed as far as
//!   the step may go, brings the offset not even to half ([`PROMISE`]): it has a minimum there that is no zero, or the
//!   ray passes the piece. Where the tangent plane promises much and holds little, close by a fold
//!   ([`NEAR_FOLD_PX`]), and where a collapsed edge twists the piece, the search has some
//!   [patience](PieceRecord::patience). Where no step comes nearer, for all is within what f32 leaves of S and of the
//!   parameters ([`ROUNDING`](super::place::ROUNDING)), the place is as good as any. Or after [`EVALUATIONS`].
//! * **Outcome.** A hit where the place found lies on the piece or within [`NEAR_PX`] (or what f32 leaves) of its border, between the near
//!   and the far plane. A miss where it lies beyond, or where no step promised enough. Anything else has not converged, and
//!   says so.

use super::fold::{QUEUE, Queue, RESTARTS, again};
use super::place::{Place, Problem, extent, is_edge_on, searched};
use super::record::PieceRecord;
use nurbs::MAX_ORDER;
use pipeline::sight::{Footprint, NEAR_PX, NEARLY_SINGULAR, Sight, across, dot, is_shown, near_px, plane};
use pipeline::{FaceRecord, PackedScene};
use std::cell::Cell;

/// Evaluations of S from one seed, at most.
pub const EVALUATIONS: u32 = 32;

/// A step is the last where its squared share of the piece times the piece's longer side, in pixels, is at most this:
/// the piece turns by half a radian along each parameter, so a quarter of it, 1/512 pixel, is what the step leaves
/// in each direction.
pub const LAST_BEND_PX: f32 = 1.0 / 128.0;

/// An offset that counts as none, pixels. At a silhouette Newton's step is long however small the offset.
pub const FINE_PX: f32 = 1.0 / 1024.0;

/// The least share of the squared offset that a step must promise to take away.
pub const PROMISE: f32 = 3.0 / 4.0;

/// A step that takes less than this share of the squared offset away is as doubtful as one that promised little. Toward
/// a double root Newton's step takes 15/16.
pub const SLOW: f32 = 1.0 / 2.0;

/// How far inside the piece a seed stays, as a share of it: at a pole the derivatives tell no direction.
pub const INSIDE: f32 = 1.0 / 16.0;

/// Seeds nearer to each other than this share of the piece are one.
pub const ONE_SEED: f32 = 1.0 / 4.0;

/// Halvings of one step: where none of them comes nearer, the offset has a minimum.
pub const HALVINGS: u32 = 4;

/// The longest step where the piece is seen edge-on, as a share of it: a longer one might jump over a fold.
pub const STEP_EDGE_ON: f32 = 1.0 / 2.0;

/// Doubtful steps which a search takes after a step that promised much, close by a fold, or on a piece whose
/// derivatives change by more than they measure where they are least, as at a collapsed edge.
pub const PATIENCE: u32 = 4;

/// The same farther from a fold: what the piece does beyond the fold is not for this search to find.
pub const PATIENCE_EDGE_ON: u32 = 1;

/// A search that is nearer than this to the ray where the piece is seen edge-on is close by a fold, pixels.
pub const NEAR_FOLD_PX: f32 = 1.0 / 4.0;

/// Two searches that end nearer to each other than this share of the piece have ended at one place.
pub const ONE_END: f32 = 1.0 / 64.0;

/// A piece whose longer side measures more than this, in pixels, is seen from so near that its picture is far from flat. It is
/// measured where the ray comes into its hull: a search that is led away from the eye ends where the piece is small.
pub const LARGE_PX: f32 = 1024.0;

/// A search that ends at a border of a twisted piece and misses by no more than this, pixels, may have gone away from the root,
/// beyond a fold.
pub const NEAR_TWISTED_PX: f32 = 1.0 / 2.0;

/// Only a twisted piece whose longer side measures more than this there, pixels: smaller ones are nearly met by every ray that
/// meets a neighbour.
pub const TWISTED_SIDE_PX: f32 = 16.0;

/// Steps of those searches by the offset times w, which go first and are not weighed: in pixels all is small far off, so that
/// near the eye less offset leads away from it; times w the offset is as flat as the piece.
pub const APPROACHES: u32 = 4;

/// Weight of the damping then, as a share of the squared columns.
pub const DAMPING: f32 = 1.0 / 1048576.0;

/// What a piece is to a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// The pixel's ray meets it.
    Hit {
        /// Parameters of the span, inside the piece.
        uv: [f32; 2],
        /// z / w there.
        depth: f32,
    },
    /// It does not.
    Miss,
    /// The search ended without an answer.
    Unconverged,
}

/// What a search found, and what it took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// The nearest point of the piece.
    pub outcome: Outcome,
    /// How often the surface was evaluated.
    pub evaluations: u32,
}

/// Where a search ended.
#[derive(Clone, Copy)]
pub(super) struct End {
    outcome: Outcome,
    at: Place,
}

/// The nearest point of a piece on a pixel's ray.
pub fn solve(scene: &PackedScene, piece: &PieceRecord, sight: &Sight) -> Solution {
    let Some(seeds) = seeds(piece, sight) else {
        return Solution { outcome: Outcome::Miss, evaluations: 0 };
    };
    let problem = Problem::new(scene, piece, sight, seeds.1);
    match problem.degree {
        [3, 3] => problem.search_all::<4>(seeds.0, None),
        [5, 5] => problem.search_all::<6>(seeds.0, None),
        _ => problem.search_all::<MAX_ORDER>(seeds.0, None),
    }
}

/// Parameters where the ray enters and leaves the hull, as if the piece were flat; `None` where it does not meet it in
/// front of the near plane.
#[inline]
pub(super) fn seeds(piece: &PieceRecord, sight: &Sight) -> Option<([[f32; 2]; 2], f32)> {
    let rows = &piece.hull_from_local;
    let center = [rows[0][3], rows[1][3], rows[2][3]];
    let [x, y] = [&sight.x, &sight.y].map(|p| [p[0], p[1], p[2]]);
    // The point of the ray nearest to the centre, about the centre.
    let (at_x, at_y) = (plane(&sight.x, center), plane(&sight.y, center));
    let (xx, xy, yy) = (dot(x, x), dot(x, y), dot(y, y));
    let det = xx * yy - xy * xy;
    let (a, b) = ((xy * at_y - yy * at_x) / det, (xy * at_x - xx * at_y) / det);
    let from: [f32; 3] = std::array::from_fn(|i| a * x[i] + b * y[i]);
    let direction = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
    // The part of the ray inside the hull, and behind the near plane: w − z is not negative.
    let (mut near, mut far) = (f32::MIN, f32::MAX);
    for row in rows {
        let row = [row[0], row[1], row[2]];
        let (start, speed) = (dot(row, from), dot(row, direction));
        if speed != 0.0 {
            let (first, last) = ((-1.0 - start) / speed, (1.0 - start) / speed);
            near = near.max(first.min(last));
            far = far.min(first.max(last));
        } else if start.abs() > 1.0 {
            (near, far) = (f32::MAX, f32::MIN);
        }
    }
    let beyond: [f32; 4] = std::array::from_fn(|i| sight.w[i] - sight.z[i]);
    let start = plane(&beyond, std::array::from_fn(|i| center[i] + from[i]));
    let speed = dot([beyond[0], beyond[1], beyond[2]], direction);
    if speed > 0.0 {
        near = near.max(-start / speed);
    }
    if speed < 0.0 {
        far = far.min(-start / speed);
    }
    if near > far {
        return None;
    }
    let parameters = |along: f32| {
        let h = [0, 1].map(|k| {
            let row = [rows[k][0], rows[k][1], rows[k][2]];
            dot(row, from) + along * dot(row, direction)
        });
        let [u, v] = [0, 1].map(|k| piece.flat[k] + piece.flat[2 + k] * h[k]);
        [inside(piece, 0, u), inside(piece, 1, v)]
    };
    let w = |along: f32| plane(&sight.w, std::array::from_fn(|i| center[i] + (from[i] + along * direction[i])));
    Some(([parameters(near), parameters(far)], w(near).min(w(far))))
}

/// One search: the best place so far, and the step from it. The twin's `search` has this in its loop.
pub(super) struct Walk {
    best: Place,
    step: [f32; 2],
    /// Where the surface is wanted next.
    pub uv: [f32; 2],
    /// Places that were looked at.
    places: u32,
    doubts: u32,
    halvings: u32,
}

impl Walk {
    /// A search that begins at a place. [`Self::judge`] says how to go on.
    #[inline(always)]
    pub fn new(piece: &PieceRecord, at: Place) -> Self {
        let [low, high] = searched(piece);
        let step = slid(&at, newton_step(&at), low, high);
        Self { best: at, step, uv: at.uv, places: 1, doubts: 0, halvings: 0 }
    }

    /// Takes the place that was wanted; where the search ends, says how.
    #[inline(always)]
    pub fn advance(&mut self, piece: &PieceRecord, next: Place) -> Option<End> {
        let [low, high] = searched(piece);
        let best = &self.best;
        let comes_forward = best.w <= 0.0 && next.w > 0.0;
        let goes_back = best.w > 0.0 && next.w <= 0.0;
        let improved = comes_forward || (!goes_back && next.squared < best.squared);
        let slow = !comes_forward && next.squared > (1.0 - SLOW) * best.squared;
        self.places += 1;
        if improved {
            self.best = next;
            self.step = slid(&next, newton_step(&next), low, high);
            self.halvings = 0;
        } else if self.halvings == HALVINGS {
            return Some(End { outcome: stopped(piece, &self.best, !goes_back), at: self.best });
        } else {
            self.step = self.step.map(|x| x * 0.5);
            self.halvings += 1;
        }
        self.judge(piece, improved, slow)
    }

    /// Whether the search is over; if not, where it goes.
    #[inline(always)]
    pub fn judge(&mut self, piece: &PieceRecord, improved: bool, slow: bool) -> Option<End> {
        let extent = extent(piece);
        let [low, high] = searched(piece);
        let Self { best, step, .. } = *self;
        let longest = step[0].abs().max(step[1].abs());
        let bend = longest * longest;
        let recedes = best.recedes[0] * step[0] + best.recedes[1] * step[1];
        let is_last = piece.patience == 0
            && best.w > 0.0
            && bend * bend * best.side_squared <= LAST_BEND_PX * LAST_BEND_PX
            && recedes * recedes * best.squared <= FINE_PX * FINE_PX
            && left_squared(&best, step) <= FINE_PX * FINE_PX;
        if is_last {
            return Some(End { outcome: arrived(piece, &best, step), at: best });
        }
        if best.w > 0.0 && best.squared <= FINE_PX * FINE_PX {
            return Some(End { outcome: arrived(piece, &best, [0.0; 2]), at: best });
        }
        let uv = [0, 1].map(|k| (best.uv[k] + step[k] * extent[k]).max(low[k]).min(high[k]));
        let promising = promises(&best, [0, 1].map(|k| (uv[k] - best.uv[k]) / extent[k]));
        if improved && (slow || !promising) {
            if self.doubts >= patience(piece, &best, promising) || uv == best.uv {
                return Some(End { outcome: stopped(piece, &best, true), at: best });
            }
            self.doubts += 1;
        }
        self.uv = uv;
        (self.places == EVALUATIONS).then(|| End { outcome: stopped(piece, &best, false), at: best })
    }
}

impl<'a> Problem<'a> {
    pub(super) fn new(scene: &'a PackedScene, piece: &'a PieceRecord, sight: &'a Sight, nearest_w: f32) -> Self {
        let face = &scene.faces()[piece.face as usize];
        let degree = [face.degree_u, face.degree_v].map(|p| p as usize);
        Self { scene, piece, sight, nearest_w, degree, evaluations: Cell::new(0) }
    }

    /// The first seeds: both ends, or one between them.
    #[inline(always)]
    pub(super) fn queue(&self, [first, last]: [[f32; 2]; 2]) -> Queue {
        let mut queue = Queue { seeds: [[0.0; 2]; QUEUE], count: 0 };
        if self.near(first, last, ONE_SEED) {
            queue.push([0, 1].map(|k| 0.5 * (first[k] + last[k])));
        } else {
            queue.push(first);
            queue.push(last);
        }
        queue
    }

    /// Whether two places are within a share of the piece.
    #[inline(always)]
    fn near(&self, a: [f32; 2], b: [f32; 2], share: f32) -> bool {
        let extent = extent(self.piece);
        (0..2).all(|k| (a[k] - b[k]).abs() <= share * extent[k])
    }

    /// Searches from all seeds; `begun` is how the first search ended, where that is known.
    #[inline(always)]
    pub(super) fn search_all<const CAPACITY: usize>(&self, seeds: [[f32; 2]; 2], begun: Option<End>) -> Solution {
        let extent = extent(self.piece);
        let mut queue = self.queue(seeds);
        let face = &self.scene.faces()[self.piece.face as usize];
        let given = queue.count;
        let mut before = [f32::MAX; 2];
        let mut restarts = QUEUE..QUEUE;
        let mut approaches = 0;
        let mut best = Outcome::Miss;
        let mut k = 0;
        while k < queue.count {
            let end = match begun {
                Some(end) if k == 0 => end,
                _ => self.search::<CAPACITY>(queue.seeds[k], if restarts.contains(&k) { approaches } else { 0 }),
            };
            best = match (best, end.outcome) {
                (Outcome::Hit { depth: old, .. }, Outcome::Hit { depth: new, .. }) if new <= old => best,
                (_, Outcome::Hit { uv, .. }) if is_shown(self.scene, face, &self.footprint(face, &end.at, uv)) => {
                    end.outcome
                }
                (Outcome::Miss, Outcome::Unconverged) => end.outcome,
                _ => best,
            };
            let may_be_led_away = match end.outcome {
                Outcome::Hit { .. } => false,
                Outcome::Miss => end.at.w <= 0.0 || self.is_large_near(&end.at),
                Outcome::Unconverged => true,
            };
            let may_be_beyond_a_fold = end.outcome == Outcome::Miss && is_near_twisted(self.piece, &end.at);
            if k < given && restarts.is_empty() && (may_be_led_away || may_be_beyond_a_fold) {
                restarts = queue.count..queue.count + RESTARTS.len();
                approaches = if may_be_led_away { APPROACHES } else { 0 };
                for [s, t] in RESTARTS {
                    queue.push([0, 1].map(|k| self.piece.rectangle[k] + [s, t][k] * extent[k]));
                }
            }
            if k < given && end.at.w > 0.0 && is_edge_on(&end.at) && !self.near(end.at.uv, before, ONE_END) {
                let is_met = matches!(end.outcome, Outcome::Hit { .. });
                again::<CAPACITY>(self, &end.at, is_met, &mut queue);
            }
            before = end.at.uv;
            k += 1;
        }
        Solution { outcome: best, evaluations: self.evaluations.get() }
    }

    #[inline(always)]
    fn search<const CAPACITY: usize>(&self, seed: [f32; 2], approaches: u32) -> End {
        let piece = self.piece;
        let extent = extent(piece);
        let [low, high] = searched(piece);
        let mut uv = seed;
        for _ in 0..approaches {
            let at = self.place::<CAPACITY>(uv, false);
            let step = slid(&at, newton_step(&at), low, high);
            uv = [0, 1].map(|k| (uv[k] + step[k] * extent[k]).max(low[k]).min(high[k]));
        }
        let mut walk = Walk::new(piece, self.place::<CAPACITY>(uv, true));
        let mut end = walk.judge(piece, true, false);
        loop {
            match end {
                Some(end) => return end,
                None => end = walk.advance(piece, self.place::<CAPACITY>(walk.uv, true)),
            }
        }
    }

    /// Whether the piece measures more than [`LARGE_PX`] where the ray comes into its hull, by what it does at a place.
    #[inline(always)]
    fn is_large_near(&self, at: &Place) -> bool {
        at.side_squared * (at.w * at.w) > LARGE_PX * LARGE_PX * (self.nearest_w * self.nearest_w)
    }

    /// The footprint of a pixel whose ray meets the piece at `uv`, by the place where the search came to know.
    fn footprint(&self, face: &FaceRecord, at: &Place, uv: [f32; 2]) -> Footprint {
        let spans = self.scene.spans(face, [self.piece.span_u, self.piece.span_v]);
        let (right, up) = across(at.along_u, at.along_v);
        let extent = extent(self.piece);
        let gain = |gain: [f32; 2]| [0, 1].map(|k| gain[k] * (extent[k] * spans[k].length));
        let center = [0, 1].map(|k| spans[k].whole(uv[k]));
        let near_px = near_px(at.along_u, at.along_v, at.sides_squared);
        Footprint { center, right: gain(right), up: gain(up), near_px, step_squared: 0.0 }
    }
}

/// A parameter moved into the part of the piece where seeds may stand.
#[inline(always)]
fn inside(piece: &PieceRecord, k: usize, t: f32) -> f32 {
    let margin = INSIDE * extent(piece)[k];
    t.max(piece.rectangle[k] + margin).min(piece.rectangle[2 + k] - margin)
}

/// Doubtful steps that a search takes after a step that promised much or not.
#[inline(always)]
fn patience(piece: &PieceRecord, at: &Place, promised: bool) -> u32 {
    let is_edge_on = is_edge_on(at);
    if promised || (is_edge_on && at.squared <= NEAR_FOLD_PX * NEAR_FOLD_PX) {
        PATIENCE
    } else if is_edge_on {
        piece.patience.max(PATIENCE_EDGE_ON)
    } else {
        piece.patience
    }
}

/// What it means to end at a place from which no step comes nearer (`settled`), or none was left to try.
#[inline]
fn stopped(piece: &PieceRecord, at: &Place, settled: bool) -> Outcome {
    if at.w > 0.0 && at.squared <= at.rounding_squared {
        arrived(piece, at, [0.0; 2])
    } else if settled {
        Outcome::Miss
    } else {
        Outcome::Unconverged
    }
}

/// What it means to end at a place and a step from there.
#[inline]
fn arrived(piece: &PieceRecord, at: &Place, step: [f32; 2]) -> Outcome {
    let extent = extent(piece);
    let uv = [0, 1].map(|k| at.uv[k] + step[k] * extent[k]);
    let inside = [0, 1].map(|k| uv[k].max(piece.rectangle[k]).min(piece.rectangle[2 + k]));
    // How far the border is, in pixels, and along the ray.
    let back = [0, 1].map(|k| (inside[k] - uv[k]) / extent[k]);
    let moved = moved(at, back);
    let depth = at.depth[0] + at.depth[1] * (step[0] + back[0]) + at.depth[2] * (step[1] + back[1]);
    // Two pieces that meet there may each be off by what f32 leaves.
    let near = moved[0] * moved[0] + moved[1] * moved[1] <= (NEAR_PX * NEAR_PX).max(at.rounding_squared);
    if near && (0.0..=1.0).contains(&depth) { Outcome::Hit { uv: inside, depth } } else { Outcome::Miss }
}

/// Whether the tangent plane, followed by `step`, takes [`PROMISE`] of the squared offset away. Behind the eye anything
/// may come.
#[inline]
fn promises(at: &Place, step: [f32; 2]) -> bool {
    at.w <= 0.0 || left_squared(at, step) <= (1.0 - PROMISE) * at.squared
}

/// The square of the offset that a step along the tangent plane leaves.
#[inline(always)]
fn left_squared(at: &Place, step: [f32; 2]) -> f32 {
    let moved = moved(at, step);
    let left = [at.offset[0] + moved[0], at.offset[1] + moved[1]];
    left[0] * left[0] + left[1] * left[1]
}

/// By how many pixels a step along the tangent plane moves the offset.
#[inline(always)]
fn moved(at: &Place, step: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|k| at.along_u[k] * step[0] + at.along_v[k] * step[1])
}

/// A step that would leave the part that may be searched: along the border instead, to where the offset is least.
#[inline]
fn slid(at: &Place, step: [f32; 2], low: [f32; 2], high: [f32; 2]) -> [f32; 2] {
    let leaves = |k: usize| (at.uv[k] <= low[k] && step[k] < 0.0) || (at.uv[k] >= high[k] && step[k] > 0.0);
    let along = |a: [f32; 2]| {
        let squared = a[0] * a[0] + a[1] * a[1];
        if squared == 0.0 { 0.0 } else { (-(a[0] * at.offset[0] + a[1] * at.offset[1]) / squared).clamp(-1.0, 1.0) }
    };
    match [leaves(0), leaves(1)] {
        [true, true] => [0.0, 0.0],
        [true, false] => [0.0, along(at.along_v)],
        [false, true] => [along(at.along_u), 0.0],
        [false, false] => step,
    }
}

/// Whether a search ended at a border of a twisted piece, and so near the ray that it may have gone to the wrong one.
#[inline(always)]
fn is_near_twisted(piece: &PieceRecord, at: &Place) -> bool {
    let [low, high] = searched(piece);
    piece.patience > 0
        && at.squared <= NEAR_TWISTED_PX * NEAR_TWISTED_PX
        && at.side_squared > TWISTED_SIDE_PX * TWISTED_SIDE_PX
        && (0..2).any(|k| at.uv[k] <= low[k] || at.uv[k] >= high[k])
}

/// The step toward zero offset, as shares of the piece: at most one piece long, less where it is seen edge-on.
#[inline]
fn newton_step(at: &Place) -> [f32; 2] {
    let Place { offset, along_u: a, along_v: b, .. } = *at;
    let det = a[0] * b[1] - a[1] * b[0];
    let (aa, bb) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
    let step = if det.abs() > NEARLY_SINGULAR * (aa + bb) {
        [(b[0] * offset[1] - b[1] * offset[0]) / det, (a[1] * offset[0] - a[0] * offset[1]) / det]
    } else {
        let damping = DAMPING * (aa + bb);
        let ab = a[0] * b[0] + a[1] * b[1];
        let (gu, gv) = (a[0] * offset[0] + a[1] * offset[1], b[0] * offset[0] + b[1] * offset[1]);
        let (uu, vv) = (aa + damping, bb + damping);
        let det = uu * vv - ab * ab;
        if det == 0.0 {
            return [0.0; 2];
        }
        [(ab * gv - vv * gu) / det, (ab * gu - uu * gv) / det]
    };
    // The two directions are independent but at a fold, which one of them crosses.
    let longest = step[0].abs().max(step[1].abs());
    if !is_edge_on(at) {
        step.map(|x| x.clamp(-1.0, 1.0))
    } else if longest > STEP_EDGE_ON {
        step.map(|x| x * (STEP_EDGE_ON / longest))
    } else {
        step
    }
}

//! Loops that close by themselves, as curves that points are inside or outside of.

use super::chain::Chain;
use super::frame::Frame;
use super::segment::Segment;
use crate::SceneError;
use glam::DVec2;
use nurbs::{BezierCurve, Rectangle};

/// How often a loop may be repeated where it leaves the domain of a closed surface: a spiral of 64 turns, say.
const MAX_COPIES: usize = 64;

/// A copy of a loop counts where it reaches into the domain by more than this share of the domain's length.
const REACHES_IN: f64 = 1e-6;

/// A loop that is thinner on average than this share of the domain encloses nothing but rounding.
const THIN: f64 = 1e-12;

/// Heights at which a point inside a loop is looked for.
const HEIGHTS: usize = 5;

/// A loop with what is needed to say whether a point lies in it.
pub(super) struct Contour<'a> {
    pub chain: &'a Chain,
    /// The segments cut where u or v turns back.
    pub monotone: Vec<Segment>,
    /// Signed, of one copy.
    pub area: f64,
    /// Offsets by whole periods at which it reaches into the domain.
    pub copies: Vec<DVec2>,
}

impl<'a> Contour<'a> {
    pub fn new(frame: &Frame, chain: &'a Chain) -> Result<Self, SceneError> {
        let area = signed_area(&chain.segments);
        let copies = copies(frame, chain)?;
        Ok(Self { chain, monotone: monotone(&chain.segments), area, copies })
    }

    /// Whether the loop runs back on itself, or is thinner than a picture could show.
    pub fn encloses_nothing(&self, frame: &Frame) -> bool {
        let (size, domain) = (self.chain.hull.size(), frame.domain.size());
        let rounding = f64::EPSILON * self.chain.segments.len() as f64 * size.x * size.y;
        self.area.abs() <= rounding.max(THIN * (size.x * domain.y + size.y * domain.x))
    }

    /// Points inside the loop, as far from it as they come at several heights.
    ///
    /// Another loop that crosses this one nowhere holds all of them or none, also where both share sides.
    pub fn interior(&self) -> Vec<DVec2> {
        let Rectangle { min, max } = self.chain.hull;
        // No even share: corners of shapes along the axes stand there.
        let height = |i: usize| min.y + (max.y - min.y) * (i as f64 + 0.618) / HEIGHTS as f64;
        (0..HEIGHTS).filter_map(|i| widest(curves(&self.monotone), height(i))).collect()
    }

    /// Whether a copy of the loop holds the point.
    pub fn holds(&self, point: DVec2) -> bool {
        let inside = |offset: &DVec2| {
            let local = point - *offset;
            let hull = self.chain.hull;
            hull.min.cmple(local).all() && local.cmple(hull.max).all() && winding(curves(&self.monotone), local) != 0
        };
        self.copies.iter().any(inside)
    }
}

/// The middle of the widest stretch of a height that is inside a closed chain of monotone pieces.
fn widest<'a>(pieces: impl IntoIterator<Item = &'a BezierCurve>, v: f64) -> Option<DVec2> {
    let mut crossings: Vec<(f64, i32)> = vec![];
    for piece in pieces {
        let (a, b) = (piece.start().y, piece.end().y);
        if a.min(b) <= v && v < a.max(b) {
            crossings.push((at_height(piece, v), if a < b { 1 } else { -1 }));
        }
    }
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0;
    let inside = crossings.windows(2).filter_map(|pair| {
        sum += pair[0].1;
        (sum != 0).then_some([pair[0].0, pair[1].0])
    });
    let [low, high] = inside.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
    Some(DVec2::new(0.5 * (low + high), v))
}

/// The offsets by whole periods at which a loop reaches into the domain; none but zero on an open surface.
fn copies(frame: &Frame, chain: &Chain) -> Result<Vec<DVec2>, SceneError> {
    let (size, hull, Rectangle { min, max }) = (frame.domain.size(), chain.hull, frame.domain);
    let range = |axis: usize| {
        let slack = REACHES_IN * size[axis];
        let outside = hull.min[axis] < min[axis] - slack || max[axis] + slack < hull.max[axis];
        if !outside || !frame.closed[axis] {
            return [0.0, 0.0];
        }
        // hull + k period meets the domain by more than the slack
        let first = ((min[axis] + slack - hull.max[axis]) / size[axis]).ceil();
        let last = ((max[axis] - slack - hull.min[axis]) / size[axis]).floor();
        if first <= last { [first, last] } else { [0.0, 0.0] }
    };
    let ranges = [range(0), range(1)];
    let [along_u, along_v] = ranges.map(|[first, last]| last - first + 1.0);
    let copies = along_u * along_v;
    // Counted before any is made.
    if copies.is_nan() || MAX_COPIES as f64 <= copies - 1.0 {
        let (face, boundary) = (frame.face, chain.source);
        return Err(SceneError::LoopReach { face, boundary, copies, limit: MAX_COPIES });
    }
    let steps = |[first, last]: [f64; 2]| (0..=(last - first) as usize).map(move |k| first + k as f64);
    Ok(steps(ranges[0]).flat_map(|i| steps(ranges[1]).map(move |j| DVec2::new(i, j) * size)).collect())
}

/// The signed area of a closed chain: positive counter-clockwise.
pub(super) fn signed_area(segments: &[Segment]) -> f64 {
    let about = segments[0].curve.start();
    segments.iter().map(|s| s.curve.area(about)).sum()
}

/// Segments cut where u or v turns back.
pub(super) fn monotone(segments: &[Segment]) -> Vec<Segment> {
    let pieces = |s: &Segment| s.curve.monotone_pieces().into_iter();
    segments.iter().flat_map(|s| pieces(s).map(|curve| Segment { curve, ..*s })).collect()
}

/// The curves of segments.
pub(super) fn curves(segments: &[Segment]) -> impl Iterator<Item = &BezierCurve> {
    segments.iter().map(|s| &s.curve)
}

/// The winding number of a closed chain of monotone pieces about a point, by crossings with the ray toward +u.
///
/// Exact but for points nearer to a piece than its evaluation's rounding.
pub(super) fn winding<'a>(pieces: impl IntoIterator<Item = &'a BezierCurve>, point: DVec2) -> i32 {
    let crossed = pieces.into_iter().filter(|piece| is_crossed(piece, point));
    crossed.map(|piece| if piece.start().y < piece.end().y { 1 } else { -1 }).sum()
}

/// Whether the ray from a point toward +u crosses a monotone piece.
pub(crate) fn is_crossed(piece: &BezierCurve, point: DVec2) -> bool {
    let (a, b) = (piece.start(), piece.end());
    let (low, high) = (a.y.min(b.y), a.y.max(b.y));
    low <= point.y && point.y < high && point.x < a.x.max(b.x) && (point.x < a.x.min(b.x) || is_beyond(piece, point))
}

/// Whether a monotone piece passes the height of a point, within its range, at a greater u than the point's.
///
/// As [`at_height`] says, but ended where both ends of what is left of the piece are on one side of the point.
fn is_beyond(piece: &BezierCurve, point: DVec2) -> bool {
    let rises = piece.start().y < piece.end().y;
    let (mut low, mut high) = (0.0, 1.0);
    let mut ends = [piece.start().x, piece.end().x];
    loop {
        let middle = 0.5 * (low + high);
        let at = piece.point(middle);
        let is_last = middle <= low || middle >= high;
        if (at.y <= point.y) == rises {
            (low, ends[0]) = (middle, at.x)
        } else {
            (high, ends[1]) = (middle, at.x)
        }
        let is_below = ends.map(|u| point.x < u);
        if is_last || is_below[0] == is_below[1] {
            return point.x < at.x;
        }
    }
}

/// u of a piece, monotone in v, at height `v` within its range.
fn at_height(piece: &BezierCurve, v: f64) -> f64 {
    let rises = piece.start().y < piece.end().y;
    let (mut low, mut high) = (0.0, 1.0);
    loop {
        let middle = 0.5 * (low + high);
        let point = piece.point(middle);
        if middle <= low || middle >= high {
            return point.x;
        }
        if (point.y <= v) == rises { low = middle } else { high = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// Numbers in [0, 1), the same on every machine (Steele & Vigna 2021, splitmix64).
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    #[test]
    fn the_side_of_a_piece_is_that_of_its_point_at_the_same_height() {
        let mut state = 7;
        let mut beyond = 0;
        for case in 0..2000 {
            let control = (0..2 + case % 4).map(|_| {
                let [u, v, w] = [0; 3].map(|_| random(&mut state));
                DVec3::new(u, v, 1.0) * (0.1 + w)
            });
            let curve = BezierCurve::new(control.collect()).expect("a legal curve");
            for piece in curve.monotone_pieces() {
                let Rectangle { min, max } = piece.hull();
                let inside = min + (max - min) * DVec2::new(random(&mut state), random(&mut state));
                let at = at_height(&piece, inside.y);
                let near = [at - 1e-12, at + 1e-12].map(|u| DVec2::new(u, inside.y));
                for point in [inside, near[0], near[1]] {
                    assert_eq!(is_beyond(&piece, point), point.x < at, "case {case}: {point:?} of {piece:?}");
                    beyond += usize::from(point.x < at);
                }
            }
        }
        assert!(beyond > 1000, "{beyond}");
    }
}

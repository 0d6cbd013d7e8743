//! Winding numbers the slow and plain way: crossings of a ray with chords of the curves, halved near the point.
//!
//! It shares no code with any renderer, and with the program that froze the answers nothing but the definition of a
//! B-spline.

use glam::{DVec2, DVec3};
use nurbs::basis_derivatives;
use scene::{Loop, Trim};

/// Chords a knot span at first: shorter than any feature of the curves in question.
const CHORDS: usize = 32;

/// A chord that is as short as this, in shares of the box, is taken for its curve.
const SHORTEST: f64 = 1e-14;

/// A stretch of a curve.
struct Chord<'a> {
    trim: &'a Trim,
    /// Parameters of its ends, in the order of the loop; equal where it bridges two trims.
    t: [f64; 2],
    /// Points at its ends, in shares of the box.
    ends: [DVec2; 2],
}

/// The chords of a face's loops, in shares of a box.
pub struct Outline<'a> {
    chords: Vec<Chord<'a>>,
    corner: DVec2,
    size: DVec2,
}

/// C(t).
fn point(trim: &Trim, t: f64) -> DVec2 {
    let span = trim.knots.find_span(t);
    let basis = &basis_derivatives(&trim.knots, span, t, 0)[0];
    let p = trim.knots.degree();
    let term = |r: usize| {
        let k = span - p + r;
        trim.points[k].extend(1.0) * trim.weights.as_ref().map_or(1.0, |w| w[k]) * basis[r]
    };
    let sum: DVec3 = (0..=p).map(term).sum();
    sum.truncate() / sum.z
}

/// Parameters of the first chords' ends, in the order of the loop.
fn parameters(trim: &Trim) -> Vec<f64> {
    let knots = trim.knots.knots();
    let spans: Vec<[f64; 2]> = trim.knots.spans().map(|i| [knots[i], knots[i + 1]]).collect();
    let inside = |[a, b]: [f64; 2]| (0..CHORDS).map(move |k| a + (b - a) * k as f64 / CHORDS as f64);
    let mut t: Vec<f64> = spans.into_iter().flat_map(inside).collect();
    t.push(trim.knots.domain().1);
    if trim.reversed {
        t.reverse();
    }
    t
}

impl<'a> Outline<'a> {
    /// Of loops, for points of the box that has this corner and size. Gaps between trims are bridged by lines.
    pub fn new(loops: &'a [Loop], corner: DVec2, size: DVec2) -> Self {
        let mut chords: Vec<Chord> = vec![];
        for boundary in loops {
            let first = chords.len();
            let bridge = |trim, from, to| Chord { trim, t: [0.0; 2], ends: [from, to] };
            for trim in &boundary.trims {
                let at = |t: f64| (point(trim, t) - corner) / size;
                let parameters = parameters(trim);
                if let Some(last) = chords[first..].last() {
                    let from = last.ends[1];
                    chords.push(bridge(trim, from, at(parameters[0])));
                }
                chords.extend(parameters.windows(2).map(|t| Chord {
                    trim,
                    t: [t[0], t[1]],
                    ends: [at(t[0]), at(t[1])],
                }));
            }
            if let (Some(start), Some(end)) = (chords.get(first), chords.last()) {
                let closing = bridge(end.trim, end.ends[1], start.ends[0]);
                chords.push(closing);
            }
        }
        Self { chords, corner, size }
    }

    /// How often the loops go round a point, counter-clockwise.
    pub fn winding(&self, uv: DVec2) -> i32 {
        let p = (uv - self.corner) / self.size;
        self.chords.iter().map(|chord| self.crossings(chord.trim, chord.t, chord.ends, p)).sum()
    }

    /// Crossings upward, less those downward, of the ray from `p` along +u.
    fn crossings(&self, trim: &Trim, t: [f64; 2], [a, b]: [DVec2; 2], p: DVec2) -> i32 {
        let length = a.distance(b);
        let along = if length > 0.0 { ((p - a).dot(b - a) / (length * length)).clamp(0.0, 1.0) } else { 0.0 };
        let middle = (t[0] + t[1]) / 2.0;
        // The curve stays within its chord's length of the chord: a point farther off is on the same side of both.
        let far = p.distance(a + (b - a) * along) > length;
        if far || length <= SHORTEST || middle == t[0] || middle == t[1] {
            let upward = (a.y <= p.y) != (b.y <= p.y) && (b - a).perp_dot(p - a) * (b.y - a.y) > 0.0;
            return if upward { if b.y > a.y { 1 } else { -1 } } else { 0 };
        }
        let m = (point(trim, middle) - self.corner) / self.size;
        self.crossings(trim, [t[0], middle], [a, m], p) + self.crossings(trim, [middle, t[1]], [m, b], p)
    }
}

/// The largest gap between trims of a loop, and twice its signed area, in shares of a box of this size.
pub fn closure(boundary: &Loop, size: DVec2) -> (f64, f64) {
    let loops = std::slice::from_ref(boundary);
    let outline = Outline::new(loops, DVec2::ZERO, size);
    let bridges = outline.chords.iter().filter(|chord| chord.t[0] == chord.t[1]);
    let gap = bridges.map(|chord| chord.ends[0].distance(chord.ends[1])).fold(0.0, f64::max);
    (gap, outline.chords.iter().map(|chord| chord.ends[0].perp_dot(chord.ends[1])).sum())
}

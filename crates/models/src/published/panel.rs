//! Skins cut into panels: each a face of its own, bounded by cubic Bézier curves, with openings in it.

use crate::construction::clamped;
use glam::{DVec2, dvec2};
use nurbs::{Direction, KnotVector, Surface};
use scene::{Loop, Trim};

/// An opening of a panel; places and lengths are shares of the panel's sides.
#[derive(Debug, Clone, Copy)]
pub(super) enum Opening {
    /// A rectangle with round corners, of eight curves.
    Window { center: DVec2, half: DVec2 },
    /// An ellipse of four curves.
    Hole { center: DVec2, half: DVec2 },
}

/// A skin in panels of so many knot spans along u and along v, row-major in u.
pub(super) fn panels(skin: &Surface, [spans_u, spans_v]: [&[usize]; 2]) -> Vec<Surface> {
    let strips = cut(skin, Direction::U, spans_u);
    strips.iter().flat_map(|strip| cut(strip, Direction::V, spans_v)).collect()
}

fn cut(skin: &Surface, direction: Direction, spans: &[usize]) -> Vec<Surface> {
    let (mut parts, mut rest) = (vec![], skin.clone());
    for &count in &spans[..spans.len() - 1] {
        let knots = rest.knots(direction);
        let next = knots.spans().nth(count).expect("the skin has as many spans");
        let [part, more] = rest.split(direction, knots.span(next).0).expect("a knot inside the domain");
        parts.push(part);
        rest = more;
    }
    parts.push(rest);
    parts
}

/// A panel with openings: its outer loop has a curve along each knot span of its border, all curves are cubic.
pub(super) fn opened(panel: Surface, openings: &[Opening]) -> (Surface, Vec<Loop>) {
    let mut loops = vec![Loop { outer: true, trims: border(&panel) }];
    let [[u0, u1], [v0, v1]] = panel.domain();
    // Ends of the domain come out to the bit.
    let within = |p: DVec2| dvec2(u0 * (1.0 - p.x) + u1 * p.x, v0 * (1.0 - p.y) + v1 * p.y);
    loops.extend(openings.iter().map(|opening| Loop {
        outer: false,
        trims: opening.curves().into_iter().map(|curve| cubic(curve.map(within))).collect(),
    }));
    (panel, loops)
}

fn border(panel: &Surface) -> Vec<Trim> {
    let ends = |knots: &KnotVector| -> Vec<f64> {
        let starts = knots.spans().map(|k| knots.span(k).0);
        starts.chain([knots.domain().1]).collect()
    };
    let [u, v] = [Direction::U, Direction::V].map(|direction| ends(panel.knots(direction)));
    let (u1, v1) = (u[u.len() - 1], v[v.len() - 1]);
    let mut corners: Vec<DVec2> = u.iter().map(|&u| dvec2(u, v[0])).collect();
    corners.extend(v[1..].iter().map(|&v| dvec2(u1, v)));
    corners.extend(u.iter().rev().skip(1).map(|&u| dvec2(u, v1)));
    corners.extend(v.iter().rev().skip(1).map(|&v| dvec2(u[0], v)));
    corners.windows(2).map(|side| cubic(straight(side[0], side[1]))).collect()
}

fn cubic(points: [DVec2; 4]) -> Trim {
    Trim::new(clamped(3, &[]), points.to_vec(), None)
}

fn straight(from: DVec2, to: DVec2) -> [DVec2; 4] {
    [from, from + (to - from) / 3.0, to - (to - from) / 3.0, to]
}

/// Where a cubic's inner control points lie between the ends and the corner of the quarter of a circle that it stands for.
const QUARTER: f64 = 0.552_284_749_830_793_4;

fn quarter(from: DVec2, corner: DVec2, to: DVec2) -> [DVec2; 4] {
    [from, from.lerp(corner, QUARTER), to.lerp(corner, QUARTER), to]
}

impl Opening {
    /// The curves, clockwise, so that material lies on the left.
    fn curves(&self) -> Vec<[DVec2; 4]> {
        match *self {
            Self::Window { center, half } => {
                let signs = [dvec2(-1.0, -1.0), dvec2(-1.0, 1.0), dvec2(1.0, 1.0), dvec2(1.0, -1.0)];
                let corner = |k: usize| center + half * signs[k % 4];
                // Of a side's half the round corner takes this share.
                let toward = |k: usize, other: usize| corner(k).lerp(corner(other), 0.35);
                (0..4)
                    .flat_map(|k| {
                        let (start, end) = (toward(k, k + 1), toward(k + 1, k));
                        [straight(start, end), quarter(end, corner(k + 1), toward(k + 1, k + 2))]
                    })
                    .collect()
            }
            Self::Hole { center, half } => {
                let side =
                    [dvec2(-1.0, 0.0), dvec2(0.0, 1.0), dvec2(1.0, 0.0), dvec2(0.0, -1.0)].map(|s| center + s * half);
                let corner = |k: usize| side[k] + side[(k + 1) % 4] - center;
                (0..4).map(|k| quarter(side[k], corner(k), side[(k + 1) % 4])).collect()
            }
        }
    }
}

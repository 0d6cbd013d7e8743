//! Whether a point of a face's domain is material, and how near the edge of it is: in f64, from the unsplit loops.
//!
//! Data come from [`scene::Region::loops`]; the region's monotone pieces, on which the rasterizers count crossings, are
//! not used. A curve that a point is not in the convex hull of winds about it as its chord does; so a loop's winding
//! number is a sum over chords, and only where the point is inside a hull is the curve halved. A box tree over all
//! segments leaves out those that the ray toward +u passes by.

use crate::tree_2d::{Node, grow};
use glam::{DMat2, DVec2, DVec3};
use nurbs::{BezierCurve, MAX_ORDER, Rectangle};
use scene::Region;

/// Halvings of a segment: then it is shorter than the spacing of its parameters.
const HALVINGS: u32 = 60;

/// Rounding of a point's distance from a chord, in ε times the greatest coordinate: de Casteljau's and the cross product's.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The share by which a distance to the edge may be understated.
const DISTANCE_SLACK: f64 = 0.01;

/// How much farther than the nearest place of an edge a place may be that is taken for it, pixels.
const PLACE_SLACK_PX: f64 = 1e-10;

/// What lies within this share of the domain of a side of it lies on it.
const ON_SIDE: f64 = 1e-10;

/// On which side of the edge a point is, and how far from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// Whether the point is material.
    pub inside: bool,
    /// No edge is nearer than this, in the metric that was asked for, and one is within 1.02 times this.
    pub distance: f64,
}

/// A picture about one of its points as a linear map of (u, v).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureMap {
    /// The parameters of a point.
    pub uv: DVec2,
    /// Where the picture has it, pixels, from where distances are measured.
    pub offset: DVec2,
    /// What u (first column) and v add to that.
    pub slopes: DMat2,
}

impl PictureMap {
    /// Where the map has a point.
    pub(crate) fn at(&self, uv: DVec2) -> DVec2 {
        self.offset + self.slopes * (uv - self.uv)
    }
}

/// The nearest place of an edge that is known.
struct Nearest {
    uv: Option<DVec2>,
    /// No nearer place of it is farther than this, pixels.
    distance: f64,
}

/// The loops of one region, made ready for many points.
#[derive(Debug, Clone)]
pub struct Classifier {
    domain: Rectangle,
    /// Whether the face ends at the sides of the domain, as [`Region::ends_at`] has it.
    ends: [[bool; 2]; 2],
    /// In the order of the tree's leaves.
    segments: Vec<BezierCurve>,
    nodes: Vec<Node>,
}

impl Classifier {
    /// Takes over the loops of `region`.
    pub fn new(region: &Region) -> Self {
        let mut segments: Vec<(Rectangle, BezierCurve)> =
            region.loops().iter().flat_map(|l| &l.segments).map(|s| (s.curve.hull(), s.curve.clone())).collect();
        let mut nodes = vec![];
        let end = segments.len();
        grow(&mut nodes, &mut segments, [0, end]);
        let ends = [0, 1].map(|axis| [0, 1].map(|side| region.ends_at(axis, side)));
        Self { domain: region.domain(), ends, segments: segments.into_iter().map(|(_, s)| s).collect(), nodes }
    }

    /// The box of the loops, outside of which nothing is material.
    pub(crate) fn hull(&self) -> Rectangle {
        self.nodes[0].hull
    }

    /// Whether the point (u, v) of the closed domain is material: the winding number of all loops is not zero.
    ///
    /// A point on the domain's border counts as its neighbour inside. Right for every point that is farther from all
    /// edges than 16 ε of the loops' greatest coordinate; on the edge itself it is one of the two answers.
    /// What is not finite is not material.
    pub fn inside(&self, uv: DVec2) -> bool {
        if !uv.is_finite() {
            return false;
        }
        let below = self.domain.max.map(f64::next_down);
        self.winding(uv.clamp(self.domain.min, below)) != 0
    }

    /// Which side (u, v) is on, and its distance from the nearest edge, in which du counts `speeds.x` and dv `speeds.y`:
    /// with |S_u| and |S_v| about model units, with ones parameters.
    ///
    /// The natural boundary counts as an edge only where a loop runs along it.
    pub fn side(&self, uv: DVec2, speeds: DVec2) -> Side {
        let mut nearest = f64::INFINITY;
        self.approach(0, uv, speeds, &mut nearest);
        Side { inside: self.inside(uv), distance: nearest / (1.0 + DISTANCE_SLACK) }
    }

    /// The place, in (u, v), of all at which the face ends that is nearest by `map`, within `reach` pixels.
    ///
    /// The face ends at the loops inside its domain, but where they run along a seam or a side that is a point; and at the
    /// other sides of the domain, where they have material. A map that takes a direction to nothing finds nothing.
    pub fn nearest_edge(&self, map: &PictureMap, reach: f64) -> Option<DVec2> {
        let per_pixel = map.slopes.inverse();
        if !per_pixel.is_finite() {
            return None;
        }
        let mut nearest = Nearest { uv: None, distance: reach };
        for (axis, side) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if self.ends[axis][side] {
                self.approach_side(axis, side, map, &mut nearest);
            }
        }
        // By how much u and v change at most within a pixel.
        let extent = DVec2::new(per_pixel.row(0).length(), per_pixel.row(1).length());
        let center = map.uv - per_pixel * map.offset;
        let mut stack = vec![0];
        while let Some(node) = stack.pop() {
            let node: &Node = &self.nodes[node];
            let within = nearest.distance * extent;
            if !node.hull.meets(Rectangle { min: center - within, max: center + within }) {
                continue;
            }
            match node.halves {
                Some(halves) => stack.extend(halves),
                None => {
                    for segment in &self.segments[node.range[0]..node.range[1]] {
                        if !self.runs_along_a_seam(segment) {
                            let mut control = [DVec3::ZERO; MAX_ORDER];
                            control[..=segment.degree()].copy_from_slice(segment.control());
                            self.approach_edge(&control[..=segment.degree()], map, &mut nearest, HALVINGS);
                        }
                    }
                }
            }
        }
        nearest.uv
    }

    /// The side of the domain at which the face ends where it has material.
    fn approach_side(&self, axis: usize, side: usize, map: &PictureMap, nearest: &mut Nearest) {
        let mut start = self.domain.min;
        start[axis] = [self.domain.min, self.domain.max][side][axis];
        let mut end = self.domain.max;
        end[axis] = start[axis];
        let [a, b] = [start, end].map(|uv| map.at(uv));
        let along = b - a;
        let uv = start + (end - start) * (-a.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        // Where the foot has none, the nearest that has is on a loop.
        let distance = map.at(uv).length();
        if distance < nearest.distance && self.inside(uv) {
            *nearest = Nearest { uv: Some(uv), distance };
        }
    }

    fn runs_along_a_seam(&self, segment: &BezierCurve) -> bool {
        let (hull, size) = (segment.hull(), self.domain.size());
        let sides = [self.domain.min, self.domain.max];
        (0..2).any(|axis| {
            (0..2).any(|side| {
                let near = |t: f64| (t - sides[side][axis]).abs() <= ON_SIDE * size[axis];
                !self.ends[axis][side] && near(hull.min[axis]) && near(hull.max[axis])
            })
        })
    }

    /// Brings `nearest` to a part of a loop, of which only what lies in the domain counts.
    fn approach_edge(&self, control: &[DVec3], map: &PictureMap, nearest: &mut Nearest, halvings: u32) {
        let p = control.len() - 1;
        let uv = |i: usize| control[i].truncate() / control[i].z;
        let Rectangle { min, max } = self.domain;
        let margin = ON_SIDE * self.domain.size();
        let outside = |axis: usize| {
            (0..=p).all(|i| uv(i)[axis] < min[axis] - margin[axis])
                || (0..=p).all(|i| max[axis] + margin[axis] < uv(i)[axis])
        };
        if outside(0) || outside(1) {
            return;
        }
        let (start, end) = (map.at(uv(0)), map.at(uv(p)));
        let bend = (1..p).map(|i| distance_to_segment(map.at(uv(i)), start, end)).fold(0.0, f64::max);
        let chord = distance_to_segment(DVec2::ZERO, start, end);
        // Also where the map is not finite: then nothing is near, and nothing is halved.
        let may_be_nearer = chord - bend + PLACE_SLACK_PX < nearest.distance;
        if !may_be_nearer {
            return;
        }
        let inside = (0..=p).all(|i| (min - margin).cmple(uv(i)).all() && uv(i).cmple(max + margin).all());
        let is_fine = bend <= PLACE_SLACK_PX || halvings == 0;
        if inside && (is_fine || chord + bend < nearest.distance) {
            let along = end - start;
            let length = along.length_squared();
            let share = if 0.0 < length { (-start.dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
            *nearest = Nearest { uv: Some(uv(0) + (uv(p) - uv(0)) * share), distance: chord + bend };
        }
        if halvings == 0 || (inside && is_fine) {
            return;
        }
        let (first, second) = halve(control);
        self.approach_edge(&first[..=p], map, nearest, halvings - 1);
        self.approach_edge(&second[..=p], map, nearest, halvings - 1);
    }

    /// Whether an edge comes within `reach` of (u, v), in the metric of [`Self::side`], give or take a hundredth of it.
    pub fn is_at_edge(&self, uv: DVec2, speeds: DVec2, reach: f64) -> bool {
        if reach < box_distance(self.nodes[0].hull, uv, speeds) {
            return false;
        }
        let mut nearest = reach.next_up();
        self.approach(0, uv, speeds, &mut nearest);
        nearest <= reach
    }

    fn winding(&self, uv: DVec2) -> i32 {
        let mut sum = 0;
        let mut stack = vec![0];
        while let Some(node) = stack.pop() {
            let node: &Node = &self.nodes[node];
            if uv.y < node.hull.min.y || node.hull.max.y < uv.y || node.hull.max.x < uv.x {
                continue;
            }
            match node.halves {
                Some(halves) => stack.extend(halves),
                None => {
                    sum += self.segments[node.range[0]..node.range[1]].iter().map(|s| winding_of(s, uv)).sum::<i32>();
                }
            }
        }
        sum
    }

    /// Lowers `nearest` to a distance that an edge under `node` is proven to be within.
    fn approach(&self, node: usize, uv: DVec2, speeds: DVec2, nearest: &mut f64) {
        let node = &self.nodes[node];
        let Some(halves) = node.halves else {
            for segment in &self.segments[node.range[0]..node.range[1]] {
                let p = segment.degree();
                let mut local = [DVec3::ZERO; MAX_ORDER];
                for (local, c) in local.iter_mut().zip(segment.control()) {
                    *local = ((c.truncate() / c.z - uv) * speeds * c.z).extend(c.z);
                }
                approach_curve(&local[..=p], nearest, HALVINGS);
            }
            return;
        };
        let mut order = halves.map(|half| (box_distance(self.nodes[half].hull, uv, speeds), half));
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (distance, half) in order {
            if distance * (1.0 + DISTANCE_SLACK) < *nearest {
                self.approach(half, uv, speeds, nearest);
            }
        }
    }
}

/// What a segment adds to the winding number of `uv`: crossings of the ray toward +u, upward less downward.
fn winding_of(segment: &BezierCurve, uv: DVec2) -> i32 {
    let p = segment.degree();
    let size = segment.control().iter().map(|c| (c.truncate() / c.z).abs().max_element()).fold(0.0, f64::max);
    let mut control = [DVec3::ZERO; MAX_ORDER];
    for (control, c) in control.iter_mut().zip(segment.control()) {
        *control = (c.truncate() - uv * c.z).extend(c.z);
    }
    winding_about_origin(&control[..=p], ROUNDING * (size + uv.abs().max_element()), HALVINGS)
}

fn winding_about_origin(control: &[DVec3], rounding: f64, halvings: u32) -> i32 {
    let p = control.len() - 1;
    // Signs need no division: weights are positive.
    let above = control.iter().filter(|c| 0.0 < c.y).count();
    let right = control.iter().filter(|c| 0.0 < c.x).count();
    if above == p + 1 || right == 0 && control.iter().all(|c| c.x < 0.0) || control.iter().all(|c| c.y < 0.0) {
        return 0;
    }
    let [start, end] = [control[0], control[p]].map(|c| c.truncate() / c.z);
    if right == p + 1 {
        return i32::from(start.y <= 0.0 && 0.0 < end.y) - i32::from(end.y <= 0.0 && 0.0 < start.y);
    }
    // The distances of the control points, and of the origin, from the chord.
    let along = (end - start).normalize_or_zero();
    let origin = along.perp_dot(-start);
    let offsets = control.iter().map(|c| along.perp_dot(c.truncate() / c.z - start));
    let (low, high) = offsets.fold((0.0f64, 0.0f64), |(low, high), d| (low.min(d), high.max(d)));
    // A segment that ends where it begins has no chord to be near to: it is a point or must be halved.
    let is_thin = if start == end {
        control.iter().all(|c| (c.truncate() / c.z).distance(start) <= rounding)
    } else {
        high - low <= rounding
    };
    if origin < low - rounding || high + rounding < origin || halvings == 0 || is_thin {
        let crosses_up = start.y <= 0.0 && 0.0 < end.y && 0.0 < origin;
        let crosses_down = end.y <= 0.0 && 0.0 < start.y && origin < 0.0;
        return i32::from(crosses_up) - i32::from(crosses_down);
    }
    let (first, second) = halve(control);
    winding_about_origin(&first[..=p], rounding, halvings - 1)
        + winding_about_origin(&second[..=p], rounding, halvings - 1)
}

/// Lowers `nearest` to a distance from the origin that the curve is proven to come within.
fn approach_curve(control: &[DVec3], nearest: &mut f64, halvings: u32) {
    let p = control.len() - 1;
    let point = |i: usize| control[i].truncate() / control[i].z;
    let (start, end) = (point(0), point(p));
    // The curve is within `bend` of its chord, and every point of the chord within `bend` of the curve.
    let bend = (1..p).map(|i| distance_to_segment(point(i), start, end)).fold(0.0, f64::max);
    let chord = distance_to_segment(DVec2::ZERO, start, end);
    *nearest = nearest.min(chord + bend);
    // Not so, either, where the metric is not finite: then nothing is near, and nothing is halved.
    let may_be_nearer = (chord - bend) * (1.0 + DISTANCE_SLACK) < *nearest;
    if halvings == 0 || !may_be_nearer {
        return;
    }
    if bend <= f64::EPSILON * (start.abs().max_element() + end.abs().max_element()) {
        return;
    }
    let (first, second) = halve(control);
    let mut order = [first, second];
    if end.length_squared() < start.length_squared() {
        order.reverse();
    }
    for half in order {
        approach_curve(&half[..=p], nearest, halvings - 1);
    }
}

fn halve(control: &[DVec3]) -> ([DVec3; MAX_ORDER], [DVec3; MAX_ORDER]) {
    let p = control.len() - 1;
    let (mut low, mut high) = ([DVec3::ZERO; MAX_ORDER], [DVec3::ZERO; MAX_ORDER]);
    high[..=p].copy_from_slice(control);
    for r in 0..=p {
        low[r] = high[0];
        for i in 0..p - r {
            high[i] = 0.5 * (high[i] + high[i + 1]);
        }
    }
    (low, high)
}

fn distance_to_segment(point: DVec2, start: DVec2, end: DVec2) -> f64 {
    let along = end - start;
    let length = along.length_squared();
    let t = if 0.0 < length { ((point - start).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(start + along * t)
}

fn box_distance(hull: Rectangle, uv: DVec2, speeds: DVec2) -> f64 {
    (((hull.min - uv).max(uv - hull.max)).max(DVec2::ZERO) * speeds).length()
}

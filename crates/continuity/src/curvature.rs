//! The least radius of curvature of a face, bounded from below, and where its normals vanish.
//!
//! Branch and bound over the face's Bézier patches: on a rectangle of parameters every derivative is a function of u with a
//! radius that holds all v, and so are H and K; no principal curvature is greater than |H| + √(H² − K). A rectangle with no material is left out; one that a trim crosses counts whole, so
//! that the bound is of the face and what lies beside its trims. The radius that was seen is at a point of the face.

use crate::net::Jet;
use crate::region::Material;
use crate::surface::Patches;
use crate::taylor::{Taylor, cross, dot};
use glam::{DVec2, DVec3};
use nurbs::NormalStatus;
use scene::{FaceId, Model};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The bound is close enough where it is at most this times the curvature seen.
const CLOSE: f64 = 1.1;

/// Rectangles that are looked at in a face, beside four for each of its patches.
const MOST_RECTANGLES: usize = 3_000;

/// Halvings after which a rectangle without a bound is a place without a normal: 1/128 of a patch each way.
const HALVINGS: u32 = 14;

/// The curvature of a face where it is greatest.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceCurvature {
    /// The face.
    pub face: FaceId,
    /// No principal curvature is greater, 1 / model units, but at [`Self::degenerate`] places; `None` where the search ended
    /// before there was a bound.
    pub bound: Option<f64>,
    /// The greatest that was seen, where, and its place in the domain; `None` of a face that is flat or was not seen.
    pub seen: Option<(f64, DVec3, DVec2)>,
    /// Where S_u × S_v vanishes, or may: a pole, a fold, a cusp.
    pub degenerate: Vec<DegenerateNormal>,
}

/// A place of a face without a proven normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DegenerateNormal {
    /// In the domain.
    pub uv: DVec2,
    /// In space.
    pub position: DVec3,
    /// What the normal is there: regular where it only comes close to vanishing.
    pub status: NormalStatus,
}

struct Open {
    span: [usize; 2],
    /// Least parameters of the rectangle, and its sides, in shares of the patch.
    from: DVec2,
    size: DVec2,
    halvings: u32,
    upper: f64,
    /// The parameter that is halved next: 0 = u, 1 = v.
    axis: usize,
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        let place = |open: &Self| (other.span.cmp(&open.span), open.from);
        let (span, from) = place(self);
        let order = from.y.total_cmp(&other.from.y).then(from.x.total_cmp(&other.from.x));
        self.upper.total_cmp(&other.upper).then(span).then(order)
    }
}

/// The greatest curvature of a face; below `flat`, 1 / model units, it does not matter.
pub fn face_curvature(model: &Model, face: FaceId, flat: f64) -> FaceCurvature {
    let surface = model.surface(face);
    let material = Material::new(model, face);
    let mut patches = Patches::new(surface);
    let [ku, kv] = [nurbs::Direction::U, nurbs::Direction::V].map(|direction| surface.knots(direction));
    let uv = |span: [usize; 2], t: DVec2| {
        let ([u, lu], [v, lv]) = (<[f64; 2]>::from(ku.span(span[0])), <[f64; 2]>::from(kv.span(span[1])));
        DVec2::new(u + lu * t.x, v + lv * t.y)
    };
    let mut found = FaceCurvature { face, bound: None, seen: None, degenerate: vec![] };
    let mut heap = BinaryHeap::new();
    let mut looked = 0;
    let mut push = |heap: &mut BinaryHeap<Open>, seen: &mut Option<(f64, DVec3, DVec2)>, mut open: Open| {
        let [low, high] = [open.from, open.from + open.size].map(|t| uv(open.span, t));
        if material.is_without(low, high) {
            return;
        }
        looked += 1;
        let u = Taylor::between(open.from.x, open.from.x + open.size.x);
        let v = Taylor::ball(open.from.y + 0.5 * open.size.y, 0.5 * open.size.y);
        let longer = usize::from(open.size.x < open.size.y);
        let found = patches.get(open.span).net.jet(u, v).and_then(|jet| greatest(&jet));
        (open.upper, open.axis) = found.unwrap_or((f64::INFINITY, longer));
        let middle = uv(open.span, open.from + 0.5 * open.size);
        let point = surface.inspect_on(open.span[0], open.span[1], middle.x, middle.y);
        if let Some(curvature) = point.curvature {
            let here = curvature.k1.abs().max(curvature.k2.abs());
            if seen.is_none_or(|(most, ..)| most < here) && material.holds(middle) {
                *seen = Some((here, point.derivatives.s, middle));
            }
        }
        heap.push(open);
    };
    let spans: Vec<[usize; 2]> = ku.spans().flat_map(|k| kv.spans().map(move |l| [k, l])).collect();
    let most = MOST_RECTANGLES + 4 * spans.len();
    for span in spans {
        let open = Open { span, from: DVec2::ZERO, size: DVec2::ONE, halvings: 0, upper: 0.0, axis: 0 };
        push(&mut heap, &mut found.seen, open);
    }
    let mut count = heap.len();
    while let Some(open) = heap.pop() {
        let seen = found.seen.map_or(0.0, |(most, ..)| most);
        if open.upper <= (CLOSE * seen).max(flat) || most <= count {
            found.bound = (open.upper < f64::INFINITY).then_some(open.upper);
            return found;
        }
        if HALVINGS <= open.halvings && open.upper == f64::INFINITY {
            let place = uv(open.span, open.from + 0.5 * open.size);
            note(&mut found.degenerate, surface, place, uv(open.span, DVec2::ONE) - uv(open.span, DVec2::ZERO));
            continue;
        }
        let (mut size, mut step) = (open.size, DVec2::ZERO);
        size[open.axis] *= 0.5;
        step[open.axis] = size[open.axis];
        for from in [open.from, open.from + step] {
            push(&mut heap, &mut found.seen, Open { from, size, halvings: open.halvings + 1, ..open });
            count += 1;
        }
    }
    found.bound = Some(found.seen.map_or(0.0, |(most, ..)| most));
    found
}

/// Adds a place unless it is near one that is known, in shares of the patch's sides.
fn note(places: &mut Vec<DegenerateNormal>, surface: &nurbs::Surface, uv: DVec2, size: DVec2) {
    const NEAR: f64 = 0.5;
    if places.iter().all(|place| NEAR < ((place.uv - uv) / size).abs().max_element()) {
        let point = surface.inspect(uv.x, uv.y);
        places.push(DegenerateNormal { uv, position: point.derivatives.s, status: point.normal.status() });
    }
}

/// An upper bound of both principal curvatures' sizes, and the parameter that it owes most of its width to.
fn greatest(jet: &Jet) -> Option<(f64, usize)> {
    let product = cross(&jet.su, &jet.sv);
    let squared = dot(&product, &product);
    let inverse = squared.inverse_root()?;
    let [l, m, n] = [&jet.suu, &jet.suv, &jet.svv].map(|s| dot(s, &product) * inverse);
    let [e, f, g] = [dot(&jet.su, &jet.su), dot(&jet.su, &jet.sv), dot(&jet.sv, &jet.sv)];
    let area = inverse * inverse;
    let mean = (e * n + g * l - (f * m).scaled(2.0)).scaled(0.5) * area;
    let gaussian = (l * n - m * m) * area;
    let root = (mean * mean - gaussian).peak().upper.max(0.0).sqrt();
    let size = mean.peak().upper.max((-mean).peak().upper);
    let along_u = mean.magnitude() - mean.middle().abs() - mean.radius();
    Some(((size + root) * (1.0 + 1e-12), usize::from(along_u < mean.radius())))
}

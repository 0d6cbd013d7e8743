//! The nearest point of a trimmed model to a place in space.
//!
//! Patches are quartered until their normals turn little, trim edges halved until they are short; each part has a box that holds
//! it. A place asks the parts whose boxes are nearer than the best point so far. In a part of a patch Newton's search finds one
//! point, which counts where its face has material; where it has none, the nearest point of the face is on its trim edges.

use glam::{DVec2, DVec3};
use nurbs::{BezierCurve, BezierPatch, DerivativeBounds, Hull};
use raycast::Classifier;
use rayon::prelude::*;
use scene::{FaceId, Model};

/// The sine of the greatest angle by which normals of a part turn from its middle one: the distance to it then has one least value,
/// from nearer than its radius of curvature.
const TURN: f64 = 0.5;

/// Quarterings of a Bézier patch. Beside a pole, normals never turn little.
const QUARTERINGS: u32 = 4;

/// A trim edge's part is not longer than this share of the model's size, as far as its bound tells.
const SHORT: f64 = 1.0 / 64.0;

/// Halvings of a trim edge's curve.
const HALVINGS: u32 = 8;

/// Steps of a search along a trim edge. It ends where a step moves the point by less than rounding.
const STEPS: usize = 60;

/// A place whose way to the model leaves it at less than this sine from the tangent plane's normal is opposite to it.
const OPPOSITE: f64 = 1e-3;

/// Below this share of the model's size a place is on the model, and its way there has no direction.
const ON_IT: f64 = 1e-12;

/// Parts of one leaf of the tree.
const LEAF: usize = 4;

/// A model that is asked for nearest points.
pub struct Nearest {
    model: Model,
    /// Of the faces that are trimmed.
    classifiers: Vec<Option<Classifier>>,
    parts: Vec<Part>,
    /// The root comes last.
    nodes: Vec<Node>,
    size: f64,
}

/// The nearest point that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// On which face.
    pub face: FaceId,
    /// Its parameters, in the surface's domain.
    pub uv: DVec2,
    /// It, model units.
    pub position: DVec3,
    /// From the place that was asked for, model units.
    pub distance: f64,
    /// The face's unit normal there; `None` where it has none.
    pub normal: Option<DVec3>,
    /// Whether the way there leaves the surface along its normal. Where it does not, the point is on a border, or on a crease.
    pub is_opposite: bool,
}

struct Part {
    face: FaceId,
    hull: Hull,
    kind: Kind,
}

enum Kind {
    /// A part of a surface over this rectangle.
    Patch([[f64; 2]; 2]),
    /// A part of a trim edge.
    Edge(BezierCurve),
}

struct Node {
    hull: Hull,
    kind: Inner,
}

enum Inner {
    Children([usize; 2]),
    /// Of `parts`, from the first to before the last.
    Leaf([usize; 2]),
}

#[derive(Clone, Copy)]
struct Best {
    face: FaceId,
    uv: DVec2,
    distance: f64,
}

impl Nearest {
    /// Prepares a model.
    pub fn new(model: Model) -> Self {
        let size = model.hull().diagonal();
        let faces = 0..model.faces().len() as u32;
        let classifiers = faces.clone().into_par_iter();
        let classifiers = classifiers.map(|id| model.trimmed_region(FaceId(id)).map(Classifier::new)).collect();
        let mut parts: Vec<Part> =
            faces.into_par_iter().flat_map_iter(|id| parts_of(&model, FaceId(id), size)).collect();
        let mut nodes = vec![];
        let count = parts.len();
        grow(&mut parts, [0, count], &mut nodes);
        Self { model, classifiers, parts, nodes, size }
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The point of the model that is nearest to `place`, as far as one search in each part finds it. No bound says that a nearer
    /// one does not exist; its distance is what it says. `None` where the model has no face, or `place` is not finite.
    pub fn to(&self, place: DVec3) -> Option<Foot> {
        let mut best: Option<Best> = None;
        let mut open = vec![(0.0, self.nodes.len().checked_sub(1)?)];
        while let Some((lower, node)) = open.pop() {
            if best.is_some_and(|best| best.distance <= lower) {
                continue;
            }
            match self.nodes[node].kind {
                Inner::Leaf([first, end]) => {
                    for part in &self.parts[first..end] {
                        let wanted = best.map_or(f64::INFINITY, |best| best.distance);
                        if away(part.hull, place) < wanted {
                            let found = self.in_part(part, place).filter(|found| found.distance < wanted);
                            best = found.or(best);
                        }
                    }
                }
                Inner::Children(children) => {
                    let mut next = children.map(|child| (away(self.nodes[child].hull, place), child));
                    // The nearer one is taken first.
                    next.sort_by(|a, b| b.0.total_cmp(&a.0));
                    open.extend(next);
                }
            }
        }
        best.map(|best| self.foot(best, place))
    }

    fn in_part(&self, part: &Part, place: DVec3) -> Option<Best> {
        let face = part.face;
        let surface = self.model.surface(face);
        match &part.kind {
            Kind::Patch(rectangle) => {
                let middle = rectangle.map(|[low, high]| 0.5 * (low + high));
                let found = surface.nearest_in(place, *rectangle, DVec2::from_array(middle));
                let classifier = self.classifiers[face.0 as usize].as_ref();
                let is_material = classifier.is_none_or(|classifier| classifier.inside(found.uv));
                is_material.then_some(Best { face, uv: found.uv, distance: found.distance })
            }
            Kind::Edge(curve) => {
                let at = |t: f64| {
                    let [uv, speed] = curve.first_derivative(t);
                    let d = surface.first_derivatives(uv.x, uv.y);
                    (uv, d.s, d.su * speed.x + d.sv * speed.y)
                };
                let away = |t: f64| at(t).1.distance(place);
                let mut t = [0.0, 0.5, 1.0].into_iter().min_by(|a, b| away(*a).total_cmp(&away(*b)))?;
                for _ in 0..STEPS {
                    let (_, point, tangent) = at(t);
                    let rate = tangent.length_squared();
                    if rate == 0.0 {
                        break;
                    }
                    let mut step = (place - point).dot(tangent) / rate;
                    // Where the curve bends about the place, a whole step goes too far.
                    while away((t + step).clamp(0.0, 1.0)) >= away(t) && self.size * ON_IT < step.abs() * rate.sqrt() {
                        step *= 0.5;
                    }
                    let next = (t + step).clamp(0.0, 1.0);
                    if next == t || step.abs() * rate.sqrt() <= self.size * ON_IT {
                        break;
                    }
                    t = next;
                }
                let (uv, point, _) = at(t);
                Some(Best { face, uv, distance: point.distance(place) })
            }
        }
        .filter(|found| found.distance.is_finite())
    }

    fn foot(&self, Best { face, uv, distance }: Best, place: DVec3) -> Foot {
        let found = self.model.surface(face).inspect(uv.x, uv.y);
        let position = found.derivatives.s;
        let turn = if self.model.faces()[face.0 as usize].reversed { -1.0 } else { 1.0 };
        let normal = found.normal.unit().map(|normal| turn * normal);
        let way = place - position;
        let is_opposite = distance <= self.size * ON_IT
            || normal.is_some_and(|normal| way.cross(normal).length() <= OPPOSITE * way.length());
        Foot { face, uv, position, distance, normal, is_opposite }
    }
}

/// The distance of a place from a box; 0 inside.
fn away(hull: Hull, place: DVec3) -> f64 {
    (hull.min - place).max(place - hull.max).max(DVec3::ZERO).length()
}

/// The parts of a face: of its patches where it may have material, and of its trim edges.
fn parts_of(model: &Model, face: FaceId, size: f64) -> Vec<Part> {
    let surface = model.surface(face);
    let region = model.trimmed_region(face);
    let mut parts = vec![];
    let patches = surface.bezier_patches();
    for patch in &patches {
        let mut open = vec![(patch.clone(), 0)];
        while let Some((patch, depth)) = open.pop() {
            let [u, v] = patch.domain;
            let is_beside = region.is_some_and(|region| {
                let material = region.hull();
                u[1] < material.min.x || material.max.x < u[0] || v[1] < material.min.y || material.max.y < v[0]
            });
            let turns = |patch: &BezierPatch| patch.normal_cone().is_none_or(|cone| TURN < cone.sine);
            if is_beside {
                continue;
            }
            if depth < QUARTERINGS && turns(&patch) {
                open.extend(patch.quarters().map(|quarter| (quarter, depth + 1)));
            } else {
                parts.push(Part { face, hull: patch.hull(), kind: Kind::Patch(patch.domain) });
            }
        }
    }
    let Some(region) = region else { return parts };
    let bounds = patches.iter().map(BezierPatch::derivative_bounds);
    let speeds = bounds.fold(DerivativeBounds::default(), DerivativeBounds::max);
    for piece in region.edges() {
        let mut open = vec![(piece.curve.clone(), 0)];
        while let Some((curve, depth)) = open.pop() {
            let hull = curve.hull();
            let half = 0.5 * hull.size();
            let (middle, radius) = (hull.min + half, speeds.u * half.x + speeds.v * half.y);
            if depth < HALVINGS && SHORT * size < radius {
                open.extend(curve.split(0.5).map(|curve| (curve, depth + 1)));
                continue;
            }
            let centre = surface.point(middle.x, middle.y);
            let hull = Hull::of([centre - radius, centre + radius]);
            parts.push(Part { face, hull, kind: Kind::Edge(curve) });
        }
    }
    parts
}

/// Builds the tree over a range of parts, halved in the middle along the longest side; returns its number.
fn grow(parts: &mut [Part], [first, end]: [usize; 2], nodes: &mut Vec<Node>) -> Option<usize> {
    let own = &mut parts[first..end];
    let hull = own.iter().map(|part| part.hull).reduce(Hull::union)?;
    let kind = if own.len() <= LEAF {
        Inner::Leaf([first, end])
    } else {
        let size = hull.max - hull.min;
        let axis = (0..3).max_by(|a, b| size[*a].total_cmp(&size[*b]))?;
        let half = own.len() / 2;
        own.select_nth_unstable_by(half, |a, b| a.hull.center()[axis].total_cmp(&b.hull.center()[axis]));
        let low = grow(parts, [first, first + half], nodes)?;
        let high = grow(parts, [first + half, end], nodes)?;
        Inner::Children([low, high])
    };
    nodes.push(Node { hull, kind });
    Some(nodes.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs::Surface;

    fn builtin(name: &str) -> Nearest {
        Nearest::new(models::builtin(name).expect("built in"))
    }

    /// Places in and about a box, the same on every run.
    fn places(hull: Hull, count: usize) -> Vec<DVec3> {
        let share = |i: usize, k: f64| (i as f64 * k).fract();
        let size = hull.max - hull.min;
        let at = |i: usize| DVec3::new(share(i, 0.8191725), share(i, 0.6710436), share(i, 0.5497005));
        (1..=count).map(|i| hull.min - 0.2 * size + 1.4 * size * at(i)).collect()
    }

    #[test]
    fn a_spheres_nearest_point_is_on_the_ray_from_its_centre() {
        let sphere = builtin("sphere");
        let hull = sphere.model().hull();
        let (centre, radius) = (hull.center(), 1.0);
        for place in places(hull, 300) {
            let foot = sphere.to(place).expect("it has faces");
            let exact = (place.distance(centre) - radius).abs();
            assert!((foot.distance - exact).abs() < 1e-9, "{place}: {} {exact}", foot.distance);
            assert!(foot.is_opposite && (foot.position.distance(centre) - radius).abs() < 1e-12, "{place}: {foot:?}");
        }
    }

    /// Against every sample of a fine grid of what has material: none of them is nearer.
    #[test]
    fn no_sample_of_a_trimmed_or_bent_model_is_nearer() {
        for name in ["teapot", "islands", "torus", "petal"] {
            let nearest = builtin(name);
            let model = nearest.model();
            let samples: Vec<DVec3> = (0..model.faces().len() as u32)
                .flat_map(|id| {
                    let surface: &Surface = model.surface(FaceId(id));
                    let [[u0, u1], [v0, v1]] = surface.domain();
                    let classifier = &nearest.classifiers[id as usize];
                    let steps =
                        (0..=40).flat_map(|i| (0..=40).map(move |j| [f64::from(i) / 40.0, f64::from(j) / 40.0]));
                    let uv = steps.map(|[s, t]| DVec2::new(u0 + s * (u1 - u0), v0 + t * (v1 - v0)));
                    let inside = uv.filter(|uv| classifier.as_ref().is_none_or(|c| c.inside(*uv))).collect::<Vec<_>>();
                    inside.into_iter().map(|uv| surface.point(uv.x, uv.y)).collect::<Vec<_>>()
                })
                .collect();
            for place in places(model.hull(), 100) {
                let foot = nearest.to(place).expect("it has faces");
                let least = samples.iter().map(|sample| sample.distance(place)).fold(f64::INFINITY, f64::min);
                assert!(foot.distance <= least + 1e-9, "{name} {place}: {} {least}", foot.distance);
                assert!((foot.position.distance(place) - foot.distance).abs() < 1e-12, "{name}");
            }
        }
    }

    #[test]
    fn beside_a_trim_edge_the_nearest_point_is_on_it_and_not_opposite() {
        // A square with a round hole: above the hole's centre all of its edge is as near.
        let islands = builtin("islands");
        let model = islands.model();
        let region = model.trimmed_region(FaceId(0)).expect("it is trimmed");
        let classifier = Classifier::new(region);
        let surface = model.surface(FaceId(0));
        let [[u0, u1], [v0, v1]] = surface.domain();
        let mut beside = 0;
        for k in 0..400 {
            let share = DVec2::new((f64::from(k) * 0.7548777).fract(), (f64::from(k) * 0.5698403).fract());
            let uv = DVec2::new(u0, v0) + share * DVec2::new(u1 - u0, v1 - v0);
            let place = surface.point(uv.x, uv.y);
            let foot = islands.to(place).expect("it has faces");
            if classifier.inside(uv) {
                assert!(foot.distance < 1e-9, "{uv}: {foot:?}");
            } else if foot.distance > 1e-3 {
                beside += 1;
                assert!(!foot.is_opposite, "{uv}: {foot:?}");
                assert!(classifier.is_at_edge(foot.uv, DVec2::ONE, 1e-6), "{uv}: {foot:?}");
            }
        }
        assert!(beside > 10, "{beside}");
    }
}

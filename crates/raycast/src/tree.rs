//! The cull: an obvhs box tree over pieces, made safe for f64.
//!
//! obvhs works in f32 and its slab test is not conservative, so it only culls. Boxes are moved to the scene's centre
//! in f64, divided by the scene's radius, rounded outward and padded; a ray starts anew near the scene in f64, so that
//! a far eye costs nothing; and the distance that prunes is rounded up.

use crate::pieces::Pieces;
use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::ray::{Ray as BoxRay, RayHit};
use obvhs::{BvhBuildParams, fast_stack};
use scene::Ray;
use std::time::Duration;

/// Outward padding of boxes, as a share of the scene's radius: 32 ulp of 1 in f32.
///
/// In units of the radius a ray starts at most 3 from the centre and passes the scene within t ≤ 5. In f32, with
/// u = 2⁻²⁴ = ulp / 2: narrowing the origin displaces the ray by ≤ 3 u, narrowing the direction by ≤ 5 u; the clamp of
/// small direction components to 1.2e-7 by ≤ 5 · 2 u; subtraction, reciprocal and product change a slab's distance by
/// 3 roundings of (bound − origin) ≤ 4, ≤ 12 u. In sum 30 u = 15 ulp, and 32 ulp are more than twice that.
const PAD: f32 = 32.0 * f32::EPSILON;

/// How far before the scene's centre a ray from afar starts anew, in radii of the scene.
const START: f64 = 2.0;

/// The box tree of a scene.
pub(crate) struct Tree {
    tree: Bvh2,
    center: DVec3,
    radius: f64,
}

impl Tree {
    pub fn new(pieces: &Pieces) -> Self {
        let about_first = pieces.bodies[0].origin;
        let whole = |center: DVec3| {
            pieces.pieces.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], piece| {
                let [low, high] = pieces.hull_about(piece, center);
                [min.min(low), max.max(high)]
            })
        };
        let [min, max] = whole(about_first);
        let center = about_first + min + 0.5 * (max - min);
        let [min, max] = whole(center);
        // Of the box, not less; squares of tiny sizes leave f64.
        let radius = min.abs().max(max.abs()).max_element() * 3f64.sqrt();
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let boxes: Vec<Aabb> = pieces
            .pieces
            .iter()
            .map(|piece| {
                let [low, high] = pieces.hull_about(piece, center).map(|p| p / radius);
                let narrow = |p: DVec3, outward: fn(f32) -> f32, pad: f32| {
                    let [x, y, z] = p.to_array().map(|x| outward(outward(x as f32) + pad));
                    Vec3A::new(x, y, z)
                };
                Aabb::new(narrow(low, f32::next_down, -PAD), narrow(high, f32::next_up, PAD))
            })
            .collect();
        let parameters = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        let tree = build_bvh2(&boxes, parameters, &mut Duration::default());
        Self { tree, center, radius }
    }

    /// Calls `visit` with the index of every piece whose box `ray` may meet at a distance from `ray.near` up to the
    /// least that `visit` has returned, roughly from near to far.
    pub fn visit(&self, ray: &Ray, mut visit: impl FnMut(usize) -> f64) {
        let offset = ray.origin - self.center;
        let foot = -offset.dot(ray.direction);
        let start = ray.near.max(foot - START * self.radius);
        let origin = (offset + ray.direction * start) / self.radius;
        // Past the scene, or beside it by more than any rounding: also keeps the numbers within f32.
        let aside = (offset + ray.direction * foot).length() / self.radius;
        if !(start - foot <= START * self.radius && aside <= START) {
            return;
        }
        let narrow = |x: DVec3| Vec3A::new(x.x as f32, x.y as f32, x.z as f32);
        let box_ray = BoxRay::new(narrow(origin), narrow(ray.direction), 0.0, f32::INFINITY);
        let mut nearest = f64::INFINITY;
        let mut leaf = |node: &obvhs::bvh2::node::Bvh2Node, ray: &mut BoxRay, _: &mut RayHit| {
            for k in node.first_index..node.first_index + node.prim_count {
                let t = visit(self.tree.primitive_indices[k as usize] as usize);
                if t < nearest {
                    nearest = t;
                    // A hit lies deeper than the pad inside its box, so the box's distance, errors and all, is less.
                    ray.tmax = (((t - start) / self.radius) as f32).max(0.0).next_up();
                }
            }
            true
        };
        fast_stack!(u32, (96, 192), self.tree.max_depth, stack, {
            self.tree.ray_traverse_dynamic(&mut stack, box_ray, &mut RayHit::none(), &mut leaf)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pieces::Pieces;
    use nurbs::{KnotVector, Surface};
    use scene::Model;

    /// Numbers in [-1, 1), the same on every machine (Steele & Vigna 2021, splitmix64).
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Patches scattered about a centre: every third a rectangle across an axis, whose box has no thickness.
    fn patches(state: &mut u64, center: DVec3) -> Model {
        let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        let surfaces = (0..300)
            .map(|k| {
                let mut any = || DVec3::new(random(state), random(state), random(state));
                let at = center + any();
                let corners = if k % 3 == 0 {
                    let [x, y] = [DVec3::X, DVec3::Y].map(|axis| axis * 0.1);
                    [at, at + y, at + x, at + x + y]
                } else {
                    [at, at + any() * 0.1, at + any() * 0.1, at + any() * 0.1]
                };
                Surface::new(knots.clone(), knots.clone(), corners.to_vec(), None).unwrap()
            })
            .collect();
        Model::of_surfaces("patches", surfaces).unwrap()
    }

    #[test]
    fn no_piece_with_a_point_on_the_ray_is_culled() {
        let mut state = 5;
        for center in [DVec3::ZERO, DVec3::new(1e9, -1e8, 3.0)] {
            let model = patches(&mut state, center);
            let pieces = Pieces::new(&model);
            let tree = Tree::new(&pieces);
            for case in 0..30_000 {
                let index = case % pieces.pieces.len();
                let [[u0, u1], [v0, v1]] = pieces.pieces[index].domain;
                let surface = &model.surfaces()[pieces.pieces[index].body as usize];
                let (s, t) = (0.5 + 0.5 * random(&mut state), 0.5 + 0.5 * random(&mut state));
                let target = surface.point(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t);
                // Along an axis, nearly along one, or anywhere; from inside the scene to very far.
                let mut direction = DVec3::new(random(&mut state), random(&mut state), random(&mut state));
                let small = [1.0, 1e-7, 1e-12, 0.0][case % 4];
                direction.x *= small;
                direction.z *= [1.0, small][case / 4 % 2];
                let direction = direction.normalize();
                let distance = [0.5, 5.0, 1e4][case / 8 % 3];
                let ray = Ray { origin: target - direction * distance, direction, near: 0.0 };
                let mut seen = false;
                tree.visit(&ray, |visited| {
                    seen |= visited == index;
                    f64::INFINITY
                });
                assert!(seen, "case {case}: piece {index} at {target:?} along {direction:?}");
                // A hit just there must not cull the piece that has it.
                let mut seen = false;
                tree.visit(&ray, |visited| {
                    seen |= visited == index;
                    distance
                });
                assert!(seen, "case {case}, cut off at the hit");
            }
        }
    }

    #[test]
    fn rays_beside_or_past_the_scene_visit_nothing() {
        let mut state = 6;
        let model = patches(&mut state, DVec3::ZERO);
        let tree = Tree::new(&Pieces::new(&model));
        let visited = |origin: DVec3, near: f64| {
            let mut count = 0;
            tree.visit(&Ray { origin, direction: DVec3::X, near }, |_| {
                count += 1;
                f64::INFINITY
            });
            count
        };
        assert!(visited(DVec3::new(-5.0, 0.0, 0.0), 0.0) > 0);
        assert_eq!(visited(DVec3::new(-5.0, 3.0, 0.0), 0.0), 0);
        assert_eq!(visited(DVec3::new(5.0, 0.0, 0.0), 0.0), 0);
        assert_eq!(visited(DVec3::new(-5.0, 0.0, 0.0), 10.0), 0);
    }
}

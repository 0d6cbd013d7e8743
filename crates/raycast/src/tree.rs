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
        let radius = min.abs().max(max.abs()).length();
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
mod tests {}

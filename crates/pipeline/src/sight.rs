//! What a pixel sees of a face: its ray as two planes, and its footprint in the parameters. Twin of `shaders/sight.wgsl`.
//!
//! S(u, v) is on the ray where its offset from the pixel, in pixels, vanishes in x and in y. The offset is the projection
//! of S less the pixel's position, so its size means the same whatever the distance, the focal length and the scale of the
//! face. By its derivatives the tangent plane says where the ray meets the surface near a point that is not quite on
//! it, and how far u and v run from one pixel to the next (after Igehy, *Tracing ray differentials*, SIGGRAPH 1999).
//!
//! There a face that is bounded by loops says whether it covers the pixel ([`is_shown`]): at the pixel's own ray, not where
//! a triangle's interpolated (u, v) is. Each face decides by itself; as each goes [`NEAR_PX`] too far, two whose edges
//! coincide leave no crack between them. Of two that cover one pixel there the nearer is seen, or the one drawn first.

use crate::PackedScene;
use crate::fragment::{TangentPlane, tangent_plane};
use crate::layout::{BOUNDED, FaceRecord, View};
use crate::trim;

/// How far beyond its border, natural or trimmed, a face covers a pixel's centre, pixels: two that share an edge to within
/// twice this leave no crack, whatever f32 makes of either.
pub const NEAR_PX: f32 = 1.0 / 256.0;

/// The farthest that a tangent plane is followed, in pixels were it seen at a right angle.
pub const REACH_PX: f32 = 4.0;

/// A step that short, in the same pixels, is the last: what it leaves is quadratic in it.
pub const LAST_STEP_PX: f32 = 1.0 / 8.0;

/// Steps at most from where a triangle is to where the pixel's ray is.
pub const STEPS: u32 = 4;

/// Below this determinant, as a share of the squared columns, the columns count as nearly parallel.
pub const NEARLY_SINGULAR: f32 = 1.0 / 65536.0;

/// A pixel's ray as planes in a face's local coordinates: offsets times w in x (right) and y (up), z, and w.
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    pub(crate) x: [f32; 4],
    pub(crate) y: [f32; 4],
    pub(crate) z: [f32; 4],
    pub(crate) w: [f32; 4],
}

/// A pixel's centre in the parameters of a face, on the tangent plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Where the pixel's ray meets the plane, local parameters; they may lie beyond the domain.
    pub center: [f32; 2],
    /// What u and v gain along a pixel to the right; zeros where the plane is seen edge-on.
    pub right: [f32; 2],
    /// The same along a pixel up.
    pub up: [f32; 2],
    /// Whether the ray meets the plane so near S that it meets the surface there, too.
    pub settled: bool,
    /// Whether nothing can be known of where it meets the surface: the plane is too far from the ray, or nearly along it.
    pub lost: bool,
}

impl Sight {
    /// The ray through picture position `at`, pixels from the top left corner.
    #[inline]
    pub fn new(view: &View, at: [f32; 2]) -> Self {
        let m = &view.clip_from_local;
        let row = |r: usize| [m[0][r], m[1][r], m[2][r], m[3][r]];
        let (w, z) = (row(3), row(2));
        let [right, up] = [at[0] - view.units[1], view.units[2] - at[1]];
        let plane = |half: f32, clip: [f32; 4], across: f32| std::array::from_fn(|i| half * clip[i] - across * w[i]);
        Self { x: plane(view.units[1], row(0), right), y: plane(view.units[2], row(1), up), z, w }
    }

    /// Derivatives of (x, y, z) / w, which have `value`, along a derivative of S; last, of w. All of them times w.
    #[inline(always)]
    pub(crate) fn along(&self, value: [f32; 3], derivative: [f32; 3]) -> [f32; 4] {
        let of = |p: &[f32; 4]| dot([p[0], p[1], p[2]], derivative);
        let slope = of(&self.w);
        // Of a quotient: what is left of the plane's own slope is that of w, seen at the value.
        let quotient = |p: &[f32; 4], value: f32| of(p) - value * slope;
        [quotient(&self.x, value[0]), quotient(&self.y, value[1]), quotient(&self.z, value[2]), slope]
    }

    /// Pixels to a local unit across the ray, squared, where w is that of S.
    #[inline(always)]
    pub(crate) fn squared_pixels(&self, w: f32) -> f32 {
        let right = [self.x[0], self.x[1], self.x[2]];
        dot(right, right) / (w * w)
    }

    /// The footprint on a tangent plane.
    ///
    /// Where the ray meets the plane farther from S than [`REACH_PX`], or runs nearly along it, the centre is S's own uv.
    pub fn footprint(&self, &TangentPlane { uv, s, su, sv }: &TangentPlane) -> Footprint {
        let w = plane(&self.w, s);
        let [x, y] = [&self.x, &self.y].map(|p| plane(p, s) / w);
        let [a, b] = [su, sv].map(|derivative| self.along([x, y, 0.0], derivative).map(|slope| slope / w));
        let (right, up) = across([a[0], a[1]], [b[0], b[1]]);
        let step = [0, 1].map(|k| -(x * right[k] + y * up[k]));
        let far = (dot(su, su) * (step[0] * step[0])).max(dot(sv, sv) * (step[1] * step[1])) * self.squared_pixels(w);
        let found = far <= REACH_PX * REACH_PX && (right != [0.0; 2] || up != [0.0; 2]);
        let center = if found { [uv[0] + step[0], uv[1] + step[1]] } else { uv };
        Footprint { center, right, up, settled: found && far <= LAST_STEP_PX * LAST_STEP_PX, lost: !found }
    }

    /// The parameters that a fragment of a bounded face shows, if the face covers the pixel: those interpolated, `uv`, at
    /// which it has the tangent plane; on a skirt those where the ray meets the surface.
    pub fn shown(&self, scene: &PackedScene, face: u32, uv: [f32; 2], plane: &TangentPlane) -> Option<[f32; 2]> {
        let on_skirt = uv != plane.uv;
        let mut at = self.footprint(plane);
        for _ in 1..STEPS {
            if at.settled || at.lost {
                break;
            }
            at = self.footprint(&tangent_plane(scene, face, at.center));
        }
        let is_shown = (at.settled || !on_skirt) && is_shown(scene, &scene.faces[face as usize], &at);
        is_shown.then_some(if on_skirt { at.center } else { uv })
    }
}

/// Whether `face` of the scene covers a pixel: it has material in the middle of the footprint, or [`NEAR_PX`] to its
/// right, left, above or below.
pub fn is_shown(scene: &PackedScene, face: &FaceRecord, &Footprint { center, right, up, .. }: &Footprint) -> bool {
    if face.flags & BOUNDED == 0 || is_there(scene, face, center) {
        return true;
    }
    let [right, up] = [right, up].map(|gain| gain.map(|t| t * NEAR_PX));
    let reach = [0, 1].map(|k| right[k].abs().max(up[k].abs()));
    let at_border = (0..2).any(|k| center[k] < reach[k] || center[k] > 1.0 - reach[k]);
    let beside = |gain: [f32; 2], sign: f32| is_there(scene, face, [0, 1].map(|k| center[k] + sign * gain[k]));
    (at_border || trim::is_at_edge(scene, face, center, reach))
        && (beside(right, 1.0) || beside(right, -1.0) || beside(up, 1.0) || beside(up, -1.0))
}

/// Whether local parameters are in the domain, and material.
fn is_there(scene: &PackedScene, face: &FaceRecord, uv: [f32; 2]) -> bool {
    uv.iter().all(|t| (0.0..=1.0).contains(t)) && trim::is_material(scene, face, uv)
}

/// What two parameters gain along a pixel to the right, and along one up, where their own gains move by `a` and `b`
/// pixels; zeros where these are nearly parallel.
#[inline(always)]
pub(crate) fn across(a: [f32; 2], b: [f32; 2]) -> ([f32; 2], [f32; 2]) {
    let det = a[0] * b[1] - a[1] * b[0];
    let squares = a[0] * a[0] + a[1] * a[1] + (b[0] * b[0] + b[1] * b[1]);
    if det.abs() > NEARLY_SINGULAR * squares {
        ([b[1] / det, -a[1] / det], [-b[0] / det, a[0] / det])
    } else {
        ([0.0; 2], [0.0; 2])
    }
}

#[inline(always)]
pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A plane's value at a point.
#[inline(always)]
pub(crate) fn plane(p: &[f32; 4], at: [f32; 3]) -> f32 {
    p[0] * at[0] + p[1] * at[1] + p[2] * at[2] + p[3]
}

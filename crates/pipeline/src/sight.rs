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

use crate::fragment::{TangentPlane, is_on_skirt, tangent_plane};
use crate::layout::{BOUNDED, FaceRecord, Parameters, View};
use crate::packed::PackedScene;
use crate::trim::{self, Reach};
use std::cmp::Ordering;

/// How far beyond its border, natural or trimmed, a face covers a pixel's centre, pixels: two that share an edge to within
/// twice this leave no crack, whatever f32 makes of either.
pub const NEAR_PX: f32 = 1.0 / 256.0;

/// Below this sine of the angle under which a face is seen that is less, in proportion: along the surface it is nowhere more
/// than 1/16 pixel, for so far the surface is flat.
pub const STEEP: f32 = 1.0 / 16.0;

/// The farthest that a tangent plane is followed, in pixels were it seen at a right angle.
pub const REACH_PX: f32 = 4.0;

/// How far a tangent plane leads from a fragment of a skirt to the next place, where it is decided. Triangles fall short of a border by
/// their error in the picture, and along a surface that is seen under the angle α by 1 / sin α as much: this is an error of half a
/// pixel at one degree. That the surface may have bent away there does no harm, since that place has a tangent plane of its own.
pub const SKIRT_REACH_PX: f32 = 32.0;

/// The farthest that it leads from there to the ray of a pixel that a fragment of a skirt covers: Newton's method has come to the
/// ray. A sliver's parameters, interpolated beyond the triangle, may be anywhere, and a surface may bend away from its border
/// within a pixel.
pub const SKIRT_FOUND_PX: f32 = 1.0 / 16.0;

/// A fragment of a skirt is led on until its next place is no farther than this, in pixels were the surface seen at a right angle.
pub const SKIRT_SETTLED_PX: f32 = 1.0 / 256.0;

/// How often a fragment of a skirt is led on at most.
pub const SKIRT_STEPS: u32 = 6;

/// Below this determinant, as a share of the squared columns, the columns count as nearly parallel.
pub const NEARLY_SINGULAR: f32 = 1.0 / 65536.0;

/// A pixel's ray as planes in a face's local coordinates: offsets times w in x (right) and y (up), z, and w.
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    /// Offset to the right, times w.
    pub x: [f32; 4],
    /// Offset up, times w.
    pub y: [f32; 4],
    /// z.
    pub z: [f32; 4],
    /// w.
    pub w: [f32; 4],
}

/// A pixel's centre in the parameters of a face, on the tangent plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Where the pixel's ray meets the plane, parameters of the whole domain; they may lie beyond it.
    pub center: [f32; 2],
    /// What u and v gain along a pixel to the right; zeros where the plane is seen edge-on.
    pub right: [f32; 2],
    /// The same along a pixel up.
    pub up: [f32; 2],
    /// How far beyond its border a face covers this pixel, pixels: [`NEAR_PX`], but less where it is seen edge-on.
    pub near_px: f32,
    /// How far it is from S, pixels squared, were the plane seen at a right angle; the greatest number where the ray meets it
    /// too far away, or runs nearly along it, and the centre is S's own (u, v).
    pub step_squared: f32,
}

impl Footprint {
    /// Whether its centre is beyond the domain.
    fn is_beyond(&self) -> bool {
        self.center.iter().any(|t| !(0.0..=1.0).contains(t))
    }

    /// The ellipse of parameters that is [`Self::near_px`] about its centre in the picture.
    fn reach(&self) -> Reach {
        let [a, b] = [self.right, self.up].map(|gain| gain.map(|t| t * self.near_px));
        let metric = [a[0] * a[0] + b[0] * b[0], a[0] * a[1] + b[0] * b[1], a[1] * a[1] + b[1] * b[1]];
        Reach { metric, extent: [metric[0].sqrt(), metric[2].sqrt()] }
    }

    /// The place, of those whose parameters are from 0 to 1, that is nearest to the centre in the picture.
    ///
    /// Where parameters come to the border at a slant, that is not the one with the nearest parameters: along each border
    /// the other parameter goes where the distance is least, and the nearer of the two places stays.
    fn nearest(&self) -> [f32; 2] {
        let ([a, b], [c, d], center) = (self.right, self.up, self.center);
        let [uu, uv, vv] = [a * a + c * c, a * b + c * d, b * b + d * d];
        let inside = center.map(|t| t.clamp(0.0, 1.0));
        let beyond = [0, 1].map(|k| center[k] - inside[k]);
        let slope = |side: f32| if side > 0.0 { uv / side } else { 0.0 };
        let on_u = [inside[0], (center[1] - beyond[0] * slope(uu)).clamp(0.0, 1.0)];
        let on_v = [(center[0] - beyond[1] * slope(vv)).clamp(0.0, 1.0), inside[1]];
        // Squared, times a factor that all places share.
        let distance = |place: [f32; 2]| {
            let [u, v] = [0, 1].map(|k| place[k] - center[k]);
            vv * u * u - 2.0 * uv * u * v + uu * v * v
        };
        if distance(on_u) <= distance(on_v) { on_u } else { on_v }
    }
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
    pub fn along(&self, value: [f32; 3], derivative: [f32; 3]) -> [f32; 4] {
        let of = |p: &[f32; 4]| dot([p[0], p[1], p[2]], derivative);
        let slope = of(&self.w);
        // Of a quotient: what is left of the plane's own slope is that of w, seen at the value.
        let quotient = |p: &[f32; 4], value: f32| of(p) - value * slope;
        [quotient(&self.x, value[0]), quotient(&self.y, value[1]), quotient(&self.z, value[2]), slope]
    }

    /// Pixels to a local unit across the ray, squared, where w is that of S.
    #[inline(always)]
    pub fn squared_pixels(&self, w: f32) -> f32 {
        let right = [self.x[0], self.x[1], self.x[2]];
        dot(right, right) / (w * w)
    }

    /// The footprint on a tangent plane that is followed as far as `reach_px`.
    ///
    /// Where the ray meets the plane farther from S, or runs nearly along it, the centre is S's own uv.
    pub fn footprint(&self, &TangentPlane { uv, s, su, sv, .. }: &TangentPlane, reach_px: f32) -> Footprint {
        let w = plane(&self.w, s);
        let [x, y] = [&self.x, &self.y].map(|p| plane(p, s) / w);
        let [a, b] = [su, sv].map(|derivative| self.along([x, y, 0.0], derivative).map(|slope| slope / w));
        let (right, up) = across([a[0], a[1]], [b[0], b[1]]);
        let step = [0, 1].map(|k| -(x * right[k] + y * up[k]));
        let pixels = self.squared_pixels(w);
        let [side_u, side_v] = [su, sv].map(|derivative| dot(derivative, derivative) * pixels);
        let far = (side_u * (step[0] * step[0])).max(side_v * (step[1] * step[1]));
        let found = far <= reach_px * reach_px && (right != [0.0; 2] || up != [0.0; 2]);
        let center = if found { [uv[0] + step[0], uv[1] + step[1]] } else { uv };
        let near_px = near_px([a[0], a[1]], [b[0], b[1]], side_u * side_v);
        Footprint { center, right, up, near_px, step_squared: if found { far } else { f32::MAX } }
    }

    /// Whether a fragment of `face` at `at`, where the face has a tangent plane, covers the pixel, and then its depth z / w: that
    /// of its triangle, given as `depth`, but on a skirt that of the place that it shows, which may be far from there. Where the ray
    /// passes the face by, within [`NEAR_PX`] of its border, the farther of the two: a skirt goes back from the border, so that
    /// the neighbour that the ray meets there stays in front.
    pub fn shows(
        &self,
        scene: &PackedScene,
        face: u32,
        at: Parameters,
        plane: &TangentPlane,
        depth: f32,
    ) -> Option<f32> {
        let (_, plane) = self.settled(scene, face, at, plane);
        let footprint = self.footprint(&plane, REACH_PX);
        let is_far = plane.on_skirt && footprint.step_squared > SKIRT_FOUND_PX * SKIRT_FOUND_PX;
        let depth = match plane.on_skirt {
            true if footprint.is_beyond() => self.depth(plane.s).min(depth),
            true => self.depth(plane.s),
            false => depth,
        };
        let is_there = depth > 0.0 && !is_far && is_shown(scene, &scene.faces()[face as usize], &footprint);
        is_there.then_some(depth)
    }

    /// z / w of a point, from 0 to 1; 0, which is infinitely far, of one behind the eye.
    fn depth(&self, s: [f32; 3]) -> f32 {
        let w = plane(&self.w, s);
        if w > 0.0 { (plane(&self.z, s) / w).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Where a fragment shows its face: at its parameters, but on a skirt at the place that is nearest to the pixel in the
    /// picture.
    pub fn place(&self, scene: &PackedScene, face: u32, at: Parameters) -> Parameters {
        if !is_on_skirt(&scene.faces()[face as usize], at) {
            return at;
        }
        self.settled(scene, face, at, &tangent_plane(scene, face, at)).0
    }

    /// The parameters and the tangent plane that decide about a fragment. On a skirt tangent planes lead from the border to the place
    /// of the face that is nearest to the pixel, up to [`SKIRT_STEPS`] times, until it moves no farther than [`SKIRT_SETTLED_PX`].
    fn settled(
        &self,
        scene: &PackedScene,
        face: u32,
        mut at: Parameters,
        plane: &TangentPlane,
    ) -> (Parameters, TangentPlane) {
        let mut plane = *plane;
        for _ in 0..if plane.on_skirt { SKIRT_STEPS } else { 0 } {
            let (next, way_squared) = self.nearest_on_span(scene, face, at, &plane);
            if way_squared <= SKIRT_SETTLED_PX * SKIRT_SETTLED_PX {
                break;
            }
            at = next;
            plane = TangentPlane { on_skirt: true, ..tangent_plane(scene, face, at) };
        }
        (at, plane)
    }

    /// The place of a fragment's span that is nearest to the pixel in the picture, as a tangent plane on it has it; beyond a knot
    /// that is no border, the place of the next span. With it comes the square of the way there, in pixels were the surface seen at
    /// a right angle; to another span it counts as endless.
    fn nearest_on_span(
        &self,
        scene: &PackedScene,
        face: u32,
        at: Parameters,
        plane: &TangentPlane,
    ) -> (Parameters, f32) {
        let f = &scene.faces()[face as usize];
        let spans = scene.spans(f, at.span);
        // By the span's own parameters, which f32 resolves however short it is.
        let by_span = |derivative: [f32; 3], k: usize| derivative.map(|x| x * spans[k].length);
        let (su, sv) = (by_span(plane.su, 0), by_span(plane.sv, 1));
        let plane = TangentPlane { uv: at.uv.map(|t| t.clamp(0.0, 1.0)), su, sv, ..*plane };
        let found = self.footprint(&plane, SKIRT_REACH_PX);
        let on_span = found.nearest();
        let lasts = [f.spans_u - 1, f.spans_v - 1];
        let next = [0, 1].map(|k| match found.center[k] {
            t if t < 0.0 && at.span[k] > 0 => at.span[k] - 1,
            t if t > 1.0 && at.span[k] < lasts[k] => at.span[k] + 1,
            _ => at.span[k],
        });
        let lengths = scene.spans(f, next).map(|span| span.length);
        let uv = [0, 1].map(|k| {
            let gain = spans[k].length / lengths[k];
            match next[k].cmp(&at.span[k]) {
                Ordering::Less => (1.0 + found.center[k] * gain).clamp(0.0, 1.0),
                Ordering::Greater => ((found.center[k] - 1.0) * gain).clamp(0.0, 1.0),
                Ordering::Equal => on_span[k],
            }
        });
        let pixels = self.squared_pixels(self::plane(&self.w, plane.s));
        let squares = [0, 1].map(|k| {
            let way = uv[k] - plane.uv[k];
            dot([su, sv][k], [su, sv][k]) * pixels * (way * way)
        });
        let way_squared = if next == at.span { squares[0].max(squares[1]) } else { f32::MAX };
        (Parameters { span: next, uv }, way_squared)
    }
}

/// Whether `face` of the scene covers a pixel: it has material within [`Footprint::near_px`] of the middle of the footprint.
pub fn is_shown(scene: &PackedScene, face: &FaceRecord, footprint: &Footprint) -> bool {
    if face.flags & BOUNDED == 0 {
        return true;
    }
    let reach = footprint.reach();
    let center = footprint.center;
    let uv = center.map(|t| t.clamp(0.0, 1.0));
    let beyond = [0, 1].map(|k| (center[k] - uv[k]).abs());
    beyond[0] <= reach.extent[0] && beyond[1] <= reach.extent[1] && trim::is_near_material(scene, face, uv, &reach)
}

/// What two parameters gain along a pixel to the right, and along one up, where their own gains move by `a` and `b`
/// pixels; zeros where these are nearly parallel.
#[inline(always)]
pub fn across(a: [f32; 2], b: [f32; 2]) -> ([f32; 2], [f32; 2]) {
    let det = a[0] * b[1] - a[1] * b[0];
    let squares = a[0] * a[0] + a[1] * a[1] + (b[0] * b[0] + b[1] * b[1]);
    if det.abs() > NEARLY_SINGULAR * squares {
        ([b[1] / det, -a[1] / det], [-b[0] / det, a[0] / det])
    } else {
        ([0.0; 2], [0.0; 2])
    }
}

/// How far beyond its border a face covers a pixel where its parameters' gains move by `a` and `b` pixels, and would move by
/// the square root of `sides_squared`, the one times the other, seen at a right angle.
#[inline(always)]
pub fn near_px(a: [f32; 2], b: [f32; 2], sides_squared: f32) -> f32 {
    let det = (a[0] * b[1] - a[1] * b[0]).abs();
    let steep = STEEP * sides_squared.sqrt();
    if det < steep { NEAR_PX * (det / steep) } else { NEAR_PX }
}

/// The scalar product, summed in order.
#[inline(always)]
pub fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A plane's value at a point.
#[inline(always)]
pub fn plane(p: &[f32; 4], at: [f32; 3]) -> f32 {
    p[0] * at[0] + p[1] * at[1] + p[2] * at[2] + p[3]
}

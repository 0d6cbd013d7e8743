// What a pixel sees of a face: its ray as two planes, and its footprint in the parameters. Twin of crates/pipeline/src/sight.rs.
// Uses layout.wgsl trim.wgsl

const NEAR_PX: f32 = 1.0 / 256.0;
const STEEP: f32 = 1.0 / 16.0;
const REACH_PX: f32 = 4.0;
const SKIRT_REACH_PX: f32 = 32.0;
const SKIRT_FOUND_PX: f32 = 1.0 / 16.0;
const SKIRT_SETTLED_PX: f32 = 1.0 / 256.0;
const SKIRT_STEPS: u32 = 6u;
const NEARLY_SINGULAR: f32 = 1.0 / 65536.0;

struct Sight {
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
    w: vec4<f32>,
}

struct Footprint {
    center: vec2<f32>,
    right: vec2<f32>,
    up: vec2<f32>,
    near_px: f32,
    step_squared: f32,
}

struct Across {
    right: vec2<f32>,
    up: vec2<f32>,
}

fn sight(view: View, at: vec2<f32>) -> Sight {
    let m = transpose(view.clip_from_local);
    let right = at.x - view.units.y;
    let up = view.units.z - at.y;
    return Sight(view.units.y * m[0] - right * m[3], view.units.z * m[1] - up * m[3], m[2], m[3]);
}

fn plane(p: vec4<f32>, at: vec3<f32>) -> f32 {
    return dot(p.xyz, at) + p.w;
}

// z / w of a point, from 0 to 1; 0, which is infinitely far, of one behind the eye.
fn depth_of(s: Sight, position: vec3<f32>) -> f32 {
    let w = plane(s.w, position);
    if (w > 0.0) {
        return clamp(plane(s.z, position) / w, 0.0, 1.0);
    }
    return 0.0;
}

// The derivative of a quotient, times w: what is left of the planes' own slopes is that of w, seen at the value.
// Last, the slope of w itself.
fn along(s: Sight, value: vec3<f32>, derivative: vec3<f32>) -> vec4<f32> {
    let slopes = vec3<f32>(dot(s.x.xyz, derivative), dot(s.y.xyz, derivative), dot(s.z.xyz, derivative));
    let slope = dot(s.w.xyz, derivative);
    return vec4<f32>(slopes - value * slope, slope);
}

fn squared_pixels(s: Sight, w: f32) -> f32 {
    return dot(s.x.xyz, s.x.xyz) / (w * w);
}

fn footprint(s: Sight, uv: vec2<f32>, position: vec3<f32>, su: vec3<f32>, sv: vec3<f32>, reach_px: f32) -> Footprint {
    let w = plane(s.w, position);
    let value = vec3<f32>(plane(s.x, position), plane(s.y, position), 0.0) / w;
    let a = along(s, value, su).xy / w;
    let b = along(s, value, sv).xy / w;
    let pixel = across(a, b);
    let step = -(value.x * pixel.right + value.y * pixel.up);
    let pixels = squared_pixels(s, w);
    let side_u = dot(su, su) * pixels;
    let side_v = dot(sv, sv) * pixels;
    let far = max(side_u * (step.x * step.x), side_v * (step.y * step.y));
    let found = far <= reach_px * reach_px && (any(pixel.right != vec2<f32>()) || any(pixel.up != vec2<f32>()));
    let center = select(uv, uv + step, found);
    return Footprint(center, pixel.right, pixel.up, near_px(a, b, side_u * side_v), select(GREATEST, far, found));
}

fn across(a: vec2<f32>, b: vec2<f32>) -> Across {
    let det = a.x * b.y - a.y * b.x;
    let squares = dot(a, a) + dot(b, b);
    if (abs(det) > NEARLY_SINGULAR * squares) {
        return Across(vec2<f32>(b.y, -a.y) / det, vec2<f32>(-b.x, a.x) / det);
    }
    return Across(vec2<f32>(), vec2<f32>());
}

fn near_px(a: vec2<f32>, b: vec2<f32>, sides_squared: f32) -> f32 {
    let det = abs(a.x * b.y - a.y * b.x);
    let steep = STEEP * sqrt(sides_squared);
    if (det < steep) {
        return NEAR_PX * (det / steep);
    }
    return NEAR_PX;
}

fn reach_of(at: Footprint) -> Reach {
    let a = at.right * at.near_px;
    let b = at.up * at.near_px;
    let metric = vec3<f32>(a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y);
    return Reach(metric, sqrt(metric.xz));
}

// The place, of those whose parameters are from 0 to 1, that is nearest to the centre in the picture.
fn nearest(at: Footprint) -> vec2<f32> {
    let uu = at.right.x * at.right.x + at.up.x * at.up.x;
    let uv = at.right.x * at.right.y + at.up.x * at.up.y;
    let vv = at.right.y * at.right.y + at.up.y * at.up.y;
    let inside = clamp(at.center, vec2<f32>(0.0), vec2<f32>(1.0));
    let beyond = at.center - inside;
    let on_u = vec2<f32>(inside.x, clamp(at.center.y - beyond.x * slope_of(uv, uu), 0.0, 1.0));
    let on_v = vec2<f32>(clamp(at.center.x - beyond.y * slope_of(uv, vv), 0.0, 1.0), inside.y);
    let u = on_u - at.center;
    let v = on_v - at.center;
    let distance_u = vv * u.x * u.x - 2.0 * uv * u.x * u.y + uu * u.y * u.y;
    let distance_v = vv * v.x * v.x - 2.0 * uv * v.x * v.y + uu * v.y * v.y;
    return select(on_v, on_u, distance_u <= distance_v);
}

fn slope_of(uv: f32, side: f32) -> f32 {
    if (side > 0.0) {
        return uv / side;
    }
    return 0.0;
}

fn is_shown(face: FaceRecord, at: Footprint) -> bool {
    if ((face.flags & BOUNDED) == 0u) {
        return true;
    }
    let reach = reach_of(at);
    let uv = clamp(at.center, vec2<f32>(0.0), vec2<f32>(1.0));
    return all(abs(at.center - uv) <= reach.extent) && is_near_material(face, uv, reach);
}

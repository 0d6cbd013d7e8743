// What a pixel sees of a face: its ray as two planes, and its footprint in the parameters. Twin of crates/pipeline/src/sight.rs.

const NEAR_PX: f32 = 1.0 / 256.0;
const REACH_PX: f32 = 4.0;
const LAST_STEP_PX: f32 = 1.0 / 8.0;
const STEPS: u32 = 4u;
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
    settled: bool,
    lost: bool,
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

fn footprint(s: Sight, uv: vec2<f32>, position: vec3<f32>, su: vec3<f32>, sv: vec3<f32>) -> Footprint {
    let w = plane(s.w, position);
    let value = vec3<f32>(plane(s.x, position), plane(s.y, position), 0.0) / w;
    let pixel = across(along(s, value, su).xy / w, along(s, value, sv).xy / w);
    let step = -(value.x * pixel.right + value.y * pixel.up);
    let far = max(dot(su, su) * (step.x * step.x), dot(sv, sv) * (step.y * step.y)) * squared_pixels(s, w);
    let found = far <= REACH_PX * REACH_PX && (any(pixel.right != vec2<f32>()) || any(pixel.up != vec2<f32>()));
    let center = select(uv, uv + step, found);
    return Footprint(center, pixel.right, pixel.up, found && far <= LAST_STEP_PX * LAST_STEP_PX, !found);
}

fn across(a: vec2<f32>, b: vec2<f32>) -> Across {
    let det = a.x * b.y - a.y * b.x;
    let squares = dot(a, a) + dot(b, b);
    if (abs(det) > NEARLY_SINGULAR * squares) {
        return Across(vec2<f32>(b.y, -a.y) / det, vec2<f32>(-b.x, a.x) / det);
    }
    return Across(vec2<f32>(), vec2<f32>());
}

fn is_shown(face: FaceRecord, at: Footprint) -> bool {
    if ((face.flags & BOUNDED) == 0u || is_there(face, at.center)) {
        return true;
    }
    let right = at.right * NEAR_PX;
    let up = at.up * NEAR_PX;
    let reach = max(abs(right), abs(up));
    let at_border = any(at.center < reach) || any(at.center > 1.0 - reach);
    return (at_border || is_at_edge(face, at.center, reach))
        && (is_there(face, at.center + right)
            || is_there(face, at.center - right)
            || is_there(face, at.center + up)
            || is_there(face, at.center - up));
}

fn is_there(face: FaceRecord, uv: vec2<f32>) -> bool {
    return all(uv >= vec2<f32>(0.0)) && all(uv <= vec2<f32>(1.0)) && is_material(face, uv);
}

// Whether a face has material at (u, v). Twin of crates/pipeline/src/trim.rs.
// Uses layout.wgsl

const BELOW_ONE: f32 = 0.99999994;
const BISECTIONS: u32 = 24u;

// An ellipse of parameters.
struct Reach {
    metric: vec3<f32>,
    extent: vec2<f32>,
}

fn is_material(face: FaceRecord, uv: vec2<f32>) -> bool {
    return is_near_material(face, uv, Reach());
}

fn toward(reach: Reach, n: vec2<f32>) -> vec2<f32> {
    let g = vec2<f32>(dot(reach.metric.xy, n), dot(reach.metric.yz, n));
    let squared = dot(n, g);
    if (squared > 0.0) {
        return g / sqrt(squared);
    }
    return vec2<f32>();
}

fn is_near_material(face: FaceRecord, uv: vec2<f32>, reach: Reach) -> bool {
    if (face.intervals == 0u) {
        return true;
    }
    let at = min(uv, vec2<f32>(BELOW_ONE));
    // Beyond a level edge or a corner is another interval.
    let up = toward(reach, vec2<f32>(0.0, 1.0));
    var place = at;
    var is_above = false;
    var within = reach;
    for (var k = 0u; k < 3u; k++) {
        let here = side(face, place, within);
        if (here.material) {
            return true;
        }
        if (k == 0u) {
            is_above = at.y + reach.extent.y >= here.high;
            within = Reach();
        }
        if (k == 0u && at.y - reach.extent.y < here.low) {
            place = min(at - up, vec2<f32>(BELOW_ONE));
        } else if (is_above) {
            is_above = false;
            place = min(at + up, vec2<f32>(BELOW_ONE));
        } else {
            return false;
        }
    }
    return false;
}

struct Side {
    material: bool,
    low: f32,
    high: f32,
}

fn side(face: FaceRecord, at: vec2<f32>, reach: Reach) -> Side {
    let ends = face.trims;
    if (at.y < knots[ends]) {
        return Side(false, -GREATEST, knots[ends]);
    }
    if (at.y >= knots[ends + face.intervals]) {
        return Side(false, knots[ends + face.intervals], GREATEST);
    }
    var low = 0u;
    var high = face.intervals;
    while (high - low > 1u) {
        let middle = (low + high) / 2u;
        if (at.y < knots[ends + middle]) {
            high = middle;
        } else {
            low = middle;
        }
    }
    let starts = ends + face.intervals + 1u;
    let first = u32(knots[starts + low]);
    let end = u32(knots[starts + low + 1u]);
    // Edges before `left` pass on the left, those from `right` on do not.
    var left = first;
    var right = end;
    while (left < right) {
        let middle = (left + right) / 2u;
        let inward = select(-1.0, 1.0, (middle - first) % 2u == 0u);
        if (passes_left(points[middle], at, reach, inward)) {
            left = middle + 1u;
        } else {
            right = middle;
        }
    }
    return Side((left - first) % 2u == 1u, knots[ends + low], knots[ends + high]);
}

fn passes_left(edge: vec4<f32>, at: vec2<f32>, reach: Reach, inward: f32) -> bool {
    let moved = at.x + inward * reach.extent.x;
    if (max(at.x, moved) < edge.x) {
        return false;
    }
    if (min(at.x, moved) >= edge.y) {
        return true;
    }
    let piece = u32(edge.z);
    let box = points[piece];
    // Across the piece's chord; an upright one has no extent in u.
    let across = select(vec2<f32>(1.0, 0.0), vec2<f32>(box.z, -edge.w * box.w), box.z > 0.0);
    let shift = toward(reach, across);
    if (box.z <= 0.0) {
        return at.x + inward * shift.x >= box.x;
    }
    let x = (at.x + inward * shift.x - box.x) * box.z;
    let y = (at.y + inward * shift.y - box.y) * box.w;
    let control = piece + 1u;
    let degree = u32(points[control].w);
    var low = 0.0;
    var high = 1.0;
    var x_low = points[control].x / points[control].z;
    var x_high = points[control + degree].x / points[control + degree].z;
    for (var k = 0u; k < BISECTIONS; k++) {
        if (x < min(x_low, x_high)) {
            return false;
        }
        if (x >= max(x_low, x_high)) {
            return true;
        }
        let t = 0.5 * (low + high);
        let c = boundary_point(control, degree, t);
        if (c.y <= y * c.z) {
            low = t;
            x_low = c.x / c.z;
        } else {
            high = t;
            x_high = c.x / c.z;
        }
    }
    return x >= 0.5 * (x_low + x_high);
}

fn boundary_point(control: u32, degree: u32, t: f32) -> vec3<f32> {
    let s = 1.0 - t;
    var power = 1.0;
    var sum = vec3<f32>();
    for (var i = 0u; i < degree; i++) {
        sum = (sum + power * points[control + i].xyz) * s;
        power *= t;
    }
    return sum + power * points[control + degree].xyz;
}

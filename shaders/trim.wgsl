// Whether a face has material at (u, v). Twin of crates/pipeline/src/trim.rs.

const BELOW_ONE: f32 = 0.99999994;
const BISECTIONS: u32 = 24u;

fn is_material(face: FaceRecord, uv: vec2<f32>) -> bool {
    if (face.intervals == 0u) {
        return true;
    }
    let at = locate(face, min(uv, vec2<f32>(BELOW_ONE)));
    return at.found && (at.left - at.first) % 2u == 1u;
}

fn is_at_edge(face: FaceRecord, uv: vec2<f32>, reach: vec2<f32>) -> bool {
    if (face.intervals == 0u) {
        return false;
    }
    let ends = face.trims;
    let place = min(uv, vec2<f32>(BELOW_ONE));
    let at = locate(face, place);
    if (!at.found) {
        return place.y + reach.y >= knots[ends] && place.y - reach.y < knots[ends + face.intervals];
    }
    return place.y - reach.y < knots[ends + at.interval]
        || place.y + reach.y >= knots[ends + at.interval + 1u]
        || (at.left > at.first && place.x - reach.x < points[at.left - 1u].y)
        || (at.left < at.end && place.x + reach.x >= points[at.left].x);
}

struct Located {
    found: bool,
    interval: u32,
    first: u32,
    end: u32,
    left: u32,
}

fn locate(face: FaceRecord, at: vec2<f32>) -> Located {
    let ends = face.trims;
    if (!(at.y >= knots[ends] && at.y < knots[ends + face.intervals])) {
        return Located(false, 0u, 0u, 0u, 0u);
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
    var left = first;
    var right = end;
    while (left < right) {
        let middle = (left + right) / 2u;
        if (passes_left(points[middle], at)) {
            left = middle + 1u;
        } else {
            right = middle;
        }
    }
    return Located(true, low, first, end, left);
}

fn passes_left(edge: vec4<f32>, at: vec2<f32>) -> bool {
    if (at.x < edge.x) {
        return false;
    }
    if (at.x >= edge.y) {
        return true;
    }
    let piece = u32(edge.z);
    let box = points[piece];
    let x = (at.x - box.x) * box.z;
    let y = (at.y - box.y) * box.w;
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

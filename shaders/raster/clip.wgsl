// Clipping against the near and far planes of the clip volume and a guard band around the picture.
// Twin of crates/raster/src/clip.rs.
// Uses raster/strict.wgsl

const GUARD_BAND: f32 = 4.0;
// Corners of a triangle that six planes have cut.
const MOST_CORNERS: u32 = 9u;

// A corner before the division by w, as a share of the triangle's three.
struct ClipVertex {
    clip: vec4<f32>,
    uv: vec2<f32>,
    share: vec3<f32>,
}

struct Polygon {
    corners: array<ClipVertex, MOST_CORNERS>,
    count: u32,
}

// The signed distance to a plane, not negative inside.
fn distance_to(plane: u32, clip: vec4<f32>) -> f32 {
    let guard = GUARD_BAND * clip.w;
    switch (plane) {
        case 0u: { return difference(clip.w, clip.z); }
        case 1u: { return clip.z; }
        case 2u: { return sum(guard, clip.x); }
        case 3u: { return difference(guard, clip.x); }
        case 4u: { return sum(guard, clip.y); }
        default: { return difference(guard, clip.y); }
    }
}

fn is_inside(clip: vec4<f32>) -> bool {
    // Not a number is not inside.
    return distance_to(0u, clip) >= 0.0 && distance_to(1u, clip) >= 0.0 && distance_to(2u, clip) >= 0.0
        && distance_to(3u, clip) >= 0.0 && distance_to(4u, clip) >= 0.0 && distance_to(5u, clip) >= 0.0;
}

// The part of a triangle inside all planes.
fn clipped(corners: array<ClipVertex, 3>) -> Polygon {
    var polygon: Polygon;
    polygon.count = 3u;
    for (var i = 0u; i < 3u; i++) {
        polygon.corners[i] = corners[i];
    }
    for (var plane = 0u; plane < 6u; plane++) {
        var inside: Polygon;
        for (var i = 0u; i < polygon.count; i++) {
            let at = polygon.corners[i];
            let before = polygon.corners[(i + polygon.count - 1u) % polygon.count];
            let d_at = distance_to(plane, at.clip);
            let d_before = distance_to(plane, before.clip);
            if ((d_before >= 0.0 && d_at < 0.0) || (d_before < 0.0 && d_at >= 0.0)) {
                if (d_before >= 0.0) {
                    enter(&inside, cut(before, at, d_before, d_at));
                } else {
                    enter(&inside, cut(at, before, d_at, d_before));
                }
            }
            if (d_at >= 0.0) {
                enter(&inside, at);
            }
        }
        polygon = inside;
    }
    return polygon;
}

fn enter(polygon: ptr<function, Polygon>, corner: ClipVertex) {
    // Rounding makes no tenth corner of a convex polygon; were there one, nothing else would be written over.
    if ((*polygon).count < MOST_CORNERS) {
        (*polygon).corners[(*polygon).count] = corner;
        (*polygon).count += 1u;
    }
}

// Where the edge from `inside` to `outside` meets the plane at these distances from them.
fn cut(inside: ClipVertex, outside: ClipVertex, d_inside: f32, d_outside: f32) -> ClipVertex {
    let t = quotient(d_inside, difference(d_inside, d_outside));
    var at: ClipVertex;
    for (var i = 0u; i < 4u; i++) {
        at.clip[i] = sum(inside.clip[i], product(difference(outside.clip[i], inside.clip[i]), t));
    }
    at.uv = inside.uv + (outside.uv - inside.uv) * t;
    at.share = inside.share + (outside.share - inside.share) * t;
    return at;
}

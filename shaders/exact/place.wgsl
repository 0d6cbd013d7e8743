// A piece at one place of a search: where it is seen from a pixel, and how that changes. Twin of
// crates/techniques/src/exact/place.rs.
// Uses layout.wgsl eval.wgsl sight.wgsl

const ROUNDING: f32 = 1.0 / 2097152.0;
const BEYOND: f32 = 1.0 / 8.0;
const EDGE_ON: f32 = 3.0 / 8.0;

struct PieceRecord {
    hull_from_local: array<vec4<f32>, 3>,
    flat: vec4<f32>,
    rectangle: vec4<f32>,
    face: u32,
    span_u: u32,
    span_v: u32,
    patience: u32,
}

// How often the thread has evaluated the surface.
var<private> evaluations: u32;

struct Place {
    uv: vec2<f32>,
    w: f32,
    offset: vec2<f32>,
    squared: f32,
    rounding_squared: f32,
    along_u: vec2<f32>,
    along_v: vec2<f32>,
    side_squared: f32,
    sides_squared: f32,
    recedes: vec2<f32>,
    depth: vec3<f32>,
}

fn extent(piece: PieceRecord) -> vec2<f32> {
    return piece.rectangle.zw - piece.rectangle.xy;
}

// The square of what S moves by where its parameters grow by shares of themselves, as rounding has them do.
fn shifted_squared(uv: vec2<f32>, su: vec3<f32>, sv: vec3<f32>) -> f32 {
    return dot(su, su) * (uv.x * uv.x) + dot(sv, sv) * (uv.y * uv.y);
}

fn place(piece: PieceRecord, s: Sight, uv: vec2<f32>, is_divided: bool) -> Place {
    evaluations += 1u;
    let face = faces[piece.face];
    let p = degree(face.degree_u);
    let q = degree(face.degree_v);
    let span_u = span_of(face.table_u, face.spans_u, p, piece.span_u);
    let span_v = span_of(face.table_v, face.spans_v, q, piece.span_v);
    var nu = basis(span_u.knots, p, uv.x, 1.0, false);
    var nv = basis(span_v.knots, q, uv.y, 1.0, false);
    let d = surface(face, p, q, vec2<u32>(span_u.first, span_v.first), &nu, &nv, false);
    let size = extent(piece);
    let w = plane(s.w, d.s);
    var out: Place;
    out.uv = uv;
    out.w = w;
    let divided = is_divided && w > 0.0;
    let divisor = select(1.0, w, divided);
    out.offset = vec2<f32>(plane(s.x, d.s), plane(s.y, d.s)) / divisor;
    out.squared = dot(out.offset, out.offset);
    let pixels = squared_pixels(s, divisor);
    out.rounding_squared = ROUNDING * ROUNDING * pixels * (1.0 + shifted_squared(uv, d.su, d.sv));
    let side_u = dot(d.su, d.su) * (size.x * size.x) * pixels;
    let side_v = dot(d.sv, d.sv) * (size.y * size.y) * pixels;
    out.side_squared = max(side_u, side_v);
    out.sides_squared = side_u * side_v;
    out.depth.x = plane(s.z, d.s) / divisor;
    // Times w, the offset has slopes of its own.
    let value = select(vec3<f32>(), vec3<f32>(out.offset, out.depth.x), divided);
    let along_u = along(s, value, d.su) * (size.x / divisor);
    let along_v = along(s, value, d.sv) * (size.y / divisor);
    out.along_u = along_u.xy;
    out.along_v = along_v.xy;
    out.recedes = vec2<f32>(along_u.w, along_v.w);
    out.depth.y = along_u.z;
    out.depth.z = along_v.z;
    return out;
}

fn is_edge_on(at: Place) -> bool {
    let det = at.along_u.x * at.along_v.y - at.along_u.y * at.along_v.x;
    return det * det < EDGE_ON * EDGE_ON * at.sides_squared;
}

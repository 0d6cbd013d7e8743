// The fragment program: from interpolated (u, v) and a face to what the pixel shows.
// Twin of crates/pipeline/src/fragment.rs.

const REGULAR: u32 = 0u;
const UNDEFINED: u32 = 2u;

struct Fragment {
    uv: vec2<f32>,
    span: vec2<u32>,
    position: vec3<f32>,
    su: vec3<f32>,
    sv: vec3<f32>,
    normal: vec3<f32>,
    status: u32,
    curvature: vec2<f32>,
    speed: vec2<f32>,
}

fn fragment(face_id: u32, uv_interpolated: vec2<f32>) -> Fragment {
    let uv = min(max(uv_interpolated, vec2<f32>(0.0)), vec2<f32>(1.0));
    let face = faces[face_id];
    let p = degree(face.degree_u);
    let q = degree(face.degree_v);
    let span_u = find_span(face.knots_u, p, face.count_u, face.last_u, uv.x);
    let span_v = find_span(face.knots_v, q, face.count_v, face.last_v, uv.y);
    var nu = basis(face.knots_u, p, span_u, uv.x, CURVATURE);
    var nv = basis(face.knots_v, q, span_v, uv.y, CURVATURE);
    let d = surface(face, p, q, span_u, span_v, &nu, &nv, CURVATURE);
    var n = cross(d.su, d.sv);
    let n_squared = dot(n, n);
    let su_squared = dot(d.su, d.su);
    let sv_squared = dot(d.sv, d.sv);
    var out: Fragment;
    out.uv = uv;
    out.span = vec2<u32>(span_u, span_v);
    out.position = d.s;
    out.su = d.su;
    out.sv = d.sv;
    out.status = UNDEFINED;
    out.speed = vec2<f32>(sqrt(su_squared), sqrt(sv_squared));
    if (is_regular(n_squared, su_squared, sv_squared)) {
        let length = sqrt(n_squared);
        n = n / length;
        out.status = REGULAR;
        out.normal = n;
        if (CURVATURE) {
            out.curvature = curvature(d, n, su_squared);
        }
        if ((face.flags & REVERSED) != 0u) {
            out.normal = -out.normal;
            out.curvature = vec2<f32>(-out.curvature.y, -out.curvature.x);
        }
    }
    return out;
}

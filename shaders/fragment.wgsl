// The fragment program: from a face and interpolated parameters to what the pixel shows.
// Twin of crates/pipeline/src/fragment.rs.
// Uses layout.wgsl eval.wgsl

const REGULAR: u32 = 0u;
const UNDEFINED: u32 = 2u;

struct Parameters {
    span: vec2<u32>,
    uv: vec2<f32>,
}

struct Fragment {
    uv: vec2<f32>,
    span: vec2<u32>,
    // Parameters of the whole domain.
    whole: vec2<f32>,
    position: vec3<f32>,
    // Derivatives by parameters of the whole domain.
    su: vec3<f32>,
    sv: vec3<f32>,
    normal: vec3<f32>,
    status: u32,
    curvature: vec2<f32>,
    speed: vec2<f32>,
}

// Whether parameters are beyond the domain.
fn is_on_skirt(face: FaceRecord, at: Parameters) -> bool {
    let last = vec2<u32>(face.spans_u - 1u, face.spans_v - 1u);
    return any(((at.uv < vec2<f32>(0.0)) & (at.span == vec2<u32>(0u))) | ((at.uv > vec2<f32>(1.0)) & (at.span == last)));
}

// The spans and the parameters on them, inside 0 … 1.
fn found(face: FaceRecord, at: Parameters) -> Parameters {
    let uv = min(max(at.uv, vec2<f32>(0.0)), vec2<f32>(1.0));
    if (at.span.x != SEARCHED) {
        return Parameters(at.span, uv);
    }
    let k = find_span(face.table_u, face.spans_u, uv.x);
    let l = find_span(face.table_v, face.spans_v, uv.y);
    let span_u = span_of(face.table_u, face.spans_u, degree(face.degree_u), k);
    let span_v = span_of(face.table_v, face.spans_v, degree(face.degree_v), l);
    return Parameters(vec2<u32>(k, l), vec2<f32>(local(span_u, uv.x), local(span_v, uv.y)));
}

fn fragment(face_id: u32, given: Parameters) -> Fragment {
    let face = faces[face_id];
    let p = degree(face.degree_u);
    let q = degree(face.degree_v);
    let at = found(face, given);
    let span_u = span_of(face.table_u, face.spans_u, p, at.span.x);
    let span_v = span_of(face.table_v, face.spans_v, q, at.span.y);
    var nu = basis(span_u.knots, p, at.uv.x, span_u.gain, CURVATURE);
    var nv = basis(span_v.knots, q, at.uv.y, span_v.gain, CURVATURE);
    let d = surface(face, p, q, vec2<u32>(span_u.first, span_v.first), &nu, &nv, CURVATURE);
    var n = cross(d.su, d.sv);
    let n_squared = dot(n, n);
    let su_squared = dot(d.su, d.su);
    let sv_squared = dot(d.sv, d.sv);
    var out: Fragment;
    out.uv = at.uv;
    out.span = at.span;
    out.whole = vec2<f32>(whole(span_u, at.uv.x), whole(span_v, at.uv.y));
    out.position = d.s;
    out.su = d.su * span_u.per_whole;
    out.sv = d.sv * span_v.per_whole;
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

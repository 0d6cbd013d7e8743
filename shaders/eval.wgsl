// Evaluation of a face: span, basis, surface. Twin of crates/pipeline/src/eval.rs.
// Uses layout.wgsl

const PARALLEL: f32 = 1.0 / 1048576.0;
const COLLAPSED: f32 = 1.0 / 1048576.0;

struct Basis {
    value: array<f32, CAPACITY>,
    first: array<f32, CAPACITY>,
    second: array<f32, CAPACITY>,
}

struct Derivatives {
    s: vec3<f32>,
    su: vec3<f32>,
    sv: vec3<f32>,
    suu: vec3<f32>,
    suv: vec3<f32>,
    svv: vec3<f32>,
}

struct Span {
    start: f32,
    first: u32,
    length: f32,
    gain: f32,
    per_whole: f32,
    // Index of the first of its knots.
    knots: u32,
}

fn span_of(table: u32, spans: u32, p: u32, k: u32) -> Span {
    let record = table + spans + 1u + k * (SPAN_HEAD + 2u * p);
    return Span(
        knots[table + k],
        u32(knots[record]),
        knots[record + 1u],
        knots[record + 2u],
        knots[record + 3u],
        record + SPAN_HEAD,
    );
}

fn whole(span: Span, t: f32) -> f32 {
    return span.start + span.length * t;
}

fn local(span: Span, t: f32) -> f32 {
    return clamp((t - span.start) / span.length, 0.0, 1.0);
}

fn find_span(table: u32, spans: u32, t: f32) -> u32 {
    var low = 0u;
    var high = spans;
    while (high - low > 1u) {
        let middle = (low + high) / 2u;
        if (t < knots[table + middle]) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return low;
}

fn differences(term: ptr<function, array<f32, CAPACITY>>, p: u32, gain: f32) -> array<f32, CAPACITY> {
    var d: array<f32, CAPACITY>;
    let scale = f32(p) * gain;
    d[0] = -(*term)[0] * scale;
    for (var r = 1u; r < p; r++) {
        d[r] = ((*term)[r - 1u] - (*term)[r]) * scale;
    }
    d[p] = (*term)[p - 1u] * scale;
    return d;
}

fn basis(first_knot: u32, p: u32, t: f32, gain: f32, second: bool) -> Basis {
    var b: Basis;
    var term: array<f32, CAPACITY>;
    var reciprocal: array<f32, CAPACITY>;
    b.value[0] = 1.0;
    for (var j = 1u; j <= p; j++) {
        var saved = 0.0;
        for (var r = 0u; r < j; r++) {
            let right = knots[first_knot + p + r];
            let left = knots[first_knot + p + r - j];
            reciprocal[r] = 1.0 / (right - left);
            term[r] = b.value[r] * reciprocal[r];
            b.value[r] = saved + (right - t) * term[r];
            saved = (t - left) * term[r];
        }
        b.value[j] = saved;
        if (second && j + 1u == p) {
            b.second = differences(&term, j, gain);
        }
    }
    b.first = differences(&term, p, gain);
    if (second) {
        for (var r = 0u; r < p; r++) {
            term[r] = b.second[r] * reciprocal[r];
        }
        b.second = differences(&term, p, gain);
    }
    return b;
}

fn surface(face: FaceRecord, p: u32, q: u32, first: vec2<u32>, nu: ptr<function, Basis>, nv: ptr<function, Basis>, second: bool) -> Derivatives {
    var a = vec4<f32>();
    var a_u = vec4<f32>();
    var a_v = vec4<f32>();
    var a_uu = vec4<f32>();
    var a_uv = vec4<f32>();
    var a_vv = vec4<f32>();
    for (var i = 0u; i <= p; i++) {
        let start = face.points + (first.x + i) * face.count_v + first.y;
        var row = vec4<f32>();
        var row_v = vec4<f32>();
        var row_vv = vec4<f32>();
        for (var j = 0u; j <= q; j++) {
            let point = points[start + j];
            row = row + (*nv).value[j] * point;
            row_v = row_v + (*nv).first[j] * point;
            if (second) {
                row_vv = row_vv + (*nv).second[j] * point;
            }
        }
        a = a + (*nu).value[i] * row;
        a_u = a_u + (*nu).first[i] * row;
        a_v = a_v + (*nu).value[i] * row_v;
        if (second) {
            a_uu = a_uu + (*nu).second[i] * row;
            a_uv = a_uv + (*nu).first[i] * row_v;
            a_vv = a_vv + (*nu).value[i] * row_vv;
        }
    }
    var d = Derivatives(a.xyz, a_u.xyz, a_v.xyz, a_uu.xyz, a_uv.xyz, a_vv.xyz);
    if ((face.flags & RATIONAL) != 0u) {
        let w = 1.0 / a.w;
        d.s = d.s * w;
        d.su = (d.su - d.s * a_u.w) * w;
        d.sv = (d.sv - d.s * a_v.w) * w;
        if (second) {
            d.suu = (d.suu - d.su * (2.0 * a_u.w) - d.s * a_uu.w) * w;
            d.suv = (d.suv - d.sv * a_u.w - d.su * a_v.w - d.s * a_uv.w) * w;
            d.svv = (d.svv - d.sv * (2.0 * a_v.w) - d.s * a_vv.w) * w;
        }
    }
    return d;
}

fn is_regular(n_squared: f32, su_squared: f32, sv_squared: f32) -> bool {
    return su_squared > COLLAPSED * COLLAPSED
        && sv_squared > COLLAPSED * COLLAPSED
        && n_squared > PARALLEL * PARALLEL * (su_squared * sv_squared);
}

fn curvature(d: Derivatives, n: vec3<f32>, su_squared: f32) -> vec2<f32> {
    let length = sqrt(su_squared);
    let e1 = d.su / length;
    let e2 = cross(n, e1);
    let g = dot(d.sv, e2);
    let shear = dot(d.sv, e1) / length;
    let l = dot(d.suu, n);
    let m = dot(d.suv, n);
    let nn = dot(d.svv, n);
    let a = l / su_squared;
    let b = (m - shear * l) / (length * g);
    let c = (nn - (shear + shear) * m + shear * shear * l) / (g * g);
    let mean = (a + c) * 0.5;
    let x = (a - c) * 0.5;
    let half = sqrt(x * x + b * b);
    return vec2<f32>(mean + half, mean - half);
}

fn view_direction(eye: vec4<f32>, s: vec3<f32>) -> vec3<f32> {
    if (eye.w == 0.0) {
        return eye.xyz;
    }
    let d = s - eye.xyz;
    let length = sqrt(dot(d, d));
    return d / length;
}

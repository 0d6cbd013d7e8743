// Entry points of technique `fragment`. The vertex stage places a triangle's corners; the fragment stage runs the
// program at the interpolated (u, v).

struct VertexInput {
    @location(0) position: vec3<f32>,
    @location(1) uv: vec2<f32>,
    @location(2) face: u32,
    @location(3) normal: vec3<f32>,
}

struct VertexOutput {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(perspective) uv: vec2<f32>,
    @location(1) @interpolate(flat) face: u32,
    @location(2) @interpolate(perspective) normal: vec3<f32>,
    @location(3) @interpolate(perspective) local: vec3<f32>,
}

@vertex
fn vertex(in: VertexInput) -> VertexOutput {
    let m = views[in.face].clip_from_local;
    var out: VertexOutput;
    out.clip = m[0] * in.position.x + m[1] * in.position.y + m[2] * in.position.z + m[3];
    out.uv = in.uv;
    out.face = in.face;
    out.normal = in.normal;
    out.local = in.position;
    return out;
}

// The program at the interpolated (u, v), or on a skirt where the ray meets the surface; what lies behind is seen where the
// face does not cover the pixel.
fn shown(in: VertexOutput) -> Fragment {
    if (!TRIMMED) {
        return fragment(in.face, in.uv);
    }
    let s = sight(views[in.face], in.clip.xy);
    let on_skirt = any(in.uv != clamp(in.uv, vec2<f32>(0.0), vec2<f32>(1.0)));
    var out: Fragment;
    var at: Footprint;
    var uv = in.uv;
    for (var k = 0u; k <= STEPS; k++) {
        let f = fragment(in.face, uv);
        if (k == 0u || on_skirt) {
            out = f;
        }
        if (k == STEPS || at.settled) {
            break;
        }
        at = footprint(s, f.uv, f.position, f.su, f.sv);
        uv = at.center;
        if (at.lost || (at.settled && !on_skirt)) {
            break;
        }
    }
    if ((on_skirt && !at.settled) || !is_shown(faces[in.face], at)) {
        discard;
    }
    return out;
}

@fragment
fn fragment_gbuffer(in: VertexOutput) -> GBufferOutput {
    let f = shown(in);
    return gbuffer_output(in.face, f, in.clip.xy);
}

@fragment
fn fragment_shaded(in: VertexOutput) -> @location(0) vec4<f32> {
    let f = shown(in);
    var normal = f.normal;
    if (INTERPOLATED_NORMAL) {
        normal = in.normal / sqrt(dot(in.normal, in.normal));
    }
    // The flat triangle's point is on the pixel's ray; S is off it by the chord.
    return shaded_output(in.face, f, normal, in.local);
}

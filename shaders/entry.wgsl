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

// A fragment without material leaves the pixel to what lies behind it.
fn cut(face: u32, uv: vec2<f32>) {
    if (TRIMMED && !is_material(faces[face], clamp(uv, vec2<f32>(0.0), vec2<f32>(1.0)))) {
        discard;
    }
}

@fragment
fn fragment_gbuffer(in: VertexOutput) -> GBufferOutput {
    cut(in.face, in.uv);
    let f = fragment(in.face, in.uv);
    return gbuffer_output(in.face, f, in.clip.xy);
}

@fragment
fn fragment_shaded(in: VertexOutput) -> @location(0) vec4<f32> {
    cut(in.face, in.uv);
    let f = fragment(in.face, in.uv);
    var normal = f.normal;
    if (INTERPOLATED_NORMAL) {
        normal = in.normal / sqrt(dot(in.normal, in.normal));
    }
    // The flat triangle's point is on the pixel's ray; S is off it by the chord.
    return shaded_output(in.face, f, normal, in.local);
}

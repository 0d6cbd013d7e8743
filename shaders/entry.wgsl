// Entry points. The vertex stage places a proxy's corners; the fragment stage runs the program.

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

// Four targets of 16 bytes. All-zero means that nothing was drawn: the face is stored plus one.
struct GBufferOutput {
    @location(0) identity: vec4<u32>, // face + 1, status, span in u, span in v
    @location(1) position: vec4<f32>, // S in local coordinates, u
    @location(2) normal: vec4<f32>,   // unit normal, v
    @location(3) shape: vec4<f32>,    // k1, k2 in local units, |S_u|, |S_v|
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

@fragment
fn fragment_gbuffer(in: VertexOutput) -> GBufferOutput {
    let f = fragment(in.face, in.uv);
    return GBufferOutput(
        vec4<u32>(in.face + 1u, f.status, f.span),
        vec4<f32>(f.position, f.uv.x),
        vec4<f32>(f.normal, f.uv.y),
        vec4<f32>(f.curvature, f.speed),
    );
}

@fragment
fn fragment_shaded(in: VertexOutput) -> @location(0) vec4<f32> {
    let f = fragment(in.face, in.uv);
    let view = views[in.face];
    var s: ShadeInput;
    s.normal = f.normal;
    s.status = f.status;
    if (INTERPOLATED_NORMAL) {
        s.normal = in.normal / sqrt(dot(in.normal, in.normal));
    }
    // The flat triangle's point is on the pixel's ray; S is off it by the chord.
    s.view = view_direction(view.eye, in.local);
    s.uv01 = f.uv;
    s.face = in.face;
    s.curved = select(0u, 1u, CURVATURE && f.status == REGULAR);
    s.k1 = f.curvature.x * view.curvature.x;
    s.k2 = f.curvature.y * view.curvature.x;
    return vec4<f32>(shade(shading, s), 1.0);
}

// The fragment stage of techniques by triangles: the hardware finds who is seen.
// Uses triangles.wgsl output.wgsl

struct VertexOutput {
    // Faces that share a corner are drawn by programs of their own, and it must be at one place.
    @builtin(position) @invariant clip: vec4<f32>,
    @location(0) @interpolate(perspective) uv: vec2<f32>,
    @location(1) @interpolate(flat) face: u32,
    @location(2) @interpolate(perspective) normal: vec3<f32>,
    @location(3) @interpolate(perspective) local: vec3<f32>,
    @location(4) @interpolate(flat) span: vec2<u32>,
}

fn sample_of(in: VertexOutput) -> Sample {
    return Sample(in.face, Parameters(in.span, in.uv), in.clip.xy, in.normal, in.local);
}

@fragment
fn fragment_gbuffer(in: VertexOutput) -> GBufferOutput {
    let out = recorded(sample_of(in));
    if (!out.is_drawn) {
        discard;
    }
    return gbuffer_output(in.face, out.f, in.clip.xy);
}

@fragment
fn fragment_shaded(in: VertexOutput) -> @location(0) vec4<f32> {
    let out = coloured(sample_of(in));
    if (!out.is_drawn) {
        discard;
    }
    // The flat triangle's point is on the pixel's ray; S is off it by the chord.
    return shaded_output(in.face, out.f, in.local);
}

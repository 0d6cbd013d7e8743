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

// Skirts are drawn by entry points of their own, since they have the depth of the place that they show: a stage that writes depths
// culls nothing early.
struct SkirtGBufferOutput {
    @location(0) identity: vec4<u32>,
    @location(1) position: vec4<f32>,
    @location(2) normal: vec4<f32>,
    @location(3) shape: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

struct SkirtShadedOutput {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment_gbuffer(in: VertexOutput) -> GBufferOutput {
    let sample = sample_of(in);
    var out: Shown;
    if (!is_of_skirt(sample)) {
        out = recorded(sample, false);
    }
    if (!out.is_drawn) {
        discard;
    }
    return gbuffer_output(in.face, out.f, in.clip.xy);
}

@fragment
fn skirt_gbuffer(in: VertexOutput) -> SkirtGBufferOutput {
    let sample = sample_of(in);
    var out: Shown;
    if (is_of_skirt(sample)) {
        out = recorded(sample, true);
    }
    if (!out.is_drawn) {
        discard;
    }
    let g = gbuffer_output(in.face, out.f, in.clip.xy);
    return SkirtGBufferOutput(g.identity, g.position, g.normal, g.shape, skirt_depth(out, in.clip.z));
}

@fragment
fn fragment_shaded(in: VertexOutput) -> @location(0) vec4<f32> {
    let sample = sample_of(in);
    var out: Shown;
    if (!is_of_skirt(sample)) {
        out = coloured(sample, false);
    }
    if (!out.is_drawn) {
        discard;
    }
    // The flat triangle's point is on the pixel's ray; S is off it by the chord.
    return shaded_output(in.face, out.f, in.local);
}

@fragment
fn skirt_shaded(in: VertexOutput) -> SkirtShadedOutput {
    let sample = sample_of(in);
    var out: Shown;
    if (is_of_skirt(sample)) {
        out = coloured(sample, true);
    }
    if (!out.is_drawn) {
        discard;
    }
    return SkirtShadedOutput(shaded_output(in.face, out.f, in.local), skirt_depth(out, in.clip.z));
}

// The vertex stage of technique `fragment`: it places a triangle's corners.
// Uses layout.wgsl fragment.wgsl fragment_stage.wgsl

struct VertexInput {
    @location(0) position: vec3<f32>,
    @location(1) uv: vec2<f32>,
    @location(2) face: u32,
    @location(3) span: vec2<u32>,
    @location(4) normal: vec3<f32>,
    @location(5) frame: u32,
}

@vertex
fn vertex(in: VertexInput) -> VertexOutput {
    let m = views[in.frame].clip_from_local;
    var out: VertexOutput;
    out.clip = m[0] * in.position.x + m[1] * in.position.y + m[2] * in.position.z + m[3];
    out.uv = in.uv;
    out.face = in.face;
    out.span = in.span;
    out.normal = in.normal;
    out.local = in.position;
    // A corner that faces share has the coordinates of one of them.
    if (in.frame != in.face) {
        out.local = fragment(in.face, Parameters(in.span, in.uv)).position;
    }
    return out;
}

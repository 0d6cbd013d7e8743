// What is written of the fragment program's answer, whatever the technique.
// Uses layout.wgsl eval.wgsl fragment.wgsl edge.wgsl shade.wgsl

// Four targets of 16 bytes. All-zero means that nothing was drawn: the face is stored plus one.
struct GBufferOutput {
    @location(0) identity: vec4<u32>, // face + 1, status and edge (edge.wgsl), span in u, span in v
    @location(1) position: vec4<f32>, // S in local coordinates, u
    @location(2) normal: vec4<f32>,   // unit normal, v
    @location(3) shape: vec4<f32>,    // k1, k2 in local units, |S_u|, |S_v| as of `Fragment`
}

// The answer of a fragment of the pixel with its centre at `at`.
fn gbuffer_output(face: u32, f: Fragment, at: vec2<f32>) -> GBufferOutput {
    return GBufferOutput(
        vec4<u32>(face + 1u, f.status | edge(face, f.whole, at), f.span),
        vec4<f32>(f.position, f.uv.x),
        vec4<f32>(f.normal, f.uv.y),
        vec4<f32>(f.curvature, f.speed),
    );
}

// The colour of a fragment, seen at a local position.
fn shaded_output(face: u32, f: Fragment, local: vec3<f32>) -> vec4<f32> {
    let view = views[face];
    var s: ShadeInput;
    s.normal = f.normal;
    s.status = f.status;
    s.view = view_direction(view.eye, local);
    s.uv01 = f.whole;
    s.face = face;
    s.curved = select(0u, 1u, CURVATURE && f.status == REGULAR);
    s.k1 = f.curvature.x * view.units.x;
    s.k2 = f.curvature.y * view.units.x;
    return vec4<f32>(shade(shading, s), 1.0);
}

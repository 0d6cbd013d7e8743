// The fragment program at given parameters; where these are of the whole domain, whether there is material. Host: crates/gpu/src/probe.rs.
// Uses layout.wgsl fragment.wgsl trim.wgsl

struct ProbeQuery {
    uv: vec2<f32>,
    span: vec2<u32>,
    face: u32,
    padding: u32,
}

// Set in the status of an answer where the face has material.
const MATERIAL: u32 = 0x100u;

// The same four vectors as GBufferOutput, with MATERIAL in the status.
struct ProbeAnswer {
    identity: vec4<u32>,
    position: vec4<f32>,
    normal: vec4<f32>,
    shape: vec4<f32>,
}

@group(1) @binding(0) var<storage, read> probe_queries: array<ProbeQuery>;
@group(1) @binding(1) var<storage, read_write> probe_answers: array<ProbeAnswer>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if (index >= min(arrayLength(&probe_queries), arrayLength(&probe_answers))) {
        return;
    }
    let query = probe_queries[index];
    let f = fragment(query.face, Parameters(query.span, query.uv));
    let material = select(0u, MATERIAL, is_material(faces[query.face], query.uv));
    probe_answers[index] = ProbeAnswer(
        vec4<u32>(query.face + 1u, f.status | material, f.span),
        vec4<f32>(f.position, f.uv.x),
        vec4<f32>(f.normal, f.uv.y),
        vec4<f32>(f.curvature, f.speed),
    );
}

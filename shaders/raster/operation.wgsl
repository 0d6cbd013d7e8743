// One operation at given operands, for tests of a strict program's arithmetic. Host: crates/gpu/src/operation.rs, which writes
// `result` behind it.
// Uses raster/strict.wgsl

@group(0) @binding(0) var<storage, read> operands: array<vec2<f32>>;
// Bits of each result, and 1 beside one that was raised.
@group(0) @binding(1) var<storage, read_write> results: array<vec2<u32>>;

var<private> raised: u32;

fn raise_subnormal() {
    raised = 1u;
}

@compute @workgroup_size(64)
fn operate(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = id.y * groups.x * 64u + id.x;
    if (i < arrayLength(&operands)) {
        let bits = bitcast<u32>(result(operands[i].x, operands[i].y));
        results[i] = vec2<u32>(bits, raised);
    }
}

// Draws the atlas of masks as the CPU has it, texel by texel: strict programs take no coverage from an adapter. One triangle covers
// all. Host: crates/gpu/src/masks.rs.

// Four texels a word, row-major; 255 is material.
@group(0) @binding(0) var<storage, read> texels: array<u32>;

struct Extent {
    width: u32,
}

@group(0) @binding(1) var<uniform> extent: Extent;

@vertex
fn all_over(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    return vec4<f32>(4.0 * corner - 1.0, 0.0, 1.0);
}

@fragment
fn texel(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let index = u32(at.y) * extent.width + u32(at.x);
    let value = (texels[index / 4u] >> (8u * (index % 4u))) & 255u;
    return vec4<f32>(select(0.0, 1.0, value == 255u));
}

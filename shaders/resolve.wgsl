// What is seen becomes what is written, by compute kernels: once a pixel, whoever found it.
// Uses fragment.wgsl output.wgsl

// Side of the square of pixels that a workgroup resolves.
const TILE: u32 = 8u;

@group(2) @binding(0) var identity_target: texture_storage_2d<rgba32uint, write>;
@group(2) @binding(1) var position_target: texture_storage_2d<rgba32float, write>;
@group(2) @binding(2) var normal_target: texture_storage_2d<rgba32float, write>;
@group(2) @binding(3) var shape_target: texture_storage_2d<rgba32float, write>;
@group(2) @binding(4) var colour_target: texture_storage_2d<rgba8unorm, write>;

// What a pixel's G-buffer holds.
fn write_gbuffer(pixel: vec2<u32>, face: u32, f: Fragment) {
    let g = gbuffer_output(face, f, vec2<f32>(pixel) + 0.5);
    textureStore(identity_target, pixel, g.identity);
    textureStore(position_target, pixel, g.position);
    textureStore(normal_target, pixel, g.normal);
    textureStore(shape_target, pixel, g.shape);
}

// A pixel's colour, seen at a local position.
fn write_shaded(pixel: vec2<u32>, face: u32, f: Fragment, local: vec3<f32>) {
    textureStore(colour_target, pixel, shaded_output(face, f, local));
}

// A pixel that sees nothing.
fn clear_gbuffer(pixel: vec2<u32>, nothing: vec4<f32>) {
    textureStore(identity_target, pixel, vec4<u32>(0u));
    textureStore(position_target, pixel, nothing);
    textureStore(normal_target, pixel, nothing);
    textureStore(shape_target, pixel, nothing);
}

fn clear_shaded(pixel: vec2<u32>, nothing: vec4<f32>) {
    textureStore(colour_target, pixel, nothing);
}

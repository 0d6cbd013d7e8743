// How much each corner of a triangle counts at a pixel, by the areas that decide coverage.
// Uses raster/setup.wgsl

// In perspective, where the edges have these values.
fn weights_at(t: Flat, pixel: vec2<i32>, values: vec3<f32>) -> vec3<f32> {
    return values * t.share;
}

// How much each corner of a triangle counts at a pixel, by the areas that decide coverage.
// Uses raster/setup.wgsl

fn inverse_of(w: f32) -> f32 {
    return 1.0 / w;
}

// Shares of 1, in perspective, where the edges have these values.
fn weights_at(t: Flat, pixel: vec2<i32>, values: vec3<f32>) -> vec3<f32> {
    let w = vec3<f32>(t.corners[0].inverse_w, t.corners[1].inverse_w, t.corners[2].inverse_w);
    let weights = values * (w / max(max(w.x, w.y), w.z));
    return weights / (weights.x + weights.y + weights.z);
}

// The mean of what three corners carry, from the first one's on: equal ones give that exactly.
fn mixed(corners: vec3<f32>, weights: vec3<f32>) -> f32 {
    let a = corners.x;
    return a + (weights.y * (corners.y - a) + weights.z * (corners.z - a));
}

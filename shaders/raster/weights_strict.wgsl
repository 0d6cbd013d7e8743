// How much each corner of a triangle counts at a pixel, with the CPU rasterizer's bits. Twin of crates/raster/src/setup.rs.
// Uses raster/setup.wgsl raster/area.wgsl raster/subnormal.wgsl

// How far beyond an edge a triangle is extrapolated, as a share of its height over that edge.
const BEYOND: f32 = 1.0 / 64.0;

fn inverse_of(w: f32) -> f32 {
    return quotient(1.0, w);
}

// How much each corner counts where the edges have these values, in perspective: the areas that the sample of a covered pixel
// makes with the corners as they were before snapping, but those of the snapped triangle where that would be too far beyond it.
fn weights_at(t: Flat, pixel: vec2<i32>, values: vec3<f32>) -> vec3<f32> {
    let sample = vec2<f32>(pixel) + 0.5;
    let a = t.corners[0].position - sample;
    let b = t.corners[1].position - sample;
    let c = t.corners[2].position - sample;
    let areas = vec3<f32>(area_between(b, c), area_between(c, a), area_between(a, b));
    let w = vec3<f32>(t.corners[0].inverse_w, t.corners[1].inverse_w, t.corners[2].inverse_w);
    let share = w / max(max(w.x, w.y), w.z);
    let weights = select(areas, -areas, t.turned) * share;
    let sum = weights.x + weights.y + weights.z;
    if (sum > 0.0 && all(weights >= vec3<f32>(sum * -BEYOND))) {
        return weights;
    }
    return values * share;
}

// The weighted mean of what three corners carry, from the first one's on: equal ones give that exactly.
fn mixed(corners: vec3<f32>, weights: vec3<f32>) -> f32 {
    let sum = weights.x + weights.y + weights.z;
    let a = corners.x;
    return a + (weights.y * (corners.y - a) + weights.z * (corners.z - a)) / sum;
}

// Who is nearest at each pixel, by atomics of 32 bits: a first round finds the greatest order, a second one the triangle drawn
// first of those that have it. Host: crates/techniques/src/triangles/compute.rs; in one round: raster/nearest64.wgsl.
// `call` is that of raster/entry.wgsl, which uses this.

// Two for each pixel, row-major: the order, and the triangle's complement. Zero where nothing is drawn.
@group(1) @binding(2) var<storage, read_write> seen: array<atomic<u32>>;

fn offer(pixel: u32, order: u32, triangle: u32) {
    if (call.back == 0u) {
        atomicMax(&seen[2u * pixel], order);
    } else if (order == order_at(pixel)) {
        atomicMax(&seen[2u * pixel + 1u], ~triangle);
    }
}

// Whether an offer may still be the nearest.
fn is_wanted(pixel: u32, order: u32) -> bool {
    let greatest = order_at(pixel);
    return order == greatest || (call.back == 0u && order > greatest);
}

fn order_at(pixel: u32) -> u32 {
    return atomicLoad(&seen[2u * pixel]);
}

fn triangle_at(pixel: u32) -> u32 {
    return ~atomicLoad(&seen[2u * pixel + 1u]);
}

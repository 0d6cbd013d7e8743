// Who is nearest at each pixel, by atomics of 64 bits: the greater order, and of equal ones the triangle drawn first.
// Host: crates/techniques/src/triangles/compute.rs; the form for adapters without them: raster/nearest32.wgsl.

// Row-major. Zero where nothing is drawn.
@group(1) @binding(2) var<storage, read_write> seen: array<atomic<u64>>;

fn offer(pixel: u32, order: u32, triangle: u32) {
    atomicMax(&seen[pixel], (u64(order) << 32u) | u64(~triangle));
}

// Whether an offer may still be the nearest.
fn is_wanted(pixel: u32, order: u32) -> bool {
    return order >= order_at(pixel);
}

fn order_at(pixel: u32) -> u32 {
    return u32(atomicLoad(&seen[pixel]) >> 32u);
}

fn triangle_at(pixel: u32) -> u32 {
    return ~u32(atomicLoad(&seen[pixel]) & 0xfffffffflu);
}

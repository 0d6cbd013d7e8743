// Quads with one slanted edge each: how far it covers tells where the adapter has snapped the edge's end.
// Twin: `start` in crates/gpu/src/snapping.rs.

// Whether the quads stand one below another, and not side by side.
override IS_DOWN: bool = false;

// Pixels along a slanted edge, from the end that is asked about to the other.
const LENGTH: f32 = 4096.0;
// Pixels across from a quad to the next.
const PITCH: f32 = 4.0;
const QUADS: f32 = 64.0;

// Where the end of a quad's edge is, pixels from the quad's start: odd multiples of 2^-13 below a half.
fn start(quad: u32) -> f32 {
    return f32(2u * ((quad * 1237u) % 2048u) + 1u) / 8192.0;
}

@vertex
fn corner(@builtin(vertex_index) index: u32, @builtin(instance_index) quad: u32) -> @builtin(position) vec4<f32> {
    // Two triangles: the edge's ends and the far corner, then its first end and both far corners.
    let is_far = index == 2u || index > 3u;
    let is_end = index == 1u || index == 2u || index == 4u;
    let across = select(select(start(quad), 1.0, is_end), 3.0, is_far) + PITCH * f32(quad);
    let along = select(0.0, LENGTH, is_end);
    // All of it is exact in f32, and so is the way back to pixels.
    let a = across * (2.0 / (PITCH * QUADS)) - 1.0;
    let l = along * (2.0 / LENGTH) - 1.0;
    if (IS_DOWN) {
        return vec4<f32>(l, -a, 0.5, 1.0);
    }
    return vec4<f32>(a, -l, 0.5, 1.0);
}

@fragment
fn covered() -> @location(0) vec4<f32> {
    return vec4<f32>(1.0);
}

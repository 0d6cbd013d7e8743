// Whether a face has material at (u, v), by its mask in the atlas; stands in a program where trim.wgsl does otherwise.
// Twin of crates/pipeline/src/mask.rs.
// Uses layout.wgsl

@group(0) @binding(5) var atlas: texture_2d<f32>;

// An ellipse of parameters.
struct Reach {
    metric: vec3<f32>,
    extent: vec2<f32>,
}

// Of masks, only in the middle.
fn is_near_material(face: FaceRecord, uv: vec2<f32>, reach: Reach) -> bool {
    return is_material(face, uv);
}

fn is_material(face: FaceRecord, uv: vec2<f32>) -> bool {
    if (face.intervals == 0u) {
        return true;
    }
    let tile = face.trims;
    let low = vec2<f32>(knots[tile], knots[tile + 1u]);
    let high = vec2<f32>(knots[tile + 2u], knots[tile + 3u]);
    if (!(all(uv >= low) && all(uv <= high))) {
        return false;
    }
    let texels = vec2<f32>(knots[tile + 4u], knots[tile + 5u]);
    let corner = vec2<f32>(knots[tile + 6u], knots[tile + 7u]);
    let last = vec2<f32>(knots[tile + 8u], knots[tile + 9u]);
    let at = corner + min(floor((uv - low) * texels), last);
    return textureLoad(atlas, vec2<u32>(at), 0).x > 0.5;
}

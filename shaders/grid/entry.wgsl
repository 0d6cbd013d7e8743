// The vertex stage of technique `grid`: each instance is a bunch of tiles of Bézier patches' grids, each vertex a
// corner of their cells.
// Uses grid/corner.wgsl grid/tiles.wgsl fragment_stage.wgsl

// A draw call.
struct Drawn {
    number: u32,
    // Corners across a tile.
    across: u32,
    // Corners of a tile, and tiles of a bunch.
    corners: u32,
    bunch: u32,
}

@group(1) @binding(1) var<storage, read> tiles: array<Tile>;
@group(1) @binding(2) var<storage, read> drawn_calls: array<DrawCall>;
@group(1) @binding(3) var<uniform> drawn: Drawn;

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> VertexOutput {
    let number = instance * drawn.bunch + index / drawn.corners;
    if (number >= drawn_calls[drawn.number].tiles) {
        // The last bunch is not full: beyond the near plane, all of it at one point.
        var nowhere: VertexOutput;
        nowhere.clip = vec4<f32>(0.0, 0.0, 2.0, 1.0);
        return nowhere;
    }
    let tile = tiles[drawn_calls[drawn.number].start + number];
    let k = index % drawn.corners;
    let at = vec2<u32>(tile.at >> 16u, tile.at & 65535u) + vec2<u32>(k / drawn.across, k % drawn.across);
    return corner_at(tile.grid, at.x, at.y);
}

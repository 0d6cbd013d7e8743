// The vertex stage of technique `grid`: each instance is a tile of a Bézier patch's grid, each vertex a corner of its cells.
// Uses grid/corner.wgsl grid/tiles.wgsl triangles.wgsl

// A draw call.
struct Drawn {
    number: u32,
    // Corners across a tile.
    across: u32,
}

@group(1) @binding(1) var<storage, read> tiles: array<Tile>;
@group(1) @binding(2) var<storage, read> drawn_calls: array<DrawCall>;
@group(1) @binding(3) var<uniform> drawn: Drawn;

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> VertexOutput {
    let tile = tiles[drawn_calls[drawn.number].start + instance];
    let at = vec2<u32>(tile.at >> 16u, tile.at & 65535u) + vec2<u32>(index / drawn.across, index % drawn.across);
    return corner_at(tile.grid, at.x, at.y);
}

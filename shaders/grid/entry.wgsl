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
    return vertex_of(index, instance, false);
}

// Of tiles that may show skirts alone.
@vertex
fn skirt_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> VertexOutput {
    return vertex_of(index, instance, true);
}

fn vertex_of(index: u32, instance: u32, of_skirts: bool) -> VertexOutput {
    let number = instance * drawn.bunch + index / drawn.corners;
    if (number >= drawn_calls[drawn.number].tiles) {
        // The last bunch is not full.
        return nowhere();
    }
    let tile = tiles[drawn_calls[drawn.number].start + number];
    let first = vec2<u32>(tile.at >> 16u, tile.at & 65535u);
    if (of_skirts && !is_beside_skirt(tile.grid, first, 1u << GREATEST_SIDE)) {
        return nowhere();
    }
    let k = index % drawn.corners;
    let at = first + vec2<u32>(k / drawn.across, k % drawn.across);
    return corner_at(tile.grid, at.x, at.y);
}

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

// Of tiles of skirts alone.
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
    if (of_skirts && !is_skirt(tile)) {
        return nowhere();
    }
    let k = index % drawn.corners;
    let at = vec2<u32>(tile.at >> 16u, tile.at & 65535u) + vec2<u32>(k / drawn.across, k % drawn.across);
    return corner_at(tile.grid, at.x, at.y);
}

// Whether a tile is of a skirt, which is a row or a column of tiles of its own.
fn is_skirt(tile: Tile) -> bool {
    let sides = grids[tile.grid].sides;
    let at = vec2<u32>(tile.at >> 16u, tile.at & 65535u);
    let last = cells_of(tile.grid) - 1u;
    let low = (vec2<u32>(sides) & vec2<u32>(LOW_U, LOW_V)) != vec2<u32>(0u);
    let high = (vec2<u32>(sides) & vec2<u32>(2u * LOW_U, 2u * LOW_V)) != vec2<u32>(0u);
    return any((low & (at == vec2<u32>(0u))) | (high & (at == last)));
}

// Beyond the near plane, all of a tile at one point.
fn nowhere() -> VertexOutput {
    var out: VertexOutput;
    out.clip = vec4<f32>(0.0, 0.0, 2.0, 1.0);
    return out;
}

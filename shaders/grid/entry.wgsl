// The vertex stage of technique `grid`: each instance is a Bézier patch, each six vertices are a cell of its grid.
// Uses grid/corner.wgsl triangles.wgsl

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) grid: u32) -> VertexOutput {
    let columns = cells_of(grid).y;
    let cell = index / 6u;
    let at = vec2<u32>(cell / columns, cell % columns) + corner_of_cell(index % 6u);
    return corner_at(grid, at.x, at.y);
}

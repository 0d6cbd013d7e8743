// Technique `zones`: two kernels cut grids into zones of SIDE × SIDE cells and evaluate the corners of each zone, those on its
// borders too; the vertex stage takes them from there. Host: crates/techniques/src/zones/gpu.rs.
// Uses grid/corner.wgsl fragment_stage.wgsl

const SIDE: u32 = 4u;
const ACROSS: u32 = SIDE + 1u;
const WORKGROUP: u32 = 64u;

// The zones of one dispatch.
struct Step {
    first: u32,
    count: u32,
    number: u32,
    // How many grids there are in all.
    grids: u32,
}

struct MadeCorner {
    clip: vec4<f32>,
    uv: vec2<f32>,
    span: vec2<u32>,
    normal: vec3<f32>,
    face: u32,
    local: vec3<f32>,
    // Whether its zone may show a skirt.
    is_beside_skirt: u32,
}

// The number of each grid's first zone, and one more behind the last.
@group(1) @binding(1) var<storage, read> firsts: array<u32>;
// Of each zone of the step: its grid, its first row and column, and the number of the step.
@group(1) @binding(2) var<storage, read_write> zones: array<vec4<u32>>;
@group(1) @binding(3) var<storage, read_write> made: array<MadeCorner>;
@group(1) @binding(4) var<uniform> step_at: Step;
@group(2) @binding(0) var<storage, read> corners: array<MadeCorner>;

@compute @workgroup_size(WORKGROUP)
fn find_zones(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= step_at.count) {
        return;
    }
    let zone = step_at.first + id.x;
    var low = 0u;
    var high = step_at.grids;
    while (high - low > 1u) {
        let middle = (low + high) / 2u;
        if (zone < firsts[middle]) {
            high = middle;
        } else {
            low = middle;
        }
    }
    let columns = (cells_of(low).y + SIDE - 1u) / SIDE;
    let k = zone - firsts[low];
    zones[id.x] = vec4<u32>(low, k / columns * SIDE, k % columns * SIDE, step_at.number);
}

// A workgroup a zone, a thread a corner. A zone at the end of a grid has fewer cells: the rest have no area.
@compute @workgroup_size(WORKGROUP)
fn tessellate(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) k: u32) {
    if (group.x >= step_at.count || k >= ACROSS * ACROSS) {
        return;
    }
    let zone = zones[group.x];
    let at = min(zone.yz + vec2<u32>(k / ACROSS, k % ACROSS), cells_of(zone.x));
    let v = corner_at(zone.x, at.x, at.y);
    let is_beside = select(0u, 1u, is_beside_skirt(zone.x, zone.yz, SIDE));
    made[group.x * ACROSS * ACROSS + k] = MadeCorner(v.clip, v.uv, v.span, v.normal, v.face, v.local, is_beside);
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) zone: u32) -> VertexOutput {
    return vertex_of(index, zone);
}

// Of zones that may show skirts alone.
@vertex
fn skirt_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) zone: u32) -> VertexOutput {
    if (corners[zone * ACROSS * ACROSS].is_beside_skirt == 0u) {
        return nowhere();
    }
    return vertex_of(index, zone);
}

fn vertex_of(index: u32, zone: u32) -> VertexOutput {
    let cell = index / 6u;
    let at = vec2<u32>(cell / SIDE, cell % SIDE) + corner_of_cell(index % 6u);
    let v = corners[(zone * ACROSS + at.x) * ACROSS + at.y];
    var out: VertexOutput;
    out.clip = v.clip;
    out.uv = v.uv;
    out.face = v.face;
    out.normal = v.normal;
    out.local = v.local;
    out.span = v.span;
    return out;
}

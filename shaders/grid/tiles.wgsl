// Grids in tiles of at most 8 × 8 cells, and a draw call for those of each program and size. Twin of
// crates/techniques/src/grid/tiles.rs; host: crates/techniques/src/grid/gpu.rs.
// Uses grid/corner.wgsl grid/levels.wgsl

const GREATEST_SIDE: u32 = 3u;
const SIDES: u32 = GREATEST_SIDE + 1u;
const SIZES: u32 = SIDES * SIDES;
const SCANNERS: u32 = 256u;
const EACH: u32 = 4u;
const BUNCH_CORNERS: u32 = 128u;

struct Band {
    start: u32,
    length: u32,
    side: u32,
}

struct Tile {
    grid: u32,
    // Its first row and column there, 16 bits each.
    at: u32,
}

struct DrawCall {
    indices: u32,
    instances: u32,
    first_index: u32,
    base_vertex: u32,
    first_instance: u32,
    // Where its tiles start.
    start: u32,
    // The grids of its program.
    first_grid: u32,
    end_grid: u32,
    // How many they are; an instance is a bunch of them.
    tiles: u32,
}

// Of each size and grid how many tiles there are, and then how many before them; all of them; sums of blocks.
@group(2) @binding(3) var<storage, read_write> counts: array<u32>;
@group(2) @binding(4) var<storage, read_write> calls: array<DrawCall>;
@group(2) @binding(5) var<storage, read_write> placed: array<Tile>;

var<workgroup> scans: array<u32, SCANNERS>;

fn has_side(grid: u32, side: u32) -> u32 {
    return select(0u, 1u, (settled[grid].sides & (LOW_U << side)) != 0u);
}

// The low skirt, the patch and the high skirt along u or v.
fn bands(grid: u32, k: u32) -> array<Band, 3> {
    let low = has_side(grid, 2u * k);
    let length = 1u << settled[grid].level[k];
    let side = min(settled[grid].level[k], GREATEST_SIDE);
    let high = has_side(grid, 2u * k + 1u);
    return array<Band, 3>(Band(0u, low, 0u), Band(low, length, side), Band(low + length, high, 0u));
}

// Corners of a tile of a size.
fn corners_of(size: u32) -> u32 {
    return ((1u << (size / SIDES)) + 1u) * ((1u << (size % SIDES)) + 1u);
}

// Where a grid has the tile of a size that has a number.
fn tile_at(grid: u32, size: u32, number: u32) -> vec2<u32> {
    var before = 0u;
    var rows = bands(grid, 0u);
    var columns = bands(grid, 1u);
    for (var pair = 0u; pair < 9u; pair++) {
        let row = rows[pair / 3u];
        let column = columns[pair % 3u];
        if (row.side * SIDES + column.side != size) {
            continue;
        }
        let across = column.length >> column.side;
        let count = (row.length >> row.side) * across;
        if (number - before < count) {
            let k = number - before;
            return vec2<u32>(row.start + ((k / across) << row.side), column.start + ((k % across) << column.side));
        }
        before += count;
    }
    return vec2<u32>(0u);
}

@compute @workgroup_size(WORKGROUP)
fn count_tiles(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= asked.grids) {
        return;
    }
    settle(id.x);
    var own: array<u32, SIZES>;
    if (settled[id.x].sides != OUT) {
        var rows = bands(id.x, 0u);
        var columns = bands(id.x, 1u);
        for (var pair = 0u; pair < 9u; pair++) {
            let row = rows[pair / 3u];
            let column = columns[pair % 3u];
            own[row.side * SIDES + column.side] += (row.length >> row.side) * (column.length >> column.side);
        }
    }
    for (var size = 0u; size < SIZES; size++) {
        counts[size * asked.grids + id.x] = own[size];
    }
}

// The sum of what the threads before have; `scans` holds the sums up to each.
fn sum_before(k: u32, own: u32) -> u32 {
    scans[k] = own;
    workgroupBarrier();
    for (var step = 1u; step < SCANNERS; step *= 2u) {
        var before = 0u;
        if (k >= step) {
            before = scans[k - step];
        }
        workgroupBarrier();
        scans[k] += before;
        workgroupBarrier();
    }
    return scans[k] - own;
}

fn count_at(k: u32) -> u32 {
    if (k >= SIZES * asked.grids) {
        return 0u;
    }
    return counts[k];
}

fn own_counts(first: u32) -> u32 {
    var own = 0u;
    for (var k = 0u; k < EACH; k++) {
        own += count_at(first + k);
    }
    return own;
}

@compute @workgroup_size(SCANNERS)
fn sum_blocks(@builtin(workgroup_id) block: vec3<u32>, @builtin(local_invocation_index) k: u32) {
    sum_before(k, own_counts((block.x * SCANNERS + k) * EACH));
    if (k == 0u) {
        counts[SIZES * asked.grids + 1u + block.x] = scans[SCANNERS - 1u];
    }
}

// One workgroup: each block's sum becomes that of the blocks before it, and all of them are added up.
@compute @workgroup_size(SCANNERS)
fn scan_blocks(@builtin(local_invocation_index) k: u32) {
    let total = SIZES * asked.grids;
    let blocks = (total + SCANNERS * EACH - 1u) / (SCANNERS * EACH);
    var carried = 0u;
    for (var first = 0u; first < blocks; first += SCANNERS) {
        let block = first + k;
        var own = 0u;
        if (block < blocks) {
            own = counts[total + 1u + block];
        }
        let before = carried + sum_before(k, own);
        if (block < blocks) {
            counts[total + 1u + block] = before;
        }
        carried += scans[SCANNERS - 1u];
        workgroupBarrier();
    }
    if (k == 0u) {
        counts[total] = carried;
    }
}

@compute @workgroup_size(SCANNERS)
fn scan_counts(@builtin(workgroup_id) block: vec3<u32>, @builtin(local_invocation_index) k: u32) {
    let first = (block.x * SCANNERS + k) * EACH;
    let total = SIZES * asked.grids;
    var before = counts[total + 1u + block.x] + sum_before(k, own_counts(first));
    for (var i = first; i < min(first + EACH, total); i++) {
        let own = counts[i];
        counts[i] = before;
        before += own;
    }
}

// Says where the tiles of each draw call start, and how many they are.
@compute @workgroup_size(WORKGROUP)
fn fill_calls(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= asked.draws) {
        return;
    }
    let row = id.x % SIZES * asked.grids;
    let start = min(counts[row + calls[id.x].first_grid], asked.capacity);
    calls[id.x].start = start;
    let tiles = min(counts[row + calls[id.x].end_grid], asked.capacity) - start;
    let bunch = max(BUNCH_CORNERS / corners_of(id.x % SIZES), 1u);
    calls[id.x].tiles = tiles;
    calls[id.x].instances = (tiles + bunch - 1u) / bunch;
}

// A thread a tile.
@compute @workgroup_size(WORKGROUP)
fn place_tiles(@builtin(global_invocation_id) id: vec3<u32>) {
    let total = SIZES * asked.grids;
    if (id.x >= min(counts[total], asked.capacity)) {
        return;
    }
    // The last that has no more tiles before it.
    var low = 0u;
    var high = total;
    while (high - low > 1u) {
        let middle = (low + high) / 2u;
        if (counts[middle] <= id.x) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let grid = low % asked.grids;
    let at = tile_at(grid, low / asked.grids, id.x - counts[low]);
    placed[id.x] = Tile(grid, (at.x << 16u) | at.y);
}

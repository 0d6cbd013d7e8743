// How fine each grid is in the picture. Twin of crates/techniques/src/grid/levels.rs, which chooses the same levels, to the bit.
// Uses layout.wgsl grid/corner.wgsl

const GREATEST_LEVEL: u32 = 11u;
const WIDE: f32 = 1.0625;
const ROUNDING: f32 = 9.5367431640625e-7;
const NEAREST_SHARE: f32 = 0.0625;
const SKIRT_PX: f32 = 0.0625;
const OUT: u32 = 16u;
const WORKGROUP: u32 = 64u;

struct Measure {
    center: vec3<f32>,
    diagonal: f32,
    half: vec3<f32>,
    skirts: u32,
    bend: vec3<f32>,
    floor: u32,
    groups: vec4<u32>,
}

struct Asked {
    error_px: f32,
    most: u32,
    // How many grids there are.
    grids: u32,
    // How many tiles there is room for.
    capacity: u32,
    // How many draw calls there are.
    draws: u32,
    // 0, which no compiler knows.
    zero: u32,
    // 1 / error_px.
    per_error: f32,
}

@group(2) @binding(0) var<storage, read_write> settled: array<GridRecord>;
@group(2) @binding(1) var<storage, read> measures: array<Measure>;
// Of each group of borders the greatest level, then of each face the bits of the most that a pixel measures on it.
@group(2) @binding(2) var<storage, read_write> marks: array<atomic<u32>>;
@group(2) @binding(6) var<uniform> asked: Asked;

// A value that no compiler can fuse with what follows: WGSL rounds + and × as IEEE does, but allows it to leave roundings out. As
// `kept` of raster/strict.wgsl.
fn rounded(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) | asked.zero);
}

fn product(a: f32, b: f32) -> f32 {
    return rounded(a * b);
}

fn sum(a: f32, b: f32) -> f32 {
    return rounded(a + b);
}

// a · b, term by term.
fn in_order(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return sum(sum(product(a.x, b.x), product(a.y, b.y)), product(a.z, b.z));
}

// The least and the greatest of n · p + d in a patch's box, for a plane (n, d).
fn range(plane: vec4<f32>, grid: u32) -> vec2<f32> {
    let center = measures[grid].center;
    let middle = sum(in_order(plane.xyz, center), plane.w);
    let spread = in_order(abs(plane.xyz), measures[grid].half);
    let size = sum(in_order(abs(plane.xyz), abs(center)), abs(plane.w));
    let reach = sum(spread, product(ROUNDING, sum(size, spread)));
    return vec2<f32>(sum(middle, -reach), sum(middle, reach));
}

fn row(m: mat4x4<f32>, k: u32) -> vec4<f32> {
    return vec4<f32>(m[0][k], m[1][k], m[2][k], m[3][k]);
}

fn plus(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(sum(a.x, b.x), sum(a.y, b.y), sum(a.z, b.z), sum(a.w, b.w));
}

// 2^-k.
fn power(k: u32) -> f32 {
    return bitcast<f32>((127u - k) << 23u);
}

fn chord(bend: vec3<f32>, level: vec2<u32>) -> f32 {
    let powers = vec3<f32>(power(2u * level.x), power(level.x + level.y), power(2u * level.y));
    return in_order(bend, powers);
}

fn level_of(bend: vec3<f32>, allowed: f32, floor: vec2<u32>) -> vec2<u32> {
    var level = floor;
    while (chord(bend, level) > allowed && min(level.x, level.y) < asked.most) {
        let finer_u = chord(bend, level + vec2<u32>(1u, 0u));
        let finer_v = chord(bend, level + vec2<u32>(0u, 1u));
        if (level.x == asked.most || (level.y < asked.most && finer_v < finer_u)) {
            level.y += 1u;
        } else {
            level.x += 1u;
        }
    }
    return level;
}

// What each patch alone asks for.
@compute @workgroup_size(WORKGROUP)
fn choose(@builtin(global_invocation_id) id: vec3<u32>) {
    let grid = id.x;
    if (grid >= asked.grids) {
        return;
    }
    let face = settled[grid].face;
    let m = views[face].clip_from_local;
    let x = row(m, 0u);
    let y = row(m, 1u);
    let w = row(m, 3u);
    let wide = vec4<f32>(product(WIDE, w.x), product(WIDE, w.y), product(WIDE, w.z), product(WIDE, w.w));
    let planes = array<vec4<f32>, 5>(plus(wide, -x), plus(wide, x), plus(wide, -y), plus(wide, y), plus(w, -row(m, 2u)));
    settled[grid].sides = 0u;
    for (var k = 0u; k < 5u; k++) {
        if (!(range(planes[k], grid).y >= 0.0)) {
            settled[grid].sides = OUT;
            return;
        }
    }
    let forward = max(max(abs(w.x), abs(w.y)), abs(w.z));
    let away = product(product(NEAREST_SHARE, measures[grid].diagonal), forward);
    var pixel = product(views[face].units.w, max(range(w, grid).x, away));
    let allowed = product(asked.error_px, pixel);
    let floor = vec2<u32>(measures[grid].floor & 65535u, measures[grid].floor >> 16u);
    let level = level_of(measures[grid].bend, allowed, floor);
    // Where the greatest level leaves more, skirts are as wide.
    let off = chord(measures[grid].bend, level);
    let widened = product(off, asked.per_error);
    if (off > allowed && widened <= GREATEST) {
        pixel = widened;
    }
    settled[grid].level = level;
    let groups = measures[grid].groups;
    atomicMax(&marks[groups.x], level.y);
    atomicMax(&marks[groups.y], level.y);
    atomicMax(&marks[groups.z], level.x);
    atomicMax(&marks[groups.w], level.x);
    atomicMax(&marks[4u * asked.grids + face], bitcast<u32>(pixel));
}

// The greater level of each border, and of each patch that of its borders.
fn settle(grid: u32) {
    if (settled[grid].sides == OUT) {
        return;
    }
    let groups = measures[grid].groups;
    var levels: array<u32, 4>;
    for (var side = 0u; side < 4u; side++) {
        levels[side] = atomicLoad(&marks[groups[side]]);
        settled[grid].borders[side].level = levels[side];
    }
    let level = max(settled[grid].level, vec2<u32>(max(levels[2], levels[3]), max(levels[0], levels[1])));
    settled[grid].level = level;
    var sides = 0u;
    for (var side = 0u; side < 4u; side++) {
        if (level[side / 2u] < ((measures[grid].skirts >> (8u * side)) & 255u)) {
            sides |= LOW_U << side;
        }
    }
    settled[grid].sides = sides;
    let pixel = bitcast<f32>(atomicLoad(&marks[4u * asked.grids + settled[grid].face]));
    settled[grid].skirt = product(sum(asked.error_px, SKIRT_PX), pixel);
}

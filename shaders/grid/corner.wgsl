// A corner of a patch's grid. Twin of crates/techniques/src/grid/corner.rs.
// Uses layout.wgsl fragment.wgsl fragment_stage.wgsl

const LOW_U: u32 = 1u;
const LOW_V: u32 = 4u;
const BEYOND: f32 = 1.0 / 65536.0;
const STEEPEST: f32 = 0.0625;

struct CornerRecord {
    face: u32,
    padding: u32,
    span: vec2<u32>,
    uv: vec2<f32>,
}

struct BorderRecord {
    face: u32,
    level: u32,
    span: vec2<u32>,
    start: vec2<f32>,
    end: vec2<f32>,
}

struct GridRecord {
    face: u32,
    sides: u32,
    span: vec2<u32>,
    level: vec2<u32>,
    start: vec2<f32>,
    size: vec2<f32>,
    skirt: f32,
    padding: u32,
    borders: array<BorderRecord, 4>,
    corners: array<CornerRecord, 4>,
}

@group(1) @binding(0) var<storage, read> grids: array<GridRecord>;

// A line of a grid: its parameter, and to which side of the patch it lies beyond it.
struct Line {
    t: f32,
    side: f32,
}

// Where a corner of a grid is evaluated.
struct Site {
    face: u32,
    place: Parameters,
}

fn line(index: u32, level: u32, has_skirt: bool) -> Line {
    let cells = 1i << level;
    let i = i32(index) - select(0i, 1i, has_skirt);
    let side = select(select(0.0, 1.0, i > cells), -1.0, i < 0);
    return Line(f32(clamp(i, 0i, cells)) / f32(cells), side);
}

// Cells along u and along v, those of skirts too.
fn cells_of(grid: u32) -> vec2<u32> {
    let sides = grids[grid].sides;
    return (vec2<u32>(1u) << grids[grid].level) + countOneBits(vec2<u32>(sides & (3u * LOW_U), sides & (3u * LOW_V)));
}

// Whether a square of cells, the first of them and how many along each side, is of a skirt or beside one: interpolation may leave the face
// for the skirt by a rounding error.
fn is_beside_skirt(grid: u32, first: vec2<u32>, count: u32) -> bool {
    let sides = vec2<u32>(grids[grid].sides);
    let low = (sides & vec2<u32>(LOW_U, LOW_V)) != vec2<u32>(0u);
    let high = (sides & vec2<u32>(2u * LOW_U, 2u * LOW_V)) != vec2<u32>(0u);
    return any((low & (first <= vec2<u32>(1u))) | (high & (first + count + 1u >= cells_of(grid))));
}

// Beyond the near plane: triangles whose corners are all there have no pixels.
fn nowhere() -> VertexOutput {
    var out: VertexOutput;
    out.clip = vec4<f32>(0.0, 0.0, 2.0, 1.0);
    return out;
}

// The corner in a row, which is along v, and a column of a grid.
fn corner_at(grid: u32, row: u32, column: u32) -> VertexOutput {
    let sides = grids[grid].sides;
    let level = grids[grid].level;
    return corner(grid, line(row, level.x, (sides & LOW_U) != 0u), line(column, level.y, (sides & LOW_V) != 0u));
}

// a, b, c and a, c, d: a is a cell's first corner, b is beside it along u, c across, d along v.
fn corner_of_cell(k: u32) -> vec2<u32> {
    return vec2<u32>(select(0u, 1u, k == 1u || k == 2u || k == 4u), select(0u, 1u, k == 2u || k == 4u || k == 5u));
}

fn snapped(t: f32, level: u32) -> f32 {
    let cells = f32(1u << level);
    return floor(t * cells) / cells;
}

fn corner(grid: u32, u: Line, v: Line) -> VertexOutput {
    let face = grids[grid].face;
    let span = grids[grid].span;
    var t = vec2<f32>(u.t, v.t);
    let on_border = (t == vec2<f32>(0.0)) | (t == vec2<f32>(1.0));
    // Where all faces evaluate it that share it.
    var site = Site(face, Parameters(span, grids[grid].start + grids[grid].size * t));
    if (u.side == 0.0 && v.side == 0.0) {
        if (all(on_border)) {
            let at = grids[grid].corners[2u * u32(u.t) + u32(v.t)];
            site = Site(at.face, Parameters(at.span, at.uv));
        } else if (any(on_border)) {
            let along = select(0u, 1u, on_border.x);
            let border = grids[grid].borders[select(2u + u32(v.t), u32(u.t), on_border.x)];
            t[along] = snapped(t[along], border.level);
            let place = border.start + t[along] * (border.end - border.start);
            site = Site(border.face, Parameters(border.span, place));
        }
    }
    let uv = grids[grid].start + grids[grid].size * t;
    let sites = array<Site, 2>(Site(face, Parameters(span, uv)), site);
    // Its own evaluation, where another one gives the position, is for normals and for what is in another face's coordinates.
    let is_shared = u.side == 0.0 && v.side == 0.0 && any(on_border);
    let first = select(0u, 1u, is_shared && site.face == face && !VERTEX_NORMALS);
    let last = select(0u, 1u, is_shared);
    var own: Fragment;
    var seam: Fragment;
    // A loop, so that the program stands there once.
    for (var k = first; k <= last; k++) {
        seam = fragment(sites[k].face, sites[k].place);
        if (k == first) {
            own = seam;
        }
    }
    let sight = views[face].eye.xyz - own.position * views[face].eye.w;
    let ways = way(sight, own.sv, own.su, u.side) + way(sight, own.su, own.sv, v.side);
    var out: VertexOutput;
    out.local = own.position + grids[grid].skirt * ways;
    out.uv = uv + BEYOND * vec2<f32>(u.side, v.side);
    out.face = face;
    out.span = span;
    out.normal = own.normal;
    var position = seam.position;
    if (u.side != 0.0 || v.side != 0.0) {
        position = out.local;
    }
    let m = views[site.face].clip_from_local;
    out.clip = m[0] * position.x + m[1] * position.y + m[2] * position.z + m[3];
    return out;
}

// The way from a border, as it is seen along `sight`, straight away from its tangent `along`; to the side to which `out` times
// `side` leads. Zero from a collapsed border, and from one that is seen end-on.
// In depth it goes as the surface goes on the way in, up to where that is seen under STEEPEST.
fn way(sight_given: vec3<f32>, along_given: vec3<f32>, out: vec3<f32>, side: f32) -> vec3<f32> {
    let sight = unit(sight_given);
    let along = unit(along_given);
    let across = unit(cross(sight, along));
    if (side == 0.0 || all(across == vec3<f32>(0.0))) {
        return vec3<f32>(0.0);
    }
    let towards = select(1.0, -1.0, side * dot(across, out) < 0.0);
    let straight = unit(side * (out - along * dot(out, along)));
    let depth = dot(straight, sight) / max(towards * dot(straight, across), STEEPEST);
    return towards * across - sight * depth;
}

fn unit(a: vec3<f32>) -> vec3<f32> {
    let length = sqrt(dot(a, a));
    return select(vec3<f32>(0.0), a / length, length > 0.0);
}

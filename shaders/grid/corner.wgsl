// A corner of a patch's grid. Twin of crates/techniques/src/grid/corner.rs.
// Uses layout.wgsl fragment.wgsl fragment_stage.wgsl

const LOW_U: u32 = 1u;
const LOW_V: u32 = 4u;
const SLANT: f32 = 4.0;

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
    let record = faces[face];
    let su = own.su * span_of(record.table_u, record.spans_u, degree(record.degree_u), span.x).length;
    let sv = own.sv * span_of(record.table_v, record.spans_v, degree(record.degree_v), span.y).length;
    let beyond = vec2<f32>(u.side, v.side) * reach(grids[grid].skirt, su, sv);
    var out: VertexOutput;
    out.local = own.position + su * beyond.x + sv * beyond.y;
    out.uv = uv + beyond;
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

// What u and v gain on the way straight away from a border by the skirt's width.
fn reach(width: f32, su: vec3<f32>, sv: vec3<f32>) -> vec2<f32> {
    let n = cross(su, sv);
    let area = sqrt(dot(n, n));
    let speed_u = sqrt(dot(su, su));
    let speed_v = sqrt(dot(sv, sv));
    return vec2<f32>(gain(width, speed_u, speed_v, area), gain(width, speed_v, speed_u, area));
}

// The border, whose tangent is `along`, may be come to at a slant; from a collapsed one nothing goes on.
fn gain(width: f32, speed: f32, along: f32, area: f32) -> f32 {
    if (area == 0.0) {
        return 0.0;
    }
    return min(width * along / area, SLANT * width / speed);
}

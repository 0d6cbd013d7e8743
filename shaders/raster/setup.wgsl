// Triangle setup: snapped corners, edge functions for coverage, depth, and what interpolation takes. Twin of
// crates/raster/src/{vertex,setup}.rs: what decides coverage and depth has the same bits.
// Uses layout.wgsl raster/strict.wgsl

const SUBPIXEL_ONE: f32 = 256.0;
const PIXEL: i32 = 256;
const HALF_PIXEL: i32 = 128;
// Where no corner of a triangle is farther from another than this along an axis, edge functions fit 32 bits.
const NARROW: i32 = 16640;
// More than what rounding moves the end of a row by: a quotient of up to 2^14 columns, to 2^-21 of itself.
const ROUNDING_PX: f32 = 1.0 / 16.0;

struct Corner {
    // Pixels from the top left corner.
    position: vec2<f32>,
    // Snapped: in 1/256 of a pixel.
    at: vec2<i32>,
    // z / w.
    depth: f32,
    // 0 where the corner is outside the clip volume or the guard band.
    inverse_w: f32,
}

// A triangle in the picture.
struct Flat {
    corners: array<Corner, 3>,
    // The edges opposite to its corners, with the triangle on their positive side: where each starts, and how far it goes.
    edges: array<vec4<i32>, 3>,
    // The least values of the edges that count as covered: 0 on a top or a left edge, else 1.
    least: vec3<i32>,
    // Whether corners run counterclockwise, y down.
    turned: bool,
    is_narrow: bool,
    // The pixels whose centres are in its box: the first, and one beyond the last.
    first: vec2<i32>,
    end: vec2<i32>,
    // How depth grows with the values of the edges opposite to the second and the third corner.
    scale: f32,
    gain: vec2<f32>,
    // Its area.
    pixels: f32,
    // Whether it has any area and any pixel.
    is_seen: bool,
}

// Clip coordinates of a local position.
fn clip_position(view: View, position: vec3<f32>) -> vec4<f32> {
    let rows = transpose(view.clip_from_local);
    return vec4<f32>(
        row_times(rows[0], position),
        row_times(rows[1], position),
        row_times(rows[2], position),
        row_times(rows[3], position),
    );
}

fn row_times(row: vec4<f32>, position: vec3<f32>) -> f32 {
    let xy = sum(product(row.x, position.x), product(row.y, position.y));
    return sum(sum(xy, product(row.z, position.z)), row.w);
}

// The division by w and the map to the picture.
fn corner_of(clip: vec4<f32>, half: vec2<f32>) -> Corner {
    if (!(clip.w > 0.0)) {
        return Corner();
    }
    let x = sum(half.x, product(half.x, quotient(clip.x, clip.w)));
    let y = difference(half.y, product(half.y, quotient(clip.y, clip.w)));
    return corner_at(vec2<f32>(x, y), quotient(clip.z, clip.w), inverse_of(clip.w));
}

fn corner_at(position: vec2<f32>, depth: f32, inverse_w: f32) -> Corner {
    return Corner(position, vec2<i32>(round(position * SUBPIXEL_ONE)), depth, inverse_w);
}

fn set_up(corners: array<Corner, 3>, size: vec2<i32>) -> Flat {
    var t: Flat;
    t.corners = corners;
    let low = min(min(corners[0].at, corners[1].at), corners[2].at);
    let high = max(max(corners[0].at, corners[1].at), corners[2].at);
    t.is_narrow = all(high - low <= vec2<i32>(NARROW));
    t.first = max((low - HALF_PIXEL + PIXEL - 1) >> vec2<u32>(8u), vec2<i32>(0));
    t.end = min(((high - HALF_PIXEL) >> vec2<u32>(8u)) + 1, size);
    if (any(t.first >= t.end)) {
        return t;
    }
    let b = corners[1].at - corners[0].at;
    let c = corners[2].at - corners[0].at;
    var area = wide_difference(wide_product(b.x, c.y), wide_product(b.y, c.x));
    t.turned = area.high < 0;
    if (t.turned) {
        area = wide_difference(Wide(0, 0u), area);
    }
    t.is_seen = area.high != 0 || area.low != 0u;
    if (t.is_seen) {
        t.edges[0] = edge_between(corners[1].at, corners[2].at, t.turned);
        t.edges[1] = edge_between(corners[2].at, corners[0].at, t.turned);
        t.edges[2] = edge_between(corners[0].at, corners[1].at, t.turned);
        t.least = vec3<i32>(least_of(t.edges[0].zw), least_of(t.edges[1].zw), least_of(t.edges[2].zw));
        let whole = rounded(area);
        t.pixels = whole * (0.5 / (SUBPIXEL_ONE * SUBPIXEL_ONE));
        // Biased exponents e and 254 − e belong to powers of two whose product is 1.
        t.scale = bitcast<f32>((254u - (bitcast<u32>(whole) >> 23u)) << 23u);
        let scaled = whole * t.scale;
        let first = corners[0].depth;
        t.gain = vec2<f32>(
            quotient(difference(corners[1].depth, first), scaled),
            quotient(difference(corners[2].depth, first), scaled),
        );
    }
    return t;
}

fn edge_between(start: vec2<i32>, end: vec2<i32>, is_turned: bool) -> vec4<i32> {
    let first = select(start, end, is_turned);
    return vec4<i32>(first, select(end, start, is_turned) - first);
}

// The least value of an edge that counts as covered: 0 on a top or a left edge, else 1.
fn least_of(delta: vec2<i32>) -> i32 {
    return select(1, 0, delta.y < 0 || (delta.y == 0 && delta.x > 0));
}

// The value of an edge at a pixel's centre, from 0 or 1 on where the pixel may be covered.
fn edge_at(edge: vec4<i32>, is_narrow: bool, pixel: vec2<i32>) -> Wide {
    let d = pixel * PIXEL + HALF_PIXEL - edge.xy;
    if (is_narrow) {
        let narrow = edge.z * d.y - edge.w * d.x;
        return Wide(narrow >> 31u, u32(narrow));
    }
    return wide_difference(wide_product(edge.z, d.y), wide_product(edge.w, d.x));
}

// The columns of a row that may be covered: the first, and one beyond the last. Those between are decided exactly.
fn columns_of(t: Flat, y: i32) -> vec2<i32> {
    var columns = vec2<f32>(0.0, f32(t.end.x - t.first.x));
    columns = columns_within(columns, t, t.edges[0], y);
    columns = columns_within(columns, t, t.edges[1], y);
    columns = columns_within(columns, t, t.edges[2], y);
    return t.first.x + vec2<i32>(i32(ceil(columns.x)), i32(floor(max(columns.y, 0.0))));
}

// Those of them, counted from the triangle's first, that may be within an edge, too.
fn columns_within(columns: vec2<f32>, t: Flat, edge: vec4<i32>, y: i32) -> vec2<f32> {
    let value = approximate(edge_at(edge, t.is_narrow, vec2<i32>(t.first.x, y)));
    let step = -f32(edge.w) * f32(PIXEL);
    if (step > 0.0) {
        return vec2<f32>(max(columns.x, -value / step - ROUNDING_PX), columns.y);
    }
    if (step < 0.0) {
        return vec2<f32>(columns.x, min(columns.y, value / -step + 1.0 + ROUNDING_PX));
    }
    return vec2<f32>(columns.x, select(columns.y, 0.0, value < 0.0));
}

// What the edges say of a pixel's centre.
struct Values {
    covered: bool,
    // The edges' values, each rounded once.
    rounded: vec3<f32>,
}

fn values_at(t: Flat, pixel: vec2<i32>) -> Values {
    let x = edge_at(t.edges[0], t.is_narrow, pixel);
    let y = edge_at(t.edges[1], t.is_narrow, pixel);
    let z = edge_at(t.edges[2], t.is_narrow, pixel);
    if (is_below(x, t.least.x) || is_below(y, t.least.y) || is_below(z, t.least.z)) {
        return Values();
    }
    return Values(true, vec3<f32>(rounded(x), rounded(y), rounded(z)));
}

fn is_below(value: Wide, least: i32) -> bool {
    return value.high < 0 || (value.high == 0 && value.low < u32(least));
}

// z / w at a pixel's centre that it covers, never beyond the corners' own.
fn depth_at(t: Flat, values: vec3<f32>) -> f32 {
    let gained = sum(product(values.y * t.scale, t.gain.x), product(values.z * t.scale, t.gain.y));
    let depth = sum(t.corners[0].depth, gained);
    let a = t.corners[0].depth;
    let b = t.corners[1].depth;
    let c = t.corners[2].depth;
    return clamp(depth, min(min(a, b), c), max(max(a, b), c));
}

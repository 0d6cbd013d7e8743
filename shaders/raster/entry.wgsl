// Triangles without a rasterizer: compute kernels place corners, find who covers each pixel, and run the program there once. They
// run in the order in which they stand here. Host: crates/techniques/src/triangles/compute.rs.
// Uses layout.wgsl fragment.wgsl triangles.wgsl resolve.wgsl raster/setup.wgsl raster/weights.wgsl raster/clip.wgsl raster/nearest.wgsl

const WORKGROUP: u32 = 64u;
// Rows of a triangle, and pixels of its area, that one thread goes through at most.
const SMALL_ROWS: i32 = 24;
const SMALL_AREA: f32 = 48.0;
// Threads that share a row of a triangle that is not small.
const ALONG: u32 = 8u;
// Words of a question: pixel, order, triangle, (u, v).
const QUESTION: u32 = 5u;
// Words of a vertex: position, (u, v), face, spans, normal, and the face whose coordinates the position has.
const VERTEX: u32 = 12u;

// A fault, for tests of the comparer.
override FARTHEST: bool = false;

// The triangles of one program.
struct Call {
    first: u32,
    count: u32,
    width: u32,
    height: u32,
    // Where the indices start in `mesh`, and how many vertices there are before them.
    indices: u32,
    vertices: u32,
    // Where the counts of large triangles, of cut ones and of questions stand in `queue`, and where the triangles' numbers start.
    counts: u32,
    waiting: u32,
    // Whether the call is that which clears pixels that see nothing, and to what.
    clears: u32,
    // Where questions start, and how many there is room for.
    questions: u32,
    room: u32,
    // Where there are two rounds, in the second one how many words before its counts those of the first stand; else 0.
    back: u32,
    nothing: vec4<f32>,
}

// Vertices, then three indices a triangle.
@group(1) @binding(0) var<storage, read> mesh: array<u32>;
// A vertex: x and y in the picture, depth, 1 / w.
@group(1) @binding(1) var<storage, read_write> corners: array<vec4<f32>>;
// Whether a subnormal number was met; then counts; then triangles that wait, large ones from the front on, cut ones from the back;
// then questions that wait.
@group(1) @binding(3) var<storage, read_write> queue: array<atomic<u32>>;
@group(1) @binding(4) var<uniform> call: Call;

// The place of a thread among all of a dispatch that may be more than one row of workgroups.
fn place_of(id: vec3<u32>, groups: vec3<u32>) -> u32 {
    return id.y * groups.x * WORKGROUP + id.x;
}

fn number_of(vertex: u32, word: u32) -> f32 {
    return bitcast<f32>(mesh[vertex * VERTEX + word]);
}

fn position_of(vertex: u32) -> vec3<f32> {
    return vec3<f32>(number_of(vertex, 0u), number_of(vertex, 1u), number_of(vertex, 2u));
}

fn clip_of(vertex: u32) -> vec4<f32> {
    return clip_position(views[mesh[vertex * VERTEX + 11u]], position_of(vertex));
}

fn half_size() -> vec2<f32> {
    return vec2<f32>(f32(call.width), f32(call.height)) * 0.5;
}

fn vertices_of(triangle: u32) -> vec3<u32> {
    let at = call.indices + 3u * triangle;
    return vec3<u32>(mesh[at], mesh[at + 1u], mesh[at + 2u]);
}

// A thread a vertex.
@compute @workgroup_size(WORKGROUP)
fn place_corners(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let vertex = place_of(id, groups);
    if (vertex >= call.vertices) {
        return;
    }
    let clip = clip_of(vertex);
    var corner: Corner;
    if (is_inside(clip)) {
        corner = corner_of(clip, half_size());
    }
    corners[vertex] = vec4<f32>(corner.position, corner.depth, corner.inverse_w);
}

fn corners_of(vertices: vec3<u32>) -> array<Corner, 3> {
    var placed: array<Corner, 3>;
    for (var i = 0u; i < 3u; i++) {
        let c = corners[vertices[i]];
        placed[i] = corner_at(c.xy, c.z, c.w);
    }
    return placed;
}

// Whether a triangle must be cut before it is drawn.
fn is_cut(placed: array<Corner, 3>) -> bool {
    return placed[0].inverse_w == 0.0 || placed[1].inverse_w == 0.0 || placed[2].inverse_w == 0.0;
}

fn size_in_pixels() -> vec2<i32> {
    return vec2<i32>(i32(call.width), i32(call.height));
}

// A thread a triangle: the small ones are drawn, and all others wait.
@compute @workgroup_size(WORKGROUP)
fn cover_small(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = place_of(id, groups);
    if (index >= call.count) {
        return;
    }
    let triangle = call.first + index;
    let placed = corners_of(vertices_of(triangle));
    if (is_cut(placed)) {
        let slot = atomicAdd(&queue[call.counts + 1u], 1u);
        atomicStore(&queue[call.waiting + call.count - 1u - slot], triangle);
        return;
    }
    let t = set_up(placed, size_in_pixels());
    if (!t.is_seen) {
        return;
    }
    if (!t.is_narrow || t.end.y - t.first.y > SMALL_ROWS || t.pixels > SMALL_AREA) {
        let slot = atomicAdd(&queue[call.counts], 1u);
        atomicStore(&queue[call.waiting + slot], triangle);
        return;
    }
    let piece = whole_piece(t, triangle);
    for (var y = t.first.y; y < t.end.y; y++) {
        let columns = columns_of(t, y);
        for (var x = columns.x; x < columns.y; x++) {
            cover(piece, triangle, vec2<i32>(x, y));
        }
    }
}

// However many large triangles there are, they share the workgroups.
@compute @workgroup_size(WORKGROUP)
fn cover_large(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let count = atomicLoad(&queue[call.counts]);
    if (count == 0u) {
        return;
    }
    let shares = max(groups.x / count, 1u);
    for (var i = group.x; i < count * shares; i += groups.x) {
        let triangle = atomicLoad(&queue[call.waiting + i / shares]);
        let t = set_up(corners_of(vertices_of(triangle)), size_in_pixels());
        cover_shared(whole_piece(t, triangle), triangle, (i % shares) * WORKGROUP + lane, shares * WORKGROUP);
    }
}

// The same of triangles that reach beyond the clip volume or the guard band, piece by piece.
@compute @workgroup_size(WORKGROUP)
fn cover_cut(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let count = atomicLoad(&queue[call.counts + 1u]);
    if (count == 0u) {
        return;
    }
    let shares = max(groups.x / count, 1u);
    for (var i = group.x; i < count * shares; i += groups.x) {
        let triangle = atomicLoad(&queue[call.waiting + call.count - 1u - i / shares]);
        let polygon = polygon_of(triangle);
        for (var k = 2u; k < polygon.count; k++) {
            let piece = piece_of(polygon, k, triangle);
            if (piece.t.is_seen) {
                cover_shared(piece, triangle, (i % shares) * WORKGROUP + lane, shares * WORKGROUP);
            }
        }
    }
}

// The part of thread `k` of `threads`: every so many rows, and there every ALONG-th pixel.
fn cover_shared(piece: Piece, triangle: u32, k: u32, threads: u32) {
    let t = piece.t;
    for (var y = t.first.y + i32(k / ALONG); y < t.end.y; y += i32(threads / ALONG)) {
        let columns = columns_of(t, y);
        for (var x = columns.x + i32(k % ALONG); x < columns.y; x += i32(ALONG)) {
            cover(piece, triangle, vec2<i32>(x, y));
        }
    }
}

// A triangle, or a part of a cut one: then also what each of its corners carries of the whole one's, and its own u and v.
struct Piece {
    t: Flat,
    // Whether the triangle may have samples on a skirt.
    of_skirt: bool,
    is_part: bool,
    u: vec3<f32>,
    v: vec3<f32>,
    share: mat3x3<f32>,
}

fn whole_piece(t: Flat, triangle: u32) -> Piece {
    return Piece(t, reaches_skirt(triangle), false, vec3<f32>(), vec3<f32>(), mat3x3<f32>());
}

// Whether a triangle is of a skirt or touches the border before one, from where interpolation may step onto it by a rounding error.
fn reaches_skirt(triangle: u32) -> bool {
    if (!is_asked(triangle)) {
        return false;
    }
    let corners = vertices_of(triangle);
    var reaches = false;
    for (var i = 0u; i < 3u; i++) {
        let corner = corners[i];
        let face = faces[face_of(corner)];
        let uv = vec2<f32>(number_of(corner, 3u), number_of(corner, 4u));
        let span = span_at(corner);
        let is_low = (uv <= vec2<f32>(0.0)) & (span == vec2<u32>(0u));
        let is_high = (uv >= vec2<f32>(1.0)) & (span + 1u == vec2<u32>(face.spans_u, face.spans_v));
        reaches = reaches || any(is_low | is_high);
    }
    return reaches;
}

fn polygon_of(triangle: u32) -> Polygon {
    let vertices = vertices_of(triangle);
    var corners: array<ClipVertex, 3>;
    for (var i = 0u; i < 3u; i++) {
        let vertex = vertices[i];
        let uv = vec2<f32>(number_of(vertex, 3u), number_of(vertex, 4u));
        corners[i] = ClipVertex(clip_of(vertex), uv, vec3<f32>(vec3<u32>(i) == vec3<u32>(0u, 1u, 2u)));
    }
    return clipped(corners);
}

// Of the fan of pieces, the one that ends with corner k.
fn piece_of(polygon: Polygon, k: u32, triangle: u32) -> Piece {
    var polygon_at = polygon;
    var placed: array<Corner, 3>;
    var piece: Piece;
    piece.of_skirt = reaches_skirt(triangle);
    piece.is_part = true;
    for (var i = 0u; i < 3u; i++) {
        let corner = polygon_at.corners[select(k - 2u + i, 0u, i == 0u)];
        placed[i] = corner_of(corner.clip, half_size());
        piece.u[i] = corner.uv.x;
        piece.v[i] = corner.uv.y;
        piece.share[i] = corner.share;
    }
    if (!is_cut(placed)) {
        piece.t = set_up(placed, size_in_pixels());
    }
    return piece;
}

// What a triangle has to say about a pixel.
struct Offer {
    // Whether it covers the pixel's centre, and may be the nearest there.
    is_open: bool,
    pixel: u32,
    // By the triangle's depth; on a skirt that of what is shown decides.
    order: u32,
    // Whether its face must be asked if it is there, and then what it shows.
    is_asked: bool,
    on_skirt: bool,
    in: Sample,
}

fn offer_of(piece: Piece, triangle: u32, pixel: vec2<i32>) -> Offer {
    var made: Offer;
    let values = values_at(piece.t, pixel);
    if (values.covered) {
        made.order = order_of(depth_at(piece.t, values.rounded));
        made.pixel = u32(pixel.y) * call.width + u32(pixel.x);
        made.is_open = made.order != 0u && is_wanted(made.pixel, made.order);
        made.is_asked = is_asked(triangle);
        if (made.is_asked && (made.is_open || piece.of_skirt)) {
            made.in = sample_of(piece, triangle, weights_at(piece.t, pixel, values.rounded), pixel);
            made.on_skirt = is_of_skirt(made.in);
            made.is_open = made.is_open || made.on_skirt;
        }
    }
    return made;
}

// Whether the face of a triangle must be asked at each pixel if it is there.
fn is_asked(triangle: u32) -> bool {
    return TRIMMED && (faces[face_of(vertices_of(triangle).x)].flags & BOUNDED) != 0u;
}

// Offers a triangle to a pixel if it covers its centre. The question if its face is there waits until all are known, so that every
// thread has as many as any other.
fn cover(piece: Piece, triangle: u32, pixel: vec2<i32>) {
    let made = offer_of(piece, triangle, pixel);
    if (!made.is_open) {
        return;
    }
    if (!made.is_asked) {
        offer(made.pixel, made.order, triangle);
        return;
    }
    let slot = atomicAdd(&queue[call.counts + 2u], 1u);
    if (slot < call.room) {
        let at = call.questions + slot * QUESTION;
        atomicStore(&queue[at], made.pixel);
        atomicStore(&queue[at + 1u], made.order);
        atomicStore(&queue[at + 2u], triangle);
        atomicStore(&queue[at + 3u], bitcast<u32>(made.in.given.uv.x));
        atomicStore(&queue[at + 4u], bitcast<u32>(made.in.given.uv.y));
    }
}

// However many questions there are, they share the threads.
@compute @workgroup_size(WORKGROUP)
fn answer(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let count = atomicLoad(&queue[call.counts + 2u]);
    if (finds_no_room()) {
        return;
    }
    for (var i = id.x; i < count; i += groups.x * WORKGROUP) {
        let at = call.questions + i * QUESTION;
        let pixel = atomicLoad(&queue[at]);
        let order = atomicLoad(&queue[at + 1u]);
        let triangle = atomicLoad(&queue[at + 2u]);
        let vertex = vertices_of(triangle).x;
        let uv = vec2<f32>(bitcast<f32>(atomicLoad(&queue[at + 3u])), bitcast<f32>(atomicLoad(&queue[at + 4u])));
        var in: Sample;
        in.face = face_of(vertex);
        in.given = Parameters(span_at(vertex), uv);
        in.at = vec2<f32>(vec2<u32>(pixel % call.width, pixel / call.width)) + 0.5;
        let on_skirt = is_of_skirt(in);
        if (on_skirt || is_wanted(pixel, order)) {
            decide(Offer(true, pixel, order, true, on_skirt, in), triangle);
        }
    }
}

// Offers a triangle to a pixel where its face is there; on a skirt by the depth of what is shown, as `skirt_depth` of triangles.wgsl.
fn decide(made: Offer, triangle: u32) {
    let seen = shown(made.in, made.on_skirt);
    if (seen.is_drawn) {
        let own = order_of(seen.depth);
        let of_skirt = select(own, min(own, made.order), seen.is_beyond);
        offer(made.pixel, select(made.order, of_skirt, made.on_skirt), triangle);
    }
}

// Whether questions were lost: in both rounds as in the first one, since another kernel's answers may differ in a last digit.
fn finds_no_room() -> bool {
    return atomicLoad(&queue[call.counts - call.back + 2u]) > call.room;
}

// Where some questions found no room, all are answered where they arise.
@compute @workgroup_size(WORKGROUP)
fn answer_rest(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    if (!finds_no_room()) {
        return;
    }
    for (var i = group.x; i < call.count; i += groups.x) {
        let triangle = call.first + i;
        if (!is_asked(triangle)) {
            continue;
        }
        let placed = corners_of(vertices_of(triangle));
        if (!is_cut(placed)) {
            answer_all(whole_piece(set_up(placed, size_in_pixels()), triangle), triangle, lane);
            continue;
        }
        let polygon = polygon_of(triangle);
        for (var k = 2u; k < polygon.count; k++) {
            answer_all(piece_of(polygon, k, triangle), triangle, lane);
        }
    }
}

// The part of a workgroup's thread.
fn answer_all(piece: Piece, triangle: u32, lane: u32) {
    let t = piece.t;
    if (!t.is_seen) {
        return;
    }
    for (var y = t.first.y + i32(lane / ALONG); y < t.end.y; y += i32(WORKGROUP / ALONG)) {
        let columns = columns_of(t, y);
        for (var x = columns.x + i32(lane % ALONG); x < columns.y; x += i32(ALONG)) {
            let made = offer_of(piece, triangle, vec2<i32>(x, y));
            if (made.is_open) {
                decide(made, triangle);
            }
        }
    }
}

fn face_of(vertex: u32) -> u32 {
    return mesh[vertex * VERTEX + 5u];
}

fn span_at(vertex: u32) -> vec2<u32> {
    return vec2<u32>(mesh[vertex * VERTEX + 6u], mesh[vertex * VERTEX + 7u]);
}

// Greater is nearer. The bits of floats from 0 to 1 stand in their order; 0 is the depth of a cleared picture.
fn order_of(depth: f32) -> u32 {
    let bits = bitcast<u32>(depth) & 0x7fffffffu;
    return select(bits, select(~bits, 0u, bits == 0u), FARTHEST);
}

fn sample_of(piece: Piece, triangle: u32, weights: vec3<f32>, pixel: vec2<i32>) -> Sample {
    let corners = vertices_of(triangle);
    var u = piece.u;
    var v = piece.v;
    var of_whole = weights;
    if (piece.is_part) {
        of_whole = piece.share[0] * weights.x + piece.share[1] * weights.y + piece.share[2] * weights.z;
    } else {
        u = numbers_of(corners, 3u);
        v = numbers_of(corners, 4u);
    }
    var in: Sample;
    in.face = face_of(corners.x);
    in.given = Parameters(span_at(corners.x), vec2<f32>(mixed(u, weights), mixed(v, weights)));
    in.at = vec2<f32>(pixel) + 0.5;
    if (VERTEX_NORMALS) {
        in.normal = carried_at(corners, 8u, of_whole);
    }
    in.local = carried_at(corners, 0u, of_whole);
    return in;
}

// A number that each of three vertices carries.
fn numbers_of(vertices: vec3<u32>, word: u32) -> vec3<f32> {
    return vec3<f32>(number_of(vertices.x, word), number_of(vertices.y, word), number_of(vertices.z, word));
}

fn carried_at(vertices: vec3<u32>, word: u32, weights: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(
        mixed(numbers_of(vertices, word), weights),
        mixed(numbers_of(vertices, word + 1u), weights),
        mixed(numbers_of(vertices, word + 2u), weights),
    );
}

// What a pixel sees, if that is of this call.
struct Seen {
    is_there: bool,
    // Nothing is seen, and it is this call that says so.
    is_cleared: bool,
    in: Sample,
}

fn seen_at(at: vec2<u32>) -> Seen {
    var found: Seen;
    if (at.x >= call.width || at.y >= call.height) {
        return found;
    }
    let index = at.y * call.width + at.x;
    if (order_at(index) == 0u) {
        found.is_cleared = call.clears != 0u;
        return found;
    }
    let triangle = triangle_at(index);
    // A triangle before the first wraps around to one far behind the last.
    if (triangle - call.first >= call.count) {
        return found;
    }
    let pixel = vec2<i32>(at);
    let placed = corners_of(vertices_of(triangle));
    found.is_there = true;
    if (!is_cut(placed)) {
        found.in = sample_at(whole_piece(set_up(placed, size_in_pixels()), triangle), triangle, pixel);
        return found;
    }
    let polygon = polygon_of(triangle);
    for (var k = 2u; k < polygon.count; k++) {
        let piece = piece_of(polygon, k, triangle);
        let values = values_at(piece.t, pixel);
        if (piece.t.is_seen && values.covered) {
            let in = sample_at(piece, triangle, pixel);
            if (is_of_skirt(in) || order_of(depth_at(piece.t, values.rounded)) == order_at(index)) {
                found.in = in;
                break;
            }
        }
    }
    return found;
}

// What a piece shows at a pixel that it covers.
fn sample_at(piece: Piece, triangle: u32, pixel: vec2<i32>) -> Sample {
    return sample_of(piece, triangle, weights_at(piece.t, pixel, values_at(piece.t, pixel).rounded), pixel);
}

// A thread a pixel.
@compute @workgroup_size(TILE, TILE)
fn resolve_gbuffer(@builtin(global_invocation_id) id: vec3<u32>) {
    let found = seen_at(id.xy);
    if (found.is_there) {
        write_gbuffer(id.xy, found.in.face, recorded(found.in, is_of_skirt(found.in)).f);
    } else if (found.is_cleared) {
        clear_gbuffer(id.xy, call.nothing);
    }
}

@compute @workgroup_size(TILE, TILE)
fn resolve_shaded(@builtin(global_invocation_id) id: vec3<u32>) {
    let found = seen_at(id.xy);
    if (found.is_there) {
        write_shaded(id.xy, found.in.face, coloured(found.in, is_of_skirt(found.in)).f, found.in.local);
    } else if (found.is_cleared) {
        clear_shaded(id.xy, call.nothing);
    }
}

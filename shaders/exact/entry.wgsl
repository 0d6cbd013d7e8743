// Entry points of technique `exact`: compute kernels, run in the order in which they stand here. No fragment stage is
// fit for it: a search writes its own depth, so that nothing hidden is culled early, and hulls overlap.
// Host: crates/techniques/src/exact/gpu.rs.
// Uses exact/newton.wgsl exact/place.wgsl resolve.wgsl layout.wgsl fragment.wgsl sight.wgsl

const WORKGROUP: u32 = 64u;
// Threads that share a small hull, and the pixels of its rectangle at most.
const LANES: u32 = 8u;
const SMALL: u32 = 64u;

// By how much a hull's rectangle is wider than its corners, pixels: hulls are grown by 1/16, projecting rounds by less.
const MARGIN_PX: f32 = 1.0 / 64.0;
// The same where the near plane cuts it: how far that moves a corner depends on how near the plane is to the eye.
const CUT_MARGIN_PX: f32 = 1.0;

// A fault, for tests of the comparer.
override FARTHEST: bool = false;

struct Hull {
    corners: array<vec4<f32>, 8>,
    // The pixels that may see it.
    first: vec2<u32>,
    size: vec2<u32>,
    // In the order of the batch: its pieces with hulls that are not small, in any order.
    large: u32,
}

// A place at which a pixel's ray meets a piece.
struct Meeting {
    u: f32,
    v: f32,
    pixel: u32,
    piece: u32,
    order: u32,
}

struct Picture {
    // The most meetings that a frame has had since this was zeroed.
    most: atomic<u32>,
    // The meetings of this frame; beyond the array's end they are only counted.
    count: atomic<u32>,
    // Two for each pixel, row-major: the greatest order met; the meeting to be shown, plus one. Then, from
    // `batch.unconverged`, a bit for each pixel: a search has not converged there. From `batch.evaluations` on, how often
    // the surface was evaluated for each pixel. Then a count of large hulls for each batch.
    words: array<atomic<u32>>,
}

// The pieces of one program.
struct Batch {
    first: u32,
    count: u32,
    width: u32,
    height: u32,
    unconverged: u32,
    evaluations: u32,
    large: u32,
    // Whether it is this batch that clears pixels that see nothing, and to what.
    clears: u32,
    nothing: vec4<f32>,
}

@group(1) @binding(0) var<storage, read> pieces: array<PieceRecord>;
@group(1) @binding(1) var<storage, read_write> hulls: array<Hull>;
@group(1) @binding(2) var<storage, read_write> picture: Picture;
@group(1) @binding(3) var<storage, read_write> meetings: array<Meeting>;
@group(1) @binding(4) var<uniform> batch: Batch;

// The place of a thread among all of a dispatch that may be more than one row of workgroups.
fn place_of(id: vec3<u32>, groups: vec3<u32>) -> u32 {
    return id.y * groups.x * WORKGROUP + id.x;
}

// A thread a piece of the batch: which pixels may see its hull.
@compute @workgroup_size(WORKGROUP)
fn bound_hulls(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = place_of(id, groups);
    if (index >= batch.count) {
        return;
    }
    let piece = batch.first + index;
    let bounds = bounds_px(piece);
    let viewport = vec2<f32>(f32(batch.width), f32(batch.height));
    // Pixels whose centres are in it.
    let first = vec2<u32>(clamp(ceil(bounds.xy - 0.5), vec2<f32>(), viewport));
    let end = vec2<u32>(clamp(floor(bounds.zw + 0.5), vec2<f32>(), viewport));
    let size = max(first, end) - first;
    hulls[piece].first = first;
    hulls[piece].size = size;
    if (size.x * size.y > SMALL) {
        let slot = atomicAdd(&picture.words[batch.large], 1u);
        hulls[batch.first + slot].large = piece;
    }
}

// The rectangle around what of a hull is behind the near plane, where w − z is not negative: least x and y, then
// greatest, pixels from the top left corner.
fn bounds_px(piece: u32) -> vec4<f32> {
    let view = views[pieces[piece].face];
    let m = view.clip_from_local;
    var corners: array<vec4<f32>, 8>;
    for (var i = 0u; i < 8u; i++) {
        let local = hulls[piece].corners[i];
        corners[i] = m[0] * local.x + m[1] * local.y + m[2] * local.z + m[3];
    }
    var low = vec2<f32>(GREATEST);
    var high = vec2<f32>(-GREATEST);
    var margin = MARGIN_PX;
    for (var i = 0u; i < 8u; i++) {
        let a = corners[i];
        let behind = a.w - a.z;
        if (behind >= 0.0) {
            let at = a.xy / a.w;
            low = min(low, at);
            high = max(high, at);
        }
        // Where the three edges to a greater corner cross the plane.
        for (var bit = 1u; bit < 8u; bit = bit << 1u) {
            let b = corners[i | bit];
            let other = b.w - b.z;
            if ((behind >= 0.0) != (other >= 0.0)) {
                let cut = mix(a, b, behind / (behind - other));
                let at = cut.xy / cut.w;
                low = min(low, at);
                high = max(high, at);
                margin = CUT_MARGIN_PX;
            }
        }
    }
    let half = view.units.yz;
    return vec4<f32>(
        half.x + half.x * low.x - margin,
        half.y - half.y * high.y - margin,
        half.x + half.x * high.x + margin,
        half.y - half.y * low.y + margin,
    );
}

// LANES threads a piece: those with small hulls.
@compute @workgroup_size(WORKGROUP)
fn meet_small(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let place = place_of(id, groups);
    let index = place / LANES;
    if (index >= batch.count) {
        return;
    }
    let piece = batch.first + index;
    let size = hulls[piece].size;
    if (size.x * size.y <= SMALL) {
        meet(piece, place % LANES, LANES);
    }
}

// The pieces with large hulls: however many there are, they share the workgroups.
@compute @workgroup_size(WORKGROUP)
fn meet_large(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let count = atomicLoad(&picture.words[batch.large]);
    if (count == 0u) {
        return;
    }
    let shares = max(groups.x / count, 1u);
    for (var i = group.x; i < count * shares; i += groups.x) {
        meet(hulls[batch.first + i / shares].large, (i % shares) * WORKGROUP + lane, shares * WORKGROUP);
    }
}

// Looks for a piece in every `stride`-th pixel of its rectangle.
fn meet(index: u32, start: u32, stride: u32) {
    let piece = pieces[index];
    let view = views[piece.face];
    let first = hulls[index].first;
    let size = hulls[index].size;
    for (var k = start; k < size.x * size.y; k += stride) {
        let at = first + vec2<u32>(k % size.x, k / size.x);
        let pixel = at.y * batch.width + at.x;
        evaluations = 0u;
        let outcome = solve(piece, sight(view, vec2<f32>(at) + 0.5));
        atomicAdd(&picture.words[batch.evaluations + pixel], evaluations);
        if (outcome.status == UNCONVERGED) {
            atomicOr(&picture.words[batch.unconverged + pixel / 32u], 1u << (pixel % 32u));
        }
        if (outcome.status == HIT) {
            let order = order_of(outcome.depth);
            // What is hidden already need not be kept.
            if (order != 0u && atomicMax(&picture.words[2u * pixel], order) <= order) {
                let slot = atomicAdd(&picture.count, 1u);
                if (slot < arrayLength(&meetings)) {
                    meetings[slot] = Meeting(outcome.uv.x, outcome.uv.y, pixel, index, order);
                }
            }
        }
    }
}

// Greater is nearer. The bits of floats from 0 to 1 stand in their order; −0 is 0, the depth of a cleared picture.
fn order_of(depth: f32) -> u32 {
    let bits = bitcast<u32>(depth) & 0x7fffffffu;
    return select(bits, ~bits, FARTHEST);
}

// The threads share the meetings: of a pixel's nearest, that of the piece drawn first is shown.
@compute @workgroup_size(WORKGROUP)
fn choose(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let count = atomicLoad(&picture.count);
    if (id.x == 0u) {
        atomicMax(&picture.most, count);
    }
    for (var k = id.x; k < min(count, arrayLength(&meetings)); k += groups.x * WORKGROUP) {
        let pixel = meetings[k].pixel;
        if (meetings[k].order == atomicLoad(&picture.words[2u * pixel])) {
            show(k, pixel);
        }
    }
}

// Shows a meeting at its pixel unless another one there is of an earlier piece. A piece meets a pixel once.
fn show(k: u32, pixel: u32) {
    let piece = meetings[k].piece;
    var shown = 0u;
    loop {
        let answer = atomicCompareExchangeWeak(&picture.words[2u * pixel + 1u], shown, k + 1u);
        if (answer.exchanged) {
            return;
        }
        shown = answer.old_value;
        if (shown != 0u && meetings[shown - 1u].piece < piece) {
            return;
        }
    }
}

// The meeting shown at a pixel plus one, or 0 where there is none of the batch.
fn shown_at(at: vec2<u32>) -> u32 {
    if (at.x >= batch.width || at.y >= batch.height) {
        return 0u;
    }
    let shown = atomicLoad(&picture.words[2u * (at.y * batch.width + at.x) + 1u]);
    if (shown == 0u) {
        return 0u;
    }
    // A piece before the first wraps around to one far behind the last.
    return select(0u, shown, meetings[shown - 1u].piece - batch.first < batch.count);
}

// Whether a pixel sees nothing of any batch, and it is this one that says so.
fn is_cleared(at: vec2<u32>) -> bool {
    return batch.clears != 0u
        && at.x < batch.width
        && at.y < batch.height
        && atomicLoad(&picture.words[2u * (at.y * batch.width + at.x) + 1u]) == 0u;
}

fn met_at(meeting: Meeting) -> Parameters {
    let piece = pieces[meeting.piece];
    return Parameters(vec2<u32>(piece.span_u, piece.span_v), vec2<f32>(meeting.u, meeting.v));
}

// A thread a pixel.
@compute @workgroup_size(TILE, TILE)
fn resolve_gbuffer(@builtin(global_invocation_id) id: vec3<u32>) {
    let shown = shown_at(id.xy);
    if (shown == 0u) {
        if (is_cleared(id.xy)) {
            clear_gbuffer(id.xy, batch.nothing);
        }
        return;
    }
    let meeting = meetings[shown - 1u];
    let face = pieces[meeting.piece].face;
    write_gbuffer(id.xy, face, fragment(face, met_at(meeting)));
}

@compute @workgroup_size(TILE, TILE)
fn resolve_shaded(@builtin(global_invocation_id) id: vec3<u32>) {
    let shown = shown_at(id.xy);
    if (shown == 0u) {
        if (is_cleared(id.xy)) {
            clear_shaded(id.xy, batch.nothing);
        }
        return;
    }
    let meeting = meetings[shown - 1u];
    let face = pieces[meeting.piece].face;
    let f = fragment(face, met_at(meeting));
    write_shaded(id.xy, face, f, f.position);
}

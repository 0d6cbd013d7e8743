// Ray ∩ piece by Newton's method, at a fragment of technique `exact`. Twin of crates/techniques/src/exact/newton.rs.
// Uses exact/fold.wgsl exact/place.wgsl layout.wgsl eval.wgsl sight.wgsl

const EVALUATIONS: u32 = 32u;
const LAST_BEND_PX: f32 = 1.0 / 128.0;
const FINE_PX: f32 = 1.0 / 1024.0;
const PROMISE: f32 = 3.0 / 4.0;
const INSIDE: f32 = 1.0 / 16.0;
const ONE_SEED: f32 = 1.0 / 4.0;
const HALVINGS: u32 = 4u;
const SLOW: f32 = 1.0 / 2.0;
const STEP_EDGE_ON: f32 = 1.0 / 2.0;
const PATIENCE: u32 = 4u;
const PATIENCE_EDGE_ON: u32 = 1u;
const NEAR_FOLD_PX: f32 = 1.0 / 4.0;
const ONE_END: f32 = 1.0 / 64.0;
const LARGE_PX: f32 = 1024.0;
const NEAR_TWISTED_PX: f32 = 1.0 / 2.0;
const TWISTED_SIDE_PX: f32 = 16.0;
const APPROACHES: u32 = 4u;
const DAMPING: f32 = 1.0 / 1048576.0;

const HIT: u32 = 0u;
const MISS: u32 = 1u;
const UNCONVERGED: u32 = 2u;

struct Outcome {
    status: u32,
    uv: vec2<f32>,
    depth: f32,
}

struct End {
    outcome: Outcome,
    at: Place,
}

struct Seeds {
    first: vec2<f32>,
    last: vec2<f32>,
    // w where the ray comes into the hull, in front of the near plane.
    nearest_w: f32,
    any: bool,
}

fn solve(piece: PieceRecord, s: Sight) -> Outcome {
    let found = seeds(piece, s);
    if (!found.any) {
        return Outcome(MISS, vec2<f32>(), 0.0);
    }
    var queue: Queue;
    if (near(piece, found.first, found.last, ONE_SEED)) {
        push(&queue, 0.5 * (found.first + found.last));
    } else {
        push(&queue, found.first);
        push(&queue, found.last);
    }
    let given = queue.count;
    var before = vec2<f32>(GREATEST);
    var restarts = QUEUE;
    var approaches = 0u;
    var best = Outcome(MISS, vec2<f32>(), 0.0);
    for (var k = 0u; k < queue.count; k++) {
        let is_restart = restarts <= k && k < restarts + RESTARTS;
        let end = search(piece, s, queue.seeds[k], select(0u, approaches, is_restart));
        let next = end.outcome;
        let nearer = next.status == HIT && (best.status != HIT || next.depth > best.depth)
            && (!TRIMMED || is_shown(faces[piece.face], footprint_of(piece, end.at, next.uv)));
        if (nearer || (next.status == UNCONVERGED && best.status == MISS)) {
            best = next;
        }
        let may_be_led_away = next.status == UNCONVERGED
            || (next.status == MISS && (end.at.w <= 0.0 || is_large_near(end.at, found.nearest_w)));
        let may_be_beyond_a_fold = next.status == MISS && is_near_twisted(piece, end.at);
        if (k < given && restarts == QUEUE && (may_be_led_away || may_be_beyond_a_fold)) {
            restarts = queue.count;
            approaches = select(0u, APPROACHES, may_be_led_away);
            let size = extent(piece);
            push(&queue, piece.rectangle.xy + vec2<f32>(0.5, 0.5) * size);
            push(&queue, piece.rectangle.xy + vec2<f32>(0.125, 0.125) * size);
            push(&queue, piece.rectangle.xy + vec2<f32>(0.125, 0.875) * size);
            push(&queue, piece.rectangle.xy + vec2<f32>(0.875, 0.125) * size);
            push(&queue, piece.rectangle.xy + vec2<f32>(0.875, 0.875) * size);
        }
        if (k < given && end.at.w > 0.0 && is_edge_on(end.at) && !near(piece, end.at.uv, before, ONE_END)) {
            again(piece, s, end.at, next.status == HIT, &queue);
        }
        before = end.at.uv;
    }
    return best;
}

fn is_large_near(at: Place, nearest_w: f32) -> bool {
    return at.side_squared * (at.w * at.w) > LARGE_PX * LARGE_PX * (nearest_w * nearest_w);
}

fn is_near_twisted(piece: PieceRecord, at: Place) -> bool {
    let margin = BEYOND * extent(piece);
    let is_at_border = any(at.uv <= piece.rectangle.xy - margin) || any(at.uv >= piece.rectangle.zw + margin);
    return piece.patience > 0u && at.squared <= NEAR_TWISTED_PX * NEAR_TWISTED_PX
        && at.side_squared > TWISTED_SIDE_PX * TWISTED_SIDE_PX && is_at_border;
}

// The footprint of a pixel whose ray meets the piece at `uv`, by the place where the search came to know.
fn footprint_of(piece: PieceRecord, at: Place, uv: vec2<f32>) -> Footprint {
    let face = faces[piece.face];
    let span_u = span_of(face.table_u, face.spans_u, degree(face.degree_u), piece.span_u);
    let span_v = span_of(face.table_v, face.spans_v, degree(face.degree_v), piece.span_v);
    let pixel = across(at.along_u, at.along_v);
    let size = extent(piece) * vec2<f32>(span_u.length, span_v.length);
    let center = vec2<f32>(whole(span_u, uv.x), whole(span_v, uv.y));
    return Footprint(center, pixel.right * size, pixel.up * size, near_px(at.along_u, at.along_v, at.sides_squared), 0.0);
}

fn near(piece: PieceRecord, a: vec2<f32>, b: vec2<f32>, share: f32) -> bool {
    return all(abs(a - b) <= share * extent(piece));
}

fn seeds(piece: PieceRecord, s: Sight) -> Seeds {
    let rows = piece.hull_from_local;
    let center = vec3<f32>(rows[0].w, rows[1].w, rows[2].w);
    let x = s.x.xyz;
    let y = s.y.xyz;
    // The point of the ray nearest to the centre, about the centre.
    let at_x = plane(s.x, center);
    let at_y = plane(s.y, center);
    let xx = dot(x, x);
    let xy = dot(x, y);
    let yy = dot(y, y);
    let det = xx * yy - xy * xy;
    let a = (xy * at_y - yy * at_x) / det;
    let b = (xy * at_x - xx * at_y) / det;
    let start = a * x + b * y;
    let direction = cross(x, y);
    // The part of the ray inside the hull, and behind the near plane: w − z is not negative.
    var near = -GREATEST;
    var far = GREATEST;
    for (var k = 0u; k < 3u; k++) {
        let at = dot(rows[k].xyz, start);
        let speed = dot(rows[k].xyz, direction);
        if (speed != 0.0) {
            let first = (-1.0 - at) / speed;
            let last = (1.0 - at) / speed;
            near = max(near, min(first, last));
            far = min(far, max(first, last));
        } else if (abs(at) > 1.0) {
            near = GREATEST;
            far = -GREATEST;
        }
    }
    let beyond = s.w - s.z;
    let at = plane(beyond, center + start);
    let speed = dot(beyond.xyz, direction);
    if (speed > 0.0) {
        near = max(near, -at / speed);
    }
    if (speed < 0.0) {
        far = min(far, -at / speed);
    }
    var out: Seeds;
    out.any = near <= far;
    out.first = parameters(piece, start, direction, near);
    out.last = parameters(piece, start, direction, far);
    out.nearest_w = min(plane(s.w, center + (start + near * direction)), plane(s.w, center + (start + far * direction)));
    return out;
}

fn parameters(piece: PieceRecord, start: vec3<f32>, direction: vec3<f32>, along: f32) -> vec2<f32> {
    let rows = piece.hull_from_local;
    let h = vec2<f32>(
        dot(rows[0].xyz, start) + along * dot(rows[0].xyz, direction),
        dot(rows[1].xyz, start) + along * dot(rows[1].xyz, direction),
    );
    return inside(piece, piece.flat.xy + piece.flat.zw * h);
}

fn inside(piece: PieceRecord, uv: vec2<f32>) -> vec2<f32> {
    let margin = INSIDE * extent(piece);
    return min(max(uv, piece.rectangle.xy + margin), piece.rectangle.zw - margin);
}

fn search(piece: PieceRecord, s: Sight, seed: vec2<f32>, approaches: u32) -> End {
    let size = extent(piece);
    let low = piece.rectangle.xy - BEYOND * size;
    let high = piece.rectangle.zw + BEYOND * size;
    var uv = seed;
    var best: Place;
    var step = vec2<f32>();
    var doubts = 0u;
    var halvings = 0u;
    for (var k = 0u; k < approaches + EVALUATIONS; k++) {
        let next = place(piece, s, uv, k >= approaches);
        if (k < approaches) {
            uv = min(max(uv + slid(next, newton_step(next), low, high) * size, low), high);
            continue;
        }
        let is_first = k == approaches;
        let comes_forward = !is_first && best.w <= 0.0 && next.w > 0.0;
        let goes_back = !is_first && best.w > 0.0 && next.w <= 0.0;
        let improved = is_first || comes_forward || (!goes_back && next.squared < best.squared);
        let slow = !is_first && !comes_forward && next.squared > (1.0 - SLOW) * best.squared;
        if (improved) {
            best = next;
            step = slid(best, newton_step(best), low, high);
            halvings = 0u;
        } else if (halvings == HALVINGS) {
            return End(stopped(piece, best, !goes_back), best);
        } else {
            step = step * 0.5;
            halvings += 1u;
        }
        let longest = max(abs(step.x), abs(step.y));
        let bend = longest * longest;
        let recedes = dot(best.recedes, step);
        let is_last = piece.patience == 0u
            && best.w > 0.0
            && bend * bend * best.side_squared <= LAST_BEND_PX * LAST_BEND_PX
            && recedes * recedes * best.squared <= FINE_PX * FINE_PX
            && left_squared(best, step) <= FINE_PX * FINE_PX;
        if (is_last) {
            return End(arrived(piece, best, step), best);
        }
        if (best.w > 0.0 && best.squared <= FINE_PX * FINE_PX) {
            return End(arrived(piece, best, vec2<f32>()), best);
        }
        uv = min(max(best.uv + step * size, low), high);
        let promising = promises(best, (uv - best.uv) / size);
        if (improved && (slow || !promising)) {
            if (doubts >= patience(piece, best, promising) || all(uv == best.uv)) {
                return End(stopped(piece, best, true), best);
            }
            doubts += 1u;
        }
    }
    return End(stopped(piece, best, false), best);
}

fn patience(piece: PieceRecord, at: Place, promised: bool) -> u32 {
    let edge_on = is_edge_on(at);
    if (promised || (edge_on && at.squared <= NEAR_FOLD_PX * NEAR_FOLD_PX)) {
        return PATIENCE;
    }
    return select(piece.patience, max(piece.patience, PATIENCE_EDGE_ON), edge_on);
}

fn stopped(piece: PieceRecord, at: Place, settled: bool) -> Outcome {
    if (at.w > 0.0 && at.squared <= at.rounding_squared) {
        return arrived(piece, at, vec2<f32>());
    }
    return Outcome(select(UNCONVERGED, MISS, settled), at.uv, 0.0);
}

fn arrived(piece: PieceRecord, at: Place, step: vec2<f32>) -> Outcome {
    let size = extent(piece);
    let uv = at.uv + step * size;
    let inside = min(max(uv, piece.rectangle.xy), piece.rectangle.zw);
    // How far the border is, in pixels, and along the ray.
    let back = (inside - uv) / size;
    let away = moved(at, back);
    let depth = at.depth.x + at.depth.y * (step.x + back.x) + at.depth.z * (step.y + back.y);
    let near = dot(away, away) <= max(NEAR_PX * NEAR_PX, at.rounding_squared);
    return Outcome(select(MISS, HIT, near && depth >= 0.0 && depth <= 1.0), inside, depth);
}

fn promises(at: Place, step: vec2<f32>) -> bool {
    return at.w <= 0.0 || left_squared(at, step) <= (1.0 - PROMISE) * at.squared;
}

fn left_squared(at: Place, step: vec2<f32>) -> f32 {
    let left = at.offset + moved(at, step);
    return dot(left, left);
}

fn moved(at: Place, step: vec2<f32>) -> vec2<f32> {
    return at.along_u * step.x + at.along_v * step.y;
}

fn slid(at: Place, step: vec2<f32>, low: vec2<f32>, high: vec2<f32>) -> vec2<f32> {
    let leaves = ((at.uv <= low) & (step < vec2<f32>())) | ((at.uv >= high) & (step > vec2<f32>()));
    if (leaves.x && leaves.y) {
        return vec2<f32>();
    }
    if (leaves.x) {
        return vec2<f32>(0.0, least_along(at.along_v, at.offset));
    }
    if (leaves.y) {
        return vec2<f32>(least_along(at.along_u, at.offset), 0.0);
    }
    return step;
}

fn least_along(along: vec2<f32>, offset: vec2<f32>) -> f32 {
    let squared = dot(along, along);
    if (squared == 0.0) {
        return 0.0;
    }
    return min(max(-dot(along, offset) / squared, -1.0), 1.0);
}

fn newton_step(at: Place) -> vec2<f32> {
    let a = at.along_u;
    let b = at.along_v;
    let o = at.offset;
    let det = a.x * b.y - a.y * b.x;
    let aa = dot(a, a);
    let bb = dot(b, b);
    var step: vec2<f32>;
    if (abs(det) > NEARLY_SINGULAR * (aa + bb)) {
        step = vec2<f32>(b.x * o.y - b.y * o.x, a.y * o.x - a.x * o.y) / det;
    } else {
        let damping = DAMPING * (aa + bb);
        let ab = dot(a, b);
        let gu = dot(a, o);
        let gv = dot(b, o);
        let uu = aa + damping;
        let vv = bb + damping;
        let damped = uu * vv - ab * ab;
        if (damped == 0.0) {
            return vec2<f32>();
        }
        step = vec2<f32>(ab * gv - vv * gu, ab * gu - uu * gv) / damped;
    }
    let longest = max(abs(step.x), abs(step.y));
    // The two directions are independent but at a fold, which one of them crosses.
    if (!is_edge_on(at)) {
        return min(max(step, vec2<f32>(-1.0)), vec2<f32>(1.0));
    }
    if (longest > STEP_EDGE_ON) {
        return step * (STEP_EDGE_ON / longest);
    }
    return step;
}

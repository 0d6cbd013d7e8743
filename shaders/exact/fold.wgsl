// Where a ray that met a piece near a fold, or passed it there, may meet it again. Twin of
// crates/techniques/src/exact/fold.rs.
// Uses exact/place.wgsl layout.wgsl sight.wgsl

const RESTARTS: u32 = 5u;
const QUEUE: u32 = 19u;
const SAMPLES: u32 = 8u;
const ASIDE: f32 = 1.0 / 16.0;
const SHORT: f32 = 1.0 / 8.0;

struct Queue {
    seeds: array<vec2<f32>, QUEUE>,
    count: u32,
}

fn push(queue: ptr<function, Queue>, seed: vec2<f32>) {
    if ((*queue).count < QUEUE) {
        (*queue).seeds[(*queue).count] = seed;
        (*queue).count += 1u;
    }
}

fn again(piece: PieceRecord, s: Sight, end: Place, is_met: bool, queue: ptr<function, Queue>) {
    let size = extent(piece);
    var start = end;
    if (abs(aside(start)) > ASIDE) {
        let along = select(vec2<f32>(0.0, 1.0), vec2<f32>(1.0, 0.0), u_is_stronger(start));
        let uv = start.uv + aside(start) * along * size;
        let beyond = BEYOND * size;
        start = place(piece, s, min(max(uv, piece.rectangle.xy - beyond), piece.rectangle.zw + beyond), true);
    }
    let u_is_strong = u_is_stronger(start);
    let products = products(start);
    let squared = max(products.x, products.z);
    if (squared == 0.0) {
        return;
    }
    let along = select(vec2<f32>(0.0, 1.0), vec2<f32>(1.0, 0.0), u_is_strong);
    let share = (start.uv - piece.rectangle.xy) / size + aside(start) * along;
    let ratio = -products.y / squared;
    let direction = select(vec2<f32>(1.0, ratio), vec2<f32>(ratio, 1.0), u_is_strong);
    // How far the curve runs in the part that may be searched, in shares of the piece by the weaker parameter.
    var least = -GREATEST;
    var greatest = GREATEST;
    for (var k = 0u; k < 2u; k++) {
        if (direction[k] != 0.0) {
            let low = (-BEYOND - share[k]) / direction[k];
            let high = (1.0 + BEYOND - share[k]) / direction[k];
            least = max(least, min(low, high));
            greatest = min(greatest, max(low, high));
        }
    }
    if (least >= greatest) {
        return;
    }
    let at_start = height(start, u_is_strong, direction);
    for (var k = 0u; k < 2u; k++) {
        let last = select(greatest, least, k == 0u);
        if ((k == 0u && least > -SHORT) || (k == 1u && greatest < SHORT)) {
            continue;
        }
        let there = place(piece, s, piece.rectangle.xy + (share + last * direction) * size, true);
        let at_last = height(there, u_is_strong, direction);
        // Hermite: height + t (slope + t (square + t cube)).
        let chord = (at_last.x - at_start.x) / last;
        let square = (3.0 * chord - 2.0 * at_start.y - at_last.y) / last;
        let cube = (at_start.y + at_last.y - 2.0 * chord) / (last * last);
        var was_above = select(at_start.x, at_start.y, is_met) > 0.0;
        for (var sample = 1u; sample <= SAMPLES; sample++) {
            let t = last * (f32(sample) / f32(SAMPLES));
            let divided = at_start.y + t * (square + t * cube);
            let is_above = select(at_start.x + t * divided, divided, is_met) > 0.0;
            if (is_above != was_above) {
                let middle = last * ((f32(sample) - 0.5) / f32(SAMPLES));
                push(queue, piece.rectangle.xy + (share + middle * direction) * size);
            }
            was_above = is_above;
        }
    }
}

fn products(at: Place) -> vec3<f32> {
    return vec3<f32>(dot(at.along_u, at.along_u), dot(at.along_u, at.along_v), dot(at.along_v, at.along_v));
}

fn u_is_stronger(at: Place) -> bool {
    let products = products(at);
    return products.x > products.z;
}

fn aside(at: Place) -> f32 {
    let products = products(at);
    let squared = max(products.x, products.z);
    if (squared == 0.0) {
        return 0.0;
    }
    return -dot(at.offset, select(at.along_v, at.along_u, products.x > products.z)) / squared;
}

fn height(at: Place, u_is_strong: bool, direction: vec2<f32>) -> vec2<f32> {
    let along = select(at.along_v, at.along_u, u_is_strong);
    let weaker = select(at.along_u, at.along_v, u_is_strong);
    let length = sqrt(dot(along, along));
    if (length == 0.0) {
        return vec2<f32>();
    }
    let offset_above = above(at.offset, along) / length;
    let weaker_above = above(weaker, along) / length;
    return vec2<f32>(offset_above, weaker_above + offset_above * dot(at.recedes, direction)) * at.w;
}

fn above(p: vec2<f32>, along: vec2<f32>) -> f32 {
    return p.x * along.y - p.y * along.x;
}

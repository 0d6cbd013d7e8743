// Where a trim edge passes by a pixel's centre. Twin of crates/pipeline/src/edge.rs; stands only in programs that look
// for edges.
// Names begin with the file's, for there are others like them.
// Uses layout.wgsl eval.wgsl fragment.wgsl sight.wgsl trim.wgsl

const EDGE_REACH_PX: f32 = 1.0;
const EDGE_MAP_REACH_PX: f32 = 2.0;
const EDGE_MAPS: u32 = 2u;
const EDGE_EDGE_ON: f32 = 1.0 / 65536.0;
const EDGE_CLIP_HALVINGS: u32 = 12u;
const EDGE_CHORDS: u32 = 8u;
const EDGE_ROUNDS: u32 = 5u;
const EDGE_FINE_PX: f32 = 1.0 / 32.0;
const EDGE_STEPS: f32 = 16383.0;
const EDGE_MIDDLE: f32 = 16384.0;
const EDGE_STATUS_BITS: u32 = 2u;
const EDGE_BITS: u32 = 15u;

struct EdgeSeen {
    behind: bool,
    offset: vec2<f32>,
    along_u: vec2<f32>,
    along_v: vec2<f32>,
}

struct EdgeMap {
    sound: bool,
    center: vec2<f32>,
    along_u: vec2<f32>,
    along_v: vec2<f32>,
    extent: vec2<f32>,
}

struct EdgeFoot {
    found: bool,
    uv: vec2<f32>,
    squared: f32,
}

struct EdgeOnChord {
    share: f32,
    squared: f32,
    length_squared: f32,
}

// The nearest edge of a face, packed, or zero.
fn edge(face_id: u32, uv: vec2<f32>, at: vec2<f32>) -> u32 {
    let face = faces[face_id];
    if (face.intervals == 0u) {
        return 0u;
    }
    let view = views[face_id];
    var here = edge_seen(view, face, uv, at);
    let first = edge_map(here, uv);
    var by = first;
    var word = 0u;
    var offset = vec2<f32>();
    var squared = EDGE_REACH_PX * EDGE_REACH_PX;
    for (var k = 0u; k < EDGE_MAPS; k++) {
        if (!by.sound) {
            break;
        }
        let foot = edge_nearest(face, by);
        // What the first map has farther away is on another sheet of the surface.
        if (!foot.found || edge_squared(first, foot.uv) > EDGE_MAP_REACH_PX * EDGE_MAP_REACH_PX) {
            break;
        }
        here = edge_seen(view, face, foot.uv, at);
        let x = here.offset.x;
        let y = here.offset.y;
        if (!here.behind && x * x + y * y <= squared) {
            squared = x * x + y * y;
            offset = here.offset;
            word = edge_packed(offset);
        }
        by = edge_map(here, foot.uv);
    }
    // A face covers a centre that is a little beyond its border; the edge is recorded on the side where it ends.
    if (word != 0u && squared <= NEAR_PX * NEAR_PX && !is_material(face, first.center)) {
        word = edge_packed(-offset);
    }
    return word;
}

fn edge_map(here: EdgeSeen, uv: vec2<f32>) -> EdgeMap {
    let a = here.along_u;
    let b = here.along_v;
    let o = here.offset;
    let det = a.x * b.y - a.y * b.x;
    let aa = a.x * a.x + a.y * a.y;
    let bb = b.x * b.x + b.y * b.y;
    var map: EdgeMap;
    map.sound = !here.behind && det * det > (EDGE_EDGE_ON * EDGE_EDGE_ON) * aa * bb;
    map.center = vec2<f32>(uv.x - (b.y * o.x - b.x * o.y) / det, uv.y - (a.x * o.y - a.y * o.x) / det);
    map.along_u = a;
    map.along_v = b;
    map.extent = vec2<f32>(sqrt(bb) / abs(det), sqrt(aa) / abs(det));
    return map;
}

// The squared distance that a map gives a point from the pixel's centre.
fn edge_squared(map: EdgeMap, uv: vec2<f32>) -> f32 {
    let away = uv - map.center;
    let x = away.x * map.along_u.x + away.y * map.along_v.x;
    let y = away.x * map.along_u.y + away.y * map.along_v.y;
    return x * x + y * y;
}

fn edge_direction(m: mat4x4<f32>, x: vec3<f32>, k: u32) -> f32 {
    return m[0][k] * x.x + m[1][k] * x.y + m[2][k] * x.z;
}

fn edge_seen(view: View, face: FaceRecord, parameters: vec2<f32>, at: vec2<f32>) -> EdgeSeen {
    let place = found(face, Parameters(vec2<u32>(SEARCHED), parameters));
    let p = degree(face.degree_u);
    let q = degree(face.degree_v);
    let span_u = span_of(face.table_u, face.spans_u, p, place.span.x);
    let span_v = span_of(face.table_v, face.spans_v, q, place.span.y);
    var nu = basis(span_u.knots, p, place.uv.x, span_u.gain, false);
    var nv = basis(span_v.knots, q, place.uv.y, span_v.gain, false);
    let d = surface(face, p, q, vec2<u32>(span_u.first, span_v.first), &nu, &nv, false);
    let m = view.clip_from_local;
    let w = edge_direction(m, d.s, 3u) + m[3][3];
    var out: EdgeSeen;
    out.behind = !(w > 0.0);
    let x = (edge_direction(m, d.s, 0u) + m[3][0]) / w;
    let y = (edge_direction(m, d.s, 1u) + m[3][1]) / w;
    let half = view.units.yz;
    out.offset = vec2<f32>(half.x * x + (half.x - at.x), half.y - at.y - half.y * y);
    out.along_u = edge_along(m, d.su * span_u.per_whole, x, y, w, half);
    out.along_v = edge_along(m, d.sv * span_v.per_whole, x, y, w, half);
    return out;
}

fn edge_along(m: mat4x4<f32>, derivative: vec3<f32>, x: f32, y: f32, w: f32, half: vec2<f32>) -> vec2<f32> {
    let slope = edge_direction(m, derivative, 3u);
    return vec2<f32>(
        (edge_direction(m, derivative, 0u) - x * slope) / w * half.x,
        -((edge_direction(m, derivative, 1u) - y * slope) / w * half.y),
    );
}

fn edge_nearest(face: FaceRecord, map: EdgeMap) -> EdgeFoot {
    let tree = face.trims + 2u * (face.intervals + 1u);
    var node = u32(knots[tree]);
    let end = u32(knots[tree + 1u]);
    var best = EdgeFoot(false, vec2<f32>(), EDGE_MAP_REACH_PX * EDGE_MAP_REACH_PX);
    while (node < end) {
        let hull = points[node];
        let link = points[node + 1u];
        let reach = sqrt(best.squared) * map.extent;
        let low = map.center - reach;
        let high = map.center + reach;
        if (high.x >= hull.x && high.y >= hull.y && low.x <= hull.z && low.y <= hull.w) {
            if (link.y >= 0.0) {
                let foot = edge_nearest_on_piece(u32(link.y), map, low, high);
                if (foot.squared < best.squared) {
                    best = foot;
                }
            }
            node += 2u;
        } else {
            node = u32(link.x);
        }
    }
    return best;
}

fn edge_nearest_on_piece(piece: u32, map: EdgeMap, reach_low: vec2<f32>, reach_high: vec2<f32>) -> EdgeFoot {
    let box = points[piece];
    let control = piece + 1u;
    let degree = u32(points[control].w);
    let low = (reach_low - box.xy) * box.zw;
    let high = (reach_high - box.xy) * box.zw;
    // v rises along a piece; u may fall.
    let first = points[control];
    let last = points[control + degree];
    let falls = first.x / first.z > last.x / last.z;
    var start = 0.0;
    var beyond = 1.0;
    for (var k = 0u; k < EDGE_CLIP_HALVINGS; k++) {
        let t = 0.5 * (start + beyond);
        let c = boundary_point(control, degree, t);
        if (select((c.x < low.x * c.z), (c.x > high.x * c.z), falls) || c.y < low.y * c.z) {
            start = t;
        } else {
            beyond = t;
        }
    }
    var within = start;
    var end = 1.0;
    for (var k = 0u; k < EDGE_CLIP_HALVINGS; k++) {
        let t = 0.5 * (within + end);
        let c = boundary_point(control, degree, t);
        if (select((c.x > high.x * c.z), (c.x < low.x * c.z), falls) || c.y > high.y * c.z) {
            end = t;
        } else {
            within = t;
        }
    }
    // The piece's box, which is 0 … 1 along x and y, in the picture.
    let size = vec2<f32>(edge_extent(box.z), edge_extent(box.w));
    let along_x = map.along_u * size.x;
    let along_y = map.along_v * size.y;
    let from_corner = box.xy - map.center;
    let corner = from_corner.x * map.along_u + from_corner.y * map.along_v;
    let least = start;
    let greatest = end;
    var squared = GREATEST;
    var nearest = start;
    for (var round = 0u; round < EDGE_ROUNDS; round++) {
        let step = (end - start) / f32(EDGE_CHORDS);
        let base = start;
        var from_place = edge_place(control, degree, base, corner, along_x, along_y);
        squared = GREATEST;
        var length_squared = 0.0;
        for (var i = 0u; i < EDGE_CHORDS; i++) {
            let to_place = edge_place(control, degree, base + step * (f32(i) + 1.0), corner, along_x, along_y);
            let chord = edge_nearest_on_chord(from_place, to_place);
            if (chord.squared < squared) {
                squared = chord.squared;
                length_squared = chord.length_squared;
                // Half of the chord before and of the one behind: the arc may be nearest beside its nearest chord.
                start = max(base + step * (f32(i) - 0.5), least);
                end = min(base + step * (f32(i) + 1.5), greatest);
                nearest = base + step * (f32(i) + chord.share);
            }
            from_place = to_place;
        }
        if (length_squared <= EDGE_FINE_PX * EDGE_FINE_PX) {
            break;
        }
    }
    let c = boundary_point(control, degree, nearest);
    return EdgeFoot(true, box.xy + c.xy / c.z * size, squared);
}

fn edge_extent(per: f32) -> f32 {
    if (per > 0.0) {
        return 1.0 / per;
    }
    return 0.0;
}

fn edge_place(control: u32, degree: u32, t: f32, corner: vec2<f32>, along_x: vec2<f32>, along_y: vec2<f32>) -> vec2<f32> {
    let c = boundary_point(control, degree, t);
    return corner + (c.x / c.z * along_x + c.y / c.z * along_y);
}

fn edge_nearest_on_chord(from_place: vec2<f32>, to_place: vec2<f32>) -> EdgeOnChord {
    let chord = to_place - from_place;
    let length_squared = chord.x * chord.x + chord.y * chord.y;
    let along = -(from_place.x * chord.x + from_place.y * chord.y);
    var share = 0.0;
    if (length_squared > 0.0) {
        share = clamp(along / length_squared, 0.0, 1.0);
    }
    let at = from_place + share * chord;
    return EdgeOnChord(share, at.x * at.x + at.y * at.y, length_squared);
}

fn edge_packed(offset: vec2<f32>) -> u32 {
    let steps = vec2<u32>(EDGE_MIDDLE + 0.5 + EDGE_STEPS * clamp(offset, vec2<f32>(-EDGE_REACH_PX), vec2<f32>(EDGE_REACH_PX)));
    return (steps.x << EDGE_STATUS_BITS) | (steps.y << (EDGE_STATUS_BITS + EDGE_BITS));
}

// What a sample of a flat triangle shows: the program, run at the interpolated (u, v).
// Uses layout.wgsl eval.wgsl fragment.wgsl sight.wgsl

struct Sample {
    face: u32,
    given: Parameters,
    // Where in the picture, pixels from the top left corner.
    at: vec2<f32>,
    // What the triangle carries there.
    normal: vec3<f32>,
    local: vec3<f32>,
}

struct Shown {
    f: Fragment,
    is_drawn: bool,
    // z / w of the place that a skirt shows, which may be far from its triangle; elsewhere the triangle has it.
    depth: f32,
    // Whether the ray passes the face by: then a skirt has the farther depth, that of the place or that of its triangle.
    is_beyond: bool,
}

fn is_of_skirt(in: Sample) -> bool {
    return TRIMMED && (faces[in.face].flags & BOUNDED) != 0u && is_on_skirt(faces[in.face], in.given);
}

// The program at the interpolated (u, v), but on a skirt at the place of the face that is nearest to the pixel; what lies behind
// is seen where the face does not cover it. Twin: `Sight::shows` and `Sight::place`.
fn shown(in: Sample, on_skirt: bool) -> Shown {
    let face = faces[in.face];
    let pixel = sight(views[in.face], in.at);
    var f: Fragment;
    var place = in.given;
    var steps = 0u;
    // A loop, so that the program stands there once.
    loop {
        f = fragment(in.face, place);
        if (!on_skirt || steps == SKIRT_STEPS) {
            break;
        }
        let next = nearest_on_span(face, f, pixel);
        if (next.way_squared <= SKIRT_SETTLED_PX * SKIRT_SETTLED_PX) {
            break;
        }
        place = next.at;
        steps += 1u;
    }
    if (!TRIMMED) {
        return Shown(f, true, 0.0, false);
    }
    let at = footprint(pixel, f.whole, f.position, f.su, f.sv, REACH_PX);
    let depth = depth_of(pixel, f.position);
    let is_lost = on_skirt && (at.step_squared > SKIRT_FOUND_PX * SKIRT_FOUND_PX || depth == 0.0);
    return Shown(f, !is_lost && is_shown(face, at), depth, any(at.center < vec2<f32>(0.0)) || any(at.center > vec2<f32>(1.0)));
}

struct Nearest {
    at: Parameters,
    // The square of the way there, pixels were the surface seen at a right angle.
    way_squared: f32,
}

// The place of a fragment's span that is nearest to a pixel in the picture, by the span's own parameters; beyond a knot that is
// no border, the place of the next span.
fn nearest_on_span(face: FaceRecord, f: Fragment, pixel: Sight) -> Nearest {
    let length_u = span_of(face.table_u, face.spans_u, degree(face.degree_u), f.span.x).length;
    let length_v = span_of(face.table_v, face.spans_v, degree(face.degree_v), f.span.y).length;
    let su = f.su * length_u;
    let sv = f.sv * length_v;
    let found = footprint(pixel, f.uv, f.position, su, sv, SKIRT_REACH_PX);
    let is_before = (found.center < vec2<f32>(0.0)) & (f.span > vec2<u32>(0u));
    let is_beyond = (found.center > vec2<f32>(1.0)) & (f.span < vec2<u32>(face.spans_u, face.spans_v) - 1u);
    let next = f.span + select(vec2<u32>(0u), vec2<u32>(1u), is_beyond) - select(vec2<u32>(0u), vec2<u32>(1u), is_before);
    let next_u = span_of(face.table_u, face.spans_u, degree(face.degree_u), next.x).length;
    let next_v = span_of(face.table_v, face.spans_v, degree(face.degree_v), next.y).length;
    let gain = vec2<f32>(length_u, length_v) / vec2<f32>(next_u, next_v);
    let low = clamp(1.0 + found.center * gain, vec2<f32>(0.0), vec2<f32>(1.0));
    let high = clamp((found.center - 1.0) * gain, vec2<f32>(0.0), vec2<f32>(1.0));
    let uv = select(select(nearest(found), low, is_before), high, is_beyond);
    let pixels = squared_pixels(pixel, plane(pixel.w, f.position));
    let way = uv - f.uv;
    let way_squared = max(dot(su, su) * pixels * (way.x * way.x), dot(sv, sv) * pixels * (way.y * way.y));
    return Nearest(Parameters(next, uv), select(GREATEST, way_squared, all(next == f.span)));
}

// What the flat triangle carries, in place of the surface's own: its point and the interpolated normal. A skirt shows the surface's own,
// of a place beside the triangle.
fn carried(in: Sample, own: Fragment, on_skirt: bool) -> Fragment {
    var f = own;
    f.curvature = vec2<f32>(0.0);
    if (on_skirt) {
        return f;
    }
    let length = sqrt(dot(in.normal, in.normal));
    f.status = select(UNDEFINED, REGULAR, length > 0.0);
    f.normal = select(vec3<f32>(0.0), in.normal / length, length > 0.0);
    f.position = in.local;
    return f;
}

// Where a fragment is, without what the surface is there: all that a colour takes of it where triangles carry the rest.
fn unevaluated(in: Sample) -> Fragment {
    let face = faces[in.face];
    let at = found(face, in.given);
    let span_u = span_of(face.table_u, face.spans_u, degree(face.degree_u), at.span.x);
    let span_v = span_of(face.table_v, face.spans_v, degree(face.degree_v), at.span.y);
    var f: Fragment;
    f.uv = at.uv;
    f.span = at.span;
    f.whole = vec2<f32>(whole(span_u, at.uv.x), whole(span_v, at.uv.y));
    return f;
}

// What a colour is made of: nothing is evaluated where triangles carry all of it.
fn coloured(in: Sample, on_skirt: bool) -> Shown {
    if (VERTEX_NORMALS && !TRIMMED) {
        return Shown(carried(in, unevaluated(in), false), true, 0.0, false);
    }
    return recorded(in, on_skirt);
}

// The depth of a skirt whose triangle has another.
fn skirt_depth(out: Shown, depth: f32) -> f32 {
    return select(out.depth, min(out.depth, depth), out.is_beyond);
}

// What a G-buffer holds.
fn recorded(in: Sample, on_skirt: bool) -> Shown {
    var out = shown(in, on_skirt);
    if (VERTEX_NORMALS) {
        out.f = carried(in, out.f, on_skirt);
    }
    return out;
}

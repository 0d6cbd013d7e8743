// Colour of a hit: the twin of crates/gbuffer/src/shade.rs, function by function and statement by statement.
// Only + - * / sqrt and exact operations (min, max, clamp, abs, floor, comparisons, integers) are used.

// Kinds of shading, as in ShadeKind.
const KIND_PHONG: u32 = 0u;
const KIND_ISOPHOTES: u32 = 1u;
const KIND_ZEBRA: u32 = 2u;
const KIND_NORMAL: u32 = 3u;
const KIND_CHECKER: u32 = 4u;
const KIND_FACE: u32 = 5u;
const KIND_GAUSSIAN: u32 = 6u;
const KIND_MEAN: u32 = 7u;

// Status of a normal without a direction, as in nurbs::NormalStatus.
const STATUS_UNDEFINED: u32 = 2u;

// Where nothing is hit.
const BACKGROUND: vec3<f32> = vec3<f32>(0.082, 0.094, 0.118);
// Where the normal is undefined.
const UNDEFINED_COLOUR: vec3<f32> = vec3<f32>(1.0, 0.0, 1.0);
// Where the curvature is unknown.
const UNKNOWN_COLOUR: vec3<f32> = vec3<f32>(0.45, 0.45, 0.45);

const PHONG_BASE: vec3<f32> = vec3<f32>(0.44, 0.56, 0.66);
const PHONG_AMBIENT: f32 = 0.025;
const PHONG_HEADLIGHT: f32 = 0.13;
const PHONG_DIFFUSE: f32 = 0.72;
const PHONG_SPECULAR: f32 = 0.3;
// How fast the side turns dark toward the silhouette, where the seen side changes.
const PHONG_RIM: f32 = 4.0;

const LIGHT_TONE: vec3<f32> = vec3<f32>(0.965, 0.961, 0.945);
const DARK_TONE: vec3<f32> = vec3<f32>(0.141, 0.208, 0.345);

// Hues of isophotes from facing the light to grazing it.
const ANGLE_0: vec3<f32> = vec3<f32>(0.957, 0.647, 0.165);
const ANGLE_1: vec3<f32> = vec3<f32>(0.859, 0.243, 0.263);
const ANGLE_2: vec3<f32> = vec3<f32>(0.494, 0.184, 0.557);
const ANGLE_3: vec3<f32> = vec3<f32>(0.118, 0.29, 0.553);

const CHECKER_LIGHT: vec3<f32> = vec3<f32>(0.957, 0.925, 0.851);
const CHECKER_DARK: vec3<f32> = vec3<f32>(0.165, 0.404, 0.447);

// Signed values from the least through nought to the greatest.
const NEGATIVE_2: vec3<f32> = vec3<f32>(0.078, 0.196, 0.478);
const NEGATIVE_1: vec3<f32> = vec3<f32>(0.337, 0.592, 0.812);
const NOUGHT: vec3<f32> = vec3<f32>(0.969, 0.965, 0.957);
const POSITIVE_1: vec3<f32> = vec3<f32>(0.914, 0.51, 0.392);
const POSITIVE_2: vec3<f32> = vec3<f32>(0.553, 0.067, 0.118);

// Scaled curvatures beyond this have overflowed, or might.
const GREATEST_CURVATURE: f32 = 1e30;

// Share of a lit colour that does not depend on the angle of view.
const RELIEF_FLOOR: f32 = 0.6;

// What a picture's shading depends on besides the hit.
struct ShadeUniform {
    // Unit direction to the light, world.
    light: vec3<f32>,
    // One of the kinds above.
    kind: u32,
    // Unit direction across which the reflection lines are counted, world.
    axis: vec3<f32>,
    // Number of reflection lines, light and dark, over all directions.
    stripes: f32,
    // Number of squares along each parameter.
    squares: f32,
    // Number of isophote bands from 0 to 90 degrees.
    bands: f32,
    // Takes the unit out of principal curvatures, model units.
    curvature_scale: f32,
    padding: f32,
    // Cosines at which isophote bands end, decreasing; -2 where there is none.
    thresholds: array<vec4<f32>, 9>,
}

// What a colour depends on.
struct ShadeInput {
    // Unit normal, world; anything where status is STATUS_UNDEFINED.
    normal: vec3<f32>,
    // Unit direction of the pixel's ray, from the eye to the point, world.
    view: vec3<f32>,
    // Parameters, 0 to 1 over the surface's domain.
    uv01: vec2<f32>,
    // Number of the face.
    face: u32,
    // 1 where k1 and k2 hold, else 0.
    curved: u32,
    // Principal curvatures, 1 / model unit; looked at only where curved is 1.
    k1: f32,
    k2: f32,
    // A nurbs::NormalStatus.
    status: u32,
}

fn dot3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn lerp3(a: vec3<f32>, b: vec3<f32>, t: f32) -> vec3<f32> {
    return a + (b - a) * t;
}

fn clamp01(x: f32) -> f32 {
    return clamp(x, 0.0, 1.0);
}

// 1 for odd whole numbers, 0 for even ones.
fn parity(n: f32) -> f32 {
    return n - 2.0 * floor(n * 0.5);
}

// The view direction mirrored at the surface; the same for both normals.
fn reflected(s: ShadeInput) -> vec3<f32> {
    return s.view - s.normal * (2.0 * dot3(s.view, s.normal));
}

// A colour made darker where the surface turns away from the eye.
fn relief(s: ShadeInput, colour: vec3<f32>) -> vec3<f32> {
    return colour * (RELIEF_FLOOR + (1.0 - RELIEF_FLOOR) * abs(dot3(s.normal, s.view)));
}

// Two-sided: both dot products change sign with the normal. Linear light, encoded by a square root (a gamma of 2).
fn phong_colour(uniforms: ShadeUniform, s: ShadeInput) -> vec3<f32> {
    let facing = -dot3(s.normal, s.view);
    let side = clamp(PHONG_RIM * facing, -1.0, 1.0);
    let diffuse = max(dot3(s.normal, uniforms.light) * side, 0.0);
    let gloss = max(dot3(reflected(s), uniforms.light), 0.0);
    let gloss2 = gloss * gloss;
    let gloss4 = gloss2 * gloss2;
    let gloss8 = gloss4 * gloss4;
    let gloss16 = gloss8 * gloss8;
    let gloss32 = gloss16 * gloss16;
    let matt = PHONG_AMBIENT + PHONG_HEADLIGHT * abs(facing) + PHONG_DIFFUSE * diffuse;
    let shine = PHONG_SPECULAR * gloss32;
    let linear = PHONG_BASE * matt + vec3<f32>(shine, shine, shine);
    return vec3<f32>(sqrt(clamp01(linear.x)), sqrt(clamp01(linear.y)), sqrt(clamp01(linear.z)));
}

// How many of four cosines are above this one.
fn count_above(cosine: f32, thresholds: vec4<f32>) -> f32 {
    let x = select(0.0, 1.0, cosine < thresholds.x);
    let y = select(0.0, 1.0, cosine < thresholds.y);
    let z = select(0.0, 1.0, cosine < thresholds.z);
    let w = select(0.0, 1.0, cosine < thresholds.w);
    return x + y + z + w;
}

// The cosine that isophotes are lines of; the same for both normals.
fn isophote_cosine(uniforms: ShadeUniform, s: ShadeInput) -> f32 {
    return abs(dot3(s.normal, uniforms.light));
}

// The band of a cosine, from 0 where the surface faces the light.
fn isophote_band(uniforms: ShadeUniform, cosine: f32) -> f32 {
    var band = count_above(cosine, uniforms.thresholds[0]);
    band = band + count_above(cosine, uniforms.thresholds[1]);
    band = band + count_above(cosine, uniforms.thresholds[2]);
    band = band + count_above(cosine, uniforms.thresholds[3]);
    band = band + count_above(cosine, uniforms.thresholds[4]);
    band = band + count_above(cosine, uniforms.thresholds[5]);
    band = band + count_above(cosine, uniforms.thresholds[6]);
    band = band + count_above(cosine, uniforms.thresholds[7]);
    band = band + count_above(cosine, uniforms.thresholds[8]);
    return band;
}

fn isophote_colour(bands: f32, band: f32) -> vec3<f32> {
    let t = (band + 0.5) / bands * 3.0;
    var hue = lerp3(ANGLE_0, ANGLE_1, clamp01(t));
    hue = lerp3(hue, ANGLE_2, clamp01(t - 1.0));
    hue = lerp3(hue, ANGLE_3, clamp01(t - 2.0));
    return lerp3(LIGHT_TONE, hue, parity(band));
}

// How far along the axis the mirrored view points, counted in stripes.
fn zebra_coordinate(uniforms: ShadeUniform, s: ShadeInput) -> f32 {
    return (dot3(reflected(s), uniforms.axis) * 0.5 + 0.5) * uniforms.stripes;
}

fn zebra_colour(band: f32) -> vec3<f32> {
    return lerp3(LIGHT_TONE, DARK_TONE, parity(band));
}

fn normal_colour(s: ShadeInput) -> vec3<f32> {
    return s.normal * 0.5 + vec3<f32>(0.5, 0.5, 0.5);
}

// The square that a parameter from 0 to 1 falls into; the last has both its ends.
fn checker_square(uniforms: ShadeUniform, x: f32) -> f32 {
    return min(max(floor(x * uniforms.squares), 0.0), uniforms.squares - 1.0);
}

fn checker_colour(square_u: f32, square_v: f32) -> vec3<f32> {
    return lerp3(CHECKER_LIGHT, CHECKER_DARK, parity(square_u + square_v));
}

// Hues of successive faces differ by the golden ratio of the circle (Fibonacci hashing), so that neighbours differ.
fn face_colour(face: u32) -> vec3<f32> {
    let hash = face * 2654435769u + 1640531527u;
    let hue = f32(hash >> 8u) * (6.0 / 16777216.0);
    let r = clamp01(abs(hue - 3.0) - 1.0);
    let g = clamp01(2.0 - abs(hue - 2.0));
    let b = clamp01(2.0 - abs(hue - 4.0));
    let tint = 0.05 * parity(f32(face & 1u));
    return vec3<f32>(0.34 + tint, 0.36 + tint, 0.38 + tint) + vec3<f32>(r * 0.56, g * 0.46, b * 0.52);
}

// All of the line to -1 < x < 1, keeping sign and order.
fn compressed(value: f32) -> f32 {
    let x = clamp(value, -GREATEST_CURVATURE, GREATEST_CURVATURE);
    return x / (1.0 + abs(x));
}

// A colour for -1 to 1: blue, white at nought, red.
fn diverging_colour(x: f32) -> vec3<f32> {
    let t = abs(x) * 2.0;
    let first = select(NEGATIVE_1, POSITIVE_1, x > 0.0);
    let second = select(NEGATIVE_2, POSITIVE_2, x > 0.0);
    return lerp3(lerp3(NOUGHT, first, clamp01(t)), second, clamp01(t - 1.0));
}

fn curvature_colour(s: ShadeInput, value: f32) -> vec3<f32> {
    if (s.curved == 0u) {
        return relief(s, UNKNOWN_COLOUR);
    }
    return relief(s, diverging_colour(compressed(value)));
}

// The colour of a hit, each part 0 to 1, to be stored as unorm8 as it is.
fn shade(uniforms: ShadeUniform, s: ShadeInput) -> vec3<f32> {
    if (s.status == STATUS_UNDEFINED) {
        return UNDEFINED_COLOUR;
    }
    switch uniforms.kind {
        case KIND_PHONG: {
            return phong_colour(uniforms, s);
        }
        case KIND_ISOPHOTES: {
            return isophote_colour(uniforms.bands, isophote_band(uniforms, isophote_cosine(uniforms, s)));
        }
        case KIND_ZEBRA: {
            return zebra_colour(floor(zebra_coordinate(uniforms, s)));
        }
        case KIND_NORMAL: {
            return normal_colour(s);
        }
        case KIND_CHECKER: {
            let square_u = checker_square(uniforms, s.uv01.x);
            let square_v = checker_square(uniforms, s.uv01.y);
            return relief(s, checker_colour(square_u, square_v));
        }
        case KIND_FACE: {
            return relief(s, face_colour(s.face));
        }
        case KIND_GAUSSIAN: {
            return curvature_colour(s, (s.k1 * uniforms.curvature_scale) * (s.k2 * uniforms.curvature_scale));
        }
        case KIND_MEAN: {
            return curvature_colour(s, 0.5 * (s.k1 + s.k2) * uniforms.curvature_scale);
        }
        default: {
            return UNKNOWN_COLOUR;
        }
    }
}

// Draws the atlas of masks: for each chord of a loop the triangle from the loop's first point. Where an odd number of
// them covers a texel it is inside; blending counts them. Host: crates/gpu/src/masks.rs.

const MAX_ORDER: u32 = 16u;

struct MaskCurve {
    corner: vec2<f32>,
    origin: vec2<f32>,
    control: u32,
    degree: u32,
    first_chord: u32,
    chords: u32,
}

struct Extent {
    size: vec2<f32>,
    curves: u32,
}

@group(0) @binding(0) var<storage, read> curves: array<MaskCurve>;
@group(0) @binding(1) var<storage, read> control: array<vec4<f32>>;
@group(0) @binding(2) var<uniform> extent: Extent;

@vertex
fn fan(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let curve = curves[curve_of(index / 3u)];
    var at = curve.origin;
    let corner = index % 3u;
    if (corner > 0u) {
        let k = index / 3u - curve.first_chord + corner - 1u;
        at = curve_point(curve, f32(k) / f32(curve.chords));
    }
    // Rows run downward.
    let share = (curve.corner + at) / extent.size;
    return vec4<f32>(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.0, 1.0);
}

@fragment
fn toggle() -> @location(0) vec4<f32> {
    return vec4<f32>(1.0);
}

// The curve that a chord belongs to.
fn curve_of(chord: u32) -> u32 {
    var low = 0u;
    var high = extent.curves;
    while (high - low > 1u) {
        let middle = (low + high) / 2u;
        if (chord < curves[middle].first_chord) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return low;
}

fn curve_point(curve: MaskCurve, t: f32) -> vec2<f32> {
    let s = 1.0 - t;
    var points: array<vec3<f32>, MAX_ORDER>;
    for (var i = 0u; i <= curve.degree; i++) {
        points[i] = control[curve.control + i].xyz;
    }
    for (var remaining = curve.degree; remaining > 0u; remaining--) {
        for (var i = 0u; i < remaining; i++) {
            points[i] = s * points[i] + t * points[i + 1u];
        }
    }
    return points[0].xy / points[0].z;
}

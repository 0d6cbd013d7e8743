// The records that the CPU and the GPU read alike. Twin of crates/pipeline/src/layout.rs.
// Uses shade.wgsl

const RATIONAL: u32 = 1u;
const REVERSED: u32 = 2u;
const BOUNDED: u32 = 4u;
const GREATEST: f32 = 3.40282346e38;
const SEARCHED: u32 = 0xffffffffu;
const SPAN_HEAD: u32 = 4u;

struct FaceRecord {
    degree_u: u32,
    degree_v: u32,
    spans_u: u32,
    spans_v: u32,
    table_u: u32,
    table_v: u32,
    points: u32,
    count_v: u32,
    flags: u32,
    trims: u32,
    intervals: u32,
    padding: u32,
}

struct View {
    clip_from_local: mat4x4<f32>,
    eye: vec4<f32>,
    units: vec4<f32>,
}

@group(0) @binding(0) var<storage, read> faces: array<FaceRecord>;
@group(0) @binding(1) var<storage, read> views: array<View>;
@group(0) @binding(2) var<storage, read> knots: array<f32>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<uniform> shading: ShadeUniform;

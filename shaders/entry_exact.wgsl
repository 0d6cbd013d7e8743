// Entry points of technique `exact`. The vertex stage places a hull's corners; the fragment stage looks for the hull's
// piece on its pixel's ray, and runs the program where it finds it.

const CORNERS: u32 = 8u;

@group(1) @binding(0) var<storage, read> pieces: array<PieceRecord>;
// A bit a pixel, row-major: a search has not converged there. Behind the bits, nothing.
@group(1) @binding(1) var<storage, read_write> unconverged: array<atomic<u32>>;

struct VertexOutput {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) piece: u32,
}

struct ExactGBufferOutput {
    @builtin(frag_depth) depth: f32,
    @location(0) identity: vec4<u32>,
    @location(1) position: vec4<f32>,
    @location(2) normal: vec4<f32>,
    @location(3) shape: vec4<f32>,
}

struct ExactShadedOutput {
    @builtin(frag_depth) depth: f32,
    @location(0) colour: vec4<f32>,
}

@vertex
fn vertex(@location(0) position: vec3<f32>, @location(2) face: u32, @builtin(vertex_index) index: u32) -> VertexOutput {
    let m = views[face].clip_from_local;
    var out: VertexOutput;
    out.clip = m[0] * position.x + m[1] * position.y + m[2] * position.z + m[3];
    out.piece = index / CORNERS;
    return out;
}

fn look(piece: PieceRecord, at: vec2<f32>) -> Outcome {
    let view = views[piece.face];
    let outcome = solve(piece, sight(view, at));
    if (outcome.status == UNCONVERGED) {
        let pixel = vec2<u32>(at);
        let index = pixel.y * u32(2.0 * view.units.y) + pixel.x;
        atomicOr(&unconverged[index / 32u], 1u << (index % 32u));
    }
    return outcome;
}

@fragment
fn fragment_gbuffer(in: VertexOutput) -> ExactGBufferOutput {
    let piece = pieces[in.piece];
    let outcome = look(piece, in.clip.xy);
    if (outcome.status != HIT) {
        discard;
    }
    let g = gbuffer_output(piece.face, fragment(piece.face, outcome.uv));
    return ExactGBufferOutput(outcome.depth, g.identity, g.position, g.normal, g.shape);
}

@fragment
fn fragment_shaded(in: VertexOutput) -> ExactShadedOutput {
    let piece = pieces[in.piece];
    let outcome = look(piece, in.clip.xy);
    if (outcome.status != HIT) {
        discard;
    }
    let f = fragment(piece.face, outcome.uv);
    return ExactShadedOutput(outcome.depth, shaded_output(piece.face, f, f.normal, f.position));
}

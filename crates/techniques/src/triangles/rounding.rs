//! What f32 makes of a corner that the program evaluates itself.

use pipeline::{PackedScene, RATIONAL};

/// How far S may be off in f32 anywhere on a face, model units: of the basis functions, which are sums of products of what is not negative,
/// 10 roundings a degree; of the sums over control points, which are at most 1, one a term; and as much for the weights' sum.
pub fn rounding(scene: &PackedScene, face: u32) -> f64 {
    const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
    let f = &scene.faces()[face as usize];
    let degrees = f64::from(f.degree_u + f.degree_v);
    let of_weights = if f.flags & RATIONAL != 0 { 2.0 } else { 1.0 };
    (11.0 * degrees + 8.0) * of_weights * UNIT * scene.frames()[face as usize].scale
}

//! Angles between the normals of two pictures, over pixels that show the same face.

use gbuffer::{GBuffer, Hit};
use serde::Serialize;

/// Angles between a picture's normals and the ray caster's, degrees, over pixels that show the same face.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Angles {
    /// Pixels compared.
    pub pixels: usize,
    /// Half are below.
    pub median_deg: f64,
    /// 99 of 100 are below.
    pub percentile_99_deg: f64,
    /// The largest.
    pub greatest_deg: f64,
}

/// The angle between the normals of two hits, degrees; `None` where they show different faces, or one has no normal.
pub fn angle_deg(a: &Hit, b: &Hit) -> Option<f64> {
    let (n, m) = (a.normal.unit()?.normalize_or_zero(), b.normal.unit()?);
    // The cross product keeps small angles that the dot product rounds away.
    (a.face == b.face).then(|| n.cross(m).length().atan2(n.dot(m)).to_degrees())
}

/// How far a buffer's normals are from the exact ones.
pub fn angles(buffer: &GBuffer, exact: &GBuffer) -> Angles {
    let mut found: Vec<f64> = buffer.pixels().zip(exact.pixels()).filter_map(|(a, b)| angle_deg(a?, b?)).collect();
    found.sort_by(f64::total_cmp);
    let at = |share: f64| found.get(((found.len() as f64 - 1.0) * share) as usize).copied().unwrap_or(0.0);
    Angles { pixels: found.len(), median_deg: at(0.5), percentile_99_deg: at(0.99), greatest_deg: at(1.0) }
}

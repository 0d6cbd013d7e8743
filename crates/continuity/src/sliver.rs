//! How wide a face is on the whole: twice its area over the length of its borders. Measured, not bounded.

use crate::borders::Given;
use crate::region::Material;
use glam::DVec2;
use scene::{FaceId, Model};

/// Places along each parameter at which a face's area is measured.
const PLACES: usize = 24;

/// Of each face: for a long strip it is its width, for a disc its radius. Model units.
pub fn mean_widths(model: &Model, borders: &[Given]) -> Vec<f64> {
    let mut lengths = vec![0.0; model.faces().len()];
    for given in borders {
        lengths[given.border.face.0 as usize] += given.border.length();
    }
    let width = |(index, length): (usize, f64)| {
        let area = area(model, FaceId(index as u32));
        if 0.0 < length { 2.0 * area / length } else { f64::INFINITY }
    };
    lengths.into_iter().enumerate().map(width).collect()
}

fn area(model: &Model, face: FaceId) -> f64 {
    let surface = model.surface(face);
    let material = Material::new(model, face);
    let [[u0, u1], [v0, v1]] = surface.domain();
    let (mut min, mut max) = (DVec2::new(u0, v0), DVec2::new(u1, v1));
    if let Some(region) = model.trimmed_region(face) {
        let hull = region.hull();
        (min, max) = (hull.min, hull.max);
    }
    let step = (max - min) / PLACES as f64;
    let mut sum = 0.0;
    for i in 0..PLACES {
        for j in 0..PLACES {
            let uv = min + step * DVec2::new(i as f64 + 0.5, j as f64 + 0.5);
            if material.holds(uv) {
                let d = surface.first_derivatives(uv.x, uv.y);
                sum += d.su.cross(d.sv).length();
            }
        }
    }
    sum * step.x * step.y
}

//! `info --approximate`: how many bicubic patches stand for a model's own, and how far off they are at most.

use anyhow::{Context, Result};
use rayon::prelude::*;
use scene::Model;
use serde::Serialize;

/// A model by bicubic patches (Geiger 2015, Sec. 3.2).
#[derive(Serialize)]
pub struct ApproximationInfo {
    /// What was asked for, model units.
    pub tolerance: f64,
    /// Bézier patches of all surfaces.
    pub patches: usize,
    /// Bicubic ones that stand for them.
    pub bicubic_patches: usize,
    /// The greatest distance of one from what it stands for, at equal parameters, at most; model units.
    pub bound: f64,
    /// The same of each surface.
    pub surfaces: Vec<SurfaceInfo>,
}

/// A surface by bicubic patches.
#[derive(Serialize)]
pub struct SurfaceInfo {
    /// Its Bézier patches.
    pub patches: usize,
    /// Bicubic ones.
    pub bicubic_patches: usize,
    /// The greatest distance, model units.
    pub bound: f64,
}

/// Approximates all surfaces of a model.
///
/// # Errors
/// Where a patch cannot be brought within the tolerance: the surface, and the patch by its spans.
pub fn approximated(model: &Model, tolerance: f64) -> Result<ApproximationInfo> {
    let of_surface = |index: usize| -> Result<SurfaceInfo> {
        let patches = model.surfaces()[index].bezier_patches();
        let mut info = SurfaceInfo { patches: patches.len(), bicubic_patches: 0, bound: 0.0 };
        for (number, patch) in patches.iter().enumerate() {
            let [[u0, u1], [v0, v1]] = patch.domain;
            let place = || format!("surface {index}, patch {number} on [{u0}, {u1}] x [{v0}, {v1}]");
            let parts = patch.bicubics(tolerance).with_context(place)?;
            info.bicubic_patches += parts.len();
            info.bound = parts.iter().fold(info.bound, |most, part| most.max(part.error));
        }
        Ok(info)
    };
    let surfaces: Vec<SurfaceInfo> =
        (0..model.surfaces().len()).into_par_iter().map(of_surface).collect::<Result<_>>()?;
    Ok(ApproximationInfo {
        tolerance,
        patches: surfaces.iter().map(|surface| surface.patches).sum(),
        bicubic_patches: surfaces.iter().map(|surface| surface.bicubic_patches).sum(),
        bound: surfaces.iter().fold(0.0, |most, surface| most.max(surface.bound)),
        surfaces,
    })
}

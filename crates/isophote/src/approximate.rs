//! `--approximate`: bicubic patches drawn in place of a model's own, as Geiger (2015, Sec. 3.2) draws.

use crate::number;
use anyhow::{Context, Result};
use clap::Args;
use compare::StandIn;
use nurbs::{BicubicSurface, Direction, Surface};
use rayon::prelude::*;
use scene::{Camera, Model, Viewport};
use serde::Serialize;

/// Whether a model is drawn by bicubic patches.
#[derive(Debug, Clone, Copy, Args)]
pub struct ApproximateArgs {
    /// Draw bicubic patches within this distance of the model's own: in model units, or in pixels where the model is nearest, as
    /// in 0.1px
    #[arg(long = "approximate", hide_short_help = true, value_name = "TOL", value_parser = tolerance, allow_hyphen_values = true)]
    tolerance: Option<Tolerance>,
}

/// A distance that is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Model units.
    Units(f64),
    /// Pixels where the model is nearest.
    Pixels(f64),
}

fn tolerance(text: &str) -> Result<Tolerance, String> {
    match text.strip_suffix("px") {
        Some(pixels) => number::error_px(pixels).map(Tolerance::Pixels),
        None => number::positive(text).map(Tolerance::Units),
    }
}

/// A model by bicubic patches.
pub struct Approximated {
    /// It, with the loops and the parameters of the original.
    pub model: Model,
    /// How it lies on the original.
    pub stand_in: StandIn,
    /// What it comes to.
    pub facts: Approximation,
}

/// What an approximation comes to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Approximation {
    /// The distance asked for, model units.
    pub tolerance: f64,
    /// The greatest distance that is proven, model units.
    pub bound: f64,
    /// Bézier patches of the model.
    pub patches: usize,
    /// Bicubic patches that are drawn in their place.
    pub bicubic_patches: usize,
}

impl Approximation {
    /// In words.
    pub fn line(&self) -> String {
        let Self { tolerance, bound, patches, bicubic_patches } = self;
        format!(
            "approximated: {patches} patches by {bicubic_patches} bicubic ones within {tolerance:.3e}; proven {bound:.3e}, \
             added to what rasterizers are allowed against rays"
        )
    }
}

impl ApproximateArgs {
    /// Whether it is asked for.
    pub fn is_asked(&self) -> bool {
        self.tolerance.is_some()
    }

    /// What is drawn in a model's place, where another one is.
    ///
    /// # Errors
    /// Where a surface cannot be brought within the distance; which one.
    pub fn drawn(&self, model: &Model, camera: &Camera, viewport: Viewport) -> Result<Option<Approximated>> {
        let tolerance = match self.tolerance {
            None => return Ok(None),
            Some(Tolerance::Units(units)) => units,
            Some(Tolerance::Pixels(pixels)) => pixels * camera.pixel_at(viewport, model.hull()),
        };
        approximated(model, tolerance).map(Some)
    }
}

/// A model by bicubic patches within a distance, model units.
///
/// # Errors
/// Where a surface cannot be brought within it; which one.
pub fn approximated(model: &Model, tolerance: f64) -> Result<Approximated> {
    let of_surface =
        |(index, surface): (usize, &Surface)| surface.bicubic(tolerance).with_context(|| format!("surface {index}"));
    let found: Vec<BicubicSurface> = model.surfaces().par_iter().enumerate().map(of_surface).collect::<Result<_>>()?;
    let columns = |surface: &Surface| surface.knots(Direction::V).spans().count();
    let pieces = |(surface, BicubicSurface { spans: [us, vs], .. }): (&Surface, &BicubicSurface)| {
        let columns = columns(surface);
        us.iter().flat_map(|k| vs.iter().map(move |l| k * columns + l)).collect::<Vec<usize>>()
    };
    let pieces: Vec<Vec<usize>> = model.surfaces().iter().zip(&found).map(pieces).collect();
    let counts: Vec<usize> =
        model.surfaces().iter().map(|surface| surface.knots(Direction::U).spans().count() * columns(surface)).collect();
    let error: Vec<f64> = found.iter().map(|found| found.error).collect();
    let facts = Approximation {
        tolerance,
        bound: error.iter().copied().fold(0.0, f64::max),
        patches: counts.iter().sum(),
        bicubic_patches: pieces.iter().map(Vec::len).sum(),
    };
    let surfaces = model.faces().iter().map(|face| face.surface).collect();
    let drawn = model.with_surfaces(found.into_iter().map(|found| found.surface).collect());
    Ok(Approximated { model: drawn, stand_in: StandIn { error, pieces, counts, surfaces }, facts })
}

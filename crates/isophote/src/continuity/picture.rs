//! The model with its edges by class: isophotes beside zebra stripes, as a camera that frames it sees them.

use crate::overlay::Overlay;
use anyhow::Result;
use continuity::Report;
use gbuffer::{Picture, ShadeKind, Shading};
use scene::{Camera, Model, SamplePattern, Viewport};
use suite::stage::{Plan, Stage};

/// Pixels of each of the two.
const SIZE: [usize; 2] = [800, 640];

/// Both pictures side by side, each the mean of four samples a pixel, by the CPU rasterizer.
///
/// # Errors
/// Where the model cannot be packed for it.
pub fn pair(report: &Report, model: &Model) -> Result<Picture> {
    let [width, height] = SIZE;
    let viewport = Viewport::new(width, height)?;
    let overlay = Overlay::of(report);
    let stage = Stage::new(model, Camera::framing(model, viewport), viewport, Plan::default())?;
    let mut pictures = [vec![], vec![]];
    for sample in stage.samples(SamplePattern::Four) {
        let buffer = sample.raster();
        for (kind, samples) in [ShadeKind::Isophotes, ShadeKind::Zebra].into_iter().zip(&mut pictures) {
            let picture = buffer.shaded(&Shading::new(kind), model, &sample.camera)?;
            samples.push(overlay.drawn(&picture, &buffer, &sample.camera)?);
        }
    }
    let [isophotes, zebra] = [Picture::average(&pictures[0])?, Picture::average(&pictures[1])?];
    Ok(Picture::beside(&[&isophotes, &zebra]))
}

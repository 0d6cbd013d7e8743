//! Frames of a turning model, timed.

use anyhow::{Context, Result};
use gbuffer::{ShadeKind, Shading};
use glam::{DQuat, DVec3};
use isophote::stage::{Path, Plan};
use pipeline::{PackedScene, View};
use scene::{Camera, Model, Viewport};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;
use techniques::{DEFAULT_CHORD_PX, Limits, Prepared, Setting, Technique};

/// Cameras around a model: the frames of a rotating object.
pub fn turning(model: &Model, viewport: Viewport, frames: usize, start: f64) -> Vec<Camera> {
    let framing = Camera::framing(model, viewport);
    let center = model.hull().center();
    let turn = |i: usize| DQuat::from_rotation_z(start + i as f64 * std::f64::consts::TAU / frames as f64);
    (0..frames)
        .map(|i| {
            let eye = center + turn(i) * (framing.eye() - center);
            Camera::look_at(eye, center, DVec3::Z, framing.projection()).expect("a turned camera is as legal")
        })
        .collect()
}

/// The frames of a turning model, by one technique.
pub struct Frames<'a> {
    model: &'a Model,
    technique: &'static dyn Technique,
    scene: PackedScene,
    prepared: Arc<dyn Prepared>,
    path: Path,
    cameras: &'a [Camera],
    views: Vec<Vec<View>>,
    viewport: Viewport,
}

impl<'a> Frames<'a> {
    /// Frames of a model tessellated into `cells` × `cells` cells a face, or else to the chord error that all commands use.
    ///
    /// # Errors
    /// Where it cannot be packed or tessellated.
    pub fn new(
        model: &'a Model,
        plan: Plan,
        cells: Option<usize>,
        cameras: &'a [Camera],
        viewport: Viewport,
    ) -> Result<Self> {
        let Plan { technique, scheme, path, .. } = plan;
        let scene = PackedScene::new(model, scheme)?;
        let camera = cameras.first().context("a round has frames")?;
        let uniform = cells.map(|cells| technique.uniform(model, &scene, cells)).transpose()?.flatten();
        let prepared = match uniform {
            Some(uniform) => uniform,
            None => {
                let limits = Limits::default();
                technique.prepare(&Setting {
                    model,
                    scene: &scene,
                    camera,
                    viewport,
                    chord_px: DEFAULT_CHORD_PX,
                    limits,
                    vertex_normals: false,
                })?
            }
        };
        let views = cameras.iter().map(|camera| scene.views(model, camera, viewport)).collect();
        Ok(Self { model, technique, scene, prepared, path, cameras, views, viewport })
    }

    /// Frames a second of the rasterizer, which draws the first one alone.
    pub fn on_cpu(&self) -> f64 {
        let Self { scene, prepared, viewport, .. } = self;
        let (camera, views) = (&self.cameras[0], &self.views[0]);
        let options = raster::Options { curvature: false, vertex_normals: false };
        let meta = gbuffer::Meta::new("raster", self.technique.name(), self.model, camera);
        let start = Instant::now();
        let drawing = raster::Drawing { scene, views, camera, viewport: *viewport, options };
        black_box(raster::Rasterizer::new(drawing, prepared.visibility(drawing)).render(meta, &|_| {}));
        1.0 / start.elapsed().as_secs_f64()
    }

    /// Frames a second of the GPU, shaded on it.
    ///
    /// # Errors
    /// Where the GPU fails.
    pub fn on_gpu(&self, device: &gpu::Device) -> Result<f64> {
        let mut renderer = self.path.renderer(device, &self.scene, &self.prepared, gpu::RendererOptions::default())?;
        let size = self.model.hull().diagonal();
        let shading = Shading::new(ShadeKind::Isophotes).uniform(&self.cameras[0], size);
        Ok(renderer.time_shaded(&self.views, &shading, self.viewport)?.frames_per_second())
    }
}

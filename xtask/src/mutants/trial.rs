//! The trial of a program on the scenes: drawn by the GPU, judged as any other rendering.

use super::scenes::Shown;
use crate::stage::Stage;
use anyhow::{Context, Result, bail};
use compare::Verdict;
use gbuffer::{GBuffer, Shading};
use pipeline::Proxy;
use pipeline::wgsl::{self, Variant};
use raycast::Caster;
use serde::{Deserialize, Serialize};
use std::cell::Cell;

/// How a mutant was caught.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Catch {
    /// On which scene.
    pub scene: String,
    /// The main cause that the comparison named, or what else gave it away.
    pub cause: String,
    /// The worst pixel in words.
    pub detail: String,
}

/// What a program did on one scene.
pub enum Shot {
    /// The scene's programs do not hold the change.
    Untouched,
    /// All that was drawn agrees.
    Agrees,
    /// Something differs.
    Caught(Catch),
}

/// A scene with the reference that it is judged by.
pub struct Trial<'s> {
    shown: &'s Shown,
    stage: Stage<'s>,
    caster: Caster<'s>,
    reference: GBuffer,
}

impl<'s> Trial<'s> {
    /// Renders the reference.
    ///
    /// # Errors
    /// Where the scene cannot be drawn.
    pub fn new(shown: &'s Shown) -> Result<Self> {
        let mut stage = Stage::new(&shown.model, shown.camera, shown.viewport, shown.plan)?;
        if let Some(cells) = shown.cells {
            stage.proxy = Proxy::uniform(&shown.model, &stage.scene, cells)?;
        }
        let caster = Caster::new(&shown.model);
        let reference = if shown.vertex_normals {
            let options = raster::Options { curvature: false, interpolated_normals: true };
            let buffer = stage.rasterizer(options).render(stage.meta("raster"), &|_| {});
            if buffer.covered() < shown.viewport.pixels() {
                bail!("{}: the surface does not fill the picture", shown.name);
            }
            buffer
        } else {
            stage.raycast(&caster)
        };
        Ok(Self { shown, stage, caster, reference })
    }

    /// Draws with the programs that `source` makes, and judges them. A GPU that refuses or fails is a catch too; the
    /// device should not be used again then.
    ///
    /// # Errors
    /// Where the answer cannot be judged.
    pub fn run(&self, device: &gpu::Device, source: &dyn Fn(Variant) -> String) -> Result<Shot> {
        let touched = Cell::new(false);
        let watched = |variant: Variant| {
            let text = source(variant);
            touched.set(touched.get() || text != wgsl::source(variant));
            text
        };
        let overrides = gpu::Overrides { source: Some(&watched), ..Default::default() };
        let caught = self.judged(device, overrides)?;
        Ok(match caught {
            Some(caught) => Shot::Caught(caught),
            None if touched.get() => Shot::Agrees,
            None => Shot::Untouched,
        })
    }

    fn judged(&self, device: &gpu::Device, overrides: gpu::Overrides) -> Result<Option<Catch>> {
        let shading = Shading::new(self.shown.shade);
        let caught =
            |cause: &str, detail: String| Catch { scene: self.shown.name.to_owned(), cause: cause.to_owned(), detail };
        let (gbuffer, picture) = if self.shown.vertex_normals {
            let options = gpu::RendererOptions { curvature: false, interpolated_normals: true, overrides };
            let size = self.shown.model.hull().diagonal();
            let uniform = shading.uniform(&self.stage.camera, size);
            let picture = gpu::Renderer::new(device, &self.stage.scene, &self.stage.proxy, options)
                .and_then(|mut renderer| renderer.shaded(&self.stage.views, &uniform, self.stage.viewport));
            match picture {
                Ok(picture) => (None, picture),
                Err(error) => return Ok(Some(caught(REFUSED, error.to_string()))),
            }
        } else {
            match self.stage.gpu(device, Some(&shading), overrides) {
                Ok(drawn) => (Some(drawn.gbuffer), drawn.shaded.context("a shading was asked for")?),
                Err(error) => return Ok(Some(caught(REFUSED, format!("{error:#}")))),
            }
        };
        if let Some(gbuffer) = &gbuffer {
            let pair = self.stage.against_raycast(&self.caster, &self.reference, gbuffer)?;
            if pair.verdict != Verdict::Agree {
                let cause = pair.main_cause().map_or("none", |cause| cause.label());
                let worst = pair.worst.first().map_or(String::new(), |p| format!("({}, {}): {}", p.x, p.y, p.detail));
                return Ok(Some(caught(cause, worst)));
            }
        }
        let judged = self.stage.judge_shading(&shading, gbuffer.as_ref().unwrap_or(&self.reference), &picture)?;
        if judged.verdict != Verdict::Agree {
            let detail = format!("{} of {} pixels, first {:?}", judged.differ, judged.covered, judged.first);
            return Ok(Some(caught("shading", detail)));
        }
        Ok(None)
    }
}

/// The cause where the GPU returns an error in place of a picture.
pub const REFUSED: &str = "refused";

//! The pictures of a stage against each other, and against rays.

use super::drawn::{Original, Rendered, Stage};
use crate::progress::progress;
use anyhow::Result;
use compare::{Deviation, Judge, PairReport, PixelVerdict, Sampler};
use gbuffer::{GBuffer, Hit, Meta};
use raster::PointSampler;
use raycast::{Cast, Caster};
use scene::{Camera, Viewport};

/// The ray caster, asked at any position.
pub struct Rays<'a> {
    /// It.
    pub caster: &'a Caster<'a>,
    /// Who looks.
    pub camera: Camera,
    /// At how many pixels.
    pub viewport: Viewport,
}

impl Rays<'_> {
    /// The ray of pixel `at` alone: what it meets, and a G-buffer, of these facts, that holds nothing else.
    pub fn alone(&self, [x, y]: [usize; 2], meta: Meta) -> (Cast, GBuffer) {
        let Self { caster, camera, viewport } = self;
        let cast = caster.first(&camera.ray(*viewport, x as f64 + 0.5, y as f64 + 0.5));
        let row = |row| (0..viewport.width()).map(|column| cast.hit.filter(|_| [column, row] == [x, y])).collect();
        let buffer = GBuffer::from_rows(*viewport, meta, (0..viewport.height()).map(row));
        (cast, buffer.with_undecided(cast.undecided.map(|_| (x, y))))
    }
}

impl Sampler for Rays<'_> {
    fn first(&self, x: f64, y: f64) -> Option<Hit> {
        self.caster.first(&self.camera.ray(self.viewport, x, y)).hit
    }

    fn layers(&self, x: f64, y: f64) -> Vec<Hit> {
        self.caster.all(&self.camera.ray(self.viewport, x, y)).hits
    }
}

/// The CPU rasterizer, asked at any position.
struct Triangles<'a>(PointSampler<'a>);

impl Sampler for Triangles<'_> {
    fn first(&self, x: f64, y: f64) -> Option<Hit> {
        self.0.sample(x, y)
    }

    fn layers(&self, x: f64, y: f64) -> Vec<Hit> {
        self.0.layers(x, y)
    }
}

impl Stage<'_> {
    /// Compares all pairs.
    ///
    /// # Errors
    /// Where two buffers cannot be compared.
    pub fn compare(&self, caster: &Caster, rendered: &Rendered) -> Result<Vec<PairReport>> {
        let mut pairs = vec![self.against_raycast(caster, &rendered.raycast, &rendered.raster)?];
        if let Ok(gpu) = &rendered.gpu {
            pairs.push(self.against_raycast_on(caster, &rendered.raycast, &gpu.gbuffer, gpu.moves_px)?);
            pairs.push(self.against_raster_on(&rendered.raster, &gpu.gbuffer, gpu.moves_px)?);
        }
        Ok(pairs)
    }

    /// A rasterized buffer against the ray caster.
    ///
    /// # Errors
    /// Where the buffers cannot be compared.
    pub fn against_raycast(&self, caster: &Caster, reference: &GBuffer, candidate: &GBuffer) -> Result<PairReport> {
        self.against_raycast_on(caster, reference, candidate, None)
    }

    /// The same of an adapter whose rasterizer moves corners by `moves_px` along each side of a pixel, as was measured there.
    ///
    /// # Errors
    /// Where the buffers cannot be compared.
    pub fn against_raycast_on(
        &self,
        caster: &Caster,
        reference: &GBuffer,
        candidate: &GBuffer,
        moves_px: Option<f64>,
    ) -> Result<PairReport> {
        self.pair(reference, &self.rays(caster), candidate, true, moves_px)
    }

    /// The GPU's buffer against the CPU rasterizer's.
    ///
    /// # Errors
    /// Where the buffers cannot be compared.
    pub fn against_raster(&self, reference: &GBuffer, candidate: &GBuffer) -> Result<PairReport> {
        self.against_raster_on(reference, candidate, None)
    }

    /// The same of an adapter as of [`Self::against_raycast_on`].
    ///
    /// # Errors
    /// Where the buffers cannot be compared.
    pub fn against_raster_on(
        &self,
        reference: &GBuffer,
        candidate: &GBuffer,
        moves_px: Option<f64>,
    ) -> Result<PairReport> {
        let rasterizer = self.rasterizer(raster::Options { curvature: false, vertex_normals: false });
        self.pair(reference, &Triangles(rasterizer.sampler()), candidate, false, moves_px)
    }

    /// What each comparison says of pixel `at`, with the names of reference and candidate.
    ///
    /// # Errors
    /// Where two buffers cannot be compared.
    pub fn pixel(
        &self,
        caster: &Caster,
        rendered: &Rendered,
        at: [usize; 2],
    ) -> Result<Vec<(String, String, PixelVerdict)>> {
        let rays = self.rays(caster);
        let rasterizer = self.rasterizer(raster::Options { curvature: false, vertex_normals: false });
        let triangles = Triangles(rasterizer.sampler());
        let Rendered { raycast, raster, gpu } = rendered;
        let judged =
            |reference: &GBuffer, sampler: &dyn Sampler, candidate: &GBuffer, exact: bool, moves_px| -> Result<_> {
                let deviation = self.deviation(exact, moves_px);
                let verdict = self.judge(exact).pixel(reference, sampler, candidate, &deviation, exact, at)?;
                Ok((reference.meta().renderer.clone(), candidate.meta().renderer.clone(), verdict))
            };
        let mut verdicts = vec![judged(raycast, &rays, raster, true, None)?];
        if let Ok(gpu) = gpu {
            verdicts.push(judged(raycast, &rays, &gpu.gbuffer, true, gpu.moves_px)?);
            verdicts.push(judged(raster, &triangles, &gpu.gbuffer, false, gpu.moves_px)?);
        }
        Ok(verdicts)
    }

    /// What is said of pixel `at` of a rasterized buffer against the one ray that is cast there.
    ///
    /// # Errors
    /// Where the buffer is not of this stage.
    pub fn against_ray(&self, caster: &Caster, candidate: &GBuffer, at: [usize; 2]) -> Result<PixelVerdict> {
        let rays = self.rays(caster);
        let (_, reference) = rays.alone(at, self.meta("raycast"));
        Ok(self.judge(true).pixel(&reference, &rays, candidate, &self.deviation(true, None), true, at)?)
    }

    fn rays<'a>(&self, caster: &'a Caster<'a>) -> Rays<'a> {
        Rays { caster, camera: self.camera, viewport: self.viewport }
    }

    /// Of pictures against the surface itself, or of two renderers of the same triangles.
    fn judge(&self, exact: bool) -> Judge<'_> {
        let judge = match self.original.as_ref().filter(|_| exact) {
            None => Judge::new(self.model, &self.camera, self.viewport, &self.scene),
            Some(Original { model, scene, .. }) => {
                Judge::new(model, &self.camera, self.viewport, scene).of_drawn(self.model, &self.scene)
            }
        };
        judge.with_unbounded_share(self.plan.unbounded_share)
    }

    /// The allowance against the surface itself, or between two renderers of the same triangles; `moves_px` is what was measured of
    /// the candidate's adapter.
    fn deviation(&self, exact: bool, moves_px: Option<f64>) -> Deviation {
        let (claims, chord, asked_px) = (self.plan.technique.claims(), self.prepared.chord(), self.plan.chord_px);
        let deviation = if exact {
            Deviation::against_surface(claims, &self.interpolation, chord, asked_px)
        } else {
            Deviation::between_twins(claims, &self.interpolation, chord, asked_px)
        };
        let deviation = match moves_px {
            None => deviation,
            Some(moves_px) => deviation.on_grid(moves_px),
        };
        let deviation = match &self.vertex_normals {
            None => deviation,
            Some(normals) => deviation.with_vertex_normals(normals.clone()),
        };
        let deviation = match self.original.as_ref().filter(|_| exact) {
            None => deviation.meeting(self.prepared.seams()),
            Some(original) => deviation.of_stand_in(original.stand_in),
        };
        match &self.scene.masks() {
            None => deviation,
            Some(masks) => {
                let text = format!("{}; trim edges: masks within {:.3} px", deviation.text, masks.plan.error_px());
                Deviation { text, ..deviation }
            }
        }
    }

    fn pair(
        &self,
        reference: &GBuffer,
        sampler: &dyn Sampler,
        candidate: &GBuffer,
        exact: bool,
        moves_px: Option<f64>,
    ) -> Result<PairReport> {
        let what = format!("{} | {}", reference.meta().renderer, candidate.meta().renderer);
        let bar = progress(&what, self.viewport.height());
        let deviation = self.deviation(exact, moves_px);
        Ok(self.judge(exact).pair(reference, sampler, candidate, &deviation, exact, &|rows| bar.inc(rows as u64))?)
    }
}

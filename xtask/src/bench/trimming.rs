//! What trimming costs: against the same faces whole, and to set up.

use super::frames::{Frames, turning};
use super::sample::Sample;
use anyhow::Result;
use isophote::stage::Plan;
use pipeline::PackedScene;
use scene::{Face, Model, Viewport};
use std::hint::black_box;
use std::time::Instant;
use techniques::Technique;

/// A model whose faces have 50 trim curves each.
const MODEL: &str = "pieces";

/// Faces that are set up: 7,500 curves.
const FACES: usize = 150;

/// The measurements, round by round.
pub struct Trimming {
    trimmed: Model,
    whole: Model,
    many: Vec<Face>,
    /// Of each technique, on the CPU and on the GPU.
    costs: Vec<(&'static dyn Technique, [Sample; 2])>,
    setup: Sample,
}

impl Trimming {
    /// Nothing measured yet.
    ///
    /// # Errors
    /// Where the model's surfaces make no model.
    pub fn new(side: usize) -> Result<Self> {
        let trimmed = models::builtin(MODEL).expect("built in");
        let whole = Model::of_surfaces(format!("{MODEL}, whole"), trimmed.surfaces().to_vec())?;
        let many = trimmed.faces().iter().cycle().take(FACES).cloned().collect();
        let cost = |technique: &'static dyn Technique| {
            let sample = |renderer| {
                let what = format!("exact trims, {renderer}, {MODEL} {side}x{side}, {}", technique.name());
                Sample::new(what, "× the same untrimmed", "≤ 1.5".to_owned())
            };
            (technique, ["raster", "gpu"].map(sample))
        };
        let what = format!("setting up {FACES} faces with {} trim curves", 50 * FACES);
        let setup = Sample::new(what, "ms", "≤ 100".to_owned());
        Ok(Self { trimmed, whole, many, costs: techniques::ALL.iter().copied().map(cost).collect(), setup })
    }

    /// One round: trimmed and whole by turns.
    ///
    /// # Errors
    /// Where the GPU fails.
    pub fn measure(
        &mut self,
        device: Option<&gpu::Device>,
        plan: Plan,
        viewport: Viewport,
        frames: usize,
        start: f64,
    ) -> Result<()> {
        let cameras = turning(&self.trimmed, viewport, frames, start);
        for (technique, [raster, on_gpu]) in &mut self.costs {
            let of = |model| Frames::new(model, Plan { technique: *technique, ..plan }, None, &cameras, viewport);
            let [trimmed, whole] = [of(&self.trimmed)?, of(&self.whole)?];
            raster.values.push(whole.on_cpu() / trimmed.on_cpu());
            if let Some(device) = device {
                on_gpu.values.push(whole.on_gpu(device)? / trimmed.on_gpu(device)?);
            }
        }
        let (surfaces, faces) = (self.trimmed.surfaces().to_vec(), self.many.clone());
        let clock = Instant::now();
        let model = Model::new("many", surfaces, faces)?;
        let regions = clock.elapsed();
        let whole = Model::new(
            "whole",
            model.surfaces().to_vec(),
            model.faces().iter().map(|f| Face::whole(f.surface)).collect(),
        )?;
        let clock = Instant::now();
        black_box(PackedScene::new(&model, plan.scheme)?);
        let packed = clock.elapsed();
        let clock = Instant::now();
        black_box(PackedScene::new(&whole, plan.scheme)?);
        self.setup.values.push(1e3 * (regions + packed.saturating_sub(clock.elapsed())).as_secs_f64());
        Ok(())
    }

    /// All samples.
    pub fn samples(self) -> impl Iterator<Item = Sample> {
        self.costs.into_iter().flat_map(|(_, samples)| samples).chain([self.setup])
    }
}

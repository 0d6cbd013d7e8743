//! A model by a technique on a renderer, timed where renderers agree.

use crate::bench::agree::disagreement;
use crate::cost::{self, Cost, Patience};
use crate::stage::{Plan, Stage};
use scene::{Camera, Model, Viewport};
use serde::Serialize;
use std::collections::BTreeSet;
use std::time::Instant;
use techniques::Technique;

/// Milliseconds of a frame beyond which a technique is not tried on more patches of the same figure.
const SLOW_MS: f64 = 2000.0;

/// One figure's number.
#[derive(Debug, Clone, Serialize)]
pub struct Line {
    /// Which figure of which seed.
    pub figure: &'static str,
    /// What is drawn.
    pub model: String,
    /// Its Bézier patches.
    pub patches: usize,
    /// By which technique.
    pub technique: &'static str,
    /// By which renderer.
    pub renderer: &'static str,
    /// Error asked for, pixels.
    pub error_px: f64,
    /// Triangles drawn.
    pub triangles: Option<usize>,
    /// Packing, choosing levels and preparing, once, on the CPU.
    pub set_up_ms: Option<f64>,
    /// What a frame costs.
    pub cost: Option<Cost>,
    /// Why it was not timed.
    pub not_timed: Option<String>,
    /// What the paper says.
    pub reference: &'static str,
}

/// Heads of the columns of [`Line::cells`].
pub const HEADS: [&str; 11] = [
    "model",
    "patches",
    "technique",
    "renderer",
    "triangles",
    "set up, ms",
    "frames/s",
    "frame, ms",
    "device, ms",
    "processor, ms",
    "sent, bytes",
];

impl Line {
    /// As a row of the table.
    pub fn cells(&self) -> Vec<String> {
        let ms = |x: Option<f64>| x.map_or_else(|| "—".to_owned(), |x| format!("{x:.3}"));
        let cost = self.cost.as_ref();
        let rate = cost.map(|cost| format!("{:.1}", cost.frames_per_second()));
        vec![
            self.model.clone(),
            self.patches.to_string(),
            self.technique.to_owned(),
            self.renderer.to_owned(),
            self.triangles.map_or_else(|| "—".to_owned(), |n| n.to_string()),
            ms(self.set_up_ms),
            rate.unwrap_or_else(|| "not timed".to_owned()),
            ms(cost.map(|cost| cost.frame_ms)),
            ms(cost.and_then(|cost| cost.gpu_ms)),
            ms(cost.and_then(|cost| cost.processor_ms)),
            cost.and_then(|cost| cost.bytes_uploaded).map_or_else(|| "—".to_owned(), |bytes| bytes.to_string()),
        ]
    }
}

/// The measurements as they are made.
pub struct Measuring<'a> {
    plan: Plan,
    viewport: Viewport,
    device: Option<&'a gpu::Device>,
    patience: Patience,
    /// No model of more patches is drawn.
    most: usize,
    /// Models and techniques whose renderers agree.
    agreed: BTreeSet<(String, &'static str)>,
    disagreements: Vec<String>,
    lines: Vec<Line>,
}

impl<'a> Measuring<'a> {
    /// Nothing measured yet.
    pub fn new(
        plan: Plan,
        viewport: Viewport,
        device: Option<&'a gpu::Device>,
        patience: Patience,
        most: usize,
    ) -> Self {
        Self { plan, viewport, device, patience, most, agreed: BTreeSet::new(), disagreements: vec![], lines: vec![] }
    }

    /// What was measured, and which renderers disagree.
    pub fn done(self) -> (Vec<Line>, Vec<String>) {
        (self.lines, self.disagreements)
    }

    /// A built-in model by each technique, at the error asked for.
    pub fn model(
        &mut self,
        figure: &'static str,
        name: &str,
        patches: usize,
        techniques: &[&'static dyn Technique],
        reference: &'static str,
    ) {
        self.at_error(figure, name, patches, techniques, self.plan.chord_px, reference);
    }

    /// The same at another error.
    pub fn at_error(
        &mut self,
        figure: &'static str,
        name: &str,
        patches: usize,
        techniques: &[&'static dyn Technique],
        error_px: f64,
        reference: &'static str,
    ) {
        if patches > self.most {
            return;
        }
        let model = models::builtin(name).expect("built in");
        for &technique in techniques {
            let plan = Plan { technique, chord_px: error_px, ..self.plan };
            let line = |renderer| Line {
                figure,
                model: name.to_owned(),
                patches,
                technique: technique.name(),
                renderer,
                error_px,
                triangles: None,
                set_up_ms: None,
                cost: None,
                not_timed: None,
                reference,
            };
            let mut lines = ["raster", "gpu"].map(line);
            for line in &mut lines {
                line.not_timed = self.too_slow(line);
            }
            if lines.iter().any(|line| line.not_timed.is_none())
                && let Some(failure) = self.timed(&model, plan, &mut lines)
            {
                lines.iter_mut().filter(|line| line.cost.is_none()).for_each(|line| {
                    line.not_timed.get_or_insert_with(|| failure.clone());
                });
            }
            self.lines.extend(lines);
        }
    }

    /// Why a line need not be tried: one of the same figure with fewer patches took too long.
    fn too_slow(&self, line: &Line) -> Option<String> {
        let same = |other: &&Line| {
            (other.figure, other.technique, other.renderer) == (line.figure, line.technique, line.renderer)
        };
        let slow = self.lines.iter().filter(same).filter_map(|other| Some((other, other.cost.as_ref()?.frame_ms)));
        let slow = slow.into_iter().find(|(_, frame_ms)| *frame_ms > SLOW_MS);
        slow.map(|(other, frame_ms)| format!("not tried: {} took {:.1} s a frame", other.model, frame_ms / 1e3))
    }

    /// Fills in what can be timed; returns why the rest cannot.
    fn timed(&mut self, model: &Model, plan: Plan, lines: &mut [Line; 2]) -> Option<String> {
        let key = (model.name().to_owned(), plan.technique.name());
        if !self.agreed.contains(&key) {
            match disagreement(model, self.device, Plan { chord_px: self.plan.chord_px, ..plan }) {
                Ok(None) => self.agreed.insert(key),
                Ok(Some(text)) => {
                    self.disagreements.push(text.clone());
                    return Some(text);
                }
                Err(error) => return Some(format!("{error:#}")),
            };
        }
        let camera = Camera::framing(model, self.viewport);
        let clock = Instant::now();
        let stage = match Stage::new(model, camera, self.viewport, plan) {
            Ok(stage) => stage,
            Err(error) => return Some(format!("{error:#}")),
        };
        let set_up_ms = 1e3 * clock.elapsed().as_secs_f64();
        let [raster, on_gpu] = lines;
        for line in [&mut *raster, &mut *on_gpu] {
            line.triangles = Some(stage.prepared.triangles());
            line.set_up_ms = Some(set_up_ms);
        }
        if raster.not_timed.is_none() {
            raster.cost = Some(cost::on_cpu(&stage, self.patience));
        }
        match self.device {
            None => on_gpu.not_timed = Some("gpu not run".to_owned()),
            Some(device) if on_gpu.not_timed.is_none() => match cost::on_gpu(&stage, device, self.patience) {
                Ok(cost) => on_gpu.cost = Some(cost),
                Err(error) => return Some(format!("{error:#}")),
            },
            Some(_) => {}
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_too_slow_is_not_tried_on_more_patches() {
        let viewport = Viewport::new(32, 32).unwrap();
        let patience = Patience { frames: 3, seconds: 1e-3 };
        let mut measuring = Measuring::new(Plan::default(), viewport, None, patience, 100);
        let line = |technique, renderer, frame_ms: Option<f64>| Line {
            figure: "a figure",
            model: "quilt-100".to_owned(),
            patches: 100,
            technique,
            renderer,
            error_px: 0.5,
            triangles: None,
            set_up_ms: None,
            cost: frame_ms.map(|frame_ms| Cost {
                frames: 3,
                frame_ms,
                gpu_ms: None,
                processor_ms: None,
                bytes_uploaded: None,
                bytes_held: None,
            }),
            not_timed: None,
            reference: "",
        };
        measuring.lines = vec![line("exact", "gpu", Some(2500.0)), line("exact", "raster", Some(1500.0))];
        let why = measuring.too_slow(&line("exact", "gpu", None));
        assert_eq!(why.as_deref(), Some("not tried: quilt-100 took 2.5 s a frame"));
        assert_eq!(measuring.too_slow(&line("exact", "raster", None)), None);
        assert_eq!(measuring.too_slow(&line("grid", "gpu", None)), None);
        // Nor is a model of more patches than were allowed.
        measuring.model("a figure", "quilt-300", 300, techniques::ALL, "");
        assert_eq!(measuring.done().0.len(), 2);
    }
}

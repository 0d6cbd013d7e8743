//! A model by a technique on a renderer, timed where renderers agree.

use crate::bench::agree::disagreement;
use isophote::cost::{self, Cost, Patience};
use isophote::stage::{Plan, Stage};
use scene::{Camera, Model, Viewport};
use serde::Serialize;
use std::time::Instant;
use techniques::{GREATEST_LEVEL, Technique};

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
    /// log₂ of the cells along a side of a patch at most, where it has a grid.
    pub level: u32,
    /// Patches that a step of technique `zones` draws; absent where its zones end a step.
    pub batch: Option<u32>,
    /// Whether normals are those of the triangles' corners.
    pub vertex_normals: bool,
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
pub const HEADS: [&str; 12] = [
    "model",
    "patches",
    "asked for",
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
    /// What was asked for, in words.
    fn asked(&self) -> String {
        let mut asked = format!("{} px", self.error_px);
        if self.level < GREATEST_LEVEL {
            asked += &format!(", cells ≤ {0}x{0}", 1u32 << self.level);
        }
        if let Some(batch) = self.batch {
            asked += &format!(", {batch} a step");
        }
        if self.vertex_normals {
            asked += ", vertex normals";
        }
        asked
    }

    /// As a row of the table.
    pub fn cells(&self) -> Vec<String> {
        let ms = |x: Option<f64>| x.map_or_else(|| "—".to_owned(), |x| format!("{x:.3}"));
        let cost = self.cost.as_ref();
        let rate = cost.map(|cost| format!("{:.1}", cost.frames_per_second()));
        vec![
            self.model.clone(),
            self.patches.to_string(),
            self.asked(),
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
    /// Whether a model with so many patches is drawn.
    is_asked: &'a dyn Fn(&str, usize) -> bool,
    /// Models whose renderers agree, and how they are drawn.
    agreed: Vec<(String, Plan)>,
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
        is_asked: &'a dyn Fn(&str, usize) -> bool,
    ) -> Self {
        Self { plan, viewport, device, patience, is_asked, agreed: vec![], disagreements: vec![], lines: vec![] }
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
        self.drawn(figure, name, patches, techniques, self.plan, reference);
    }

    /// The same drawn in another way, by each technique in turn. Steps of so many patches are the GPU's alone.
    pub fn drawn(
        &mut self,
        figure: &'static str,
        name: &str,
        patches: usize,
        techniques: &[&'static dyn Technique],
        plan: Plan,
        reference: &'static str,
    ) {
        if !(self.is_asked)(name, patches) {
            return;
        }
        let model = models::builtin(name).expect("built in");
        for &technique in techniques {
            let plan = Plan { technique, ..plan };
            let line = |renderer| Line {
                figure,
                model: name.to_owned(),
                patches,
                technique: technique.name(),
                renderer,
                error_px: plan.chord_px,
                level: plan.limits.level,
                batch: plan.limits.batch,
                vertex_normals: plan.vertex_normals,
                triangles: None,
                set_up_ms: None,
                cost: None,
                not_timed: None,
                reference,
            };
            let renderers: &[_] = if plan.limits.batch.is_some() { &["gpu"] } else { &["raster", "gpu"] };
            let mut lines: Vec<Line> = renderers.iter().copied().map(line).collect();
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
    fn timed(&mut self, model: &Model, plan: Plan, lines: &mut [Line]) -> Option<String> {
        let key = (model.name().to_owned(), Plan { chord_px: self.plan.chord_px, ..plan });
        if !self.agreed.contains(&key) {
            match disagreement(model, self.device, key.1) {
                Ok(None) => self.agreed.push(key),
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
        for line in lines {
            line.triangles = Some(stage.prepared.triangles());
            line.set_up_ms = Some(set_up_ms);
            match (line.renderer, self.device) {
                ("gpu", None) => line.not_timed = Some("gpu not run".to_owned()),
                _ if line.not_timed.is_some() => {}
                ("gpu", Some(device)) => match cost::on_gpu(&stage, device, self.patience) {
                    Ok(cost) => line.cost = Some(cost),
                    Err(error) => return Some(format!("{error:#}")),
                },
                _ => line.cost = Some(cost::on_cpu(&stage, self.patience)),
            }
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
        let mut measuring = Measuring::new(Plan::default(), viewport, None, patience, &|_, patches| patches <= 100);
        let line = |technique, renderer, frame_ms: Option<f64>| Line {
            figure: "a figure",
            model: "quilt-100".to_owned(),
            patches: 100,
            technique,
            renderer,
            error_px: 0.5,
            level: GREATEST_LEVEL,
            batch: None,
            vertex_normals: false,
            triangles: None,
            set_up_ms: None,
            cost: frame_ms.map(|frame_ms| Cost {
                frames: 3,
                frame_ms,
                gpu_ms: None,
                parts_ms: vec![],
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

//! A case that differs, made as small as it still differs, and written as a report of it needs it.
//!
//! First the picture becomes smaller: the same camera with fewer pixels. Then faces fall away, half of them at a time and at last
//! one at a time, and with them the surfaces that nobody shows. Then loops fall away, surfaces are cut down to a part of their spans,
//! and with them their control points. At last the program loses what nothing in it uses. Each step is judged anew.

use super::wording::{Opened, Wording, Wrong};
use crate::legal::Judged;
use anyhow::{Context, Result};
use isophote::capsule::recorded;
use isophote::conform::corpus::command_options;
use isophote::output;
use isophote::stage::{Plan, Stage};
use nurbs::{Direction, Surface};
use raycast::Caster;
use scene::{Camera, Face, Model, Viewport};
use std::collections::BTreeSet;
use std::path::Path;

/// Sides of pictures that are tried, pixels.
const SIDES: [usize; 6] = [1, 2, 3, 4, 6, 8];

/// What is drawn.
struct Case {
    model: Model,
    camera: Camera,
    viewport: Viewport,
    plan: Plan,
}

impl Case {
    /// What is wrong with it; what cannot be drawn does not differ.
    fn wrong(&self, wording: Wording, host: &Opened) -> Option<Wrong> {
        let stage = Stage::new(&self.model, self.camera, self.viewport, self.plan).ok()?;
        let caster = Caster::new(&self.model);
        wording.wrong(&Judged::new(&stage, &caster), host).ok().flatten()
    }

    fn with_faces(&self, kept: &[Face]) -> Option<Self> {
        let used: BTreeSet<usize> = kept.iter().map(|face| face.surface).collect();
        let surfaces = used.iter().map(|&surface| self.model.surfaces()[surface].clone()).collect();
        let place = |face: &Face| used.range(..face.surface).count();
        let faces = kept.iter().map(|face| Face { surface: place(face), ..face.clone() }).collect();
        let model = Model::new(self.model.name(), surfaces, faces).ok()?;
        Some(Self { model, ..*self })
    }

    fn with_part(&self, surface: usize, direction: Direction, range: [f64; 2]) -> Option<Self> {
        let mut surfaces = self.model.surfaces().to_vec();
        surfaces[surface] = surfaces[surface].restricted(direction, range).ok()?;
        let model = Model::new(self.model.name(), surfaces, self.model.faces().to_vec()).ok()?;
        Some(Self { model, ..*self })
    }
}

/// A case that differs, and what is wrong with it.
struct Reduction<'h> {
    case: Case,
    wrong: Wrong,
    wording: Wording,
    host: &'h Opened,
}

impl Reduction<'_> {
    /// Takes another case where that differs, too; whether it does.
    fn take(&mut self, other: Option<Case>) -> bool {
        let found = other.and_then(|other| Some((other.wrong(self.wording, self.host)?, other)));
        let is_taken = found.is_some();
        if let Some((wrong, case)) = found {
            (self.case, self.wrong) = (case, wrong);
        }
        is_taken
    }

    fn fewer_pixels(&mut self) -> Result<()> {
        for side in SIDES {
            let viewport = Viewport::new(side, side)?;
            if self.take(Some(Case { viewport, model: self.case.model.clone(), ..self.case })) {
                break;
            }
        }
        Ok(())
    }

    fn fewer_faces(&mut self) {
        let mut part = self.case.model.faces().len() / 2;
        while part > 0 {
            let mut start = 0;
            while start < self.case.model.faces().len() && self.case.model.faces().len() > 1 {
                let faces = self.case.model.faces();
                let kept = [&faces[..start], &faces[(start + part).min(faces.len())..]].concat();
                if !self.take(self.case.with_faces(&kept)) {
                    start += part;
                }
            }
            part /= 2;
        }
    }

    fn fewer_loops(&mut self) {
        for face in 0..self.case.model.faces().len() {
            let mut index = 0;
            while index < self.case.model.faces()[face].loops.len() {
                let mut faces = self.case.model.faces().to_vec();
                faces[face].loops.remove(index);
                if !self.take(self.case.with_faces(&faces)) {
                    index += 1;
                }
            }
        }
    }

    /// Cuts surfaces down to one half of their spans, again and again.
    fn fewer_spans(&mut self) {
        for surface in 0..self.case.model.surfaces().len() {
            for direction in [Direction::U, Direction::V] {
                while let Some(halves) = halves(&self.case.model.surfaces()[surface], direction) {
                    let [first, last] = halves.map(|range| self.case.with_part(surface, direction, range));
                    if !self.take(first) && !self.take(last) {
                        break;
                    }
                }
            }
        }
    }

    fn fewer_declarations(&mut self) {
        let lean = Wording { is_lean: true, ..self.wording };
        if let Some(wrong) = self.case.wrong(lean, self.host) {
            (self.wording, self.wrong) = (lean, wrong);
        }
    }
}

/// The two halves of a surface's spans; `None` where it has one.
fn halves(surface: &Surface, direction: Direction) -> Option<[[f64; 2]; 2]> {
    let knots = surface.knots(direction);
    let starts: Vec<f64> = knots.spans().map(|span| knots.knots()[span]).collect();
    let (start, end) = knots.domain();
    let middle = *starts.get(starts.len() / 2).filter(|_| starts.len() > 1)?;
    Some([[start, middle], [middle, end]])
}

/// Reduces a stage that differs in these words, and writes it into a folder: `model.json`, a program a file, `README.md`, and by a GPU
/// the folder `capsule`, which other hosts play.
///
/// # Errors
/// Where it does not differ any more, or something cannot be written.
pub fn write(folder: &Path, stage: &Stage, wording: Wording, host: &Opened) -> Result<()> {
    let Stage { camera, viewport, plan, .. } = *stage;
    let case = Case { model: stage.model.clone(), camera, viewport, plan };
    let wrong = case.wrong(wording, host).context("drawn again it does not differ")?;
    let mut reduction = Reduction { case, wrong, wording, host };
    reduction.fewer_pixels()?;
    reduction.fewer_faces();
    reduction.fewer_loops();
    reduction.fewer_spans();
    reduction.fewer_declarations();
    written(folder, &reduction)
}

fn written(folder: &Path, Reduction { case, wrong, wording, host }: &Reduction) -> Result<()> {
    output::folder(folder)?;
    let file = |name: &str, text: String| std::fs::write(folder.join(name), text).with_context(|| name.to_owned());
    file("model.json", formats::json::write(&case.model)?)?;
    for (i, program) in wrong.programs.iter().enumerate() {
        file(&format!("program-{i}.wgsl"), program.clone())?;
    }
    if let Opened::Gpu(device) = host {
        let stage = Stage::new(&case.model, case.camera, case.viewport, case.plan)?;
        let source = |variant| wording.program(variant, host);
        let overrides = gpu::Overrides { source: Some(&source), ..Default::default() };
        recorded(&stage, Some(&device.info().name), overrides)?.0.write(&folder.join("capsule"))?;
    }
    let (why, count) = (&wrong.why, wrong.programs.len());
    let host = match host {
        Opened::Gpu(device) => format!("{} ({})", device.info().name, device.info().driver_info),
        Opened::Machine => "the machine of `cargo xtask legal`, strict".to_owned(),
    };
    let options = command_options(&case.camera, case.viewport, case.plan);
    let Wording { seed, fault, .. } = *wording;
    let planted = fault.map_or(String::new(), |fault| format!("\nThe fault `{fault:?}` was put into it on purpose.\n"));
    file(
        "README.md",
        format!(
            "# A program in other words gives another picture\n\n\
             Drawn by {host}, with the WGSL of seed {seed}, one of {count} program(s) a file: `program-N.wgsl`.\n{planted}\n\
             What differs: {why}\n\n\
             The same picture by the program in its own words:\n\n\
             ```sh\nisophote compare model.json {options}\n```\n"
        ),
    )
}

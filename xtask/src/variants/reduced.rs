//! A case that differs, made as small as it still differs, and written as a report of it needs it.
//!
//! First the picture becomes smaller: the same camera with fewer pixels. Then faces fall away, half of them at a time and at last
//! one at a time, and with them the surfaces that nobody shows. Each step is judged anew.

use super::wording::{Opened, Wording, Wrong};
use crate::legal::Judged;
use anyhow::{Context, Result};
use isophote::conform::corpus::command_options;
use isophote::output;
use isophote::stage::{Plan, Stage};
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
}

/// Reduces a stage that differs in these words, and writes it into a folder: `model.json`, a program a file, `README.md`.
///
/// # Errors
/// Where it does not differ any more, or something cannot be written.
pub fn write(folder: &Path, stage: &Stage, wording: Wording, host: &Opened) -> Result<()> {
    let Stage { camera, viewport, plan, .. } = *stage;
    let mut case = Case { model: stage.model.clone(), camera, viewport, plan };
    let mut wrong = case.wrong(wording, host).context("drawn again it does not differ")?;
    for side in SIDES {
        let smaller = Case { viewport: Viewport::new(side, side)?, model: case.model.clone(), ..case };
        if let Some(found) = smaller.wrong(wording, host) {
            (case, wrong) = (smaller, found);
            break;
        }
    }
    let mut part = case.model.faces().len() / 2;
    while part > 0 {
        let mut start = 0;
        while start < case.model.faces().len() && case.model.faces().len() > 1 {
            let faces = case.model.faces();
            let kept = [&faces[..start], &faces[(start + part).min(faces.len())..]].concat();
            let fewer = case.with_faces(&kept);
            match fewer.and_then(|fewer| Some((fewer.wrong(wording, host)?, fewer))) {
                Some((found, fewer)) => (case, wrong) = (fewer, found),
                None => start += part,
            }
        }
        part /= 2;
    }
    written(folder, &case, wording, host, &wrong)
}

fn written(folder: &Path, case: &Case, wording: Wording, host: &Opened, wrong: &Wrong) -> Result<()> {
    output::folder(folder)?;
    let file = |name: &str, text: String| std::fs::write(folder.join(name), text).with_context(|| name.to_owned());
    file("model.json", formats::json::write(&case.model)?)?;
    for (i, program) in wrong.programs.iter().enumerate() {
        file(&format!("program-{i}.wgsl"), program.clone())?;
    }
    let (why, count) = (&wrong.why, wrong.programs.len());
    let host = match host {
        Opened::Gpu(device) => format!("{} ({})", device.info().name, device.info().driver_info),
        Opened::Machine => "the machine of `cargo xtask legal`, strict".to_owned(),
    };
    let options = command_options(&case.camera, case.viewport, case.plan);
    let Wording { seed, fault } = wording;
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

//! A case that differs, made as small as it still differs, and written as a report of it needs it.
//!
//! First the picture becomes smaller: the same camera with fewer pixels. Then faces fall away, half of them at a time and at last
//! one at a time, and with them the surfaces that nobody shows. Then loops fall away, surfaces are cut down to a part of their spans,
//! and with them their control points. At last the program loses what nothing in it uses. Each step is judged anew.
//!
//! Then functions lose statements ([`bodies`](super::bodies)). A program that does less gives another picture by right, so the judge has
//! nothing to say there. It is drawn twice, in its own words and in the others: these mean the same, and still come out far apart.

use super::bodies::shrunk;
use super::variant;
use super::wording::{Opened, Wording, Wrong};
use crate::legal::Judged;
use crate::mutants::capped::capped;
use anyhow::{Context, Result};
use gbuffer::{GBuffer, Hit};
use isophote::capsule::recorded;
use isophote::conform::corpus::command_options;
use isophote::output;
use isophote::stage::{Plan, Stage};
use nurbs::{Direction, Surface};
use pipeline::wgsl::{self, Variant};
use raycast::Caster;
use scene::{Camera, Face, Model, Viewport};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Sides of pictures that are tried, pixels.
const SIDES: [usize; 6] = [1, 2, 3, 4, 6, 8];

/// A picture's numbers that are farther apart than this share of the model's size, or of a number's own, are so by no rounding.
const APART: f64 = 1.0 / 1024.0;

/// Programs that do less, by their whole text.
type Bodies = BTreeMap<String, String>;

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
    bodies: Bodies,
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

/// A program as it is after reduction: in its own words, and in the others that mean the same.
struct Pair {
    right: String,
    other: String,
}

impl Pair {
    /// By the seed of a wording, or with its fault alone where `is_plain`.
    fn new(body: &str, wording: Wording, host: &Opened, is_plain: bool) -> Self {
        let faulty = wording.fault.map_or(body.to_owned(), |fault| fault.put(body));
        let is_plain = is_plain && wording.fault.is_some();
        let other = if is_plain { faulty } else { variant::variant(&faulty, wording.seed, host.called()) };
        Self { right: body.to_owned(), other: variant::lean(&other, host.called()) }
    }
}

impl Reduction<'_> {
    /// Takes statements out of the programs.
    fn fewer_statements(&mut self) {
        let Ok(stage) = Stage::new(&self.case.model, self.case.camera, self.case.viewport, self.case.plan) else {
            return;
        };
        let sources = RefCell::new(BTreeSet::new());
        let source = |variant: Variant| {
            let whole = wgsl::source(variant);
            sources.borrow_mut().insert(whole.clone());
            whole
        };
        if self.host.draw(&stage, &source).is_err() {
            return;
        }
        let mut bodies = Bodies::new();
        for whole in sources.into_inner() {
            let small = shrunk(&whole, self.host.called(), &mut |candidate| {
                let tried = bodies.iter().map(|(whole, small)| (whole.clone(), small.clone()));
                let tried = tried.chain([(whole.clone(), candidate.to_owned())]).collect();
                self.is_apart(&stage, &tried, true)
            });
            bodies.insert(whole, small);
        }
        // In the words of the seed, too.
        if self.is_apart(&stage, &bodies, false) {
            self.bodies = bodies;
        }
    }

    /// Whether the programs that do less give pictures that are far apart, in their own words and in the others.
    fn is_apart(&self, stage: &Stage, bodies: &Bodies, is_plain: bool) -> bool {
        let drawn = |of: fn(Pair) -> String| {
            let source = |variant: Variant| {
                let whole = wgsl::source(variant);
                let body = bodies.get(&whole).unwrap_or(&whole);
                capped(&of(Pair::new(body, self.wording, self.host, is_plain)))
            };
            self.host.draw(stage, &source)
        };
        let (Ok(right), Ok(other)) = (drawn(|pair| pair.right), drawn(|pair| pair.other)) else { return false };
        are_apart(&right, &other, stage.model.hull().diagonal())
    }
}

/// Whether some pixel of two pictures of a model is far apart.
fn are_apart(a: &GBuffer, b: &GBuffer, size: f64) -> bool {
    let near = |x: f64, y: f64, unit: f64| (x - y).abs() <= APART * unit.max(x.abs());
    let alike = |a: &Hit, b: &Hit| {
        let positions = a.position.to_array().into_iter().zip(b.position.to_array());
        let curvatures = match (a.curvature, b.curvature) {
            (Some(a), Some(b)) => near(a.k1, b.k1, 1.0 / size) && near(a.k2, b.k2, 1.0 / size),
            (a, b) => a.is_some() == b.is_some(),
        };
        let normals = match (a.normal.unit(), b.normal.unit()) {
            (Some(a), Some(b)) => near(a.distance(b), 0.0, 1.0),
            (a, b) => a.is_some() == b.is_some(),
        };
        curvatures && normals && positions.into_iter().all(|(x, y)| near(x, y, size))
    };
    a.pixels().zip(b.pixels()).any(|pair| match pair {
        (Some(a), Some(b)) => !alike(a, b),
        (a, b) => a.is_some() != b.is_some(),
    })
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
    let mut reduction = Reduction { case, wrong, wording, host, bodies: Bodies::new() };
    reduction.fewer_pixels()?;
    reduction.fewer_faces();
    reduction.fewer_loops();
    reduction.fewer_spans();
    reduction.fewer_declarations();
    reduction.fewer_statements();
    written(folder, &reduction)
}

fn written(folder: &Path, Reduction { case, wrong, wording, host, bodies }: &Reduction) -> Result<()> {
    output::folder(folder)?;
    let file = |name: &str, text: String| std::fs::write(folder.join(name), text).with_context(|| name.to_owned());
    file("model.json", formats::json::write(&case.model)?)?;
    for (i, program) in wrong.programs.iter().enumerate() {
        file(&format!("program-{i}.wgsl"), program.clone())?;
    }
    for (i, body) in bodies.values().enumerate() {
        let Pair { right, other } = Pair::new(body, *wording, host, false);
        file(&format!("small-{i}.wgsl"), right)?;
        file(&format!("small-{i}-other.wgsl"), other)?;
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
    let lines =
        |programs: &mut dyn Iterator<Item = &String>| programs.map(|program| program.lines().count()).sum::<usize>();
    let [whole, small] = [lines(&mut bodies.keys()), lines(&mut bodies.values())];
    let small = match small {
        0 => String::new(),
        _ => format!(
            "The programs `small-N.wgsl` are what is left of them: {small} of {whole} lines. They no longer draw the surface. `small-N-other.wgsl` \
             means the same in other words, and at the same place it gives another picture.\n\n"
        ),
    };
    file(
        "README.md",
        format!(
            "# A program in other words gives another picture\n\n\
             Drawn by {host}, with the WGSL of seed {seed}, one of {count} program(s) a file: `program-N.wgsl`.\n{planted}\n\
             What differs: {why}\n\n{small}\
             The same picture by the program in its own words:\n\n\
             ```sh\nisophote compare model.json {options}\n```\n"
        ),
    )
}

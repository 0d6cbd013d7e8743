//! `compare A.npz [B.npz]` as a person or a machine reads it.

use super::answer::{SCHEMA_VERSION, answer};
use super::args::CompareArgs;
use super::next::Next;
use super::page::Page;
use super::pictures::Pictures;
use super::saved::{Saved, SavedComparison, SavedFile};
use super::table;
use crate::antialias::Antialias;
use crate::say;
use crate::view::ViewArgs;
use anyhow::{Result, bail};
use compare::{Diagnosis, PairReport};
use gbuffer::{GBuffer, Meta};
use scene::Camera;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use suite::text::escaped;

#[derive(Serialize)]
struct Report<'a> {
    /// Of `testdata/schema/judge-1.json`.
    schema_version: u32,
    model: &'a str,
    model_hash: String,
    size: [usize; 2],
    files: Vec<FileReport<'a>>,
    /// Who looks, as the files say.
    camera: &'a Camera,
    /// The renderer, where one drew both files: the second is checked for regressions against the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    regression_of: Option<&'a str>,
    /// What flat triangles were allowed, pixels.
    chord_px: f64,
    pairs: &'a [PairReport],
    /// Of each pair, the one fault that explains it, where one does.
    diagnoses: &'a [Option<Diagnosis>],
    /// Pixels that the ray caster could not decide.
    undecided: usize,
}

#[derive(Serialize)]
struct FileReport<'a> {
    file: String,
    renderer: &'a str,
    technique: &'a str,
    adapter: Option<&'a str>,
    driver: Option<&'a str>,
    version: &'a str,
    covered: usize,
}

/// Runs the command on saved files.
pub(super) fn run(args: &CompareArgs, files: &[&String]) -> Result<ExitCode> {
    if let Some(option) = args.view.given().or(args.drawing.adapter.as_ref().map(|_| "--adapter")) {
        bail!("{option} does not go with saved G-buffers, which bring their own camera, size and adapter");
    }
    if args.antialias != Antialias::None {
        bail!("--antialias does not go with saved G-buffers: each is one sample, by its camera's lens shift");
    }
    let paths: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
    let saved = Saved::open(&paths, args.of_model.as_deref())?;
    let plan = args.drawing.plan();
    let comparison = saved.compare(plan, args.drawing.trim.masks_px())?;
    let SavedComparison { cast, pairs, diagnoses } = &comparison;
    let buffers: Vec<&GBuffer> = std::iter::once(cast).chain(saved.files.iter().map(|file| &file.buffer)).collect();
    let report = Report {
        schema_version: SCHEMA_VERSION,
        model: saved.model.name(),
        model_hash: saved.model.hash(),
        size: [saved.viewport.width(), saved.viewport.height()],
        files: saved.files.iter().map(FileReport::new).collect(),
        camera: &saved.camera,
        regression_of: saved.regression_of.as_deref(),
        chord_px: plan.chord_px,
        pairs,
        diagnoses,
        undecided: cast.undecided(),
    };
    let pictures = Pictures::new(&saved.model, &saved.camera, &buffers, &args.shade.shading())?;
    let mut facts = vec![
        ("model hash", report.model_hash.clone()),
        ("size", format!("{} x {} pixels", report.size[0], report.size[1])),
        ("camera", serde_json::to_string(&saved.camera)?),
        ("chord error", format!("{} px", plan.chord_px)),
        ("undecided by the ray caster", report.undecided.to_string()),
        ("program", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    facts.extend(report.files.iter().map(|file| ("file", file.line())));
    let (line, code, viewport) = (comparison.line(), comparison.exit_code(), saved.viewport);
    let name = args.of_model.as_deref().unwrap_or(report.model);
    let next = Next::new(name, &ViewArgs::of(&saved.camera, saved.viewport), &args.drawing)?;
    let page = Page { model: report.model, line: line.clone(), code, facts, pairs, viewport, next: &next };
    answer(args, &report, &pictures, &page, || print(&report, &line, &next))?;
    Ok(ExitCode::from(code))
}

impl<'a> FileReport<'a> {
    fn new(file: &'a SavedFile) -> Self {
        let Meta { renderer, technique, adapter, driver, version, .. } = file.buffer.meta();
        Self {
            file: file.path.display().to_string(),
            renderer,
            technique,
            adapter: adapter.as_deref(),
            driver: driver.as_deref(),
            version,
            covered: file.buffer.covered(),
        }
    }

    fn line(&self) -> String {
        let Self { file, renderer, technique, adapter, version, covered, .. } = self;
        let adapter = adapter.map_or(String::new(), |name| format!(" on {name:?}"));
        let [file, renderer, technique] = [file.as_str(), renderer, technique].map(escaped);
        format!("{file}: {renderer}{adapter}, technique {technique}, version {version:?}, {covered} pixels covered")
    }
}

fn print(report: &Report, line: &str, next: &Next) -> Result<()> {
    say!("{}, {}x{}", escaped(report.model), report.size[0], report.size[1])?;
    report.files.iter().try_for_each(|file| say!("{}", file.line()))?;
    if let Some(renderer) = report.regression_of {
        say!("a check for regressions: both files are of {}, the second is held against the first", escaped(renderer))?;
    }
    table::pairs(report.pairs, next)?;
    if report.undecided > 0 {
        say!("the ray caster left {} pixels undecided", report.undecided)?;
    }
    say!("{line}")
}

//! `conform export` and `conform judge`: the suite's scenes for a renderer that is not ours, and the report of its answers.
//!
//! A scene is a file `NAME-VIEW.json`, its answer `NAME-VIEW.npz` beside it (docs/gbuffer.md describes both). Scenes that
//! stress how our own masks trim are left out.

use super::answer::{OutputArgs, claim, finish};
use crate::compare::Saved;
use crate::{output, say, scene, terminal};
use ::scene::{Camera, Model, Viewport};
use anyhow::{Context, Result, bail};
use clap::Args;
use gbuffer::{GBuffer, ShadeKind, Shading};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;
use suite::corpus::{CaseKey, Scene, Suite, Viewpoint};
use suite::difference::Map;
use suite::embedded::data_uri;
use suite::report::{Case, Outcome, Pair, Report, Subject};
use suite::run::{Plans, host};
use suite::shard::Shard;
use suite::stage::{Path as DrawnBy, Plan};

/// Write the suite's scenes, for a renderer of your own to draw
///
/// Each is a file NAME-VIEW.json as `isophote scene` writes it. Draw it to NAME-VIEW.npz beside it, then ask for the verdict by
/// `conform judge`. docs/gbuffer.md describes both files.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// Where the scenes go
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// How much of the corpus
    #[arg(long, value_enum, default_value = "smoke")]
    suite: Suite,
}

/// Judge what a renderer of your own drew of the exported scenes
///
/// Reads NAME-VIEW.npz of every scene, and writes the report that `conform` writes. A fault of whole pictures is named.
///
/// Exit code 0: all agree; 1: something differs; 2: an answer is missing or cannot be read.
#[derive(Debug, Args)]
pub struct JudgeArgs {
    /// Where the answers are
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// How much of the corpus
    #[arg(long, value_enum, default_value = "smoke")]
    suite: Suite,
    #[command(flatten)]
    output: OutputArgs,
}

/// A view of a scene.
struct View {
    scene: &'static Scene,
    viewpoint: Viewpoint,
    model: Model,
    camera: Camera,
    viewport: Viewport,
    plan: Plan,
}

/// The views of a suite that any renderer can draw.
fn views(suite: Suite) -> Result<Vec<View>> {
    let viewport = Viewport::new(suite.side(), suite.side())?;
    let mut views = vec![];
    for scene in suite.scenes().into_iter().filter(|scene| !scene.masked) {
        for &viewpoint in suite.viewpoints(scene) {
            let model = scene.open().map_err(anyhow::Error::msg)?;
            let camera = viewpoint.camera(&model, viewport);
            let plan = Plan { unbounded_share: scene.unbounded_share, ..suite.plans(scene)[0] };
            views.push(View { scene, viewpoint, model, camera, viewport, plan });
        }
    }
    Ok(views)
}

impl View {
    fn key(&self) -> CaseKey {
        self.scene.key(self.viewpoint, self.plan)
    }

    fn file(&self, folder: &Path, ending: &str) -> PathBuf {
        folder.join(format!("{}-{}.{ending}", self.scene.name, self.viewpoint.name()))
    }

    /// Judges an answer: its pictures and what was found.
    fn judged(&self, path: &Path, subject: &str) -> Case {
        let started = Instant::now();
        let mut case = Case {
            key: self.key(),
            size: [self.viewport.width(), self.viewport.height()],
            options: self.scene.options(&self.camera, self.viewport, self.plan),
            triangles: 0,
            undecided: 0,
            picture: None,
            error: None,
            outcomes: vec![],
        };
        let mut outcome = Outcome { subject: subject.to_owned(), ..Outcome::default() };
        match self.compared(path) {
            Err(error) => outcome.error = Some(format!("{error:#}")),
            Ok((cast, buffer, pair)) => {
                case.undecided = cast.undecided();
                case.picture = self.shaded(&cast).ok();
                outcome.picture = self.shaded(&buffer).ok();
                let map = data_uri(&Map::new(&self.camera, &cast, &buffer).picture()).ok();
                outcome.pairs.push(Pair { difference: map, ..pair });
            }
        }
        outcome.seconds = started.elapsed().as_secs_f64();
        case.outcomes.push(outcome);
        case
    }

    fn compared(&self, path: &Path) -> Result<(GBuffer, GBuffer, Pair)> {
        let saved = Saved::open(&[path.to_owned()], Some(self.scene.model))?;
        if saved.camera != self.camera || saved.viewport != self.viewport {
            bail!("{}: it shows another view than the scene", path.display());
        }
        let found = saved.compare(self.plan, None)?;
        let buffer = saved.files.into_iter().next().context("one file was opened")?.buffer;
        let mut pair = Pair::new(&found.pairs[0], &found.cast, &buffer);
        if let Some(diagnosis) = &found.diagnoses[0] {
            pair.reasons.insert(0, diagnosis.to_string());
        }
        Ok((found.cast, buffer, pair))
    }

    fn shaded(&self, buffer: &GBuffer) -> Result<String> {
        data_uri(&buffer.shaded(&Shading::new(ShadeKind::Isophotes), &self.model, &self.camera)?)
    }
}

/// Writes the scenes.
///
/// # Errors
/// Where a file cannot be written.
pub fn export(args: &ExportArgs) -> Result<ExitCode> {
    let _lock = output::claim(&args.folder)?;
    let views = views(args.suite)?;
    for view in &views {
        let document = scene::document(&view.model, &view.camera, view.viewport)?;
        output::write(&view.file(&args.folder, "json"), (document.to_string() + "\n").as_bytes())?;
    }
    let folder = args.folder.display();
    say!(
        "{} scenes are in {folder}: draw each NAME.json to NAME.npz, then `isophote conform judge {folder}`",
        views.len()
    )?;
    Ok(ExitCode::SUCCESS)
}

/// Judges the answers.
///
/// # Errors
/// Where there is no answer at all, or the report cannot be written.
pub fn judge(args: &JudgeArgs) -> Result<ExitCode> {
    let views = views(args.suite)?;
    let paths: Vec<PathBuf> = views.iter().map(|view| view.file(&args.folder, "npz")).collect();
    let first = paths.iter().find(|path| path.exists());
    let Some(first) = first else {
        bail!("{}: no answer is there, such as {}", args.folder.display(), paths[0].display());
    };
    let name = GBuffer::read_npz_meta(first)?.0.renderer;
    let _lock = claim(&args.output.out, args.suite, Shard::WHOLE)?;
    let subject = foreign(&name);
    let scenes = args.suite.scenes().into_iter().filter(|scene| !scene.masked).collect();
    let mut report = Plans { suite: args.suite, scenes, shard: Shard::WHOLE, path: DrawnBy::default() }.report(vec![]);
    report.planned = views.iter().map(View::key).collect();
    report.sources.iter_mut().for_each(|source| source.subjects = vec![subject.id.clone()]);
    report.subjects = vec![subject];
    let bar = terminal::progress("judge", views.len());
    report.cases = judged(&views, &paths, &report, &bar);
    drop(bar);
    finish(&report, &args.output)
}

fn judged(views: &[View], paths: &[PathBuf], report: &Report, bar: &indicatif::ProgressBar) -> Vec<Case> {
    let id = &report.subjects[0].id;
    let case = |(view, path): (&View, &PathBuf)| {
        let case = view.judged(path, id);
        bar.inc(1);
        case
    };
    views.iter().zip(paths).map(case).collect()
}

/// The renderer that answers.
fn foreign(name: &str) -> Subject {
    Subject {
        id: format!("{name} | {}", host()),
        name: name.to_owned(),
        kind: "foreign".to_owned(),
        driver: String::new(),
        backend: String::new(),
        compiler: String::new(),
        host: host(),
        failure: None,
    }
}

//! `legal`: does the judge accept every answer that WGSL permits, and none beyond?
//!
//! The scenes of a suite are drawn by adapters that make the worst of what WGSL leaves to them ([`arithmetic`], [`order`]), each
//! by its seed. They run the WGSL programs themselves ([`program`], [`machine`]), on whoever covers a pixel ([`picture`]). Each
//! picture is judged as a GPU's is. A legal adapter that differs shows a bound that is too narrow, and one with a planted fault
//! that agrees shows how wide the bounds are.

pub mod arithmetic;
mod builtin;
pub mod machine;
pub mod order;
pub mod picture;
pub mod program;

use anyhow::{Result, bail};
use arithmetic::Fault;
use clap::Args;
use compare::{PairReport, Verdict};
use gbuffer::GBuffer;
use isophote::conform::corpus::{CaseKey, Scene, Suite};
use isophote::format::Format;
use isophote::stage::{Plan, Stage};
use isophote::{say, terminal};
use picture::Adapter;
use raycast::Caster;
use scene::Viewport;
use serde::Serialize;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use techniques::Technique;

/// Draw the conformance scenes with the worst arithmetic that WGSL permits, by seed: all must agree
///
/// Exit code 0: all agree. 1: some picture differs. 2: something could not run.
#[derive(Debug, Args)]
pub struct LegalArgs {
    /// Which scenes
    #[arg(long, value_enum, default_value_t = Suite::Smoke)]
    suite: Suite,
    /// Only scenes of this name; may be given again
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,
    /// Only this technique
    #[arg(long, value_parser = isophote::technique::parser())]
    technique: Option<&'static dyn Technique>,
    /// How many adapters draw each picture
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    seeds: u64,
    /// The seed of the first
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Side of the square pictures, pixels, in place of the suite's
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    side: Option<u16>,
    /// Something that WGSL does not permit, to see that it is noticed
    #[arg(long, value_enum)]
    fault: Option<Fault>,
    /// Begin no further picture after this many seconds
    #[arg(long, value_name = "S")]
    seconds: Option<u64>,
    /// For people or for machines
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// What came of a case.
#[derive(Debug, Clone, Serialize)]
pub struct Line {
    /// The case.
    pub case: CaseKey,
    /// How many adapters drew it.
    pub seeds: u64,
    /// The largest share of its interval that a position used, of any adapter and pixel.
    pub position_share: f64,
    /// The same for a normal.
    pub normal_share: f64,
    /// The same for a curvature.
    pub curvature_share: f64,
    /// Adapters of which some pixel differs.
    pub differ: u64,
    /// Adapters whose pictures have no verdict.
    pub no_verdict: u64,
    /// The first seed that does not agree, and why.
    pub first: Option<(u64, String)>,
}

/// What came of a run.
#[derive(Debug, Default, Serialize)]
struct Report {
    cases: Vec<Line>,
    /// Cases that were not begun when the time was over.
    not_begun: usize,
    /// Cases by techniques `grid` and `zones` and by masks, which are not drawn here.
    not_drawn: usize,
}

/// A stage with what it is judged by.
pub struct Judged<'s> {
    stage: &'s Stage<'s>,
    caster: &'s Caster<'s>,
    rays: GBuffer,
    raster: GBuffer,
}

impl<'s> Judged<'s> {
    /// Draws it by rays and by the rasterizer.
    pub fn new(stage: &'s Stage<'s>, caster: &'s Caster<'s>) -> Self {
        Self { stage, caster, rays: stage.raycast(caster), raster: stage.raster() }
    }

    /// What is drawn.
    pub fn stage(&self) -> &'s Stage<'s> {
        self.stage
    }

    /// The rasterizer's picture.
    pub fn raster(&self) -> &GBuffer {
        &self.raster
    }

    /// A picture against rays and against the rasterizer's, as a GPU's is judged.
    ///
    /// # Errors
    /// Where they cannot be compared.
    pub fn reports(&self, picture: &GBuffer) -> Result<[PairReport; 2]> {
        Ok([
            self.stage.against_raycast(self.caster, &self.rays, picture)?,
            self.stage.against_raster(&self.raster, picture)?,
        ])
    }
}

impl Line {
    fn new(case: CaseKey) -> Self {
        Self {
            case,
            seeds: 0,
            position_share: 0.0,
            normal_share: 0.0,
            curvature_share: 0.0,
            differ: 0,
            no_verdict: 0,
            first: None,
        }
    }

    /// Enters what was said of an adapter's picture.
    fn add(&mut self, seed: u64, reports: &[PairReport; 2]) {
        self.seeds += 1;
        for report in reports {
            self.position_share = self.position_share.max(report.position_share);
            self.normal_share = self.normal_share.max(report.normal_share);
            self.curvature_share = self.curvature_share.max(report.curvature_share);
        }
        let worst = reports.iter().max_by_key(|report| report.verdict).expect("two");
        match worst.verdict {
            Verdict::Agree => return,
            Verdict::Differ => self.differ += 1,
            Verdict::NoVerdict => self.no_verdict += 1,
        }
        self.first.get_or_insert_with(|| (seed, why(worst)));
    }

    fn verdict(&self) -> &'static str {
        match (self.differ, self.no_verdict) {
            (0, 0) => "agree",
            (0, _) => "no verdict",
            _ => "differ",
        }
    }
}

/// The pair, how many pixels differ, and what is wrong with the worst.
pub fn why(report: &PairReport) -> String {
    let pair = format!("{} | {}", report.reference, report.candidate);
    match report.worst.first() {
        Some(pixel) => {
            format!(
                "{pair}: {} pixels, ({}, {}) {:?}: {}",
                report.differing(),
                pixel.x,
                pixel.y,
                pixel.cause,
                pixel.detail
            )
        }
        None => format!("{pair}: {}", report.explanation.as_deref().unwrap_or("no verdict")),
    }
}

/// The plans by which a suite draws a scene, as far as they are asked for: those that an adapter here can draw, and how many it
/// cannot, for the device's own vertex stages and masks are not run.
fn plans(args: &LegalArgs, scene: &Scene) -> (Vec<Plan>, usize) {
    let is_asked = |plan: &Plan| args.technique.is_none_or(|technique| technique == plan.technique);
    let can_be_drawn = |plan: &Plan| !scene.masked && ["fragment", "exact"].contains(&plan.technique.name());
    let asked: Vec<Plan> = args.suite.plans(scene).into_iter().filter(is_asked).collect();
    let (drawn, others): (Vec<Plan>, Vec<Plan>) = asked.into_iter().partition(can_be_drawn);
    (drawn, others.len())
}

/// Runs the command.
///
/// # Errors
/// Where there is no such scene, or one cannot be drawn.
pub fn run(args: &LegalArgs) -> Result<ExitCode> {
    let began = Instant::now();
    let is_over = || args.seconds.is_some_and(|seconds| began.elapsed() >= Duration::from_secs(seconds));
    let scenes: Vec<&Scene> = args.suite.scenes();
    if let Some(unknown) = args.scene.iter().find(|name| !scenes.iter().any(|scene| scene.name == **name)) {
        bail!("the suite has no scene `{unknown}`");
    }
    let side = args.side.map_or(args.suite.side(), usize::from);
    let viewport = Viewport::new(side, side)?;
    let mut report = Report::default();
    for scene in scenes.into_iter().filter(|scene| args.scene.is_empty() || args.scene.iter().any(|n| n == scene.name))
    {
        let model = scene.open().map_err(anyhow::Error::msg)?;
        let caster = Caster::new(&model);
        for &viewpoint in args.suite.viewpoints(scene) {
            let camera = viewpoint.camera(&model, viewport);
            let (plans, others) = plans(args, scene);
            report.not_drawn += others;
            for plan in plans {
                if is_over() {
                    report.not_begun += 1;
                    continue;
                }
                let plan = Plan { unbounded_share: scene.unbounded_share, ..plan };
                let stage = Stage::new(&model, camera, viewport, plan)?;
                let (judged, drawn) = (Judged::new(&stage, &caster), picture::Scene::new(&stage)?);
                let mut line = Line::new(scene.key(viewpoint, plan));
                for seed in args.first..args.first + args.seeds {
                    if is_over() {
                        break;
                    }
                    let picture = drawn.draw(Adapter { fault: args.fault, ..Adapter::legal(seed) })?;
                    line.add(seed, &judged.reports(&picture)?);
                }
                if args.format == Format::Table {
                    show(&line)?;
                }
                report.cases.push(line);
            }
        }
    }
    let lines = &report.cases;
    let differ = lines.iter().filter(|line| line.differ > 0).count();
    let agree = lines.iter().filter(|line| line.verdict() == "agree" && line.seeds > 0).count();
    let is_cut = report.not_begun > 0 || lines.iter().any(|line| line.seeds < args.seeds);
    let is_short = is_cut || agree < lines.len() || lines.is_empty();
    match args.format {
        Format::Json => terminal::json(&report)?,
        Format::Table => {
            let pictures: u64 = lines.iter().map(|line| line.seeds).sum();
            say!("{agree} of {} cases agree, {differ} differ; {pictures} pictures", lines.len())?;
            let Report { not_begun, not_drawn, .. } = &report;
            say!("{not_begun} cases were not begun; {not_drawn} by grid, zones or masks are not drawn here")?;
        }
    }
    Ok(ExitCode::from(match (differ > 0, is_short) {
        (true, _) => 1,
        (false, true) => 2,
        (false, false) => 0,
    }))
}

/// One line for people, and one more where something is wrong.
fn show(line: &Line) -> Result<()> {
    let Line { case, seeds, position_share, normal_share, curvature_share, differ, .. } = line;
    say!(
        "{:60} {:>5} seeds  S {:4.2}  n {:4.2}  k {:4.2}  {}{}",
        case.to_string(),
        seeds,
        position_share,
        normal_share,
        curvature_share,
        line.verdict(),
        if *differ > 0 { format!(" ({differ})") } else { String::new() }
    )?;
    if let Some((seed, why)) = &line.first {
        say!("    seed {seed}: {why}")?;
    }
    Ok(())
}

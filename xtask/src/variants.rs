//! `variants`: programs in other words. What a compiler makes of them must be the same function.
//!
//! Each seed writes the WGSL of a technique anew ([`variant`]) by rules that leave its meaning as it is ([`rewriting`]), on the
//! tokens of its text ([`text`]). A host draws a few scenes with it, and each picture is judged as any other: against rays and
//! against the rasterizer. After Donaldson et al., *Automated Testing of Graphics Shader Compilers* (2017, doi 10.1145/3133917).

pub mod rewriting;
pub mod text;
pub mod variant;

use crate::legal::picture::{Adapter, CALLED, Scene};
use crate::legal::{Judged, why};
use anyhow::{Context, Result, ensure};
use clap::{Args, ValueEnum};
use compare::Verdict;
use gbuffer::GBuffer;
use isophote::conform::corpus::Suite;
use isophote::format::Format;
use isophote::stage::{Path, Plan, Stage};
use isophote::{say, terminal};
use pipeline::wgsl::{self, Variant};
use raycast::Caster;
use scene::Viewport;
use serde::Serialize;
use std::cell::Cell;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use techniques::Technique;

/// The scenes that each variant draws: folds, weights, loops inside loops, and a sphere, where both curvatures are one.
const SCENES: [&str; 4] = ["silhouette", "weights-1-to-1000", "trim-nested-islands", "pole"];

/// Side of their pictures, pixels.
const SIDE: usize = 24;

/// Draw with each program in other words, by seed: all must agree
///
/// Exit code 0: all agree. 1: some picture differs. 2: something could not run.
#[derive(Debug, Args)]
pub struct VariantsArgs {
    /// Only this program; may be given again
    #[arg(long, value_enum)]
    program: Vec<Kind>,
    /// Who draws
    #[arg(long, value_enum, default_value_t = Host::Gpu)]
    host: Host,
    /// Part of the GPU adapter's name
    #[arg(long)]
    adapter: Option<String>,
    /// How many variants of each program
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    seeds: u64,
    /// The seed of the first
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// A fault of a compiler, to see that it is noticed
    #[arg(long, value_enum)]
    fault: Option<Fault>,
    /// Begin no further variant after this many seconds
    #[arg(long, value_name = "S")]
    seconds: Option<u64>,
    /// Write the programs of the first variant that differs into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<std::path::PathBuf>,
    /// For people or for machines
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// A program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Technique `fragment`
    Fragment,
    /// Technique `exact`
    Exact,
    /// Technique `grid`
    Grid,
    /// Technique `zones`
    Zones,
    /// Triangles by kernels
    Compute,
}

impl Kind {
    /// How it draws a scene.
    pub fn plan(self) -> Plan {
        let name = match self {
            Self::Fragment | Self::Compute => "fragment",
            Self::Exact => "exact",
            Self::Grid => "grid",
            Self::Zones => "zones",
        };
        let technique: &'static dyn Technique = techniques::named(name).expect("one of them");
        let path = if self == Self::Compute { Path::Compute32 } else { Path::Fragment };
        Plan { technique, path, ..Plan::default() }
    }
}

/// Who draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Host {
    /// A GPU, by its compiler
    Gpu,
    /// The machine of `legal`, run strictly: `fragment` and `exact` alone
    Machine,
}

/// What a compiler may get wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Fault {
    /// A square is expanded, so that a difference cancels
    Reassociation,
    /// A place that was found is not clamped to its piece: of the program `exact`
    Clamp,
    /// A loop ends one turn too early
    Bound,
}

impl Fault {
    /// The text with the fault in it.
    fn put(self, program: &str) -> String {
        let (right, wrong) = match self {
            Self::Reassociation => ("sqrt(x * x + b * b)", "sqrt(mean * mean - (a * c - b * b))"),
            Self::Clamp => ("let inside = min(max(uv, piece.rectangle.xy), piece.rectangle.zw);", "let inside = uv;"),
            Self::Bound => ("j <= q", "j < q"),
        };
        program.replace(right, wrong)
    }
}

/// What came of a program's variants.
#[derive(Debug, Clone, Serialize)]
pub struct Line {
    /// The program.
    pub program: Kind,
    /// How many variants drew all scenes, or those before the first that differed.
    pub variants: u64,
    /// Those of which some picture differs.
    pub differ: u64,
    /// Those that the host refused: a rule wrote what it should not have.
    pub refused: u64,
    /// The first seed that does not agree, the scene, and why.
    pub first: Option<(u64, String, String)>,
}

/// A host that is there.
pub enum Opened {
    /// A GPU.
    Gpu(Box<gpu::Device>),
    /// The machine.
    Machine,
}

impl Opened {
    /// The functions that it calls by their names, beside entry points.
    fn called(&self) -> &'static [&'static str] {
        match self {
            Self::Gpu(_) => &[],
            Self::Machine => &CALLED,
        }
    }

    /// Draws a stage with the programs of `source`.
    ///
    /// # Errors
    /// Where the host refuses them.
    pub fn draw(&self, stage: &Stage, source: &dyn Fn(Variant) -> String) -> Result<GBuffer> {
        match self {
            Self::Gpu(device) => {
                let overrides = gpu::Overrides { source: Some(source), ..Default::default() };
                Ok(stage.gpu(device, None, overrides)?.gbuffer)
            }
            Self::Machine => Scene::with_source(stage, source)?.draw(Adapter::STRICT),
        }
    }
}

/// Draws all scenes with the variant of a seed; what is wrong with the first that does not agree, and where.
///
/// # Errors
/// Where the host refuses the programs.
pub fn differs(
    stages: &[(&str, Judged)],
    host: &Opened,
    seed: u64,
    fault: Option<Fault>,
) -> Result<Option<(String, String)>> {
    let is_wrong = Cell::new(fault.is_none());
    let source = |variant: Variant| {
        let right = wgsl::source(variant);
        let text = fault.map_or(right.clone(), |fault| fault.put(&right));
        is_wrong.set(is_wrong.get() || text != right);
        variant::variant(&text, seed, host.called())
    };
    for (name, judged) in stages {
        let picture = host.draw(judged.stage(), &source)?;
        ensure!(is_wrong.get(), "no program of {name} has the text that the fault changes");
        let reports = judged.reports(&picture)?;
        if let Some(report) = reports.iter().find(|report| report.verdict == Verdict::Differ) {
            return Ok(Some(((*name).to_owned(), why(report))));
        }
    }
    Ok(None)
}

/// Prepares the scenes of a program for `visit`.
///
/// # Errors
/// Where one cannot be drawn.
pub fn with_stages<T>(kind: Kind, visit: impl FnOnce(&[(&str, Judged)]) -> Result<T>) -> Result<T> {
    let scenes = Suite::Smoke.scenes();
    let named = |name: &&str| scenes.iter().find(|scene| scene.name == *name).copied();
    let scenes = SCENES.iter().map(|name| named(name).context("a scene of the suite")).collect::<Result<Vec<_>>>()?;
    let models = scenes.iter().map(|scene| scene.open().map_err(anyhow::Error::msg)).collect::<Result<Vec<_>>>()?;
    let viewport = Viewport::new(SIDE, SIDE)?;
    let mut stages = vec![];
    for (scene, model) in scenes.iter().zip(&models) {
        stages.push(Stage::new(model, scene.viewpoints[0].camera(model, viewport), viewport, kind.plan())?);
    }
    let casters: Vec<Caster> = models.iter().map(Caster::new).collect();
    let judged = scenes.iter().zip(&stages).zip(&casters);
    let judged: Vec<(&str, Judged)> =
        judged.map(|((scene, stage), caster)| (scene.name, Judged::new(stage, caster))).collect();
    visit(&judged)
}

/// Runs the command.
///
/// # Errors
/// Where there is no such adapter, or a scene cannot be drawn.
pub fn run(args: &VariantsArgs) -> Result<ExitCode> {
    let began = Instant::now();
    let is_over = || args.seconds.is_some_and(|seconds| began.elapsed() >= Duration::from_secs(seconds));
    let host = match args.host {
        Host::Gpu => Opened::Gpu(Box::new(gpu::Device::open(args.adapter.as_deref())?)),
        Host::Machine => Opened::Machine,
    };
    let can_be_run = |kind: &Kind| args.host == Host::Gpu || [Kind::Fragment, Kind::Exact].contains(kind);
    let is_chosen = |kind: &Kind| args.program.is_empty() || args.program.contains(kind);
    let mut lines = vec![];
    for &kind in Kind::value_variants().iter().filter(|kind| is_chosen(kind) && can_be_run(kind)) {
        let line = with_stages(kind, |stages| {
            let mut line = Line { program: kind, variants: 0, differ: 0, refused: 0, first: None };
            for seed in args.first..args.first + args.seeds {
                if is_over() {
                    break;
                }
                line.variants += 1;
                let wrong = match differs(stages, &host, seed, args.fault) {
                    Ok(None) => continue,
                    Ok(Some(found)) => {
                        line.differ += 1;
                        found
                    }
                    Err(error) => {
                        line.refused += 1;
                        (String::new(), format!("{error:#}"))
                    }
                };
                if line.first.is_none() {
                    line.first = Some((seed, wrong.0, wrong.1));
                    if let Some(folder) = &args.out {
                        written(folder, stages, kind, seed, args.fault)?;
                    }
                }
            }
            Ok(line)
        })?;
        if args.format == Format::Table {
            let Line { variants, differ, refused, .. } = line;
            say!("{kind:?}: {variants} variants, {differ} differ, {refused} refused")?;
            if let Some((seed, scene, why)) = &line.first {
                say!("    seed {seed}, {scene}: {why}")?;
            }
        }
        lines.push(line);
    }
    if args.format == Format::Json {
        terminal::json(&lines)?;
    }
    let is_short = |line: &Line| line.refused > 0 || line.variants < args.seeds;
    Ok(ExitCode::from(match (lines.iter().any(|line| line.differ > 0), lines.iter().any(is_short)) {
        (true, _) => 1,
        (false, true) => 2,
        (false, false) => {
            if lines.is_empty() {
                2
            } else {
                0
            }
        }
    }))
}

/// Writes the programs of a variant, a file each.
fn written(
    folder: &std::path::Path,
    stages: &[(&str, Judged)],
    kind: Kind,
    seed: u64,
    fault: Option<Fault>,
) -> Result<()> {
    isophote::output::folder(folder)?;
    for (name, judged) in stages {
        let scene = &judged.stage().scene;
        for &program in scene.programs() {
            let parts = kind.plan().technique.parts();
            let text = wgsl::source(Variant {
                parts,
                program,
                curvature: true,
                vertex_normals: false,
                trims: scene.trim_method(),
            });
            let text = fault.map_or(text.clone(), |fault| fault.put(&text));
            let file = format!("{kind:?}-{name}-{program:?}-seed-{seed}.wgsl").to_lowercase();
            std::fs::write(folder.join(file), variant::variant(&text, seed, &[]))?;
        }
    }
    Ok(())
}

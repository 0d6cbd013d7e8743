//! `variants`: programs in other words. What a compiler makes of them must be the same function.
//!
//! Each seed writes the WGSL of a technique anew ([`variant`]) by rules that leave its meaning as it is ([`rewriting`]), on the
//! tokens of its text ([`text`]). A host draws a few scenes with it, and each picture is judged as any other: against rays and
//! against the rasterizer. After Donaldson et al., *Automated Testing of Graphics Shader Compilers* (2017, doi 10.1145/3133917).

pub mod bodies;
pub mod reduced;
pub mod rewriting;
pub mod text;
pub mod variant;
pub mod wording;

use crate::legal::Judged;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use isophote::conform::corpus::Suite;
use isophote::format::Format;
use isophote::stage::{Path, Plan, Stage};
use isophote::{say, terminal};
use raycast::Caster;
use scene::Viewport;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use techniques::Technique;
use wording::{Fault, Opened, Wording, Wrong};

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
    /// Reduce the first variant that differs, and write it into this folder: model, programs, and how to see it
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
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

/// Draws all scenes; the first that does not agree, and what is wrong with it.
///
/// # Errors
/// Where the host refuses the programs.
pub fn differs(stages: &[(&str, Judged)], host: &Opened, wording: Wording) -> Result<Option<(String, String)>> {
    for (name, judged) in stages {
        if let Some(Wrong { why, .. }) = wording.wrong(judged, host)? {
            return Ok(Some(((*name).to_owned(), why)));
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
    if let Some(kind) = args.program.iter().find(|kind| !can_be_run(kind)) {
        bail!("--host machine runs the programs fragment and exact, not {kind:?}");
    }
    let mut lines = vec![];
    for &kind in Kind::value_variants().iter().filter(|kind| is_chosen(kind) && can_be_run(kind)) {
        let line = with_stages(kind, |stages| {
            let mut line = Line { program: kind, variants: 0, differ: 0, refused: 0, first: None };
            for seed in args.first..args.first + args.seeds {
                if is_over() {
                    break;
                }
                line.variants += 1;
                let wording = Wording { seed, fault: args.fault, is_lean: false };
                let wrong = match differs(stages, &host, wording) {
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
                    if let (Some(folder), Some((_, judged))) =
                        (&args.out, stages.iter().find(|(name, _)| *name == wrong.0))
                    {
                        reduced::write(folder, judged.stage(), wording, &host)?;
                    }
                    line.first = Some((seed, wrong.0, wrong.1));
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

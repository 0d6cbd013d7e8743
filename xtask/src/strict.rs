//! `strict`: has a strict program the same bits on every host?
//!
//! First each operation alone, at numbers by the million ([`operations`]); then the scenes of a suite, each drawn by the CPU rasterizer and by
//! `--path strict` on each host. All must have one hash.

pub mod operations;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use gbuffer::GBuffer;
use isophote::conform::bits::Bits;
use isophote::conform::corpus::{Scene, Suite};
use isophote::conform::dawn::Dawn;
use isophote::conform::run::{Adapter, DrawError, Gpu};
use isophote::say;
use isophote::stage::{Path, Stage};
use operations::Amount;
use scene::Viewport;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use techniques::Technique;

/// Hold strict programs to the CPU rasterizer's bits: each operation by the million, then scenes
///
/// Exit code 0: the same bits everywhere. 1: some are others. 2: something could not run, or nothing was compared.
#[derive(Debug, Args)]
pub struct StrictArgs {
    /// How many operands each operation is tried at
    #[arg(long, value_enum, default_value_t = Amount::Few)]
    operations: Amount,
    /// Which scenes
    #[arg(long, value_enum, default_value_t = Suite::Smoke)]
    suite: Suite,
    /// Only scenes of this name; may be given again
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,
    /// By which technique's triangles
    #[arg(long, value_parser = isophote::technique::parser(), default_value = isophote::technique::default())]
    technique: &'static dyn Technique,
    /// What compiles and draws: wgpu (by naga), dawn (by Tint), or both
    #[arg(long, value_enum, value_delimiter = ',', default_value = "wgpu")]
    hosts: Vec<Host>,
    /// With --hosts dawn: the folder of the Node program
    #[arg(long, value_name = "DIR", default_value = "hosts/node")]
    dawn: PathBuf,
    /// Part of the adapter's name
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Side of the square pictures, pixels, in place of the suite's
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=4096))]
    side: Option<u16>,
    /// Begin no further picture after this many seconds
    #[arg(long, value_name = "S")]
    seconds: Option<u64>,
}

/// What plays a picture's commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Host {
    /// In this process, by naga
    Wgpu,
    /// By the Node program in --dawn, by Tint
    Dawn,
}

/// What was counted.
#[derive(Debug, Default)]
struct Counts {
    pictures: usize,
    unlike: usize,
    failed: usize,
    not_begun: usize,
    /// Pixels that show something, of all pictures.
    covered: usize,
}

/// Runs the command.
///
/// # Errors
/// Where there is no such scene, no such host, or one cannot be drawn by the CPU.
pub fn run(args: &StrictArgs) -> Result<ExitCode> {
    let began = Instant::now();
    let mut wrong = 0;
    if args.operations != Amount::None {
        let device = gpu::Device::open(args.adapter.as_deref())?;
        wrong = operations::run(&device, args.operations)?;
    }
    let mut hosts: Vec<Box<dyn Adapter>> = vec![];
    for host in &args.hosts {
        hosts.push(match host {
            Host::Wgpu => Box::new(Gpu::open(args.adapter.as_deref())?),
            Host::Dawn => Box::new(Dawn::open(&args.dawn, args.adapter.as_deref())?),
        });
    }
    for host in &hosts {
        let subject = host.subject();
        say!("host {}, {}, {}", subject.compiler, subject.name, subject.driver)?;
    }
    let counts = pictures(args, &mut hosts, began)?;
    let Counts { pictures, unlike, failed, not_begun, covered } = counts;
    say!(
        "{pictures} pictures, {covered} covered pixels: {unlike} have other bits, {failed} could not be drawn, {not_begun} not begun; {wrong} operations differ; {:.0} s",
        began.elapsed().as_secs_f64()
    )?;
    let is_short = failed > 0 || not_begun > 0 || covered == 0;
    Ok(ExitCode::from(if wrong + unlike > 0 { 1 } else { 2 * u8::from(is_short) }))
}

fn pictures(args: &StrictArgs, hosts: &mut [Box<dyn Adapter>], began: Instant) -> Result<Counts> {
    let scenes: Vec<&Scene> = args.suite.scenes();
    if let Some(unknown) = args.scene.iter().find(|name| !scenes.iter().any(|scene| scene.name == **name)) {
        bail!("the suite has no scene `{unknown}`");
    }
    let is_over = || args.seconds.is_some_and(|seconds| began.elapsed() >= Duration::from_secs(seconds));
    let side = args.side.map_or(args.suite.side(), usize::from);
    let viewport = Viewport::new(side, side)?;
    let is_asked = |scene: &&Scene| args.scene.is_empty() || args.scene.iter().any(|name| name == scene.name);
    let mut counts = Counts::default();
    for scene in scenes.into_iter().filter(is_asked) {
        let model = scene.open().map_err(anyhow::Error::msg)?;
        let plans = args.suite.plans_by(scene, Path::Strict);
        for plan in plans.into_iter().filter(|plan| plan.technique == args.technique) {
            for &viewpoint in args.suite.viewpoints(scene) {
                if is_over() {
                    counts.not_begun += hosts.len();
                    continue;
                }
                let camera = viewpoint.camera(&model, viewport);
                let stage = Stage::new(&model, camera, viewport, plan)?;
                let raster = stage.raster();
                say!("{:60} {} covered, {}", scene.key(viewpoint, plan).to_string(), raster.covered(), raster.hash())?;
                for host in hosts.iter_mut() {
                    counts.add(&raster, host.draw(&stage).map(|drawn| drawn.gbuffer), &host.subject().compiler)?;
                }
            }
        }
    }
    Ok(counts)
}

impl Counts {
    fn add(&mut self, raster: &GBuffer, drawn: Result<GBuffer, DrawError>, host: &str) -> Result<()> {
        self.pictures += 1;
        match drawn {
            Ok(drawn) => {
                self.covered += drawn.covered();
                if let Some(first) = Bits::new(raster, &drawn).first {
                    self.unlike += 1;
                    say!("    {host}: {}: {first}", drawn.hash())?;
                }
            }
            Err(DrawError::Lost(why) | DrawError::Refused(why)) => {
                self.failed += 1;
                say!("    {host}: {why}")?;
            }
        }
        Ok(())
    }
}

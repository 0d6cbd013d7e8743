//! `capsule`: what a picture is made by, for any host of WebGPU; and what a host made of it.

use crate::compare::DrawingArgs;
use crate::view::{ModelArgs, ViewArgs};
use crate::{output, say};
use anyhow::Result;
use clap::{Args, Subcommand};
use gpu::capsule::{self, Contents, Played, Recording};
use std::path::PathBuf;
use suite::stage::{Plan, Stage};

/// Write what a GPU picture is made by, for any WebGPU host to draw
///
/// Shaders, buffers, textures, pipelines and commands as capsule.json and files beside it (docs/hosts.md). A host plays them
/// and writes an answer; `capsule read` makes the G-buffer of it, which `compare` judges.
#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  isophote capsule teapot --size 64x64 --out teapot
  isophote capsule play teapot --answer wgpu
  isophote capsule read teapot --answer wgpu --gbuffer teapot.npz"
)]
pub struct CapsuleArgs {
    #[command(subcommand)]
    command: Option<CapsuleCommand>,
    #[command(flatten)]
    record: RecordArgs,
}

#[derive(Debug, Subcommand)]
enum CapsuleCommand {
    Play(PlayArgs),
    Read(ReadArgs),
}

/// What is recorded.
#[derive(Debug, Args)]
struct RecordArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    drawing: DrawingArgs,
    /// The folder of the capsule [default: out/capsule]
    #[arg(long, help_heading = "Output", value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the G-buffer that was drawn while recording to this NumPy file
    #[arg(long, help_heading = "Output", value_name = "X.npz")]
    gbuffer: Option<PathBuf>,
}

/// Play a capsule by wgpu, and write its answer
#[derive(Debug, Args)]
struct PlayArgs {
    /// The folder of the capsule
    #[arg(value_name = "DIR")]
    capsule: PathBuf,
    /// The folder of the answer
    #[arg(long, value_name = "DIR")]
    answer: PathBuf,
    /// Part of the GPU adapter's name (`isophote adapters`)
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

/// Make the G-buffer of a host's answer to a capsule
#[derive(Debug, Args)]
struct ReadArgs {
    /// The folder of the capsule
    #[arg(value_name = "DIR")]
    capsule: PathBuf,
    /// The folder of the answer
    #[arg(long, value_name = "DIR")]
    answer: PathBuf,
    /// Write the G-buffer to this NumPy file
    #[arg(long, value_name = "X.npz")]
    gbuffer: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// Where input is bad, there is no adapter, a capsule or answer is damaged, or a file cannot be written.
pub fn run(args: &CapsuleArgs) -> Result<()> {
    match &args.command {
        None => record(&args.record),
        Some(CapsuleCommand::Play(args)) => {
            let played = capsule::play(&Contents::read(&args.capsule)?, args.adapter.as_deref())?;
            Ok(played.write(&args.answer)?)
        }
        Some(CapsuleCommand::Read(args)) => {
            output::check(&args.gbuffer, "npz")?;
            let (contents, played) = (Contents::read(&args.capsule)?, Played::read(&args.answer)?);
            Ok(capsule::gbuffer(&contents, &played)?.write_npz(&args.gbuffer)?)
        }
    }
}

fn record(args: &RecordArgs) -> Result<()> {
    // Before a picture is drawn for nothing.
    args.gbuffer.iter().try_for_each(|path| output::check(path, "npz"))?;
    let folder = args.out.clone().unwrap_or_else(|| PathBuf::from("out/capsule"));
    let _lock = output::claim(&folder)?;
    let model = args.model.open()?;
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&model, viewport)?;
    let stage = Stage::new(&model, camera, viewport, Plan { edges: false, ..args.drawing.plan() })?;
    let (contents, drawn) = recorded(&stage, args.drawing.adapter.as_deref(), gpu::Overrides::default())?;
    contents.write(&folder)?;
    args.gbuffer.iter().try_for_each(|path| drawn.write_npz(path))?;
    say!("a capsule of {} files is in {}", contents.capsule().files.len() + 1, folder.display())
}

/// The capsule of a stage, drawn with these faults, and the G-buffer that was drawn to record it.
///
/// # Errors
/// Where the adapter refuses, or the picture needs more than a capsule holds.
pub fn recorded(
    stage: &Stage,
    adapter: Option<&str>,
    overrides: gpu::Overrides<'_>,
) -> Result<(Contents, gbuffer::GBuffer)> {
    let recording = Recording::new(adapter)?;
    let drawn = stage.gpu(recording.device(), None, overrides)?.gbuffer;
    let contents = recording.finish(&stage.scene, &drawn, !stage.plan.vertex_normals)?;
    Ok((contents, drawn))
}

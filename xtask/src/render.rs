//! `render`: one renderer, one picture or G-buffer.

use crate::compare::{DrawingArgs, Shade};
use crate::masks::MaskReport;
use crate::stage::{Antialias, Stage};
use crate::terminal;
use crate::view::{ModelArgs, ViewArgs};
use anyhow::Result;
use clap::{Args, ValueEnum};
use gbuffer::Picture;
use raycast::Caster;
use std::path::PathBuf;

/// Render a model by one renderer, to a picture, a G-buffer or the terminal
#[derive(Debug, Args)]
pub struct RenderArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    drawing: DrawingArgs,
    /// Which renderer
    #[arg(long, value_enum, default_value = "raster")]
    with: With,
    /// What the picture shows
    #[arg(long, value_enum, default_value = "isophotes")]
    shade: Shade,
    /// Write the picture to this PNG file
    #[arg(long, value_name = "X.png")]
    out: Option<PathBuf>,
    /// Write the G-buffer to this NumPy file
    #[arg(long, value_name = "X.npz")]
    gbuffer: Option<PathBuf>,
    /// Put the legend of a curvature map beside the picture
    #[arg(long)]
    legend: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum With {
    /// The CPU rasterizer, f32
    Raster,
    /// The GPU, f32
    Gpu,
    /// The ray caster, f64
    Raycast,
}

/// Runs the command.
///
/// # Errors
/// Where input is bad, there is no adapter, or a file cannot be written.
pub fn run(args: &RenderArgs) -> Result<()> {
    let model = args.model.open()?;
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&model, viewport)?;
    let stage = || {
        let stage = Stage::new(&model, camera, viewport, args.drawing.plan())?;
        if let Some(note) = MaskReport::of(&stage).and_then(|masks| masks.note) {
            eprintln!("note: {note}");
        }
        anyhow::Ok(stage)
    };
    let buffer = match args.with {
        With::Raster => stage()?.raster(),
        With::Gpu => {
            let device = gpu::Device::open(args.drawing.adapter.as_deref())?;
            stage()?.gpu(&device, None, gpu::Overrides::default())?.gbuffer
        }
        With::Raycast => {
            let bar = terminal::progress("raycast", viewport.height());
            let edges = args.drawing.antialias() == Antialias::Trims;
            Caster::new(&model).with_edges(edges).render(&camera, viewport, &|rows| bar.inc(rows as u64))
        }
    };
    if let Some(path) = &args.gbuffer {
        buffer.write_npz(path)?;
    }
    if args.out.is_some() || (args.gbuffer.is_none() && terminal::is_terminal()) {
        let shading = args.shade.shading();
        let mut picture = buffer.shaded(&shading, &model, &camera)?;
        if buffer.has_edges() {
            picture = buffer.resolved(&picture, &camera)?;
        }
        if let Some(legend) = shading.legend(viewport.height()).filter(|_| args.legend) {
            picture = Picture::beside(&[&picture, &legend]);
        }
        match &args.out {
            Some(path) => picture.write_png(path)?,
            None => terminal::show(&picture),
        }
    }
    if args.out.is_none() && args.gbuffer.is_none() {
        println!(
            "{} of {} pixels covered (--out X.png or --gbuffer X.npz keeps them)",
            buffer.covered(),
            viewport.pixels()
        );
    }
    Ok(())
}

//! What is asked for: which pixel, and of what.

use crate::compare::DrawingArgs;
use crate::view::ViewArgs;
use anyhow::{Context, Result, bail};
use clap::Args;
use scene::Viewport;

/// Explain one pixel, stage by stage, in each renderer, or of a saved G-buffer
///
/// pixel B.npz X,Y tells of a saved G-buffer what it holds there. It tells what the ray through the pixel's centre meets, and the
/// verdict with its cause. The file brings its camera and size. Its model is the built-in one that it names, or --model.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  isophote pixel teapot 120,80 --size 256x256
  isophote pixel yours.npz 120,80               a renderer of your own, against a ray")]
pub struct PixelArgs {
    /// A model file, a built-in model's name (`isophote info --list`), or a saved G-buffer (.npz)
    #[arg(value_name = "MODEL|FILE.npz")]
    pub(super) model: String,
    /// Column and row, from the top left corner, from 0
    #[arg(value_name = "X,Y")]
    pub(super) pixel: String,
    /// What a saved G-buffer shows, where that is no built-in model
    #[arg(long = "model", value_name = "MODEL")]
    pub(super) of_model: Option<String>,
    #[command(flatten)]
    pub(super) view: ViewArgs,
    #[command(flatten)]
    pub(super) drawing: DrawingArgs,
}

impl PixelArgs {
    /// Column and row in a picture of that size.
    pub(super) fn place(&self, viewport: Viewport) -> Result<[usize; 2]> {
        let (x, y): (usize, usize) = self
            .pixel
            .split_once(',')
            .and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)))
            .with_context(|| format!("{:?} is not X,Y, as in 120,80", self.pixel))?;
        if x >= viewport.width() || y >= viewport.height() {
            bail!("pixel ({x}, {y}) is outside the picture of {}x{}", viewport.width(), viewport.height());
        }
        Ok([x, y])
    }
}

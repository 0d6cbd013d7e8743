//! `view`: a window on a model.

mod drawer;
mod panel;
mod reading;
mod session;

use crate::compare::DrawingArgs;
use crate::look::LookArgs;
use crate::output;
use crate::view::{ModelArgs, ViewArgs};
use crate::with::With;
use ::view::{Display, ViewError};
use anyhow::{Context, Result, anyhow};
use clap::Args;
use std::path::PathBuf;

pub use panel::{PANEL_WIDTH, Window};
pub use reading::Reading;
pub use session::{Saved, Session};

/// Open a window on a model: turn it, light it, ask its pixels, pull its control points
///
/// The left button turns, or moves the light or a control point, as the panel says; with Shift it moves the picture, as the
/// middle and the right button do. The wheel brings nearer what is under the mouse. A click reads a pixel, and judges it by a ray
/// that is cast there.
///
/// S saves the picture, and beside it the command that draws it again; where a control point was moved, the model, too. F frames the
/// model, T, L and P choose what the left button does, Q closes the window.
///
/// While something moves the picture may be coarser. At rest it is the one that `render` writes, to the bit.
#[derive(Debug, Clone, Args)]
#[command(after_help = "\
Examples:
  isophote view part.step
  isophote view teapot --shade zebra --size 1000x700
  isophote view part.step --with raster             where there is no GPU")]
pub struct ViewerArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) view: ViewArgs,
    #[command(flatten)]
    pub(crate) drawing: DrawingArgs,
    /// raster, gpu or raycast
    #[arg(long, help_heading = "Drawing", value_enum, default_value = "gpu", hide_possible_values = true)]
    pub(crate) with: With,
    #[command(flatten)]
    pub(crate) look: LookArgs,
    /// Where S saves the picture; where that is taken, X-1.png, X-2.png … [default: view.png]
    #[arg(long, help_heading = "Output", value_name = "X.png")]
    pub(crate) out: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Where input is bad, there is no display, or no adapter.
pub fn run(args: &ViewerArgs) -> Result<()> {
    // Before a large file is read for nothing.
    args.look.check()?;
    args.out.iter().try_for_each(|path| output::check(path, "png"))?;
    let display = Display::open().map_err(|error| match error {
        ViewError::NoDisplay { .. } => {
            anyhow!("{error}; `isophote render {} --out X.png` draws without one", args.model.model)
        }
        error => error.into(),
    })?;
    let device = match args.with {
        With::Gpu => Some(
            gpu::Device::open(args.drawing.adapter.as_deref())
                .context("`--with raster` draws on the processor; the GPU gives no answer")?,
        ),
        With::Raster | With::Raycast => None,
    };
    let session = Session::new(args, device.as_ref())?;
    let title = format!("{} - isophote", session.model().name());
    let size = [session.viewport().width() + PANEL_WIDTH as usize, session.viewport().height()];
    let mut window = Window::new(session);
    display.show(&title, size, &mut |context| window.show(context))?;
    Ok(())
}

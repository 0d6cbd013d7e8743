//! `view`: a window on a model.

mod args;
mod drawer;
mod judging;
mod panel;
mod reading;
mod session;

use crate::output;
use crate::with::With;
use ::view::{Display, ViewError};
use anyhow::{Context, Result, anyhow, bail};
use scene::escaped;

pub use args::ViewerArgs;
pub use panel::{PANEL_WIDTH, Window};
pub use reading::{Reading, Told};
pub use session::{Saved, Session};

/// Runs the command.
///
/// # Errors
/// Where input is bad, there is no display, or no adapter.
pub fn run(args: &ViewerArgs) -> Result<()> {
    // Before a large file is read for nothing.
    args.look.check()?;
    if args.look.is_measured() {
        bail!("--shade deviation goes with `isophote render` and `isophote compare`");
    }
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
                .context("the GPU gives no answer (`--with raster` draws without one)")?,
        ),
        With::Raster | With::Raycast => None,
    };
    let session = Session::new(args, device.as_ref())?;
    let title = format!("{} - isophote", escaped(session.model().name()));
    let size = [session.viewport().width(), session.viewport().height()];
    let mut window = Window::new(session);
    display.show(&title, size, PANEL_WIDTH, &mut |context| window.show(context))?;
    Ok(())
}

//! What a window begins with.

use crate::compare::DrawingArgs;
use crate::look::LookArgs;
use crate::view::{ModelArgs, ViewArgs};
use crate::with::With;
use clap::Args;
use std::path::PathBuf;

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
    pub(super) model: ModelArgs,
    #[command(flatten)]
    pub(super) view: ViewArgs,
    #[command(flatten)]
    pub(super) drawing: DrawingArgs,
    /// raster, gpu or raycast
    #[arg(long, help_heading = "Drawing", value_enum, default_value = "gpu", hide_possible_values = true)]
    pub(super) with: With,
    #[command(flatten)]
    pub(super) look: LookArgs,
    /// Where S saves the picture; where that is taken, X-1.png, X-2.png … [default: view.png]
    #[arg(long, help_heading = "Output", value_name = "X.png")]
    pub(super) out: Option<PathBuf>,
}

//! The command that says more of a pixel.

use super::args::DrawingArgs;
use crate::view::ViewArgs;
use crate::words;
use anyhow::Result;
use compare::PixelReport;

/// How one picture's pixels are asked for.
pub(super) struct Next {
    model: String,
    /// The words of the camera, the size and the way of drawing, where they are not the usual ones.
    options: Vec<String>,
}

impl Next {
    /// Of a model by name or file.
    ///
    /// # Errors
    /// None, as long as the options have defaults.
    pub fn new(model: &str, view: &ViewArgs, drawing: &DrawingArgs) -> Result<Self> {
        let options = view.words().into_iter().chain(drawing.unusual()?).flatten().collect();
        Ok(Self { model: model.to_owned(), options })
    }

    /// As a shell takes it.
    pub fn command(&self, pixel: &PixelReport) -> String {
        let start = ["isophote", "pixel", &self.model].map(str::to_owned);
        let at = format!("{},{}", pixel.x, pixel.y);
        words::line(start.into_iter().chain([at]).chain(self.options.iter().cloned()))
    }
}

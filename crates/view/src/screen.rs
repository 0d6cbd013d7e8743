//! A frame after the other: what is shown is laid out by egui and painted, with a window or without.

use crate::canvas::Canvas;
use crate::letters::letters;
use crate::textures::Textures;
use egui::{Context, RawInput, Rect, Vec2, ViewportCommand, ViewportId};
use std::time::Duration;

/// What is shown, and what egui remembers of it.
pub struct Screen {
    context: Context,
    textures: Textures,
    canvas: Canvas,
}

/// What is to come after a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shown {
    /// When there is something else to show though nothing happens; `None` where there never is.
    pub again: Option<Duration>,
    /// Whether what is shown asks to be closed.
    pub is_over: bool,
}

impl Default for Screen {
    fn default() -> Self {
        let context = Context::default();
        context.set_fonts(letters());
        Self { context, textures: Textures::default(), canvas: Canvas::default() }
    }
}

impl Screen {
    /// Shows a frame of `size` pixels, of which a point has `pixels_per_point`, after what happened as `input` has it.
    pub fn frame(
        &mut self,
        input: RawInput,
        size: [usize; 2],
        pixels_per_point: f32,
        content: &mut dyn FnMut(&Context),
    ) -> Shown {
        self.context.set_pixels_per_point(pixels_per_point);
        let points = Vec2::new(size[0] as f32, size[1] as f32) / pixels_per_point;
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Default::default(), points)),
            max_texture_side: Some(1 << 14),
            ..input
        };
        let output = self.context.run(input, |context| content(context));
        self.textures.set(&output.textures_delta);
        let primitives = self.context.tessellate(output.shapes, output.pixels_per_point);
        self.canvas = Canvas::new(size[0], size[1]);
        self.canvas.paint(&primitives, output.pixels_per_point, &self.textures);
        self.textures.free(&output.textures_delta);
        let root = output.viewport_output.get(&ViewportId::ROOT);
        Shown {
            again: root.map(|root| root.repaint_delay).filter(|delay| *delay < Duration::MAX),
            is_over: root.is_some_and(|root| root.commands.contains(&ViewportCommand::Close)),
        }
    }

    /// What the last frame shows.
    pub fn canvas(&self) -> &Canvas {
        &self.canvas
    }
}

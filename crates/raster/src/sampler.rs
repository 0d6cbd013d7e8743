//! Single samples at any position of the picture.

use crate::drawing::Drawing;
use crate::resolve;
use crate::visibility::{Samples, Seen};
use gbuffer::Hit;

/// Answers what the rasterizer would see if a sample stood at any position instead of at a pixel's centre.
///
/// Corners are moved by the sample's distance from its pixel's centre *before* they are snapped, and then the stages
/// of [`Rasterizer::render`](crate::Rasterizer::render) run: at a pixel's centre the answer is that of the picture, to the
/// bit. Elsewhere moving rounds positions once more, by at most half an ulp of a pixel position (2⁻¹⁴ pixel below 2048).
pub struct PointSampler<'a> {
    drawing: &'a Drawing<'a>,
    samples: Box<dyn Samples + 'a>,
}

impl<'a> PointSampler<'a> {
    pub(crate) fn new(drawing: &'a Drawing<'a>, samples: Box<dyn Samples + 'a>) -> Self {
        Self { drawing, samples }
    }

    /// What is seen at (x, y), pixels from the top left corner; `None` also outside the picture.
    ///
    /// Its distance is taken along the ray through (x, y).
    pub fn sample(&self, x: f64, y: f64) -> Option<Hit> {
        // At equal depth the earlier one, as in the picture.
        let nearer = |a: Seen, b: Seen| if b.depth > a.depth { b } else { a };
        let seen = self.seen(x, y).into_iter().reduce(nearer)?;
        Some(resolve::sample(self.drawing, &seen, [x, y]))
    }

    /// All layers at (x, y), hidden ones too, nearest first.
    pub fn layers(&self, x: f64, y: f64) -> Vec<Hit> {
        let mut seen = self.seen(x, y);
        seen.sort_by(|a, b| b.depth.total_cmp(&a.depth));
        seen.iter().map(|seen| resolve::sample(self.drawing, seen, [x, y])).collect()
    }

    fn seen(&self, x: f64, y: f64) -> Vec<Seen> {
        let inside = |t: f64, side: usize| t >= 0.0 && t < side as f64;
        let viewport = self.drawing.viewport;
        let is_inside = inside(x, viewport.width()) && inside(y, viewport.height());
        if is_inside { self.samples.layers(x, y) } else { vec![] }
    }
}

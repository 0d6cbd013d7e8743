//! Maps of how far apart two renderers' points are.

use gbuffer::{GBuffer, Hit, Picture};
use scene::{Camera, Viewport};

/// How far apart two renderers' points are, a pixel each.
pub struct Map {
    viewport: Viewport,
    /// Pixels of the picture at that depth; infinite where only one of the two sees anything.
    apart_px: Vec<Option<f64>>,
}

impl Map {
    /// How far apart the points of two pictures of one size are, across and along the ray.
    pub fn new(camera: &Camera, a: &GBuffer, b: &GBuffer) -> Self {
        let viewport = a.viewport();
        let apart = |(a, b): (Option<&Hit>, Option<&Hit>)| match (a, b) {
            (None, None) => None,
            (Some(a), Some(b)) => {
                let depth = camera.depth(a.position).max(camera.near()).max(f64::MIN_POSITIVE);
                Some(a.position.distance(b.position) * camera.pixels_per_unit(viewport, depth))
            }
            _ => Some(f64::INFINITY),
        };
        Self { viewport, apart_px: a.pixels().zip(b.pixels()).map(apart).collect() }
    }

    /// Takes in another map of that size: of two distances the greater is kept.
    pub fn widen(&mut self, other: &Self) {
        for (own, other) in self.apart_px.iter_mut().zip(&other.apart_px) {
            *own = own.map_or(*other, |own| Some(other.map_or(own, |other| own.max(other))));
        }
    }

    /// In pixels of the picture at that depth: false colour from 10⁻⁶ to 1 pixel, logarithmic; magenta where only one of the two
    /// sees anything.
    pub fn picture(&self) -> Picture {
        let (width, height) = (self.viewport.width(), self.viewport.height());
        let shown = |px: f64| if px.is_finite() { px.max(1e-6).log10() } else { f64::NAN };
        Picture::false_colour(width, height, |x, y| self.apart_px[y * width + x].map(shown), [-6.0, 0.0])
    }
}

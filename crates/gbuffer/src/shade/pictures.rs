//! Pictures of a shading: of a G-buffer, and of the scale that its colours stand for.

use super::{ShadeInput, ShadeKind, Shading, background, diverging_colour, isophote_colour, shade_pixel, unorm8};
use crate::{GBuffer, GBufferError, Picture};
use scene::{Camera, Model};

impl Shading {
    /// A strip, 24 pixels wide, of the colours of this kind from its greatest value on top to its least, with a tick
    /// at both ends and at each quarter; `None` for kinds without a scale.
    ///
    /// Isophotes: 0° on top, 90° at the bottom. Curvatures: x / (1 + |x|) from 1 on top to −1, so that the ticks stand
    /// for x = ∞, 1, 0, −1, −∞; x is the curvature scaled as in [`ShadeKind`].
    pub fn legend(&self, height: usize) -> Option<Picture> {
        match self.kind {
            ShadeKind::Isophotes => Some(Picture::legend(height, |t| {
                let bands = (90.0 / self.band_deg).ceil() as f32;
                let band = ((1.0 - t) * 90.0 / self.band_deg).floor() as f32;
                unorm8(isophote_colour(bands, band.min(bands - 1.0)))
            })),
            ShadeKind::Gaussian | ShadeKind::Mean => {
                Some(Picture::legend(height, |t| unorm8(diverging_colour((2.0 * t - 1.0) as f32))))
            }
            _ => None,
        }
    }
}

impl GBuffer {
    /// The buffer as a picture of `model`, as `camera` sees it; pixels without a hit have the colour [`background`].
    ///
    /// # Errors
    /// [`GBufferError::NoSuchFace`] where a hit is on a face that the model does not have.
    pub fn shaded(&self, shading: &Shading, model: &Model, camera: &Camera) -> Result<Picture, GBufferError> {
        let uniform = shading.uniform(camera, model.hull().diagonal());
        let viewport = self.viewport();
        let mut rgb = Vec::with_capacity(viewport.pixels());
        for y in 0..viewport.height() {
            for x in 0..viewport.width() {
                rgb.push(match self.get(x, y) {
                    None => background(),
                    Some(hit) => {
                        let (face, count) = (hit.face.0, model.faces().len());
                        let ray = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5);
                        let input = ShadeInput::new(hit, model, &ray);
                        let input = input.ok_or(GBufferError::NoSuchFace { x, y, face, count })?;
                        unorm8(shade_pixel(&uniform, &input))
                    }
                });
            }
        }
        Picture::new(viewport.width(), viewport.height(), rgb)
    }
}

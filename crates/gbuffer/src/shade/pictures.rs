//! Pictures of a shading: of a G-buffer, and of the scale that its colours stand for.

use super::{ShadeInput, ShadeKind, Shading, background, isophote_colour, shade_pixel, unorm8};
use crate::legend::number;
use crate::{GBuffer, GBufferError, Picture};
use scene::{Camera, Model};

impl Shading {
    /// The colours of isophotes beside the angle between normal and light: 0° on top, 90° at the bottom. `None` for other
    /// kinds: what curvatures are is said by the legend of a [`Quantity`](crate::Quantity).
    pub fn legend(&self, height: usize) -> Option<Picture> {
        (self.kind == ShadeKind::Isophotes).then(|| {
            let ticks = [0.0, 22.5, 45.0, 67.5, 90.0].map(|angle| (1.0 - angle / 90.0, format!("{}°", number(angle))));
            Picture::numbered_legend(height, "to light", &ticks, |t| {
                let bands = (90.0 / self.band_deg).ceil() as f32;
                let band = ((1.0 - t) * 90.0 / self.band_deg).floor() as f32;
                unorm8(isophote_colour(bands, band.min(bands - 1.0)))
            })
        })
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

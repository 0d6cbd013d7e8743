//! The pictures of a comparison, for the terminal and the `--out` folder.

use anyhow::{Context, Result};
use gbuffer::{GBuffer, Picture, Shading};
use scene::{Camera, Model};
use std::path::Path;

/// What a comparison shows: the renderers' pictures and the maps of their differences, by file name.
pub(super) struct Pictures {
    named: Vec<(String, Picture)>,
    views: usize,
}

impl Pictures {
    /// Shades buffers of one size, blends those along their trim edges that record them, and draws their differences.
    ///
    /// # Errors
    /// Where a buffer shows a face that the model does not have.
    pub fn new(model: &Model, camera: &Camera, buffers: &[&GBuffer], shading: &Shading) -> Result<Self> {
        let mut pictures = Self { named: vec![], views: buffers.len() };
        for buffer in buffers {
            let picture = buffer.shaded(shading, model, camera)?;
            let picture = if buffer.has_edges() { buffer.resolved(&picture, camera)? } else { picture };
            pictures.add(&buffer.meta().renderer, picture);
        }
        for (i, a) in buffers.iter().enumerate() {
            for b in &buffers[i + 1..] {
                let name = format!("difference-{}-{}", a.meta().renderer, b.meta().renderer);
                pictures.add(&name, difference(camera, a, b));
            }
        }
        Ok(pictures)
    }

    /// Adds a picture under a name that need not be one of a file: a foreign renderer may be called anything.
    pub fn add(&mut self, name: &str, picture: Picture) {
        let legal = |c: char| if c.is_alphanumeric() || "-_.+".contains(c) { c } else { '-' };
        let name: String = name.chars().map(legal).collect();
        let taken = self.named.iter().filter(|(n, _)| n.eq_ignore_ascii_case(&name)).count();
        let name = if taken == 0 { name } else { format!("{name}-{}", self.named.len()) };
        self.named.push((name, picture));
    }

    /// The renderers' pictures.
    pub fn views(&self) -> Vec<&Picture> {
        self.named[..self.views].iter().map(|(_, picture)| picture).collect()
    }

    /// Writes all of them to a folder, which is made if need be.
    pub fn write(&self, folder: &Path) -> Result<()> {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        for (name, picture) in &self.named {
            picture.write_png(folder.join(format!("{name}.png")))?;
        }
        Ok(())
    }
}

/// How far apart two renderers' points are, across and along the ray, in pixels of the picture at that depth: false
/// colour from 10⁻⁶ to 1 pixel, logarithmic; magenta where only one of them sees anything.
pub fn difference(camera: &Camera, a: &GBuffer, b: &GBuffer) -> Picture {
    let viewport = a.viewport();
    let value = |x: usize, y: usize| match (a.get(x, y), b.get(x, y)) {
        (None, None) => None,
        (Some(a), Some(b)) => {
            let depth = camera.depth(a.position).max(camera.near());
            let pixels =
                a.position.distance(b.position) * camera.pixels_per_unit(viewport, depth.max(f64::MIN_POSITIVE));
            Some(pixels.max(1e-6).log10())
        }
        _ => Some(f64::NAN),
    };
    Picture::false_colour(viewport.width(), viewport.height(), value, [-6.0, 0.0])
}

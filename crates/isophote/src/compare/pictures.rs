//! The pictures of a comparison, for the terminal and the `--out` folder.

use crate::output;
use anyhow::Result;
use gbuffer::{GBuffer, Hit, Picture, Shading};
use scene::{Camera, Model, Viewport};
use std::path::Path;

/// What a comparison shows, by file name: the renderers' pictures, and maps of where they differ.
pub(super) struct Pictures {
    /// Each with a picture a sample.
    shaded: Vec<(String, Vec<Picture>)>,
    /// How many of them are of G-buffers.
    views: usize,
    maps: Vec<(String, Map)>,
}

/// How far apart two renderers' points are, a pixel each.
struct Map {
    viewport: Viewport,
    /// Pixels of the picture at that depth; infinite where only one of the two sees anything.
    apart_px: Vec<Option<f64>>,
}

impl Pictures {
    /// Shades buffers of one size, blends those along their trim edges that record them, and finds their differences.
    ///
    /// # Errors
    /// Where a buffer shows a face that the model does not have.
    pub fn new(model: &Model, camera: &Camera, buffers: &[&GBuffer], shading: &Shading) -> Result<Self> {
        let mut pictures = Self { shaded: vec![], views: buffers.len(), maps: vec![] };
        for buffer in buffers {
            let picture = buffer.shaded(shading, model, camera)?;
            let picture = if buffer.has_edges() { buffer.resolved(&picture, camera)? } else { picture };
            pictures.add(&buffer.meta().renderer, picture);
        }
        for (i, a) in buffers.iter().enumerate() {
            for b in &buffers[i + 1..] {
                let name = format!("difference-{}-{}", a.meta().renderer, b.meta().renderer);
                let name = pictures.free_name(&name);
                pictures.maps.push((name, Map::new(camera, a, b)));
            }
        }
        Ok(pictures)
    }

    /// Adds a picture under a name that need not be one of a file: a foreign renderer may be called anything.
    pub fn add(&mut self, name: &str, picture: Picture) {
        let name = self.free_name(name);
        self.shaded.push((name, vec![picture]));
    }

    /// Takes in the same pictures of another sample: those of each name are averaged, of differences the greatest is shown.
    pub fn add_sample(&mut self, sample: Self) {
        for (name, pictures) in sample.shaded {
            self.shaded
                .iter_mut()
                .filter(|(own, _)| *own == name)
                .for_each(|(_, all)| all.extend_from_slice(&pictures));
        }
        for (name, map) in sample.maps {
            self.maps.iter_mut().filter(|(own, _)| *own == name).for_each(|(_, own)| own.widen(&map));
        }
    }

    fn free_name(&self, name: &str) -> String {
        let legal = |c: char| if c.is_alphanumeric() || "-_.+".contains(c) { c } else { '-' };
        let name: String = name.chars().map(legal).collect();
        let names = || self.shaded.iter().map(|(name, _)| name).chain(self.maps.iter().map(|(name, _)| name));
        let taken = names().filter(|n| n.eq_ignore_ascii_case(&name)).count();
        if taken == 0 { name } else { format!("{name}-{}", names().count()) }
    }

    /// The renderers' pictures, averaged over their samples.
    ///
    /// # Errors
    /// Where those of one renderer are of several sizes.
    pub fn views(&self) -> Result<Vec<Picture>> {
        self.shaded[..self.views].iter().map(|(_, samples)| Ok(Picture::average(samples)?)).collect()
    }

    /// The pictures by name, averaged over their samples, without the maps.
    ///
    /// # Errors
    /// As of [`Self::views`].
    pub fn named(&self) -> Result<Vec<(&str, Picture)>> {
        self.shaded.iter().map(|(name, samples)| Ok((&**name, Picture::average(samples)?))).collect()
    }

    /// Writes all of them to a folder, which is made if need be.
    pub fn write(&self, folder: &Path) -> Result<()> {
        output::folder(folder)?;
        for (name, samples) in &self.shaded {
            Picture::average(samples)?.write_png(folder.join(format!("{name}.png")))?;
        }
        for (name, map) in &self.maps {
            map.picture().write_png(folder.join(format!("{name}.png")))?;
        }
        Ok(())
    }
}

impl Map {
    fn new(camera: &Camera, a: &GBuffer, b: &GBuffer) -> Self {
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

    fn widen(&mut self, other: &Self) {
        for (own, other) in self.apart_px.iter_mut().zip(&other.apart_px) {
            *own = own.map_or(*other, |own| Some(other.map_or(own, |other| own.max(other))));
        }
    }

    fn picture(&self) -> Picture {
        let (width, height) = (self.viewport.width(), self.viewport.height());
        let shown = |px: f64| if px.is_finite() { px.max(1e-6).log10() } else { f64::NAN };
        Picture::false_colour(width, height, |x, y| self.apart_px[y * width + x].map(shown), [-6.0, 0.0])
    }
}

/// How far apart two renderers' points are, across and along the ray, in pixels of the picture at that depth: false
/// colour from 10⁻⁶ to 1 pixel, logarithmic; magenta where only one of them sees anything.
pub fn difference(camera: &Camera, a: &GBuffer, b: &GBuffer) -> Picture {
    Map::new(camera, a, b).picture()
}

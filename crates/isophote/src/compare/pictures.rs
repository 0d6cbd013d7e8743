//! The pictures of a comparison, for the terminal and the `--out` folder.

use crate::output;
use anyhow::Result;
use gbuffer::{GBuffer, Picture, Shading};
use scene::{Camera, Model};
use std::path::Path;
use suite::difference::Map;

/// What a comparison shows, by file name: the renderers' pictures, and maps of where they differ.
pub(super) struct Pictures {
    /// Each with a picture a sample.
    shaded: Vec<(String, Vec<Picture>)>,
    /// How many of them are of G-buffers.
    views: usize,
    maps: Vec<(String, Map)>,
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

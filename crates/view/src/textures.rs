//! The pictures that egui keeps: its letters, and those that a program shows.

use egui::epaint::ImageDelta;
use egui::{Color32, ColorImage, ImageData, TextureId, TexturesDelta};
use std::collections::HashMap;
use std::sync::Arc;

/// Pictures by name.
#[derive(Default)]
pub(crate) struct Textures {
    images: HashMap<TextureId, Arc<ColorImage>>,
}

impl Textures {
    /// Takes what is new or has changed.
    pub fn set(&mut self, delta: &TexturesDelta) {
        for (id, ImageDelta { image: ImageData::Color(image), pos, .. }) in &delta.set {
            match (pos, self.images.get_mut(id)) {
                (Some([left, top]), Some(whole)) => {
                    let whole = Arc::make_mut(whole);
                    let [width, _] = whole.size;
                    for (y, row) in image.pixels.chunks_exact(image.size[0].max(1)).enumerate() {
                        let start = (top + y) * width + left;
                        whole.pixels[start..start + row.len()].copy_from_slice(row);
                    }
                }
                _ => {
                    self.images.insert(*id, image.clone());
                }
            }
        }
    }

    /// Forgets what nobody shows any more.
    pub fn free(&mut self, delta: &TexturesDelta) {
        delta.free.iter().for_each(|id| {
            self.images.remove(id);
        });
    }

    pub fn get(&self, id: TextureId) -> Option<&ColorImage> {
        self.images.get(&id).map(|image| &**image)
    }
}

/// The texel at a place from 0 to 1 across and down, without a filter: letters and pictures are laid out pixel by pixel.
pub(crate) fn texel(image: &ColorImage, [u, v]: [f32; 2]) -> Color32 {
    let [width, height] = image.size;
    let at = |t: f32, count: usize| ((t * count as f32) as usize).min(count.saturating_sub(1));
    image.pixels.get(at(v, height) * width + at(u, width)).copied().unwrap_or(Color32::TRANSPARENT)
}

//! Who is seen: what a technique answers about pixels and samples, before the fragment program runs.

use crate::rect::Rect;
use pipeline::Parameters;

/// Pixels of a tile that see one face.
#[derive(Debug, Default)]
pub struct Run {
    /// The face.
    pub face: u32,
    /// The pixels as row × [`TILE`](crate::rect::TILE) + column.
    pub pixels: Vec<u16>,
    /// Where each sees the face.
    pub places: Vec<Parameters>,
    /// What the triangles there carry, where it is asked for; else none.
    pub carried: Vec<Carried>,
}

impl Run {
    /// Hands the pixels over, where there are some, and holds none then.
    pub fn hand_over(&mut self, resolve: &mut dyn FnMut(&Run)) {
        if !self.pixels.is_empty() {
            resolve(self);
        }
        self.pixels.clear();
        self.places.clear();
        self.carried.clear();
    }
}

/// What a flat triangle carries to a pixel, in place of the surface's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Carried {
    /// On a skirt: the surface's own is shown, of a place beside the triangle.
    Nothing,
    /// A point of the triangle.
    Point {
        /// The interpolated normal, of any length.
        normal: [f32; 3],
        /// z / w.
        depth: f32,
    },
}

/// What is drawn at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// The face.
    pub face: u32,
    /// Where.
    pub place: Parameters,
    /// z / w: the greater is the nearer.
    pub depth: f32,
    /// What its triangle carries, where it is asked for.
    pub carried: Option<Carried>,
}

/// How a technique finds who is seen.
pub trait Visibility: Sync {
    /// Finds the nearest face at the centre of every pixel of a tile, and hands each run of pixels that see one face to
    /// `resolve`, no pixel twice. Returns the pixels (x, y) of the picture for which it has no answer.
    fn tile(&self, rect: Rect, resolve: &mut dyn FnMut(&Run)) -> Vec<(usize, usize)>;

    /// Prepares to answer single samples.
    fn samples(&self) -> Box<dyn Samples + '_>;
}

/// Answers what would be seen if a sample stood elsewhere than at a pixel's centre.
pub trait Samples: Sync {
    /// All that covers position (x, y) in front of the far plane, hidden layers too, in drawing order; pixels from the top left
    /// corner, inside the picture. At a pixel's centre the nearest, of equal ones the first, is that of [`Visibility::tile`].
    fn layers(&self, x: f64, y: f64) -> Vec<Seen>;
}

/// The pixel of a position in the picture, and how far the position is from its centre.
pub fn of_pixel(x: f64, y: f64) -> ([usize; 2], [f32; 2]) {
    let [column, row] = [x, y].map(|t| t as usize);
    ([column, row], [x - (column as f64 + 0.5), y - (row as f64 + 0.5)].map(|d| d as f32))
}

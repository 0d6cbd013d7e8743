//! Which triangles may touch which square of the picture.

use crate::geometry::Geometry;
use crate::rect::{Rect, TILE};
use rayon::prelude::*;
use scene::Viewport;

/// Lists of triangles, in drawing order, one a square.
#[derive(Debug, Clone)]
pub struct Bins {
    side: usize,
    columns: usize,
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

/// Triangles that are binned by one task.
const CHUNK: usize = 1 << 12;

/// Side of a square of triangles that are looked through for one sample, pixels.
const SIDE_OF_SAMPLES: usize = 8;

impl Bins {
    /// The triangles that may cover the centre of any pixel of each tile.
    pub fn of_tiles(geometry: &Geometry, viewport: Viewport) -> Self {
        Self::new(viewport, TILE, geometry.triangles(), |i, add| geometry.boxes(i, add))
    }

    /// The triangles that may cover any position of a square, wherever a sample stands in its pixel.
    pub fn of_samples(geometry: &Geometry, viewport: Viewport) -> Self {
        Self::new(viewport, SIDE_OF_SAMPLES, geometry.triangles(), |i, add| {
            geometry.ids(i, |id| {
                let [low, high] = geometry.extent(id);
                // A pixel of margin holds what snapping, moving and narrowing to whole pixels can do.
                let ([left, top], [right, bottom]) = (low.map(|t| t as i32 - 1), high.map(|t| t as i32 + 2));
                add(id, Rect { left, top, right, bottom });
            });
        })
    }

    /// Sorts triangles into squares of `side` pixels. `boxes` calls its last argument with the id and the pixels of every
    /// piece of triangle `i < count`, in drawing order; what lies outside the viewport is left out.
    fn new(
        viewport: Viewport,
        side: usize,
        count: usize,
        boxes: impl Fn(usize, &mut dyn FnMut(u32, Rect)) + Sync,
    ) -> Self {
        let columns = viewport.width().div_ceil(side);
        let rows = viewport.height().div_ceil(side);
        let whole = Rect { left: 0, top: 0, right: viewport.width() as i32, bottom: viewport.height() as i32 };
        let chunks: Vec<Vec<(u32, u32)>> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut pairs = vec![];
                let mut add = |id: u32, rect: Rect| {
                    let rect = rect.intersection(whole);
                    if rect.is_empty() {
                        return;
                    }
                    let range = |start: i32, end: i32| start as usize / side..=(end - 1) as usize / side;
                    for row in range(rect.top, rect.bottom) {
                        pairs.extend(range(rect.left, rect.right).map(|c| ((row * columns + c) as u32, id)));
                    }
                };
                for i in chunk * CHUNK..count.min((chunk + 1) * CHUNK) {
                    boxes(i, &mut add);
                }
                pairs
            })
            .collect();
        let mut starts = vec![0u32; columns * rows + 1];
        for (bin, _) in chunks.iter().flatten() {
            starts[*bin as usize + 1] += 1;
        }
        for i in 0..columns * rows {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut triangles = vec![0u32; starts[columns * rows] as usize];
        for (bin, id) in chunks.into_iter().flatten() {
            let place = &mut next[bin as usize];
            triangles[*place as usize] = id;
            *place += 1;
        }
        Self { side, columns, starts, triangles }
    }

    /// The triangles of the square that holds pixel (x, y).
    pub fn of_pixel(&self, x: usize, y: usize) -> &[u32] {
        let bin = y / self.side * self.columns + x / self.side;
        &self.triangles[self.starts[bin] as usize..self.starts[bin + 1] as usize]
    }
}

//! The CPU rasterizer: the fixed-function stages of a GPU, then the fragment program, all of it the same on every machine.
//!
//! A [`Rasterizer`] draws tile by tile: first who is seen, which a technique answers by its [`Visibility`], then the fragment
//! program of [`pipeline::fragment`] for the pixels that are seen, many pixels of a face at a time. The result goes
//! into a [`GBuffer`]. A [`PointSampler`] answers what would be seen if a sample stood elsewhere than at a pixel's centre.
//!
//! What techniques share stands here: the vertex stage ([`vertex`]), clipping ([`clip`]), triangles in the picture
//! ([`geometry`], [`setup`]), which pixels they cover ([`coverage`], [`bins`]) and which of them is nearest ([`depth`]).
//!
//! Every number is made by IEEE `+ − × ÷ √` in a fixed order, and no task reads what another writes: the G-buffer
//! does not depend on the number of threads.

pub mod bins;
pub mod clip;
pub mod coverage;
pub mod depth;
mod drawing;
pub mod geometry;
pub mod rect;
mod resolve;
mod sampler;
pub mod setup;
pub mod vertex;
pub mod visibility;

pub use drawing::{Drawing, Options};
pub use sampler::PointSampler;

use crate::rect::{Rect, TILE};
use crate::resolve::Tile;
use crate::visibility::Visibility;
use gbuffer::{GBuffer, Meta};
use rayon::prelude::*;
use std::cell::RefCell;

/// Pixels that are held twice, as tiles and as rows, at most (or one row of tiles): bounds memory, not the result.
const PIXELS_AT_ONCE: usize = 1 << 18;

/// A drawing, and who is seen in it.
pub struct Rasterizer<'a> {
    drawing: Drawing<'a>,
    visibility: Box<dyn Visibility + 'a>,
}

impl<'a> Rasterizer<'a> {
    /// Draws what a technique says is seen; `visibility` is of the same drawing.
    pub fn new(drawing: Drawing<'a>, visibility: Box<dyn Visibility + 'a>) -> Self {
        Self { drawing, visibility }
    }

    /// Draws the whole picture. `progress` is called with the number of pixels done since its last call, from any thread.
    ///
    /// Pixels for which the technique has no answer are entered as undecided. The result is the same to
    /// the bit for any number of threads.
    pub fn render(&self, meta: Meta, progress: &(dyn Fn(usize) + Sync)) -> GBuffer {
        let viewport = self.drawing.viewport;
        let (width, height) = (viewport.width(), viewport.height());
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let together = (PIXELS_AT_ONCE / (columns * TILE * TILE)).max(1);
        let bands = (0..rows).step_by(together).map(|first| first..rows.min(first + together));
        let undecided = RefCell::new(vec![]);
        let picture = bands.flat_map(|band| {
            let first = band.start;
            let tiles: Vec<Tile> = (band.start * columns..band.end * columns)
                .into_par_iter()
                .map(|i| {
                    let (left, top) = (i % columns * TILE, i / columns * TILE);
                    let rect = Rect {
                        left: left as i32,
                        top: top as i32,
                        right: width.min(left + TILE) as i32,
                        bottom: height.min(top + TILE) as i32,
                    };
                    let tile = resolve::tile(&self.drawing, &*self.visibility, rect);
                    progress((rect.right - rect.left) as usize * (rect.bottom - rect.top) as usize);
                    tile
                })
                .collect();
            undecided.borrow_mut().extend(tiles.iter().flat_map(|tile| &tile.undecided).copied());
            (band.start * TILE..height.min(band.end * TILE)).map(move |y| {
                let mut row = Vec::with_capacity(columns * TILE);
                for tile in &tiles[(y / TILE - first) * columns..][..columns] {
                    match tile.hits.get(y % TILE * TILE..) {
                        Some(rest) if !rest.is_empty() => row.extend_from_slice(&rest[..TILE]),
                        _ => row.extend([None; TILE]),
                    }
                }
                row.truncate(width);
                row
            })
        });
        let buffer = GBuffer::from_rows(viewport, meta, picture);
        buffer.with_undecided(undecided.into_inner()).with_edges(self.drawing.scene.has_edges())
    }

    /// Prepares to answer single samples.
    pub fn sampler(&self) -> PointSampler<'_> {
        PointSampler::new(&self.drawing, self.visibility.samples())
    }
}

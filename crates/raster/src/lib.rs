//! The CPU rasterizer: the fixed-function stages of a GPU, then the fragment program, all of it the same on every machine.
//!
//! A [`Rasterizer`] runs a [`Proxy`]'s corners through the vertex stage, clips, and then draws tile by tile: first who
//! is seen (coverage and depth), then the fragment program of [`pipeline::fragment`] for the pixels that are seen, many
//! pixels of a face at a time. The result goes into a [`GBuffer`]. A [`PointSampler`] answers what would be seen if a
//! sample stood elsewhere than at a pixel's centre.
//!
//! Every number is made by IEEE `+ − × ÷ √` in a fixed order, and no task reads what another writes: the G-buffer
//! does not depend on the number of threads.

mod bins;
pub mod clip;
pub mod coverage;
mod cut;
pub mod depth;
mod exact;
mod geometry;
pub mod rect;
mod sampler;
pub mod setup;
mod tile;
pub mod vertex;

pub use sampler::PointSampler;

use crate::bins::Bins;
use crate::depth::TILE;
use crate::geometry::Geometry;
use crate::rect::Rect;
use crate::tile::Tile;
use gbuffer::{GBuffer, Meta};
use pipeline::{PackedScene, Proxy, View};
use rayon::prelude::*;
use scene::{Camera, Viewport};
use std::cell::RefCell;

/// Pixels that are held twice, as tiles and as rows, at most (or one row of tiles): bounds memory, not the result.
const PIXELS_AT_ONCE: usize = 1 << 18;

/// What is computed at a fragment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// Whether principal curvatures are.
    pub curvature: bool,
    /// Whether a hit's normal is the one interpolated from the corners (Kanai 2007, Fig. 3, left) instead of the
    /// surface's own at the fragment. All else stays.
    pub interpolated_normals: bool,
}

/// What is drawn, and how it is seen.
#[derive(Debug, Clone, Copy)]
pub struct Drawing<'a> {
    /// The packed faces.
    pub scene: &'a PackedScene,
    /// Their triangles, drawn in the order of their indices.
    pub proxy: &'a Proxy,
    /// How each face is seen: [`PackedScene::views`] of the same camera and viewport.
    pub views: &'a [View],
    /// The camera, for the rays of pixels.
    pub camera: &'a Camera,
    /// The pixels.
    pub viewport: Viewport,
    /// What is computed.
    pub options: Options,
}

/// A drawing whose vertex stage and clipping are done.
#[derive(Debug)]
pub struct Rasterizer<'a> {
    drawing: Drawing<'a>,
    geometry: Geometry,
}

impl<'a> Rasterizer<'a> {
    /// Runs the vertex stage and clipping.
    pub fn new(drawing: Drawing<'a>) -> Self {
        Self { drawing, geometry: Geometry::new(&drawing) }
    }

    /// Draws the whole picture. `progress` is called with the number of pixels done since its last call, from any thread.
    ///
    /// Pixels in which a search of technique `exact` has not converged are entered as undecided. The result is the same to
    /// the bit for any number of threads.
    pub fn render(&self, meta: Meta, progress: &(dyn Fn(usize) + Sync)) -> GBuffer {
        let viewport = self.drawing.viewport;
        let (width, height) = (viewport.width(), viewport.height());
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let bins =
            Bins::new(viewport, TILE, self.geometry.triangles(), |i, add| self.geometry.boxes(&self.drawing, i, add));
        let together = (PIXELS_AT_ONCE / (columns * TILE * TILE)).max(1);
        let bands = (0..rows).step_by(together).map(|first| first..rows.min(first + together));
        let unconverged = RefCell::new(vec![]);
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
                    let tile = tile::render(self, bins.of_pixel(left, top), rect);
                    progress((rect.right - rect.left) as usize * (rect.bottom - rect.top) as usize);
                    tile
                })
                .collect();
            unconverged.borrow_mut().extend(tiles.iter().flat_map(|tile| &tile.unconverged).copied());
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
        buffer.with_undecided(unconverged.into_inner()).with_edges(self.drawing.scene.has_edges())
    }

    /// Prepares to answer single samples.
    pub fn sampler(&self) -> PointSampler<'_> {
        PointSampler::new(self)
    }
}

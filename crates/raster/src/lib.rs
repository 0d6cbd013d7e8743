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
//!
//! # Examples
//! ```
//! use gbuffer::Meta;
//! use glam::DVec3;
//! use nurbs::{KnotVector, Surface};
//! use pipeline::{PackedScene, Scheme};
//! use raster::{Drawing, Options, Rasterizer};
//! use scene::{Camera, Model, Viewport};
//!
//! let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0])?;
//! let points = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::X + DVec3::Y];
//! let model = Model::of_surfaces("square", vec![Surface::new(knots.clone(), knots, points, None)?])?;
//! let viewport = Viewport::new(64, 64)?;
//! let camera = Camera::framing(&model, viewport);
//! let scene = PackedScene::new(&model, Scheme::General)?;
//! let views = scene.views(&model, &camera, viewport);
//! // Who is seen is a technique's answer.
//! let setting = techniques::Setting {
//!     model: &model,
//!     scene: &scene,
//!     camera: &camera,
//!     viewport,
//!     chord_px: 0.25,
//!     limits: Default::default(),
//!     vertex_normals: false,
//! };
//! let prepared = techniques::named("fragment").expect("the default").prepare(&setting)?;
//! let drawing = Drawing { scene: &scene, views: &views, camera: &camera, viewport, options: Options::default() };
//! let rasterizer = Rasterizer::new(drawing, prepared.visibility(drawing));
//! let buffer = rasterizer.render(Meta::new("raster", "fragment", &model, &camera), &|_| ());
//! assert!(buffer.covered() > 100);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
use gbuffer::{GBuffer, Meta, Rows};
use rayon::prelude::*;

/// Pixels that are held twice, as tiles and as rows, at most (or one row of tiles): bounds memory, not the result. A thread has some
/// tiles of them each.
const PIXELS_AT_ONCE: usize = 1 << 18;

/// Fragments of a tile at most.
const FRAGMENTS: usize = TILE * TILE;

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
        let together = (PIXELS_AT_ONCE / (columns * TILE * TILE)).clamp(1, rows);
        let mut tiles: Vec<Tile> = (0..together * columns).map(|_| Tile::new()).collect();
        let mut picture = Rows::new(viewport, meta);
        let mut pixels = vec![];
        let mut undecided = vec![];
        for first in (0..rows).step_by(together) {
            let tiles = &mut tiles[..together.min(rows - first) * columns];
            tiles.par_iter_mut().enumerate().for_each(|(i, tile)| {
                let (left, top) = (i % columns * TILE, (first + i / columns) * TILE);
                let rect = Rect {
                    left: left as i32,
                    top: top as i32,
                    right: width.min(left + TILE) as i32,
                    bottom: height.min(top + TILE) as i32,
                };
                tile.draw(&self.drawing, &*self.visibility, rect);
                progress((rect.right - rect.left) as usize * (rect.bottom - rect.top) as usize);
            });
            undecided.extend(tiles.iter().flat_map(|tile| &tile.undecided).copied());
            let top = first * TILE;
            pixels.resize((height.min((first + together) * TILE) - top) * width, Rows::NOTHING);
            pixels.par_chunks_mut(width).enumerate().for_each(|(i, row)| {
                let start = i / TILE * columns;
                let seen = (start..start + columns).flat_map(|tile| {
                    let number = move |fragment: u16| (tile * FRAGMENTS + usize::from(fragment)) as u32;
                    tiles[tile].row(top + i).map(move |fragment| fragment.map_or(Rows::NOTHING, number))
                });
                row.iter_mut().zip(seen).for_each(|(pixel, seen)| *pixel = seen);
            });
            picture.extend(&pixels, |pixel| {
                let (tile, fragment) = (pixel as usize / FRAGMENTS, pixel as usize % FRAGMENTS);
                tiles[tile].hit(&self.drawing, fragment as u16)
            });
        }
        picture.finish().with_undecided(undecided).with_edges(self.drawing.scene.has_edges())
    }

    /// Prepares to answer single samples.
    pub fn sampler(&self) -> PointSampler<'_> {
        PointSampler::new(&self.drawing, self.visibility.samples())
    }
}

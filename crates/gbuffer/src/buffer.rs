//! The grid of hits.

use crate::Hit;
use rayon::prelude::*;
use scene::{Camera, Model, Viewport};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Marks a pixel without a hit.
pub(crate) const NO_HIT: u32 = u32::MAX;

/// How the faces of a G-buffer were trimmed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Trims {
    /// By their curves, or not at all.
    #[default]
    Exact,
    /// By masks.
    Masks {
        /// How far an edge may be off at its face's nearest depth, pixels; as much along u as along v, each at most half.
        error_px: f64,
    },
}

/// Where a G-buffer comes from: what a reader needs to repeat or to judge it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Meta {
    /// Which renderer made it: `raster`, `gpu`, `raycast`, or the name of a foreign one.
    pub renderer: String,
    /// The technique: `fragment`, `exact`, or `rays` for a ray caster.
    pub technique: String,
    /// How faces were trimmed.
    pub trims: Trims,
    /// Name of the model.
    pub model: String,
    /// [`Model::hash`] of the model.
    pub model_hash: String,
    /// The camera, as the JSON that `scene::Camera` serialises to.
    pub camera: Value,
    /// GPU adapter, where one was used.
    pub adapter: Option<String>,
    /// Its driver.
    pub driver: Option<String>,
    /// What made the adapter's programs of WGSL: `naga`, `tint` …
    #[serde(default)]
    pub compiler: Option<String>,
    /// Version of the program.
    pub version: String,
}

impl Meta {
    /// The facts of a rendering of `model` as `camera` sees it, by a renderer of this program that trims exactly.
    pub fn new(renderer: &str, technique: &str, model: &Model, camera: &Camera) -> Self {
        Self {
            renderer: renderer.to_owned(),
            technique: technique.to_owned(),
            trims: Trims::Exact,
            model: model.name().to_owned(),
            model_hash: model.hash(),
            camera: json!(camera),
            adapter: None,
            driver: None,
            compiler: None,
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }
}

/// The fields of a [`GBuffer`], as a file's reader finds them.
pub(crate) struct Parts {
    /// The size.
    pub viewport: Viewport,
    /// Where it comes from.
    pub meta: Meta,
    /// Per pixel, index into `hits`, or [`NO_HIT`].
    pub index: Vec<u32>,
    /// The hits in row-major order.
    pub hits: Vec<Hit>,
    /// Undecided pixels in row-major order.
    pub undecided: Vec<u32>,
    /// Whether trim edges were asked for.
    pub edges: bool,
}

/// A viewport of hits. Memory is 4 bytes a pixel and one [`Hit`] a covered pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct GBuffer {
    viewport: Viewport,
    meta: Meta,
    /// Per pixel, row-major from the top: index into `hits`, or [`NO_HIT`].
    index: Vec<u32>,
    hits: Vec<Hit>,
    /// Pixels that the renderer could not decide, in row-major order.
    undecided: Vec<u32>,
    edges: bool,
}

/// A G-buffer whose rows come band by band, each made by many threads in the place where it stays.
pub struct Rows {
    viewport: Viewport,
    meta: Meta,
    index: Vec<u32>,
    hits: Vec<Hit>,
}

impl Rows {
    /// Marks a pixel that sees nothing in [`Self::extend`].
    pub const NOTHING: u32 = NO_HIT;

    /// No rows yet.
    pub fn new(viewport: Viewport, meta: Meta) -> Self {
        Self { viewport, meta, index: Vec::with_capacity(viewport.pixels()), hits: vec![] }
    }

    /// Appends whole rows, the next ones from the top. A pixel is a number that `hit` knows, or [`Self::NOTHING`]; each is
    /// asked for once, from any thread.
    pub fn extend(&mut self, pixels: &[u32], hit: impl Fn(u32) -> Hit + Sync) {
        let width = self.viewport.width();
        let is_seen = |&&pixel: &&u32| pixel != Self::NOTHING;
        let counts: Vec<usize> = pixels.par_chunks(width).map(|row| row.iter().filter(is_seen).count()).collect();
        let mut seen = vec![0; counts.iter().sum()];
        let first = self.index.len();
        self.index.resize(first + pixels.len(), NO_HIT);
        let mut rows = Vec::with_capacity(counts.len());
        let (mut rest, mut next) = (&mut seen[..], self.hits.len() as u32);
        for count in counts {
            let (row, behind) = rest.split_at_mut(count);
            rows.push((row, next));
            (rest, next) = (behind, next + count as u32);
        }
        let index = self.index[first..].par_chunks_mut(width);
        pixels.par_chunks(width).zip(index).zip(rows).for_each(|((pixels, index), (seen, first))| {
            let places = pixels.iter().zip(index).filter(|(pixel, _)| is_seen(pixel));
            for (number, ((&pixel, place), seen)) in (first..).zip(places.zip(seen)) {
                (*place, *seen) = (number, pixel);
            }
        });
        self.hits.par_extend(seen.par_iter().map(|&pixel| hit(pixel)));
    }

    /// The picture.
    ///
    /// # Panics
    /// Where the rows do not fill the viewport.
    pub fn finish(self) -> GBuffer {
        let Self { viewport, meta, index, hits } = self;
        assert_eq!(index.len(), viewport.pixels(), "rows fill the viewport");
        GBuffer { viewport, meta, index, hits, undecided: vec![], edges: false }
    }
}

impl GBuffer {
    /// Gathers the rows of a picture, top row first; each row holds one entry a pixel.
    ///
    /// # Panics
    /// Where the rows do not fill the viewport.
    pub fn from_rows(viewport: Viewport, meta: Meta, rows: impl IntoIterator<Item = Vec<Option<Hit>>>) -> Self {
        let mut index = Vec::with_capacity(viewport.pixels());
        let mut hits = vec![];
        for row in rows {
            assert_eq!(row.len(), viewport.width(), "a row is as wide as the viewport");
            for hit in row {
                index.push(if hit.is_some() { hits.len() as u32 } else { NO_HIT });
                hits.extend(hit);
            }
        }
        assert_eq!(index.len(), viewport.pixels(), "there are as many rows as the viewport is high");
        Self { viewport, meta, index, hits, undecided: vec![], edges: false }
    }

    /// Puts together what a file's reader has found consistent.
    pub(crate) fn from_parts(parts: Parts) -> Self {
        let Parts { viewport, meta, index, hits, undecided, edges } = parts;
        Self { viewport, meta, index, hits, undecided, edges }
    }

    /// The same buffer with other facts about where it comes from.
    pub fn with_meta(mut self, meta: Meta) -> Self {
        self.meta = meta;
        self
    }

    /// The same buffer with a list of pixels (x, y) that the renderer could not decide.
    pub fn with_undecided(mut self, pixels: impl IntoIterator<Item = (usize, usize)>) -> Self {
        self.undecided = pixels.into_iter().map(|(x, y)| (y * self.viewport.width() + x) as u32).collect();
        self.undecided.sort_unstable();
        self.undecided.dedup();
        self
    }

    /// The same buffer, in which a hit without an edge says that none is near, or (`false`) that none was asked for.
    pub fn with_edges(self, edges: bool) -> Self {
        Self { edges, ..self }
    }

    /// Whether the renderer was asked for trim edges.
    pub fn has_edges(&self) -> bool {
        self.edges
    }

    /// Whether every hit, of which there are some, has parameters local to its spans.
    pub fn has_local(&self) -> bool {
        !self.hits.is_empty() && self.hits.iter().all(|hit| hit.local.is_some())
    }

    /// The size.
    pub fn viewport(&self) -> Viewport {
        self.viewport
    }

    /// Where it comes from.
    pub fn meta(&self) -> &Meta {
        &self.meta
    }

    /// The hit of pixel (x, y), or `None` where nothing is seen.
    ///
    /// # Panics
    /// Outside the viewport.
    pub fn get(&self, x: usize, y: usize) -> Option<&Hit> {
        assert!(x < self.viewport.width(), "x inside the viewport");
        match self.index[y * self.viewport.width() + x] {
            NO_HIT => None,
            i => Some(&self.hits[i as usize]),
        }
    }

    /// All pixels in row-major order.
    pub fn pixels(&self) -> impl Iterator<Item = Option<&Hit>> {
        self.index.iter().map(|&i| (i != NO_HIT).then(|| &self.hits[i as usize]))
    }

    /// Number of covered pixels.
    pub fn covered(&self) -> usize {
        self.hits.len()
    }

    /// Whether the renderer said that it could not decide pixel (x, y).
    pub fn is_undecided(&self, x: usize, y: usize) -> bool {
        self.undecided.binary_search(&((y * self.viewport.width() + x) as u32)).is_ok()
    }

    /// How many pixels the renderer could not decide.
    pub fn undecided(&self) -> usize {
        self.undecided.len()
    }
}

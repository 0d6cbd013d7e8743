//! What grids may come to, whatever the error asks for.

use crate::triangles::coarsened::REFINED_TRIANGLES;

/// log₂ of the cells of a patch in one direction at most.
pub const GREATEST_LEVEL: u32 = 11;

/// Zones that one step emits unless another number is asked for. Their corners take 13 MB.
pub const DEFAULT_ZONES: u32 = 8192;

/// Numbers of 32 bits that a zone is, where a kernel says which ones there are: grid, row, column and step.
pub const ZONE_WORDS: u32 = 4;

/// Zones of a step in Concheiro et al. 2011: a geometry shader emits at most 1024 words.
pub const PAPER_ZONES: u32 = 1024 / ZONE_WORDS;

/// What bounds grids and their zones. Techniques that draw neither have no limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Limits {
    /// log₂ of the cells of a patch along each side, at most [`GREATEST_LEVEL`]. Where so many leave more error than was asked
    /// for, [`Prepared::built_px`](crate::Prepared::built_px) says how much.
    pub level: u32,
    /// Zones that one step of technique `zones` emits at most; 0 counts as 1.
    pub zones: u32,
    /// Patches that one step of it draws at most, each of them whole; 0 counts as 1. Without it a step ends where its zones do,
    /// within a patch as well.
    pub batch: Option<u32>,
    /// Triangles up to which the error asked for decides: one that takes more is doubled until it does not. Technique `fragment` keeps to
    /// `REFINED_TRIANGLES`.
    pub triangles: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { level: GREATEST_LEVEL, zones: DEFAULT_ZONES, batch: None, triangles: REFINED_TRIANGLES }
    }
}

//! Arrays over the pixels of a picture: their shape, and how long the chunks are in which they are written and read.

use scene::Viewport;

/// Elements encoded or decoded at a time.
pub(super) const CHUNK_ELEMENTS: usize = 4096;

/// Rows, columns and, for vectors, components.
pub(super) fn shape(viewport: Viewport, components: Option<u64>) -> Vec<u64> {
    [viewport.height() as u64, viewport.width() as u64].into_iter().chain(components).collect()
}

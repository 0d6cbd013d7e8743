//! The depth test over one tile, and who is seen in each of its pixels.

use crate::rect::{Rect, TILE};

/// Marks a pixel that nothing covers.
const NOBODY: u32 = u32::MAX;

/// Depth and owner of every pixel of a tile.
#[derive(Debug, Clone)]
pub struct DepthTile {
    rect: Rect,
    depth: Vec<f32>,
    owner: Vec<u32>,
}

impl DepthTile {
    /// Cleared: reversed depth 0 is infinitely far.
    pub fn new(rect: Rect) -> Self {
        Self { rect, depth: vec![0.0; TILE * TILE], owner: vec![NOBODY; TILE * TILE] }
    }

    /// Where the pixel stands in a tile's arrays.
    pub fn index(&self, x: i32, y: i32) -> usize {
        (y - self.rect.top) as usize * TILE + (x - self.rect.left) as usize
    }

    /// Whether something of this depth would be seen: `Greater`, so that at equal depth the earlier one stays.
    pub fn passes(&self, x: i32, y: i32, depth: f32) -> bool {
        depth > self.depth[self.index(x, y)]
    }

    /// Tests and, where it passes, replaces.
    pub fn test(&mut self, x: i32, y: i32, depth: f32, owner: u32) {
        let i = self.index(x, y);
        if depth > self.depth[i] {
            self.depth[i] = depth;
            self.owner[i] = owner;
        }
    }

    /// The covered pixels as indices row × [`TILE`] + column, grouped by owner 0 … `owners` − 1 in order and row-major
    /// within each: all of them, and where each owner's start (with one more at the end).
    pub fn by_owner(&self, owners: usize) -> (Vec<u16>, Vec<u32>) {
        let mut starts = vec![0u32; owners + 1];
        for &owner in self.owner.iter().filter(|&&o| o != NOBODY) {
            starts[owner as usize + 1] += 1;
        }
        for i in 0..owners {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut pixels = vec![0u16; starts[owners] as usize];
        for (i, &owner) in self.owner.iter().enumerate().filter(|(_, o)| **o != NOBODY) {
            let place = &mut next[owner as usize];
            pixels[*place as usize] = i as u16;
            *place += 1;
        }
        (pixels, starts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_equal_depth_the_earlier_stays_and_the_nearer_wins() {
        let mut tile = DepthTile::new(Rect { left: 64, top: 0, right: 128, bottom: 64 });
        tile.test(64, 0, 0.5, 0);
        tile.test(64, 0, 0.5, 1);
        tile.test(65, 0, 0.5, 0);
        tile.test(65, 0, 0.75, 1);
        tile.test(66, 2, 0.25, 2);
        assert!(!tile.passes(64, 0, 0.5) && tile.passes(64, 0, 0.75));
        assert_eq!(tile.by_owner(3), (vec![0, 1, 130], vec![0, 1, 2, 3]));
    }
}

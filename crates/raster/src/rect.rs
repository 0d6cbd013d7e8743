//! Rectangles of pixels: tiles, bins, and the bounds of triangles.

/// Side of a tile, pixels.
pub const TILE: usize = 64;

/// A half-open rectangle of pixels; empty where it ends before it starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rect {
    /// First column.
    pub left: i32,
    /// First row.
    pub top: i32,
    /// One past the last column.
    pub right: i32,
    /// One past the last row.
    pub bottom: i32,
}

impl Rect {
    /// What both hold.
    pub fn intersection(self, other: Self) -> Self {
        Self {
            left: self.left.max(other.left),
            top: self.top.max(other.top),
            right: self.right.min(other.right),
            bottom: self.bottom.min(other.bottom),
        }
    }

    /// The pixel (x, y) of the picture that has a place, row × [`TILE`] + column, in the tile of this rectangle.
    #[inline]
    pub fn position(self, place: u16) -> (i32, i32) {
        (self.left + i32::from(place) % TILE as i32, self.top + i32::from(place) / TILE as i32)
    }

    /// Whether it holds no pixel.
    pub fn is_empty(self) -> bool {
        self.right <= self.left || self.bottom <= self.top
    }
}

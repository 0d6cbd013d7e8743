//! The records of a patch's grid, as the CPU and the GPU read them. `shaders/grid/corner.wgsl` and `levels.wgsl` declare the same ones.

use bytemuck::{Pod, Zeroable};

/// [`GridRecord::sides`]: a skirt goes on beyond u = 0. The bits for u = 1, v = 0 and v = 1 follow.
pub const LOW_U: u32 = 1;

/// [`GridRecord::sides`]: a skirt goes on beyond v = 0.
pub const LOW_V: u32 = 4;

/// [`GridRecord::sides`]: the patch is out of the picture, and nothing of it is drawn.
pub const OUT: u32 = 16;

/// Where all patches that meet at a corner evaluate it. 24 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct CornerRecord {
    /// The face.
    pub face: u32,
    /// Unused.
    pub padding: u32,
    /// Its spans.
    pub span: [u32; 2],
    /// Parameters there.
    pub uv: [f32; 2],
}

/// Where all patches that share a border evaluate it, and in how many parts. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct BorderRecord {
    /// The face.
    pub face: u32,
    /// It has 2^level parts.
    pub level: u32,
    /// The face's spans.
    pub span: [u32; 2],
    /// Parameters there at this border's start, where the grid's own are least.
    pub start: [f32; 2],
    /// The same at its end.
    pub end: [f32; 2],
}

/// The grid of a Bézier patch, or of a part of one whose weights vary much. 272 bytes.
///
/// What a view decides is 0 before `levels::settled`: the levels, the sides and the skirt.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct GridRecord {
    /// The face.
    pub face: u32,
    /// On which sides it has a skirt: a bit each, u = 0 the lowest; 16 where it is out of the picture.
    pub sides: u32,
    /// The face's spans.
    pub span: [u32; 2],
    /// It has 2^level cells along u and along v, besides skirts.
    pub level: [u32; 2],
    /// The least parameters of the part; each 0 where it is the whole patch.
    pub from: [f32; 2],
    /// How far its parameters run; each 1 where it is the whole patch.
    pub size: [f32; 2],
    /// The skirt's width, local units.
    pub skirt: f32,
    /// Unused.
    pub padding: u32,
    /// u = 0, u = 1, v = 0, v = 1.
    pub borders: [BorderRecord; 4],
    /// (0, 0), (0, 1), (1, 0), (1, 1).
    pub corners: [CornerRecord; 4],
}

/// What a patch's levels depend on besides the view. 64 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Measure {
    /// The middle of a box that holds the patch, with all its parts, local units of its face.
    pub center: [f32; 3],
    /// The box's diagonal.
    pub diagonal: f32,
    /// Half its edges, rounded outward.
    pub half: [f32; 3],
    /// For u = 0, u = 1, v = 0 and v = 1 a byte, the least first: a skirt is there at levels below it.
    pub skirts: u32,
    /// |S_uu|, 2 |S_uv| and |S_vv| at most, over 8, by parameters that are 0 … 1 across the patch.
    pub bend: [f32; 3],
    /// The least levels that it may have, whatever the view: along u in the lower 16 bits, along v above.
    pub floor: u32,
    /// The groups of borders that its sides are of, as [`GridRecord::borders`].
    pub groups: [u32; 4],
}

impl Measure {
    /// Its least levels along u and along v, as [`Self::floor`] has them.
    pub fn packed_floor([u, v]: [u32; 2]) -> u32 {
        u | v << 16
    }

    /// [`Self::floor`], along u and along v.
    pub fn least(&self) -> [u32; 2] {
        [self.floor & 0xffff, self.floor >> 16]
    }
}

impl GridRecord {
    /// Cells along u and along v, those of skirts too; none out of the picture.
    pub fn cells(&self) -> [u32; 2] {
        if self.sides & OUT != 0 {
            return [0, 0];
        }
        [0, 1].map(|k| (1 << self.level[k]) + (self.sides >> (2 * k) & 3).count_ones())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_have_the_sizes_that_wgsl_gives_them() {
        assert_eq!((size_of::<CornerRecord>(), size_of::<BorderRecord>(), size_of::<GridRecord>()), (24, 32, 272));
        assert_eq!(size_of::<Measure>(), 64);
    }
}

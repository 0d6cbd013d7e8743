//! Grids of places to which rasterizers snap the corners of triangles, and which of them slanted edges tell of.

/// As in `shaders/snapping.wgsl`, like the next.
pub(crate) const QUADS: u32 = 64;
pub(crate) const LENGTH: u32 = 4096;

/// Bits of a pixel that grids are looked for with: Vulkan asks for the least of them, and more than the most move nothing that
/// the picture could tell.
const BITS: std::ops::RangeInclusive<u32> = 4..=11;

/// A pixel more or less of an edge's length may be rounding of the edge itself: 1/2048 pixel of its end.
const SLACK: u32 = 1;

/// How coordinates go to the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rounding {
    /// To the nearest place.
    Nearest,
    /// All to the same side.
    OneWay,
}

/// A grid of places for corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    /// It has 2^`bits` places to a pixel along each side.
    pub bits: u32,
    /// How corners go there.
    pub rounding: Rounding,
}

impl Grid {
    /// How far a coordinate is moved at most, pixels.
    pub fn moves_px(self) -> f64 {
        let step = 0.5f64.powi(self.bits as i32);
        match self.rounding {
            Rounding::Nearest => 0.5 * step,
            Rounding::OneWay => step,
        }
    }
}

impl std::fmt::Display for Grid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let how = match self.rounding {
            Rounding::Nearest => "to the nearest",
            Rounding::OneWay => "one way",
        };
        write!(f, "1/{} px, {how}", 1u32 << self.bits)
    }
}

/// Where a coordinate goes, by the side that it goes to.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    Nearest,
    Lower,
    Upper,
}

impl Side {
    fn snapped(self, x: f64, bits: u32) -> f64 {
        let places = f64::from(1u32 << bits);
        let place = match self {
            Self::Nearest => (x * places).round(),
            Self::Lower => (x * places).floor(),
            Self::Upper => (x * places).ceil(),
        };
        place / places
    }
}

/// Where the end of a quad's edge is, pixels. Twin: `start` in `shaders/snapping.wgsl`.
fn start(quad: u32) -> f64 {
    f64::from(2 * (quad * 1237 % 2048) + 1) / 8192.0
}

/// How many pixels in the line of centres half a pixel across an edge covers that goes from `start` to one pixel across. The edge
/// meets no centre of them: that would take a length with more factors of two.
fn length(start: f64) -> u32 {
    let covers = |k: &u32| start + (1.0 - start) * (f64::from(*k) + 0.5) / f64::from(LENGTH) < 0.5;
    (0..LENGTH).take_while(covers).count() as u32
}

/// The grid along one side by which edges are as long as was found; `None` where there is none.
pub(crate) fn fitting(found: &[u32]) -> Option<Grid> {
    let sides = [Side::Nearest, Side::Lower, Side::Upper];
    let all = BITS.flat_map(|bits| sides.map(|side| (bits, side)));
    let off = |(bits, side): (u32, Side)| {
        let expected = (0..QUADS).map(|quad| length(side.snapped(start(quad), bits)));
        let off: Vec<u32> = found.iter().zip(expected).map(|(found, expected)| found.abs_diff(expected)).collect();
        off.iter().all(|off| *off <= SLACK).then(|| off.iter().sum::<u32>())
    };
    let fits = all.filter_map(|grid| Some((off(grid)?, grid)));
    let (_, (bits, side)) = fits.min_by_key(|(off, _)| *off)?;
    Some(Grid { bits, rounding: if side == Side::Nearest { Rounding::Nearest } else { Rounding::OneWay } })
}

/// The coarser of two sides' grids.
pub(crate) fn either(across: Grid, down: Grid) -> Grid {
    let is_nearest = across.rounding == Rounding::Nearest && down.rounding == Rounding::Nearest;
    let rounding = if is_nearest { Rounding::Nearest } else { Rounding::OneWay };
    Grid { bits: across.bits.min(down.bits), rounding }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lengths(snapped: impl Fn(f64) -> f64) -> Vec<u32> {
        (0..QUADS).map(|quad| length(snapped(start(quad)))).collect()
    }

    #[test]
    fn each_grid_is_told_from_all_others() {
        for bits in BITS {
            for side in [Side::Nearest, Side::Lower, Side::Upper] {
                let found = fitting(&lengths(|x| side.snapped(x, bits)));
                let rounding = if side == Side::Nearest { Rounding::Nearest } else { Rounding::OneWay };
                assert_eq!(found, Some(Grid { bits, rounding }), "{side:?}");
            }
        }
    }

    /// A picture that is moved is no coarser grid, which would be allowed more; nor is one coarser than is legal.
    #[test]
    fn what_is_moved_or_torn_or_coarser_than_legal_is_no_grid() {
        for bits in [4, 8] {
            for moved in [1.0 / 64.0, -1.0 / 64.0, 1.0 / 32.0, 1.0 / 300.0] {
                assert_eq!(fitting(&lengths(|x| Side::Nearest.snapped(x, bits) + moved)), None, "{bits}, {moved}");
            }
        }
        assert_eq!(fitting(&lengths(|x| Side::Nearest.snapped(x, 3))), None);
        let mut torn = lengths(|x| Side::Nearest.snapped(x, 8));
        torn[17] += 9;
        assert_eq!(fitting(&torn), None);
        assert_eq!(fitting(&[0; QUADS as usize]), None);
    }

    #[test]
    fn a_grid_moves_a_coordinate_by_half_a_step_or_a_whole_one() {
        let grid = |bits, rounding| Grid { bits, rounding };
        assert_eq!(grid(8, Rounding::Nearest).moves_px(), 1.0 / 512.0);
        assert_eq!(grid(4, Rounding::OneWay).moves_px(), 1.0 / 16.0);
        let both = either(grid(8, Rounding::Nearest), grid(4, Rounding::OneWay));
        assert_eq!(both, grid(4, Rounding::OneWay));
        assert_eq!(either(both, grid(8, Rounding::Nearest)), both);
    }
}

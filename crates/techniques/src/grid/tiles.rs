//! Grids in tiles of at most 8 × 8 cells, in the order in which they are drawn. Twin of `shaders/grid/tiles.wgsl`.
//!
//! Tiles of one program and size are the instances of one draw call, so that as many calls draw any number of patches, and the
//! corners of a tile are evaluated once. A skirt is a row of tiles of its own.

use super::record::{GridRecord, LOW_U};
use pipeline::Program;
use std::ops::Range;

/// log₂ of the cells of a tile along each side at most.
pub const GREATEST_SIDE: u32 = 3;

/// How many sizes of tiles there are along a side.
pub const SIDES: u32 = GREATEST_SIDE + 1;

/// How many sizes there are.
pub const SIZES: u32 = SIDES * SIDES;

/// Cells of some grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// The grid.
    pub grid: u32,
    /// Its first row and column there.
    pub at: [u32; 2],
}

/// Tiles that one draw call instances.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The program.
    pub program: Program,
    /// log₂ of the cells of each along u and along v.
    pub size: [u32; 2],
    /// The tiles.
    pub tiles: Range<usize>,
}

/// Rows or columns of a grid that are cut alike.
#[derive(Clone, Copy)]
struct Band {
    start: u32,
    length: u32,
    /// log₂ of a tile's cells across it.
    side: u32,
}

/// The low skirt, the patch and the high skirt along u or v.
fn bands(record: &GridRecord, k: usize) -> [Band; 3] {
    let [low, high] = [0, 1].map(|end| u32::from(record.sides & LOW_U << (2 * k + end) != 0));
    let length = if record.cells() == [0, 0] { 0 } else { 1 << record.level[k] };
    let side = record.level[k].min(GREATEST_SIDE);
    [
        Band { start: 0, length: low, side: 0 },
        Band { start: low, length, side },
        Band { start: low + length, length: high, side: 0 },
    ]
}

/// The tiles of a size that a grid has, in order.
pub fn tiles(record: &GridRecord, size: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let [rows, columns] = [0, 1].map(|k| bands(record, k));
    let pairs = rows.into_iter().flat_map(move |row| columns.map(|column| [row, column]));
    let of_size = move |pair: &[Band; 2]| (0..2).all(|k| pair[k].side == size[k]);
    let starts = |band: Band| (band.start..band.start + band.length).step_by(1 << band.side);
    pairs
        .filter(of_size)
        .flat_map(move |[row, column]| starts(row).flat_map(move |i| starts(column).map(move |j| [i, j])))
}

/// All tiles of grids in drawing order; `programs` holds those of each program.
pub fn in_drawing_order(records: &[GridRecord], programs: &[(Program, Range<usize>)]) -> (Vec<Tile>, Vec<Run>) {
    let (mut all, mut runs) = (vec![], vec![]);
    for (program, grids) in programs {
        for size in (0..SIDES).flat_map(|u| (0..SIDES).map(move |v| [u, v])) {
            let start = all.len();
            for grid in grids.clone() {
                all.extend(tiles(&records[grid], size).map(|at| Tile { grid: grid as u32, at }));
            }
            if all.len() > start {
                runs.push(Run { program: *program, size, tiles: start..all.len() });
            }
        }
    }
    (all, runs)
}

/// The corners of a size's triangles, two a cell, with its vertices numbered row by row.
pub fn indices([u, v]: [u32; 2]) -> impl Iterator<Item = u16> {
    let columns = (1 << v) + 1;
    let cells = (0..1 << u).flat_map(move |i| (0..1 << v).map(move |j| i * columns + j));
    cells.flat_map(move |first| crate::triangles::cell(first, columns)).map(|index| index as u16)
}

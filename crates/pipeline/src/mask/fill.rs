//! Masks drawn on the CPU.

use super::plan::{MaskFill, MaskPlan};
use super::tile::{Ring, Tile, curve_point};
use earcut::Earcut;
use rayon::prelude::*;
use tiny_skia::{FillRule, Mask, Path, PathBuilder, Transform};

impl MaskPlan {
    /// The texels of the atlas, row-major; 255 is material.
    pub fn fill(&self, fill: MaskFill) -> Vec<u8> {
        let width = self.size[0] as usize;
        let mut texels = vec![0; width * self.size[1] as usize];
        let drawn: Vec<(&Tile, Vec<u8>)> = self
            .tiles
            .par_iter()
            .flatten()
            .filter(|tile| !tile.size.contains(&0))
            .map(|tile| (tile, self.mask(tile, fill)))
            .collect();
        for (tile, mask) in drawn {
            let [x, y] = tile.corner.map(|x| x as usize);
            for (row, line) in mask.chunks_exact(tile.size[0] as usize).enumerate() {
                texels[(y + row) * width + x..][..line.len()].copy_from_slice(line);
            }
        }
        texels
    }

    /// The points of a loop, texels from the corner of its tile, the first not repeated.
    pub fn polygon(&self, ring: &Ring) -> Vec<[f32; 2]> {
        let mut points = vec![];
        for curve in &self.curves[ring.curves.clone()] {
            let control = &self.control[curve.control as usize..][..=curve.degree as usize];
            points.extend((0..curve.chords).map(|k| curve_point(control, k as f32 / curve.chords as f32)));
        }
        points
    }

    fn mask(&self, tile: &Tile, fill: MaskFill) -> Vec<u8> {
        let polygons = tile.rings.iter().map(|ring| (ring.depth, self.polygon(ring)));
        match fill {
            MaskFill::EvenOdd => {
                let mut mask = blank(tile);
                let contours: Vec<Vec<[f32; 2]>> = polygons.map(|(_, polygon)| polygon).collect();
                draw(&mut mask, path(contours), FillRule::EvenOdd);
                mask.take()
            }
            MaskFill::Earcut => {
                let mut polygons: Vec<(usize, Vec<[f32; 2]>)> = polygons.collect();
                polygons.sort_by_key(|(depth, _)| *depth);
                let mut painted = vec![0; tile.size.iter().map(|&side| side as usize).product()];
                for (depth, polygon) in polygons {
                    let mut mask = blank(tile);
                    draw(&mut mask, path(triangles(&polygon)), FillRule::Winding);
                    let value = if depth % 2 == 0 { 255 } else { 0 };
                    let covered = painted.iter_mut().zip(mask.data());
                    covered.filter(|(_, covers)| **covers > 0).for_each(|(texel, _)| *texel = value);
                }
                painted
            }
        }
    }
}

fn blank(tile: &Tile) -> Mask {
    Mask::new(tile.size[0], tile.size[1]).expect("a tile has texels, and its sides are far below 2³¹")
}

/// Nothing is drawn of what has no extent.
fn draw(mask: &mut Mask, path: Option<Path>, rule: FillRule) {
    if let Some(path) = path {
        mask.fill_path(&path, rule, false, Transform::identity());
    }
}

fn path(contours: impl IntoIterator<Item = Vec<[f32; 2]>>) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for contour in contours {
        for (i, [x, y]) in contour.into_iter().enumerate() {
            if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        builder.close();
    }
    builder.finish()
}

/// The triangles of a polygon, all of one orientation.
fn triangles(polygon: &[[f32; 2]]) -> Vec<Vec<[f32; 2]>> {
    let mut indices: Vec<usize> = vec![];
    Earcut::new().earcut(polygon.iter().copied(), &[], &mut indices);
    indices.chunks_exact(3).map(|corners| corners.iter().map(|&i| polygon[i]).collect()).collect()
}

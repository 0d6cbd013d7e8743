//! How fine each grid is in a picture. Twin of `shaders/grid/levels.wgsl`, which chooses the same levels, to the bit.
//!
//! Only `+`, `−` and `×` of f32 in a fixed order decide, and powers of two: WGSL rounds these as IEEE does. A compiler may fuse
//! them, and the shader keeps it from that.

use super::record::{GridRecord, LOW_U, Measure, OUT};
use pipeline::View;
use rayon::prelude::*;

/// How much wider than the picture is what counts as in it, as a share of half of it.
pub const WIDE: f32 = 1.0 + 1.0 / 16.0;

/// What rounding may change of a sum of four products, as a share of their sizes.
pub const ROUNDING: f32 = 1.0 / (1 << 20) as f32;

/// A box is at least this share of its diagonal away, where pixels are measured on it ([`scene::Camera::pixel_at`]).
pub const NEAREST_SHARE: f32 = 1.0 / 16.0;

/// How much wider than the error a skirt is, pixels ([`crate::triangles::SKIRT_PX`]).
pub const SKIRT_PX: f32 = crate::triangles::SKIRT_PX as f32;

/// What levels are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Asked {
    /// How far flat cells may be off the surface, pixels.
    pub error_px: f32,
    /// The reciprocal of it: on a GPU a quotient is not the same to the bit, a product is.
    pub per_error: f32,
    /// The greatest level that may be chosen.
    pub most: u32,
}

impl Asked {
    /// So many pixels at most, by levels up to `most`.
    pub fn new(error_px: f64, most: u32) -> Self {
        let error_px = error_px as f32;
        Self { error_px, per_error: 1.0 / error_px, most }
    }
}

/// What a view decides of a patch alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chosen {
    /// Its levels.
    pub level: [u32; 2],
    /// What a pixel measures where the patch is nearest, local units; where the greatest level leaves more than the error, so
    /// much more that skirts are as wide.
    pub pixel: f32,
    /// How many times the error its cells may be off: 1 where levels keep to it.
    pub short: f32,
    /// Whether it may be in the picture.
    pub is_seen: bool,
}

/// A plane (n, d), with the least and the greatest of n · p + d in a box.
fn range(plane: [f32; 4], measure: &Measure) -> [f32; 2] {
    let [a, b, c, d] = plane;
    let [x, y, z] = measure.center;
    let [i, j, k] = measure.half;
    let middle = a * x + b * y + c * z + d;
    let spread = a.abs() * i + b.abs() * j + c.abs() * k;
    let size = a.abs() * x.abs() + b.abs() * y.abs() + c.abs() * z.abs() + d.abs();
    let reach = spread + ROUNDING * (size + spread);
    [middle - reach, middle + reach]
}

/// The levels of a patch as one view has it.
pub fn chosen(measure: &Measure, view: &View, asked: &Asked) -> Chosen {
    let row = |k: usize| view.clip_from_local.map(|column| column[k]);
    let [x, y, z, w] = [0, 1, 2, 3].map(row);
    let wide = w.map(|t| WIDE * t);
    let sum = |a: [f32; 4], b: [f32; 4]| std::array::from_fn(|k| a[k] + b[k]);
    let difference = |a: [f32; 4], b: [f32; 4]| std::array::from_fn(|k| a[k] - b[k]);
    let planes = [difference(wide, x), sum(wide, x), difference(wide, y), sum(wide, y), difference(w, z)];
    let is_seen = planes.iter().all(|plane| range(*plane, measure)[1] >= 0.0);
    let forward = w[0].abs().max(w[1].abs()).max(w[2].abs());
    let nearest = range(w, measure)[0].max(NEAREST_SHARE * measure.diagonal * forward);
    let pixel = view.units[3] * nearest;
    let allowed = asked.error_px * pixel;
    let level = level(measure.bend, allowed, measure.least(), asked.most);
    let off = chord(measure.bend, level);
    let widened = off * asked.per_error;
    if off > allowed && widened <= f32::MAX {
        Chosen { level, pixel: widened, short: off / allowed, is_seen }
    } else {
        Chosen { level, pixel, short: 1.0, is_seen }
    }
}

/// The least levels from a floor on, the direction that gains more first, whose cells are off by so much at most.
fn level(bend: [f32; 3], allowed: f32, floor: [u32; 2], most: u32) -> [u32; 2] {
    let mut level = floor;
    while chord(bend, level) > allowed && level[0].min(level[1]) < most {
        let finer = [chord(bend, [level[0] + 1, level[1]]), chord(bend, [level[0], level[1] + 1])];
        let is_v = level[0] == most || (level[1] < most && finer[1] < finer[0]);
        level[usize::from(is_v)] += 1;
    }
    level
}

/// How far a grid's cells are off the surface at most (Filip, Magedson & Markot 1986, Theorem 1).
fn chord([uu, uv, vv]: [f32; 3], [k, l]: [u32; 2]) -> f32 {
    uu * power(2 * k) + uv * power(k + l) + vv * power(2 * l)
}

/// 2^−k, k up to 126.
fn power(k: u32) -> f32 {
    f32::from_bits((127 - k) << 23)
}

/// The records as one picture has them, and what each patch alone would have.
///
/// A border takes the greatest level that a patch in the picture beside it has chosen along it; each patch is refined to the
/// levels of its borders. The skirts of a face are as wide as the error is where a pixel measures most on it.
pub fn settled(
    records: &[GridRecord],
    measures: &[Measure],
    views: &[View],
    asked: &Asked,
) -> (Vec<GridRecord>, Vec<Chosen>) {
    let choose = |(record, measure): (&GridRecord, &Measure)| chosen(measure, &views[record.face as usize], asked);
    let chosen: Vec<Chosen> = records.par_iter().zip(measures).map(choose).collect();
    let mut borders = vec![0; 4 * records.len()];
    let mut pixels = vec![0.0f32; views.len()];
    for ((record, measure), Chosen { level: [u, v], pixel, .. }) in
        records.iter().zip(measures).zip(&chosen).filter(|(_, chosen)| chosen.is_seen)
    {
        // Along u = 0 and u = 1 runs v.
        for (group, level) in measure.groups.iter().zip([v, v, u, u]) {
            let border = &mut borders[*group as usize];
            *border = (*border).max(*level);
        }
        let of_face = &mut pixels[record.face as usize];
        *of_face = of_face.max(*pixel);
    }
    let settle = |((record, measure), chosen): ((&GridRecord, &Measure), &Chosen)| {
        let levels = measure.groups.map(|group| borders[group as usize]);
        let mut settled = *record;
        if !chosen.is_seen {
            settled.sides = OUT;
            return settled;
        }
        settled.level = [chosen.level[0].max(levels[2]).max(levels[3]), chosen.level[1].max(levels[0]).max(levels[1])];
        settled.sides = (0..4)
            .filter(|side| settled.level[side / 2] < measure.skirts >> (8 * side) & 255)
            .fold(0, |sides, side| sides | LOW_U << side);
        settled.skirt = (asked.error_px + SKIRT_PX) * pixels[record.face as usize];
        for (border, level) in settled.borders.iter_mut().zip(levels) {
            border.level = level;
        }
        settled
    };
    (records.par_iter().zip(measures).zip(&chosen).map(settle).collect(), chosen)
}

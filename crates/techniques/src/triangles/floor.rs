//! How fine a patch has to be cut so that something is known of normals that are interpolated over a cell, whatever the picture shows.
//!
//! A flat cell may be near a small or a narrow bend and know nothing of how it turns. So a patch has least levels, its floor. The cone that
//! holds all normals of a part ([`BezierPatch::normal_cone`]) says when a part is small enough; a patch is halved until its parts are.

use super::coarsened::REFINED_TRIANGLES;
use nurbs::BezierPatch;

/// The sine of how far normals may be off their cone's axis in a cell of a floor. The judge asks for 0.5 (`compare`), and follows triangles
/// beyond their edges, by which cones grow.
const WIDEST: f64 = 1.0 / 3.0;

/// No floor is higher.
pub const GREATEST_FLOOR: u32 = 6;

/// Parts of at most this share of the patch ask for nothing: about a cusp they would be ever smaller.
const LEFT: f64 = 1.0 / 256.0;

/// The least levels by which nearly all cells of a patch that may have narrow cones have them. Parts without one at the greatest floor,
/// as where a patch is folded to a line, ask for nothing.
pub fn floor(patch: &BezierPatch) -> [u32; 2] {
    let mut narrow = vec![];
    halve(patch, sine(patch), [0, 0], &mut narrow);
    let depth = |level: &[u32; 2]| level[0] + level[1];
    narrow.sort_by_key(|level| std::cmp::Reverse(depth(level)));
    let mut left: f64 = 0.0;
    let is_left = |level: &&[u32; 2]| {
        left += 0.5f64.powi(depth(level) as i32);
        left <= LEFT
    };
    let kept = narrow.iter().skip_while(is_left);
    kept.fold([0, 0], |floor, level| [0, 1].map(|k| level[k].max(floor[k])))
}

/// Halves a patch, in the direction that narrows its cone more, until it is narrow or as deep as a floor may be; collects the halvings
/// along u and along v of the narrow parts.
fn halve(patch: &BezierPatch, own: f64, level: [u32; 2], narrow: &mut Vec<[u32; 2]>) {
    if own <= WIDEST {
        narrow.push(level);
        return;
    }
    let halves = |k: usize| {
        if level[k] == GREATEST_FLOOR {
            return None;
        }
        let middle = 0.5 * (patch.domain[k][0] + patch.domain[k][1]);
        let halves = if k == 0 { patch.split_u(middle) } else { patch.split_v(middle) };
        Some(halves.map(|half| (sine(&half), half)))
    };
    let widest = |k: usize, halves: &[(f64, BezierPatch); 2]| (halves[0].0.max(halves[1].0), level[k]);
    let (k, halves) = match [halves(0), halves(1)] {
        // Where both gain alike, the one that has gained less.
        [Some(u), Some(v)] if widest(1, &v) < widest(0, &u) => (1, v),
        [Some(u), _] => (0, u),
        [None, Some(v)] => (1, v),
        [None, None] => return,
    };
    let mut finer = level;
    finer[k] += 1;
    halves.iter().for_each(|(sine, half)| halve(half, *sine, finer, narrow));
}

/// The sine of a patch's cone, 1 where it has none.
fn sine(patch: &BezierPatch) -> f64 {
    patch.normal_cone().map_or(1.0, |cone| cone.sine)
}

/// The height to which floors are lowered so that they alone take at most half of the triangles that an error may
/// ([`REFINED_TRIANGLES`]); `triangles` counts those of floors up to a height.
pub fn height(mut triangles: impl FnMut(u32) -> f64) -> u32 {
    (1..=GREATEST_FLOOR).rev().find(|height| triangles(*height) <= (REFINED_TRIANGLES / 2) as f64).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangles::bounds::parts_of;
    use glam::{DVec3, DVec4};

    /// A patch of degree 3 × 1, straight along v, whose rows along u stand at these places.
    fn strip(rows: [[f64; 2]; 4]) -> BezierPatch {
        let row = |[x, z]: [f64; 2]| [0.0, 1.0].map(|y| DVec4::new(x, y, z, 1.0));
        let control = rows.into_iter().flat_map(row).collect();
        BezierPatch { degree: [3, 1], domain: [[0.0, 1.0], [2.0, 3.0]], origin: DVec3::ZERO, control }
    }

    #[test]
    fn a_flat_patch_asks_for_nothing_and_a_bend_for_cells_across_it() {
        assert_eq!(floor(&strip([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]])), [0, 0]);
        let [across, along] = floor(&strip([[0.0, 0.0], [0.0, 1.0], [3.0, 1.0], [3.0, 0.0]]));
        assert!(across > 1 && along == 0, "{across}, {along}");
        // However narrow it is: the chord knows nothing of it.
        let narrow = strip([[0.0, 0.0], [0.0, 1e-6], [3e-6, 1e-6], [3e-6, 0.0]]);
        assert_eq!(floor(&narrow), [across, along]);
    }

    /// The bend is a half turn: halved three times, each part turns by an eighth of that or a little more.
    #[test]
    fn cells_of_a_floor_have_narrow_cones() {
        let patch = strip([[0.0, 0.0], [0.0, 4.0], [3.0, -4.0], [3.0, 0.5]]);
        let [u, v] = floor(&patch).map(|level| 1usize << level);
        let cells = parts_of(&patch, [u, v]);
        let wide = cells.iter().filter(|cell| sine(cell) > WIDEST).count();
        assert!(wide as f64 <= LEFT * cells.len() as f64, "{wide} of {}", cells.len());
        let coarser = parts_of(&patch, [u / 2, v]);
        assert!(coarser.iter().any(|cell| sine(cell) > WIDEST), "half as many cells would do");
    }

    #[test]
    fn what_has_no_normal_asks_for_nothing_and_a_cusp_for_little() {
        assert_eq!(floor(&strip([[1.0, 1.0]; 4])), [0, 0]);
        // x = t², z = t³ about t = 0: there both tangents vanish, and the normal turns round.
        let cusp = strip([[1.0, -1.0], [-1.0 / 3.0, 1.0], [-1.0 / 3.0, -1.0], [1.0, 1.0]]);
        let [across, along] = floor(&cusp);
        assert!(across <= GREATEST_FLOOR && along == 0, "{across}, {along}");
    }

    #[test]
    fn floors_are_lowered_until_they_take_half_of_the_triangles() {
        let triangles = |patches: f64| move |height: u32| 2.0 * patches * 4f64.powi(height as i32);
        assert_eq!(height(triangles(1.0)), GREATEST_FLOOR);
        assert_eq!(height(triangles(30_000.0)), 2);
        assert_eq!(height(triangles(1e9)), 0);
    }
}

//! What a pixel may show of a flat triangle whose corners carry normals, as the papers draw: the triangle's point and the
//! interpolated normal, in place of the surface's own.
//!
//! The point is within the chord of S at the pixel's own (u, v). The normal is a mixture of three normals of the surface, taken at
//! the corners of one cell. A cone that holds all normals of the cell holds any mixture, and S's own normal, too
//! ([`nurbs::BezierPatch::normal_cone`]).

use crate::difference::Difference;
use crate::evaluation::Evaluated;
use crate::setting::Setting;
use crate::{Cause, Shares, Unbounded};
use gbuffer::Hit;
use glam::{DVec2, DVec3};
use nurbs::{BezierPatch, Cone};
use rayon::prelude::*;
use scene::Model;
use std::sync::Arc;

/// How a technique has cut a Bézier piece: into equal parts, and each of them into cells from its start on.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    /// Parts along u and along v.
    pub parts: [usize; 2],
    /// Of each part, row-major in u, the greatest cell along u and along v, as shares of the part: each of its cells lies in one of those.
    pub sizes: Vec<[f64; 2]>,
}

impl Cells {
    /// Those of a piece in so many parts of which nothing is drawn.
    pub fn in_parts(parts: [usize; 2]) -> Self {
        Self { parts, sizes: vec![[0.0; 2]; parts[0] * parts[1]] }
    }

    /// The cells that come within `reach` of parameters `at`, each 0 … 1: shares of the piece, too. `None` where nothing is known of
    /// one of them.
    fn within(&self, at: [f64; 2], reach: [f64; 2]) -> Option<Vec<Rectangle>> {
        let parts = [0, 1].map(|k| {
            let part = |t: f64| ((t * self.parts[k] as f64).max(0.0) as usize).min(self.parts[k] - 1);
            part(at[k] - reach[k])..=part(at[k] + reach[k])
        });
        let mut cells = vec![];
        for (i, j) in parts[0].clone().flat_map(|i| parts[1].clone().map(move |j| (i, j))) {
            let shares = *self.sizes.get(i * self.parts[1] + j)?;
            if !shares.iter().all(|size| *size > 0.0 && *size <= 1.0) {
                return None;
            }
            let lines = |k: usize, part: usize| {
                let parts = self.parts[k] as f64;
                let (start, size) = (part as f64 / parts, shares[k] / parts);
                let line = |t: f64| ((t - start).clamp(0.0, 1.0 / parts) / size).floor();
                // The last cell of a part ends where the part does, and rounding makes no other after it.
                let last = (shares[k].recip() * (1.0 - 2.0 * f64::EPSILON)).ceil() - 1.0;
                let (first, last) =
                    (line(at[k] - reach[k]).min(last) as usize, line(at[k] + reach[k]).min(last) as usize);
                (first..=last).map(move |n| [n, n + 1].map(|n| (start + n as f64 * size).min(1.0)))
            };
            cells.extend(lines(0, i).flat_map(|u| lines(1, j).map(move |v| [u, v])));
        }
        Some(cells)
    }
}

/// Where a cell starts and ends along u, and along v.
type Rectangle = [[f64; 2]; 2];

/// A cone whose sine comes to this says nothing: a normal may then be 30° off its axis.
pub const WIDEST: f64 = 0.5;

/// Rounding of a normal in f32: its evaluation at corners (a thousandth of a degree by the proven intervals of surfaces that are not
/// degenerate), interpolation, and the division by its length.
pub const NORMAL_ROUNDING: f64 = 1.0 / (1 << 15) as f64;

/// Parameters that f32 interpolates may be beyond their cell by this share of the piece.
const BEYOND: f64 = 1.0 / (1 << 18) as f64;

/// A triangle that is followed beyond its edges by more than its own size says nothing: bounds grow by twice the way.
const MOST_FOLLOWED: f64 = 3.0;

/// Rounding of the triangle's point, in units of 2⁻²⁴ of its distance and the model's size: its depth is interpolated.
const POINT_ULPS: f64 = 16.0;

/// Cells of all pieces, with the pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexNormals {
    /// Of each surface.
    pieces: Arc<Vec<Vec<BezierPatch>>>,
    /// Of each face.
    surfaces: Vec<usize>,
    cells: Vec<Vec<Cells>>,
}

impl VertexNormals {
    /// Those of a model; for each face and each of its pieces how it is cut, or none for a face of which nothing is known.
    pub fn new(model: &Model, cells: &[Vec<Cells>]) -> Self {
        Self {
            pieces: Arc::new(model.surfaces().par_iter().map(|surface| surface.bezier_patches()).collect()),
            surfaces: model.faces().iter().map(|face| face.surface).collect(),
            cells: cells.to_vec(),
        }
    }

    /// A cone that holds what the triangles of a cell of a piece carry.
    fn cone(&self, face: usize, piece: usize, cell: &Rectangle) -> Option<Cone> {
        let patch = &self.pieces[self.surfaces[face]][piece];
        let rectangle = [0, 1].map(|k| {
            let [start, end] = patch.domain[k];
            cell[k].map(|t| start + (end - start) * t)
        });
        let is_whole = rectangle.iter().all(|[low, high]| low < high);
        if is_whole { patch.part(rectangle).normal_cone() } else { None }
    }
}

impl Setting<'_> {
    /// Checks what a triangle carries to a hit at the position `center`; `chord` is how far its point may be from S, model units, and
    /// `snap_px` how far beside its triangle that may be.
    pub(crate) fn carried(
        &self,
        hit: &Hit,
        center: DVec2,
        normals: &VertexNormals,
        chord: f64,
        snap_px: f64,
    ) -> Result<Evaluated, Difference> {
        if !hit.uv.is_finite() || !hit.position.is_finite() {
            let detail = format!("(u, v) = {}, S = {}", hit.uv, hit.position);
            return Err(Difference::new(self.attribution.of_position(hit, f64::INFINITY), f64::INFINITY, detail));
        }
        let s = self.surface_point(hit);
        let face = hit.face.0 as usize;
        let pieces: Vec<usize> = self.pieces(hit).collect();
        let at = |piece: usize| {
            let patch = &normals.pieces[normals.surfaces[face]][piece];
            [0, 1].map(|k| {
                let [start, end] = patch.domain[k];
                ((hit.uv[k] - start) / (end - start)).clamp(0.0, 1.0)
            })
        };
        // Snapping may leave the pixel's centre outside its triangle, whose plane is then followed so far.
        let d = self.model.surface(hit.face).first_derivatives(hit.uv.x, hit.uv.y);
        let reach = self.reach([d.su, d.sv], s, snap_px);
        let beside = |piece: usize| beside(reach, &normals.pieces[normals.surfaces[face]][piece].domain);
        let pieces: Vec<(usize, [f64; 2])> = pieces.into_iter().map(|piece| (piece, beside(piece))).collect();
        let cells = |piece: usize, reach: [f64; 2]| normals.cells.get(face)?.get(piece)?.within(at(piece), reach);
        let followed = |&(piece, beside): &(usize, [f64; 2])| {
            let Some(cells) = cells(piece, [BEYOND; 2]) else { return f64::INFINITY };
            let shares = cells.iter().flat_map(|cell| (0..2).map(|k| beside[k] / (cell[k][1] - cell[k][0])));
            shares.fold(0.0, f64::max)
        };
        let followed = 1.0 + 2.0 * pieces.iter().map(followed).fold(0.0, f64::max);
        let evaluated = |shares| Ok(Evaluated { shares, radius: 0.0 });
        // Seen edge-on, or on a sliver of a cell.
        let is_beside = followed <= MOST_FOLLOWED;
        if !is_beside {
            return evaluated(Shares { unbounded: Some(Unbounded::Interpolation), ..Shares::default() });
        }
        // A plane through points that lie `h` apart is off by M / 2 (h + b) b at most where it is followed `b` beyond them, and the chord of
        // h + 2 b is more.
        // On a border of the piece its parameters end, and the plane goes on.
        let ended = |&(piece, beside): &(usize, [f64; 2])| -> f64 {
            let ([su, sv], at) = ([d.su, d.sv].map(DVec3::length), at(piece));
            let domain = &normals.pieces[normals.surfaces[face]][piece].domain;
            let ways = [0, 1].map(|k| [su, sv][k] * beside[k] * (domain[k][1] - domain[k][0]));
            (0..2).filter(|k| at[*k] <= BEYOND || at[*k] >= 1.0 - BEYOND).map(|k| ways[k]).sum()
        };
        let ended = pieces.iter().map(ended).fold(0.0, f64::max);
        let rounding = POINT_ULPS / (1u64 << 24) as f64 * (hit.t.abs() + self.size);
        let allowed = chord * followed.powi(2) + ended + rounding;
        let off = hit.position.distance(s);
        if off > allowed {
            let detail = format!("the triangle's point is {off:.3e} from S(u, v); {allowed:.3e} are allowed");
            return Err(Difference::new(self.attribution.of_position(hit, off / allowed), off / allowed, detail));
        }
        // Wherever its plane is followed to, a triangle's point is on the ray. A skirt shows S itself.
        let is_of_skirt = self.model.region(hit.face).is_some() && off <= rounding;
        let beside_px = self.picture(hit.position).map_or(f64::INFINITY, |seen| seen.distance(center));
        let allowed_px = snap_px + self.camera.pixels_within(self.viewport, s, rounding);
        if beside_px > allowed_px && !is_of_skirt {
            let detail =
                format!("the triangle's point is {beside_px:.4} px from the pixel's ray; {allowed_px:.4} are allowed");
            return Err(Difference::new(Cause::Interpolation, beside_px / allowed_px, detail));
        }
        let mut shares = Shares { position: Some(off / allowed), ..Shares::default() };
        // The triangle is one of any of these cells.
        let cones_of = |&(piece, beside): &(usize, [f64; 2])| -> Vec<Option<Cone>> {
            let Some(cells) = cells(piece, beside.map(|beside| beside + BEYOND)) else { return vec![None] };
            cells.iter().map(|cell| normals.cone(face, piece, cell)).collect()
        };
        let cones: Vec<Option<Cone>> = pieces.iter().flat_map(cones_of).collect();
        let is_useful = |cone: &Option<Cone>| cone.is_some_and(|cone| cone.sine * followed < WIDEST);
        let Some(normal) = hit.normal.unit().filter(|_| cones.iter().all(is_useful)) else {
            if hit.normal.unit().is_none() && cones.iter().all(is_useful) {
                let detail = "no normal where the corners have some".to_owned();
                return Err(Difference::new(Cause::DegenerateNormal, f64::INFINITY, detail));
            }
            shares.unbounded = Some(Unbounded::Normal);
            return evaluated(shares);
        };
        if !normal.is_finite() || (normal.length() - 1.0).abs() > NORMAL_ROUNDING {
            let cause = if normal.is_finite() { Cause::NormalLength } else { Cause::NotFinite };
            return Err(Difference::new(cause, f64::INFINITY, format!("the normal's length is {}", normal.length())));
        }
        let reversed = self.model.faces()[face].reversed;
        let share = |cone: &Cone| {
            let axis = if reversed { -cone.axis } else { cone.axis };
            let sine = if normal.dot(axis) > 0.0 { normal.cross(axis).length() } else { 1.0 };
            sine / (cone.sine * followed + NORMAL_ROUNDING)
        };
        let share = cones.iter().flatten().map(share).fold(f64::INFINITY, f64::min);
        if share > 1.0 {
            let detail = format!("the normal {normal} is outside the cone of its cell by {share:.3} times its sine");
            return Err(Difference::new(Cause::Derivative, share, detail));
        }
        shares.normal = Some(share);
        evaluated(shares)
    }

    /// How far `snap_px` pixels reach in u and in v about a point with these derivatives.
    fn reach(&self, derivatives: [DVec3; 2], s: DVec3, snap_px: f64) -> [f64; 2] {
        let [a, b] = derivatives.map(|along| self.camera.picture_derivative(self.viewport, s, along));
        let area = a.perp_dot(b).abs();
        [b.length(), a.length()].map(|across| snap_px * across / area)
    }
}

/// A reach in u and in v as shares of a rectangle of parameters.
fn beside(reach: [f64; 2], domain: &[[f64; 2]; 2]) -> [f64; 2] {
    [0, 1].map(|k| reach[k] / (domain[k][1] - domain[k][0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A piece of two parts along u: one of four cells, one of three.
    fn cells() -> Cells {
        Cells { parts: [2, 1], sizes: vec![[0.25, 1.0], [1.0 / 3.0, 1.0]] }
    }

    fn starts(at: f64, reach: f64) -> Vec<f64> {
        let found = cells().within([at, 0.5], [reach, BEYOND]).expect("known");
        found.iter().map(|cell| cell[0][0]).collect()
    }

    #[test]
    fn a_place_amid_a_cell_is_of_that_cell_alone_and_one_on_a_line_of_both_beside_it() {
        assert_eq!(starts(0.2, BEYOND), [0.125]);
        assert_eq!(starts(0.125, BEYOND), [0.0, 0.125]);
        assert_eq!(starts(0.2, 0.1), [0.0, 0.125, 0.25]);
        // A part has its own cells, and at its border those of the part beside it, too.
        assert_eq!(starts(0.6, BEYOND), [0.5]);
        assert_eq!(starts(0.5, BEYOND), [0.375, 0.5]);
        assert_eq!((starts(0.0, BEYOND), starts(1.0, BEYOND).len()), (vec![0.0], 1));
    }

    /// A cell that rounding puts after a part's last would be empty, and of an empty one nothing is known.
    #[test]
    fn the_cells_of_a_part_tile_it_however_many_they_are() {
        for count in 1..500 {
            let cells = Cells { parts: [1, 1], sizes: vec![[1.0 / f64::from(count), 1.0]] };
            let found = cells.within([0.5, 0.5], [1.0, 0.0]).expect("known");
            assert_eq!(found.len(), count as usize);
            assert!(found.iter().all(|[[low, high], _]| low < high && *high <= 1.0), "{count}: {found:?}");
        }
    }

    #[test]
    fn nothing_is_known_beside_a_part_of_which_nothing_is_drawn_or_whose_cells_run_on() {
        for unknown in [0.0, f64::INFINITY, f64::NAN, 1.5] {
            let cells = Cells { parts: [2, 1], sizes: vec![[0.25, 1.0], [unknown, 1.0]] };
            assert!(cells.within([0.3, 0.5], [BEYOND; 2]).is_some());
            assert_eq!(cells.within([0.5, 0.5], [BEYOND; 2]), None);
        }
        let few = Cells { parts: [2, 1], sizes: vec![[0.25, 1.0]] };
        assert_eq!(few.within([0.75, 0.5], [BEYOND; 2]), None);
    }
}

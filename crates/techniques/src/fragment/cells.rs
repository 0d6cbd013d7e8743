//! How many cells a face is cut into, and the chord error that they come to.

use crate::triangles::bounds::Bounds;
use crate::triangles::coarsened::REFINED_TRIANGLES;
use crate::triangles::patches::{patches_on, spans_of};
use nurbs::{DerivativeBounds, Surface};
use pipeline::PackedFrame;
use scene::Region;
use std::ops::Range;

/// Cells of one span in one direction at most: what [`REFINED_TRIANGLES`] leaves of it however narrow it is.
pub(super) const GREATEST_CELLS: usize = REFINED_TRIANGLES / 2;

/// How the parameters of a face are cut.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Cells {
    /// Every span by itself, in u and in v: of each of its equal parts, the cells. A span of polynomial patches is one part.
    OfSpans([Vec<Vec<usize>>; 2]),
    /// The whole domain, in both directions alike.
    OfDomain(usize),
}

impl Cells {
    /// How each Bézier piece is cut. Cells of the whole domain run across pieces, and nothing is known of them.
    pub(super) fn of_pieces(&self, bounds: &Bounds) -> Vec<compare::Cells> {
        let of_piece = |index: usize| match self {
            Self::OfDomain(_) => compare::Cells { parts: [1, 1], sizes: vec![[f64::INFINITY; 2]] },
            Self::OfSpans(spans) => {
                let on = bounds.spans(index);
                let [u, v] = [0, 1].map(|k| &spans[k][on[k]]);
                let size = |cells: &usize| 1.0 / *cells as f64;
                let sizes = u.iter().flat_map(|u| v.iter().map(move |v| [size(u), size(v)])).collect();
                compare::Cells { parts: [u.len(), v.len()], sizes }
            }
        };
        (0..bounds.patches.len()).map(of_piece).collect()
    }
}

/// What a face asks of its tessellation.
pub(super) struct Wanted<'a> {
    pub(super) bounds: &'a Bounds,
    /// Of each Bézier patch, row-major in u, what a pixel measures where it is nearest, infinite out of the picture.
    pub(super) pixels: &'a [f64],
    /// The spans in u and in v that the face comes to.
    pub(super) spans: [Range<usize>; 2],
    /// Of each patch and each of its parts the least levels; none where normals are not the corners'.
    pub(super) floors: &'a [Vec<[u32; 2]>],
}

impl Wanted<'_> {
    /// The patches that the face comes to.
    pub(super) fn patches(&self) -> impl Iterator<Item = usize> {
        patches_on(&self.spans, self.bounds.parts[1].len())
    }

    /// The fewest cells of each part of the spans in u and in v that floors up to a height leave.
    pub(super) fn least(&self, height: u32) -> [Vec<Vec<usize>>; 2] {
        let mut cells =
            self.bounds.parts.each_ref().map(|spans| spans.iter().map(|&n| vec![1usize; n]).collect::<Vec<_>>());
        // A patch that is out of the picture is not cut.
        let is_seen = |index: &usize| self.pixels[*index].is_finite();
        for (index, floors) in self.patches().filter(is_seen).filter_map(|index| Some((index, self.floors.get(index)?)))
        {
            let [k, l] = self.bounds.spans(index);
            let columns = cells[1][l].len();
            for (part, floor) in floors.iter().enumerate() {
                let [u, v] = floor.map(|level| 1 << level.min(height));
                let (i, j) = (part / columns, part % columns);
                cells[0][k][i] = u.max(cells[0][k][i]);
                cells[1][l][j] = v.max(cells[1][l][j]);
            }
        }
        cells
    }

    /// The fewest cells, none fewer than so many, of each part of the spans in u and in v so that the chord bound of every cell is at
    /// most `chord_px`.
    pub(super) fn cells(&self, chord_px: f64, mut cells: [Vec<Vec<usize>>; 2]) -> [Vec<Vec<usize>>; 2] {
        for index in self.patches() {
            let (size, bounds) = &self.bounds.patches[index];
            let [k, l] = self.bounds.spans(index);
            let [rows, columns] = [cells[0][k].len(), cells[1][l].len()];
            let size = [size[0] / rows as f64, size[1] / columns as f64];
            for (part, bounds) in bounds.iter().enumerate() {
                let (i, j) = (part / columns, part % columns);
                let least = [cells[0][k][i], cells[1][l][j]];
                [cells[0][k][i], cells[1][l][j]] =
                    bounds.cells(size, chord_px * self.pixels[index], least, [GREATEST_CELLS, REFINED_TRIANGLES]);
            }
        }
        cells
    }
}

pub(super) fn total(counts: &[usize]) -> f64 {
    counts.iter().sum::<usize>() as f64
}

/// The chord of each Bézier piece of a face, from the bounds of its surface's derivatives and the cells that it is cut into, plus
/// what narrowing moves; 0 where the face does not come to. Corners are narrowed in local units of so many model
/// units at most, and off by so many beside.
pub(super) fn chord_bounds(
    bounds: &Bounds,
    surface: &Surface,
    region: Option<&Region>,
    (frame, [scale, off]): (&PackedFrame, [f64; 2]),
    cells: &Cells,
) -> Vec<f64> {
    let domain = surface.domain().map(|[start, end]| end - start);
    let mut chords = vec![0.0; bounds.patches.len()];
    for index in patches_on(&spans_of(region, &frame.breaks), bounds.parts[1].len()) {
        let (size, parts) = &bounds.patches[index];
        let whole = parts.iter().copied().fold(DerivativeBounds::default(), DerivativeBounds::max);
        let (chord, interpolated) = match cells {
            Cells::OfSpans([u, v]) => {
                let [k, l] = bounds.spans(index);
                (bounds.chord(index, [&u[k], &v[l]]), *size)
            }
            Cells::OfDomain(n) => (whole.chord(domain[0] / *n as f64, domain[1] / *n as f64), domain),
        };
        // Vertices narrow to f32 (half an ulp of the local unit in each coordinate), and a grid line may stand half an
        // ulp beside its parameter, and so may that of the face which evaluates it.
        let speed = (whole.u * interpolated[0]).max(whole.v * interpolated[1]);
        chords[index] = chord + f64::from(f32::EPSILON) * (scale + speed) + off;
    }
    chords
}

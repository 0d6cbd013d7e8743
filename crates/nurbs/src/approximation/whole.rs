//! A whole surface by bicubic patches: one surface on the same domain, so that whatever its parameters say still holds.

use crate::bezier::BezierPatch;
use crate::error::NurbsError;
use crate::knots::KnotVector;
use crate::surface::{Direction, Surface};
use glam::DVec4;

/// Rounds of cutting, each of which cuts where a part is not near enough yet; the second one is nearly always the last.
const ROUNDS: usize = 24;

/// Patches of one surface at most: 400 MB of control points.
const MOST_PATCHES: usize = 1 << 20;

/// Roundings of a control point on its way to the world's coordinates and back, of its size.
const WORLD_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A surface of degrees 3 and 3, what it stands for, and how far it is from that.
#[derive(Debug, Clone, PartialEq)]
pub struct BicubicSurface {
    /// The surface, on the original's domain.
    pub surface: Surface,
    /// The greatest distance, at equal parameters, from the original, at most; model units. It is 0 where the original is
    /// bicubic itself. The rounding of control points is counted, that of an evaluator is not.
    pub error: f64,
    /// Of each of its spans in u and in v that are not empty, the number of the original's span that it lies on, among those
    /// that are not empty.
    pub spans: [Vec<usize>; 2],
}

impl Surface {
    /// A bicubic surface that is within `tolerance` of this one, model units, at equal parameters.
    ///
    /// Its patches are those of [`BezierPatch::bicubics`], but in rows and columns: where one patch is cut, all beside it are
    /// cut alike, so that no border has more points on one side than on the other. That takes more patches than the
    /// hierarchy alone, and leaves no crack: parts that share a border have the same there, to the bit, as the original's
    /// own patches do. Where these do not, the surface is torn, and stays so.
    ///
    /// # Errors
    /// Those of [`BezierPatch::bicubics`]; [`NurbsError::BicubicTolerance`] also where over a million patches do not reach the
    /// tolerance; [`NurbsError::TooManyKnots`] where there are more knots than a vector may have.
    pub fn bicubic(&self, tolerance: f64) -> Result<BicubicSurface, NurbsError> {
        let patches = self.bezier_patches();
        let counts = [Direction::U, Direction::V].map(|direction| self.knots(direction).spans().count());
        if self.degree() == [3, 3] {
            return Ok(BicubicSurface { surface: self.clone(), error: 0.0, spans: counts.map(|n| (0..n).collect()) });
        }
        // Of each span where it is cut, in shares of it.
        let mut cuts = counts.map(|n| vec![vec![0.0, 1.0]; n]);
        let mut reached = 0.0;
        for _ in 0..ROUNDS {
            let [rows, columns] = cuts.each_ref().map(|spans| spans.iter().map(|cuts| cuts.len() - 1).sum::<usize>());
            if rows.saturating_mul(columns) > MOST_PATCHES {
                break;
            }
            let mut cells = Cells { counts: [rows, columns], parts: vec![], error: 0.0 };
            let mut more = cuts.clone();
            for k in 0..counts[0] {
                // The cells of a row of patches, strip by strip.
                let mut strips: Vec<Vec<BezierPatch>> = vec![vec![]; cuts[0][k].len() - 1];
                for l in 0..counts[1] {
                    let whole = &patches[k * counts[1] + l];
                    let unit = BezierPatch { domain: [[0.0, 1.0]; 2], ..whole.clone() };
                    for (i, strip) in cut(unit, &cuts[0][k], BezierPatch::split_u).into_iter().enumerate() {
                        for (j, cell) in cut(strip, &cuts[1][l], BezierPatch::split_v).into_iter().enumerate() {
                            let mut parts = cell.bicubics(tolerance)?;
                            for (direction, span, at) in [(0, k, i), (1, l, j)] {
                                let [start, end] = [cuts[direction][span][at], cuts[direction][span][at + 1]];
                                let shares = parts.iter().flat_map(|part| part.shares[direction]);
                                more[direction][span].extend(shares.map(|share| start + (end - start) * share));
                            }
                            cells.error = parts.iter().fold(cells.error, |most, part| most.max(part.error));
                            strips[i].push(parts.swap_remove(0).patch);
                        }
                    }
                }
                cells.parts.extend(strips.into_iter().flatten());
            }
            for cuts in more.iter_mut().flatten() {
                cuts.sort_by(f64::total_cmp);
                cuts.dedup();
            }
            if more == cuts {
                return self.assembled(&cuts, &cells);
            }
            reached = cells.error;
            cuts = more;
        }
        Err(NurbsError::BicubicTolerance { tolerance, reached, parts: MOST_PATCHES })
    }

    /// The cells as one surface.
    fn assembled(&self, cuts: &[Vec<Vec<f64>>; 2], cells: &Cells) -> Result<BicubicSurface, NurbsError> {
        let mut vectors = vec![];
        let mut lines = vec![];
        for (k, direction) in [Direction::U, Direction::V].into_iter().enumerate() {
            let (knots, (first, last)) = (self.knots(direction), self.knots(direction).domain());
            let ends = knots.spans().map(|span| [knots.knots()[span], knots.knots()[span + 1]]).zip(&cuts[k]);
            let at = |([start, end], cuts): ([f64; 2], &Vec<f64>)| {
                cuts[1..].iter().map(|share| start * (1.0 - share) + end * share).collect::<Vec<f64>>()
            };
            let breaks: Vec<f64> = ends.flat_map(at).collect();
            let mut vector = vec![first; 4];
            // Control lines: of which cell, and which of its four.
            let mut of: Vec<(usize, usize)> = (0..4).map(|line| (0, line)).collect();
            for (cell, at) in (1..).zip(&breaks[..breaks.len() - 1]) {
                let is_torn = !cells.meet(k, cell);
                vector.extend(vec![*at; 3 + usize::from(is_torn)]);
                of.extend((usize::from(!is_torn)..4).map(|line| (cell, line)));
            }
            vector.extend([last; 4]);
            vectors.push(KnotVector::new(3, vector)?);
            lines.push(of);
        }
        let columns = cells.counts[1];
        let control: Vec<(DVec4, _)> = lines[0]
            .iter()
            .flat_map(|&(row, i)| lines[1].iter().map(move |&(column, j)| (row * columns + column, 4 * i + j)))
            .map(|(cell, index)| (cells.parts[cell].control[index], cells.parts[cell].origin))
            .collect();
        let points: Vec<_> = control.iter().map(|(c, origin)| *origin + c.truncate() / c.w).collect();
        let weights = self.weights().map(|_| control.iter().map(|(c, _)| c.w).collect());
        let greatest = points.iter().fold(0.0, |most: f64, p| most.max(p.length()));
        let [knots_u, knots_v] = <[KnotVector; 2]>::try_from(vectors).expect("two directions");
        Ok(BicubicSurface {
            surface: Surface::new(knots_u, knots_v, points, weights)?,
            error: cells.error + WORLD_ROUNDING * greatest,
            spans: cuts.each_ref().map(|spans| {
                let of_span = |(k, cuts): (usize, &Vec<f64>)| vec![k; cuts.len() - 1];
                spans.iter().enumerate().flat_map(of_span).collect()
            }),
        })
    }
}

/// Bicubic patches in rows and columns, over the whole surface.
struct Cells {
    counts: [usize; 2],
    /// Row-major in u.
    parts: Vec<BezierPatch>,
    error: f64,
}

impl Cells {
    /// Whether all of row (or column) `at` have the border of those before them, to the bit.
    fn meet(&self, direction: usize, at: usize) -> bool {
        let [_, columns] = self.counts;
        (0..self.counts[1 - direction]).all(|across| {
            let of =
                |at: usize| &self.parts[if direction == 0 { at * columns + across } else { across * columns + at }];
            let index = |line: usize, along: usize| if direction == 0 { 4 * line + along } else { 4 * along + line };
            (0..4).all(|along| of(at - 1).control[index(3, along)] == of(at).control[index(0, along)])
        })
    }
}

/// A patch over 0 … 1 cut at shares of it in one direction by `split`.
fn cut(patch: BezierPatch, shares: &[f64], split: impl Fn(&BezierPatch, f64) -> [BezierPatch; 2]) -> Vec<BezierPatch> {
    let mut parts = vec![];
    let mut rest = patch;
    for share in &shares[1..shares.len() - 1] {
        let [part, beyond] = split(&rest, *share);
        parts.push(part);
        rest = beyond;
    }
    parts.push(rest);
    parts
}

//! Pieces of lines put together where their ends meet, within a face and across the borders of faces.
//!
//! Each end gets one partner at most. The nearest pairs of ends come first, so that pieces of one face, whose ends are the same
//! but for rounding, are joined before those of two.

use crate::place::Place;
use glam::{DVec2, DVec3};
use scene::Model;
use std::collections::HashMap;

/// Ends whose parameters are farther apart are on two sides of a seam, or of a fold: a share of the domain.
const BESIDE: f64 = 1e-3;

/// Lines made of pieces, each of two places at least, whose ends are joined within a distance, model units.
///
/// Two joined ends count once where they are beside each other on one face, and twice where a border or a seam is between them.
pub fn joined(pieces: Vec<Vec<Place>>, within: f64, model: &Model) -> Vec<Vec<Place>> {
    let partners = partners(&pieces, within);
    let mut is_used = vec![false; pieces.len()];
    let mut lines = vec![];
    // Lines that end somewhere begin there; then those that close.
    let open = (0..pieces.len()).filter(|k| partners[2 * k].is_none() || partners[2 * k + 1].is_none());
    for first in open.chain(0..pieces.len()) {
        if is_used[first] {
            continue;
        }
        let mut line: Vec<Place> = vec![];
        let mut end = Some(2 * first + usize::from(partners[2 * first].is_some()));
        let mut last = 2 * first;
        // A piece is entered at an end and left at the other.
        while let Some(entered) = end.filter(|end| !is_used[end / 2]) {
            is_used[entered / 2] = true;
            let piece = &pieces[entered / 2];
            let mut places: Vec<Place> = piece.clone();
            if entered % 2 == 1 {
                places.reverse();
            }
            append(&mut line, places, model);
            last = entered ^ 1;
            end = partners[last];
        }
        // What closes ends where it began, exactly.
        if partners[last].is_some_and(|end| end / 2 == first)
            && let (Some(start), Some(stop)) = (line.first().copied(), line.last().copied())
        {
            if is_beside(&start, &stop, model) {
                line.pop();
            }
            line.push(start);
        }
        lines.push(line);
    }
    lines
}

/// Adds places behind a line.
fn append(line: &mut Vec<Place>, places: Vec<Place>, model: &Model) {
    let skipped = usize::from(line.last().is_some_and(|end| is_beside(end, &places[0], model)));
    line.extend(places.into_iter().skip(skipped));
}

/// Whether two places of joined ends are on one face and on one side of its seam.
fn is_beside(a: &Place, b: &Place, model: &Model) -> bool {
    let [u, v] = model.surface(a.face).domain().map(|[start, end]| end - start);
    a.face == b.face && (a.uv - b.uv).abs().cmple(BESIDE * DVec2::new(u, v)).all()
}

/// Of each end (twice the piece's number, and one more for its last place) the end that it is joined with.
fn partners(pieces: &[Vec<Place>], within: f64) -> Vec<Option<usize>> {
    let end = |k: usize| {
        let piece = &pieces[k / 2];
        if k.is_multiple_of(2) { piece[0].position } else { piece[piece.len() - 1].position }
    };
    let cell = |p: DVec3| (p / within).floor().to_array().map(|x| x as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut pairs = vec![];
    for k in 0..2 * pieces.len() {
        let (p, [x, y, z]) = (end(k), cell(end(k)));
        for beside in 0..27 {
            let offset = [beside / 9 - 1, beside / 3 % 3 - 1, beside % 3 - 1];
            let near = [x + offset[0], y + offset[1], z + offset[2]];
            for &other in cells.get(&near).into_iter().flatten() {
                let distance = p.distance(end(other));
                if other / 2 != k / 2 && distance <= within {
                    pairs.push((distance, other, k));
                }
            }
        }
        cells.entry([x, y, z]).or_default().push(k);
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut partners = vec![None; 2 * pieces.len()];
    for (_, a, b) in pairs {
        if partners[a].is_none() && partners[b].is_none() {
            partners[a] = Some(b);
            partners[b] = Some(a);
        }
    }
    partners
}

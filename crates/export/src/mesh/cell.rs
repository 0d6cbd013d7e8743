//! The triangles of a face: whole cells are two each, and cells at a border are triangulated under constraints (`spade`).
//!
//! Chords of the border, directed with material on their left, each lie in one cell. A cell with a chord or a border point is
//! triangulated by itself, its own sides and the chords being edges. Windings are counted from triangle to triangle across
//! chords; where a cell has none, the winding of its middle says whether it is material.

use super::cells::Grid;
use glam::DVec2;
use spade::handles::FixedFaceHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::{BTreeMap, HashMap};

/// The most crossings of chords in one cell, and the most chords: each is held against each.
const MOST_CROSSINGS: usize = 64;
const MOST_CHORDS: usize = 1 << 14;

/// Two chords of a face cross, so that no triangulation has both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossed;

/// The part of a face's domain with material, in triangles.
#[derive(Default)]
pub(super) struct Triangulated {
    /// Corners, those of the border first, as they were given.
    pub corners: Vec<DVec2>,
    /// Counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Of corners where two chords cross, the corner of the border that is next, in lengths of the cell.
    pub beside: HashMap<u32, u32>,
}

/// Triangulates what lies left of the chords, pairs of `corners`. Where two cross they get a corner, if that is asked for.
///
/// # Errors
/// [`Crossed`].
pub(super) fn triangulate(
    grid: &Grid,
    corners: Vec<DVec2>,
    chords: &[[u32; 2]],
    may_split: bool,
) -> Result<Triangulated, Crossed> {
    let mut work = Work::new(grid, corners);
    work.sort_in(chords);
    let mut out = vec![];
    let [columns, rows] = [0, 1].map(|axis| grid.lines[axis].len() - 1);
    for j in 0..rows {
        let mut winding = work.beyond[j].iter().sum::<i32>();
        for i in 0..columns {
            // What the ray toward greater u from this cell's middle still meets.
            winding -= work.beyond[j][i];
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            match work.cells.remove(&[i, j]) {
                None if winding == 0 => {}
                None => {
                    let [a, b, c, d] = corners.map(|at| work.corner(at));
                    out.extend([[a, b, c], [a, c, d]]);
                }
                Some(mut chords) => {
                    if may_split {
                        chords = work.uncrossed([i, j], &chords)?;
                    }
                    work.cell([i, j], &chords, winding != 0, &mut out)?;
                }
            }
        }
    }
    Ok(Triangulated { corners: work.corners, triangles: out, beside: work.beside })
}

struct Work<'g> {
    grid: &'g Grid,
    corners: Vec<DVec2>,
    /// See [`Triangulated::beside`].
    beside: HashMap<u32, u32>,
    /// Corners of the grid that a corner stands on.
    known: HashMap<[usize; 2], u32>,
    /// Corners on lines, by the axis that is constant, its line, and the cell along it.
    on_lines: HashMap<(usize, usize, usize), Vec<u32>>,
    /// The chords of each cell that the border comes to.
    cells: BTreeMap<[usize; 2], Vec<[u32; 2]>>,
    /// For each row, by the first column that lies beyond it, the windings of chords that cross the row's middle.
    beyond: Vec<Vec<i32>>,
}

impl<'g> Work<'g> {
    fn new(grid: &'g Grid, corners: Vec<DVec2>) -> Self {
        let [columns, rows] = [0, 1].map(|axis| grid.lines[axis].len() - 1);
        let (mut known, mut on_lines) = (HashMap::new(), HashMap::<_, Vec<u32>>::new());
        let mut cells = BTreeMap::<_, Vec<_>>::new();
        for (index, uv) in corners.iter().enumerate() {
            let lines = [0, 1].map(|axis| grid.line(axis, uv[axis]));
            let own = [0, 1].map(|axis| grid.cell(axis, uv[axis]));
            match lines {
                [Some(i), Some(j)] => {
                    known.insert([i, j], index as u32);
                }
                [Some(i), None] => on_lines.entry((0, i, own[1])).or_default().push(index as u32),
                [None, Some(j)] => on_lines.entry((1, j, own[0])).or_default().push(index as u32),
                [None, None] => {}
            }
            // All cells that it touches are cut there, but for a corner of theirs.
            let touched = match lines {
                [Some(i), None] => [i.checked_sub(1), Some(i)].map(|i| i.map(|i| [i, own[1]])),
                [None, Some(j)] => [j.checked_sub(1), Some(j)].map(|j| j.map(|j| [own[0], j])),
                _ => [None; 2],
            };
            for cell in touched.into_iter().flatten().filter(|[i, j]| *i < columns && *j < rows) {
                cells.entry(cell).or_default();
            }
        }
        Self { grid, corners, beside: HashMap::new(), known, on_lines, cells, beyond: vec![vec![0; columns + 1]; rows] }
    }

    /// Hands each chord to the cells that it is in or on, and counts it for the rows' windings.
    fn sort_in(&mut self, chords: &[[u32; 2]]) {
        let [columns, rows] = [0, 1].map(|axis| self.grid.lines[axis].len() - 1);
        for &chord in chords {
            let [a, b] = chord.map(|corner| self.corners[corner as usize]);
            let middle = 0.5 * (a + b);
            let on = [0, 1].map(|axis| self.grid.line(axis, a[axis]).filter(|_| a[axis] == b[axis]));
            let own = [0, 1].map(|axis| on[axis].unwrap_or_else(|| self.grid.cell(axis, middle[axis])));
            let each = |axis: usize| {
                let low = on[axis].map_or(own[axis], |line| line.saturating_sub(1));
                low..=own[axis]
            };
            for i in each(0).filter(|i| *i < columns) {
                for j in each(1).filter(|j| *j < rows) {
                    self.cells.entry([i, j]).or_default().push(chord);
                }
            }
            if on[1].is_none() {
                let lines = &self.grid.lines[1];
                let height = 0.5 * (lines[own[1]] + lines[own[1] + 1]);
                if (a.y <= height) != (b.y <= height) {
                    self.beyond[own[1]][own[0]] += if a.y < b.y { 1 } else { -1 };
                }
            }
        }
    }

    /// The corner at a crossing of the grid's lines.
    fn corner(&mut self, at: [usize; 2]) -> u32 {
        *self.known.entry(at).or_insert_with(|| {
            self.corners.push(DVec2::new(self.grid.lines[0][at[0]], self.grid.lines[1][at[1]]));
            self.corners.len() as u32 - 1
        })
    }

    /// The corners along a side of a cell, in order: of line `line` of `axis`, beside the cell `along` of the other.
    fn side(&mut self, axis: usize, line: usize, along: usize) -> Vec<u32> {
        let at = |k: usize| if axis == 0 { [line, k] } else { [k, line] };
        let ends = [along, along + 1].map(|k| self.corner(at(k)));
        let mut inner = self.on_lines.get(&(axis, line, along)).cloned().unwrap_or_default();
        inner.sort_by(|a, b| self.corners[*a as usize][1 - axis].total_cmp(&self.corners[*b as usize][1 - axis]));
        [vec![ends[0]], inner, vec![ends[1]]].concat()
    }

    /// The chords of a cell, with a corner where two of them cross.
    ///
    /// # Errors
    /// [`Crossed`] where there are more than [`MOST_CROSSINGS`], or more chords than [`MOST_CHORDS`].
    fn uncrossed(&mut self, [i, j]: [usize; 2], chords: &[[u32; 2]]) -> Result<Vec<[u32; 2]>, Crossed> {
        if MOST_CHORDS < chords.len() {
            return Err(Crossed);
        }
        let mut done: Vec<[u32; 2]> = vec![];
        let mut waiting = chords.to_vec();
        let mut crossings = 0;
        while let Some(chord) = waiting.pop() {
            let ends = |corners: &[DVec2], chord: [u32; 2]| chord.map(|corner| corners[corner as usize]);
            let own = ends(&self.corners, chord);
            let found =
                done.iter().enumerate().find_map(|(k, other)| Some((k, crossing(own, ends(&self.corners, *other))?)));
            let Some((other, share)) = found else {
                done.push(chord);
                continue;
            };
            crossings += 1;
            if MOST_CROSSINGS < crossings {
                return Err(Crossed);
            }
            let at = self.corners.len() as u32;
            self.corners.push(own[0].lerp(own[1], share));
            let [from, to] = done.swap_remove(other);
            let (lines, place) = (&self.grid.lines, self.corners[at as usize]);
            let size = DVec2::new(lines[0][i + 1] - lines[0][i], lines[1][j + 1] - lines[1][j]);
            let distance = |corner: &u32| ((self.corners[*corner as usize] - place) / size).length();
            let ends = [from, to, chord[0], chord[1]].into_iter().filter(|corner| !self.beside.contains_key(corner));
            if let Some(next) = ends.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
                self.beside.insert(at, next);
            }
            waiting.extend([[from, at], [at, to], [chord[0], at], [at, chord[1]]]);
        }
        Ok(done)
    }

    /// The triangles with material of a cell at the border; `is_inside` says of one without chords whether it is material.
    fn cell(
        &mut self,
        [i, j]: [usize; 2],
        chords: &[[u32; 2]],
        is_inside: bool,
        out: &mut Vec<[u32; 3]>,
    ) -> Result<(), Crossed> {
        let sides = [self.side(0, i, j), self.side(0, i + 1, j), self.side(1, j, i), self.side(1, j + 1, i)];
        let lines = &self.grid.lines;
        let (min, max) = (DVec2::new(lines[0][i], lines[1][j]), DVec2::new(lines[0][i + 1], lines[1][j + 1]));
        let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
        let (mut handles, mut names) = (HashMap::new(), vec![]);
        for &corner in sides.iter().flatten().chain(chords.iter().flatten()) {
            handles.entry(corner).or_insert_with(|| {
                let uv = (self.corners[corner as usize] - min) / (max - min);
                let handle = cdt
                    .insert(Point2::new(uv.x, uv.y))
                    .expect("0 to 1 of the cell, and no nearer to 0 than lines snap");
                if handle.index() == names.len() {
                    names.push(corner);
                }
                handle
            });
        }
        let edges =
            sides.iter().flat_map(|side| side.windows(2).map(|pair| [pair[0], pair[1]])).chain(chords.iter().copied());
        for [from, to] in edges {
            let (from, to) = (handles[&from], handles[&to]);
            if from != to && !cdt.can_add_constraint(from, to) {
                return Err(Crossed);
            }
            if from != to {
                cdt.add_constraint(from, to);
            }
        }
        // How often a chord runs from one corner to another, less the other way round.
        let mut net: HashMap<(usize, usize), i32> = HashMap::new();
        for [from, to] in chords {
            let (from, to) = (handles[from].index(), handles[to].index());
            *net.entry((from, to)).or_default() += 1;
            *net.entry((to, from)).or_default() -= 1;
        }
        let mut windings: HashMap<FixedFaceHandle<_>, i32> = HashMap::new();
        let mut waiting: Vec<_> = cdt.inner_faces().next().map(|face| face.fix()).into_iter().collect();
        windings.extend(waiting.iter().map(|face| (*face, 0)));
        while let Some(face) = waiting.pop() {
            let own = windings[&face];
            for edge in cdt.face(face).adjacent_edges() {
                let Some(next) = edge.rev().face().as_inner().map(|next| next.fix()) else { continue };
                let crossed = net.get(&(edge.from().fix().index(), edge.to().fix().index())).copied().unwrap_or(0);
                windings.entry(next).or_insert_with(|| {
                    waiting.push(next);
                    own - crossed
                });
            }
        }
        let outside = outside(cdt.inner_faces().map(|face| (windings[&face.fix()], face.area())), is_inside);
        for face in cdt.inner_faces().filter(|face| windings[&face.fix()] != outside) {
            out.push(face.vertices().map(|vertex| names[vertex.fix().index()]));
        }
        Ok(())
    }
}

/// What winding, of those counted from any triangle of a cell, is no material, from these and the triangles' areas.
///
/// Chords have 1 on their left and 0 on their right. Where two of them cross by less than a tolerance there is a third winding,
/// and it has the least area.
fn outside(triangles: impl Iterator<Item = (i32, f64)>, is_inside: bool) -> i32 {
    let mut areas: BTreeMap<i32, f64> = BTreeMap::new();
    triangles.for_each(|(winding, area)| *areas.entry(winding).or_default() += area);
    if areas.len() < 2 {
        return areas.keys().next().map_or(0, |winding| winding - i32::from(is_inside));
    }
    let area = |winding: i32| areas.get(&winding).copied().unwrap_or(0.0);
    let both = |outside: i32| area(outside) + area(outside + 1);
    areas.keys().copied().max_by(|a, b| both(*a).total_cmp(&both(*b)).then(b.cmp(a))).expect("there are two")
}

/// The parameters, 0 to 1, at which two segments cross between their ends.
fn crossing([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Option<f64> {
    let (ab, cd) = (b - a, d - c);
    let sides = [ab.perp_dot(c - a), ab.perp_dot(d - a), cd.perp_dot(a - c), cd.perp_dot(b - c)];
    let is_crossed = sides[0] * sides[1] < 0.0 && sides[2] * sides[3] < 0.0;
    is_crossed.then(|| sides[2] / (sides[2] - sides[3]))
}

//! Which zones there are, and in which steps they are drawn.

use crate::grid::Grids;
use crate::triangles::cell;
use pipeline::{Mesh, PackedScene, Program};
use std::ops::Range;

/// Cells of a zone along each side: Concheiro's m.
pub const SIDE: u32 = 4;

/// Zones of a step at most. Their corners take 13 MB.
const MOST: u32 = 8192;

/// Zones of a step in the paper: a geometry shader emits at most 1024 words, and a zone is four of them.
pub const PAPER_ZONES: u32 = 1024 / 4;

/// Zones that are found, evaluated and drawn together.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// The program of their faces.
    pub program: Program,
    /// The zones.
    pub zones: Range<u32>,
}

/// The grids of a scene in zones; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Zones {
    /// The grids.
    pub grids: Grids,
    /// Their triangles zone by zone, as they are drawn.
    pub mesh: Mesh,
    /// The number of each grid's first zone, and one more behind the last.
    pub firsts: Vec<u32>,
    /// In drawing order.
    pub steps: Vec<Step>,
    /// Zones of a step at most.
    pub most: u32,
    /// The program of each run of grids, and its zones.
    programs: Vec<Step>,
}

impl Zones {
    /// The zones of grids of a scene.
    pub fn new(grids: Grids, scene: &PackedScene) -> Self {
        let mut firsts = vec![0];
        let mut programs: Vec<Step> = vec![];
        for record in &grids.picture.records {
            let start = firsts[firsts.len() - 1];
            let end = start + record.cells().map(|cells| cells.div_ceil(SIDE)).iter().product::<u32>();
            firsts.push(end);
            let program = scene.programs()[record.face as usize];
            match programs.last_mut() {
                Some(step) if step.program == program => step.zones.end = end,
                _ => programs.push(Step { program, zones: start..end }),
            }
        }
        let mesh = in_zones(&grids, scene);
        Self { grids, mesh, firsts, steps: vec![], most: MOST, programs }.in_steps_of(MOST)
    }

    /// The same in steps of at most so many zones, one at least.
    pub fn in_steps_of(self, most: u32) -> Self {
        let most = most.max(1);
        let steps = self.programs.iter().flat_map(|Step { program, zones }| {
            let starts = zones.clone().step_by(most as usize);
            starts.map(|start| Step { program: *program, zones: start..zones.end.min(start.saturating_add(most)) })
        });
        Self { steps: steps.collect(), most, ..self }
    }
}

/// The grids' triangles, zone by zone.
fn in_zones(grids: &Grids, scene: &PackedScene) -> Mesh {
    let mut mesh = Mesh { vertices: grids.picture.mesh.vertices.clone(), ..Mesh::default() };
    let mut base = 0;
    for record in grids.picture.records.iter().filter(|record| record.cells() != [0, 0]) {
        let [rows, columns] = record.cells();
        let first = mesh.indices.len() as u32;
        let starts = |cells: u32| (0..cells).step_by(SIDE as usize);
        for (row, column) in starts(rows).flat_map(|row| starts(columns).map(move |column| (row, column))) {
            for i in row..rows.min(row + SIDE) {
                for j in column..columns.min(column + SIDE) {
                    mesh.indices.extend(cell(base + i * (columns + 1) + j, columns + 1));
                }
            }
        }
        mesh.batch(scene.programs()[record.face as usize], first);
        base += (rows + 1) * (columns + 1);
    }
    mesh
}

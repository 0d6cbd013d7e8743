//! Which zones there are, and in which steps they are drawn.

use crate::error::PrepareError;
use crate::grid::Grids;
use crate::limits::Limits;
use crate::triangles::cell;
use pipeline::{Mesh, PackedScene, Program};
use std::ops::Range;

/// Cells of a zone along each side: Concheiro's m.
pub const SIDE: u32 = 4;

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
}

impl Zones {
    /// The zones of grids of a scene, in steps within the limits.
    ///
    /// # Errors
    /// [`PrepareError::TooManyZones`] where steps are of whole patches, and one has more zones than a step may.
    pub fn new(grids: Grids, scene: &PackedScene, limits: &Limits) -> Result<Self, PrepareError> {
        let most = limits.zones.max(1);
        let mut firsts = vec![0];
        let mut patches = vec![];
        for record in &grids.picture.records {
            let start = firsts[firsts.len() - 1];
            let zones = record.cells().map(|cells| cells.div_ceil(SIDE)).iter().product::<u32>();
            if zones > most && limits.batch.is_some() {
                return Err(PrepareError::TooManyZones { face: record.face, span: record.span, zones, most });
            }
            firsts.push(start + zones);
            if zones > 0 {
                patches.push(Step { program: scene.programs()[record.face as usize], zones: start..start + zones });
            }
        }
        let steps = match limits.batch {
            None => of_zones(&patches, most),
            Some(batch) => of_patches(&patches, batch.max(1), most),
        };
        let mesh = in_zones(&grids, scene);
        Ok(Self { grids, mesh, firsts, steps })
    }
}

/// Steps that are full wherever a program has as many zones, each patch being a step by itself before.
fn of_zones(patches: &[Step], most: u32) -> Vec<Step> {
    let of_run = |run: &[Step]| {
        let (program, start, end) = (run[0].program, run[0].zones.start, run[run.len() - 1].zones.end);
        let starts = (start..end).step_by(most as usize);
        starts.map(move |start| Step { program, zones: start..end.min(start.saturating_add(most)) })
    };
    patches.chunk_by(|a, b| a.program == b.program).flat_map(of_run).collect()
}

/// Steps of whole patches, `batch` of them at most, none of which has more zones than a step may.
fn of_patches(patches: &[Step], batch: u32, most: u32) -> Vec<Step> {
    let mut steps: Vec<Step> = vec![];
    let mut more = 0;
    for Step { program, zones } in patches {
        match steps.last_mut() {
            Some(step) if more > 0 && step.program == *program && zones.end - step.zones.start <= most => {
                step.zones.end = zones.end;
                more -= 1;
            }
            _ => {
                steps.push(Step { program: *program, zones: zones.clone() });
                more = batch - 1;
            }
        }
    }
    steps
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

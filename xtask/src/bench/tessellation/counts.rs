//! Concheiro's Table 1: uniform against adaptive counts of triangles, beside the paper's own.

use crate::bench::frames::turning;
use anyhow::Result;
use isophote::stage::Plan;
use models::TeaScene;
use pipeline::PackedScene;
use scene::Viewport;
use serde::Serialize;
use techniques::{Limits, Setting, Technique};

/// Views over which adaptive counts are averaged: round the model, as it fills the picture.
pub const VIEWS: usize = 6;

/// Cells along a patch at the paper's level 4, whose grids have 2⁵ values a side.
const CELLS: usize = 31;

/// Triangles that are built to be counted, at most.
const MOST: usize = 4 << 20;

/// Levels up to Concheiro's L. His grids have 2^(L + 1) values along a side, and one cell less; ours have as many cells.
pub fn of_paper(level: u32) -> Limits {
    Limits { level: level + 1, ..Limits::default() }
}

/// A row, in thousands of 1,024 triangles.
#[derive(Debug, Clone, Serialize)]
pub struct Count {
    scene: &'static str,
    patches: usize,
    paper_uniform_4: f64,
    paper_adaptive_4: f64,
    paper_uniform_6: f64,
    paper_adaptive_6: f64,
    /// What a technique with equal cells makes of level 4; absent where that is too many to build.
    uniform_4: Option<f64>,
    /// What each technique makes by error on average, with the paper's levels up to 4, and up to 6; equal where it has none.
    pub adaptive: Vec<(&'static str, [f64; 2])>,
}

impl Count {
    /// As a row of the table.
    pub fn cells(&self) -> Vec<String> {
        let thousands = |x: f64| format!("{x:.2}");
        let mut cells = vec![
            self.scene.to_owned(),
            self.patches.to_string(),
            thousands(self.paper_uniform_4),
            self.uniform_4.map_or_else(|| "—".to_owned(), thousands),
            thousands(self.paper_adaptive_4),
            thousands(self.paper_adaptive_6),
        ];
        cells.extend(self.adaptive.iter().map(|(_, [four, six])| format!("{four:.2} / {six:.2}")));
        cells
    }
}

/// The rows of scenes.
///
/// # Errors
/// Where one cannot be prepared.
pub fn counts(
    plan: Plan,
    viewport: Viewport,
    scenes: &[&TeaScene],
    techniques: &[&'static dyn Technique],
) -> Result<Vec<Count>> {
    scenes.iter().map(|scene| count(scene, plan, viewport, techniques)).collect()
}

fn count(scene: &TeaScene, plan: Plan, viewport: Viewport, techniques: &[&'static dyn Technique]) -> Result<Count> {
    let model = models::builtin(scene.name).expect("built in");
    let packed = PackedScene::new(&model, plan.scheme)?;
    let thousands = |triangles: usize| triangles as f64 / 1024.0;
    let mut uniform_4 = None;
    if 2 * CELLS * CELLS * scene.patches <= MOST {
        for technique in techniques {
            if let Some(prepared) = technique.uniform(&model, &packed, CELLS)? {
                uniform_4 = Some(thousands(prepared.triangles()));
            }
        }
    }
    let cameras = turning(&model, viewport, VIEWS, 0.0);
    let mut adaptive = vec![];
    for technique in techniques {
        let up_to = |level: u32| -> Result<f64> {
            let Plan { chord_px, .. } = plan;
            let mut total = 0;
            for camera in &cameras {
                let limits = of_paper(level);
                let setting = Setting {
                    model: &model,
                    scene: &packed,
                    camera,
                    viewport,
                    chord_px,
                    limits,
                    vertex_normals: false,
                };
                total += technique.prepare(&setting)?.triangles();
            }
            Ok(thousands(total) / VIEWS as f64)
        };
        adaptive.push((technique.name(), [up_to(4)?, up_to(6)?]));
    }
    Ok(Count {
        scene: scene.name,
        patches: scene.patches,
        paper_uniform_4: scene.uniform_4,
        paper_adaptive_4: scene.adaptive_4,
        paper_uniform_6: scene.uniform_6,
        paper_adaptive_6: scene.adaptive_6,
        uniform_4,
        adaptive,
    })
}

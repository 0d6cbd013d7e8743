//! One technique at one goal: made, judged, and timed where it is what it claims.

use super::error::{Errors, Spread, errors, normals};
use super::goal::{Goal, meet};
use crate::cost::{self, Cost, Patience};
use anyhow::Result;
use compare::{Claims, PairReport, Verdict};
use gbuffer::GBuffer;
use raycast::Caster;
use serde::Serialize;
use std::time::Instant;
use suite::stage::{OnGpu, Plan, Stage};
use techniques::{Setting, Technique};

/// A line of the table.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Its name.
    pub technique: &'static str,
    /// What it was made to meet.
    pub goal: Goal,
    /// What came of it.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// What came of a technique at a goal.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It was drawn.
    Measured(Box<Measured>),
    /// It was not, and why.
    Failed(String),
}

/// What was measured of a technique at a goal.
#[derive(Debug, Clone, Serialize)]
pub struct Measured {
    /// Chord error asked for, pixels; absent where none can be.
    pub chord_px: Option<f64>,
    /// Chord error that it was built to, pixels: greater where the one asked for takes too many triangles.
    pub built_px: Option<f64>,
    /// Triangles drawn; of hulls where no flat triangle is shown.
    pub triangles: usize,
    /// Time of preparing it on the CPU, choosing levels included.
    pub prepare_ms: f64,
    /// Of the CPU rasterizer, with normals evaluated at the fragment.
    pub errors: Errors,
    /// Of normals interpolated from the triangles' corners, as Geiger and Concheiro shade; absent where there are none.
    pub vertex_normal_deg: Option<Spread>,
    /// The CPU rasterizer.
    pub cpu: Option<Cost>,
    /// The GPU.
    pub gpu: Option<Cost>,
    /// Why a renderer was not timed, where one was not.
    pub not_timed: Vec<String>,
}

/// What all rows share.
pub struct Scene<'a, 'm> {
    /// The model, packed, with its camera; its technique is replaced.
    pub stage: &'a Stage<'m>,
    /// Of its model.
    pub caster: &'a Caster<'m>,
    /// What it sees.
    pub exact: &'a GBuffer,
    /// The GPU, where there is one.
    pub device: Option<&'a gpu::Device>,
    /// How much measuring is enough.
    pub patience: Patience,
}

/// A row, and the picture that its errors are of.
pub fn row(scene: &Scene, technique: &'static dyn Technique, goal: Goal) -> (Row, Option<GBuffer>) {
    let (outcome, picture) = match measured(scene, technique, goal) {
        Ok((measured, picture)) => (Outcome::Measured(Box::new(measured)), Some(picture)),
        Err(error) => (Outcome::Failed(format!("{error:#}")), None),
    };
    (Row { technique: technique.name(), goal, outcome }, picture)
}

fn measured(scene: &Scene, technique: &'static dyn Technique, goal: Goal) -> Result<(Measured, GBuffer)> {
    let Stage { model, camera, viewport, .. } = *scene.stage;
    let plan = scene.stage.plan;
    let Plan { chord_px, limits, .. } = plan;
    // One lot of triangles for normals of either kind.
    let vertex_normals = false;
    let setting =
        Setting { model, scene: &scene.stage.scene, camera: &camera, viewport, chord_px, limits, vertex_normals };
    let (_, chord_px) = meet(technique, &setting, goal)?;
    let clock = Instant::now();
    let prepared = technique.prepare(&Setting { chord_px, ..setting })?;
    let prepare_ms = 1e3 * clock.elapsed().as_secs_f64();
    let has_chords = technique.claims() == Claims::Chord;
    let stage = Stage {
        plan: Plan { technique, chord_px, ..plan },
        scene: scene.stage.scene.clone(),
        prepared,
        views: scene.stage.views.clone(),
        interpolation: scene.stage.interpolation.clone(),
        vertex_normals: None,
        original: scene.stage.original.clone(),
        ..*scene.stage
    };
    let picture = stage.raster();
    let vertex = has_chords.then(|| {
        let options = raster::Options { curvature: false, vertex_normals: true };
        normals(&stage.rasterizer(options).render(stage.meta("raster"), &|_| {}), scene.exact)
    });
    let mut not_timed = vec![];
    let pair = stage.against_raycast(scene.caster, scene.exact, &picture)?;
    let cpu = agrees(&pair, &mut not_timed).then(|| cost::on_cpu(&stage, scene.patience));
    let gpu = match scene.device {
        None => {
            not_timed.push("gpu: not run".to_owned());
            None
        }
        Some(device) => match on_gpu(scene, &stage, device, &picture, &mut not_timed) {
            Ok(cost) => cost,
            Err(error) => {
                not_timed.push(format!("gpu: {error:#}"));
                None
            }
        },
    };
    let measured = Measured {
        chord_px: has_chords.then_some(chord_px),
        built_px: stage.prepared.built_px(),
        triangles: stage.prepared.triangles(),
        prepare_ms,
        errors: errors(&picture, scene.exact, &camera),
        vertex_normal_deg: vertex,
        cpu,
        gpu,
        not_timed,
    };
    Ok((measured, picture))
}

/// The GPU's cost, where its picture agrees with rays and with the CPU's.
fn on_gpu(
    scene: &Scene,
    stage: &Stage,
    device: &gpu::Device,
    raster: &GBuffer,
    not_timed: &mut Vec<String>,
) -> Result<Option<Cost>> {
    let OnGpu { gbuffer: picture, moves_px, .. } = stage.gpu(device, None, gpu::Overrides::default())?;
    let pairs = [
        stage.against_raycast_on(scene.caster, scene.exact, &picture, moves_px)?,
        stage.against_raster_on(raster, &picture, moves_px)?,
    ];
    if !pairs.iter().all(|pair| agrees(pair, not_timed)) {
        return Ok(None);
    }
    Ok(Some(cost::on_gpu(stage, device, scene.patience)?))
}

/// Whether two renderers agree; if not, that is why the second is not timed.
fn agrees(pair: &PairReport, not_timed: &mut Vec<String>) -> bool {
    let PairReport { reference, candidate, .. } = pair;
    match pair.verdict {
        Verdict::Agree => return true,
        Verdict::Differ => not_timed.push(format!("{reference} | {candidate}: {} pixels differ", pair.differing())),
        Verdict::NoVerdict => not_timed.push(format!("{reference} | {candidate}: too few pixels have a verdict")),
    }
    false
}

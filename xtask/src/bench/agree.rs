//! Renderers whose pictures disagree are not timed.

use anyhow::Result;
use compare::Verdict;
use isophote::stage::{Path, Plan, Stage};
use raycast::Caster;
use scene::{Camera, Model, Viewport};

/// Size at which renderers are compared before they are timed.
const CHECK: usize = 96;

/// What two renderers of a model disagree on, each pair judged as `compare` does; `None` where all agree.
///
/// # Errors
/// Where one cannot be run.
pub fn disagreement(model: &Model, device: Option<&gpu::Device>, plan: Plan) -> Result<Option<String>> {
    let viewport = Viewport::new(CHECK, CHECK)?;
    let stage = Stage::new(model, Camera::framing(model, viewport), viewport, plan)?;
    let caster = Caster::new(model);
    let (raycast, raster) = (stage.raycast(&caster), stage.raster());
    let mut pairs = vec![stage.against_raycast(&caster, &raycast, &raster)?];
    if let Some(device) = device {
        let on_gpu = stage.gpu(device, None, gpu::Overrides::default())?;
        if plan.path == Path::Strict {
            let unlike = raster.unlike(&on_gpu.gbuffer);
            if unlike.pixels > 0 {
                return Ok(Some(format!("raster and gpu on {}: {unlike}", model.name())));
            }
        }
        pairs.push(stage.against_raycast_on(&caster, &raycast, &on_gpu.gbuffer, on_gpu.moves_px)?);
        pairs.push(stage.against_raster_on(&raster, &on_gpu.gbuffer, on_gpu.moves_px)?);
    }
    Ok(pairs.iter().find(|pair| pair.verdict != Verdict::Agree).map(|pair| {
        let how = match pair.verdict {
            Verdict::NoVerdict => "have too few pixels with a verdict".to_owned(),
            _ => format!("differ in {} pixels", pair.differing()),
        };
        format!(
            "{} and {} disagree on {}: they {how}; there is nothing to time (see `isophote compare {} --technique {}`)",
            pair.reference,
            pair.candidate,
            model.name(),
            model.name(),
            plan.technique.name()
        )
    }))
}

//! What a frame costs: time on the CPU and on the GPU, bytes sent and bytes held.

use anyhow::Result;
use gbuffer::{ShadeKind, Shading};
use serde::Serialize;
use std::hint::black_box;
use std::time::Instant;
use suite::stage::Stage;

/// Fewest frames of a figure: with one less there is no telling the first from the others.
const FEWEST_FRAMES: usize = 3;

/// How much measuring is enough.
#[derive(Debug, Clone, Copy)]
pub struct Patience {
    /// Frames of a figure, at most.
    pub frames: usize,
    /// Seconds that these should take; three frames are drawn whatever they take.
    pub seconds: f64,
}

/// What frames of one technique on one renderer cost.
#[derive(Debug, Clone, Serialize)]
pub struct Cost {
    /// How many were drawn.
    pub frames: usize,
    /// The mean of all, by the clock on the wall; on the GPU up to three are under way at once.
    pub frame_ms: f64,
    /// The median by the device's own clock; absent where it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gpu_ms: Option<f64>,
    /// Medians of the frame's parts by the same clock, by name.
    #[serde(skip)]
    pub parts_ms: Vec<(&'static str, f64)>,
    /// What a frame takes of the thread that encodes and submits it, by that thread's clock: what drivers and devices do in
    /// other threads does not count. Absent where no such clock is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub processor_ms: Option<f64>,
    /// Bytes that a frame sends to the device: how each face is seen. Absent on the CPU.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes_uploaded: Option<u64>,
    /// Bytes that the device holds for the scene and the technique, as its allocator reports them; what a frame alone has, as
    /// its targets, does not count. Absent on the CPU and where no report is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes_held: Option<u64>,
}

impl Cost {
    /// Frames a second.
    pub fn frames_per_second(&self) -> f64 {
        1e3 / self.frame_ms
    }
}

/// Seconds that this thread has worked.
#[cfg(unix)]
fn worked_s() -> Option<f64> {
    use rustix::time::{ClockId, clock_gettime};
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Some(now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9)
}

#[cfg(not(unix))]
fn worked_s() -> Option<f64> {
    None
}

/// Frames of the CPU rasterizer, from its vertices to a G-buffer without curvature.
pub fn on_cpu(stage: &Stage, patience: Patience) -> Cost {
    let options = raster::Options { curvature: false, vertex_normals: stage.plan.vertex_normals };
    let clock = Instant::now();
    let mut frames = 0;
    while frames < FEWEST_FRAMES || frames < patience.frames && clock.elapsed().as_secs_f64() < patience.seconds {
        black_box(stage.rasterizer(options).render(stage.meta("raster"), &|_| {}));
        frames += 1;
    }
    let frame_ms = 1e3 * clock.elapsed().as_secs_f64() / frames as f64;
    Cost {
        frames,
        frame_ms,
        gpu_ms: None,
        parts_ms: vec![],
        processor_ms: None,
        bytes_uploaded: None,
        bytes_held: None,
    }
}

/// Frames of the GPU, shaded by isophotes in the fragment stage, none read back.
///
/// # Errors
/// Where the adapter refuses.
pub fn on_gpu(stage: &Stage, device: &gpu::Device, patience: Patience) -> Result<Cost> {
    let held = || device.wgpu.generate_allocator_report().map(|report| report.total_allocated_bytes);
    device.wait("measuring", None)?;
    let before = held();
    let vertex_normals = stage.plan.vertex_normals;
    let options = gpu::RendererOptions { vertex_normals, ..gpu::RendererOptions::default() };
    let mut renderer = stage.renderer_of(device, options)?;
    let shading = Shading::new(ShadeKind::Isophotes).uniform(&stage.camera, stage.model.hull().diagonal());
    let mut draw = |frames: usize| -> Result<(gpu::Timing, Option<f64>)> {
        let start = worked_s();
        let timing = renderer.time_shaded(&vec![stage.views.clone(); frames], &shading, stage.viewport)?;
        Ok((timing, worked_s().zip(start).map(|(end, start)| end - start)))
    };
    // The first compiles; the second says how many there is time for, and what a frame's surroundings take.
    draw(1)?;
    let (one, around) = draw(1)?;
    let frames = ((patience.seconds / one.wall_s) as usize).min(patience.frames).max(FEWEST_FRAMES);
    let (timing, worked) = draw(frames)?;
    let bytes_held = held().zip(before).map(|(after, before)| after.saturating_sub(before));
    let median_ms = |mut seconds: Vec<f64>| {
        seconds.sort_by(f64::total_cmp);
        1e3 * seconds[seconds.len() / 2]
    };
    let parts = timing.parts_s.into_iter().filter(|(_, seconds)| !seconds.is_empty());
    let parts_ms = parts.map(|(name, seconds)| (name, median_ms(seconds))).collect();
    let gpu_ms = timing.gpu_s.map(median_ms);
    let processor = |(all, one): (f64, f64)| 1e3 * (all - one).max(0.0) / (frames - 1) as f64;
    Ok(Cost {
        frames,
        frame_ms: 1e3 * timing.wall_s / frames as f64,
        gpu_ms,
        parts_ms,
        processor_ms: worked.zip(around).map(processor),
        bytes_uploaded: Some(size_of_val(&*stage.views) as u64),
        bytes_held,
    })
}

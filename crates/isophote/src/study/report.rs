//! What a study says: of what, on what, with which caveats, and its rows.

use super::row::{Measured, Outcome, Row};
use crate::cost::Patience;
use nurbs::Direction;
use scene::{Camera, Model, Viewport};
use serde::Serialize;

/// What each number is, and is not: printed below every form of the report.
pub const CAVEATS: &[&str] = &[
    "Errors are the CPU rasterizer's against the f64 ray caster's at pixels' centres. The GPU runs the same program; it is timed only where `compare` agrees.",
    "Offset: from a pixel's centre to where S(u, v) is seen, at the (u, v) that the pixel shows. A flat triangle is on the ray itself, and S off it by the chord.",
    "Normals, degrees: evaluated at the fragment, or interpolated from a triangle's corners as Geiger and Concheiro shade. Pixels without a normal, and those that show another face, do not count.",
    "Coverage: pixels that only the ray caster covers (missing), that only the rasterizer covers (extra), and that show another face.",
    "A triangle budget is met from below by the chord error asked for; technique `exact` shows no flat triangle, its triangles are of hulls, and neither goal can be asked of it.",
    "The same error is the same proven bound. What is found is less, by how much differs from technique to technique.",
    "CPU: all threads, from vertices to a G-buffer. GPU: shaded frames, none read back, up to three under way at once. Levels are chosen when a scene is prepared, which no frame counts.",
    "Processor time is of the thread that encodes and submits, not of a driver's other threads; a software GPU works in those.",
    "Bytes held are what the device's allocator reports for scene and technique; what a frame alone has, as its targets, does not count. Bytes sent a frame are one view a face.",
    "Technique `zones` draws the triangles of `grid`, made otherwise: their errors are the same, and lines may cover each other.",
    "A time is of this machine as busy as it was. Compare within one run.",
];

/// A study.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Of the layout of this document.
    pub version: u32,
    /// The model's name.
    pub model: String,
    /// Its hash.
    pub model_hash: String,
    /// How many faces it has.
    pub faces: usize,
    /// How many Bézier patches these have.
    pub patches: usize,
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// Who looks.
    pub camera: Camera,
    /// The GPU's name, and that of its driver; absent where there was none.
    pub adapter: Option<Adapter>,
    /// Why there was none.
    pub gpu_not_run: Option<String>,
    /// Threads of the CPU's renderers.
    pub threads: usize,
    /// Frames of a time at most.
    pub frames: usize,
    /// Seconds that a time may take.
    pub seconds: f64,
    /// What the numbers are.
    pub caveats: &'static [&'static str],
    /// A technique at a goal each.
    pub rows: Vec<Row>,
}

/// A GPU and its driver.
#[derive(Debug, Clone, Serialize)]
pub struct Adapter {
    /// Its name.
    pub name: String,
    /// Its driver's.
    pub driver: String,
}

impl Adapter {
    /// That of an open device.
    pub fn of(device: &gpu::Device) -> Self {
        let info = device.info();
        let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
        Self { name: info.name.clone(), driver }
    }
}

/// The Bézier patches of a model's faces.
pub fn patches(model: &Model) -> usize {
    let spans = |surface: &nurbs::Surface, direction| surface.knots(direction).spans().count();
    let of = |face: &scene::Face| {
        let surface = &model.surfaces()[face.surface];
        spans(surface, Direction::U) * spans(surface, Direction::V)
    };
    model.faces().iter().map(of).sum()
}

impl Report {
    /// A study without rows yet.
    pub fn new(
        model: &Model,
        camera: Camera,
        viewport: Viewport,
        gpu: Result<Adapter, String>,
        patience: Patience,
    ) -> Self {
        let (adapter, gpu_not_run) = match gpu {
            Ok(adapter) => (Some(adapter), None),
            Err(why) => (None, Some(why)),
        };
        Self {
            version: 1,
            model: model.name().to_owned(),
            model_hash: model.hash(),
            faces: model.faces().len(),
            patches: patches(model),
            size: [viewport.width(), viewport.height()],
            camera,
            adapter,
            gpu_not_run,
            threads: rayon::current_num_threads(),
            frames: patience.frames,
            seconds: patience.seconds,
            caveats: CAVEATS,
            rows: vec![],
        }
    }

    /// The rows that were measured.
    pub fn measured(&self) -> impl Iterator<Item = (&Row, &Measured)> {
        self.rows.iter().filter_map(|row| match &row.outcome {
            Outcome::Measured(measured) => Some((row, &**measured)),
            Outcome::Failed(_) => None,
        })
    }
}

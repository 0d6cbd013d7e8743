//! The scenes on which faults show, each drawn by the fault's renderer and judged by the ray caster.

use compare::PairReport;
use gbuffer::{GBuffer, Hit};
use glam::DVec3;
use isophote::stage::{Plan, Stage};
use nurbs::{KnotVector, Surface};
use raycast::Caster;
use scene::{Camera, Face, Model, Projection, Viewport};
use std::sync::Arc;
use techniques::fragment::Tessellation;

const SIDE: usize = 64;

/// What is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scene {
    /// Many bicubic faces.
    Bicubic,
    /// One face of many spans.
    ManySpans,
    /// A rational face.
    Rational,
    /// A rational face of many more control points in u than in v, with repeated knots.
    Wave,
    /// [`Scene::Bicubic`] with all faces reversed.
    Reversed,
    /// Two large triangles seen at a steep angle: depth varies by a factor of ten within each.
    Steep,
    /// A square whose edge u = 1 runs exactly through a column of pixel centres.
    EdgeOnCentres,
    /// A trimmed face: a hole, an island in it, a hole in the island.
    Islands,
    /// A trimmed face of many short edges.
    Text,
}

/// All of them.
pub const ALL: &[Scene] = &[
    Scene::Bicubic,
    Scene::ManySpans,
    Scene::Rational,
    Scene::Wave,
    Scene::Reversed,
    Scene::Steep,
    Scene::EdgeOnCentres,
    Scene::Islands,
    Scene::Text,
];

/// A scene's model and camera.
pub struct Shown {
    pub model: Model,
    pub camera: Camera,
    cells: Option<usize>,
}

impl Shown {
    pub fn new(scene: Scene) -> Self {
        match scene {
            Scene::Bicubic => framed(builtin("teapot")),
            Scene::ManySpans => framed(builtin("periodic")),
            Scene::Rational => framed(builtin("torus")),
            Scene::Wave => framed(builtin("rational")),
            Scene::Reversed => framed(reversed(&builtin("teapot"))),
            Scene::Islands => framed(builtin("islands")),
            Scene::Text => framed(builtin("text")),
            Scene::Steep => {
                let projection = Projection::Perspective { fov_deg: 70.0 };
                let camera = Camera::look_at(DVec3::new(0.0, -1.2, 0.35), DVec3::ZERO, DVec3::Z, projection);
                Self { model: square(), camera: camera.expect("legal"), cells: Some(1) }
            }
            Scene::EdgeOnCentres => {
                // 64 pixels on 4 units, shifted by half a pixel.
                let shift = DVec3::new(2.0 / SIDE as f64, 2.0 / SIDE as f64, 0.0);
                let projection = Projection::Orthographic { height: 4.0 };
                let camera = Camera::look_at(shift + DVec3::Z * 4.0, shift, DVec3::Y, projection);
                Self { model: square(), camera: camera.expect("legal"), cells: Some(1) }
            }
        }
    }

    pub fn stage(&self) -> Stage<'_> {
        let plan = Plan { chord_px: 0.5, ..Plan::default() };
        let mut stage = Stage::new(&self.model, self.camera, viewport(), plan).expect("a stage");
        if let Some(cells) = self.cells {
            stage.prepared = Arc::new(Tessellation::uniform(&self.model, &stage.scene, cells).expect("few triangles"));
        }
        stage
    }

    /// The comparison of the GPU, with overrides, against the ray caster.
    pub fn on_gpu(&self, overrides: gpu::Overrides) -> PairReport {
        let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
        let stage = self.stage();
        self.judged(&stage, &stage.gpu(&device, None, overrides).expect("the GPU draws").gbuffer)
    }

    /// The comparison of the CPU's G-buffer, each pixel (x, y) changed, against the ray caster.
    pub fn changed(&self, change: impl Fn(usize, usize, Option<&Hit>) -> Option<Hit>) -> PairReport {
        let stage = self.stage();
        let buffer = stage.raster();
        let row = |y| (0..SIDE).map(|x| change(x, y, buffer.get(x, y))).collect();
        self.judged(&stage, &GBuffer::from_rows(viewport(), stage.meta("changed"), (0..SIDE).map(row)))
    }

    fn judged(&self, stage: &Stage, candidate: &GBuffer) -> PairReport {
        let caster = Caster::new(&self.model);
        stage.against_raycast(&caster, &stage.raycast(&caster), candidate).expect("comparable")
    }
}

pub fn viewport() -> Viewport {
    Viewport::new(SIDE, SIDE).expect("a legal size")
}

fn builtin(name: &str) -> Model {
    models::builtin(name).expect("built in")
}

fn framed(model: Model) -> Shown {
    let camera = Camera::framing(&model, viewport());
    Shown { model, camera, cells: None }
}

fn reversed(model: &Model) -> Model {
    let faces = model.faces().iter().map(|face| Face { reversed: true, ..face.clone() }).collect();
    Model::new("reversed", model.surfaces().to_vec(), faces).expect("as legal as before")
}

/// A flat bilinear square over [−1, 1]² with u along −x, so that u = 1 on its left edge in the picture.
fn square() -> Model {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal");
    let points = [(1.0, -1.0), (1.0, 1.0), (-1.0, -1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let surface = Surface::new(knots(), knots(), points.to_vec(), None).expect("legal");
    Model::of_surfaces("square", vec![surface]).expect("one face")
}

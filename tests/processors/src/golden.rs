//! The scenes of which goldens are kept, and the CPU's G-buffers of them.

use gbuffer::{GBuffer, Meta};
use glam::DVec3;
use pipeline::{PackedScene, Scheme};
use raster::{Drawing, Options, Rasterizer};
use raycast::Caster;
use scene::{Camera, Model, Projection, Viewport};
use techniques::{DEFAULT_CHORD_PX, Limits, Setting, Technique};

/// A golden's size, pixels: small enough that all files of G-buffers stay under a megabyte.
const SIZE: [usize; 2] = [64, 48];

/// A scene: a built-in model, a view, a scheme.
#[derive(Debug, Clone, Copy)]
pub struct Golden {
    /// Its name, and that of its file.
    pub name: &'static str,
    model: &'static str,
    scheme: Scheme,
    /// Eye, target and height, for an orthographic view; the framing camera without it.
    ortho: Option<([f64; 3], [f64; 3], f64)>,
}

/// Those whose G-buffers by the rasterizer are kept whole.
pub const GOLDENS: &[Golden] = &[
    Golden::framed("teapot", "teapot"),
    Golden {
        name: "sphere-poles",
        model: "sphere",
        scheme: Scheme::General,
        ortho: Some(([0.3, 0.2, 4.0], [0.0, 0.0, 0.0], 2.4)),
    },
    Golden::framed("surface-14x6", "surface"),
    Golden { scheme: Scheme::General, ..Golden::framed("degrees-5-2", "quintic-quadratic") },
    Golden::framed("periodic", "periodic"),
];

/// All of which a hash is kept: those, and each hard or trimmed model framed.
pub fn all() -> impl Iterator<Item = Golden> {
    let models = [models::HARD, models::TRIMMED].into_iter().flatten();
    GOLDENS.iter().copied().chain(models.map(|&(name, _)| Golden::framed(name, name)))
}

impl Golden {
    const fn framed(name: &'static str, model: &'static str) -> Self {
        Self { name, model, scheme: Scheme::Specialised, ortho: None }
    }

    /// The model.
    pub fn model(&self) -> Model {
        models::builtin(self.model).expect("goldens use built-in models")
    }

    fn viewport(&self) -> Viewport {
        Viewport::new(SIZE[0], SIZE[1]).expect("a legal size")
    }

    fn camera(&self, model: &Model) -> Camera {
        match self.ortho {
            None => Camera::framing(model, self.viewport()),
            Some((eye, target, height)) => {
                let projection = Projection::Orthographic { height };
                Camera::look_at(DVec3::from_array(eye), DVec3::from_array(target), DVec3::Y, projection)
                    .expect("goldens have legal cameras")
            }
        }
    }

    /// The rasterizer's G-buffer by a technique.
    pub fn raster(&self, model: &Model, technique: &dyn Technique) -> GBuffer {
        let (viewport, camera) = (self.viewport(), self.camera(model));
        let scene = PackedScene::new(model, self.scheme).expect("built-in models can be packed");
        let setting = Setting {
            model,
            scene: &scene,
            camera: &camera,
            viewport,
            chord_px: DEFAULT_CHORD_PX,
            limits: Limits::default(),
            vertex_normals: false,
        };
        let prepared = technique.prepare(&setting).expect("built-in models take few triangles");
        let views = scene.views(model, &camera, viewport);
        let options = Options { curvature: true, vertex_normals: false };
        let drawing = Drawing { scene: &scene, views: &views, camera: &camera, viewport, options };
        let meta = Meta::new("raster", technique.name(), model, &camera);
        Rasterizer::new(drawing, prepared.visibility(drawing)).render(meta, &|_| {})
    }

    /// The ray caster's G-buffer.
    pub fn raycast(&self, model: &Model) -> GBuffer {
        Caster::new(model).render(&self.camera(model), self.viewport(), &|_| {})
    }
}

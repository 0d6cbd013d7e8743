//! Draws one model again and again, and keeps what the next picture can use: what is packed, and the GPU's copy of it.

use crate::with::With;
use anyhow::Result;
use gbuffer::{GBuffer, Picture, Shading};
use gpu::{Drawable, GpuError};
use pipeline::PackedScene;
use raycast::Caster;
use scene::{Camera, FaceId, Model, Viewport};
use std::sync::Arc;
use suite::stage::{Plan, Stage};
use techniques::Prepared;

/// What is to be drawn, and how.
#[derive(Clone, Copy)]
pub struct Scene<'m> {
    /// The model.
    pub model: &'m Model,
    /// Who looks.
    pub camera: Camera,
    /// At how many pixels.
    pub viewport: Viewport,
    /// How it is drawn.
    pub plan: Plan,
}

/// A renderer, and what it has of a model.
pub struct Drawer<'d> {
    with: With,
    device: Option<&'d gpu::Device>,
    held: Option<Held<'d>>,
}

struct Held<'d> {
    plan: Plan,
    /// From where it was prepared.
    camera: Camera,
    viewport: Viewport,
    /// Whether control points were moved since: the triangles are those of before, moved along.
    is_edited: bool,
    scene: Arc<PackedScene>,
    drawn: Drawn,
    renderer: Option<gpu::Renderer<'d>>,
}

/// What a technique draws, and what is drawn in its place by the path that was asked for.
struct Drawn {
    prepared: Arc<dyn Prepared>,
    by_path: Option<Box<dyn Drawable>>,
}

impl Drawn {
    fn new(plan: &Plan, device: Option<&gpu::Device>, prepared: Arc<dyn Prepared>) -> Self {
        let by_path = device.and_then(|device| plan.path.drawn(device, &prepared));
        Self { prepared, by_path }
    }

    fn drawable(&self) -> &dyn Drawable {
        match &self.by_path {
            Some(by_path) => &**by_path,
            None => &*self.prepared,
        }
    }
}

impl<'d> Drawer<'d> {
    /// One that draws by a renderer; `device` is the GPU's.
    pub fn new(with: With, device: Option<&'d gpu::Device>) -> Self {
        Self { with, device, held: None }
    }

    /// Which renderer draws.
    pub fn with(&self) -> With {
        self.with
    }

    /// What each pixel sees, as `render` has it. With `moving` it may be of triangles that were moved along with an edit.
    ///
    /// # Errors
    /// Where the plan does not fit the model, or the adapter refuses.
    pub fn gbuffer(&mut self, scene: Scene, moving: bool) -> Result<GBuffer> {
        if self.with == With::Raycast {
            return Ok(Caster::new(scene.model).render(&scene.camera, scene.viewport, &|_| {}));
        }
        let held = self.prepared(scene, moving)?;
        let stage = held.stage(scene);
        match &mut held.renderer {
            Some(renderer) => Ok(stage.drawn_by(renderer, None)?.gbuffer),
            None => Ok(stage.raster()),
        }
    }

    /// The picture that the GPU shades by itself; `None` where another renderer draws.
    ///
    /// # Errors
    /// As [`Self::gbuffer`].
    pub fn shaded(&mut self, scene: Scene, shading: &Shading) -> Result<Option<Picture>> {
        if self.with != With::Gpu || scene.plan.vertex_normals {
            return Ok(None);
        }
        let held = self.prepared(scene, true)?;
        let views = held.scene.views(scene.model, &scene.camera, scene.viewport);
        let uniform = shading.uniform(&scene.camera, scene.model.hull().diagonal());
        let draw = |renderer: &mut gpu::Renderer| renderer.shaded(&views, &uniform, scene.viewport);
        Ok(held.renderer.as_mut().map(draw).transpose()?)
    }

    /// The stage of a scene of which a picture was drawn; `None` where no rasterizer drew it.
    pub fn stage<'m>(&self, scene: Scene<'m>) -> Option<Stage<'m>> {
        self.held.as_ref().map(|held| held.stage(scene))
    }

    /// Takes over a scene whose model has moved control points of one face's surface. Only what differs goes to the GPU.
    ///
    /// # Errors
    /// As [`Self::gbuffer`].
    pub fn edited(&mut self, scene: Scene, face: FaceId) -> Result<()> {
        let Some(held) = self.held.take().filter(|held| held.plan == scene.plan) else { return Ok(()) };
        let Held { plan, camera, viewport, scene: before, drawn, renderer, .. } = held;
        let after = Arc::new(plan.packed(scene.model, &camera, viewport)?);
        let setting = plan.setting(scene.model, &after, &camera, viewport);
        let follows = Drawn::new(&plan, self.device, drawn.prepared.edited(&setting, face)?);
        let renderer = match renderer {
            None => None,
            Some(mut renderer) => {
                match renderer.edit((&before, drawn.drawable()), (&after, follows.drawable())) {
                    Ok(_) => Some(renderer),
                    // The next picture begins anew.
                    Err(GpuError::OtherShape { .. }) => return Ok(()),
                    Err(error) => return Err(error.into()),
                }
            }
        };
        self.held = Some(Held { plan, camera, viewport, is_edited: true, scene: after, drawn: follows, renderer });
        Ok(())
    }

    /// Begins anew, as for another model.
    pub fn forget(&mut self) {
        self.held = None;
    }

    fn prepared(&mut self, scene: Scene, moving: bool) -> Result<&mut Held<'d>> {
        let Scene { model, camera, viewport, plan } = scene;
        let device = self.device;
        let held = match self.held.take().filter(|held| held.plan == plan) {
            Some(held) if held.camera == camera && held.viewport == viewport && (moving || !held.is_edited) => held,
            // Masks are drawn for a camera.
            Some(held) if held.scene.masks().is_none() => {
                let drawn = Drawn::new(&plan, device, plan.prepared(model, &held.scene, &camera, viewport)?);
                let mut renderer = held.renderer;
                renderer.iter_mut().try_for_each(|renderer| renderer.set(drawn.drawable()))?;
                Held { plan, camera, viewport, is_edited: false, scene: held.scene, drawn, renderer }
            }
            _ => {
                let packed = Arc::new(plan.packed(model, &camera, viewport)?);
                let drawn = Drawn::new(&plan, device, plan.prepared(model, &packed, &camera, viewport)?);
                let mut held = Held { plan, camera, viewport, is_edited: false, scene: packed, drawn, renderer: None };
                held.renderer = match device {
                    Some(device) => Some(held.stage(scene).renderer(device, gpu::Overrides::default())?),
                    None => None,
                };
                held
            }
        };
        Ok(self.held.insert(held))
    }
}

impl Held<'_> {
    fn stage<'m>(&self, scene: Scene<'m>) -> Stage<'m> {
        let Scene { model, camera, viewport, plan } = scene;
        Stage::of(model, camera, viewport, plan, self.scene.clone(), self.drawn.prepared.clone())
    }
}

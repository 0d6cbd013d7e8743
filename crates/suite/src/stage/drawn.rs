//! A model, seen: everything the three renderers need, made once, and what they return.

use super::plan::{Path, Plan};
use crate::progress::{note, progress};
use anyhow::Result;
use compare::{Claims, Interpolation, StandIn, VertexNormals};
use gbuffer::{GBuffer, Meta, Picture, Shading, Trims};
use pipeline::mask::{MaskQuality, Trimming};
use pipeline::{PackedScene, View};
use raster::{Drawing, Rasterizer};
use raycast::Caster;
use scene::{Camera, Model, SamplePattern, Viewport};
use std::sync::Arc;
use techniques::Prepared;

/// A mask that is coarser by a factor has no fewer texels than one asked for with an error larger by it and by this.
const COARSER_ROUNDING: f64 = 1.0 + 1e-9;

/// A model with a camera, packed and tessellated.
pub struct Stage<'m> {
    /// The model.
    pub model: &'m Model,
    /// Who looks.
    pub camera: Camera,
    /// At how many pixels.
    pub viewport: Viewport,
    /// How it is drawn.
    pub plan: Plan,
    /// The faces in f32; shared by the stages of a picture's samples.
    pub scene: Arc<PackedScene>,
    /// What the technique draws of them; shared alike.
    pub prepared: Arc<dyn Prepared>,
    /// How the camera sees each face.
    pub views: Vec<View>,
    /// How accurately its parameters are interpolated over them.
    pub interpolation: Interpolation,
    /// What its triangles' corners may carry, where pixels show that.
    pub vertex_normals: Option<VertexNormals>,
    /// What the model stands for, where it is drawn in the place of another.
    pub original: Option<Original<'m>>,
}

/// A model in whose place a stage draws another, by which it is judged.
#[derive(Clone)]
pub struct Original<'m> {
    /// It.
    pub(super) model: &'m Model,
    /// It, as rasterizers would read it.
    pub(super) scene: Arc<PackedScene>,
    /// How the other lies on it.
    pub(super) stand_in: &'m StandIn,
}

/// The three G-buffers of a stage; the GPU's where there was an adapter.
pub struct Rendered {
    /// Ground truth.
    pub raycast: GBuffer,
    /// The CPU's fragment program.
    pub raster: GBuffer,
    /// The GPU's, or why it did not run.
    pub gpu: Result<OnGpu, String>,
}

/// What the GPU returned.
pub struct OnGpu {
    /// Its G-buffer.
    pub gbuffer: GBuffer,
    /// Its own shading, in the fragment stage, where one was asked for.
    pub shaded: Option<Picture>,
    /// How far its adapter's rasterizer moves a corner along each side of a pixel, as measured there; none where no rasterizer
    /// draws corners, or no grid was found.
    pub moves_px: Option<f64>,
}

impl<'m> Stage<'m> {
    /// Packs and tessellates `model` for `camera`.
    ///
    /// # Errors
    /// Where the model cannot be packed or the chord error asks for too many triangles.
    pub fn new(model: &'m Model, camera: Camera, viewport: Viewport, plan: Plan) -> Result<Self> {
        let scene = Arc::new(plan.packed(model, &camera, viewport)?);
        let prepared = plan.prepared(model, &scene, &camera, viewport)?;
        if let Some(kept) = prepared.built_px().filter(|kept| *kept > plan.chord_px) {
            let (asked, triangles) = (plan.chord_px, prepared.triangles());
            note(format_args!(
                "note: a chord error of {asked} px takes more than it may from here; {triangles} triangles keep to {kept:.3} px"
            ));
        }
        Ok(Self::of(model, camera, viewport, plan, scene, prepared))
    }

    /// A stage of what was packed and prepared before, by this plan.
    pub fn of(
        model: &'m Model,
        camera: Camera,
        viewport: Viewport,
        plan: Plan,
        scene: Arc<PackedScene>,
        prepared: Arc<dyn Prepared>,
    ) -> Self {
        let views = scene.views(model, &camera, viewport);
        let interpolation = Interpolation::of(model);
        let vertex_normals = plan.vertex_normals.then(|| VertexNormals::new(model, prepared.cells()));
        Self { model, camera, viewport, plan, scene, prepared, views, interpolation, vertex_normals, original: None }
    }

    /// The same stage, judged as one that draws its model in the place of `model`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn in_place_of(self, model: &'m Model, stand_in: &'m StandIn) -> Result<Self> {
        let scene = Arc::new(self.plan.packed(model, &self.camera, self.viewport)?);
        Ok(Self { original: Some(Original { model, scene, stand_in }), ..self })
    }

    /// The model that pictures are judged by: what rays are to be cast at.
    pub fn truth(&self) -> &'m Model {
        self.original.as_ref().map_or(self.model, |original| original.model)
    }

    /// A stage a sample of `pattern`, in its order. Scene, masks and triangles are those of this stage: a pixel's size at a
    /// face, all that they depend on of a camera, is the same wherever in the pixel one looks.
    pub fn samples(&self, pattern: SamplePattern) -> impl Iterator<Item = Stage<'m>> {
        pattern.cameras(&self.camera, self.viewport).into_iter().map(|camera| Stage {
            camera,
            scene: self.scene.clone(),
            prepared: self.prepared.clone(),
            views: self.scene.views(self.model, &camera, self.viewport),
            interpolation: self.interpolation.clone(),
            vertex_normals: self.vertex_normals.clone(),
            original: self.original.clone(),
            ..*self
        })
    }

    /// The rasterizer of this stage.
    pub fn rasterizer(&self, options: raster::Options) -> Rasterizer<'_> {
        let Self { scene, views, camera, viewport, .. } = self;
        let drawing = Drawing { scene, views, camera, viewport: *viewport, options };
        Rasterizer::new(drawing, self.prepared.visibility(drawing))
    }

    /// The facts that go with a buffer of this stage.
    pub fn meta(&self, renderer: &str) -> Meta {
        Meta { trims: self.trims(), ..Meta::new(renderer, self.plan.technique.name(), self.model, &self.camera) }
    }

    /// How the rasterizers trim, as their G-buffers say it: masks made for that error are at least as coarse as these.
    fn trims(&self) -> Trims {
        let (Some(masks), Trimming::Texture(options)) = (&self.scene.masks(), &self.plan.trim) else {
            return Trims::Exact;
        };
        let asked = match options.quality {
            MaskQuality::Error { px } if masks.plan.coarser > 1.0 => px * masks.plan.coarser * COARSER_ROUNDING,
            MaskQuality::Error { px } => px,
            MaskQuality::Fixed { .. } => 0.0,
        };
        let found = masks.plan.error_px();
        // Beyond what was asked all of it may be along u, or along v, each of which is granted a half.
        let error_px = if found <= asked * COARSER_ROUNDING { asked } else { 2.0 * found };
        Trims::Masks { error_px }
    }

    /// The CPU's G-buffer.
    pub fn raster(&self) -> GBuffer {
        let bar = progress("raster", self.viewport.pixels());
        self.rasterizer(self.options()).render(self.meta("raster"), &|pixels| bar.inc(pixels as u64))
    }

    /// What both rasterizers compute: of interpolated normals there is no curvature.
    fn options(&self) -> raster::Options {
        raster::Options { curvature: !self.plan.vertex_normals, vertex_normals: self.plan.vertex_normals }
    }

    /// The ray caster's G-buffer.
    pub fn raycast(&self, caster: &Caster) -> GBuffer {
        let bar = progress("raycast", self.viewport.height());
        caster.render(&self.camera, self.viewport, &|rows| bar.inc(rows as u64))
    }

    /// The GPU's G-buffer and, for a shading, its own picture.
    ///
    /// # Errors
    /// Where the adapter refuses.
    pub fn gpu(&self, device: &gpu::Device, shading: Option<&Shading>, overrides: gpu::Overrides) -> Result<OnGpu> {
        self.drawn_by(&mut self.renderer(device, overrides)?, shading)
    }

    /// The GPU's renderer of this stage, and of the stages of its samples.
    ///
    /// # Errors
    /// Where the adapter refuses.
    pub fn renderer<'a>(
        &self,
        device: &'a gpu::Device,
        overrides: gpu::Overrides<'_>,
    ) -> Result<gpu::Renderer<'a>, gpu::GpuError> {
        let raster::Options { curvature, vertex_normals } = self.options();
        self.renderer_of(device, gpu::RendererOptions { curvature, vertex_normals, overrides })
    }

    /// One that computes what is asked for, by the path of the plan.
    ///
    /// # Errors
    /// Where the adapter refuses.
    pub fn renderer_of<'a>(
        &self,
        device: &'a gpu::Device,
        options: gpu::RendererOptions<'_>,
    ) -> Result<gpu::Renderer<'a>, gpu::GpuError> {
        self.plan.path.renderer(device, &self.scene, &self.prepared, options)
    }

    /// Whether the GPU's own rasterizer draws corners: its grid moves them.
    pub fn snaps_corners(&self) -> bool {
        self.plan.path == Path::Fragment && self.plan.technique.claims() == Claims::Chord
    }

    /// What [`Self::gpu`] returns, by a renderer of this stage or of the one whose sample it is.
    ///
    /// # Errors
    /// Where the adapter refuses.
    pub fn drawn_by(&self, renderer: &mut gpu::Renderer<'_>, shading: Option<&Shading>) -> Result<OnGpu> {
        let gbuffer = renderer.gbuffer(&self.views, &self.camera, self.viewport, self.meta("gpu"))?;
        let size = self.model.hull().diagonal();
        let shaded = shading
            .map(|shading| renderer.shaded(&self.views, &shading.uniform(&self.camera, size), self.viewport))
            .transpose()?;
        let grid = if self.snaps_corners() { renderer.measured_grid()? } else { None };
        Ok(OnGpu { gbuffer, shaded, moves_px: grid.map(gpu::Grid::moves_px) })
    }

    /// Renders by all three.
    ///
    /// A missing adapter is noted; any other failure of the GPU too, for the other two are still worth comparing.
    pub fn render(&self, caster: &Caster, adapter: Option<&str>, shading: Option<&Shading>) -> Rendered {
        let raster = self.raster();
        let gpu = gpu::Device::open(adapter)
            .map_err(anyhow::Error::from)
            .and_then(|device| self.gpu(&device, shading, gpu::Overrides::default()))
            .map_err(|error| format!("{error:#}"));
        Rendered { raycast: self.raycast(caster), raster, gpu }
    }
}

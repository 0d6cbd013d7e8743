//! A model, seen: everything the three renderers need, made once, and the comparison of what they return.

use crate::terminal;
use anyhow::{Result, bail};
use compare::{Deviation, Judge, PairReport, Sampler, ToleranceModel, Verdict};
use gbuffer::{GBuffer, Hit, Meta, Picture, ShadeInput, Shading, shade_tolerant};
use pipeline::{DEFAULT_CHORD_PX, PackedScene, Proxy, Scheme, Technique, View};
use raster::{Drawing, PointSampler, Rasterizer};
use raycast::Caster;
use scene::{Camera, FaceId, Model, Viewport};
use serde::Serialize;

/// A colour shaded on the GPU may differ from that of its own G-buffer by this much in a channel: one step of
/// rounding to 8 bits on either side.
const COLOUR_STEPS: u8 = 2;

/// How far the argument of a band may move between the two, beyond the normal's own tolerance, in units of 2⁻²⁴: the
/// view direction of the fragment stage comes from an interpolated position.
const VIEW_ULPS: f32 = 128.0;

/// How a model is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Where the surface is evaluated.
    pub technique: Technique,
    /// Which programs evaluate it.
    pub scheme: Scheme,
    /// Chord error of a tessellation, pixels.
    pub chord_px: f64,
}

impl Default for Plan {
    fn default() -> Self {
        Self { technique: Technique::default(), scheme: Scheme::default(), chord_px: DEFAULT_CHORD_PX }
    }
}

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
    /// The faces in f32.
    pub scene: PackedScene,
    /// Their triangles.
    pub proxy: Proxy,
    /// How the camera sees each face.
    pub views: Vec<View>,
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
}

/// The picture that the GPU shaded against the shading of its own G-buffer.
#[derive(Debug, Clone, Serialize)]
pub struct ShadedReport {
    /// Covered pixels compared.
    pub covered: usize,
    /// Pixels whose colour is none that the G-buffer allows.
    pub differ: usize,
    /// The first of them, (x, y).
    pub first: Option<[usize; 2]>,
    /// The answer.
    pub verdict: Verdict,
}

/// The ray caster, asked at any position.
pub struct Rays<'a> {
    /// It.
    pub caster: &'a Caster<'a>,
    /// Who looks.
    pub camera: Camera,
    /// At how many pixels.
    pub viewport: Viewport,
}

impl Sampler for Rays<'_> {
    fn first(&self, x: f64, y: f64) -> Option<Hit> {
        self.caster.first(&self.camera.ray(self.viewport, x, y)).hit
    }
}

/// The CPU rasterizer, asked at any position.
struct Triangles<'a>(PointSampler<'a>);

impl Sampler for Triangles<'_> {
    fn first(&self, x: f64, y: f64) -> Option<Hit> {
        self.0.sample(x, y)
    }

    fn layers(&self, x: f64, y: f64) -> Vec<Hit> {
        self.0.layers(x, y)
    }
}

impl<'m> Stage<'m> {
    /// Packs and tessellates `model` for `camera`.
    ///
    /// # Errors
    /// Where the model cannot be packed or the chord error asks for too many triangles.
    pub fn new(model: &'m Model, camera: Camera, viewport: Viewport, plan: Plan) -> Result<Self> {
        let scene = PackedScene::new(model, plan.scheme)?;
        let proxy = match plan.technique {
            Technique::Fragment => Proxy::tessellated(model, &scene, &camera, viewport, plan.chord_px)?,
            Technique::Exact => Proxy::hulls(model, &scene, &camera, viewport)?,
        };
        let views = scene.views(model, &camera, viewport);
        Ok(Self { model, camera, viewport, plan, scene, proxy, views })
    }

    /// The rasterizer of this stage.
    pub fn rasterizer(&self, options: raster::Options) -> Rasterizer<'_> {
        let Self { scene, proxy, views, camera, viewport, .. } = self;
        Rasterizer::new(Drawing { scene, proxy, views, camera, viewport: *viewport, options })
    }

    /// The facts that go with a buffer of this stage.
    pub fn meta(&self, renderer: &str) -> Meta {
        Meta::new(renderer, self.plan.technique.name(), self.model, &self.camera)
    }

    /// The CPU's G-buffer.
    pub fn raster(&self) -> GBuffer {
        let bar = terminal::progress("raster", self.viewport.pixels());
        let options = raster::Options { curvature: true, interpolated_normals: false };
        self.rasterizer(options).render(self.meta("raster"), &|pixels| bar.inc(pixels as u64))
    }

    /// The ray caster's G-buffer.
    pub fn raycast(&self, caster: &Caster) -> GBuffer {
        let bar = terminal::progress("raycast", self.viewport.height());
        caster.render(&self.camera, self.viewport, &|rows| bar.inc(rows as u64))
    }

    /// The GPU's G-buffer and, for a shading, its own picture.
    ///
    /// # Errors
    /// Where the adapter refuses.
    pub fn gpu(&self, device: &gpu::Device, shading: Option<&Shading>, overrides: gpu::Overrides) -> Result<OnGpu> {
        let options = gpu::RendererOptions { curvature: true, interpolated_normals: false, overrides };
        let mut renderer = gpu::Renderer::new(device, &self.scene, &self.proxy, options)?;
        let gbuffer = renderer.gbuffer(&self.views, &self.camera, self.viewport, self.meta("gpu"))?;
        let size = self.model.hull().diagonal();
        let shaded = shading
            .map(|shading| renderer.shaded(&self.views, &shading.uniform(&self.camera, size), self.viewport))
            .transpose()?;
        Ok(OnGpu { gbuffer, shaded })
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

    /// Compares all pairs.
    ///
    /// # Errors
    /// Where two buffers cannot be compared, or show nothing.
    pub fn compare(&self, caster: &Caster, rendered: &Rendered) -> Result<Vec<PairReport>> {
        let mut pairs = vec![self.against_raycast(caster, &rendered.raycast, &rendered.raster)?];
        if let Ok(gpu) = &rendered.gpu {
            pairs.push(self.against_raycast(caster, &rendered.raycast, &gpu.gbuffer)?);
            pairs.push(self.against_raster(&rendered.raster, &gpu.gbuffer)?);
        }
        Ok(pairs)
    }

    /// A rasterized buffer against the ray caster.
    ///
    /// # Errors
    /// Where the buffers cannot be compared.
    pub fn against_raycast(&self, caster: &Caster, reference: &GBuffer, candidate: &GBuffer) -> Result<PairReport> {
        let sampler = Rays { caster, camera: self.camera, viewport: self.viewport };
        let deviation = match self.plan.technique {
            Technique::Fragment => Deviation::of_proxy(self.model, &self.proxy.chord),
            Technique::Exact => Deviation::exact(self.model),
        };
        self.pair(reference, &sampler, candidate, &deviation, true)
    }

    /// The GPU's buffer against the CPU rasterizer's.
    ///
    /// # Errors
    /// Where the buffers cannot be compared.
    pub fn against_raster(&self, reference: &GBuffer, candidate: &GBuffer) -> Result<PairReport> {
        let rasterizer = self.rasterizer(raster::Options { curvature: false, interpolated_normals: false });
        let sampler = Triangles(rasterizer.sampler());
        let deviation = match self.plan.technique {
            Technique::Fragment => Deviation::of_same_proxy(self.model, &self.proxy.chord),
            Technique::Exact => Deviation::exact(self.model).either(&Deviation::exact(self.model)),
        };
        self.pair(reference, &sampler, candidate, &deviation, false)
    }

    fn pair(
        &self,
        reference: &GBuffer,
        sampler: &dyn Sampler,
        candidate: &GBuffer,
        deviation: &Deviation,
        exact: bool,
    ) -> Result<PairReport> {
        let judge = Judge::new(self.model, &self.camera, self.viewport);
        let what = format!("{} | {}", reference.meta().renderer, candidate.meta().renderer);
        let bar = terminal::progress(&what, self.viewport.height());
        Ok(judge.pair(reference, sampler, candidate, deviation, exact, &|rows| bar.inc(rows as u64))?)
    }

    /// Judges the picture that the GPU shaded in its fragment stage by the G-buffer that it returned beside it.
    ///
    /// Each colour must be one that the shared shading code gives for that hit; where a band's argument is within
    /// rounding of the band's edge (the tolerance of the normal there, and of the interpolated view), either side will do.
    ///
    /// # Errors
    /// Where the picture is of another size.
    pub fn judge_shading(&self, shading: &Shading, gpu: &GBuffer, picture: &Picture) -> Result<ShadedReport> {
        let (width, height) = (self.viewport.width(), self.viewport.height());
        if (picture.width(), picture.height()) != (width, height) {
            bail!("the shaded picture measures {}x{}, not {width}x{height}", picture.width(), picture.height());
        }
        let uniform = shading.uniform(&self.camera, self.model.hull().diagonal());
        let tolerances: Vec<ToleranceModel> = self.model.surfaces().iter().map(ToleranceModel::new).collect();
        let mut report = ShadedReport { covered: 0, differ: 0, first: None, verdict: Verdict::Differ };
        for y in 0..height {
            for x in 0..width {
                let allowed = match gpu.get(x, y) {
                    None => vec![gbuffer::background()],
                    Some(hit) => {
                        report.covered += 1;
                        let ray = self.camera.ray(self.viewport, x as f64 + 0.5, y as f64 + 0.5);
                        let input = ShadeInput::new(hit, self.model, &ray).expect("the GPU's faces were checked");
                        let tolerance = self.normal_tolerance(&tolerances, hit) + VIEW_ULPS / (1 << 24) as f32;
                        shade_tolerant(&uniform, &input, tolerance)
                    }
                };
                let shown = picture.pixel(x, y);
                let near = |colour: &[u8; 3]| (0..3).all(|c| colour[c].abs_diff(shown[c]) <= COLOUR_STEPS);
                if !allowed.iter().any(near) {
                    report.differ += 1;
                    report.first = report.first.or(Some([x, y]));
                }
            }
        }
        if report.differ == 0 && report.covered > 0 {
            report.verdict = Verdict::Agree;
        }
        Ok(report)
    }

    /// What f32 allows of the normal at a hit, or everything where there is no bound.
    fn normal_tolerance(&self, models: &[ToleranceModel], hit: &Hit) -> f32 {
        let FaceId(face) = hit.face;
        let surface = self.model.surface(hit.face);
        let point = surface.inspect(hit.uv.x, hit.uv.y);
        let span = [nurbs::Direction::U, nurbs::Direction::V].map(|d| surface.knots(d));
        let span = [span[0].find_span(hit.uv.x), span[1].find_span(hit.uv.y)];
        let model = &models[self.model.faces()[face as usize].surface];
        model.at(span, hit.uv.x, hit.uv.y, &point.derivatives, None).normal.unwrap_or(2.0) as f32
    }
}

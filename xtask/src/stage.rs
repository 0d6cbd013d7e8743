//! A model, seen: everything the three renderers need, made once, and the comparison of what they return.

use crate::terminal;
use anyhow::{Result, bail};
use compare::{
    Deviation, Interpolation, Judge, PairReport, PixelVerdict, Sampler, StandIn, UNBOUNDED_SHARE, Verdict,
    VertexNormals,
};
use gbuffer::{GBuffer, Hit, Meta, Picture, ShadeInput, Shading, Trims, shade_tolerant};
use pipeline::enclosure::{Enclosure, Enclosures, Interval, enclose};
use pipeline::mask::{MaskPlan, MaskQuality, Masks, Trimming};
use pipeline::{PackedScene, Scheme, View};
use raster::{Drawing, PointSampler, Rasterizer};
use raycast::Caster;
use scene::{Camera, Model, SamplePattern, Viewport};
use serde::Serialize;
use std::sync::Arc;
use techniques::{DEFAULT_CHORD_PX, Limits, Prepared, Setting, Technique};

/// A colour shaded on the GPU may differ from that of its own G-buffer by this much in a channel: one step of
/// rounding to 8 bits on either side.
const COLOUR_STEPS: u8 = 2;

/// How far the argument of a band may move between the two, beyond what the normals may differ by, in units of 2⁻²⁴: the
/// view direction of the fragment stage comes from an interpolated position.
const VIEW_ULPS: f32 = 128.0;

/// A mask that is coarser by a factor has no fewer texels than one asked for with an error larger by it and by this.
const COARSER_ROUNDING: f64 = 1.0 + 1e-9;

/// How a model is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Where the surface is evaluated.
    pub technique: &'static dyn Technique,
    /// Which programs evaluate it.
    pub scheme: Scheme,
    /// Chord error of a tessellation, pixels.
    pub chord_px: f64,
    /// How faces are trimmed.
    pub trim: Trimming,
    /// Whether each pixel records where a trim edge of its face passes.
    pub edges: bool,
    /// Whether pixels show the points of flat triangles, and normals interpolated over them, in place of the surface's own.
    pub vertex_normals: bool,
    /// What grids may come to beside the chord error.
    pub limits: Limits,
    /// The share of covered pixels that may have no verdict for want of a bound: what the scene states.
    pub unbounded_share: f64,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            technique: techniques::ALL[0],
            scheme: Scheme::default(),
            chord_px: DEFAULT_CHORD_PX,
            trim: Trimming::default(),
            edges: false,
            vertex_normals: false,
            limits: Limits::default(),
            unbounded_share: UNBOUNDED_SHARE,
        }
    }
}

impl Plan {
    /// A model as the rasterizers read it.
    ///
    /// # Errors
    /// Where it cannot be packed, masks do not fit, or trim edges are asked for of masks, which have none.
    pub fn packed(&self, model: &Model, camera: &Camera, viewport: Viewport) -> Result<PackedScene> {
        Ok(match (&self.trim, self.edges) {
            (Trimming::Exact, false) => PackedScene::new(model, self.scheme)?,
            (Trimming::Exact, true) => PackedScene::with_edges(model, self.scheme)?,
            (Trimming::Texture(_), true) => {
                bail!(
                    "--antialias trims measures distances to trim curves, and --trim texture has masks instead of them"
                )
            }
            (Trimming::Texture(options), false) => {
                let masks = Masks::new(MaskPlan::new(model, camera, viewport, options)?, options.fill);
                PackedScene::masked(model, self.scheme, masks)?
            }
        })
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
    /// The faces in f32; shared by the stages of a picture's samples.
    pub scene: Arc<PackedScene>,
    /// What the technique draws of them; shared alike.
    pub prepared: Arc<dyn Prepared>,
    /// How the camera sees each face.
    pub views: Vec<View>,
    /// How accurately its parameters are interpolated over them.
    pub interpolation: Interpolation,
    /// What the model stands for, where it is drawn in the place of another.
    pub original: Option<Original<'m>>,
}

/// A model in whose place a stage draws another, by which it is judged.
#[derive(Clone)]
pub struct Original<'m> {
    /// It.
    model: &'m Model,
    /// It, as rasterizers would read it.
    scene: Arc<PackedScene>,
    /// How the other lies on it.
    stand_in: &'m StandIn,
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
    /// Which of its samples, from 0, where a pixel has several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample: Option<usize>,
    /// The answer.
    pub verdict: Verdict,
}

impl ShadedReport {
    /// What reports on the samples of a picture, in their order, come to: it agrees where each does. `None` of none.
    pub fn of_samples(reports: impl IntoIterator<Item = Self>) -> Option<Self> {
        let named = |(k, report): (usize, Self)| Self { sample: report.first.map(|_| k), ..report };
        let reports: Vec<Self> = reports.into_iter().collect();
        if reports.len() == 1 {
            return reports.into_iter().next();
        }
        reports.into_iter().enumerate().map(named).reduce(|a, b| {
            let (first, sample) = if a.first.is_some() { (a.first, a.sample) } else { (b.first, b.sample) };
            let verdict = match (a.covered, b.covered) {
                (0, _) => b.verdict,
                (_, 0) => a.verdict,
                _ => a.verdict.max(b.verdict),
            };
            Self { covered: a.covered + b.covered, differ: a.differ + b.differ, first, sample, verdict }
        })
    }
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
        let scene = Arc::new(plan.packed(model, &camera, viewport)?);
        let Plan { chord_px, limits, .. } = plan;
        let setting = Setting { model, scene: &scene, camera: &camera, viewport, chord_px, limits };
        let prepared = plan.technique.prepare(&setting)?;
        if plan.vertex_normals && prepared.cells().is_empty() {
            bail!(
                "technique {} draws no triangles with corners on the surface, so it has no vertex normals",
                plan.technique.name()
            )
        }
        if let Some(kept) = prepared.built_px().filter(|kept| *kept > plan.chord_px) {
            let (asked, triangles) = (plan.chord_px, prepared.triangles());
            terminal::note(format_args!(
                "note: a chord error of {asked} px takes more than it may from here; {triangles} triangles keep to {kept} px"
            ));
        }
        let views = scene.views(model, &camera, viewport);
        let interpolation = Interpolation::of(model);
        Ok(Self { model, camera, viewport, plan, scene, prepared, views, interpolation, original: None })
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
        let bar = terminal::progress("raster", self.viewport.pixels());
        self.rasterizer(self.options()).render(self.meta("raster"), &|pixels| bar.inc(pixels as u64))
    }

    /// What both rasterizers compute: of interpolated normals there is no curvature.
    fn options(&self) -> raster::Options {
        raster::Options { curvature: !self.plan.vertex_normals, vertex_normals: self.plan.vertex_normals }
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
        self.drawn_by(&mut self.renderer(device, overrides)?, shading)
    }

    /// The GPU's renderer of this stage, and of the stages of its samples.
    ///
    /// # Errors
    /// Where the adapter refuses.
    pub fn renderer<'a>(
        &'a self,
        device: &'a gpu::Device,
        overrides: gpu::Overrides<'_>,
    ) -> Result<gpu::Renderer<'a>, gpu::GpuError> {
        let raster::Options { curvature, vertex_normals } = self.options();
        let options = gpu::RendererOptions { curvature, vertex_normals, overrides };
        gpu::Renderer::new(device, &self.scene, &*self.prepared, options)
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
    /// Where two buffers cannot be compared.
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
        self.pair(reference, &self.rays(caster), candidate, true)
    }

    /// The GPU's buffer against the CPU rasterizer's.
    ///
    /// # Errors
    /// Where the buffers cannot be compared.
    pub fn against_raster(&self, reference: &GBuffer, candidate: &GBuffer) -> Result<PairReport> {
        let rasterizer = self.rasterizer(raster::Options { curvature: false, vertex_normals: false });
        self.pair(reference, &Triangles(rasterizer.sampler()), candidate, false)
    }

    /// What each comparison says of pixel `at`, with the names of reference and candidate.
    ///
    /// # Errors
    /// Where two buffers cannot be compared.
    pub fn pixel(
        &self,
        caster: &Caster,
        rendered: &Rendered,
        at: [usize; 2],
    ) -> Result<Vec<(String, String, PixelVerdict)>> {
        let rays = self.rays(caster);
        let rasterizer = self.rasterizer(raster::Options { curvature: false, vertex_normals: false });
        let triangles = Triangles(rasterizer.sampler());
        let Rendered { raycast, raster, gpu } = rendered;
        let mut pairs: Vec<(&GBuffer, &dyn Sampler, &GBuffer, bool)> = vec![(raycast, &rays, raster, true)];
        if let Ok(gpu) = gpu {
            pairs.push((raycast, &rays, &gpu.gbuffer, true));
            pairs.push((raster, &triangles, &gpu.gbuffer, false));
        }
        let verdict = |(reference, sampler, candidate, exact): (&GBuffer, &dyn Sampler, &GBuffer, bool)| {
            let verdict = self.judge(exact).pixel(reference, sampler, candidate, &self.deviation(exact), exact, at)?;
            Ok((reference.meta().renderer.clone(), candidate.meta().renderer.clone(), verdict))
        };
        pairs.into_iter().map(verdict).collect()
    }

    /// What the fragment program may return at a hit's own place.
    pub fn enclosures(&self, hit: &Hit, curvature: bool) -> Enclosures {
        enclose(&self.scene, hit.face.0, &self.scene.frames()[hit.face.0 as usize].known(hit), curvature)
    }

    fn rays<'a>(&self, caster: &'a Caster<'a>) -> Rays<'a> {
        Rays { caster, camera: self.camera, viewport: self.viewport }
    }

    /// Of pictures against the surface itself, or of two renderers of the same triangles.
    fn judge(&self, exact: bool) -> Judge<'_> {
        let judge = match self.original.as_ref().filter(|_| exact) {
            None => Judge::new(self.model, &self.camera, self.viewport, &self.scene),
            Some(Original { model, scene, .. }) => {
                Judge::new(model, &self.camera, self.viewport, scene).of_drawn(self.model, &self.scene)
            }
        };
        judge.with_unbounded_share(self.plan.unbounded_share)
    }

    /// The allowance against the surface itself, or between two renderers of the same triangles.
    fn deviation(&self, exact: bool) -> Deviation {
        let (claims, chord, asked_px) = (self.plan.technique.claims(), self.prepared.chord(), self.plan.chord_px);
        let deviation = if exact {
            Deviation::against_surface(claims, &self.interpolation, chord, asked_px)
        } else {
            Deviation::between_twins(claims, &self.interpolation, chord, asked_px)
        };
        let deviation = if self.plan.vertex_normals {
            deviation.with_vertex_normals(VertexNormals::new(self.model, self.prepared.cells()))
        } else {
            deviation
        };
        let deviation = match self.original.as_ref().filter(|_| exact) {
            None => deviation,
            Some(original) => deviation.of_stand_in(original.stand_in),
        };
        match &self.scene.masks() {
            None => deviation,
            Some(masks) => {
                let text = format!("{}; trim edges: masks within {:.3} px", deviation.text, masks.plan.error_px());
                Deviation { text, ..deviation }
            }
        }
    }

    fn pair(&self, reference: &GBuffer, sampler: &dyn Sampler, candidate: &GBuffer, exact: bool) -> Result<PairReport> {
        let what = format!("{} | {}", reference.meta().renderer, candidate.meta().renderer);
        let bar = terminal::progress(&what, self.viewport.height());
        let deviation = self.deviation(exact);
        Ok(self.judge(exact).pair(reference, sampler, candidate, &deviation, exact, &|rows| bar.inc(rows as u64))?)
    }

    /// Judges the picture that the GPU shaded in its fragment stage by the G-buffer that it returned beside it.
    ///
    /// Each colour must be one that the shared shading code gives for that hit; where a band's argument is within
    /// rounding of the band's edge (the interval of the normal there, and the interpolated view), either side will do.
    ///
    /// # Errors
    /// Where the picture is of another size.
    pub fn judge_shading(&self, shading: &Shading, gpu: &GBuffer, picture: &Picture) -> Result<ShadedReport> {
        let (width, height) = (self.viewport.width(), self.viewport.height());
        if (picture.width(), picture.height()) != (width, height) {
            bail!("the shaded picture measures {}x{}, not {width}x{height}", picture.width(), picture.height());
        }
        let uniform = shading.uniform(&self.camera, self.model.hull().diagonal());
        let mut report = ShadedReport { covered: 0, differ: 0, first: None, sample: None, verdict: Verdict::NoVerdict };
        for y in 0..height {
            for x in 0..width {
                let allowed = match gpu.get(x, y) {
                    None => vec![gbuffer::background()],
                    Some(hit) => {
                        report.covered += 1;
                        let ray = self.camera.ray(self.viewport, x as f64 + 0.5, y as f64 + 0.5);
                        let input = ShadeInput::new(hit, self.model, &ray).expect("the GPU's faces were checked");
                        let tolerance = self.normal_tolerance(hit) + VIEW_ULPS / (1 << 24) as f32;
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
        report.verdict = match (report.differ, report.covered) {
            (0, 0) => Verdict::NoVerdict,
            (0, _) => Verdict::Agree,
            _ => Verdict::Differ,
        };
        Ok(report)
    }

    /// How far two normals that the program may return at a hit lie apart at most, or everything where there is no bound.
    fn normal_tolerance(&self, hit: &Hit) -> f32 {
        let diagonal = |enclosure: &Enclosure| {
            let length = |n: [Interval; 3]| n.iter().map(|x| x.half_width * x.half_width).sum::<f64>().sqrt();
            enclosure.normal.map_or(2.0, |n| 2.0 * length(n))
        };
        self.enclosures(hit, false).iter().map(diagonal).fold(0.0, f64::max) as f32
    }
}

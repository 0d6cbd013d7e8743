//! One picture: its targets, how it is drawn, and what is made of the answer.

use crate::buffers::{ProxyBuffers, SceneBuffers};
use crate::device::plain;
use crate::draw::Draw;
use crate::exact::{Exact, Picture as Meetings};
use crate::masks::MaskBlend;
use crate::queries::{Queries, Stamps};
use crate::readback::{CLEARED, Record, Rows};
use crate::{Device, GpuError};
use gbuffer::{GBuffer, Hit, Meta, Picture, ShadeUniform, background};
use pipeline::fragment::Fragment;
use pipeline::wgsl::{self, Variant};
use pipeline::{PackedScene, Program, Proxy, Technique, View};
use scene::{Camera, Viewport};
use std::collections::VecDeque;
use std::collections::hash_map::{Entry, HashMap};
use std::time::Instant;
use wgpu::{ShaderStages, TextureFormat, TextureUsages};

/// Frames that may be under way at once while timing: enough that the device never waits for the processor.
const FRAMES_IN_FLIGHT: usize = 3;

const TIMING: &str = "timing frames";

const ALLOCATING: &str = "allocating the picture";

/// Frames timed with one query set, whose size WebGPU bounds at 4096.
const FRAMES_A_QUERY_SET: usize = 2048;

/// Formats of `GBufferOutput` in `shaders/output.wgsl`.
const GBUFFER_FORMATS: [TextureFormat; 4] =
    [TextureFormat::Rgba32Uint, TextureFormat::Rgba32Float, TextureFormat::Rgba32Float, TextureFormat::Rgba32Float];

/// Which of several surfaces at a pixel is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DepthOrder {
    /// The nearest; at equal depth the one drawn first.
    #[default]
    Nearest,
    /// The farthest: a fault, for tests of the comparer.
    Farthest,
}

/// Faults put into a renderer to see whether a comparison finds them. The default puts in none.
#[derive(Clone, Copy, Default)]
pub struct Overrides<'f> {
    /// Makes the WGSL of a variant in place of [`wgsl::source`].
    pub source: Option<&'f dyn Fn(Variant) -> String>,
    /// The depth test.
    pub depth: DepthOrder,
    /// How masks are drawn.
    pub mask: MaskBlend,
}

/// What a renderer's programs compute.
#[derive(Clone, Copy, Default)]
pub struct RendererOptions<'f> {
    /// Second derivatives and principal curvatures.
    pub curvature: bool,
    /// Whether [`Renderer::shaded`] uses normals interpolated from the proxy's vertices. A G-buffer never does.
    pub interpolated_normals: bool,
    /// Faults, for tests of the comparer.
    pub overrides: Overrides<'f>,
}

/// How long frames took.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// Number of frames.
    pub frames: usize,
    /// Seconds from the first frame's start to the last one's end, by the processor's clock.
    pub wall_s: f64,
    /// Seconds of each frame's passes by the device's clock, where it has one.
    pub gpu_s: Option<Vec<f64>>,
}

impl Timing {
    /// Frames a second by the processor's clock.
    pub fn frames_per_second(&self) -> f64 {
        self.frames as f64 / self.wall_s
    }
}

/// What a picture is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Output {
    GBuffer,
    Shaded,
}

impl Output {
    pub(crate) fn formats(self) -> &'static [TextureFormat] {
        match self {
            Output::GBuffer => &GBUFFER_FORMATS,
            Output::Shaded => &[TextureFormat::Rgba8Unorm],
        }
    }

    /// What the targets hold where nothing is drawn.
    fn cleared(self, target: usize) -> wgpu::Color {
        let all = |x: f64| wgpu::Color { r: x, g: x, b: x, a: x };
        match (self, target) {
            (Output::GBuffer, 0) => all(0.0),
            (Output::GBuffer, _) => all(f64::from(CLEARED)),
            (Output::Shaded, _) => {
                let [r, g, b] = background().map(|x| f64::from(x) / 255.0);
                wgpu::Color { r, g, b, a: 1.0 }
            }
        }
    }
}

/// The shaders of the programs that a scene has.
pub(crate) type Modules = HashMap<Program, wgpu::ShaderModule>;

/// A picture's textures.
pub(crate) struct Targets {
    pub(crate) output: Output,
    pub(crate) viewport: Viewport,
    colours: Vec<wgpu::Texture>,
    pub(crate) colour_views: Vec<wgpu::TextureView>,
}

impl Targets {
    fn new(device: &Device, viewport: Viewport, output: Output, usage: TextureUsages) -> Result<Self, GpuError> {
        let side = viewport.width().max(viewport.height()) as u64;
        let limit = u64::from(device.limits.max_texture_dimension_2d);
        device.fits("the viewport", "max_texture_dimension_2d", side, limit)?;
        device.guarded(ALLOCATING, || {
            let usage = usage | TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
            let texture = |&format| device.texture("target", viewport, format, usage);
            let colours: Vec<_> = output.formats().iter().map(texture).collect();
            let colour_views = colours.iter().map(|texture| texture.create_view(&Default::default())).collect();
            Self { output, viewport, colours, colour_views }
        })
    }

    /// The targets as a render pass that clears them has them.
    pub(crate) fn cleared(&self) -> Vec<Option<wgpu::RenderPassColorAttachment<'_>>> {
        let attachment = |(target, view)| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(self.output.cleared(target)),
                    store: wgpu::StoreOp::Store,
                },
            })
        };
        self.colour_views.iter().enumerate().map(attachment).collect()
    }
}

/// How pictures are drawn.
enum Method {
    Fragment(Draw),
    Exact(Exact),
}

/// What a picture needs besides its targets.
enum Store {
    Depth(wgpu::TextureView),
    Meetings(Meetings),
}

/// A scene on a device, ready to be drawn from any camera.
pub struct Renderer<'a> {
    device: &'a Device,
    scene: &'a PackedScene,
    curvature: bool,
    buffers: SceneBuffers,
    modules: Modules,
    method: Method,
}

impl<'a> Renderer<'a> {
    /// Uploads a scene and its proxy, and reads the shaders of its programs.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where the scene does not fit the adapter, [`GpuError::Shader`] where a source is illegal;
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn new(
        device: &'a Device,
        scene: &'a PackedScene,
        proxy: &Proxy,
        options: RendererOptions<'_>,
    ) -> Result<Self, GpuError> {
        let RendererOptions { curvature, interpolated_normals, overrides } = options;
        let technique = proxy.technique();
        let visibility = match technique {
            Technique::Fragment => ShaderStages::VERTEX_FRAGMENT,
            Technique::Exact => ShaderStages::COMPUTE,
        };
        let buffers = SceneBuffers::new(device, scene, visibility, overrides.mask)?;
        let method = match technique {
            Technique::Fragment => Method::Fragment(Draw::new(device, &buffers, proxy, overrides.depth)?),
            Technique::Exact => Method::Exact(Exact::new(device, &buffers, proxy, overrides.depth)?),
        };
        let mut modules = HashMap::new();
        for &program in scene.programs() {
            if let Entry::Vacant(vacant) = modules.entry(program) {
                let variant = Variant {
                    technique,
                    program,
                    curvature,
                    interpolated_normal: interpolated_normals,
                    trims: scene.trim_method(),
                };
                let source = overrides.source.map_or_else(|| wgsl::source(variant), |source| source(variant));
                vacant.insert(device.module(program, source)?);
            }
        }
        Ok(Self { device, scene, curvature, buffers, modules, method })
    }

    /// Draws the scene with other triangles from now on; they must be of the same scene.
    ///
    /// # Errors
    /// As [`Self::new`]; [`GpuError::Technique`] where the proxy is of another technique.
    pub fn set_proxy(&mut self, proxy: &Proxy) -> Result<(), GpuError> {
        match (&mut self.method, proxy.technique()) {
            (Method::Fragment(draw), Technique::Fragment) => draw.proxy = ProxyBuffers::new(self.device, proxy)?,
            (Method::Exact(exact), Technique::Exact) => exact.set_proxy(self.device, proxy)?,
            (Method::Fragment(_), found) => return Err(other_technique(Technique::Fragment, found)),
            (Method::Exact(_), found) => return Err(other_technique(Technique::Exact, found)),
        }
        Ok(())
    }

    /// Takes over an edit: a scene and a proxy whose numbers differ from those `before`, which this renderer has. Only
    /// what differs is uploaded; returns how many bytes that is.
    ///
    /// Trim curves are numbers of their own, so that moving a control point leaves them and every mask alone. Where the
    /// edit changes how many pieces technique `exact` has, these are all uploaded.
    ///
    /// # Errors
    /// [`GpuError::OtherShape`] where the scenes have other layouts, or the tessellations other corners; as [`Self::new`].
    pub fn edit(&mut self, before: (&PackedScene, &Proxy), after: (&'a PackedScene, &Proxy)) -> Result<u64, GpuError> {
        let written = self.buffers.write_changes(self.device, before.0, after.0)?;
        let proxy = match &mut self.method {
            Method::Fragment(draw) => draw.proxy.write_changes(self.device, before.1, after.1)?,
            Method::Exact(exact) => exact.write_changes(self.device, before.1, after.1)?,
        };
        self.scene = after.0;
        Ok(written + proxy)
    }

    /// What each pixel sees, as `camera` has it; `views` are those of the same camera and viewport.
    ///
    /// The adapter and its driver are entered in `meta`. Pixels in which a search of technique `exact` has not converged
    /// are entered as undecided. Hits have no curvature unless the renderer computes it.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where the viewport does not fit the adapter, [`GpuError::Malformed`] where a pixel shows a
    /// face that is none, [`GpuError::NotCleared`]; [`GpuError::Shader`], [`GpuError::ViewCount`],
    /// [`GpuError::OutOfMemory`], [`GpuError::Timeout`], [`GpuError::Lost`].
    pub fn gbuffer(
        &mut self,
        views: &[View],
        camera: &Camera,
        viewport: Viewport,
        meta: Meta,
    ) -> Result<GBuffer, GpuError> {
        let info = self.device.info();
        let driver = format!("{} {}", info.driver, info.driver_info);
        let meta = Meta { adapter: Some(info.name.clone()), driver: Some(driver.trim().to_owned()), ..meta };
        let (targets, store) = self.draw(views, viewport, Output::GBuffer)?;
        let mut rows = Rows::new(self.device, targets.colours.iter().collect(), viewport)?;
        let mut failure = None;
        let hits = (0..viewport.height()).map(|y| {
            let nothing = || vec![None; viewport.width()];
            if failure.is_some() {
                return nothing();
            }
            self.row(&mut rows, viewport, y, |x, fragment| self.hit(&fragment, camera, viewport, x, y)).unwrap_or_else(
                |error| {
                    failure = Some(error);
                    nothing()
                },
            )
        });
        let buffer = GBuffer::from_rows(viewport, meta, hits).with_edges(self.scene.has_edges());
        match (failure, store) {
            (Some(error), _) => Err(error),
            (None, Store::Depth(_)) => Ok(buffer),
            (None, Store::Meetings(meetings)) => Ok(buffer.with_undecided(meetings.unconverged(self.device)?)),
        }
    }

    /// The raw answers of the fragment program, row-major from the top: what [`Self::gbuffer`] makes its hits of.
    ///
    /// # Errors
    /// As [`Self::gbuffer`].
    pub fn fragments(&mut self, views: &[View], viewport: Viewport) -> Result<Vec<Option<Fragment>>, GpuError> {
        let (targets, _) = self.draw(views, viewport, Output::GBuffer)?;
        let mut rows = Rows::new(self.device, targets.colours.iter().collect(), viewport)?;
        let mut fragments = Vec::with_capacity(viewport.pixels());
        for y in 0..viewport.height() {
            fragments.extend(self.row(&mut rows, viewport, y, |_, fragment| fragment)?);
        }
        Ok(fragments)
    }

    /// How often technique `exact` evaluates the surface for each pixel, row-major from the top, to draw the picture: what
    /// the search costs, and a witness of the path that it takes to what it finds.
    ///
    /// # Errors
    /// [`GpuError::Technique`] where the renderer is of another technique; else as [`Self::gbuffer`].
    pub fn evaluations(&mut self, views: &[View], viewport: Viewport) -> Result<Vec<u32>, GpuError> {
        match self.draw(views, viewport, Output::GBuffer)? {
            (_, Store::Meetings(meetings)) => meetings.evaluations(self.device),
            (_, Store::Depth(_)) => Err(other_technique(Technique::Fragment, Technique::Exact)),
        }
    }

    fn hit(&self, fragment: &Fragment, camera: &Camera, viewport: Viewport, x: usize, y: usize) -> Hit {
        let ray = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5);
        let hit = self.scene.hit(fragment, &ray);
        Hit { curvature: hit.curvature.filter(|_| self.curvature), ..hit }
    }

    /// Row `y` of the four targets, each drawn pixel taken through `make`.
    fn row<T>(
        &self,
        rows: &mut Rows<'_>,
        viewport: Viewport,
        y: usize,
        make: impl Fn(usize, Fragment) -> T,
    ) -> Result<Vec<Option<T>>, GpuError> {
        let row = rows.row(y)?;
        let word = |target: usize, x: usize| std::array::from_fn(|i| row[target][4 * x + i]);
        let float = |target: usize, x: usize| word(target, x).map(f32::from_bits);
        (0..viewport.width())
            .map(|x| {
                let record =
                    Record { identity: word(0, x), position: float(1, x), normal: float(2, x), shape: float(3, x) };
                Ok(record
                    .pixel(x, y, self.scene.faces().len(), self.scene.has_edges())?
                    .map(|fragment| make(x, fragment)))
            })
            .collect()
    }

    /// The picture that the device itself shades, on [`background`].
    ///
    /// Curvature shading needs a renderer that computes curvature; without it every point's is unknown.
    ///
    /// # Errors
    /// As [`Self::gbuffer`].
    pub fn shaded(&mut self, views: &[View], shading: &ShadeUniform, viewport: Viewport) -> Result<Picture, GpuError> {
        self.buffers.write_shading(self.device, shading)?;
        let (targets, _) = self.draw(views, viewport, Output::Shaded)?;
        let mut rows = Rows::new(self.device, targets.colours.iter().collect(), viewport)?;
        let mut pixels = Vec::with_capacity(viewport.pixels());
        for y in 0..viewport.height() {
            let row = rows.row(y)?[0];
            let rgba: &[[u8; 4]] = bytemuck::cast_slice(&row[..viewport.width()]);
            pixels.extend(rgba.iter().map(|&[r, g, b, _]| [r, g, b]));
        }
        Ok(Picture::new(viewport.width(), viewport.height(), pixels).expect("one colour a pixel"))
    }

    /// Draws shaded frames one after the other, reads none back, and says how long they took.
    ///
    /// The first frame is drawn once more before the clock starts, so that nothing is compiled or allocated later.
    /// Up to three frames are under way at once; writing the views is part of a frame.
    ///
    /// # Errors
    /// As [`Self::gbuffer`].
    pub fn time_shaded(
        &mut self,
        frames: &[Vec<View>],
        shading: &ShadeUniform,
        viewport: Viewport,
    ) -> Result<Timing, GpuError> {
        let Some(first) = frames.first() else {
            let gpu_s = self.device.has_timestamps().then(Vec::new);
            return Ok(Timing { frames: 0, wall_s: 0.0, gpu_s });
        };
        self.buffers.write_shading(self.device, shading)?;
        loop {
            let (targets, store) = self.draw(first, viewport, Output::Shaded)?;
            self.device.wait(TIMING, None)?;
            let timing = self.time(frames, &targets, &store)?;
            // A later frame may have had more to keep than the first.
            if self.is_complete(&store)? {
                return Ok(timing);
            }
        }
    }

    fn time(&self, frames: &[Vec<View>], targets: &Targets, store: &Store) -> Result<Timing, GpuError> {
        let mut timing =
            Timing { frames: frames.len(), wall_s: 0.0, gpu_s: self.device.has_timestamps().then(Vec::new) };
        for chunk in frames.chunks(FRAMES_A_QUERY_SET) {
            let queries = match timing.gpu_s {
                Some(_) => Some(Queries::new(self.device, chunk.len())?),
                None => None,
            };
            let start = Instant::now();
            let mut under_way = VecDeque::new();
            for (index, views) in chunk.iter().enumerate() {
                if under_way.len() == FRAMES_IN_FLIGHT {
                    self.device.wait(TIMING, under_way.pop_front())?;
                }
                self.buffers.write_views(self.device, views)?;
                let encoder = self.encode(targets, store, queries.as_ref().map(|q| q.frame(index)))?;
                under_way.push_back(self.device.submit(TIMING, encoder)?);
            }
            self.device.wait(TIMING, None)?;
            timing.wall_s += start.elapsed().as_secs_f64();
            if let (Some(seconds), Some(queries)) = (&mut timing.gpu_s, queries) {
                seconds.extend(queries.read(self.device)?);
            }
        }
        Ok(timing)
    }

    /// Draws one picture, again where it had more to keep than there was room for.
    fn draw(&mut self, views: &[View], viewport: Viewport, output: Output) -> Result<(Targets, Store), GpuError> {
        self.buffers.write_views(self.device, views)?;
        let usage = match &mut self.method {
            Method::Fragment(draw) => {
                draw.prepare(self.device, &self.modules, output)?;
                TextureUsages::empty()
            }
            Method::Exact(exact) => {
                exact.prepare(self.device, &self.modules, output)?;
                TextureUsages::STORAGE_BINDING
            }
        };
        let targets = Targets::new(self.device, viewport, output, usage)?;
        loop {
            let store = match &self.method {
                Method::Fragment(draw) => Store::Depth(draw.depth_buffer(self.device, &targets)?),
                Method::Exact(exact) => Store::Meetings(exact.picture(self.device, &targets)?),
            };
            let encoder = self.encode(&targets, &store, None)?;
            self.device.submit("drawing", encoder)?;
            if self.is_complete(&store)? {
                return Ok((targets, store));
            }
        }
    }

    /// Whether nothing of what was drawn with this store was lost for want of room; otherwise the next has more.
    fn is_complete(&mut self, store: &Store) -> Result<bool, GpuError> {
        match (&mut self.method, store) {
            (Method::Exact(exact), Store::Meetings(meetings)) => exact.had_room(self.device, meetings),
            _ => Ok(true),
        }
    }

    /// Commands that draw one picture.
    fn encode(
        &self,
        targets: &Targets,
        store: &Store,
        stamps: Option<Stamps<'_>>,
    ) -> Result<wgpu::CommandEncoder, GpuError> {
        self.device.guarded("encoding a picture", || {
            let mut encoder = self.device.wgpu.create_command_encoder(&Default::default());
            match (&self.method, store) {
                (Method::Fragment(draw), Store::Depth(depth)) => {
                    draw.encode(&mut encoder, &self.buffers, targets, depth, stamps);
                }
                (Method::Exact(exact), Store::Meetings(meetings)) => {
                    exact.encode(&mut encoder, &self.buffers, targets, meetings, stamps);
                }
                _ => unreachable!("a store is made by the method that it is drawn with"),
            }
            encoder
        })
    }
}

fn other_technique(expected: Technique, found: Technique) -> GpuError {
    GpuError::Technique { expected: expected.name(), found: found.name() }
}

impl Device {
    /// A texture of a picture's size.
    pub(crate) fn texture(
        &self,
        label: &str,
        viewport: Viewport,
        format: TextureFormat,
        usage: TextureUsages,
    ) -> wgpu::Texture {
        self.wgpu.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: viewport.width() as u32,
                height: viewport.height() as u32,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// A shader module, or the compiler's message.
    pub(crate) fn module(&self, program: Program, source: String) -> Result<wgpu::ShaderModule, GpuError> {
        self.guarded("reading a shader", || {
            self.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: None,
                source: wgpu::ShaderSource::Wgsl(source.into()),
            })
        })
        .map_err(|error| as_shader_error(error, program, "source"))
    }
}

/// A refusal of a shader or its pipeline is the shader's error; any other passes.
pub(crate) fn as_shader_error(error: GpuError, program: Program, entry: &'static str) -> GpuError {
    match error {
        GpuError::Refused { message, .. } => {
            GpuError::Shader { program: format!("{program:?}"), entry, message: plain(&message) }
        }
        other => other,
    }
}

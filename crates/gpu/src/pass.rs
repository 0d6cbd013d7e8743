//! One picture: pipelines, targets, the draw, and what is made of the answer.

use crate::buffers::{ProxyBuffers, SceneBuffers, vertex_layout};
use crate::device::plain;
use crate::pieces::{PieceBuffers, Unconverged};
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

/// Frames timed with one query set, whose size WebGPU bounds at 4096.
const FRAMES_A_QUERY_SET: usize = 2048;

const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// Formats of `GBufferOutput` in `shaders/entry.wgsl`.
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
    /// Seconds of each frame's render pass by the device's clock, where it has one.
    pub gpu_s: Option<Vec<f64>>,
}

impl Timing {
    /// Frames a second by the processor's clock.
    pub fn frames_per_second(&self) -> f64 {
        self.frames as f64 / self.wall_s
    }
}

/// What a fragment shader writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Output {
    GBuffer,
    Shaded,
}

impl Output {
    fn entry(self) -> &'static str {
        match self {
            Output::GBuffer => "fragment_gbuffer",
            Output::Shaded => "fragment_shaded",
        }
    }

    fn formats(self) -> &'static [TextureFormat] {
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

/// A picture's textures.
struct Targets {
    output: Output,
    viewport: Viewport,
    colours: Vec<wgpu::Texture>,
    colour_views: Vec<wgpu::TextureView>,
    depth_view: wgpu::TextureView,
    /// Technique `exact` alone.
    unconverged: Option<Unconverged>,
}

/// A scene on a device, ready to be drawn from any camera.
pub struct Renderer<'a> {
    device: &'a Device,
    scene: &'a PackedScene,
    curvature: bool,
    depth: DepthOrder,
    buffers: SceneBuffers,
    proxy: ProxyBuffers,
    technique: Technique,
    /// Technique `exact` alone.
    pieces: Option<PieceBuffers>,
    layout: wgpu::PipelineLayout,
    modules: HashMap<Program, wgpu::ShaderModule>,
    /// Made when first drawn with: a driver may take seconds to compile one.
    pipelines: HashMap<(Program, Output), wgpu::RenderPipeline>,
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
        let buffers = SceneBuffers::new(device, scene, ShaderStages::VERTEX_FRAGMENT)?;
        let technique = proxy.technique();
        let pieces = match technique {
            Technique::Fragment => None,
            Technique::Exact => Some(PieceBuffers::new(device, &proxy.pieces)?),
        };
        let proxy = ProxyBuffers::new(device, proxy)?;
        let groups: Vec<_> =
            [&buffers.layout].into_iter().chain(pieces.as_ref().map(|p| &p.layout)).map(Some).collect();
        let layout = device.guarded("setting up", || {
            device.wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("scene"),
                bind_group_layouts: &groups,
                immediate_size: 0,
            })
        })?;
        let mut modules = HashMap::new();
        for &program in &scene.programs {
            if let Entry::Vacant(vacant) = modules.entry(program) {
                let variant = Variant { technique, program, curvature, interpolated_normal: interpolated_normals };
                let source = overrides.source.map_or_else(|| wgsl::source(variant), |source| source(variant));
                vacant.insert(device.module(program, source)?);
            }
        }
        Ok(Self {
            device,
            scene,
            curvature,
            depth: overrides.depth,
            buffers,
            proxy,
            technique,
            pieces,
            layout,
            modules,
            pipelines: HashMap::new(),
        })
    }

    /// Draws the scene with other triangles from now on; they must be of the same scene.
    ///
    /// # Errors
    /// As [`Self::new`]; [`GpuError::Technique`] where the proxy is of another technique.
    pub fn set_proxy(&mut self, proxy: &Proxy) -> Result<(), GpuError> {
        if proxy.technique() != self.technique {
            return Err(GpuError::Technique { expected: self.technique.name(), found: proxy.technique().name() });
        }
        self.proxy = ProxyBuffers::new(self.device, proxy)?;
        if self.pieces.is_some() {
            self.pieces = Some(PieceBuffers::new(self.device, &proxy.pieces)?);
        }
        Ok(())
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
        let targets = self.draw(views, viewport, Output::GBuffer)?;
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
        let buffer = GBuffer::from_rows(viewport, meta, hits);
        match (failure, &targets.unconverged) {
            (Some(error), _) => Err(error),
            (None, None) => Ok(buffer),
            (None, Some(unconverged)) => Ok(buffer.with_undecided(unconverged.pixels(self.device)?)),
        }
    }

    /// The raw answers of the fragment program, row-major from the top: what [`Self::gbuffer`] makes its hits of.
    ///
    /// # Errors
    /// As [`Self::gbuffer`].
    pub fn fragments(&mut self, views: &[View], viewport: Viewport) -> Result<Vec<Option<Fragment>>, GpuError> {
        let targets = self.draw(views, viewport, Output::GBuffer)?;
        let mut rows = Rows::new(self.device, targets.colours.iter().collect(), viewport)?;
        let mut fragments = Vec::with_capacity(viewport.pixels());
        for y in 0..viewport.height() {
            fragments.extend(self.row(&mut rows, viewport, y, |_, fragment| fragment)?);
        }
        Ok(fragments)
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
                Ok(record.pixel(x, y, self.scene.faces.len())?.map(|fragment| make(x, fragment)))
            })
            .collect()
    }

    /// The picture that the fragment stage itself shades, on [`background`].
    ///
    /// Curvature shading needs a renderer that computes curvature; without it every point's is unknown.
    ///
    /// # Errors
    /// As [`Self::gbuffer`].
    pub fn shaded(&mut self, views: &[View], shading: &ShadeUniform, viewport: Viewport) -> Result<Picture, GpuError> {
        self.buffers.write_shading(self.device, shading)?;
        let targets = self.draw(views, viewport, Output::Shaded)?;
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
        const TIMING: &str = "timing frames";
        let Some(first) = frames.first() else {
            let gpu_s = self.device.has_timestamps().then(Vec::new);
            return Ok(Timing { frames: 0, wall_s: 0.0, gpu_s });
        };
        self.buffers.write_shading(self.device, shading)?;
        self.prepare(Output::Shaded)?;
        let targets = self.targets(viewport, Output::Shaded)?;
        self.buffers.write_views(self.device, first)?;
        let encoder = self.encode(&targets, None)?;
        self.device.submit(TIMING, encoder)?;
        self.device.wait(TIMING, None)?;
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
                let encoder = self.encode(&targets, queries.as_ref().map(|q| q.writes(index)))?;
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

    /// Submits one picture.
    fn draw(&mut self, views: &[View], viewport: Viewport, output: Output) -> Result<Targets, GpuError> {
        self.buffers.write_views(self.device, views)?;
        self.prepare(output)?;
        let targets = self.targets(viewport, output)?;
        let encoder = self.encode(&targets, None)?;
        self.device.submit("drawing", encoder)?;
        Ok(targets)
    }

    /// Compiles the pipelines that are not there yet.
    fn prepare(&mut self, output: Output) -> Result<(), GpuError> {
        for &program in self.modules.keys() {
            if !self.pipelines.contains_key(&(program, output)) {
                let pipeline = self.pipeline(program, output)?;
                self.pipelines.insert((program, output), pipeline);
            }
        }
        Ok(())
    }

    fn pipeline(&self, program: Program, output: Output) -> Result<wgpu::RenderPipeline, GpuError> {
        let module = &self.modules[&program];
        let targets: Vec<_> = output.formats().iter().map(|&format| Some(format.into())).collect();
        let compare = match self.depth {
            DepthOrder::Nearest => wgpu::CompareFunction::Greater,
            DepthOrder::Farthest => wgpu::CompareFunction::Less,
        };
        let descriptor = wgpu::RenderPipelineDescriptor {
            label: Some(output.entry()),
            layout: Some(&self.layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[Some(vertex_layout())],
            },
            primitive: wgpu::PrimitiveState {
                // A surface is seen from both its sides; a hull is drawn by its far side.
                cull_mode: match self.technique {
                    Technique::Fragment => None,
                    Technique::Exact => Some(wgpu::Face::Front),
                },
                ..Default::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(output.entry()),
                compilation_options: Default::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        };
        self.device
            .guarded("compiling a pipeline", || self.device.wgpu.create_render_pipeline(&descriptor))
            .map_err(|error| as_shader_error(error, program, output.entry()))
    }

    fn targets(&self, viewport: Viewport, output: Output) -> Result<Targets, GpuError> {
        let side = viewport.width().max(viewport.height()) as u64;
        let limit = u64::from(self.device.limits.max_texture_dimension_2d);
        self.device.fits("the viewport", "max_texture_dimension_2d", side, limit)?;
        let unconverged = match &self.pieces {
            Some(pieces) => Some(pieces.unconverged(self.device, viewport)?),
            None => None,
        };
        self.device.guarded("allocating the picture", || {
            let texture = |format, usage| {
                self.device.wgpu.create_texture(&wgpu::TextureDescriptor {
                    label: Some(output.entry()),
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
            };
            let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
            let colours: Vec<_> = output
                .formats()
                .iter()
                .map(|&format| texture(format, TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC))
                .collect();
            let colour_views = colours.iter().map(view).collect();
            let depth_view = view(&texture(DEPTH_FORMAT, TextureUsages::RENDER_ATTACHMENT));
            Targets { output, viewport, colours, colour_views, depth_view, unconverged }
        })
    }

    /// Commands that clear the targets and draw every batch, in the proxy's order.
    fn encode(
        &self,
        targets: &Targets,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> Result<wgpu::CommandEncoder, GpuError> {
        let colours: Vec<_> = targets
            .colour_views
            .iter()
            .enumerate()
            .map(|(target, view)| {
                Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(targets.output.cleared(target)),
                        store: wgpu::StoreOp::Store,
                    },
                })
            })
            .collect();
        let farthest = match self.depth {
            DepthOrder::Nearest => 0.0,
            DepthOrder::Farthest => 1.0,
        };
        self.device.guarded("encoding a picture", || {
            let mut encoder = self.device.wgpu.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(targets.output.entry()),
                color_attachments: &colours,
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &targets.depth_view,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(farthest),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes,
                ..Default::default()
            });
            let (width, height) = (targets.viewport.width() as f32, targets.viewport.height() as f32);
            pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
            pass.set_bind_group(0, &self.buffers.group, &[]);
            if let Some(unconverged) = &targets.unconverged {
                pass.set_bind_group(1, &unconverged.group, &[]);
            }
            self.proxy.bind(&mut pass);
            for batch in self.proxy.batches.iter().filter(|batch| batch.count > 0) {
                // A batch of a program that no face has draws nothing of this scene.
                if let Some(pipeline) = self.pipelines.get(&(batch.program, targets.output)) {
                    pass.set_pipeline(pipeline);
                    pass.draw_indexed(batch.first..batch.first + batch.count, 0, 0..1);
                }
            }
            drop(pass);
            encoder
        })
    }
}

impl Device {
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

/// Two timestamps a frame.
struct Queries {
    set: wgpu::QuerySet,
    frames: usize,
}

impl Queries {
    fn new(device: &Device, frames: usize) -> Result<Self, GpuError> {
        let descriptor = wgpu::QuerySetDescriptor {
            label: Some("frames"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * frames as u32,
        };
        let set = device.guarded("setting up", || device.wgpu.create_query_set(&descriptor))?;
        Ok(Self { set, frames })
    }

    fn writes(&self, frame: usize) -> wgpu::RenderPassTimestampWrites<'_> {
        wgpu::RenderPassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(2 * frame as u32),
            end_of_pass_write_index: Some(2 * frame as u32 + 1),
        }
    }

    /// Seconds from the first to the second of each pair.
    fn read(&self, device: &Device) -> Result<Vec<f64>, GpuError> {
        const READING: &str = "reading timestamps";
        let mut ticks = vec![[0u64; 2]; self.frames];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut ticks);
        let (buffer, encoder) = device.guarded(READING, || {
            let buffer = device.wgpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            let mut encoder = device.wgpu.create_command_encoder(&Default::default());
            encoder.resolve_query_set(&self.set, 0..2 * self.frames as u32, &buffer, 0);
            (buffer, encoder)
        })?;
        device.submit(READING, encoder)?;
        device.read_buffer(READING, &buffer, bytes)?;
        let second = f64::from(device.queue.get_timestamp_period()) * 1e-9;
        Ok(ticks.iter().map(|[start, end]| end.saturating_sub(*start) as f64 * second).collect())
    }
}

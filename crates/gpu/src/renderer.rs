//! One picture after the other of a scene: drawn by a technique's pass, and what is made of the answer.

use crate::buffers::SceneBuffers;
use crate::device::COMPILER;
use crate::faults::Overrides;
use crate::grid::Grid;
use crate::hits::{self, Seen};
use crate::ieee;
use crate::mark::{Mark, UNDECIDED};
use crate::modules::Modules;
use crate::pass::{Drawable, Frame, Pass};
use crate::queries::{Queries, Stamps};
use crate::readback::Rows;
use crate::targets::{Output, Targets};
use crate::{Device, GpuError};
use gbuffer::{GBuffer, Meta, Picture, ShadeUniform};
use pipeline::fragment::Fragment;
use pipeline::wgsl::{self, Variant};
use pipeline::{PackedFrame, PackedScene, View};
use scene::{Camera, Viewport};
use std::collections::VecDeque;
use std::collections::hash_map::{Entry, HashMap};
use std::time::Instant;

/// Frames that may be under way at once while timing: enough that the device never waits for the processor.
const FRAMES_IN_FLIGHT: usize = 3;

const TIMING: &str = "timing frames";

/// What a renderer's programs compute.
#[derive(Clone, Copy, Default)]
pub struct RendererOptions<'f> {
    /// Second derivatives and principal curvatures.
    pub curvature: bool,
    /// Whether [`Renderer::shaded`] uses normals interpolated from vertices, where the technique has some. A G-buffer never does.
    pub vertex_normals: bool,
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
    /// Of these the seconds of each part, by name, where the device has a clock.
    pub parts_s: Vec<(&'static str, Vec<f64>)>,
}

impl Timing {
    /// Frames a second by the processor's clock.
    pub fn frames_per_second(&self) -> f64 {
        self.frames as f64 / self.wall_s
    }
}

/// A scene on a device, ready to be drawn from any camera.
pub struct Renderer<'a> {
    device: &'a Device,
    /// Of each face; kept here, so that scenes may come and go while this draws their edits.
    frames: Vec<PackedFrame>,
    has_edges: bool,
    curvature: bool,
    buffers: SceneBuffers,
    modules: Modules,
    technique: &'static str,
    pass: Box<dyn Pass>,
}

impl<'a> Renderer<'a> {
    /// The grid to which the adapter snaps corners, as measured ([`Device::measured_grid`]).
    ///
    /// # Errors
    /// As there.
    pub fn measured_grid(&self) -> Result<Option<Grid>, GpuError> {
        self.device.measured_grid()
    }

    /// Uploads a scene and what a technique draws of it, and reads the shaders of its programs.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where the scene does not fit the adapter, [`GpuError::Shader`] where a source is illegal;
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn new(
        device: &'a Device,
        scene: &PackedScene,
        drawn: &dyn Drawable,
        options: RendererOptions<'_>,
    ) -> Result<Self, GpuError> {
        let RendererOptions { curvature, vertex_normals, overrides } = options;
        // Strict programs take no coverage from an adapter.
        let blend = (!drawn.is_strict()).then_some(overrides.mask);
        let buffers = SceneBuffers::new(device, scene, drawn.stages(), blend)?;
        let pass = drawn.pass(device, &buffers, overrides.depth)?;
        let mut modules = HashMap::new();
        for &program in scene.programs() {
            if let Entry::Vacant(vacant) = modules.entry(program) {
                let variant =
                    Variant { parts: drawn.parts(), program, curvature, vertex_normals, trims: scene.trim_method() };
                let source = overrides.source.map_or_else(|| wgsl::source(variant), |source| source(variant));
                let source = if drawn.is_strict() { ieee::strict(&source)? } else { source };
                vacant.insert(device.module(program, source)?);
            }
        }
        let (frames, has_edges) = (scene.frames().to_vec(), scene.has_edges());
        Ok(Self { device, frames, has_edges, curvature, buffers, modules, technique: drawn.technique(), pass })
    }

    /// Bytes on the device that the scene takes, and that its technique holds beside it; pictures come on top.
    pub fn bytes(&self) -> [u64; 2] {
        [self.buffers.bytes(), self.pass.bytes()]
    }

    /// Draws something else from now on; it must be of the same scene.
    ///
    /// # Errors
    /// As [`Self::new`]; [`GpuError::Technique`] where it is of another technique.
    pub fn set(&mut self, drawn: &dyn Drawable) -> Result<(), GpuError> {
        self.pass.set(self.device, drawn)
    }

    /// Takes over an edit: a scene, and what is drawn of it, whose numbers differ from those `before`, which this renderer has. Only
    /// what differs is uploaded; returns how many bytes that is.
    ///
    /// Trim curves are numbers of their own, so that moving a control point leaves them and every mask alone. Where the
    /// edit changes how many pieces technique `exact` has, these are all uploaded.
    ///
    /// # Errors
    /// [`GpuError::OtherShape`] where the scenes have other layouts, or the tessellations other corners; as [`Self::new`].
    pub fn edit(
        &mut self,
        before: (&PackedScene, &dyn Drawable),
        after: (&PackedScene, &dyn Drawable),
    ) -> Result<u64, GpuError> {
        let written = self.buffers.write_changes(self.device, before.0, after.0)?;
        let drawn = self.pass.write_changes(self.device, before.1, after.1)?;
        self.frames = after.0.frames().to_vec();
        Ok(written + drawn)
    }

    /// What each pixel sees, as `camera` has it; `views` are those of the same camera and viewport.
    ///
    /// The adapter and its driver are entered in `meta`. Pixels for which the technique has no answer
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
        let meta = Meta {
            adapter: Some(info.name.clone()),
            driver: Some(driver.trim().to_owned()),
            compiler: Some(COMPILER.to_owned()),
            ..meta
        };
        let (targets, frame) = self.draw(views, viewport, Output::GBuffer)?;
        let mut rows = Rows::new(self.device, targets.colours.iter().collect(), viewport)?;
        let (curvature, edges) = (self.curvature, self.has_edges);
        let seen = Seen { frames: &self.frames, curvature, edges, camera, viewport };
        let buffer = seen.gbuffer(meta, |y| self.row(&mut rows, viewport, y))?;
        let Some((marks, offset)) = frame.undecided() else { return Ok(buffer) };
        let mut words = vec![0u32; hits::marks(viewport) / 4];
        self.device.read_buffer(UNDECIDED, marks, offset, bytemuck::cast_slice_mut(&mut words))?;
        Ok(buffer.with_undecided(hits::undecided(&words, viewport)))
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
            fragments.extend(self.row(&mut rows, viewport, y)?);
        }
        Ok(fragments)
    }

    /// How often the technique's search evaluates the surface for each pixel, row-major from the top, to draw the picture: what
    /// the search costs, and a witness of the path that it takes to what it finds.
    ///
    /// # Errors
    /// [`GpuError::NothingSearched`] where the technique searches for nothing; else as [`Self::gbuffer`].
    pub fn evaluations(&mut self, views: &[View], viewport: Viewport) -> Result<Vec<u32>, GpuError> {
        let (_, frame) = self.draw(views, viewport, Output::GBuffer)?;
        frame.evaluations(self.device)?.ok_or(GpuError::NothingSearched { technique: self.technique })
    }

    /// The fragments of row `y` of the four targets.
    fn row(&self, rows: &mut Rows<'_>, viewport: Viewport, y: usize) -> Result<Vec<Option<Fragment>>, GpuError> {
        let targets = rows.row(y)?.try_into().expect("a G-buffer has four targets");
        hits::fragments(targets, y, viewport, (self.frames.len(), self.has_edges))
    }

    /// Whether a frame had room for all; otherwise the next one has more.
    fn had_room(&self, frame: &dyn Frame) -> Result<bool, GpuError> {
        let Some(room) = frame.room() else { return Ok(true) };
        let lacking = room.lacking(self.device)?;
        self.device.mark(lacking.map_or(Mark::Room(room.capacity), |_| Mark::NoRoom))?;
        match lacking {
            None => Ok(true),
            Some(needed) => frame.make_room(self.device, needed).map(|()| false),
        }
    }

    /// The picture that the device itself shades, on [`background`](gbuffer::background).
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
            return Ok(Timing { frames: 0, wall_s: 0.0, gpu_s, parts_s: vec![] });
        };
        self.buffers.write_shading(self.device, shading)?;
        loop {
            let (targets, frame) = self.draw(first, viewport, Output::Shaded)?;
            self.device.wait(TIMING, None)?;
            let timing = self.time(frames, &targets, &*frame)?;
            // A later frame may have had more to keep than the first.
            if self.had_room(&*frame)? {
                return Ok(timing);
            }
        }
    }

    fn time(&self, frames: &[Vec<View>], targets: &Targets, frame: &dyn Frame) -> Result<Timing, GpuError> {
        let names = frame.parts();
        let mut timing = Timing {
            frames: frames.len(),
            wall_s: 0.0,
            gpu_s: self.device.has_timestamps().then(Vec::new),
            parts_s: names.iter().map(|name| (*name, vec![])).collect(),
        };
        for chunk in frames.chunks(Queries::frames_a_set(names.len())) {
            let queries = match timing.gpu_s {
                Some(_) => Some(Queries::new(self.device, chunk.len(), names.len())?),
                None => None,
            };
            let start = Instant::now();
            let mut under_way = VecDeque::new();
            for (index, views) in chunk.iter().enumerate() {
                if under_way.len() == FRAMES_IN_FLIGHT {
                    self.device.wait(TIMING, under_way.pop_front())?;
                }
                self.buffers.write_views(self.device, views)?;
                let encoder = self.encode(targets, frame, queries.as_ref().map(|q| q.frame(index)))?;
                under_way.push_back(self.device.submit(TIMING, encoder)?);
            }
            self.device.wait(TIMING, None)?;
            timing.wall_s += start.elapsed().as_secs_f64();
            if let (Some(seconds), Some(queries)) = (&mut timing.gpu_s, queries) {
                for parts in queries.read(self.device)? {
                    seconds.push(parts.iter().sum());
                    timing.parts_s.iter_mut().zip(parts).for_each(|((_, all), part)| all.push(part));
                }
            }
        }
        Ok(timing)
    }

    /// Draws one picture, again where it had more to keep than there was room for.
    fn draw(
        &mut self,
        views: &[View],
        viewport: Viewport,
        output: Output,
    ) -> Result<(Targets, Box<dyn Frame>), GpuError> {
        self.buffers.write_views(self.device, views)?;
        let targets = Targets::new(self.device, viewport, output, self.pass.usage())?;
        loop {
            self.pass.prepare(self.device, &self.modules, output)?;
            let frame = self.pass.frame(self.device, &targets)?;
            let encoder = self.encode(&targets, &*frame, None)?;
            self.device.submit("drawing", encoder)?;
            if self.had_room(&*frame)? {
                return Ok((targets, frame));
            }
        }
    }

    /// Commands that draw one picture.
    fn encode(
        &self,
        targets: &Targets,
        frame: &dyn Frame,
        stamps: Option<Stamps<'_>>,
    ) -> Result<wgpu::CommandEncoder, GpuError> {
        self.device.guarded("encoding a picture", || {
            let mut encoder = self.device.wgpu.create_command_encoder(&Default::default());
            frame.encode(&mut encoder, &self.buffers, targets, stamps);
            encoder
        })
    }
}

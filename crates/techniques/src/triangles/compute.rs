//! Triangles on the device without its rasterizer: the kernels of `shaders/raster/`, whose coverage, depth and choice of the
//! nearest triangle have the CPU rasterizer's bits on every adapter; but on a skirt, where what is shown decides, only strict ones.

use crate::resolve;
use crate::subnormals::{Lacking, Subnormals};
use crate::technique::Prepared;
use crate::triangles::SAMPLE;
use bytemuck::{Pod, Zeroable};
use gpu::groups::{PART_STRIDE, READ, UNIFORM, UNIFORM_AT, WRITE, part, whole, workgroups};
use gpu::{
    Atomics, DepthOrder, Device, Drawable, Frame, GpuError, Modules, Output, Pass, Room, SceneBuffers, Stamps, Targets,
};
use pipeline::wgsl::Part;
use pipeline::{Mesh, Program, Vertex};
use std::collections::HashMap;
use std::sync::Arc;
use wgpu::{BufferUsages, ShaderStages, TextureUsages};

/// The kernels, whatever the atomics.
const ENTRY: Part = Part { file: "raster/entry.wgsl", text: include_str!("../../../../shaders/raster/entry.wgsl") };

/// What they use.
const CLIP: Part = Part { file: "raster/clip.wgsl", text: include_str!("../../../../shaders/raster/clip.wgsl") };
const AREA: Part = Part { file: "raster/area.wgsl", text: include_str!("../../../../shaders/raster/area.wgsl") };
const SETUP: Part = Part { file: "raster/setup.wgsl", text: include_str!("../../../../shaders/raster/setup.wgsl") };

/// How corners are weighed: by the snapped triangle, or as the CPU rasterizer does. One file's place.
const WEIGHTS: Part =
    Part { file: "raster/weights.wgsl", text: include_str!("../../../../shaders/raster/weights.wgsl") };
const WEIGHTS_STRICT: Part =
    Part { file: "raster/weights.wgsl", text: include_str!("../../../../shaders/raster/weights_strict.wgsl") };

/// The arithmetic that has the same bits everywhere.
pub const STRICT: Part =
    Part { file: "raster/strict.wgsl", text: include_str!("../../../../shaders/raster/strict.wgsl") };

/// Who is nearest, by atomics of 64 bits or of 32: one file's place.
const NEAREST_64: Part =
    Part { file: "raster/nearest.wgsl", text: include_str!("../../../../shaders/raster/nearest64.wgsl") };
const NEAREST_32: Part =
    Part { file: "raster/nearest.wgsl", text: include_str!("../../../../shaders/raster/nearest32.wgsl") };

/// The parts of a program by atomics of 64 bits.
const PARTS_64: &[Part] = &[ENTRY, CLIP, SETUP, WEIGHTS, STRICT, NEAREST_64, SAMPLE, resolve::PART];

/// How a strict program raises a subnormal number.
const SUBNORMAL: Part =
    Part { file: "raster/subnormal.wgsl", text: include_str!("../../../../shaders/raster/subnormal.wgsl") };

/// The same by atomics of 32 bits.
const PARTS_32: &[Part] = &[ENTRY, CLIP, SETUP, WEIGHTS, STRICT, NEAREST_32, SAMPLE, resolve::PART];

/// The same with the CPU rasterizer's interpolation.
const PARTS_STRICT: &[Part] =
    &[ENTRY, CLIP, SETUP, WEIGHTS_STRICT, AREA, STRICT, SUBNORMAL, NEAREST_32, SAMPLE, resolve::PART];

/// Threads of a workgroup in `shaders/raster/entry.wgsl`.
const WORKGROUP: u32 = 64;

/// Workgroups that share triangles of unknown number: enough to fill the largest chips, and soon done where there are none.
const SHARING: u32 = 2048;

/// Words of the queue before the counts: whether a subnormal number was met.
const FIRST_COUNT: usize = 1;

/// Counts a call and round: large triangles, cut ones, and questions.
const COUNTS: usize = 3;

/// Words of a question in `shaders/raster/entry.wgsl`.
const QUESTION: u64 = 5;

/// Questions that wait at once, each whether a bounded face is at a pixel: so many a pixel of the picture, and so many of any
/// picture (84 MB). Where some find no room, all are answered where they arise, by one workgroup a triangle.
const QUESTIONS_A_PIXEL: u64 = 2;
const GREATEST_ROOM: u64 = 1 << 22;

/// `Call` in `shaders/raster/entry.wgsl`, filled up to [`PART_STRIDE`].
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Call {
    first: u32,
    count: u32,
    width: u32,
    height: u32,
    indices: u32,
    vertices: u32,
    counts: u32,
    waiting: u32,
    clears: u32,
    questions: u32,
    room: u32,
    back: u32,
    nothing: [f32; 4],
    padding: [u32; 48],
}

/// An entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Kernel {
    PlaceCorners,
    CoverSmall,
    CoverLarge,
    CoverCut,
    Answer,
    AnswerRest,
    Resolve(Output),
}

impl Kernel {
    /// Those that cover, in the order in which a call takes them.
    const THAT_COVER: [Self; 5] = [Self::CoverSmall, Self::CoverLarge, Self::CoverCut, Self::Answer, Self::AnswerRest];

    fn entry(self) -> &'static str {
        match self {
            Kernel::PlaceCorners => "place_corners",
            Kernel::CoverSmall => "cover_small",
            Kernel::CoverLarge => "cover_large",
            Kernel::CoverCut => "cover_cut",
            Kernel::Answer => "answer",
            Kernel::AnswerRest => "answer_rest",
            Kernel::Resolve(Output::GBuffer) => "resolve_gbuffer",
            Kernel::Resolve(Output::Shaded) => "resolve_shaded",
        }
    }

    /// Whether it answers questions, of which scenes without trims have none.
    fn is_answer(self) -> bool {
        matches!(self, Kernel::Answer | Kernel::AnswerRest)
    }
}

/// How often triangles are gone through: atomics of 32 bits find the nearest order first, and then who has it.
fn rounds(atomics: Atomics) -> usize {
    match atomics {
        Atomics::Bits64 => 1,
        Atomics::Bits32 => 2,
    }
}

/// The triangles of a technique, drawn by kernels.
///
/// They are those of the picture that the technique was prepared for, wherever it chooses others for each frame.
pub struct ByCompute {
    prepared: Arc<dyn Prepared>,
    atomics: Atomics,
    is_strict: bool,
}

impl ByCompute {
    /// The parts of a program by these atomics; the first holds the entry points.
    pub fn parts_by(atomics: Atomics) -> &'static [Part] {
        match atomics {
            Atomics::Bits64 => PARTS_64,
            Atomics::Bits32 => PARTS_32,
        }
    }

    /// The parts of the program that [`Self::strict`] draws by.
    pub fn strict_parts() -> &'static [Part] {
        PARTS_STRICT
    }

    /// What is prepared, drawn by kernels with these atomics; `None` where it has no triangles.
    pub fn new(prepared: Arc<dyn Prepared>, atomics: Atomics) -> Option<Self> {
        prepared.mesh()?;
        Some(Self { prepared, atomics, is_strict: false })
    }

    /// The same with the CPU rasterizer's bits in all that a G-buffer holds, on every adapter: one program for all of them, in
    /// IEEE 754's arithmetic.
    pub fn strict(prepared: Arc<dyn Prepared>) -> Option<Self> {
        Some(Self { is_strict: true, ..Self::new(prepared, Atomics::Bits32)? })
    }

    fn mesh(&self) -> &Mesh {
        self.prepared.mesh().expect("looked for in `new`")
    }
}

impl Drawable for ByCompute {
    fn technique(&self) -> &'static str {
        self.prepared.technique()
    }

    fn parts(&self) -> &'static [Part] {
        if self.is_strict { Self::strict_parts() } else { Self::parts_by(self.atomics) }
    }

    fn is_strict(&self) -> bool {
        self.is_strict
    }

    fn stages(&self) -> ShaderStages {
        ShaderStages::COMPUTE
    }

    fn pass(&self, device: &Device, scene: &SceneBuffers, depth: DepthOrder) -> Result<Box<dyn Pass>, GpuError> {
        let fed = Fed::new(device, self.mesh(), rounds(self.atomics))?;
        let zeros = device.buffer("zeros", BufferUsages::UNIFORM, &[])?;
        let (layout, cover_layout, resolve_layouts) = device.guarded("setting up", || {
            let bindings = (0..).zip([READ, WRITE, WRITE, WRITE, UNIFORM_AT, UNIFORM]);
            let layout = device.group_layout("triangles", ShaderStages::COMPUTE, bindings);
            let cover_layout = device.pipeline_layout("triangles", &[Some(&scene.layouts.scene), Some(&layout)]);
            let resolve_layouts = resolve::layouts(device, "triangles", [&scene.layouts.scene, &layout]);
            (layout, cover_layout, resolve_layouts)
        })?;
        let technique = self.technique();
        let pipelines = HashMap::new();
        Ok(Box::new(Kernels {
            technique,
            subnormals: self.is_strict.then(Subnormals::default),
            depth,
            is_trimmed: scene.is_trimmed,
            fed,
            zeros,
            layout,
            cover_layout,
            resolve_layouts,
            pipelines,
        }))
    }
}

/// Triangles on the device.
#[derive(Clone)]
struct Fed {
    /// Vertices, then indices.
    mesh: wgpu::Buffer,
    corners: wgpu::Buffer,
    /// Triangles of each program: the first, and how many.
    batches: Vec<(Program, [u32; 2])>,
    vertices: u32,
    triangles: u64,
    rounds: usize,
}

impl Fed {
    fn new(device: &Device, mesh: &Mesh, rounds: usize) -> Result<Self, GpuError> {
        let vertices = bytemuck::cast_slice::<Vertex, u8>(&mesh.vertices);
        let words = [vertices, bytemuck::cast_slice(&mesh.indices)].concat();
        let triangles = |batch: &pipeline::Batch| (batch.program, [batch.first / 3, batch.count / 3]);
        let batches: Vec<_> = mesh.batches.iter().filter(|batch| batch.count > 0).map(triangles).collect();
        Ok(Self {
            mesh: device.storage("vertices and indices", &words)?,
            corners: device.empty("corners in the picture", 16 * mesh.vertices.len().max(1) as u64)?,
            batches,
            vertices: mesh.vertices.len() as u32,
            triangles: mesh.triangles() as u64,
            rounds,
        })
    }

    /// Bytes that a frame begins with as zeros, at the queue's start.
    fn counts(&self) -> u64 {
        4 * (FIRST_COUNT + COUNTS * self.rounds * self.batches.len()) as u64
    }

    /// Bytes of the counts and of all triangles.
    fn waiting(&self) -> u64 {
        self.counts() + 4 * self.triangles
    }

    /// A call a batch and round, with room for so many questions.
    fn calls(&self, targets: &Targets, room: u64) -> Vec<Call> {
        let nothing = targets.nothing();
        let call = |(index, &(_, [first, count])): (usize, &(Program, [u32; 2])), round: usize| Call {
            first,
            count,
            width: targets.viewport.width() as u32,
            height: targets.viewport.height() as u32,
            indices: self.vertices * (size_of::<Vertex>() / 4) as u32,
            vertices: self.vertices,
            counts: (FIRST_COUNT + COUNTS * (round * self.batches.len() + index)) as u32,
            waiting: (self.counts() / 4) as u32 + first,
            clears: u32::from(index == 0),
            questions: (self.waiting() / 4) as u32,
            room: room as u32,
            back: (COUNTS * round * self.batches.len()) as u32,
            nothing,
            padding: [0; 48],
        };
        (0..self.rounds)
            .flat_map(|round| self.batches.iter().enumerate().map(move |batch| call(batch, round)))
            .collect()
    }
}

/// The pass.
struct Kernels {
    technique: &'static str,
    /// Of strict kernels.
    subnormals: Option<Subnormals>,
    depth: DepthOrder,
    is_trimmed: bool,
    fed: Fed,
    zeros: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    /// Of the kernels that write no target.
    cover_layout: wgpu::PipelineLayout,
    /// Of those that do.
    resolve_layouts: resolve::Layouts,
    /// Made when first needed: a driver may take seconds to compile one.
    pipelines: HashMap<(Program, Kernel), wgpu::ComputePipeline>,
}

impl Kernels {
    fn pipeline(
        &self,
        device: &Device,
        program: Program,
        module: &wgpu::ShaderModule,
        kernel: Kernel,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let layout = match kernel {
            Kernel::Resolve(output) => &self.resolve_layouts[&output].1,
            _ => &self.cover_layout,
        };
        let mut constants = vec![("FARTHEST", f64::from(u8::from(self.depth == DepthOrder::Farthest)))];
        constants.extend(self.subnormals.iter().flat_map(Subnormals::constants));
        device.kernel(layout, (program, module), kernel.entry(), &constants)
    }
}

impl Pass for Kernels {
    fn usage(&self) -> TextureUsages {
        TextureUsages::STORAGE_BINDING
    }

    fn bytes(&self) -> u64 {
        self.fed.mesh.size() + self.fed.corners.size() + self.fed.waiting()
    }

    fn prepare(&mut self, device: &Device, modules: &Modules, output: Output) -> Result<(), GpuError> {
        if self.subnormals.as_mut().is_some_and(Subnormals::begin) {
            self.pipelines.clear();
        }
        let is_run = |kernel: &Kernel| self.is_trimmed || !kernel.is_answer();
        let covering = Kernel::THAT_COVER.into_iter().filter(is_run);
        let kernels: Vec<_> = covering.chain([Kernel::PlaceCorners, Kernel::Resolve(output)]).collect();
        for (&program, module) in modules {
            for &kernel in &kernels {
                if !self.pipelines.contains_key(&(program, kernel)) {
                    let pipeline = self.pipeline(device, program, module, kernel)?;
                    self.pipelines.insert((program, kernel), pipeline);
                }
            }
        }
        Ok(())
    }

    fn frame(&self, device: &Device, targets: &Targets) -> Result<Box<dyn Frame>, GpuError> {
        let pixels = targets.viewport.pixels() as u64;
        let seen = device.empty("who is seen", 8 * pixels)?;
        let room = if self.is_trimmed { (QUESTIONS_A_PIXEL * pixels).min(GREATEST_ROOM) } else { 0 };
        let queue = device.empty("what waits", self.fed.waiting() + 4 * QUESTION * room)?;
        let mut calls = self.fed.calls(targets, room);
        if calls.is_empty() {
            calls.push(Zeroable::zeroed());
        }
        let calls = device.buffer("calls", BufferUsages::UNIFORM, bytemuck::cast_slice(&calls))?;
        let (group, targets) = device.guarded("setting up", || {
            let Fed { mesh, corners, .. } = &self.fed;
            let buffers = whole([mesh, corners, &seen, &queue]);
            let call = part(&calls, PART_STRIDE as u64);
            let resources = buffers.chain([(4, call), (5, self.zeros.as_entire_binding())]);
            let group = device.group("triangles", &self.layout, resources);
            (group, resolve::group(device, &self.resolve_layouts[&targets.output].0, targets))
        })?;
        let (fed, pipelines) = (self.fed.clone(), self.pipelines.clone());
        let lacking = self.subnormals.as_ref().and_then(Subnormals::lacking);
        Ok(Box::new(Covered { fed, pipelines, seen, queue, asks: room > 0, lacking, group, targets }))
    }

    fn set(&mut self, device: &Device, drawn: &dyn Drawable) -> Result<(), GpuError> {
        let drawn = drawn.of::<ByCompute>(self.technique)?;
        self.fed = Fed::new(device, drawn.mesh(), self.fed.rounds)?;
        Ok(())
    }

    /// Corners alone where the triangles are the same, else all of them.
    fn write_changes(&mut self, device: &Device, before: &dyn Drawable, after: &dyn Drawable) -> Result<u64, GpuError> {
        let (before, after) = (before.of::<ByCompute>(self.technique)?, after.of::<ByCompute>(self.technique)?);
        if before.mesh().indices != after.mesh().indices {
            self.fed = Fed::new(device, after.mesh(), self.fed.rounds)?;
            return Ok(self.fed.mesh.size());
        }
        let [before, after] = [before, after].map(|of| bytemuck::cast_slice(&of.mesh().vertices));
        device.write_changes("vertices", &self.fed.mesh, before, after)
    }
}

/// One picture of the triangles.
struct Covered {
    fed: Fed,
    pipelines: HashMap<(Program, Kernel), wgpu::ComputePipeline>,
    seen: wgpu::Buffer,
    queue: wgpu::Buffer,
    /// Whether there are questions.
    asks: bool,
    /// Of strict kernels that compute no subnormal numbers: where to say that there are any.
    lacking: Option<Lacking>,
    group: wgpu::BindGroup,
    targets: wgpu::BindGroup,
}

/// A kernel that is run.
struct Dispatch {
    kernel: Kernel,
    /// Number of its call.
    call: usize,
    program: Program,
    /// Workgroups in both dimensions.
    groups: [u32; 2],
}

impl Covered {
    /// The batches by their numbers; one of a program that no face has shows nothing of this scene.
    fn batches(&self) -> Vec<(usize, Program, u32)> {
        let batches =
            self.fed.batches.iter().enumerate().map(|(index, &(program, [_, count]))| (index, program, count));
        batches.filter(|(_, program, _)| self.pipelines.contains_key(&(*program, Kernel::PlaceCorners))).collect()
    }

    fn placing(&self, batches: &[(usize, Program, u32)]) -> Vec<Dispatch> {
        let groups = workgroups(self.fed.vertices, WORKGROUP);
        let first =
            batches.first().map(|&(call, program, _)| Dispatch { kernel: Kernel::PlaceCorners, call, program, groups });
        first.into_iter().collect()
    }

    fn covering(&self, batches: &[(usize, Program, u32)]) -> Vec<Dispatch> {
        let mut dispatches = vec![];
        for round in 0..self.fed.rounds {
            // Questions of one batch are answered before those of the next take their place.
            for &(index, program, count) in batches {
                let call = index + round * self.fed.batches.len();
                for kernel in Kernel::THAT_COVER {
                    let groups = match kernel {
                        _ if kernel.is_answer() && !self.asks => continue,
                        Kernel::CoverSmall => workgroups(count, WORKGROUP),
                        _ => [SHARING, 1],
                    };
                    dispatches.push(Dispatch { kernel, call, program, groups });
                }
            }
        }
        dispatches
    }

    fn resolving(&self, batches: &[(usize, Program, u32)], targets: &Targets) -> Vec<Dispatch> {
        let groups = resolve::tiles(targets.viewport);
        let kernel = Kernel::Resolve(targets.output);
        batches.iter().map(|&(call, program, _)| Dispatch { kernel, call, program, groups }).collect()
    }
}

impl Frame for Covered {
    fn parts(&self) -> &'static [&'static str] {
        &["clear", "place", "cover", "resolve"]
    }

    fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneBuffers,
        targets: &Targets,
        stamps: Option<Stamps<'_>>,
    ) {
        let batches = self.batches();
        if let Some(stamps) = stamps {
            stamps.begin(encoder);
        }
        resolve::clear_unless_first(encoder, targets, batches.first().map(|&(index, ..)| index));
        encoder.clear_buffer(&self.seen, 0, None);
        encoder.clear_buffer(&self.queue, 0, Some(self.fed.counts()));
        let parts = [
            ("place", self.placing(&batches)),
            ("cover", self.covering(&batches)),
            ("resolve", self.resolving(&batches, targets)),
        ];
        for (ends, (label, dispatches)) in (2..).zip(parts) {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(label),
                timestamp_writes: stamps.map(|Stamps { set, start }| wgpu::ComputePassTimestampWrites {
                    query_set: set,
                    beginning_of_pass_write_index: (ends == 2).then_some(start + 1),
                    end_of_pass_write_index: Some(start + ends),
                }),
            });
            pass.set_bind_group(0, &scene.group, &[]);
            pass.set_bind_group(2, &self.targets, &[]);
            for Dispatch { kernel, call, program, groups: [x, y] } in dispatches {
                pass.set_pipeline(&self.pipelines[&(program, kernel)]);
                pass.set_bind_group(1, &self.group, &[(call * PART_STRIDE) as u32]);
                pass.dispatch_workgroups(x, y, 1);
            }
        }
    }

    /// For no subnormal number, where none is computed.
    fn room(&self) -> Option<Room<'_>> {
        let during = "looking for subnormal numbers";
        self.lacking.is_some().then_some(Room { during, buffer: &self.queue, offset: 0, capacity: 0 })
    }

    fn make_room(&self, _device: &Device, _needed: u64) -> Result<(), GpuError> {
        if let Some(lacking) = &self.lacking {
            lacking.met();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::{Expression, Literal};
    use pipeline::TrimMethod;
    use pipeline::wgsl::{self, Variant};

    #[test]
    fn records_and_workgroups_are_those_of_the_shader() {
        for parts in [PARTS_64, PARTS_32] {
            let (program, trims) = (Program::Degree(3), TrimMethod::Whole);
            let variant = Variant { parts, program, curvature: false, vertex_normals: false, trims };
            let module = naga::front::wgsl::parse_str(&wgsl::source(variant)).unwrap();
            let call = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Call")).unwrap().1;
            let naga::TypeInner::Struct { members, .. } = &call.inner else { panic!("Call is no struct") };
            assert_eq!(members.last().unwrap().offset as usize, std::mem::offset_of!(Call, nothing));
            let value = |name: &str| {
                let (_, constant) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name)).unwrap();
                module.global_expressions[constant.init].clone()
            };
            let vertex = (size_of::<Vertex>() / 4) as u32;
            let sizes =
                [("WORKGROUP", WORKGROUP), ("TILE", resolve::TILE), ("VERTEX", vertex), ("QUESTION", QUESTION as u32)];
            for (name, expected) in sizes {
                assert_eq!(value(name), Expression::Literal(Literal::U32(expected)), "{name}");
            }
        }
        assert_eq!(size_of::<Call>(), PART_STRIDE);
    }
}

//! Technique `exact` on the device: the compute kernels of `shaders/exact/entry.wgsl`, and what they share.

mod picture;

use self::picture::{Picture, Range, Shared};
use super::hulls::{CORNERS, Hulls, INDICES};
use crate::resolve;
use crate::subnormals::{Lacking, Subnormals};
use crate::triangles::compute::STRICT;
use bytemuck::{Pod, Zeroable};
use gpu::groups::{PART_STRIDE, READ, UNIFORM, UNIFORM_AT, WRITE, workgroups};
use gpu::{DepthOrder, Device, Drawable, Frame, GpuError, Modules, Output, Pass, Room, SceneBuffers, Stamps, Targets};
use pipeline::Program;
use pipeline::wgsl::Part;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use wgpu::{BufferUsages, ShaderStages, TextureUsages};

/// The technique's name.
pub(super) const NAME: &str = "exact";

/// Kernels `bound_hulls`, `meet_small`, `meet_large`, `choose`, `resolve_gbuffer` and `resolve_shaded`, and the search.
pub(super) const PARTS: &[Part] = &[ENTRY, resolve::PART, NEWTON, FOLD, PLACE];

/// The same, and what strict programs have beside it; the first uses the entry points.
const PARTS_STRICT: &[Part] = &[SUBNORMAL, ENTRY, resolve::PART, NEWTON, FOLD, PLACE, STRICT];

const ENTRY: Part = Part { file: "exact/entry.wgsl", text: include_str!("../../../../shaders/exact/entry.wgsl") };
const NEWTON: Part = Part { file: "exact/newton.wgsl", text: include_str!("../../../../shaders/exact/newton.wgsl") };
const FOLD: Part = Part { file: "exact/fold.wgsl", text: include_str!("../../../../shaders/exact/fold.wgsl") };
const PLACE: Part = Part { file: "exact/place.wgsl", text: include_str!("../../../../shaders/exact/place.wgsl") };

/// How a strict program raises a subnormal number.
const SUBNORMAL: Part =
    Part { file: "exact/subnormal.wgsl", text: include_str!("../../../../shaders/exact/subnormal.wgsl") };

/// Threads of a workgroup, and those of a small hull, in `shaders/exact/entry.wgsl`.
const WORKGROUP: u32 = 64;
const LANES: u32 = 8;

/// Workgroups of the kernels whose threads share work of unknown size: enough to fill the largest chips.
const SHARING: u32 = 16_384;

/// Meetings that `shaders/exact/subnormal.wgsl` counts where it met a subnormal number.
const ENDLESS: u64 = u32::MAX as u64;

/// `Hull` in `shaders/exact/entry.wgsl`; all but the corners is written by the device.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct HullRecord {
    corners: [[f32; 4]; 8],
    written: [u32; 8],
}

/// An entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Kernel {
    BoundHulls,
    MeetSmall,
    MeetLarge,
    Choose,
    Resolve(Output),
}

impl Kernel {
    fn entry(self) -> &'static str {
        match self {
            Kernel::BoundHulls => "bound_hulls",
            Kernel::MeetSmall => "meet_small",
            Kernel::MeetLarge => "meet_large",
            Kernel::Choose => "choose",
            Kernel::Resolve(Output::GBuffer) => "resolve_gbuffer",
            Kernel::Resolve(Output::Shaded) => "resolve_shaded",
        }
    }
}

impl Drawable for Hulls {
    fn technique(&self) -> &'static str {
        NAME
    }

    fn parts(&self) -> &'static [Part] {
        PARTS
    }

    fn stages(&self) -> ShaderStages {
        ShaderStages::COMPUTE
    }

    fn pass(&self, device: &Device, scene: &SceneBuffers, depth: DepthOrder) -> Result<Box<dyn Pass>, GpuError> {
        Ok(Box::new(Search::new(device, scene, depth, self, None)?))
    }
}

/// Hulls that strict programs search: each number of a G-buffer has the CPU rasterizer's bits, on every adapter.
pub struct Strict(pub Hulls);

impl Drawable for Strict {
    fn technique(&self) -> &'static str {
        NAME
    }

    fn parts(&self) -> &'static [Part] {
        PARTS_STRICT
    }

    fn is_strict(&self) -> bool {
        true
    }

    fn stages(&self) -> ShaderStages {
        ShaderStages::COMPUTE
    }

    fn pass(&self, device: &Device, scene: &SceneBuffers, depth: DepthOrder) -> Result<Box<dyn Pass>, GpuError> {
        Ok(Box::new(Search::new(device, scene, depth, &self.0, Some(Subnormals::default()))?))
    }
}

/// The pieces on the device, and what finds them in pixels.
struct Search {
    depth: DepthOrder,
    /// Of strict kernels.
    subnormals: Option<Subnormals>,
    shared: Shared,
    /// Of the kernels that write no target.
    search_layout: wgpu::PipelineLayout,
    /// Of those that do.
    resolve_layouts: resolve::Layouts,
    /// Made when first needed: a driver may take seconds to compile one.
    pipelines: HashMap<(Program, Kernel), wgpu::ComputePipeline>,
    /// Meetings that a picture has room for at least: as many as one has had.
    capacity: Arc<AtomicU64>,
}

impl Search {
    fn new(
        device: &Device,
        scene: &SceneBuffers,
        depth: DepthOrder,
        drawn: &Hulls,
        subnormals: Option<Subnormals>,
    ) -> Result<Self, GpuError> {
        let (pieces, hulls) = upload(device, drawn)?;
        let zeros = device.buffer("zeros", BufferUsages::UNIFORM, &[])?;
        let (layout, search_layout, resolve_layouts) = device.guarded("setting up", || {
            let layout = device.group_layout("pieces", ShaderStages::COMPUTE, shared_bindings());
            let search_layout = device.pipeline_layout("exact", &[Some(&scene.layouts.scene), Some(&layout)]);
            let resolve_layouts = resolve::layouts(device, "exact", [&scene.layouts.scene, &layout]);
            (layout, search_layout, resolve_layouts)
        })?;
        Ok(Self {
            depth,
            subnormals,
            shared: Shared { pieces, hulls, zeros, ranges: ranges(drawn), layout },
            search_layout,
            resolve_layouts,
            pipelines: HashMap::new(),
            capacity: Arc::new(AtomicU64::new(0)),
        })
    }

    /// What is drawn, by either kind of program.
    fn hulls<'d>(&self, drawn: &'d dyn Drawable) -> Result<&'d Hulls, GpuError> {
        match self.subnormals {
            None => drawn.of::<Hulls>(NAME),
            Some(_) => drawn.of::<Strict>(NAME).map(|strict| &strict.0),
        }
    }

    fn pipeline(
        &self,
        device: &Device,
        program: Program,
        module: &wgpu::ShaderModule,
        kernel: Kernel,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let layout = match kernel {
            Kernel::Resolve(output) => &self.resolve_layouts[&output].1,
            _ => &self.search_layout,
        };
        let farthest = f64::from(u8::from(self.depth == DepthOrder::Farthest));
        let mut constants = vec![("FARTHEST", farthest)];
        constants.extend(self.subnormals.iter().flat_map(Subnormals::constants));
        device.kernel(layout, (program, module), kernel.entry(), &constants)
    }
}

impl Pass for Search {
    fn usage(&self) -> TextureUsages {
        TextureUsages::STORAGE_BINDING
    }

    /// Pieces and hulls; what a picture keeps of meetings is the picture's.
    fn bytes(&self) -> u64 {
        self.shared.pieces.size() + self.shared.hulls.size()
    }

    fn prepare(&mut self, device: &Device, modules: &Modules, output: Output) -> Result<(), GpuError> {
        if self.subnormals.as_mut().is_some_and(Subnormals::begin) {
            self.pipelines.clear();
        }
        let kernels =
            [Kernel::BoundHulls, Kernel::MeetSmall, Kernel::MeetLarge, Kernel::Choose, Kernel::Resolve(output)];
        for (&program, module) in modules {
            for kernel in kernels {
                if !self.pipelines.contains_key(&(program, kernel)) {
                    let pipeline = self.pipeline(device, program, module, kernel)?;
                    self.pipelines.insert((program, kernel), pipeline);
                }
            }
        }
        Ok(())
    }

    fn frame(&self, device: &Device, targets: &Targets) -> Result<Box<dyn Frame>, GpuError> {
        let layout = &self.resolve_layouts[&targets.output].0;
        let picture = Picture::new(device, &self.shared, self.capacity.load(Relaxed), targets, layout)?;
        let (ranges, pipelines) = (self.shared.ranges.clone(), self.pipelines.clone());
        let lacking = self.subnormals.as_ref().and_then(Subnormals::lacking);
        Ok(Box::new(Searched { ranges, pipelines, picture, lacking, capacity: self.capacity.clone() }))
    }

    fn set(&mut self, device: &Device, drawn: &dyn Drawable) -> Result<(), GpuError> {
        let hulls = self.hulls(drawn)?;
        (self.shared.pieces, self.shared.hulls) = upload(device, hulls)?;
        self.shared.ranges = ranges(hulls);
        Ok(())
    }

    /// All of them where there are not as many.
    fn write_changes(&mut self, device: &Device, before: &dyn Drawable, after: &dyn Drawable) -> Result<u64, GpuError> {
        let (before, after) = (self.hulls(before)?, self.hulls(after)?);
        let [old, new] = [before, after].map(hull_records);
        if before.pieces.len() != after.pieces.len() || before.mesh.batches != after.mesh.batches {
            self.set(device, after)?;
            return Ok((size_of_val(&after.pieces[..]) + size_of_val(&new[..])) as u64);
        }
        let [a, b] = [before, after].map(|hulls| bytemuck::cast_slice(&hulls.pieces));
        let pieces = device.write_changes("pieces", &self.shared.pieces, a, b)?;
        let hulls = device.write_changes(
            "hulls",
            &self.shared.hulls,
            bytemuck::cast_slice(&old),
            bytemuck::cast_slice(&new),
        )?;
        Ok(pieces + hulls)
    }
}

/// One picture of what is searched for.
struct Searched {
    ranges: Vec<Range>,
    pipelines: HashMap<(Program, Kernel), wgpu::ComputePipeline>,
    picture: Picture,
    /// Of strict kernels that compute no subnormal numbers: where to say that there are any.
    lacking: Option<Lacking>,
    capacity: Arc<AtomicU64>,
}

impl Frame for Searched {
    fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneBuffers,
        targets: &Targets,
        stamps: Option<Stamps<'_>>,
    ) {
        let picture = &self.picture;
        if let Some(stamps) = stamps {
            stamps.begin(encoder);
        }
        // A range of a program that no face has shows nothing of this scene.
        let ranges: Vec<_> = (0..)
            .zip(&self.ranges)
            .filter(|(_, range)| self.pipelines.contains_key(&(range.program, Kernel::Choose)))
            .collect();
        resolve::clear_unless_first(encoder, targets, ranges.first().map(|&(index, _)| index as usize));
        picture.clear(encoder);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("exact"),
            timestamp_writes: stamps.map(|Stamps { set, start }| wgpu::ComputePassTimestampWrites {
                query_set: set,
                beginning_of_pass_write_index: None,
                end_of_pass_write_index: Some(start + 1),
            }),
        });
        pass.set_bind_group(0, &scene.group, &[]);
        pass.set_bind_group(2, &picture.targets, &[]);
        let mut run = |kernel: Kernel, index: u32, program: Program, [x, y]: [u32; 2]| {
            pass.set_pipeline(&self.pipelines[&(program, kernel)]);
            pass.set_bind_group(1, &picture.group, &[index * PART_STRIDE as u32]);
            pass.dispatch_workgroups(x, y, 1);
        };
        for &(index, range) in &ranges {
            run(Kernel::BoundHulls, index, range.program, workgroups(range.count, WORKGROUP));
        }
        for &(index, range) in &ranges {
            run(Kernel::MeetSmall, index, range.program, workgroups(range.count, WORKGROUP / LANES));
            run(Kernel::MeetLarge, index, range.program, [SHARING, 1]);
        }
        if let Some(&(index, range)) = ranges.first() {
            run(Kernel::Choose, index, range.program, [SHARING, 1]);
        }
        let tiles = resolve::tiles(targets.viewport);
        for &(index, range) in &ranges {
            run(Kernel::Resolve(targets.output), index, range.program, tiles);
        }
    }

    fn room(&self) -> Option<Room<'_>> {
        Some(self.picture.room())
    }

    fn make_room(&self, device: &Device, needed: u64) -> Result<(), GpuError> {
        if let Some(lacking) = self.lacking.as_ref().filter(|_| needed == ENDLESS) {
            lacking.met();
            return Ok(());
        }
        // Which meetings are found to be hidden depends on the order of work, so their number does.
        self.capacity.store(picture::within_limits(device, needed, needed + needed / 2)?, Relaxed);
        Ok(())
    }

    fn undecided(&self) -> Option<(&wgpu::Buffer, u64)> {
        Some(self.picture.unconverged())
    }

    fn evaluations(&self, device: &Device) -> Result<Option<Vec<u32>>, GpuError> {
        self.picture.evaluations(device).map(Some)
    }
}

/// The pieces that each batch of hulls draws.
fn ranges(hulls: &Hulls) -> Vec<Range> {
    let pieces = hulls.pieces.len() as u32;
    let piece = |index: u32| (index / INDICES as u32).min(pieces);
    let range = |batch: &pipeline::Batch| {
        let first = piece(batch.first);
        Range { program: batch.program, first, count: piece(batch.first + batch.count) - first }
    };
    hulls.mesh.batches.iter().map(range).filter(|range| range.count > 0).collect()
}

fn upload(device: &Device, hulls: &Hulls) -> Result<(wgpu::Buffer, wgpu::Buffer), GpuError> {
    Ok((
        device.storage("pieces", bytemuck::cast_slice(&hulls.pieces))?,
        device.storage("hulls", bytemuck::cast_slice(&hull_records(hulls)))?,
    ))
}

/// Hulls as they are uploaded.
fn hull_records(hulls: &Hulls) -> Vec<HullRecord> {
    let record = |corners: &[pipeline::Vertex]| {
        let corner = |i: usize| {
            let [x, y, z] = corners[i].position;
            [x, y, z, 1.0]
        };
        HullRecord { corners: std::array::from_fn(corner), written: [0; 8] }
    };
    hulls.mesh.vertices.chunks_exact(CORNERS).map(record).collect()
}

/// Pieces, hulls, picture, meetings, and the batch at hand: with the scene's four they are the eight storage buffers
/// that WebGPU promises a stage. Then zeros, which strict programs read.
fn shared_bindings() -> impl Iterator<Item = (u32, wgpu::BindingType)> {
    (0..).zip([READ, WRITE, WRITE, WRITE, UNIFORM_AT, UNIFORM])
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::TypeInner;
    use pipeline::TrimMethod;
    use pipeline::wgsl::{self, Variant};

    #[test]
    fn records_and_workgroups_are_those_of_the_shader() {
        let variant = Variant {
            parts: PARTS,
            program: Program::Degree(3),
            curvature: false,
            vertex_normals: false,
            trims: TrimMethod::Whole,
        };
        let module = naga::front::wgsl::parse_str(&wgsl::source(variant)).unwrap();
        let size = |name: &str| {
            let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap().1;
            let TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
            (*span as usize, members.last().unwrap().offset as usize)
        };
        assert_eq!(size("Hull"), (size_of::<HullRecord>(), 8 * 16 + 16));
        assert_eq!(size("Meeting"), (picture::MEETING_BYTES as usize, 16));
        assert_eq!(size("Batch"), (48, 32));
        assert_eq!(size("Picture").1, 4 * picture::HEAD);
        let constant = |name: &str| {
            let (_, constant) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name)).unwrap();
            module.global_expressions[constant.init].clone()
        };
        for (name, value) in [("WORKGROUP", WORKGROUP), ("LANES", LANES), ("TILE", resolve::TILE)] {
            assert_eq!(constant(name), naga::Expression::Literal(naga::Literal::U32(value)), "{name}");
        }
    }
}

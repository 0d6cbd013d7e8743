//! Technique `exact` on the device: the compute kernels of `shaders/entry_exact.wgsl`, and what they share.

mod picture;

pub(crate) use picture::Picture;

use crate::buffers::SceneBuffers;
use crate::pass::{DepthOrder, Modules, Output, Targets, as_shader_error};
use crate::queries::Stamps;
use crate::{Device, GpuError};
use bytemuck::{Pod, Zeroable};
use pipeline::{Program, Proxy};
use std::collections::HashMap;
use wgpu::{BufferBindingType, ShaderStages};

/// Threads of a workgroup, those of a small hull, and the side of a tile in `shaders/entry_exact.wgsl`.
const WORKGROUP: u32 = 64;
const LANES: u32 = 8;
const TILE: u32 = 8;

/// Workgroups in one dimension of a dispatch: what WebGPU promises.
const ROW: u32 = 65_535;

/// Workgroups of the kernels whose threads share work of unknown size: enough to fill the largest chips.
const SHARING: u32 = 16_384;

/// Indices of a hull in a proxy.
const INDICES_A_PIECE: u32 = 36;

/// `Hull` in `shaders/entry_exact.wgsl`; all but the corners is written by the device.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct HullRecord {
    corners: [[f32; 4]; 8],
    written: [u32; 8],
}

/// The pieces of a program, in drawing order.
#[derive(Clone, Copy)]
struct Range {
    program: Program,
    first: u32,
    count: u32,
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

/// The pieces on the device, and what finds them in pixels.
pub(crate) struct Exact {
    depth: DepthOrder,
    pieces: wgpu::Buffer,
    hulls: wgpu::Buffer,
    ranges: Vec<Range>,
    layout: wgpu::BindGroupLayout,
    /// Of the kernels that write no target.
    search_layout: wgpu::PipelineLayout,
    /// Group and pipeline layout of the kernels that write the targets of an output.
    resolve_layouts: HashMap<Output, (wgpu::BindGroupLayout, wgpu::PipelineLayout)>,
    /// Made when first needed: a driver may take seconds to compile one.
    pipelines: HashMap<(Program, Kernel), wgpu::ComputePipeline>,
    /// Meetings that a picture has room for at least: as many as one has had.
    capacity: u64,
}

impl Exact {
    pub(crate) fn new(
        device: &Device,
        scene: &SceneBuffers,
        proxy: &Proxy,
        depth: DepthOrder,
    ) -> Result<Self, GpuError> {
        let (pieces, hulls) = upload(device, proxy)?;
        let (layout, search_layout, resolve_layouts) = device.guarded("setting up", || {
            let layout = group_layout(device, "pieces", shared_bindings());
            let pipeline_layout = |groups: &[Option<&wgpu::BindGroupLayout>]| {
                device.wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some("exact"),
                    bind_group_layouts: groups,
                    immediate_size: 0,
                })
            };
            let search_layout = pipeline_layout(&[Some(&scene.layout), Some(&layout)]);
            let resolve_layouts = [Output::GBuffer, Output::Shaded].map(|output| {
                let targets = group_layout(device, "targets", target_bindings(output));
                let pipeline = pipeline_layout(&[Some(&scene.layout), Some(&layout), Some(&targets)]);
                (output, (targets, pipeline))
            });
            (layout, search_layout, HashMap::from(resolve_layouts))
        })?;
        Ok(Self {
            depth,
            pieces,
            hulls,
            ranges: ranges(proxy),
            layout,
            search_layout,
            resolve_layouts,
            pipelines: HashMap::new(),
            capacity: 0,
        })
    }

    /// Takes other pieces of the same scene.
    pub(crate) fn set_proxy(&mut self, device: &Device, proxy: &Proxy) -> Result<(), GpuError> {
        (self.pieces, self.hulls) = upload(device, proxy)?;
        self.ranges = ranges(proxy);
        Ok(())
    }

    /// Uploads the pieces and hulls that differ between two proxies, or all where there are not as many; says how many
    /// bytes that is.
    pub(crate) fn write_changes(&mut self, device: &Device, before: &Proxy, after: &Proxy) -> Result<u64, GpuError> {
        let [old, new] = [before, after].map(hull_records);
        if before.pieces.len() != after.pieces.len() || before.batches != after.batches {
            self.set_proxy(device, after)?;
            return Ok((size_of_val(&after.pieces[..]) + size_of_val(&new[..])) as u64);
        }
        let [a, b] = [before, after].map(|proxy| bytemuck::cast_slice(&proxy.pieces));
        let pieces = device.write_changes("pieces", &self.pieces, a, b)?;
        let hulls =
            device.write_changes("hulls", &self.hulls, bytemuck::cast_slice(&old), bytemuck::cast_slice(&new))?;
        Ok(pieces + hulls)
    }

    /// Compiles the pipelines that are not there yet.
    pub(crate) fn prepare(&mut self, device: &Device, modules: &Modules, output: Output) -> Result<(), GpuError> {
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
        let constants = &[("FARTHEST", farthest)];
        let descriptor = wgpu::ComputePipelineDescriptor {
            label: Some(kernel.entry()),
            layout: Some(layout),
            module,
            entry_point: Some(kernel.entry()),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        };
        device
            .guarded("compiling a pipeline", || device.wgpu.create_compute_pipeline(&descriptor))
            .map_err(|error| as_shader_error(error, program, kernel.entry()))
    }

    /// What a picture of these targets needs besides them.
    pub(crate) fn picture(&self, device: &Device, targets: &Targets) -> Result<Picture, GpuError> {
        Picture::new(device, self, targets)
    }

    /// Whether a picture had room for all its meetings. Otherwise the next one has room for more.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where the adapter has no room for as many.
    pub(crate) fn had_room(&mut self, device: &Device, picture: &Picture) -> Result<bool, GpuError> {
        let most = picture.most(device)?;
        if most <= picture.capacity {
            return Ok(true);
        }
        // Which meetings are found to be hidden depends on the order of work, so their number does.
        self.capacity = picture::within_limits(device, most, most + most / 2)?;
        Ok(false)
    }

    /// Commands that clear the targets, look for every piece, and resolve the nearest.
    pub(crate) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneBuffers,
        targets: &Targets,
        picture: &Picture,
        stamps: Option<Stamps<'_>>,
    ) {
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clear"),
            color_attachments: &targets.cleared(),
            timestamp_writes: stamps.map(|Stamps { set, start }| wgpu::RenderPassTimestampWrites {
                query_set: set,
                beginning_of_pass_write_index: Some(start),
                end_of_pass_write_index: None,
            }),
            ..Default::default()
        }));
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
        // A range of a program that no face has shows nothing of this scene.
        let ranges: Vec<_> = (0..)
            .zip(&self.ranges)
            .filter(|(_, range)| self.pipelines.contains_key(&(range.program, Kernel::Choose)))
            .collect();
        let mut run = |kernel: Kernel, index: u32, program: Program, [x, y]: [u32; 2]| {
            pass.set_pipeline(&self.pipelines[&(program, kernel)]);
            pass.set_bind_group(1, &picture.group, &[index * picture::BATCH_STRIDE]);
            pass.dispatch_workgroups(x, y, 1);
        };
        for &(index, range) in &ranges {
            run(Kernel::BoundHulls, index, range.program, grid(range.count, WORKGROUP));
        }
        for &(index, range) in &ranges {
            run(Kernel::MeetSmall, index, range.program, grid(range.count, WORKGROUP / LANES));
            run(Kernel::MeetLarge, index, range.program, [SHARING, 1]);
        }
        if let Some(&(index, range)) = ranges.first() {
            run(Kernel::Choose, index, range.program, [SHARING, 1]);
        }
        let side = |pixels: usize| (pixels as u32).div_ceil(TILE);
        let tiles = [side(targets.viewport.width()), side(targets.viewport.height())];
        for &(index, range) in &ranges {
            run(Kernel::Resolve(targets.output), index, range.program, tiles);
        }
    }
}

/// Workgroups for `count` pieces, so many a group, in rows of equal length.
fn grid(count: u32, a_group: u32) -> [u32; 2] {
    let groups = count.div_ceil(a_group);
    [groups.min(ROW), groups.div_ceil(ROW)]
}

/// The pieces that each batch of a proxy draws.
fn ranges(proxy: &Proxy) -> Vec<Range> {
    let pieces = proxy.pieces.len() as u32;
    let piece = |index: u32| (index / INDICES_A_PIECE).min(pieces);
    let range = |batch: &pipeline::Batch| {
        let first = piece(batch.first);
        Range { program: batch.program, first, count: piece(batch.first + batch.count) - first }
    };
    proxy.batches.iter().map(range).filter(|range| range.count > 0).collect()
}

fn upload(device: &Device, proxy: &Proxy) -> Result<(wgpu::Buffer, wgpu::Buffer), GpuError> {
    Ok((
        device.storage("pieces", bytemuck::cast_slice(&proxy.pieces))?,
        device.storage("hulls", bytemuck::cast_slice(&hull_records(proxy)))?,
    ))
}

/// The hulls of a proxy as they are uploaded.
fn hull_records(proxy: &Proxy) -> Vec<HullRecord> {
    let record = |corners: &[pipeline::Vertex]| {
        let corner = |i: usize| {
            let [x, y, z] = corners[i].position;
            [x, y, z, 1.0]
        };
        HullRecord { corners: std::array::from_fn(corner), written: [0; 8] }
    };
    proxy.vertices.chunks_exact(8).map(record).collect()
}

fn group_layout(device: &Device, label: &str, bindings: Vec<(u32, wgpu::BindingType)>) -> wgpu::BindGroupLayout {
    let entry =
        |(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility: ShaderStages::COMPUTE, ty, count: None };
    let entries: Vec<_> = bindings.into_iter().map(entry).collect();
    device.wgpu.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// Pieces, hulls, picture, meetings, and the batch at hand: with the scene's four they are the eight storage buffers
/// that WebGPU promises a stage.
fn shared_bindings() -> Vec<(u32, wgpu::BindingType)> {
    let buffer = |ty, has_dynamic_offset| wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None };
    let storage = |binding| (binding, buffer(BufferBindingType::Storage { read_only: binding == 0 }, false));
    (0..4).map(storage).chain([(4, buffer(BufferBindingType::Uniform, true))]).collect()
}

/// The targets of an output, by their bindings.
fn target_bindings(output: Output) -> Vec<(u32, wgpu::BindingType)> {
    let texture = |&format| wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D2,
    };
    (first_target(output)..).zip(output.formats().iter().map(texture)).collect()
}

/// Binding of the first target of an output.
fn first_target(output: Output) -> u32 {
    match output {
        Output::GBuffer => 0,
        Output::Shaded => 4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::TypeInner;
    use pipeline::wgsl::{self, Variant};
    use pipeline::{Technique, TrimMethod};

    #[test]
    fn records_and_workgroups_are_those_of_the_shader() {
        let variant = Variant {
            technique: Technique::Exact,
            program: Program::Degree(3),
            curvature: false,
            interpolated_normal: false,
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
        assert_eq!(size("Batch"), (28, 24));
        assert_eq!(size("Picture").1, 4 * picture::HEAD);
        let constant = |name: &str| {
            let (_, constant) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name)).unwrap();
            module.global_expressions[constant.init].clone()
        };
        for (name, value) in [("WORKGROUP", WORKGROUP), ("LANES", LANES), ("TILE", TILE)] {
            assert_eq!(constant(name), naga::Expression::Literal(naga::Literal::U32(value)), "{name}");
        }
    }

    #[test]
    fn a_dispatch_has_room_for_all_pieces_in_rows_that_are_allowed() {
        for count in [1, 64, 65, 8 * ROW, 8 * ROW + 1, 1 << 24] {
            let [x, y] = grid(count, 8);
            assert!(x <= ROW && y <= ROW && u64::from(x) * u64::from(y) * 8 >= u64::from(count), "{count}: {x} x {y}");
        }
    }
}

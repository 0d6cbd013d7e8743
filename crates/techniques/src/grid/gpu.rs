//! Technique `grid` on the device: kernels choose levels and place tiles for the view at hand, and indirect calls draw them.
//!
//! Neither the number of draw calls nor what is uploaded for a frame depends on how many patches there are.

use super::grids::Grids;
use super::record::GridRecord;
use super::tiles::{SIDES, SIZES, indices};
use crate::triangles::SAMPLE;
use crate::triangles::gpu::{Draw, Extent, FRAGMENT_STAGE, Feed};
use bytemuck::{Pod, Zeroable};
use gpu::groups::{PART_STRIDE, READ, UNIFORM, UNIFORM_AT, WRITE, part, whole};
use gpu::{DepthOrder, Device, Drawable, GpuError, Modules, Pass, Room, SceneBuffers, SceneLayouts};
use pipeline::wgsl::{Part, Variant};
use pipeline::{PackedScene, Program, View};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use wgpu::{BufferUsages, RenderPass, RenderPipeline, ShaderStages};

/// The technique's name.
pub(super) const NAME: &str = "grid";

/// Entry points `vertex` and `skirt_vertex`, the kernels, and the entry points of the fragment stage.
pub(super) const PARTS: &[Part] = &[
    Part { file: "grid/entry.wgsl", text: include_str!("../../../../shaders/grid/entry.wgsl") },
    Part { file: "grid/tiles.wgsl", text: include_str!("../../../../shaders/grid/tiles.wgsl") },
    Part { file: "grid/levels.wgsl", text: include_str!("../../../../shaders/grid/levels.wgsl") },
    CORNER,
    FRAGMENT_STAGE,
    SAMPLE,
];

/// Where a corner of a grid is.
pub const CORNER: Part = Part { file: "grid/corner.wgsl", text: include_str!("../../../../shaders/grid/corner.wgsl") };

/// The kernels, in their order.
const KERNELS: [&str; 7] =
    ["choose", "count_tiles", "sum_blocks", "scan_blocks", "scan_counts", "fill_calls", "place_tiles"];

/// Threads of a workgroup in `shaders/grid/levels.wgsl`.
const WORKGROUP: u32 = 64;

/// Counts that a workgroup of `shaders/grid/tiles.wgsl` adds up.
const BLOCK: u32 = 256 * 4;

/// Tiles that there is room for at least.
const LEAST_CAPACITY: u64 = 1024;

/// Corners of an instance about: small tiles are drawn many to an instance, since a GPU runs the corners of one instance together
/// and leaves the rest of its lanes idle.
const BUNCH_CORNERS: u32 = 128;

/// `Asked` in `shaders/grid/levels.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct AskedUniform {
    error_px: f32,
    most: u32,
    grids: u32,
    capacity: u32,
    draws: u32,
    zero: u32,
    per_error: f32,
}

/// `DrawCall` in `shaders/grid/tiles.wgsl`: what an indirect call takes, and what the vertex stage and kernels do.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(super) struct DrawCall {
    indices: u32,
    pub(super) instances: u32,
    first_index: u32,
    base_vertex: u32,
    first_instance: u32,
    pub(super) start: u32,
    first_grid: u32,
    end_grid: u32,
    pub(super) tiles: u32,
}

impl Drawable for Grids {
    fn technique(&self) -> &'static str {
        NAME
    }

    fn parts(&self) -> &'static [Part] {
        PARTS
    }

    fn stages(&self) -> ShaderStages {
        ShaderStages::VERTEX_FRAGMENT
    }

    fn pass(&self, device: &Device, scene: &SceneBuffers, depth: DepthOrder) -> Result<Box<dyn Pass>, GpuError> {
        Ok(Box::new(Draw::<Generator>::new(device, scene, self, depth)?))
    }
}

/// What chooses levels, and what draws the tiles that they come to.
#[derive(Clone)]
pub(super) struct Generator {
    buffers: Buffers,
    asked: AskedUniform,
    /// The program of each draw call.
    programs: Vec<Program>,
    layout: wgpu::BindGroupLayout,
    drawn_layout: wgpu::BindGroupLayout,
    room: TileRoom,
    /// Tiles that a picture has had, and has room for from then on.
    wanted: Arc<AtomicU64>,
    /// Made when first needed: a driver may take seconds to compile one.
    kernels: Option<[wgpu::ComputePipeline; KERNELS.len()]>,
}

/// What does not depend on how many tiles there are.
#[derive(Clone)]
struct Buffers {
    grids: wgpu::Buffer,
    measures: wgpu::Buffer,
    marks: wgpu::Buffer,
    counts: wgpu::Buffer,
    calls: wgpu::Buffer,
    indices: wgpu::Buffer,
    numbers: wgpu::Buffer,
}

/// Room for tiles, and the groups that hold it.
#[derive(Clone)]
struct TileRoom {
    capacity: u64,
    tiles: wgpu::Buffer,
    group: wgpu::BindGroup,
    drawn_group: wgpu::BindGroup,
}

/// Corners of a tile of this size.
fn corners_of(size: u32) -> u32 {
    ((1 << (size / SIDES)) + 1) * ((1 << (size % SIDES)) + 1)
}

/// Tiles of this size that are one instance.
pub(super) fn bunch_of(size: u32) -> u32 {
    (BUNCH_CORNERS / corners_of(size)).max(1)
}

/// The indices of all sizes' instances, and of each the first and how many they are.
fn all_indices() -> (Vec<u16>, [[u32; 2]; SIZES as usize]) {
    let mut all: Vec<u16> = vec![];
    let ranges = std::array::from_fn(|size| {
        let first = all.len() as u32;
        let size = size as u32;
        for tile in 0..bunch_of(size) {
            let first = (tile * corners_of(size)) as u16;
            all.extend(indices([size / SIDES, size % SIDES]).map(|index| first + index));
        }
        [first, all.len() as u32 - first]
    });
    (all, ranges)
}

impl Buffers {
    fn new(device: &Device, grids: &Grids) -> Result<Self, GpuError> {
        let count = grids.records.len() as u64;
        let groups = count.div_ceil(u64::from(WORKGROUP));
        let limit = u64::from(device.limits.max_compute_workgroups_per_dimension);
        device.fits("the patches", "max_compute_workgroups_per_dimension", groups, limit)?;
        let faces = grids.chord.len() as u64;
        let counts = u64::from(SIZES) * count;
        let (all, ranges) = all_indices();
        let call = |size: usize, [first_grid, end_grid]: [u32; 2]| {
            let [first_index, indices] = ranges[size];
            DrawCall { indices, first_index, first_grid, end_grid, ..Zeroable::zeroed() }
        };
        let of_program = |(_, range): &(Program, std::ops::Range<usize>)| {
            let ends = [range.start, range.end].map(|end| end as u32);
            (0..SIZES as usize).map(move |size| call(size, ends))
        };
        let calls: Vec<DrawCall> = grids.programs.iter().flat_map(of_program).collect();
        let mut numbers = vec![0u32; PART_STRIDE / 4 * calls.len().max(1)];
        for (number, uniform) in (0..).zip(numbers.chunks_exact_mut(PART_STRIDE / 4)) {
            let (across, size) = ((1 << (number % SIDES)) + 1, number % SIZES);
            uniform[..4].copy_from_slice(&[number, across, corners_of(size), bunch_of(size)]);
        }
        let calls = bytemuck::cast_slice(&calls);
        Ok(Self {
            grids: device.storage("grids", bytemuck::cast_slice(&grids.records))?,
            measures: device.storage("measures of grids", bytemuck::cast_slice(&grids.measures))?,
            marks: device.empty("levels of borders", 4 * (4 * count + faces).max(1))?,
            counts: device.empty("numbers of tiles", 4 * (counts + 1 + counts.div_ceil(u64::from(BLOCK))))?,
            calls: device.buffer(
                "draw calls",
                BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC,
                calls,
            )?,
            indices: device.buffer("corners of tiles", BufferUsages::INDEX, bytemuck::cast_slice(&all))?,
            numbers: device.buffer("numbers of draw calls", BufferUsages::UNIFORM, bytemuck::cast_slice(&numbers))?,
        })
    }

    /// Room for so many tiles.
    fn room(
        &self,
        device: &Device,
        layouts: [&wgpu::BindGroupLayout; 2],
        asked: AskedUniform,
        capacity: u64,
    ) -> Result<TileRoom, GpuError> {
        let limit = u64::from(device.limits.max_compute_workgroups_per_dimension) * u64::from(WORKGROUP);
        device.fits("the tiles", "max_compute_workgroups_per_dimension", capacity, limit)?;
        let tiles = device.empty("tiles", 8 * capacity)?;
        let asked = AskedUniform { capacity: capacity as u32, ..asked };
        let asked = device.buffer("levels asked for", BufferUsages::UNIFORM, bytemuck::bytes_of(&asked))?;
        let Self { grids, measures, marks, counts, calls, numbers, .. } = self;
        let (group, drawn_group) = device.guarded("setting up", || {
            let kernels = whole([grids, measures, marks, counts, calls, &tiles, &asked]);
            let group = device.group("levels", layouts[0], kernels);
            let number = part(numbers, PART_STRIDE as u64);
            let drawn = whole([grids, &tiles, calls]).chain([(3, number)]);
            (group, device.group("tiles", layouts[1], drawn))
        })?;
        Ok(TileRoom { capacity, tiles, group, drawn_group })
    }
}

impl Feed for Generator {
    type Prepared = Grids;

    fn new(device: &Device, grids: &Grids) -> Result<Self, GpuError> {
        let buffers = Buffers::new(device, grids)?;
        let asked = AskedUniform {
            error_px: grids.asked.error_px,
            per_error: grids.asked.per_error,
            most: grids.asked.most,
            grids: grids.records.len() as u32,
            draws: SIZES * grids.programs.len() as u32,
            ..Zeroable::zeroed()
        };
        let (layout, drawn_layout) = device.guarded("setting up", || {
            let kernels = [WRITE, READ, WRITE, WRITE, WRITE, WRITE, UNIFORM];
            let drawn = [READ, READ, READ, UNIFORM_AT];
            (
                device.group_layout("levels", ShaderStages::COMPUTE, (0..).zip(kernels)),
                device.group_layout("tiles", ShaderStages::VERTEX, (0..).zip(drawn)),
            )
        })?;
        let tiles = grids.picture.tiles.len() as u64;
        let capacity = (tiles + tiles / 2).max(LEAST_CAPACITY);
        let room = buffers.room(device, [&layout, &drawn_layout], asked, capacity)?;
        let programs = grids.programs.iter().map(|(program, _)| *program).collect();
        let wanted = Arc::new(AtomicU64::new(capacity));
        Ok(Self { buffers, asked, programs, layout, drawn_layout, room, wanted, kernels: None })
    }

    fn layouts(&self) -> Vec<Option<&wgpu::BindGroupLayout>> {
        vec![Some(&self.drawn_layout)]
    }

    fn prepare(&mut self, device: &Device, scene: &SceneLayouts, modules: &Modules) -> Result<(), GpuError> {
        // The kernels are the same in the module of each program.
        let Some((program, module)) = modules.iter().min_by_key(|(program, _)| **program) else { return Ok(()) };
        if self.kernels.is_none() {
            let layout = device.guarded("setting up", || {
                device.pipeline_layout("levels", &[Some(&scene.views), None, Some(&self.layout)])
            })?;
            let mut kernels = vec![];
            for entry in KERNELS {
                kernels.push(device.kernel(&layout, (*program, module), entry, &[])?);
            }
            self.kernels = kernels.try_into().ok();
        }
        Ok(())
    }

    fn bytes(&self) -> u64 {
        let Buffers { grids, measures, marks, counts, calls, indices, numbers } = &self.buffers;
        let all = [grids, measures, marks, counts, calls, indices, numbers, &self.room.tiles];
        all.into_iter().map(wgpu::Buffer::size).sum()
    }

    fn frame(&self, device: &Device) -> Result<Self, GpuError> {
        let wanted = self.wanted.load(Relaxed);
        let mut frame = self.clone();
        if wanted > self.room.capacity {
            frame.room = self.buffers.room(device, [&self.layout, &self.drawn_layout], self.asked, wanted)?;
        }
        Ok(frame)
    }

    fn before(&self, encoder: &mut wgpu::CommandEncoder, scene: &SceneBuffers, _step: usize) {
        let (Some(kernels), true) = (&self.kernels, self.asked.grids > 0) else { return };
        encoder.clear_buffer(&self.buffers.marks, 0, None);
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_bind_group(0, &scene.views_group, &[]);
        pass.set_bind_group(2, &self.room.group, &[]);
        let grids = self.asked.grids.div_ceil(WORKGROUP);
        let blocks = (SIZES * self.asked.grids).div_ceil(BLOCK);
        let calls = self.asked.draws.div_ceil(WORKGROUP);
        let tiles = (self.room.capacity as u32).div_ceil(WORKGROUP);
        for (kernel, groups) in kernels.iter().zip([grids, grids, blocks, 1, blocks, calls, tiles]) {
            pass.set_pipeline(kernel);
            pass.dispatch_workgroups(groups, 1, 1);
        }
    }

    fn draw<'p>(
        &self,
        pass: &mut RenderPass<'_>,
        pipeline: &dyn Fn(Program) -> Option<&'p RenderPipeline>,
        _extent: Extent,
        _step: usize,
    ) {
        pass.set_index_buffer(self.buffers.indices.slice(..), wgpu::IndexFormat::Uint16);
        for (index, program) in self.programs.iter().enumerate() {
            let Some(pipeline) = pipeline(*program) else { continue };
            pass.set_pipeline(pipeline);
            for call in SIZES as usize * index..SIZES as usize * (index + 1) {
                pass.set_bind_group(1, &self.room.drawn_group, &[(call * PART_STRIDE) as u32]);
                pass.draw_indexed_indirect(&self.buffers.calls, (call * size_of::<DrawCall>()) as u64);
            }
        }
    }

    fn room(&self) -> Option<Room<'_>> {
        let last = u64::from(SIZES * self.asked.grids);
        let Self { buffers, room, .. } = self;
        (last > 0).then_some(Room {
            during: "counting tiles",
            buffer: &buffers.counts,
            offset: 4 * last,
            capacity: room.capacity,
        })
    }

    fn make_room(&self, needed: u64) {
        self.wanted.store(needed + needed / 2, Relaxed);
    }

    /// All of them where there are not as many.
    fn write_changes(&mut self, device: &Device, before: &Grids, after: &Grids) -> Result<u64, GpuError> {
        if before.programs != after.programs {
            let kernels = self.kernels.take();
            *self = Self { kernels, ..Self::new(device, after)? };
            return Ok((size_of_val(&after.records[..]) + size_of_val(&after.measures[..])) as u64);
        }
        let [old, new] = [before, after].map(|grids| bytemuck::cast_slice::<GridRecord, u8>(&grids.records));
        let records = device.write_changes("grids", &self.buffers.grids, old, new)?;
        let [old, new] = [before, after].map(|grids| bytemuck::cast_slice(&grids.measures));
        Ok(records + device.write_changes("measures of grids", &self.buffers.measures, old, new)?)
    }
}

/// What the kernels have written.
pub(super) struct Chosen {
    pub records: Vec<GridRecord>,
    /// The grid, and its row and column in 16 bits each; as many as there is room for.
    pub tiles: Vec<[u32; 2]>,
    /// Those of each program and size.
    pub calls: Vec<DrawCall>,
}

/// The kernels by themselves.
impl Generator {
    /// Those of the first program of a scene, by this source.
    pub(super) fn of(
        device: &Device,
        scene: &PackedScene,
        grids: &Grids,
        source: &dyn Fn(Variant) -> String,
    ) -> Result<Self, GpuError> {
        let (program, trims) = (scene.programs()[0], scene.trim_method());
        let variant = Variant { parts: PARTS, program, curvature: false, vertex_normals: false, trims };
        let modules = Modules::from([(program, device.module(program, source(variant))?)]);
        let buffers = SceneBuffers::new(device, scene, ShaderStages::COMPUTE, None)?;
        let mut generator = Self::new(device, grids)?;
        generator.prepare(device, &buffers.layouts, &modules)?;
        Ok(generator)
    }

    /// What they choose in these views, with the room that they have.
    pub(super) fn choose(&self, device: &Device, scene: &PackedScene, views: &[View]) -> Result<Chosen, GpuError> {
        const CHOOSING: &str = "choosing levels";
        let buffers = SceneBuffers::new(device, scene, ShaderStages::COMPUTE, None)?;
        buffers.write_views(device, views)?;
        let encoder = device.guarded(CHOOSING, || {
            let mut encoder = device.wgpu.create_command_encoder(&Default::default());
            self.before(&mut encoder, &buffers, 0);
            encoder
        })?;
        device.submit(CHOOSING, encoder)?;
        let mut records: Vec<GridRecord> = vec![Zeroable::zeroed(); self.asked.grids as usize];
        let mut calls: Vec<DrawCall> = vec![Zeroable::zeroed(); self.asked.draws as usize];
        let mut tiles = vec![[0u32; 2]; self.room.capacity as usize];
        let read = |buffer: &wgpu::Buffer, out: &mut [u8]| device.read_buffer(CHOOSING, buffer, 0, out);
        read(&self.buffers.grids, bytemuck::cast_slice_mut(&mut records))?;
        read(&self.buffers.calls, bytemuck::cast_slice_mut(&mut calls))?;
        read(&self.room.tiles, bytemuck::cast_slice_mut(&mut tiles))?;
        Ok(Chosen { records, tiles, calls })
    }

    /// Whether there was too little room, and is enough now.
    pub(super) fn has_grown(&mut self, device: &Device) -> Result<bool, GpuError> {
        let Some(needed) = self.room().map(|room| room.lacking(device)).transpose()?.flatten() else {
            return Ok(false);
        };
        self.make_room(needed);
        *self = self.frame(device)?;
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::{GREATEST_LEVEL, Limits};
    use crate::technique::Setting;
    use glam::DVec3;
    use naga::{Expression, Literal, TypeInner};
    use pipeline::wgsl::source;
    use pipeline::{Scheme, TrimMethod};
    use scene::{Camera, Projection, Viewport};

    #[test]
    fn records_and_constants_are_those_of_the_shader() {
        let variant = Variant {
            parts: PARTS,
            program: Program::Degree(3),
            curvature: false,
            vertex_normals: false,
            trims: TrimMethod::Whole,
        };
        let module = naga::front::wgsl::parse_str(&source(variant)).unwrap();
        let size = |name: &str| {
            let (_, found) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap();
            let TypeInner::Struct { span, .. } = found.inner else { panic!("{name} is no struct") };
            span as usize
        };
        assert_eq!(size("Asked"), size_of::<AskedUniform>());
        assert_eq!(size("DrawCall"), size_of::<DrawCall>());
        assert_eq!(size("GridRecord"), size_of::<GridRecord>());
        assert_eq!(size("Measure"), size_of::<super::super::record::Measure>());
        assert_eq!(size("Tile"), 8);
        let constant = |name: &str| {
            let (_, constant) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name)).unwrap();
            module.global_expressions[constant.init].clone()
        };
        use super::super::levels::{NEAREST_SHARE, ROUNDING, SKIRT_PX, WIDE};
        use super::super::record::OUT;
        use super::super::tiles::GREATEST_SIDE;
        for (name, value) in [
            ("WORKGROUP", WORKGROUP),
            ("GREATEST_LEVEL", GREATEST_LEVEL),
            ("GREATEST_SIDE", GREATEST_SIDE),
            ("OUT", OUT),
            ("SCANNERS", BLOCK / 4),
            ("BUNCH_CORNERS", BUNCH_CORNERS),
            ("EACH", 4),
        ] {
            assert_eq!(constant(name), Expression::Literal(Literal::U32(value)), "{name}");
        }
        for (name, value) in [
            ("WIDE", WIDE),
            ("ROUNDING", ROUNDING),
            ("NEAREST_SHARE", NEAREST_SHARE),
            ("SKIRT_PX", SKIRT_PX),
            ("BEYOND", crate::triangles::BEYOND),
            ("STEEPEST", crate::triangles::STEEPEST),
        ] {
            assert_eq!(constant(name), Expression::Literal(Literal::F32(value)), "{name}");
        }
    }

    /// Levels, tiles and calls of the device are those of the twin, to the bit, whatever the view.
    #[test]
    fn the_device_chooses_the_same_levels_and_tiles() {
        let device = Device::open(Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`");
        let viewport = Viewport::new(96, 72).unwrap();
        let names = ["teapot", "rational", "islands", "spray", "pieces"];
        // At level 1 the error is not kept anywhere near, and skirts are wider.
        let coarse = [("teapot", 1, false), ("islands", 1, false)];
        // Normals at corners ask for least levels.
        let floored = [("teapot", GREATEST_LEVEL, true), ("weights-1000", GREATEST_LEVEL, true), ("torus", 1, true)];
        let fine = names.map(|name| (name, GREATEST_LEVEL, false));
        for (name, level, vertex_normals) in fine.into_iter().chain(coarse).chain(floored) {
            let model = models::builtin(name).unwrap();
            let scene = PackedScene::new(&model, Scheme::Specialised).unwrap();
            let framed = Camera::framing(&model, viewport);
            let near = model.hull().center() + (framed.eye() - model.hull().center()) * 0.3;
            let inside = Camera::look_at(near, model.hull().max, DVec3::Z, Projection::Perspective { fov_deg: 60.0 });
            let flat = Camera::look_at(near, model.hull().center(), DVec3::X, Projection::Orthographic { height: 1.0 });
            let limits = Limits { level, ..Limits::default() };
            let setting = Setting {
                model: &model,
                scene: &scene,
                camera: &framed,
                viewport,
                chord_px: 0.3,
                limits,
                vertex_normals,
            };
            let grids = Grids::new(&setting).unwrap();
            assert_eq!(grids.built_px > 0.3, level == 1, "{name}");
            assert_eq!(grids.measures.iter().any(|measure| measure.floor != 0), vertex_normals, "{name}");
            for camera in [framed, inside.unwrap(), flat.unwrap()] {
                let views = scene.views(&model, &camera, viewport);
                let expected = grids.seen(&scene, &views);
                let mut generator = Generator::of(&device, &scene, &grids, &source).unwrap();
                let Chosen { records, tiles, calls } = loop {
                    let chosen = generator.choose(&device, &scene, &views).unwrap();
                    if !generator.has_grown(&device).unwrap() {
                        break chosen;
                    }
                };
                assert!(records == expected.records, "{name}");
                assert!(expected.tiles.iter().all(|tile| tile.grid < grids.records.len() as u32));
                let mut drawn = vec![];
                for (number, call) in (0..).zip(calls) {
                    assert_eq!(call.instances, call.tiles.div_ceil(bunch_of(number % SIZES)));
                    drawn.extend_from_slice(&tiles[call.start as usize..(call.start + call.tiles) as usize]);
                }
                let expected: Vec<_> = expected.tiles.iter().map(|t| [t.grid, t.at[0] << 16 | t.at[1]]).collect();
                assert!(drawn == expected, "{name}: {} tiles, not {}", drawn.len(), expected.len());
            }
        }
    }
}

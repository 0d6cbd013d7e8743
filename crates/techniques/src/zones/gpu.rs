//! Technique `zones` on the device: kernels that find zones and evaluate their corners, step by step.

use super::plan::{SIDE, Step, Zones};
use crate::grid::CORNER;
use crate::triangles::SAMPLE;
use crate::triangles::gpu::{Draw, Extent, FRAGMENT_STAGE, Feed};
use gpu::groups::{PART_STRIDE, READ, UNIFORM_AT, WRITE, part, whole};
use gpu::{DepthOrder, Device, Drawable, GpuError, Modules, Pass, SceneBuffers, SceneLayouts};
use pipeline::Program;
use pipeline::wgsl::Part;
use std::collections::hash_map::{Entry, HashMap};
use wgpu::{BufferUsages, RenderPass, RenderPipeline, ShaderStages};

/// The technique's name.
pub(super) const NAME: &str = "zones";

/// Kernels `find_zones` and `tessellate`, entry point `vertex`, and those of the fragment stage.
pub(super) const PARTS: &[Part] = &[
    Part { file: "zones/entry.wgsl", text: include_str!("../../../../shaders/zones/entry.wgsl") },
    CORNER,
    FRAGMENT_STAGE,
    SAMPLE,
];

/// Threads of a workgroup in `shaders/zones/entry.wgsl`.
const WORKGROUP: u32 = 64;

/// Corners of a zone: those on its borders are evaluated by each zone that has them.
const CORNERS: u32 = (SIDE + 1) * (SIDE + 1);

/// Bytes of `MadeCorner` there.
const CORNER_BYTES: u64 = 64;

/// Vertices of a zone: two triangles a cell.
const VERTICES: u32 = 6 * SIDE * SIDE;

/// The kernels, in their order.
const KERNELS: [&str; 2] = ["find_zones", "tessellate"];

impl Drawable for Zones {
    fn technique(&self) -> &'static str {
        NAME
    }

    fn parts(&self) -> &'static [Part] {
        PARTS
    }

    fn stages(&self) -> ShaderStages {
        ShaderStages::VERTEX_FRAGMENT | ShaderStages::COMPUTE
    }

    fn pass(&self, device: &Device, scene: &SceneBuffers, depth: DepthOrder) -> Result<Box<dyn Pass>, GpuError> {
        Ok(Box::new(Draw::<Generator>::new(device, scene, self, depth)?))
    }
}

/// What generates the triangles.
#[derive(Clone)]
struct Generator {
    /// Grids, first zones, zones and corners of a step, and the steps.
    buffers: [wgpu::Buffer; 5],
    steps: Vec<Step>,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    drawn_layout: wgpu::BindGroupLayout,
    drawn_group: wgpu::BindGroup,
    /// Made when first needed: a driver may take seconds to compile one.
    kernels: HashMap<Program, [wgpu::ComputePipeline; 2]>,
}

impl Feed for Generator {
    type Prepared = Zones;

    fn new(device: &Device, zones: &Zones) -> Result<Self, GpuError> {
        let most = zones.steps.iter().map(|step| step.zones.len() as u64).max().unwrap_or(1);
        let limit = u64::from(device.limits.max_compute_workgroups_per_dimension);
        device.fits("the zones of a step", "max_compute_workgroups_per_dimension", most, limit)?;
        let grids = device.storage("grids", bytemuck::cast_slice(&zones.grids.picture.records))?;
        let firsts = device.storage("first zones", bytemuck::cast_slice(&zones.firsts))?;
        let found = device.empty("zones", 16 * most)?;
        let made = device.empty("corners of zones", CORNER_BYTES * u64::from(CORNERS) * most)?;
        let mut uniforms = vec![0u32; PART_STRIDE / 4 * zones.steps.len().max(1)];
        for (number, (uniform, step)) in (0..).zip(uniforms.chunks_exact_mut(PART_STRIDE / 4).zip(&zones.steps)) {
            let grids = zones.grids.picture.records.len() as u32;
            uniform[..4].copy_from_slice(&[step.zones.start, step.zones.len() as u32, number, grids]);
        }
        let uniforms = device.buffer("steps", BufferUsages::UNIFORM, bytemuck::cast_slice(&uniforms))?;
        let (layout, group, drawn_layout, drawn_group) = device.guarded("setting up", || {
            let kernels = [READ, READ, WRITE, WRITE, UNIFORM_AT];
            let layout = device.group_layout("zones", ShaderStages::COMPUTE, (0..).zip(kernels));
            let step = part(&uniforms, PART_STRIDE as u64);
            let group = device.group("zones", &layout, whole([&grids, &firsts, &found, &made]).chain([(4, step)]));
            let drawn_layout = device.group_layout("corners", ShaderStages::VERTEX, [(0, READ)]);
            let drawn_group = device.group("corners", &drawn_layout, whole([&made]));
            (layout, group, drawn_layout, drawn_group)
        })?;
        let (steps, kernels) = (zones.steps.clone(), HashMap::new());
        let buffers = [grids, firsts, found, made, uniforms];
        Ok(Self { buffers, steps, layout, group, drawn_layout, drawn_group, kernels })
    }

    fn layouts(&self) -> Vec<Option<&wgpu::BindGroupLayout>> {
        vec![None, Some(&self.drawn_layout)]
    }

    fn prepare(&mut self, device: &Device, scene: &SceneLayouts, modules: &Modules) -> Result<(), GpuError> {
        let layout = device
            .guarded("setting up", || device.pipeline_layout("zones", &[Some(&scene.scene), Some(&self.layout)]))?;
        for (&program, module) in modules {
            if let Entry::Vacant(vacant) = self.kernels.entry(program) {
                let compile = |kernel| device.kernel(&layout, (program, module), kernel, &[]);
                let [find, tessellate] = KERNELS;
                vacant.insert([compile(find)?, compile(tessellate)?]);
            }
        }
        Ok(())
    }

    fn bytes(&self) -> u64 {
        self.buffers.iter().map(wgpu::Buffer::size).sum()
    }

    fn steps(&self) -> usize {
        self.steps.len()
    }

    fn before(&self, encoder: &mut wgpu::CommandEncoder, scene: &SceneBuffers, step: usize) {
        // A picture of nothing has no step.
        let Some(Step { program, zones }) = self.steps.get(step) else { return };
        let Some([find, tessellate]) = self.kernels.get(program) else { return };
        let count = zones.len() as u32;
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_bind_group(0, &scene.group, &[]);
        pass.set_bind_group(1, &self.group, &[(step * PART_STRIDE) as u32]);
        pass.set_pipeline(find);
        pass.dispatch_workgroups(count.div_ceil(WORKGROUP), 1, 1);
        pass.set_pipeline(tessellate);
        pass.dispatch_workgroups(count, 1, 1);
    }

    fn draw<'p>(
        &self,
        pass: &mut RenderPass<'_>,
        pipeline: &dyn Fn(Program) -> Option<&'p RenderPipeline>,
        _extent: Extent,
        step: usize,
    ) {
        let Some(Step { program, zones }) = self.steps.get(step) else { return };
        if let Some(pipeline) = pipeline(*program) {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(2, &self.drawn_group, &[]);
            pass.draw(0..VERTICES, 0..zones.len() as u32);
        }
    }

    /// All of them where others are drawn.
    fn write_changes(&mut self, device: &Device, before: &Zones, after: &Zones) -> Result<u64, GpuError> {
        if before.firsts != after.firsts || before.steps != after.steps {
            let kernels = std::mem::take(&mut self.kernels);
            *self = Self { kernels, ..Self::new(device, after)? };
            return Ok((size_of_val(&after.grids.picture.records[..]) + size_of_val(&after.firsts[..])) as u64);
        }
        let [old, new] = [before, after].map(|zones| bytemuck::cast_slice(&zones.grids.picture.records));
        device.write_changes("grids", &self.buffers[0], old, new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::{Expression, Literal, TypeInner};
    use pipeline::TrimMethod;
    use pipeline::wgsl::{Variant, source};

    #[test]
    fn sides_and_corners_are_those_of_the_shader() {
        let variant = Variant {
            parts: PARTS,
            program: Program::Degree(3),
            curvature: false,
            vertex_normals: false,
            trims: TrimMethod::Whole,
        };
        let module = naga::front::wgsl::parse_str(&source(variant)).unwrap();
        for (name, value) in [("SIDE", SIDE), ("WORKGROUP", WORKGROUP)] {
            let (_, constant) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name)).unwrap();
            assert_eq!(module.global_expressions[constant.init], Expression::Literal(Literal::U32(value)), "{name}");
        }
        let (_, corner) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("MadeCorner")).unwrap();
        let TypeInner::Struct { span, .. } = corner.inner else { panic!("no struct") };
        assert_eq!(u64::from(span), CORNER_BYTES);
    }
}

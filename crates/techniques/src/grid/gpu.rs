//! Technique `grid` on the device: records of grids, which the vertex stage evaluates.

use super::grids::{Class, Grids};
use crate::triangles::gpu::{Draw, Feed, PART};
use gpu::{DepthOrder, Device, Drawable, GpuError, Pass, SceneBuffers};
use pipeline::Program;
use pipeline::wgsl::Part;
use wgpu::{RenderPass, RenderPipeline, ShaderStages};

/// The technique's name.
pub(super) const NAME: &str = "grid";

/// Entry point `vertex`, and those of the fragment stage.
pub(super) const PARTS: &[Part] =
    &[Part { file: "grid/entry.wgsl", text: include_str!("../../../../shaders/grid/entry.wgsl") }, CORNER, PART];

/// Where a corner of a grid is.
pub const CORNER: Part = Part { file: "grid/corner.wgsl", text: include_str!("../../../../shaders/grid/corner.wgsl") };

/// Vertices of a cell: two triangles.
const CELL: u32 = 6;

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
        Ok(Box::new(Draw::<Records>::new(device, scene, self, depth)?))
    }
}

/// The records on the device.
#[derive(Clone)]
struct Records {
    records: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    classes: Vec<Class>,
}

impl Feed for Records {
    type Prepared = Grids;

    fn new(device: &Device, grids: &Grids) -> Result<Self, GpuError> {
        let records = device.storage("grids", bytemuck::cast_slice(&grids.records))?;
        let (layout, group) = device.guarded("setting up", || {
            let layout = device.wgpu.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("grids"),
                entries: &[wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: ShaderStages::VERTEX,
                    ty: wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Storage { read_only: true },
                        has_dynamic_offset: false,
                        min_binding_size: None,
                    },
                    count: None,
                }],
            });
            let group = device.group("grids", &layout, [&records]);
            (layout, group)
        })?;
        Ok(Self { records, layout, group, classes: grids.classes.clone() })
    }

    fn layouts(&self) -> Vec<Option<&wgpu::BindGroupLayout>> {
        vec![Some(&self.layout)]
    }

    fn draw<'p>(
        &self,
        pass: &mut RenderPass<'_>,
        pipeline: &dyn Fn(Program) -> Option<&'p RenderPipeline>,
        _step: usize,
    ) {
        pass.set_bind_group(1, &self.group, &[]);
        for Class { program, cells: [rows, columns], grids } in &self.classes {
            if let Some(pipeline) = pipeline(*program) {
                pass.set_pipeline(pipeline);
                pass.draw(0..CELL * rows * columns, grids.clone());
            }
        }
    }

    fn write_changes(&mut self, device: &Device, before: &Grids, after: &Grids) -> Result<u64, GpuError> {
        let [old, new] = [before, after].map(|grids| bytemuck::cast_slice(&grids.records));
        device.write_changes("grids", &self.records, old, new)
    }
}

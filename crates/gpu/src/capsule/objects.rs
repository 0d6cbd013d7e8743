//! What a capsule has, on a device of wgpu.

use super::commands::Range;
use super::document::{
    Binding, Buffer, BufferKind, ComputePipeline, Group, GroupEntry, GroupLayout, LayoutEntry, Module, RenderPipeline,
    Resource, SampleType, Stage, Target, Texture, VertexBuffer,
};
use super::error::CapsuleError;
use super::folder::Contents;
use crate::Device;
use wgpu::{BufferUsages, ShaderStages, TextureUsages};

const MAKING: &str = "making what a capsule has";

/// What a capsule has, on a device.
pub(super) struct Objects<'a> {
    pub(super) device: &'a Device,
    pub(super) contents: &'a Contents,
    buffers: Vec<wgpu::Buffer>,
    textures: Vec<(wgpu::Texture, wgpu::TextureView)>,
    pub(super) groups: Vec<wgpu::BindGroup>,
    pub(super) compute: Vec<wgpu::ComputePipeline>,
    pub(super) render: Vec<wgpu::RenderPipeline>,
}

/// The object of that number.
pub(super) fn at<'a, T>(all: &'a [T], kind: &'static str, index: usize) -> Result<&'a T, CapsuleError> {
    let missing = CapsuleError::NoSuch { kind, index: index as u64, count: all.len() as u64 };
    all.get(index).ok_or(missing)
}

/// Bits that WebGPU has for them.
fn bits<T>(what: &'static str, bits: u32, found: Option<T>) -> Result<T, CapsuleError> {
    found.ok_or_else(|| CapsuleError::Malformed { what, reason: format!("no use has the bits {bits:#x}") })
}

impl<'a> Objects<'a> {
    pub(super) fn new(device: &'a Device, contents: &'a Contents) -> Result<Self, CapsuleError> {
        let capsule = contents.capsule();
        let mut objects = Self {
            device,
            contents,
            buffers: vec![],
            textures: vec![],
            groups: vec![],
            compute: vec![],
            render: vec![],
        };
        for buffer in &capsule.buffers {
            objects.buffers.push(objects.buffer(buffer)?);
        }
        for texture in &capsule.textures {
            objects.textures.push(objects.texture(texture)?);
        }
        let mut group_layouts = vec![];
        for layout in &capsule.group_layouts {
            group_layouts.push(objects.group_layout(layout)?);
        }
        for group in &capsule.groups {
            objects.groups.push(objects.group(group, &group_layouts)?);
        }
        let mut layouts = vec![];
        for groups in &capsule.pipeline_layouts {
            let of = |group: &Option<usize>| group.map(|g| at(&group_layouts, "group layout", g)).transpose();
            let groups: Vec<_> = groups.iter().map(of).collect::<Result<_, _>>()?;
            layouts.push(device.guarded(MAKING, || device.pipeline_layout("capsule", &groups))?);
        }
        let mut modules = vec![];
        for Module { file } in &capsule.modules {
            modules.push(objects.module(file)?);
        }
        for pipeline in &capsule.compute_pipelines {
            objects.compute.push(objects.compute_pipeline(pipeline, &layouts, &modules)?);
        }
        for pipeline in &capsule.render_pipelines {
            objects.render.push(objects.render_pipeline(pipeline, &layouts, &modules)?);
        }
        Ok(objects)
    }

    fn buffer(&self, buffer: &Buffer) -> Result<wgpu::Buffer, CapsuleError> {
        let usage = bits("a buffer", buffer.usage, BufferUsages::from_bits(buffer.usage))?;
        let limits = &self.device.limits;
        self.device.fits("a buffer of the capsule", "max_buffer_size", buffer.size, limits.max_buffer_size)?;
        let descriptor =
            wgpu::BufferDescriptor { label: Some(&buffer.label), size: buffer.size, usage, mapped_at_creation: false };
        Ok(self.device.guarded(MAKING, || self.device.wgpu.create_buffer(&descriptor))?)
    }

    fn texture(&self, texture: &Texture) -> Result<(wgpu::Texture, wgpu::TextureView), CapsuleError> {
        let usage = bits("a texture", texture.usage, TextureUsages::from_bits(texture.usage))?;
        let most = u64::from(texture.width.max(texture.height));
        let limit = u64::from(self.device.limits.max_texture_dimension_2d);
        self.device.fits("a texture of the capsule", "max_texture_dimension_2d", most, limit)?;
        let descriptor = wgpu::TextureDescriptor {
            label: Some(texture.label.as_str()),
            size: wgpu::Extent3d { width: texture.width, height: texture.height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: texture.format,
            usage,
            view_formats: &[],
        };
        Ok(self.device.guarded(MAKING, || {
            let texture = self.device.wgpu.create_texture(&descriptor);
            let view = texture.create_view(&Default::default());
            (texture, view)
        })?)
    }

    fn group_layout(&self, layout: &GroupLayout) -> Result<wgpu::BindGroupLayout, CapsuleError> {
        let entry = |entry: &LayoutEntry| {
            let visibility = ShaderStages::from_bits(entry.visibility);
            let visibility = bits("a binding", entry.visibility, visibility)?;
            let ty = match &entry.resource {
                Binding::Buffer { kind, has_dynamic_offset } => wgpu::BindingType::Buffer {
                    ty: match kind {
                        BufferKind::Uniform => wgpu::BufferBindingType::Uniform,
                        BufferKind::Storage => wgpu::BufferBindingType::Storage { read_only: false },
                        BufferKind::ReadOnlyStorage => wgpu::BufferBindingType::Storage { read_only: true },
                    },
                    has_dynamic_offset: *has_dynamic_offset,
                    min_binding_size: None,
                },
                Binding::Texture { sample_type: SampleType::UnfilterableFloat, view_dimension } => {
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: false },
                        view_dimension: *view_dimension,
                        multisampled: false,
                    }
                }
                Binding::StorageTexture { access, format, view_dimension } => wgpu::BindingType::StorageTexture {
                    access: *access,
                    format: *format,
                    view_dimension: *view_dimension,
                },
            };
            Ok(wgpu::BindGroupLayoutEntry { binding: entry.binding, visibility, ty, count: None })
        };
        let entries: Vec<_> = layout.entries.iter().map(entry).collect::<Result<_, CapsuleError>>()?;
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        Ok(self.device.guarded(MAKING, || self.device.wgpu.create_bind_group_layout(&descriptor))?)
    }

    fn group(&self, group: &Group, layouts: &[wgpu::BindGroupLayout]) -> Result<wgpu::BindGroup, CapsuleError> {
        let entry = |entry: &GroupEntry| {
            let resource = match &entry.resource {
                Resource::Buffer(range) => {
                    let buffer = self.range(range)?;
                    let size = wgpu::BufferSize::new(range.size);
                    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: range.offset, size })
                }
                Resource::Texture(index) => wgpu::BindingResource::TextureView(&self.view(*index)?.1),
            };
            Ok((entry.binding, resource))
        };
        let entries: Vec<_> = group.entries.iter().map(entry).collect::<Result<_, CapsuleError>>()?;
        let layout = at(layouts, "group layout", group.layout)?;
        Ok(self.device.guarded(MAKING, || self.device.group("capsule", layout, entries))?)
    }

    fn module(&self, file: &str) -> Result<wgpu::ShaderModule, CapsuleError> {
        let malformed =
            |error: std::str::Utf8Error| CapsuleError::Malformed { what: "a shader", reason: error.to_string() };
        let source = str::from_utf8(self.contents.file(file)?).map_err(malformed)?;
        let descriptor = wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl(source.into()) };
        Ok(self.device.guarded("reading a shader", || self.device.wgpu.create_shader_module(descriptor))?)
    }

    fn compute_pipeline(
        &self,
        pipeline: &ComputePipeline,
        layouts: &[wgpu::PipelineLayout],
        modules: &[wgpu::ShaderModule],
    ) -> Result<wgpu::ComputePipeline, CapsuleError> {
        let stage = &pipeline.compute;
        let constants = constants(stage);
        let descriptor = wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(at(layouts, "pipeline layout", pipeline.layout)?),
            module: at(modules, "module", stage.module)?,
            entry_point: Some(&stage.entry_point),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
            cache: None,
        };
        Ok(self.device.guarded(MAKING, || self.device.wgpu.create_compute_pipeline(&descriptor))?)
    }

    fn render_pipeline(
        &self,
        pipeline: &RenderPipeline,
        layouts: &[wgpu::PipelineLayout],
        modules: &[wgpu::ShaderModule],
    ) -> Result<wgpu::RenderPipeline, CapsuleError> {
        let RenderPipeline { layout, vertex, buffers, fragment, targets, depth } = pipeline;
        let [of_vertex, of_fragment] = [vertex, fragment].map(constants);
        let buffers: Vec<_> = buffers.iter().map(vertices).collect();
        let target = |Target { format, blend, write_mask }: &Target| {
            let write_mask = bits("a target", *write_mask, wgpu::ColorWrites::from_bits(*write_mask))?;
            Ok(Some(wgpu::ColorTargetState { format: *format, blend: *blend, write_mask }))
        };
        let targets: Vec<_> = targets.iter().map(target).collect::<Result<_, CapsuleError>>()?;
        let descriptor = wgpu::RenderPipelineDescriptor {
            label: None,
            layout: Some(at(layouts, "pipeline layout", *layout)?),
            vertex: wgpu::VertexState {
                module: at(modules, "module", vertex.module)?,
                entry_point: Some(&vertex.entry_point),
                compilation_options: wgpu::PipelineCompilationOptions { constants: &of_vertex, ..Default::default() },
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: depth.as_ref().map(|depth| wgpu::DepthStencilState {
                format: depth.format,
                depth_write_enabled: Some(depth.depth_write_enabled),
                depth_compare: Some(depth.depth_compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: at(modules, "module", fragment.module)?,
                entry_point: Some(&fragment.entry_point),
                compilation_options: wgpu::PipelineCompilationOptions { constants: &of_fragment, ..Default::default() },
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        };
        Ok(self.device.guarded(MAKING, || self.device.wgpu.create_render_pipeline(&descriptor))?)
    }

    /// The buffer of a range that lies in it.
    pub(super) fn range(&self, range: &Range) -> Result<&wgpu::Buffer, CapsuleError> {
        let buffer = at(&self.buffers, "buffer", range.buffer)?;
        let (offset, size, end) = (range.offset, buffer.size(), u128::from(range.offset) + u128::from(range.size));
        if range.size == 0 {
            return Err(CapsuleError::Malformed { what: "a part of a buffer", reason: "it has no bytes".to_owned() });
        }
        if end > u128::from(size) { Err(CapsuleError::Beyond { offset, end, size }) } else { Ok(buffer) }
    }

    pub(super) fn slice(&self, range: &Range) -> Result<wgpu::BufferSlice<'_>, CapsuleError> {
        Ok(self.range(range)?.slice(range.offset..range.offset + range.size))
    }

    pub(super) fn view(&self, texture: usize) -> Result<&(wgpu::Texture, wgpu::TextureView), CapsuleError> {
        at(&self.textures, "texture", texture)
    }
}

/// The values of a stage's `override`s, as wgpu takes them.
fn constants(stage: &Stage) -> Vec<(&str, f64)> {
    stage.constants.iter().map(|(name, value)| (name.as_str(), *value)).collect()
}

fn vertices(buffer: &VertexBuffer) -> Option<wgpu::VertexBufferLayout<'_>> {
    let VertexBuffer { array_stride, step_mode, attributes } = buffer;
    Some(wgpu::VertexBufferLayout { array_stride: *array_stride, step_mode: *step_mode, attributes })
}

//! wgpu's descriptors of objects, as a capsule has them.

use super::document::{
    Binding, Buffer, BufferKind, Depth, GroupLayout, LayoutEntry, RenderPipeline, SampleType, Stage, Target, Texture,
    VertexBuffer,
};
use super::error::CapsuleError;
use super::table::{Names, Table, unsupported};
use wgpu::wgc::device::trace::TraceGeneralRenderPipelineDescriptor;
use wgpu::wgc::id::{PointerId, markers};
use wgpu::wgc::pipeline::{ProgrammableStageDescriptor, RenderPipelineVertexProcessor};
use wgpu::wgc::resource::{BufferDescriptor, TextureDescriptor};
use wgpu::{BindGroupLayoutEntry, BindingType, BufferBindingType, TextureSampleType};

/// A buffer.
pub(super) fn buffer(label: String, descriptor: &BufferDescriptor<'_>) -> Buffer {
    Buffer { label, size: descriptor.size, usage: descriptor.usage.bits() }
}

/// A texture of two dimensions, one level and one sample.
pub(super) fn texture(descriptor: &TextureDescriptor<'_>) -> Result<Texture, CapsuleError> {
    let TextureDescriptor { label, size, mip_level_count, sample_count, dimension, format, usage, view_formats } =
        descriptor;
    let plain = (*mip_level_count, *sample_count, size.depth_or_array_layers) == (1, 1, 1);
    if !plain || *dimension != wgpu::TextureDimension::D2 || !view_formats.is_empty() {
        return Err(unsupported("a texture of several levels, samples or layers"));
    }
    Ok(Texture {
        label: label.as_deref().unwrap_or_default().to_owned(),
        format: *format,
        width: size.width,
        height: size.height,
        usage: usage.bits(),
    })
}

/// The layout of a group.
pub(super) fn group_layout(entries: &[BindGroupLayoutEntry]) -> Result<GroupLayout, CapsuleError> {
    let entry = |entry: &BindGroupLayoutEntry| {
        let resource = match entry.ty {
            BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None } => Binding::Buffer {
                kind: match ty {
                    BufferBindingType::Uniform => BufferKind::Uniform,
                    BufferBindingType::Storage { read_only: false } => BufferKind::Storage,
                    BufferBindingType::Storage { read_only: true } => BufferKind::ReadOnlyStorage,
                },
                has_dynamic_offset,
            },
            BindingType::Texture {
                sample_type: TextureSampleType::Float { filterable: false },
                view_dimension,
                multisampled: false,
            } => Binding::Texture { sample_type: SampleType::UnfilterableFloat, view_dimension },
            BindingType::StorageTexture { access, format, view_dimension } => {
                Binding::StorageTexture { access, format, view_dimension }
            }
            other => return Err(unsupported(format!("a binding of type {other:?}"))),
        };
        if entry.count.is_some() {
            return Err(unsupported("an array of bindings"));
        }
        Ok(LayoutEntry { binding: entry.binding, visibility: entry.visibility.bits(), resource })
    };
    Ok(GroupLayout { entries: entries.iter().map(entry).collect::<Result<_, _>>()? })
}

/// A stage of a pipeline.
pub(super) fn stage(
    stage: &ProgrammableStageDescriptor<'_, PointerId<markers::ShaderModule>>,
    modules: &Names<markers::ShaderModule>,
) -> Result<Stage, CapsuleError> {
    let entry_point = stage.entry_point.as_deref().ok_or_else(|| unsupported("a stage without an entry point"))?;
    let constants = stage.constants.iter().map(|(name, value)| (name.clone(), *value)).collect();
    Ok(Stage { module: modules.get(stage.module)?, entry_point: entry_point.to_owned(), constants })
}

/// A render pipeline of triangle lists.
pub(super) fn render_pipeline(
    descriptor: &TraceGeneralRenderPipelineDescriptor<'_>,
    table: &Table,
) -> Result<RenderPipeline, CapsuleError> {
    let RenderPipelineVertexProcessor::Vertex(vertex) = &descriptor.vertex else {
        return Err(unsupported("mesh shaders"));
    };
    let plain = descriptor.primitive == Default::default() && descriptor.multisample == Default::default();
    let (Some(layout), Some(fragment), true) = (descriptor.layout, &descriptor.fragment, plain) else {
        return Err(unsupported("a pipeline that is more than a list of triangles, or less"));
    };
    let buffer = |buffer: &Option<wgpu::wgc::pipeline::VertexBufferLayout<'_>>| {
        let buffer = buffer.as_ref().ok_or_else(|| unsupported("a slot without vertices"))?;
        Ok(VertexBuffer {
            array_stride: buffer.array_stride,
            step_mode: buffer.step_mode,
            attributes: buffer.attributes.to_vec(),
        })
    };
    let target = |target: &Option<wgpu::ColorTargetState>| {
        let target = target.as_ref().ok_or_else(|| unsupported("a target that is none"))?;
        Ok(Target { format: target.format, blend: target.blend, write_mask: target.write_mask.bits() })
    };
    let depth = |state: &wgpu::DepthStencilState| {
        let (Some(depth_write_enabled), Some(depth_compare)) = (state.depth_write_enabled, state.depth_compare) else {
            return Err(unsupported("a depth test that is none"));
        };
        if state.stencil != Default::default() || state.bias != Default::default() {
            return Err(unsupported("a stencil or a bias of depths"));
        }
        Ok(Depth { format: state.format, depth_write_enabled, depth_compare })
    };
    Ok(RenderPipeline {
        layout: table.pipeline_layouts.get(layout)?,
        vertex: stage(&vertex.stage, &table.modules)?,
        buffers: vertex.buffers.iter().map(buffer).collect::<Result<_, CapsuleError>>()?,
        fragment: stage(&fragment.stage, &table.modules)?,
        targets: fragment.targets.iter().map(target).collect::<Result<_, CapsuleError>>()?,
        depth: descriptor.depth_stencil.as_ref().map(depth).transpose()?,
    })
}

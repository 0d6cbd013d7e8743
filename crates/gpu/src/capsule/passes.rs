//! The passes of wgpu's trace, as a capsule has them.

use super::commands::{Attachment, Command, ComputeStep, DepthAttachment, Range, RenderStep, SetGroup};
use super::document::Buffer;
use super::error::CapsuleError;
use super::table::{Table, unsupported};
use std::convert::Infallible;
use wgpu::wgc::command::{
    BasePass, ColorAttachments, ComputeCommand, LoadOp, PointerReferences, RenderCommand, ResolvedPassChannel,
    ResolvedRenderPassDepthStencilAttachment, StoreOp,
};
use wgpu::wgc::id::{PointerId, markers};

type View = PointerId<markers::TextureView>;

/// The dynamic offsets of a pass, taken group by group.
struct Offsets<'p>(&'p [u32]);

impl Offsets<'_> {
    fn take(&mut self, count: usize) -> Result<Vec<u32>, CapsuleError> {
        let taken = self.0.split_off(..count).ok_or_else(|| unsupported("a group without its offsets"))?;
        Ok(taken.to_vec())
    }
}

/// What is done in a compute pass.
pub(super) fn compute_steps(
    pass: &BasePass<ComputeCommand<PointerReferences>, Infallible>,
    table: &Table,
) -> Result<Vec<ComputeStep>, CapsuleError> {
    let mut offsets = Offsets(&pass.dynamic_offsets);
    let step = |command: &ComputeCommand<PointerReferences>| {
        Ok(match command {
            ComputeCommand::SetPipeline(id) => ComputeStep::Pipeline(table.compute.get(*id)?),
            ComputeCommand::SetBindGroup { index, num_dynamic_offsets, bind_group: Some(id) } => {
                let offsets = offsets.take(*num_dynamic_offsets)?;
                ComputeStep::Group(SetGroup { index: *index, group: table.groups.get(*id)?, offsets })
            }
            ComputeCommand::DispatchWorkgroups(groups) => ComputeStep::Dispatch(*groups),
            other => return Err(unsupported(format!("{other:?}"))),
        })
    };
    pass.commands.iter().map(step).collect()
}

/// A render pass.
pub(super) fn render(
    pass: &BasePass<RenderCommand<PointerReferences>, Infallible>,
    colors: &ColorAttachments<View>,
    depth: &Option<ResolvedRenderPassDepthStencilAttachment<View>>,
    table: &Table,
    buffers: &[Buffer],
) -> Result<Command, CapsuleError> {
    let color = |color: &Option<wgpu::wgc::command::RenderPassColorAttachment<View>>| {
        let color = color.as_ref().ok_or_else(|| unsupported("an attachment that is none"))?;
        if color.depth_slice.is_some() || color.resolve_target.is_some() || color.store_op != StoreOp::Store {
            return Err(unsupported("an attachment that is resolved or not stored"));
        }
        Ok(Attachment { texture: table.views.get(color.view)?, clear: cleared(&color.load_op)? })
    };
    let attached = |depth: &ResolvedRenderPassDepthStencilAttachment<View>| {
        let ResolvedPassChannel::Operational(operations) = &depth.depth else {
            return Err(unsupported("a depth buffer that is only read"));
        };
        let store = operations.store == StoreOp::Store;
        Ok(DepthAttachment { texture: table.views.get(depth.view)?, clear: cleared(&operations.load)?, store })
    };
    Ok(Command::Render {
        colors: colors.iter().map(color).collect::<Result<_, CapsuleError>>()?,
        depth: depth.as_ref().map(attached).transpose()?,
        steps: steps(pass, table, buffers)?,
    })
}

/// What an attachment is cleared to; `None` where it is kept.
fn cleared<V: Copy>(load: &LoadOp<V>) -> Result<Option<V>, CapsuleError> {
    match load {
        LoadOp::Clear(value) => Ok(Some(*value)),
        LoadOp::Load => Ok(None),
        LoadOp::DontCare(_) => Err(unsupported("an attachment of any content")),
    }
}

fn steps(
    pass: &BasePass<RenderCommand<PointerReferences>, Infallible>,
    table: &Table,
    buffers: &[Buffer],
) -> Result<Vec<RenderStep>, CapsuleError> {
    let mut offsets = Offsets(&pass.dynamic_offsets);
    let range = |id, offset: u64, size: Option<wgpu::BufferSize>| {
        let buffer = table.buffers.get(id)?;
        let rest = buffers[buffer].size - offset;
        Ok::<_, CapsuleError>(Range { buffer, offset, size: size.map_or(rest, wgpu::BufferSize::get) })
    };
    let step = |command: &RenderCommand<PointerReferences>| {
        Ok(match command {
            RenderCommand::SetPipeline(id) => RenderStep::Pipeline(table.render.get(*id)?),
            RenderCommand::SetBindGroup { index, num_dynamic_offsets, bind_group: Some(id) } => {
                let offsets = offsets.take(*num_dynamic_offsets)?;
                RenderStep::Group(SetGroup { index: *index, group: table.groups.get(*id)?, offsets })
            }
            RenderCommand::SetViewport { rect, depth_min, depth_max } => {
                RenderStep::Viewport([rect.x, rect.y, rect.w, rect.h, *depth_min, *depth_max])
            }
            RenderCommand::SetVertexBuffer { slot, buffer: Some(id), offset, size } => {
                RenderStep::VertexBuffer { slot: *slot, range: range(*id, *offset, *size)? }
            }
            RenderCommand::SetIndexBuffer { buffer, index_format, offset, size } => {
                RenderStep::IndexBuffer { format: *index_format, range: range(*buffer, *offset, *size)? }
            }
            RenderCommand::Draw { vertex_count, instance_count, first_vertex, first_instance } => {
                RenderStep::Draw([*vertex_count, *instance_count, *first_vertex, *first_instance])
            }
            RenderCommand::DrawIndexed { index_count, instance_count, first_index, base_vertex, first_instance } => {
                RenderStep::DrawIndexed([
                    (*index_count).into(),
                    (*instance_count).into(),
                    (*first_index).into(),
                    (*base_vertex).into(),
                    (*first_instance).into(),
                ])
            }
            RenderCommand::DrawIndirect { buffer, offset, count: 1, family, .. }
                if *family == wgpu::wgc::command::DrawCommandFamily::DrawIndexed =>
            {
                RenderStep::DrawIndexedIndirect { buffer: table.buffers.get(*buffer)?, offset: *offset }
            }
            other => return Err(unsupported(format!("{other:?}"))),
        })
    };
    pass.commands.iter().map(step).collect()
}

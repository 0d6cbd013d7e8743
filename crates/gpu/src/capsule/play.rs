//! wgpu as a host: what a capsule says is made and done, and what it asks for is handed back.
//!
//! A capsule may be of any origin. What it names must be there and ranges must lie in their buffers; the rest is checked by
//! wgpu, whose refusal is an error like any other.

use super::commands::{Attachment, Command, ComputeStep, DepthAttachment, Range, RenderStep, SetGroup};
use super::document::{Host, Read, Resource};
use super::error::CapsuleError;
use super::folder::{Contents, Files, Played};
use super::objects::{Objects, at};
use crate::Device;
use crate::device::COMPILER;

/// Bytes of an indirect call.
const INDIRECT_BYTES: u64 = 20;

const PLAYING: &str = "playing a capsule";

/// Plays a capsule on the adapter whose name contains `adapter`, or on the best one.
///
/// # Errors
/// As [`Device::open`]; [`CapsuleError::Gpu`] where the device refuses, and [`CapsuleError::NoSuch`],
/// [`CapsuleError::NoFile`], [`CapsuleError::Beyond`], [`CapsuleError::Malformed`] where the capsule contradicts itself.
pub fn play(contents: &Contents, adapter: Option<&str>) -> Result<Played, CapsuleError> {
    let device = Device::for_foreign(adapter)?;
    let files = Objects::new(&device, contents)?.played()?;
    let info = device.info();
    let host = Host {
        adapter: info.name.clone(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        backend: info.backend.clone(),
        compiler: COMPILER.to_owned(),
    };
    Ok(Played::new(contents, host, files))
}

impl Objects<'_> {
    /// Does all that is to be done, and reads all that is to be read.
    fn played(&self) -> Result<Files, CapsuleError> {
        for command in &self.contents.capsule().commands {
            self.command(command)?;
        }
        let mut files = Files::new();
        for Read { name, of } in &self.contents.capsule().reads {
            let bytes = match of {
                Resource::Texture(index) => self.device.texels(PLAYING, &self.view(*index)?.0)?,
                Resource::Buffer(range) => {
                    let buffer = self.range(range)?;
                    // Allocated only after the range is known to lie in a buffer that the device has.
                    let mut bytes = vec![0; range.size as usize];
                    self.device.read_buffer(PLAYING, buffer, range.offset, &mut bytes)?;
                    bytes
                }
            };
            files.insert(format!("{name}.bin"), bytes);
        }
        Ok(files)
    }

    fn command(&self, command: &Command) -> Result<(), CapsuleError> {
        let encoder = || self.device.wgpu.create_command_encoder(&Default::default());
        let submit = |encoder| self.device.submit(PLAYING, encoder).map(|_| ());
        match command {
            Command::Write { buffer, offset, file } => {
                let bytes = self.contents.file(file)?;
                let buffer = self.range(&Range { buffer: *buffer, offset: *offset, size: bytes.len() as u64 })?;
                self.device.guarded(PLAYING, || self.device.queue.write_buffer(buffer, *offset, bytes))?;
            }
            Command::Clear(range) => {
                let buffer = self.range(range)?;
                let mut encoder = encoder();
                self.device.guarded(PLAYING, || encoder.clear_buffer(buffer, range.offset, Some(range.size)))?;
                submit(encoder)?;
            }
            Command::Compute { steps } => {
                let mut encoder = encoder();
                self.device.guarded(PLAYING, || self.compute(&mut encoder, steps))??;
                submit(encoder)?;
            }
            Command::Render { colors, depth, steps } => {
                let mut encoder = encoder();
                self.device.guarded(PLAYING, || self.render(&mut encoder, colors, depth.as_ref(), steps))??;
                submit(encoder)?;
            }
        }
        Ok(())
    }

    fn compute(&self, encoder: &mut wgpu::CommandEncoder, steps: &[ComputeStep]) -> Result<(), CapsuleError> {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for step in steps {
            match step {
                ComputeStep::Pipeline(index) => pass.set_pipeline(at(&self.compute, "compute pipeline", *index)?),
                ComputeStep::Group(SetGroup { index, group, offsets }) => {
                    pass.set_bind_group(*index, at(&self.groups, "group", *group)?, offsets);
                }
                ComputeStep::Dispatch([x, y, z]) => pass.dispatch_workgroups(*x, *y, *z),
            }
        }
        Ok(())
    }

    fn render(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        colors: &[Attachment],
        depth: Option<&DepthAttachment>,
        steps: &[RenderStep],
    ) -> Result<(), CapsuleError> {
        let color = |Attachment { texture, clear }: &Attachment| {
            Ok(Some(wgpu::RenderPassColorAttachment {
                view: &self.view(*texture)?.1,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear),
                    store: wgpu::StoreOp::Store,
                },
            }))
        };
        let colors: Vec<_> = colors.iter().map(color).collect::<Result<_, CapsuleError>>()?;
        let attached = |DepthAttachment { texture, clear, store }: &DepthAttachment| {
            Ok::<_, CapsuleError>(wgpu::RenderPassDepthStencilAttachment {
                view: &self.view(*texture)?.1,
                depth_ops: Some(wgpu::Operations {
                    load: clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear),
                    store: if *store { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard },
                }),
                stencil_ops: None,
            })
        };
        let depth_stencil_attachment = depth.map(attached).transpose()?;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &colors,
            depth_stencil_attachment,
            ..Default::default()
        });
        steps.iter().try_for_each(|step| self.render_step(&mut pass, step))
    }

    fn render_step(&self, pass: &mut wgpu::RenderPass<'_>, step: &RenderStep) -> Result<(), CapsuleError> {
        match step {
            RenderStep::Pipeline(index) => pass.set_pipeline(at(&self.render, "render pipeline", *index)?),
            RenderStep::Group(SetGroup { index, group, offsets }) => {
                pass.set_bind_group(*index, at(&self.groups, "group", *group)?, offsets);
            }
            RenderStep::Viewport([x, y, width, height, least, greatest]) => {
                pass.set_viewport(*x, *y, *width, *height, *least, *greatest);
            }
            RenderStep::VertexBuffer { slot, range } => pass.set_vertex_buffer(*slot, self.slice(range)?),
            RenderStep::IndexBuffer { format, range } => pass.set_index_buffer(self.slice(range)?, *format),
            RenderStep::Draw([vertices, instances, vertex, instance]) => {
                pass.draw(span(*vertex, *vertices)?, span(*instance, *instances)?);
            }
            RenderStep::DrawIndexed(call) => {
                let number = |k: usize| u32::try_from(call[k]).map_err(|_| counts(call));
                let base = i32::try_from(call[3]).map_err(|_| counts(call))?;
                pass.draw_indexed(span(number(2)?, number(0)?)?, base, span(number(4)?, number(1)?)?);
            }
            RenderStep::DrawIndexedIndirect { buffer, offset } => {
                let call = Range { buffer: *buffer, offset: *offset, size: INDIRECT_BYTES };
                pass.draw_indexed_indirect(self.range(&call)?, *offset);
            }
        }
        Ok(())
    }
}

/// The numbers from `first` on, so many.
fn span(first: u32, count: u32) -> Result<std::ops::Range<u32>, CapsuleError> {
    let end = first.checked_add(count).ok_or_else(|| counts(&[i64::from(first), i64::from(count)]))?;
    Ok(first..end)
}

fn counts(call: &[i64]) -> CapsuleError {
    CapsuleError::Malformed { what: "a draw call", reason: format!("its counts are {call:?}") }
}

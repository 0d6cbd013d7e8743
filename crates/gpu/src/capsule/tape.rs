//! wgpu's trace of a device, as a capsule.
//!
//! The trace is wgpu's own format, of the very version that wrote it, and is read with wgpu's own types: what a later version
//! records otherwise does not compile here, and what capsules do not hold is an error. An object's address names it until it
//! is dropped, so names are resolved in the order of the calls.

use super::commands::{Attachment, Command, Range};
use super::descriptors::{buffer, group_layout, render_pipeline, stage, texture};
use super::document::{
    COUNT, Capsule, ComputePipeline, Group, GroupEntry, Module, Picture, Read, Resource, SCHEMA, TARGETS, Texture,
    UNDECIDED,
};
use super::error::CapsuleError;
use super::folder::{Contents, Files};
use super::passes::{compute_steps, render};
use super::table::{Table, unsupported};
use crate::mark::{self, Mark};
use std::collections::BTreeMap;
use std::path::Path;
use wgpu::wgc::command::{Command as Traced, PointerReferences};
use wgpu::wgc::device::trace::{Action, Data, FILE_NAME};

/// The longest trace that is read, bytes: buffers and shaders stand beside it.
const MAX_TRACE: u64 = 1 << 30;

/// What WebGPU promises of the limits that a capsule may exceed.
const PROMISED: [(&str, u64); 4] = [
    ("maxBufferSize", 268_435_456),
    ("maxColorAttachmentBytesPerSample", 32),
    ("maxStorageBufferBindingSize", 134_217_728),
    ("maxTextureDimension2D", 8192),
];

/// The capsule of a trace.
pub(super) fn contents(folder: &Path, picture: Picture) -> Result<Contents, CapsuleError> {
    let path = folder.join(FILE_NAME);
    let read = |source| CapsuleError::Read { path: path.clone(), source };
    let text = files::read(&path, MAX_TRACE).map_err(read)?;
    let failed = |reason: String| CapsuleError::Document { path: path.clone(), reason };
    let text = str::from_utf8(&text).map_err(|error| failed(error.to_string()))?.trim_end();
    // The list is closed when wgpu drops the device, which it may do later.
    let whole = if text.ends_with(']') { text.to_owned() } else { format!("{text}]") };
    let actions: Vec<Action<'_, PointerReferences>> =
        ron::from_str(&whole).map_err(|error| failed(error.to_string()))?;
    let mut tape = Tape::new(folder, picture);
    for action in actions {
        tape.action(action)?;
    }
    tape.finish()
}

/// A command buffer's commands, or those of the queue before it.
type Batch = Vec<Command>;

/// What is known after some actions.
struct Tape<'f> {
    folder: &'f Path,
    capsule: Capsule,
    files: Files,
    table: Table,
    batches: Vec<Batch>,
    /// The count that was last read.
    counted: Option<Range>,
    /// Textures of which rows were read, in order.
    targets: Vec<usize>,
    undecided: Option<Range>,
}

impl<'f> Tape<'f> {
    fn new(folder: &'f Path, picture: Picture) -> Self {
        let (schema, schema_version) = SCHEMA;
        let capsule = Capsule {
            schema: schema.to_owned(),
            schema_version,
            picture: Some(picture),
            limits: BTreeMap::new(),
            files: vec![],
            modules: vec![],
            buffers: vec![],
            textures: vec![],
            group_layouts: vec![],
            groups: vec![],
            pipeline_layouts: vec![],
            compute_pipelines: vec![],
            render_pipelines: vec![],
            commands: vec![],
            reads: vec![],
            room: None,
        };
        Self {
            folder,
            capsule,
            files: Files::new(),
            table: Table::default(),
            batches: vec![],
            counted: None,
            targets: vec![],
            undecided: None,
        }
    }

    fn action(&mut self, action: Action<'_, PointerReferences>) -> Result<(), CapsuleError> {
        use wgpu::wgc::binding_model::BindingResource;
        let Self { capsule, table, .. } = self;
        match action {
            Action::Init { .. } => {}
            Action::CreateBuffer(id, descriptor) => {
                let staging = descriptor.usage.contains(wgpu::BufferUsages::MAP_READ);
                let label = descriptor.label.as_deref().unwrap_or_default().to_owned();
                match staging {
                    true => table.staging(id, label),
                    false => table.buffers.add(id, &mut capsule.buffers, buffer(label, &descriptor)),
                }
            }
            Action::CreateTexture(id, descriptor) => {
                table.textures.add(id, &mut capsule.textures, texture(&descriptor)?);
            }
            Action::CreateTextureView { id, parent, desc } => {
                let whole = desc.range == Default::default() && desc.usage.is_none();
                let texture = table.textures.get(parent)?;
                let own = capsule.textures[texture].format;
                let plain = desc.dimension.is_none_or(|dimension| dimension == wgpu::TextureViewDimension::D2);
                if !whole || !plain || desc.format.is_some_and(|format| format != own) {
                    return Err(unsupported("a view of a part of a texture"));
                }
                table.views.name(id, texture);
            }
            Action::CreateBindGroupLayout(id, descriptor) => {
                table.group_layouts.add(id, &mut capsule.group_layouts, group_layout(&descriptor.entries)?);
            }
            Action::CreatePipelineLayout(id, descriptor) => {
                let groups = descriptor.bind_group_layouts.iter();
                let groups = groups.map(|group| group.map(|group| table.group_layouts.get(group)).transpose());
                let groups = groups.collect::<Result<_, _>>()?;
                table.pipeline_layouts.add(id, &mut capsule.pipeline_layouts, groups);
            }
            Action::CreateBindGroup(id, descriptor) => {
                let entry = |entry: &wgpu::wgc::binding_model::BindGroupEntry<'_, _, _, _, _, _>| {
                    let resource = match &entry.resource {
                        BindingResource::Buffer(part) => {
                            let of = table.buffers.get(part.buffer)?;
                            let rest = capsule.buffers[of].size - part.offset;
                            Resource::Buffer(Range { buffer: of, offset: part.offset, size: part.size.unwrap_or(rest) })
                        }
                        BindingResource::TextureView(view) => Resource::Texture(table.views.get(*view)?),
                        other => return Err(unsupported(format!("a binding of {other:?}"))),
                    };
                    Ok(GroupEntry { binding: entry.binding, resource })
                };
                let entries = descriptor.entries.iter().map(entry).collect::<Result<_, CapsuleError>>()?;
                let layout = table.group_layouts.get(descriptor.layout)?;
                table.groups.add(id, &mut capsule.groups, Group { layout, entries });
            }
            Action::CreateShaderModule { id, desc: _, data } => {
                let file = format!("module-{}.wgsl", capsule.modules.len());
                let bytes = self.bytes(&data)?;
                self.files.insert(file.clone(), bytes);
                self.table.modules.add(id, &mut self.capsule.modules, Module { file });
            }
            Action::CreateComputePipeline { id, desc } => {
                let layout = desc.layout.ok_or_else(|| unsupported("a pipeline that finds its own layout"))?;
                let layout = table.pipeline_layouts.get(layout)?;
                let compute = stage(&desc.stage, &table.modules)?;
                let pipeline = ComputePipeline { layout, compute };
                table.compute.add(id, &mut capsule.compute_pipelines, pipeline);
            }
            Action::CreateGeneralRenderPipeline { id, desc } => {
                let pipeline = render_pipeline(&desc, table)?;
                table.render.add(id, &mut capsule.render_pipelines, pipeline);
            }
            Action::WriteBuffer { id, data, offset, size, queued: _ } => {
                let buffer = table.buffers.get(id)?;
                let bytes = self.bytes(&data)?;
                if bytes.len() as u64 != size {
                    return Err(unsupported(format!("a write of {size} bytes of {}", bytes.len())));
                }
                if size > 0 {
                    let file = format!("write-{}.bin", self.files.len());
                    self.files.insert(file.clone(), bytes);
                    self.batches.push(vec![Command::Write { buffer, offset, file }]);
                }
            }
            Action::Submit(_, commands) => self.submit(commands)?,
            Action::DropBuffer(_)
            | Action::DestroyBuffer(_)
            | Action::DropTexture(_)
            | Action::DestroyTexture(_)
            | Action::DropTextureView(_)
            | Action::DropBindGroupLayout(_)
            | Action::DropPipelineLayout(_)
            | Action::DropBindGroup(_)
            | Action::DropShaderModule(_)
            | Action::DropComputePipeline(_)
            | Action::DropRenderPipeline(_) => {}
            other => return Err(unsupported(format!("{other:?}").chars().take(120).collect::<String>())),
        }
        Ok(())
    }

    fn bytes(&self, data: &Data) -> Result<Vec<u8>, CapsuleError> {
        match data {
            Data::File(name) => {
                let path = self.folder.join(name);
                files::read(&path, MAX_TRACE).map_err(|source| CapsuleError::Read { path, source })
            }
            Data::String(_, text) => Ok(text.clone().into_bytes()),
            Data::Binary(_, bytes) => Ok(bytes.clone()),
        }
    }

    fn submit(&mut self, commands: Vec<Traced<PointerReferences>>) -> Result<(), CapsuleError> {
        let mut batch = vec![];
        for command in commands {
            match command {
                Traced::ClearBuffer { dst, offset, size } => {
                    let buffer = self.table.buffers.get(dst)?;
                    let rest = self.capsule.buffers[buffer].size - offset;
                    batch.push(Command::Clear(Range { buffer, offset, size: size.unwrap_or(rest) }));
                }
                Traced::RunComputePass { pass, timestamp_writes: None } => {
                    batch.push(Command::Compute { steps: compute_steps(&pass, &self.table)? });
                }
                Traced::RunRenderPass {
                    pass,
                    color_attachments,
                    depth_stencil_attachment,
                    timestamp_writes: None,
                    occlusion_query_set: None,
                    multiview_mask: None,
                } => {
                    let sizes = &self.capsule.buffers;
                    batch.push(render(&pass, &color_attachments, &depth_stencil_attachment, &self.table, sizes)?);
                }
                Traced::CopyTextureToBuffer { src, .. } => {
                    let texture = self.table.textures.get(src.texture)?;
                    if !self.targets.contains(&texture) {
                        self.targets.push(texture);
                    }
                }
                Traced::CopyBufferToBuffer { src, src_offset, dst, dst_offset: 0, size: Some(size) } => {
                    let range = Range { buffer: self.table.buffers.get(src)?, offset: src_offset, size };
                    match self.table.what_for(dst)? {
                        mark::UNDECIDED => self.undecided = Some(range),
                        _ => self.counted = Some(range),
                    }
                }
                Traced::InsertDebugMarker(text) => match Mark::of(&text) {
                    Some(Mark::Room(capacity)) => self.capsule.room = Some(capacity),
                    // What was drawn is the last that is no reading.
                    Some(Mark::NoRoom) => drop(self.batches.pop()),
                    None => return Err(unsupported(format!("a marker {text:?}"))),
                },
                other => return Err(unsupported(format!("{other:?}").chars().take(120).collect::<String>())),
            }
        }
        if !batch.is_empty() {
            self.batches.push(batch);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Contents, CapsuleError> {
        let targets: &[usize; TARGETS.len()] = self.targets.as_slice().try_into().map_err(|_| {
            let reason = format!("{} targets were read back, not {}", self.targets.len(), TARGETS.len());
            CapsuleError::Malformed { what: "the recording", reason }
        })?;
        let mut read = |name: &str, of| self.capsule.reads.push(Read { name: name.to_owned(), of });
        TARGETS.iter().zip(targets).for_each(|(name, &texture)| read(name, Resource::Texture(texture)));
        if let Some(range) = self.undecided {
            read(UNDECIDED, Resource::Buffer(range));
        }
        if let Some(range) = self.counted.filter(|_| self.capsule.room.is_some()) {
            self.capsule.reads.push(Read { name: COUNT.to_owned(), of: Resource::Buffer(range) });
        }
        self.capsule.limits = self.limits();
        self.capsule.commands = self.batches.into_iter().flatten().collect();
        Ok(Contents::new(self.capsule, self.files))
    }

    /// What is needed beyond what WebGPU promises.
    fn limits(&self) -> BTreeMap<String, u64> {
        let Capsule { buffers, textures, .. } = &self.capsule;
        let storage = wgpu::BufferUsages::STORAGE.bits();
        let texel = |color: &Attachment| textures[color.texture].format.block_copy_size(None).map_or(0, u64::from);
        let passes = self.batches.iter().flatten().filter_map(|command| match command {
            Command::Render { colors, .. } => Some(colors),
            _ => None,
        });
        let most = |sizes: &mut dyn Iterator<Item = u64>| sizes.max().unwrap_or(0);
        let sides = |texture: &Texture| u64::from(texture.width.max(texture.height));
        let bound = buffers.iter().filter(|buffer| buffer.usage & storage != 0);
        let needed = [
            most(&mut buffers.iter().map(|buffer| buffer.size)),
            most(&mut passes.map(|colors| colors.iter().map(texel).sum())),
            most(&mut bound.map(|buffer| buffer.size)),
            most(&mut textures.iter().map(sides)),
        ];
        let beyond = PROMISED.iter().zip(needed).filter(|((_, promised), needed)| needed > promised);
        beyond.map(|((name, _), needed)| ((*name).to_owned(), needed)).collect()
    }
}

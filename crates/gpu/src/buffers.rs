//! What is uploaded once: the packed scene. Views and shading are written anew each frame.

use crate::groups::{READ, UNIFORM, whole};
use crate::masks::{MaskAtlas, MaskBlend, MaskPainter};
use crate::{Device, GpuError};
use gbuffer::ShadeUniform;
use pipeline::mask::Masks;
use pipeline::{PackedScene, View};
use wgpu::{BufferUsages, ShaderStages};

/// Bytes that are compared at once where an edit is uploaded; records and vertices are whole numbers of them.
const WORD: usize = 4;

const UPLOADING: &str = "uploading the scene";

/// Bindings of `shaders/layout.wgsl`, in order.
const STORAGE_BINDINGS: [&str; 4] = ["faces", "views", "knots", "control points"];

/// Which of them the views are.
const VIEWS: usize = 1;

/// The layouts of group 0.
#[derive(Clone)]
pub struct SceneLayouts {
    /// Of every program.
    pub scene: wgpu::BindGroupLayout,
    /// Of kernels that read the views and no more: WebGPU promises a stage eight storage buffers.
    pub views: wgpu::BindGroupLayout,
}

/// The scene's numbers on the device.
pub struct SceneBuffers {
    /// Of the groups.
    pub layouts: SceneLayouts,
    /// Group 0 of every program.
    pub group: wgpu::BindGroup,
    /// Group 0 of kernels that read the views and no more.
    pub views_group: wgpu::BindGroup,
    /// As [`STORAGE_BINDINGS`].
    storage: [wgpu::Buffer; 4],
    shading: wgpu::Buffer,
    faces: usize,
    /// Whether some face is bounded by loops.
    pub is_trimmed: bool,
}

impl SceneBuffers {
    /// Uploads a scene for shaders of the stages `visibility`, and draws its masks where it has any; without a `blend` they are
    /// the CPU's, texel by texel.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where it does not fit the adapter; [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn new(
        device: &Device,
        scene: &PackedScene,
        visibility: ShaderStages,
        blend: Option<MaskBlend>,
    ) -> Result<Self, GpuError> {
        let faces = scene.faces().len();
        let views = vec![<View as bytemuck::Zeroable>::zeroed(); faces];
        let contents: [&[u8]; 4] = [
            bytemuck::cast_slice(scene.faces()),
            bytemuck::cast_slice(&views),
            bytemuck::cast_slice(scene.knots()),
            bytemuck::cast_slice(scene.points()),
        ];
        let mut storage = vec![];
        for (what, bytes) in STORAGE_BINDINGS.into_iter().zip(contents) {
            storage.push(device.storage(what, bytes)?);
        }
        let storage: [wgpu::Buffer; 4] = storage.try_into().expect("four bindings");
        let shading = <ShadeUniform as bytemuck::Zeroable>::zeroed();
        let shading = device.buffer("shading", BufferUsages::UNIFORM, bytemuck::bytes_of(&shading))?;
        let draw = |masks: &Masks| match blend {
            Some(blend) => MaskPainter::new(device, blend)?.draw(device, &masks.plan),
            None => MaskAtlas::of(device, masks),
        };
        let atlas = scene.masks().filter(|_| scene.is_trimmed()).map(draw).transpose()?;
        let (layouts, group, views_group) = device.guarded(UPLOADING, || {
            let mut types = vec![READ, READ, READ, READ, UNIFORM];
            let mut resources: Vec<_> = whole(storage.iter().chain([&shading])).collect();
            if let Some(atlas) = &atlas {
                types.push(wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                });
                resources.push((5, wgpu::BindingResource::TextureView(&atlas.view)));
            }
            let scene = device.group_layout("scene", visibility, (0..).zip(types));
            let group = device.group("scene", &scene, resources);
            let views = device.group_layout("views", ShaderStages::COMPUTE, [(VIEWS as u32, READ)]);
            let views_group = device.group("views", &views, [(VIEWS as u32, storage[VIEWS].as_entire_binding())]);
            (SceneLayouts { scene, views }, group, views_group)
        })?;
        let is_trimmed = scene.is_trimmed();
        Ok(Self { layouts, group, views_group, storage, shading, faces, is_trimmed })
    }

    /// How many bytes they are, masks aside.
    pub(crate) fn bytes(&self) -> u64 {
        self.storage.iter().chain([&self.shading]).map(wgpu::Buffer::size).sum()
    }

    /// Says how each face is seen in the next frame.
    ///
    /// # Errors
    /// [`GpuError::ViewCount`]; [`GpuError::Lost`].
    pub fn write_views(&self, device: &Device, views: &[View]) -> Result<(), GpuError> {
        if views.len() != self.faces {
            return Err(GpuError::ViewCount { expected: self.faces, found: views.len() });
        }
        device.guarded("writing the views", || {
            device.queue.write_buffer(&self.storage[VIEWS], 0, bytemuck::cast_slice(views))
        })
    }

    /// Uploads what differs between two scenes of the same layout, and says how many bytes that is.
    pub(crate) fn write_changes(
        &self,
        device: &Device,
        before: &PackedScene,
        after: &PackedScene,
    ) -> Result<u64, GpuError> {
        let changed = |binding: usize, before: &[u8], after: &[u8]| {
            device.write_changes(STORAGE_BINDINGS[binding], &self.storage[binding], before, after)
        };
        Ok(changed(0, bytemuck::cast_slice(before.faces()), bytemuck::cast_slice(after.faces()))?
            + changed(2, bytemuck::cast_slice(before.knots()), bytemuck::cast_slice(after.knots()))?
            + changed(3, bytemuck::cast_slice(before.points()), bytemuck::cast_slice(after.points()))?)
    }

    /// Says how the next frame is shaded.
    pub(crate) fn write_shading(&self, device: &Device, shading: &ShadeUniform) -> Result<(), GpuError> {
        device.guarded("writing the shading", || {
            device.queue.write_buffer(&self.shading, 0, bytemuck::bytes_of(shading));
        })
    }
}

impl Device {
    /// A buffer that holds `bytes`; an empty one has room for a few, since WebGPU binds no empty buffers.
    pub fn buffer(&self, what: &'static str, usage: BufferUsages, bytes: &[u8]) -> Result<wgpu::Buffer, GpuError> {
        let size = (bytes.len() as u64).max(size_of::<View>() as u64);
        self.fits(what, "max_buffer_size", size, self.limits.max_buffer_size)?;
        self.guarded(UPLOADING, || {
            let descriptor = wgpu::BufferDescriptor {
                label: Some(what),
                size,
                usage: usage | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            };
            let buffer = self.wgpu.create_buffer(&descriptor);
            self.queue.write_buffer(&buffer, 0, bytes);
            buffer
        })
    }

    /// Uploads the runs of words in which `after` differs from `before`, which the buffer holds, and says how many bytes
    /// that is.
    pub fn write_changes(
        &self,
        what: &'static str,
        buffer: &wgpu::Buffer,
        before: &[u8],
        after: &[u8],
    ) -> Result<u64, GpuError> {
        if before.len() != after.len() {
            return Err(GpuError::OtherShape { what, expected: before.len(), found: after.len() });
        }
        let mut written = 0;
        self.guarded("uploading an edit", || {
            let differs = |word: usize| before[word..].iter().zip(&after[word..]).take(WORD).any(|(a, b)| a != b);
            let starts: Vec<usize> = (0..after.len()).step_by(WORD).collect();
            for run in starts.chunk_by(|&a, &b| differs(a) == differs(b)).filter(|run| differs(run[0])) {
                let end = after.len().min(run[run.len() - 1] + WORD);
                self.queue.write_buffer(buffer, run[0] as u64, &after[run[0]..end]);
                written += (end - run[0]) as u64;
            }
        })?;
        Ok(written)
    }

    /// A storage buffer of zeros that only the device writes.
    pub fn empty(&self, what: &'static str, size: u64) -> Result<wgpu::Buffer, GpuError> {
        let limit = self.limits.max_storage_buffer_binding_size;
        self.fits(what, "max_storage_buffer_binding_size", size, limit)?;
        self.fits(what, "max_buffer_size", size, self.limits.max_buffer_size)?;
        self.guarded("allocating the picture", || {
            self.wgpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some(what),
                size,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        })
    }

    /// A storage buffer that holds `bytes` and can be copied from.
    pub fn storage(&self, what: &'static str, bytes: &[u8]) -> Result<wgpu::Buffer, GpuError> {
        let limit = self.limits.max_storage_buffer_binding_size;
        self.fits(what, "max_storage_buffer_binding_size", bytes.len() as u64, limit)?;
        self.buffer(what, BufferUsages::STORAGE | BufferUsages::COPY_SRC, bytes)
    }
}

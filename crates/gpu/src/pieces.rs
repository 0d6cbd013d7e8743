//! Bind group 1 of technique `exact`: the pieces, and the pixels in which a search has not converged.

use crate::{Device, GpuError};
use pipeline::PieceRecord;
use scene::Viewport;
use wgpu::{BufferBindingType, ShaderStages};

/// Pixels a word of `unconverged` in `shaders/entry_exact.wgsl`.
const WORD: usize = 32;

/// The pieces on the device.
pub(crate) struct PieceBuffers {
    pub(crate) layout: wgpu::BindGroupLayout,
    pieces: wgpu::Buffer,
}

/// A bit for each pixel of a picture, and the group that a draw binds.
pub(crate) struct Unconverged {
    pub(crate) group: wgpu::BindGroup,
    bits: wgpu::Buffer,
    viewport: Viewport,
}

impl PieceBuffers {
    pub(crate) fn new(device: &Device, pieces: &[PieceRecord]) -> Result<Self, GpuError> {
        let pieces = device.storage("pieces", bytemuck::cast_slice(pieces))?;
        let layout = device.guarded("setting up", || {
            let entry = |binding, read_only| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: BufferBindingType::Storage { read_only },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            };
            device.wgpu.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("pieces"),
                entries: &[entry(0, true), entry(1, false)],
            })
        })?;
        Ok(Self { layout, pieces })
    }

    /// A picture's bits, all zero.
    pub(crate) fn unconverged(&self, device: &Device, viewport: Viewport) -> Result<Unconverged, GpuError> {
        let words = vec![0u32; viewport.pixels().div_ceil(WORD)];
        let bits = device.storage("unconverged pixels", bytemuck::cast_slice(&words))?;
        let group = device.guarded("setting up", || device.group("pieces", &self.layout, [&self.pieces, &bits]))?;
        Ok(Unconverged { group, bits, viewport })
    }
}

impl Unconverged {
    /// The pixels (x, y) whose bits are set.
    pub(crate) fn pixels(&self, device: &Device) -> Result<Vec<(usize, usize)>, GpuError> {
        let (width, count) = (self.viewport.width(), self.viewport.pixels());
        let mut words = vec![0u32; count.div_ceil(WORD)];
        device.read_buffer("reading the unconverged pixels", &self.bits, bytemuck::cast_slice_mut(&mut words))?;
        let is_set = |pixel: &usize| words[pixel / WORD] >> (pixel % WORD) & 1 == 1;
        Ok((0..count).filter(is_set).map(|pixel| (pixel % width, pixel / width)).collect())
    }
}

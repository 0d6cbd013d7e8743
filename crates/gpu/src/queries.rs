//! Timestamps around frames, by the device's clock.

use crate::{Device, GpuError};

/// Two timestamps a frame.
pub(crate) struct Queries {
    set: wgpu::QuerySet,
    frames: usize,
}

/// The two timestamps of one frame.
#[derive(Clone, Copy)]
pub struct Stamps<'a> {
    /// Where they are written.
    pub set: &'a wgpu::QuerySet,
    /// Index of that of its start; that of its end is the next.
    pub start: u32,
}

impl Queries {
    pub(crate) fn new(device: &Device, frames: usize) -> Result<Self, GpuError> {
        let descriptor = wgpu::QuerySetDescriptor {
            label: Some("frames"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * frames as u32,
        };
        let set = device.guarded("setting up", || device.wgpu.create_query_set(&descriptor))?;
        Ok(Self { set, frames })
    }

    /// Those of one frame.
    pub(crate) fn frame(&self, frame: usize) -> Stamps<'_> {
        Stamps { set: &self.set, start: 2 * frame as u32 }
    }

    /// Seconds from the first to the second of each pair.
    pub(crate) fn read(&self, device: &Device) -> Result<Vec<f64>, GpuError> {
        const READING: &str = "reading timestamps";
        let mut ticks = vec![[0u64; 2]; self.frames];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut ticks);
        let (buffer, encoder) = device.guarded(READING, || {
            let buffer = device.wgpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            let mut encoder = device.wgpu.create_command_encoder(&Default::default());
            encoder.resolve_query_set(&self.set, 0..2 * self.frames as u32, &buffer, 0);
            (buffer, encoder)
        })?;
        device.submit(READING, encoder)?;
        device.read_buffer(READING, &buffer, 0, bytes)?;
        let second = f64::from(device.queue.get_timestamp_period()) * 1e-9;
        Ok(ticks.iter().map(|[start, end]| end.saturating_sub(*start) as f64 * second).collect())
    }
}

//! Timestamps around frames, by the device's clock.

use crate::{Device, GpuError};

/// Timestamps that WebGPU allows a set.
const A_SET: usize = 4096;

/// As many timestamps a frame as it has parts, and one more.
pub(crate) struct Queries {
    set: wgpu::QuerySet,
    frames: usize,
    stamps: usize,
}

/// The timestamps of one frame.
#[derive(Clone, Copy)]
pub struct Stamps<'a> {
    /// Where they are written.
    pub set: &'a wgpu::QuerySet,
    /// Index of that of its start; those of the ends of its parts follow.
    pub start: u32,
}

impl Stamps<'_> {
    /// The clock starts before what is encoded from here on.
    pub fn begin(self, encoder: &mut wgpu::CommandEncoder) {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("start"),
            timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                query_set: self.set,
                beginning_of_pass_write_index: Some(self.start),
                end_of_pass_write_index: None,
            }),
        });
    }
}

impl Queries {
    /// Frames of so many parts that one set has room for.
    pub(crate) fn frames_a_set(parts: usize) -> usize {
        A_SET / (parts + 1)
    }

    pub(crate) fn new(device: &Device, frames: usize, parts: usize) -> Result<Self, GpuError> {
        let stamps = parts + 1;
        let descriptor = wgpu::QuerySetDescriptor {
            label: Some("frames"),
            ty: wgpu::QueryType::Timestamp,
            count: (stamps * frames) as u32,
        };
        let set = device.guarded("setting up", || device.wgpu.create_query_set(&descriptor))?;
        Ok(Self { set, frames, stamps })
    }

    /// Those of one frame.
    pub(crate) fn frame(&self, frame: usize) -> Stamps<'_> {
        Stamps { set: &self.set, start: (self.stamps * frame) as u32 }
    }

    /// Seconds of each part of each frame, frame by frame.
    pub(crate) fn read(&self, device: &Device) -> Result<Vec<Vec<f64>>, GpuError> {
        const READING: &str = "reading timestamps";
        let mut ticks = vec![0u64; self.stamps * self.frames];
        let count = ticks.len() as u32;
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut ticks);
        let (buffer, encoder) = device.guarded(READING, || {
            let buffer = device.wgpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            let mut encoder = device.wgpu.create_command_encoder(&Default::default());
            encoder.resolve_query_set(&self.set, 0..count, &buffer, 0);
            (buffer, encoder)
        })?;
        device.submit(READING, encoder)?;
        device.read_buffer(READING, &buffer, 0, bytes)?;
        let second = f64::from(device.queue.get_timestamp_period()) * 1e-9;
        let parts = |frame: &[u64]| frame.windows(2).map(|t| t[1].saturating_sub(t[0]) as f64 * second).collect();
        Ok(ticks.chunks_exact(self.stamps).map(parts).collect())
    }
}

//! What the kernels of technique `exact` keep of one picture: the meetings of rays and pieces, and what each pixel shows.

use crate::resolve;
use bytemuck::{Pod, Zeroable};
use gpu::groups::{PART_STRIDE, part, whole};
use gpu::{Device, GpuError, Room, Targets};
use pipeline::Program;
use scene::Viewport;
use wgpu::BufferUsages;

/// Pixels a word of the bits in `Picture` of `shaders/exact/entry.wgsl`.
const WORD: usize = 32;

/// Words before those of the pixels there: the most meetings, and their number.
pub(super) const HEAD: usize = 2;

/// Bytes of `Meeting` there.
pub(super) const MEETING_BYTES: u64 = 20;

/// Meetings a pixel that a picture has room for at first. What is hidden when it is found is not kept, so that scenes
/// rarely need more.
const MEETINGS_A_PIXEL: u64 = 2;

/// `Batch` in `shaders/exact/entry.wgsl`, filled up to [`PART_STRIDE`].
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct BatchUniform {
    first: u32,
    count: u32,
    width: u32,
    height: u32,
    unconverged: u32,
    evaluations: u32,
    large: u32,
    clears: u32,
    nothing: [f32; 4],
    padding: [u32; 52],
}

/// The pieces of a program, in drawing order.
#[derive(Clone, Copy)]
pub struct Range {
    /// The program.
    pub program: Program,
    /// Its first piece.
    pub first: u32,
    /// How many it has.
    pub count: u32,
}

/// What all pictures share.
pub struct Shared {
    /// The pieces.
    pub pieces: wgpu::Buffer,
    /// Their hulls.
    pub hulls: wgpu::Buffer,
    /// Zeros that no compiler sees.
    pub zeros: wgpu::Buffer,
    /// The pieces of each program.
    pub ranges: Vec<Range>,
    /// Of group 1 of every kernel.
    pub layout: wgpu::BindGroupLayout,
}

/// Buffers and groups of one picture.
pub struct Picture {
    /// Pieces, hulls, and what follows; the batch by a dynamic offset.
    pub(super) group: wgpu::BindGroup,
    /// The textures to be written.
    pub(super) targets: wgpu::BindGroup,
    words: wgpu::Buffer,
    /// Meetings that there is room for.
    capacity: u64,
    viewport: Viewport,
}

impl Picture {
    /// One that has room for `capacity` meetings at least; `layout` is that of its targets.
    pub(super) fn new(
        device: &Device,
        shared: &Shared,
        capacity: u64,
        targets: &Targets,
        layout: &wgpu::BindGroupLayout,
    ) -> Result<Self, GpuError> {
        let viewport = targets.viewport;
        let pixels = viewport.pixels();
        let unconverged = 2 * pixels;
        let evaluations = unconverged + pixels.div_ceil(WORD);
        let large = evaluations + pixels;
        let words = 4 * (HEAD + large + shared.ranges.len()) as u64;
        let words = device.empty("the pixels", words)?;
        let wanted = MEETINGS_A_PIXEL * pixels as u64;
        let capacity = within_limits(device, capacity, wanted.max(capacity))?;
        let meetings = device.empty("meetings of rays and pieces", capacity * MEETING_BYTES)?;
        let batch = |(index, range): (usize, &Range)| BatchUniform {
            first: range.first,
            count: range.count,
            width: viewport.width() as u32,
            height: viewport.height() as u32,
            unconverged: unconverged as u32,
            evaluations: evaluations as u32,
            large: (large + index) as u32,
            clears: u32::from(index == 0),
            nothing: targets.nothing(),
            padding: [0; 52],
        };
        let mut batches: Vec<_> = shared.ranges.iter().enumerate().map(batch).collect();
        if batches.is_empty() {
            batches.push(Zeroable::zeroed());
        }
        let batches = device.buffer("batches", BufferUsages::UNIFORM, bytemuck::cast_slice(&batches))?;
        let (group, targets) = device.guarded("setting up", || {
            let buffers = whole([&shared.pieces, &shared.hulls, &words, &meetings]);
            let batch = part(&batches, PART_STRIDE as u64);
            let resources = buffers.chain([(4, batch), (5, shared.zeros.as_entire_binding())]);
            let group = device.group("pieces", &shared.layout, resources);
            (group, resolve::group(device, layout, targets))
        })?;
        Ok(Self { group, targets, words, capacity, viewport })
    }

    /// Empties it for a frame; the most meetings of any frame stay.
    pub(super) fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.words, 4, None);
    }

    /// Room for meetings. Counted are the most of any frame, those without room among them.
    pub(super) fn room(&self) -> Room<'_> {
        Room { during: "counting meetings", buffer: &self.words, offset: 0, capacity: self.capacity }
    }

    /// Where the pixels are marked in which a search has not converged.
    pub(super) fn unconverged(&self) -> (&wgpu::Buffer, u64) {
        (&self.words, 4 * (HEAD + 2 * self.viewport.pixels()) as u64)
    }

    /// How often the surface was evaluated for each pixel, row-major.
    pub fn evaluations(&self, device: &Device) -> Result<Vec<u32>, GpuError> {
        let count = self.viewport.pixels();
        let mut words = vec![0u32; count];
        let offset = 4 * (HEAD + 2 * count + count.div_ceil(WORD)) as u64;
        device.read_buffer("reading the evaluations", &self.words, offset, bytemuck::cast_slice_mut(&mut words))?;
        Ok(words)
    }
}

/// As many meetings as wanted, or as many as the adapter has room for if these are at least as many as needed.
pub(super) fn within_limits(device: &Device, needed: u64, wanted: u64) -> Result<u64, GpuError> {
    let limit = device.limits.max_storage_buffer_binding_size;
    let bytes = needed * MEETING_BYTES;
    device.fits("meetings of rays and pieces", "max_storage_buffer_binding_size", bytes, limit)?;
    Ok(wanted.min(limit / MEETING_BYTES))
}

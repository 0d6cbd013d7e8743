//! From the device's textures and buffers back to fragments.

use crate::{Device, GpuError};
use bytemuck::{Pod, Zeroable};
use nurbs::NormalStatus;
use pipeline::edge;
use pipeline::fragment::Fragment;
use scene::Viewport;
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::BufferUsages;

const READING: &str = "reading the picture back";

/// Bytes that are read back at once: a full 1920×1080 G-buffer is 133 MB, too much to hold beside the hits made of it.
const BAND_BYTES: u64 = 8 << 20;

/// Rows of a copied texture start at multiples of this.
const ROW_ALIGNMENT: u64 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as u64;

/// What the three float targets are cleared to: no surface in local coordinates comes near it.
pub(crate) const CLEARED: f32 = -170141183460469231731687303715884105728.0;

/// What a fragment writes: the four targets of `GBufferOutput` in `shaders/entry.wgsl`, `ProbeAnswer` in
/// `shaders/probe.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct Record {
    /// Face + 1, status (with the edge where edges are looked for), span in u, span in v.
    pub(crate) identity: [u32; 4],
    /// S in local coordinates, u.
    pub(crate) position: [f32; 4],
    /// Unit normal, v.
    pub(crate) normal: [f32; 4],
    /// k1, k2, |S_u|, |S_v|.
    pub(crate) shape: [f32; 4],
}

impl Record {
    /// The record as the CPU's type; numbers pass as they are, NaN among them. The face is not checked.
    ///
    /// A status that is none counts as undefined: a comparison then finds it wrong wherever there is a normal.
    pub(crate) fn fragment(&self) -> Fragment {
        let [x, y, z, u] = self.position;
        let [nx, ny, nz, v] = self.normal;
        let [k1, k2, speed_u, speed_v] = self.shape;
        Fragment {
            face: self.identity[0].wrapping_sub(1),
            uv: [u, v],
            span: [self.identity[2], self.identity[3]],
            position: [x, y, z],
            normal: [nx, ny, nz],
            status: match self.identity[1] {
                0 => NormalStatus::Regular,
                1 => NormalStatus::Limit,
                _ => NormalStatus::Undefined,
            },
            curvature: [k1, k2],
            speed: [speed_u, speed_v],
            edge: None,
        }
    }

    /// The fragment of pixel (x, y) of a scene of `count` faces, with edges or without, or `None` where nothing was drawn.
    pub(crate) fn pixel(
        &self,
        x: usize,
        y: usize,
        count: usize,
        has_edges: bool,
    ) -> Result<Option<Fragment>, GpuError> {
        if self.identity[0] == 0 {
            let cleared = [self.position, self.normal, self.shape] == [[CLEARED; 4]; 3] && self.identity == [0; 4];
            return if cleared { Ok(None) } else { Err(GpuError::NotCleared { x, y }) };
        }
        let mut fragment = self.fragment();
        if has_edges {
            let [face, word, span_u, span_v] = self.identity;
            let (status, edge) = edge::unpacked(word);
            fragment = Fragment { edge, ..Self { identity: [face, status, span_u, span_v], ..*self }.fragment() };
        }
        if fragment.face as usize >= count {
            return Err(GpuError::Malformed { x, y, face: fragment.face, count });
        }
        Ok(Some(fragment))
    }
}

/// Textures of one size, read back a band of rows at a time.
pub(crate) struct Rows<'a> {
    device: &'a Device,
    textures: Vec<&'a wgpu::Texture>,
    viewport: Viewport,
    staging: wgpu::Buffer,
    /// Bytes of a row of each texture in the staging buffer.
    strides: Vec<u64>,
    /// Rows a band.
    height: usize,
    /// The band at hand and its first row; textures one after the other.
    band: Vec<u32>,
    first: Option<usize>,
}

impl<'a> Rows<'a> {
    pub(crate) fn new(
        device: &'a Device,
        textures: Vec<&'a wgpu::Texture>,
        viewport: Viewport,
    ) -> Result<Self, GpuError> {
        let texel = |t: &wgpu::Texture| u64::from(t.format().block_copy_size(None).expect("a colour format"));
        let strides: Vec<u64> =
            textures.iter().map(|t| (viewport.width() as u64 * texel(t)).next_multiple_of(ROW_ALIGNMENT)).collect();
        let total: u64 = strides.iter().sum();
        let height = (BAND_BYTES / total).clamp(1, viewport.height() as u64);
        device.fits("a row of the picture", "max_buffer_size", total, device.limits.max_buffer_size)?;
        let staging = device.guarded(READING, || device.staging(READING, total * height))?;
        let band = vec![0; (total * height / 4) as usize];
        Ok(Self { device, textures, viewport, staging, strides, height: height as usize, band, first: None })
    }

    /// Row `y` of each texture, as words; beyond the last pixel stands padding.
    pub(crate) fn row(&mut self, y: usize) -> Result<Vec<&[u32]>, GpuError> {
        let first = y - y % self.height;
        if self.first != Some(first) {
            self.first = None;
            self.fetch(first)?;
            self.first = Some(first);
        }
        let mut start = 0;
        let rows = self.strides.iter().map(|&stride| {
            let words = stride as usize / 4;
            let at = start + (y - first) * words;
            start += words * self.height;
            &self.band[at..at + words]
        });
        Ok(rows.collect())
    }

    fn fetch(&mut self, first: usize) -> Result<(), GpuError> {
        let rows = self.height.min(self.viewport.height() - first) as u32;
        let encoder = self.device.guarded(READING, || {
            let mut encoder = self.device.wgpu.create_command_encoder(&Default::default());
            let mut offset = 0;
            for (texture, &stride) in self.textures.iter().zip(&self.strides) {
                encoder.copy_texture_to_buffer(
                    wgpu::TexelCopyTextureInfo {
                        texture,
                        mip_level: 0,
                        origin: wgpu::Origin3d { x: 0, y: first as u32, z: 0 },
                        aspect: wgpu::TextureAspect::All,
                    },
                    wgpu::TexelCopyBufferInfo {
                        buffer: &self.staging,
                        layout: wgpu::TexelCopyBufferLayout {
                            offset,
                            bytes_per_row: Some(stride as u32),
                            rows_per_image: None,
                        },
                    },
                    wgpu::Extent3d { width: self.viewport.width() as u32, height: rows, depth_or_array_layers: 1 },
                );
                offset += stride * self.height as u64;
            }
            encoder
        })?;
        self.device.submit(READING, encoder)?;
        self.device.read_staging(READING, &self.staging, bytemuck::cast_slice_mut(&mut self.band))
    }
}

impl Device {
    /// A buffer that the processor can read, and what for.
    pub(crate) fn staging(&self, what: &'static str, size: u64) -> wgpu::Buffer {
        self.wgpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some(what),
            size,
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// Waits for all that was submitted and copies a staging buffer out.
    pub(crate) fn read_staging(
        &self,
        during: &'static str,
        staging: &wgpu::Buffer,
        out: &mut [u8],
    ) -> Result<(), GpuError> {
        let answer = Arc::new(Mutex::new(None));
        let slot = answer.clone();
        self.guarded(during, || {
            staging.map_async(wgpu::MapMode::Read, .., move |result| {
                *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
            });
        })?;
        self.wait(during, None)?;
        let refused = |message: String| GpuError::Refused { during, message };
        match answer.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(Ok(())) => {}
            Some(Err(error)) => return Err(refused(error.to_string())),
            None => return Err(refused("the buffer was not mapped".to_owned())),
        }
        let view = staging.get_mapped_range(..).map_err(|error| refused(error.to_string()))?;
        out.copy_from_slice(&view);
        drop(view);
        staging.unmap();
        Ok(())
    }

    /// The texels of a texture, row by row from the top, without padding.
    ///
    /// # Errors
    /// [`GpuError::Refused`] where its texels cannot be copied; [`GpuError::Limit`], [`GpuError::OutOfMemory`],
    /// [`GpuError::Timeout`], [`GpuError::Lost`].
    pub(crate) fn texels(&self, during: &'static str, texture: &wgpu::Texture) -> Result<Vec<u8>, GpuError> {
        let refused = || GpuError::Refused { during, message: format!("{:?} is not copied", texture.format()) };
        let texel = u64::from(texture.format().block_copy_size(None).ok_or_else(refused)?);
        let row = u64::from(texture.width()) * texel;
        let stride = row.next_multiple_of(ROW_ALIGNMENT);
        let size = stride * u64::from(texture.height());
        self.fits("a texture that is read back", "max_buffer_size", size, self.limits.max_buffer_size)?;
        let (staging, encoder) = self.guarded(during, || {
            let staging = self.staging(during, size);
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride as u32), rows_per_image: None };
            let mut encoder = self.wgpu.create_command_encoder(&Default::default());
            encoder.copy_texture_to_buffer(
                texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo { buffer: &staging, layout },
                texture.size(),
            );
            (staging, encoder)
        })?;
        self.submit(during, encoder)?;
        let mut rows = vec![0; size as usize];
        self.read_staging(during, &staging, &mut rows)?;
        Ok(rows.chunks_exact(stride as usize).flat_map(|padded| &padded[..row as usize]).copied().collect())
    }

    /// The bytes from `offset` on of a buffer that the device wrote.
    ///
    /// # Errors
    /// Where they cannot be copied.
    pub fn read_buffer(
        &self,
        during: &'static str,
        buffer: &wgpu::Buffer,
        offset: u64,
        out: &mut [u8],
    ) -> Result<(), GpuError> {
        let (staging, encoder) = self.guarded(during, || {
            let staging = self.staging(during, out.len() as u64);
            let mut encoder = self.wgpu.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(buffer, offset, &staging, 0, out.len() as u64);
            (staging, encoder)
        })?;
        self.submit(during, encoder)?;
        self.read_staging(during, &staging, out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EMPTY: Record =
        Record { identity: [0; 4], position: [CLEARED; 4], normal: [CLEARED; 4], shape: [CLEARED; 4] };

    #[test]
    fn a_cleared_pixel_is_a_miss() {
        assert_eq!(EMPTY.pixel(3, 4, 1, false), Ok(None));
    }

    #[test]
    fn a_pixel_that_was_never_copied_is_not_taken_for_a_miss() {
        let zeros = <Record as Zeroable>::zeroed();
        assert_eq!(zeros.pixel(3, 4, 1, false), Err(GpuError::NotCleared { x: 3, y: 4 }));
    }

    #[test]
    fn a_face_that_is_not_there_is_named_with_its_pixel() {
        let record = Record { identity: [8, 0, 3, 3], ..EMPTY };
        assert_eq!(record.pixel(3, 4, 7, false), Err(GpuError::Malformed { x: 3, y: 4, face: 7, count: 7 }));
        assert_eq!(record.pixel(3, 4, 8, false).unwrap().unwrap().face, 7);
    }

    #[test]
    fn numbers_that_are_none_and_statuses_that_are_none_pass_to_the_comparison() {
        let record = Record { identity: [1, 77, 99, 3], position: [f32::NAN; 4], normal: [f32::INFINITY; 4], ..EMPTY };
        let fragment = record.pixel(0, 0, 1, false).unwrap().unwrap();
        assert!(fragment.position[0].is_nan() && fragment.uv[0].is_nan());
        assert_eq!(fragment.span, [99, 3]);
        assert_eq!(fragment.status, NormalStatus::Undefined);
    }

    #[test]
    fn an_edge_is_read_from_the_status_of_a_scene_with_edges_alone() {
        let word = edge::packed(Some([0.25, -1.0]));
        let record = Record { identity: [1, word, 3, 3], ..EMPTY };
        let fragment = record.pixel(0, 0, 1, true).unwrap().unwrap();
        assert_eq!((fragment.status, fragment.edge), (NormalStatus::Regular, edge::unpacked(word).1));
        assert!(fragment.edge.is_some_and(|[x, y]| (x - 0.25).abs() < 1e-4 && y == -1.0));
        let fragment = record.pixel(0, 0, 1, false).unwrap().unwrap();
        assert_eq!((fragment.status, fragment.edge), (NormalStatus::Undefined, None));
    }
}

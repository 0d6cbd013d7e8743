//! To which grid an adapter snaps the corners of triangles: measured on it, here and now, from how far slanted edges cover.
//!
//! A renderer is allowed what its corners are moved by. Vulkan lets a grid be as coarse as a 16th of a pixel and says nothing of how
//! corners are rounded to it; WebGPU does not tell. So it is not believed of a name or a file.

use crate::grid::{Grid, LENGTH, QUADS, either, fitting};
use crate::{Device, GpuError};
use wgpu::{TextureFormat, TextureUsages};

const SHADER: &str = include_str!("../../../shaders/snapping.wgsl");

const MEASURING: &str = "measuring the grid of corners";

/// As in `shaders/snapping.wgsl`.
const PITCH: u32 = 4;

impl Device {
    /// The grid to which this adapter's rasterizer snaps corners, by what it draws now: exactly to the grid that is named, or none
    /// is. `None` where its edges are those of no grid of 4 to 11 bits, and of a
    /// device whose commands are written down, among which the measurement would be. It is measured once.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where the picture does not fit the adapter; [`GpuError::Shader`], [`GpuError::OutOfMemory`],
    /// [`GpuError::Timeout`], [`GpuError::Lost`].
    pub fn measured_grid(&self) -> Result<Option<Grid>, GpuError> {
        if let Some(grid) = self.grid.get() {
            return Ok(*grid);
        }
        if self.records {
            return Ok(None);
        }
        let limit = u64::from(self.limits.max_texture_dimension_2d);
        self.fits("a picture of edges", "max_texture_dimension_2d", u64::from(LENGTH), limit)?;
        let [across, down] = [false, true].map(|is_down| self.lengths(is_down));
        let grid = fitting(&across?).zip(fitting(&down?)).map(|(across, down)| either(across, down));
        Ok(*self.grid.get_or_init(|| grid))
    }

    /// How far the edge of each quad covers, pixels.
    fn lengths(&self, is_down: bool) -> Result<Vec<u32>, GpuError> {
        let width = PITCH * QUADS;
        let [columns, rows] = if is_down { [LENGTH, width] } else { [width, LENGTH] };
        let (texture, encoder) = self.guarded(MEASURING, || {
            let pipeline = self.edges(is_down);
            let texture = self.wgpu.create_texture(&wgpu::TextureDescriptor {
                label: Some("edges"),
                size: wgpu::Extent3d { width: columns, height: rows, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: TextureFormat::R8Unorm,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            let view = texture.create_view(&Default::default());
            let mut encoder = self.wgpu.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("edges"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_pipeline(&pipeline);
            pass.draw(0..6, 0..QUADS);
            drop(pass);
            (texture, encoder)
        })?;
        self.submit(MEASURING, encoder)?;
        let texels = self.texels(MEASURING, &texture)?;
        let is_covered = |quad: u32, along: u32| {
            let [x, y] = if is_down { [along, PITCH * quad] } else { [PITCH * quad, along] };
            texels[(y * columns + x) as usize] > 0
        };
        Ok((0..QUADS).map(|quad| (0..LENGTH).filter(|along| is_covered(quad, *along)).count() as u32).collect())
    }

    fn edges(&self, is_down: bool) -> wgpu::RenderPipeline {
        let module = self.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("edges"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let constants = [("IS_DOWN", f64::from(u8::from(is_down)))];
        let compilation_options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let layout = self.pipeline_layout("edges", &[]);
        self.wgpu.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("edges"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options,
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("covered"),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: TextureFormat::R8Unorm,
                    blend: None,
                    write_mask: wgpu::ColorWrites::RED,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Rounding;

    #[test]
    fn llvmpipe_rounds_to_the_nearest_256th() {
        let device = Device::open(Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`");
        assert_eq!(device.measured_grid().unwrap(), Some(Grid { bits: 8, rounding: Rounding::Nearest }));
    }
}

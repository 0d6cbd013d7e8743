//! To which grid an adapter snaps the corners of triangles: measured on it, here and now, from how far slanted edges cover.
//!
//! A renderer is allowed what its corners are moved by. Vulkan lets a grid be as coarse as a 16th of a pixel and says nothing of how
//! corners are rounded to it; WebGPU does not tell. So it is not believed of a name or a file.

use crate::coverage::Painter;
use crate::grid::{Grid, LENGTH, QUADS, either, fitting};
use crate::{Device, GpuError};
use wgpu::TextureUsages;

pub(crate) const SHADER: &str = include_str!("../../../shaders/snapping.wgsl");

/// Its entry points.
pub(crate) const ENTRIES: [&str; 2] = ["corner", "covered"];

/// The constant of its vertex stage by which quads stand one below another.
pub(crate) const IS_DOWN: &str = "IS_DOWN";

const MEASURING: &str = "measuring the grid of corners";

/// As in `shaders/snapping.wgsl`.
const PITCH: u32 = 4;

/// Width and height of the picture of edges.
pub(crate) fn size(is_down: bool) -> [u32; 2] {
    let width = PITCH * QUADS;
    if is_down { [LENGTH, width] } else { [width, LENGTH] }
}

/// How far the edge of each quad covers, pixels, in such a picture of one byte a texel.
pub(crate) fn lengths(texels: &[u8], is_down: bool) -> Vec<u32> {
    let [columns, _] = size(is_down);
    let is_covered = |quad: u32, along: u32| {
        let [x, y] = if is_down { [along, PITCH * quad] } else { [PITCH * quad, along] };
        texels[(y * columns + x) as usize] > 0
    };
    (0..QUADS).map(|quad| (0..LENGTH).filter(|along| is_covered(quad, *along)).count() as u32).collect()
}

/// The grid that the lengths along both sides tell of.
pub(crate) fn grid(across: &[u32], down: &[u32]) -> Option<Grid> {
    fitting(across).zip(fitting(down)).map(|(across, down)| either(across, down))
}

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
        let grid = grid(&across?, &down?);
        Ok(*self.grid.get_or_init(|| grid))
    }

    /// How far the edge of each quad covers, pixels.
    fn lengths(&self, is_down: bool) -> Result<Vec<u32>, GpuError> {
        let (texture, encoder) = self.guarded(MEASURING, || {
            let pipeline = self.edges(is_down);
            let texture = self.coverage_target("edges", size(is_down), TextureUsages::empty());
            let view = texture.create_view(&Default::default());
            let encoder = self.coverage_painted("edges", &view, &pipeline, |pass| pass.draw(0..6, 0..QUADS));
            (texture, encoder)
        })?;
        self.submit(MEASURING, encoder)?;
        Ok(lengths(&self.texels(MEASURING, &texture)?, is_down))
    }

    fn edges(&self, is_down: bool) -> wgpu::RenderPipeline {
        self.coverage_pipeline(Painter {
            label: "edges",
            source: SHADER,
            entries: ENTRIES,
            constants: &[(IS_DOWN, f64::from(u8::from(is_down)))],
            layout: &self.pipeline_layout("edges", &[]),
            blend: None,
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

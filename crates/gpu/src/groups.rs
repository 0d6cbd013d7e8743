//! Bind groups, their layouts, the compute pipelines that take them, and how many workgroups these run in.

use crate::modules::as_shader_error;
use crate::{Device, GpuError};
use pipeline::Program;
use wgpu::{BindingResource, BindingType, BufferBindingType, ShaderStages};

/// A storage buffer that shaders read.
pub const READ: BindingType = buffer(BufferBindingType::Storage { read_only: true }, false);

/// A storage buffer that shaders read and write.
pub const WRITE: BindingType = buffer(BufferBindingType::Storage { read_only: false }, false);

/// A uniform buffer.
pub const UNIFORM: BindingType = buffer(BufferBindingType::Uniform, false);

/// A uniform buffer of which each call takes another part.
pub const UNIFORM_AT: BindingType = buffer(BufferBindingType::Uniform, true);

/// Bytes between the parts of a buffer that calls take one by one: the greatest alignment that WebGPU allows an adapter to ask for.
pub const PART_STRIDE: usize = 256;

const fn buffer(ty: BufferBindingType, has_dynamic_offset: bool) -> BindingType {
    BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None }
}

impl Device {
    /// The layout of a group with these bindings.
    pub fn group_layout(
        &self,
        label: &str,
        visibility: ShaderStages,
        bindings: impl IntoIterator<Item = (u32, BindingType)>,
    ) -> wgpu::BindGroupLayout {
        let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
        let entries: Vec<_> = bindings.into_iter().map(entry).collect();
        self.wgpu.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
    }

    /// A group of these resources.
    pub fn group<'b>(
        &self,
        label: &str,
        layout: &wgpu::BindGroupLayout,
        resources: impl IntoIterator<Item = (u32, BindingResource<'b>)>,
    ) -> wgpu::BindGroup {
        let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let entries: Vec<_> = resources.into_iter().map(entry).collect();
        self.wgpu.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
    }

    /// The layout of a pipeline that takes these groups.
    pub fn pipeline_layout(
        &self,
        label: &str,
        bind_group_layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> wgpu::PipelineLayout {
        let descriptor = wgpu::PipelineLayoutDescriptor { label: Some(label), bind_group_layouts, immediate_size: 0 };
        self.wgpu.create_pipeline_layout(&descriptor)
    }

    /// The pipeline of a kernel of a program's module, with these constants.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where the program is illegal; [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn kernel(
        &self,
        layout: &wgpu::PipelineLayout,
        (program, module): (Program, &wgpu::ShaderModule),
        entry: &'static str,
        constants: &[(&str, f64)],
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let descriptor = wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: Some(layout),
            module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        };
        self.guarded("compiling a pipeline", || self.wgpu.create_compute_pipeline(&descriptor))
            .map_err(|error| as_shader_error(error, program, entry))
    }
}

/// Workgroups of a dispatch for `count` threads or pieces, so many a group, in about as many rows as columns: more than one
/// row wherever there is more than one group, so that small pictures try what large ones rest on.
pub fn workgroups(count: u32, a_group: u32) -> [u32; 2] {
    let groups = count.div_ceil(a_group);
    let rows = groups.isqrt().max(1);
    [groups.div_ceil(rows), rows]
}

/// Whole buffers at bindings 0, 1, 2 …
pub fn whole<'b>(
    buffers: impl IntoIterator<Item = &'b wgpu::Buffer>,
) -> impl Iterator<Item = (u32, BindingResource<'b>)> {
    (0..).zip(buffers.into_iter().map(|buffer| buffer.as_entire_binding()))
}

/// The first `size` bytes of a buffer, from which calls count their offsets.
pub fn part(buffer: &wgpu::Buffer, size: u64) -> BindingResource<'_> {
    BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size: wgpu::BufferSize::new(size) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dispatch_has_room_for_all_pieces_in_rows_that_are_allowed() {
        // What each adapter of WebGPU has along an axis.
        const MOST: u64 = 65_535;
        for count in [1, 8, 9, 64, 65, 8 * 65_535, 8 * 65_536, 1 << 24, u32::MAX] {
            let [x, y] = workgroups(count, 8).map(u64::from);
            let (room, needed) = (8 * x * y, u64::from(count));
            assert!(x <= MOST && y <= MOST && room >= needed, "{count}: {x} x {y}");
            assert!(room < needed + 8 * x, "{count}: {x} x {y} has a row too many");
        }
        assert_eq!([workgroups(0, 64), workgroups(64, 64), workgroups(256, 64)], [[0, 1], [1, 1], [2, 2]]);
    }
}

//! Technique `fragment` on the device: vertices and indices that the vertex stage is fed with.

use super::tessellation::Tessellation;
use crate::triangles::SAMPLE;
use crate::triangles::gpu::{Draw, Extent, FRAGMENT_STAGE, Feed};
use gpu::{DepthOrder, Device, Drawable, GpuError, Pass, SceneBuffers};
use pipeline::wgsl::Part;
use pipeline::{Batch, Program, Vertex};
use wgpu::{BufferUsages, RenderPass, RenderPipeline, ShaderStages};

/// The technique's name.
pub(super) const NAME: &str = "fragment";

/// Entry point `vertex`, and those of the fragment stage.
pub(super) const PARTS: &[Part] = &[
    Part { file: "fragment/entry.wgsl", text: include_str!("../../../../shaders/fragment/entry.wgsl") },
    FRAGMENT_STAGE,
    SAMPLE,
];

impl Drawable for Tessellation {
    fn technique(&self) -> &'static str {
        NAME
    }

    fn parts(&self) -> &'static [Part] {
        PARTS
    }

    fn stages(&self) -> ShaderStages {
        ShaderStages::VERTEX_FRAGMENT
    }

    fn pass(&self, device: &Device, scene: &SceneBuffers, depth: DepthOrder) -> Result<Box<dyn Pass>, GpuError> {
        Ok(Box::new(Draw::<MeshBuffers>::new(device, scene, self, depth)?))
    }
}

/// The triangles on the device.
#[derive(Clone)]
struct MeshBuffers {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    batches: Vec<Batch>,
    /// Those that may show skirts.
    skirt_indices: wgpu::Buffer,
    skirt_batches: Vec<Batch>,
}

impl Feed for MeshBuffers {
    type Prepared = Tessellation;

    fn new(device: &Device, tessellation: &Tessellation) -> Result<Self, GpuError> {
        let mesh = &tessellation.mesh;
        let (skirt_indices, skirt_batches) = tessellation.beside_skirts();
        Ok(Self {
            skirt_indices: device.buffer(
                "indices of skirts",
                BufferUsages::INDEX,
                bytemuck::cast_slice(&skirt_indices),
            )?,
            skirt_batches,
            vertices: device.buffer("vertices", BufferUsages::VERTEX, bytemuck::cast_slice(&mesh.vertices))?,
            indices: device.buffer("indices", BufferUsages::INDEX, bytemuck::cast_slice(&mesh.indices))?,
            batches: mesh.batches.clone(),
        })
    }

    fn bytes(&self) -> u64 {
        self.vertices.size() + self.indices.size() + self.skirt_indices.size()
    }

    /// Which triangles are drawn is all that differs.
    fn vertex(_extent: Extent) -> &'static str {
        "vertex"
    }

    fn buffers() -> &'static [Option<wgpu::VertexBufferLayout<'static>>] {
        const { &[Some(VERTICES)] }
    }

    fn draw<'p>(
        &self,
        pass: &mut RenderPass<'_>,
        pipeline: &dyn Fn(Program) -> Option<&'p RenderPipeline>,
        extent: Extent,
        _step: usize,
    ) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        let (indices, batches) = match extent {
            Extent::Faces => (&self.indices, &self.batches),
            Extent::Skirts => (&self.skirt_indices, &self.skirt_batches),
        };
        pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        for batch in batches.iter().filter(|batch| batch.count > 0) {
            if let Some(pipeline) = pipeline(batch.program) {
                pass.set_pipeline(pipeline);
                pass.draw_indexed(batch.first..batch.first + batch.count, 0, 0..1);
            }
        }
    }

    /// Corners alone where the triangles are the same, else all of them.
    fn write_changes(&mut self, device: &Device, before: &Tessellation, after: &Tessellation) -> Result<u64, GpuError> {
        if before.mesh.indices != after.mesh.indices {
            *self = Self::new(device, after)?;
            return Ok(self.bytes());
        }
        let [before, after] = [before, after].map(|of| bytemuck::cast_slice(&of.mesh.vertices));
        device.write_changes("vertices", &self.vertices, before, after)
    }
}

/// Attributes of a [`Vertex`], by location of `VertexInput` in `shaders/fragment/entry.wgsl`.
const ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    0 => Float32x3, 1 => Float32x2, 2 => Uint32, 3 => Uint32x2, 4 => Float32x3, 5 => Uint32
];

/// Vertices as the device fetches them.
const VERTICES: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Vertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &ATTRIBUTES,
};

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    #[test]
    fn attributes_stand_where_the_vertex_has_them() {
        let offsets = ATTRIBUTES.map(|a| a.offset as usize);
        let expected = [
            offset_of!(Vertex, position),
            offset_of!(Vertex, uv),
            offset_of!(Vertex, face),
            offset_of!(Vertex, span),
            offset_of!(Vertex, normal),
            offset_of!(Vertex, frame),
        ];
        assert_eq!(offsets, expected);
        let end = ATTRIBUTES.map(|a| a.offset + a.format.size()).into_iter().max();
        assert!(end.is_some_and(|end| end <= size_of::<Vertex>() as u64));
    }
}

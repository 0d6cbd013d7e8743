//! Technique `fragment` on the device: triangles are drawn, and the fragment stage runs the program.

use super::tessellation::Tessellation;
use gpu::{
    DepthOrder, Device, Drawable, Frame, GpuError, Modules, Output, Pass, SceneBuffers, Stamps, Targets,
    as_shader_error,
};
use pipeline::wgsl::Part;
use pipeline::{Batch, Mesh, Program, Vertex};
use std::collections::HashMap;
use wgpu::{BufferUsages, ShaderStages, TextureFormat, TextureUsages};

/// The technique's name.
pub(super) const NAME: &str = "fragment";

/// Entry points `vertex`, `fragment_gbuffer` and `fragment_shaded`.
pub(super) const PARTS: &[Part] =
    &[Part { file: "fragment/entry.wgsl", text: include_str!("../../../../shaders/fragment/entry.wgsl") }];

const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

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
        let mesh = MeshBuffers::new(device, &self.mesh)?;
        let layout = device.guarded("setting up", || {
            device.wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("scene"),
                bind_group_layouts: &[Some(&scene.layout)],
                immediate_size: 0,
            })
        })?;
        Ok(Box::new(Draw { depth, mesh, layout, pipelines: HashMap::new() }))
    }
}

/// The triangles on the device.
#[derive(Clone)]
struct MeshBuffers {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    batches: Vec<Batch>,
}

impl MeshBuffers {
    fn new(device: &Device, mesh: &Mesh) -> Result<Self, GpuError> {
        Ok(Self {
            vertices: device.buffer("vertices", BufferUsages::VERTEX, bytemuck::cast_slice(&mesh.vertices))?,
            indices: device.buffer("indices", BufferUsages::INDEX, bytemuck::cast_slice(&mesh.indices))?,
            batches: mesh.batches.clone(),
        })
    }

    /// Uploads the corners that differ between two meshes of the same triangles, and says how many bytes that is.
    fn write_changes(&self, device: &Device, before: &Mesh, after: &Mesh) -> Result<u64, GpuError> {
        let [before, after] = [before, after].map(|mesh| bytemuck::cast_slice(&mesh.vertices));
        device.write_changes("vertices", &self.vertices, before, after)
    }

    fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

/// Attributes of a [`Vertex`], by location of `VertexInput` in `shaders/fragment/entry.wgsl`.
const ATTRIBUTES: [wgpu::VertexAttribute; 5] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x2, 2 => Uint32, 3 => Uint32x2, 4 => Float32x3];

/// Vertices as the device fetches them.
fn vertex_layout() -> wgpu::VertexBufferLayout<'static> {
    wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &ATTRIBUTES,
    }
}

/// The triangles and what draws them.
struct Draw {
    depth: DepthOrder,
    mesh: MeshBuffers,
    layout: wgpu::PipelineLayout,
    /// Made when first drawn with: a driver may take seconds to compile one.
    pipelines: HashMap<(Program, Output), wgpu::RenderPipeline>,
}

impl Draw {
    fn pipeline(
        &self,
        device: &Device,
        program: Program,
        module: &wgpu::ShaderModule,
        output: Output,
    ) -> Result<wgpu::RenderPipeline, GpuError> {
        let entry = match output {
            Output::GBuffer => "fragment_gbuffer",
            Output::Shaded => "fragment_shaded",
        };
        let targets: Vec<_> = output.formats().iter().map(|&format| Some(format.into())).collect();
        let compare = match self.depth {
            DepthOrder::Nearest => wgpu::CompareFunction::Greater,
            DepthOrder::Farthest => wgpu::CompareFunction::Less,
        };
        let descriptor = wgpu::RenderPipelineDescriptor {
            label: Some(entry),
            layout: Some(&self.layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[Some(vertex_layout())],
            },
            // Nothing is culled: a surface is seen from both its sides.
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        };
        device
            .guarded("compiling a pipeline", || device.wgpu.create_render_pipeline(&descriptor))
            .map_err(|error| as_shader_error(error, program, entry))
    }
}

impl Pass for Draw {
    fn prepare(&mut self, device: &Device, modules: &Modules, output: Output) -> Result<(), GpuError> {
        for (&program, module) in modules {
            if !self.pipelines.contains_key(&(program, output)) {
                let pipeline = self.pipeline(device, program, module, output)?;
                self.pipelines.insert((program, output), pipeline);
            }
        }
        Ok(())
    }

    fn frame(&self, device: &Device, targets: &Targets) -> Result<Box<dyn Frame>, GpuError> {
        let depth_buffer = device.guarded("allocating the picture", || {
            let usage = TextureUsages::RENDER_ATTACHMENT;
            device.texture("depth", targets.viewport, DEPTH_FORMAT, usage).create_view(&Default::default())
        })?;
        let Self { depth, mesh, pipelines, .. } = self;
        Ok(Box::new(Drawn { depth: *depth, mesh: mesh.clone(), pipelines: pipelines.clone(), depth_buffer }))
    }

    fn set(&mut self, device: &Device, drawn: &dyn Drawable) -> Result<(), GpuError> {
        self.mesh = MeshBuffers::new(device, &drawn.of::<Tessellation>(NAME)?.mesh)?;
        Ok(())
    }

    fn write_changes(&mut self, device: &Device, before: &dyn Drawable, after: &dyn Drawable) -> Result<u64, GpuError> {
        let (before, after) = (before.of::<Tessellation>(NAME)?, after.of::<Tessellation>(NAME)?);
        self.mesh.write_changes(device, &before.mesh, &after.mesh)
    }
}

/// One picture of the triangles.
struct Drawn {
    depth: DepthOrder,
    mesh: MeshBuffers,
    pipelines: HashMap<(Program, Output), wgpu::RenderPipeline>,
    depth_buffer: wgpu::TextureView,
}

impl Frame for Drawn {
    fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneBuffers,
        targets: &Targets,
        stamps: Option<Stamps<'_>>,
    ) {
        let farthest = match self.depth {
            DepthOrder::Nearest => 0.0,
            DepthOrder::Farthest => 1.0,
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("draw"),
            color_attachments: &targets.cleared(),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth_buffer,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(farthest),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: stamps.map(|Stamps { set, start }| wgpu::RenderPassTimestampWrites {
                query_set: set,
                beginning_of_pass_write_index: Some(start),
                end_of_pass_write_index: Some(start + 1),
            }),
            ..Default::default()
        });
        let (width, height) = (targets.viewport.width() as f32, targets.viewport.height() as f32);
        pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
        pass.set_bind_group(0, &scene.group, &[]);
        self.mesh.bind(&mut pass);
        for batch in self.mesh.batches.iter().filter(|batch| batch.count > 0) {
            // A batch of a program that no face has draws nothing of this scene.
            if let Some(pipeline) = self.pipelines.get(&(batch.program, targets.output)) {
                pass.set_pipeline(pipeline);
                pass.draw_indexed(batch.first..batch.first + batch.count, 0, 0..1);
            }
        }
    }
}

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
        ];
        assert_eq!(offsets, expected);
        let end = ATTRIBUTES.map(|a| a.offset + a.format.size()).into_iter().max();
        assert_eq!(end, Some(size_of::<Vertex>() as u64));
    }
}

//! Technique `fragment` on the device: triangles are drawn, and the fragment stage runs the program.

use crate::buffers::{ProxyBuffers, SceneBuffers, vertex_layout};
use crate::pass::{DepthOrder, Modules, Output, Targets, as_shader_error};
use crate::queries::Stamps;
use crate::{Device, GpuError};
use pipeline::{Program, Proxy};
use std::collections::HashMap;
use wgpu::{TextureFormat, TextureUsages};

const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// The triangles and what draws them.
pub(crate) struct Draw {
    depth: DepthOrder,
    pub(crate) proxy: ProxyBuffers,
    layout: wgpu::PipelineLayout,
    /// Made when first drawn with: a driver may take seconds to compile one.
    pipelines: HashMap<(Program, Output), wgpu::RenderPipeline>,
}

impl Draw {
    pub(crate) fn new(
        device: &Device,
        buffers: &SceneBuffers,
        proxy: &Proxy,
        depth: DepthOrder,
    ) -> Result<Self, GpuError> {
        let proxy = ProxyBuffers::new(device, proxy)?;
        let layout = device.guarded("setting up", || {
            device.wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("scene"),
                bind_group_layouts: &[Some(&buffers.layout)],
                immediate_size: 0,
            })
        })?;
        Ok(Self { depth, proxy, layout, pipelines: HashMap::new() })
    }

    /// Compiles the pipelines that are not there yet.
    pub(crate) fn prepare(&mut self, device: &Device, modules: &Modules, output: Output) -> Result<(), GpuError> {
        for (&program, module) in modules {
            if !self.pipelines.contains_key(&(program, output)) {
                let pipeline = self.pipeline(device, program, module, output)?;
                self.pipelines.insert((program, output), pipeline);
            }
        }
        Ok(())
    }

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

    /// A depth buffer for these targets.
    pub(crate) fn depth_buffer(&self, device: &Device, targets: &Targets) -> Result<wgpu::TextureView, GpuError> {
        device.guarded("allocating the picture", || {
            let usage = TextureUsages::RENDER_ATTACHMENT;
            device.texture("depth", targets.viewport, DEPTH_FORMAT, usage).create_view(&Default::default())
        })
    }

    /// Commands that clear the targets and draw every batch, in the proxy's order.
    pub(crate) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        buffers: &SceneBuffers,
        targets: &Targets,
        depth_buffer: &wgpu::TextureView,
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
                view: depth_buffer,
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
        pass.set_bind_group(0, &buffers.group, &[]);
        self.proxy.bind(&mut pass);
        for batch in self.proxy.batches.iter().filter(|batch| batch.count > 0) {
            // A batch of a program that no face has draws nothing of this scene.
            if let Some(pipeline) = self.pipelines.get(&(batch.program, targets.output)) {
                pass.set_pipeline(pipeline);
                pass.draw_indexed(batch.first..batch.first + batch.count, 0, 0..1);
            }
        }
    }
}

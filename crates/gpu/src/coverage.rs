//! Pictures of one byte a texel, which say what triangles cover, and the pipelines that paint them.

use crate::Device;
use wgpu::{TextureFormat, TextureUsages};

/// Of such pictures.
pub(crate) const FORMAT: TextureFormat = TextureFormat::R8Unorm;

/// A program that paints such a picture.
pub(crate) struct Painter<'a> {
    /// What it is called in messages.
    pub(crate) label: &'a str,
    /// Its WGSL.
    pub(crate) source: &'a str,
    /// The entry points of the vertex and the fragment stage.
    pub(crate) entries: [&'a str; 2],
    /// Constants of the vertex stage.
    pub(crate) constants: &'a [(&'a str, f64)],
    /// What it binds.
    pub(crate) layout: &'a wgpu::PipelineLayout,
    /// What a triangle does to a texel that it covers; `None` fills it.
    pub(crate) blend: Option<wgpu::BlendState>,
}

impl Device {
    /// A picture that can be painted and read back, and used as told besides.
    pub(crate) fn coverage_target(
        &self,
        label: &str,
        [width, height]: [u32; 2],
        usage: TextureUsages,
    ) -> wgpu::Texture {
        self.wgpu.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: usage | TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }

    /// Compiles a program that paints.
    pub(crate) fn coverage_pipeline(&self, painter: Painter) -> wgpu::RenderPipeline {
        let Painter { label, source, entries: [vertex, fragment], constants, layout, blend } = painter;
        let module = self.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        self.wgpu.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(vertex),
                compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState { format: FORMAT, blend, write_mask: wgpu::ColorWrites::RED })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
    /// Commands that clear such a picture and paint it.
    pub(crate) fn coverage_painted(
        &self,
        label: &str,
        view: &wgpu::TextureView,
        pipeline: &wgpu::RenderPipeline,
        draw: impl FnOnce(&mut wgpu::RenderPass),
    ) -> wgpu::CommandEncoder {
        let mut encoder = self.wgpu.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        draw(&mut pass);
        drop(pass);
        encoder
    }
}

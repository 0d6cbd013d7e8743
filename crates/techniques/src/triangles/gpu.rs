//! Triangles on the device: the fragment stage runs the program, and a depth buffer keeps the nearest.

use gpu::{
    DepthOrder, Device, Drawable, Frame, GpuError, Modules, Output, Pass, Room, SceneBuffers, SceneLayouts, Stamps,
    Targets, as_shader_error,
};
use pipeline::Program;
use pipeline::wgsl::Part;
use std::collections::HashMap;
use wgpu::{RenderPass, RenderPipeline, TextureFormat, TextureUsages};

/// Entry points `fragment_gbuffer` and `fragment_shaded`, and those of skirts.
pub const FRAGMENT_STAGE: Part =
    Part { file: "fragment_stage.wgsl", text: include_str!("../../../../shaders/fragment_stage.wgsl") };

const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// What is drawn of the triangles, by pipelines of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Extent {
    /// All but skirts, at the depth of the triangles.
    Faces,
    /// The skirts, which bounded faces have, at the depth of what they show: so nothing of them is culled early.
    Skirts,
}

/// A pipeline draws a program's triangles, or their skirts, to targets.
type Pipelines = HashMap<(Program, Output, Extent), RenderPipeline>;

/// What the vertex stage of a technique is fed with.
pub trait Feed: Clone + Sized + 'static {
    /// What a technique has prepared.
    type Prepared: Drawable;

    /// Uploads it.
    ///
    /// # Errors
    /// As of [`Drawable::pass`].
    fn new(device: &Device, prepared: &Self::Prepared) -> Result<Self, GpuError>;

    /// The layouts of groups 1, 2 … of the vertex stage.
    fn layouts(&self) -> Vec<Option<&wgpu::BindGroupLayout>> {
        vec![]
    }

    /// Compiles what runs before triangles are drawn, where it is not there yet.
    ///
    /// # Errors
    /// As of [`Pass::prepare`].
    fn prepare(&mut self, _device: &Device, _scene: &SceneLayouts, _modules: &Modules) -> Result<(), GpuError> {
        Ok(())
    }

    /// It with room for what a picture has had.
    ///
    /// # Errors
    /// As of [`Pass::frame`].
    fn frame(&self, _device: &Device) -> Result<Self, GpuError> {
        Ok(self.clone())
    }

    /// What there may be too little room for.
    fn room(&self) -> Option<Room<'_>> {
        None
    }

    /// Sees to it that the next frame has room for so many.
    fn make_room(&self, _needed: u64) {}

    /// Bytes of its buffers.
    fn bytes(&self) -> u64;

    /// In how many steps a picture is drawn.
    fn steps(&self) -> usize {
        1
    }

    /// Commands before the triangles of a step are drawn.
    fn before(&self, _encoder: &mut wgpu::CommandEncoder, _scene: &SceneBuffers, _step: usize) {}

    /// What a pipeline fetches from vertex buffers.
    fn buffers() -> &'static [Option<wgpu::VertexBufferLayout<'static>>] {
        &[]
    }

    /// The vertex stage's entry point.
    fn vertex(extent: Extent) -> &'static str {
        match extent {
            Extent::Faces => "vertex",
            Extent::Skirts => "skirt_vertex",
        }
    }

    /// Draws all of a step, in order, each with the pipeline of its program; of a program that no face has nothing is drawn. What cannot
    /// show a skirt may be left out of skirts.
    fn draw<'p>(
        &self,
        pass: &mut RenderPass<'_>,
        pipeline: &dyn Fn(Program) -> Option<&'p RenderPipeline>,
        extent: Extent,
        step: usize,
    );

    /// Uploads what differs between two, and says how many bytes that is.
    ///
    /// # Errors
    /// As of [`Pass::write_changes`].
    fn write_changes(
        &mut self,
        device: &Device,
        before: &Self::Prepared,
        after: &Self::Prepared,
    ) -> Result<u64, GpuError>;
}

/// The triangles and what draws them.
pub struct Draw<F> {
    technique: &'static str,
    depth: DepthOrder,
    fed: F,
    scene: SceneLayouts,
    /// Faces, and skirts where the scene has bounded faces.
    extents: &'static [Extent],
    layout: wgpu::PipelineLayout,
    /// Made when first drawn with: a driver may take seconds to compile one.
    pipelines: Pipelines,
}

impl<F: Feed> Draw<F> {
    /// Uploads what was prepared.
    ///
    /// # Errors
    /// As of [`Drawable::pass`].
    pub fn new(
        device: &Device,
        scene: &SceneBuffers,
        prepared: &F::Prepared,
        depth: DepthOrder,
    ) -> Result<Self, GpuError> {
        let fed = F::new(device, prepared)?;
        let layout = device.guarded("setting up", || {
            let groups: Vec<_> = [Some(&scene.layouts.scene)].into_iter().chain(fed.layouts()).collect();
            device.pipeline_layout("scene", &groups)
        })?;
        let extents: &[Extent] = if scene.is_trimmed { &[Extent::Faces, Extent::Skirts] } else { &[Extent::Faces] };
        let (technique, scene) = (prepared.technique(), scene.layouts.clone());
        Ok(Self { technique, depth, fed, scene, extents, layout, pipelines: HashMap::new() })
    }

    fn pipeline(
        &self,
        device: &Device,
        program: Program,
        module: &wgpu::ShaderModule,
        (output, extent): (Output, Extent),
    ) -> Result<wgpu::RenderPipeline, GpuError> {
        let entry = match (output, extent) {
            (Output::GBuffer, Extent::Faces) => "fragment_gbuffer",
            (Output::GBuffer, Extent::Skirts) => "skirt_gbuffer",
            (Output::Shaded, Extent::Faces) => "fragment_shaded",
            (Output::Shaded, Extent::Skirts) => "skirt_shaded",
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
                entry_point: Some(F::vertex(extent)),
                compilation_options: Default::default(),
                buffers: F::buffers(),
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

impl<F: Feed> Pass for Draw<F> {
    fn bytes(&self) -> u64 {
        self.fed.bytes()
    }

    fn prepare(&mut self, device: &Device, modules: &Modules, output: Output) -> Result<(), GpuError> {
        self.fed.prepare(device, &self.scene, modules)?;
        for (&program, module) in modules {
            for &extent in self.extents {
                if !self.pipelines.contains_key(&(program, output, extent)) {
                    let pipeline = self.pipeline(device, program, module, (output, extent))?;
                    self.pipelines.insert((program, output, extent), pipeline);
                }
            }
        }
        Ok(())
    }

    fn frame(&self, device: &Device, targets: &Targets) -> Result<Box<dyn Frame>, GpuError> {
        let depth_buffer = device.guarded("allocating the picture", || {
            let usage = TextureUsages::RENDER_ATTACHMENT;
            device.texture("depth", targets.viewport, DEPTH_FORMAT, usage).create_view(&Default::default())
        })?;
        let (fed, pipelines) = (self.fed.frame(device)?, self.pipelines.clone());
        Ok(Box::new(Drawn { depth: self.depth, fed, extents: self.extents, pipelines, depth_buffer }))
    }

    fn set(&mut self, device: &Device, drawn: &dyn Drawable) -> Result<(), GpuError> {
        self.fed = F::new(device, drawn.of(self.technique)?)?;
        Ok(())
    }

    fn write_changes(&mut self, device: &Device, before: &dyn Drawable, after: &dyn Drawable) -> Result<u64, GpuError> {
        self.fed.write_changes(device, before.of(self.technique)?, after.of(self.technique)?)
    }
}

/// One picture of the triangles.
struct Drawn<F> {
    depth: DepthOrder,
    fed: F,
    extents: &'static [Extent],
    pipelines: Pipelines,
    depth_buffer: wgpu::TextureView,
}

impl<F: Feed> Frame for Drawn<F> {
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
        let (width, height) = (targets.viewport.width() as f32, targets.viewport.height() as f32);
        // The clock starts before what the first step computes.
        if let Some(stamps) = stamps {
            stamps.begin(encoder);
        }
        // A picture of nothing is cleared, too.
        let steps = self.fed.steps().max(1);
        for step in 0..steps {
            let (is_first, is_last) = (step == 0, step + 1 == steps);
            self.fed.before(encoder, scene, step);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("draw"),
                color_attachments: &if is_first { targets.cleared() } else { targets.kept() },
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &self.depth_buffer,
                    depth_ops: Some(wgpu::Operations {
                        load: if is_first { wgpu::LoadOp::Clear(farthest) } else { wgpu::LoadOp::Load },
                        store: if is_last { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes: stamps.filter(|_| is_last).map(|Stamps { set, start }| {
                    wgpu::RenderPassTimestampWrites {
                        query_set: set,
                        beginning_of_pass_write_index: None,
                        end_of_pass_write_index: Some(start + 1),
                    }
                }),
                ..Default::default()
            });
            pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
            pass.set_bind_group(0, &scene.group, &[]);
            for &extent in self.extents {
                let pipeline = |program| self.pipelines.get(&(program, targets.output, extent));
                self.fed.draw(&mut pass, &pipeline, extent, step);
            }
        }
    }

    fn room(&self) -> Option<Room<'_>> {
        self.fed.room()
    }

    fn make_room(&self, _device: &Device, needed: u64) -> Result<(), GpuError> {
        self.fed.make_room(needed);
        Ok(())
    }
}

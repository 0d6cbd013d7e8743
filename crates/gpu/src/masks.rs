//! The atlas of masks, drawn on the device from its curves.
//!
//! The first pass of Geiger's algorithm, once for all faces: the vertex stage evaluates the curves, each chord makes a
//! triangle with its loop's first point, and each triangle turns over the texels that it covers. A target of 8 bits is blended
//! with source × (1 − destination) + destination × 0; with a source of one that exchanges 0 and 1, both of which the format
//! holds exactly, and WebGPU promises that the format blends. A logic operation would do the same, and wgpu has none; nor do
//! faces need rectangles to be cut to: a triangle with its corners in the box of a loop stays in it.
//!
//! Strict programs take no coverage from an adapter: their atlas is the CPU's, painted texel by texel.

use crate::coverage::Painter;
use crate::groups::{READ, UNIFORM, whole};
use crate::{Device, GpuError};
use bytemuck::{Pod, Zeroable};
use pipeline::mask::{MaskPlan, Masks};
use pipeline::wgsl;
use wgpu::{BlendComponent, BlendFactor, BlendOperation, BufferUsages, ShaderStages, TextureUsages};

const DRAWING: &str = "drawing the masks";

const READING: &str = "reading the masks back";

/// What a triangle does to a texel that it covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MaskBlend {
    /// Turns it over.
    #[default]
    Parity,
    /// Fills it: a fault, for tests of the comparer.
    Union,
}

/// What draws masks; made once, it draws those of any plan.
#[derive(Debug)]
pub struct MaskPainter {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

/// `Extent` in `shaders/entry_mask.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Extent {
    size: [f32; 2],
    curves: u32,
    padding: u32,
}

impl MaskPainter {
    /// Compiles the program.
    ///
    /// # Errors
    /// [`GpuError::Refused`], [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn new(device: &Device, blend: MaskBlend) -> Result<Self, GpuError> {
        device.guarded("compiling a pipeline", || {
            let layout = layout(device);
            Self { pipeline: pipeline(device, &layout, blend), layout }
        })
    }

    /// Draws the masks of a plan, and waits until that is done.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where the atlas does not fit the adapter; [`GpuError::OutOfMemory`], [`GpuError::Timeout`],
    /// [`GpuError::Lost`].
    pub fn draw(&self, device: &Device, plan: &MaskPlan) -> Result<MaskAtlas, GpuError> {
        let atlas = MaskAtlas::blank(device, plan.size)?;
        let extent = Extent { size: plan.size.map(|side| side as f32), curves: plan.curves.len() as u32, padding: 0 };
        let buffers = [
            device.storage("mask curves", bytemuck::cast_slice(&plan.curves))?,
            device.storage("control points of masks", bytemuck::cast_slice(&plan.control))?,
            device.buffer("the atlas's extent", BufferUsages::UNIFORM, bytemuck::bytes_of(&extent))?,
        ];
        atlas.paint(device, &self.pipeline, (&self.layout, &buffers), 3 * plan.chords())?;
        Ok(atlas)
    }
}

/// Drawn masks.
#[derive(Debug)]
pub struct MaskAtlas {
    texture: wgpu::Texture,
    pub(crate) view: wgpu::TextureView,
}

impl MaskAtlas {
    /// Masks as the CPU drew them.
    ///
    /// # Errors
    /// As [`MaskPainter::draw`].
    pub fn of(device: &Device, masks: &Masks) -> Result<Self, GpuError> {
        let atlas = Self::blank(device, masks.plan.size)?;
        let mut texels = masks.texels.clone();
        texels.resize(texels.len().next_multiple_of(size_of::<u32>()), 0);
        let buffers = [
            device.storage("texels of masks", &texels)?,
            device.buffer("the atlas's width", BufferUsages::UNIFORM, bytemuck::bytes_of(&masks.plan.size[0]))?,
        ];
        let (pipeline, layout) = device.guarded("compiling a pipeline", || {
            let layout = device.group_layout("texels", ShaderStages::FRAGMENT, (0..).zip([READ, UNIFORM]));
            let pipeline = device.coverage_pipeline(Painter {
                label: "texels",
                source: wgsl::ENTRY_TEXELS,
                entries: ["all_over", "texel"],
                constants: &[],
                layout: &device.pipeline_layout("texels", &[Some(&layout)]),
                blend: None,
            });
            (pipeline, layout)
        })?;
        atlas.paint(device, &pipeline, (&layout, &buffers), 3)?;
        Ok(atlas)
    }

    /// The texels, row-major; 255 is material.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`], [`GpuError::Timeout`], [`GpuError::Lost`].
    pub fn texels(&self, device: &Device) -> Result<Vec<u8>, GpuError> {
        device.texels(READING, &self.texture)
    }

    fn blank(device: &Device, size: [u32; 2]) -> Result<Self, GpuError> {
        let side = u64::from(size[0].max(size[1]));
        let limit = u64::from(device.limits.max_texture_dimension_2d);
        device.fits("the atlas of masks", "max_texture_dimension_2d", side, limit)?;
        device.guarded(DRAWING, || {
            let texture = device.coverage_target("masks", size, TextureUsages::TEXTURE_BINDING);
            let view = texture.create_view(&Default::default());
            Self { texture, view }
        })
    }

    /// Draws triangles of so many vertices on nothing, and waits until that is done.
    fn paint(
        &self,
        device: &Device,
        pipeline: &wgpu::RenderPipeline,
        (layout, buffers): (&wgpu::BindGroupLayout, &[wgpu::Buffer]),
        vertices: u32,
    ) -> Result<(), GpuError> {
        let encoder = device.guarded(DRAWING, || {
            let group = device.group("masks", layout, whole(buffers));
            device.coverage_painted("masks", &self.view, pipeline, |pass| {
                pass.set_bind_group(0, &group, &[]);
                pass.draw(0..vertices, 0..1);
            })
        })?;
        let submitted = device.submit(DRAWING, encoder)?;
        device.wait(DRAWING, Some(submitted))
    }
}

fn layout(device: &Device) -> wgpu::BindGroupLayout {
    device.group_layout("masks", ShaderStages::VERTEX, (0..).zip([READ, READ, UNIFORM]))
}

fn pipeline(device: &Device, layout: &wgpu::BindGroupLayout, blend: MaskBlend) -> wgpu::RenderPipeline {
    let turn_over = BlendComponent {
        src_factor: BlendFactor::OneMinusDst,
        dst_factor: BlendFactor::Zero,
        operation: BlendOperation::Add,
    };
    let blend = (blend == MaskBlend::Parity).then_some(wgpu::BlendState { color: turn_over, alpha: turn_over });
    device.coverage_pipeline(Painter {
        label: "masks",
        source: wgsl::ENTRY_MASK,
        entries: ["fan", "toggle"],
        constants: &[],
        layout: &device.pipeline_layout("masks", &[Some(layout)]),
        blend,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::TypeInner;
    use pipeline::mask::MaskCurve;

    #[test]
    fn records_and_the_capacity_are_those_of_the_shader() {
        let module = naga::front::wgsl::parse_str(wgsl::ENTRY_MASK).unwrap();
        let size = |name: &str| {
            let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap().1;
            let TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
            (*span as usize, members.last().unwrap().offset as usize)
        };
        assert_eq!(size("MaskCurve"), (size_of::<MaskCurve>(), std::mem::offset_of!(MaskCurve, chords)));
        assert_eq!(size("Extent"), (size_of::<Extent>(), std::mem::offset_of!(Extent, curves)));
        let (_, order) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some("MAX_ORDER")).unwrap();
        let expected = naga::Expression::Literal(naga::Literal::U32(nurbs::MAX_ORDER as u32));
        assert_eq!(module.global_expressions[order.init], expected);
    }
}

//! The textures of one picture.

use crate::readback::CLEARED;
use crate::{Device, GpuError};
use gbuffer::background;
use scene::Viewport;
use wgpu::{TextureFormat, TextureUsages};

/// Formats of `GBufferOutput` in `shaders/output.wgsl`.
const GBUFFER_FORMATS: [TextureFormat; 4] =
    [TextureFormat::Rgba32Uint, TextureFormat::Rgba32Float, TextureFormat::Rgba32Float, TextureFormat::Rgba32Float];

/// What a picture is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Output {
    /// Four targets that hold what a pixel sees.
    GBuffer,
    /// One colour.
    Shaded,
}

impl Output {
    /// Of its targets, in order.
    pub fn formats(self) -> &'static [TextureFormat] {
        match self {
            Output::GBuffer => &GBUFFER_FORMATS,
            Output::Shaded => &[TextureFormat::Rgba8Unorm],
        }
    }

    /// What a target holds where nothing is drawn.
    fn cleared(self, target: usize) -> wgpu::Color {
        let all = |x: f64| wgpu::Color { r: x, g: x, b: x, a: x };
        match (self, target) {
            (Output::GBuffer, 0) => all(0.0),
            (Output::GBuffer, _) => all(f64::from(CLEARED)),
            (Output::Shaded, _) => {
                let [r, g, b] = background().map(|x| f64::from(x) / 255.0);
                wgpu::Color { r, g, b, a: 1.0 }
            }
        }
    }
}

/// A picture's textures.
pub struct Targets {
    /// What they are made for.
    pub output: Output,
    /// Their size.
    pub viewport: Viewport,
    pub(crate) colours: Vec<wgpu::Texture>,
    /// One view a target.
    pub colour_views: Vec<wgpu::TextureView>,
}

impl Targets {
    /// Textures for so many pixels, with `usage` besides being drawn to and copied from.
    pub(crate) fn new(
        device: &Device,
        viewport: Viewport,
        output: Output,
        usage: TextureUsages,
    ) -> Result<Self, GpuError> {
        let side = viewport.width().max(viewport.height()) as u64;
        let limit = u64::from(device.limits.max_texture_dimension_2d);
        device.fits("the viewport", "max_texture_dimension_2d", side, limit)?;
        device.guarded("allocating the picture", || {
            let usage = usage | TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
            let texture = |&format| device.texture("target", viewport, format, usage);
            let colours: Vec<_> = output.formats().iter().map(texture).collect();
            let colour_views = colours.iter().map(|texture| texture.create_view(&Default::default())).collect();
            Self { output, viewport, colours, colour_views }
        })
    }

    /// The targets as a render pass that clears them has them.
    pub fn cleared(&self) -> Vec<Option<wgpu::RenderPassColorAttachment<'_>>> {
        self.attached(|target| wgpu::LoadOp::Clear(self.output.cleared(target)))
    }

    /// What a kernel writes where nothing is drawn, to targets of floats; those of whole numbers hold zeros.
    pub fn nothing(&self) -> [f32; 4] {
        let wgpu::Color { r, g, b, a } = self.output.cleared(self.colours.len() - 1);
        [r, g, b, a].map(|x| x as f32)
    }

    /// The targets as a render pass that keeps what is there has them.
    pub fn kept(&self) -> Vec<Option<wgpu::RenderPassColorAttachment<'_>>> {
        self.attached(|_| wgpu::LoadOp::Load)
    }

    fn attached(
        &self,
        load: impl Fn(usize) -> wgpu::LoadOp<wgpu::Color>,
    ) -> Vec<Option<wgpu::RenderPassColorAttachment<'_>>> {
        let attachment = |(target, view)| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: load(target), store: wgpu::StoreOp::Store },
            })
        };
        self.colour_views.iter().enumerate().map(attachment).collect()
    }
}

impl Device {
    /// A texture of a picture's size.
    pub fn texture(
        &self,
        label: &str,
        viewport: Viewport,
        format: TextureFormat,
        usage: TextureUsages,
    ) -> wgpu::Texture {
        self.wgpu.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: viewport.width() as u32,
                height: viewport.height() as u32,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }
}

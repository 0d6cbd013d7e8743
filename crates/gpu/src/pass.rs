//! How a technique draws on the device: what it brings, and what a renderer asks of it.

use crate::buffers::SceneBuffers;
use crate::faults::DepthOrder;
use crate::modules::Modules;
use crate::queries::Stamps;
use crate::targets::{Output, Targets};
use crate::{Device, GpuError};
use pipeline::wgsl::Part;
use std::any::Any;
use wgpu::{ShaderStages, TextureUsages};

/// What a technique has prepared of a scene, as a renderer takes it.
pub trait Drawable: Any + Send + Sync {
    /// The technique's name.
    fn technique(&self) -> &'static str;

    /// Its shaders beside those that all techniques share; the first holds the entry points.
    fn parts(&self) -> &'static [Part];

    /// The stages that read the scene.
    fn stages(&self) -> ShaderStages;

    /// Uploads it.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where it does not fit the adapter; [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    fn pass(&self, device: &Device, scene: &SceneBuffers, depth: DepthOrder) -> Result<Box<dyn Pass>, GpuError>;
}

impl dyn Drawable {
    /// It as the type that a technique's own pass takes.
    ///
    /// # Errors
    /// [`GpuError::Technique`] where it is of another technique than `expected`.
    pub fn of<T: Drawable>(&self, expected: &'static str) -> Result<&T, GpuError> {
        let other = GpuError::Technique { expected, found: self.technique() };
        (self as &dyn Any).downcast_ref().ok_or(other)
    }
}

/// What is drawn, on the device.
pub trait Pass {
    /// How the targets are used besides being cleared and copied.
    fn usage(&self) -> TextureUsages {
        TextureUsages::empty()
    }

    /// Bytes on the device that it holds beside the scene, from frame to frame; targets of pictures are not among them.
    fn bytes(&self) -> u64;

    /// Compiles the pipelines that are not there yet.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where a program is illegal; [`GpuError::Lost`].
    fn prepare(&mut self, device: &Device, modules: &Modules, output: Output) -> Result<(), GpuError>;

    /// What one picture of these targets needs, for which pipelines were prepared.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where it does not fit the adapter; [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    fn frame(&self, device: &Device, targets: &Targets) -> Result<Box<dyn Frame>, GpuError>;

    /// Takes something else of the same scene.
    ///
    /// # Errors
    /// [`GpuError::Technique`] where it is of another technique; as [`Drawable::pass`].
    fn set(&mut self, device: &Device, drawn: &dyn Drawable) -> Result<(), GpuError>;

    /// Uploads what differs between two, of which it has the first, and says how many bytes that is.
    ///
    /// # Errors
    /// [`GpuError::OtherShape`] where they have other layouts; as [`Self::set`].
    fn write_changes(&mut self, device: &Device, before: &dyn Drawable, after: &dyn Drawable) -> Result<u64, GpuError>;
}

/// One picture on the device; frames of it may be drawn one after the other.
pub trait Frame {
    /// What of it is timed by itself, in order.
    fn parts(&self) -> &'static [&'static str] {
        &["frame"]
    }

    /// Commands that clear the targets and draw.
    fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneBuffers,
        targets: &Targets,
        stamps: Option<Stamps<'_>>,
    );

    /// Whether nothing of what was drawn was lost for want of room; otherwise the pass's next frame has more.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where the adapter has no room for as much.
    fn had_room(&self, _device: &Device) -> Result<bool, GpuError> {
        Ok(true)
    }

    /// The pixels (x, y) for which the technique has no answer.
    ///
    /// # Errors
    /// Where it cannot be read back.
    fn undecided(&self, _device: &Device) -> Result<Vec<(usize, usize)>, GpuError> {
        Ok(vec![])
    }

    /// How often a search evaluated the surface for each pixel, row-major; `None` where nothing is searched for.
    ///
    /// # Errors
    /// Where it cannot be read back.
    fn evaluations(&self, _device: &Device) -> Result<Option<Vec<u32>>, GpuError> {
        Ok(None)
    }
}

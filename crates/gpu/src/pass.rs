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

    /// Whether its programs are strict: in the arithmetic of [`crate::strict`].
    fn is_strict(&self) -> bool {
        false
    }

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

/// What a frame counts on the device, and how many it has room for.
pub struct Room<'f> {
    /// Counting them, in words.
    pub during: &'static str,
    /// Where the count is, a word of 32 bits.
    pub buffer: &'f wgpu::Buffer,
    /// Bytes before it there.
    pub offset: u64,
    /// How many it has room for; the rest is counted and lost.
    pub capacity: u64,
}

impl Room<'_> {
    /// How many there were, where that is more than there was room for.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`], [`GpuError::Timeout`], [`GpuError::Lost`].
    pub fn lacking(&self, device: &Device) -> Result<Option<u64>, GpuError> {
        let mut count = 0u32;
        device.read_buffer(self.during, self.buffer, self.offset, bytemuck::bytes_of_mut(&mut count))?;
        Ok(Some(u64::from(count)).filter(|&count| count > self.capacity))
    }
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

    /// What there may be too little room for; `None` where there is always enough.
    fn room(&self) -> Option<Room<'_>> {
        None
    }

    /// Sees to it that the pass's next frame has room for so many.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where the adapter has no room for as much.
    fn make_room(&self, _device: &Device, _needed: u64) -> Result<(), GpuError> {
        Ok(())
    }

    /// Where the pixels for which the technique has no answer are marked: a buffer, and the bytes before the marks. Pixel k,
    /// row-major from the top, is bit k % 32 of word k / 32. `None` where it always has one.
    fn undecided(&self) -> Option<(&wgpu::Buffer, u64)> {
        None
    }

    /// How often a search evaluated the surface for each pixel, row-major; `None` where nothing is searched for.
    ///
    /// # Errors
    /// Where it cannot be read back.
    fn evaluations(&self, _device: &Device) -> Result<Option<Vec<u32>>, GpuError> {
        Ok(None)
    }
}

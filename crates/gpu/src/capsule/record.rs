//! A device whose calls become a capsule.
//!
//! The rejected way is to describe a frame as data that both a player and a writer take: every technique would be written
//! anew, and the renderer that is timed would be another. wgpu's trace stands below all of them, has the WGSL as the
//! compiler gets it, and costs nothing where it is off.

use super::document::{Face, Picture};
use super::error::CapsuleError;
use super::folder::Contents;
use super::tape;
use crate::Device;
use files::Scratch;
use gbuffer::{GBuffer, Meta};
use pipeline::{PackedFrame, PackedScene};
use std::path::PathBuf;

/// A device that draws one G-buffer and then becomes a capsule.
pub struct Recording {
    device: Device,
    folder: Scratch,
}

impl Recording {
    /// Opens an adapter as [`Device::open`] does, with WebGPU's own features alone: kernels take atomics of 32 bits.
    ///
    /// # Errors
    /// As [`Device::open`]; [`CapsuleError::Write`] where there is no room for the recording.
    pub fn new(adapter: Option<&str>) -> Result<Self, CapsuleError> {
        let failed = |source| CapsuleError::Write { path: PathBuf::from("a temporary folder"), source };
        let folder = Scratch::new().map_err(failed)?;
        Ok(Self { device: Device::recording(adapter, folder.path())?, folder })
    }

    /// What is to draw one G-buffer.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The capsule of the G-buffer that was drawn of a scene, with curvatures or without.
    ///
    /// # Errors
    /// [`CapsuleError::Unsupported`] where the renderer asked for what capsules do not hold, [`CapsuleError::Malformed`] where
    /// no G-buffer was drawn; [`CapsuleError::Read`], [`CapsuleError::Document`] where the recording was lost.
    pub fn finish(self, scene: &PackedScene, drawn: &GBuffer, curvature: bool) -> Result<Contents, CapsuleError> {
        let Self { device, folder } = self;
        drop(device);
        let viewport = drawn.viewport();
        let picture = Picture {
            width: viewport.width(),
            height: viewport.height(),
            curvature,
            edges: drawn.has_edges(),
            meta: Meta { adapter: None, driver: None, compiler: None, ..drawn.meta().clone() },
            faces: scene.frames().iter().map(face).collect(),
        };
        tape::contents(folder.path(), picture)
    }
}

fn face(frame: &PackedFrame) -> Face {
    Face { origin: frame.origin.to_array(), scale: frame.scale, breaks: frame.breaks.clone() }
}

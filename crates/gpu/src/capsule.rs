//! A picture's programs, buffers and commands in a folder, for any host of WebGPU to play.
//!
//! [`Recording`] draws a picture on a device whose calls wgpu itself writes down, so that no renderer knows of capsules and
//! nothing that a device is asked can be missing from one. [`Contents`] is written to a folder and read from one, [`play()`] is a
//! host, and [`gbuffer()`] makes the G-buffer of what a host hands back: bytes of textures and buffers, and no more. [`edges()`] is a
//! capsule by which a host's rasterizer is measured, and [`grid()`] what comes of it.

mod answer;
mod commands;
mod descriptors;
mod document;
mod edges;
mod error;
mod folder;
mod objects;
mod passes;
mod play;
mod record;
mod table;
mod tape;

pub use answer::gbuffer;
pub use document::{ANSWER_FILE, Answer, CAPSULE_FILE, Capsule, Host};
pub use edges::{edges, grid};
pub use error::CapsuleError;
pub use folder::{Contents, Played, Reader};
pub use play::play;
pub use record::Recording;

//! The GPU path: the fragment program of `pipeline` in WGSL, run by wgpu on any adapter, software ones among them.
//!
//! A [`Renderer`] takes the same `PackedScene` and `View`s as the CPU rasterizer, and what a technique draws of the scene
//! ([`Drawable`]). It returns a `GBuffer`, the raw [`Fragment`](pipeline::fragment::Fragment)s, or a picture shaded on the device;
//! [`probe()`] runs the program at given parameters without a picture. Nothing in wgpu's reach panics: refusals, shader
//! errors, exhausted memory and lost devices come back as [`GpuError`].
//!
//! # Examples
//! ```
//! match gpu::Device::open(None) {
//!     Ok(device) => println!("draws on {}", device.info().name),
//!     // Where there is no adapter the error says what to install.
//!     Err(error) => println!("{error}"),
//! }
//! assert!(gpu::Device::open(Some("no adapter of this name")).is_err());
//! ```

mod buffers;
pub mod capsule;
mod coverage;
mod device;
mod error;
mod faults;
mod grid;
pub mod groups;
mod hits;
mod ieee;
mod mark;
mod masks;
mod modules;
mod operation;
mod pass;
mod probe;
mod queries;
mod readback;
mod renderer;
mod snapping;
mod targets;

pub use buffers::{SceneBuffers, SceneLayouts};
pub use device::{AdapterInfo, AdapterKind, Atomics, COMPILER, Device, adapters};
pub use error::{GpuError, SOFTWARE_DRIVER, remedy};
pub use faults::{DepthOrder, Overrides};
pub use grid::{Grid, Rounding};
pub use ieee::{constants as strict_constants, strict};
pub use masks::{MaskAtlas, MaskBlend, MaskPainter};
pub use modules::{Modules, as_shader_error};
pub use operation::{Operation, Operator};
pub use pass::{Drawable, Frame, Pass, Room};
pub use probe::{PROBE, probe, probe_material};
pub use queries::Stamps;
pub use renderer::{Renderer, RendererOptions, Timing};
pub use targets::{Output, Targets};

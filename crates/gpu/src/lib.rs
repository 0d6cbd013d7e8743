//! The GPU path: the fragment program of `pipeline` in WGSL, run by wgpu on any adapter, software ones among them.
//!
//! A [`Renderer`] takes the same `PackedScene`, `Proxy` and `View`s as the CPU rasterizer and returns a `GBuffer`, the
//! raw [`Fragment`](pipeline::fragment::Fragment)s, or a picture shaded on the device; [`probe()`] runs the
//! program at given parameters without a picture. Nothing in wgpu's reach panics: refusals, shader errors, exhausted
//! memory and lost devices come back as [`GpuError`].

mod buffers;
mod device;
mod draw;
mod error;
mod exact;
mod masks;
mod pass;
mod probe;
mod queries;
mod readback;

pub use device::{AdapterInfo, AdapterKind, Device, adapters};
pub use error::{GpuError, SOFTWARE_DRIVER};
pub use masks::{MaskAtlas, MaskBlend, MaskPainter};
pub use pass::{DepthOrder, Overrides, Renderer, RendererOptions, Timing};
pub use probe::{PROBE, probe, probe_material};

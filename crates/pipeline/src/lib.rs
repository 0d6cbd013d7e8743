//! The f32 side: a packed scene, the proxies that are rasterized, and the program that runs at every fragment.
//!
//! `raster` runs [`fragment`] from this crate, `gpu` runs its twin in WGSL ([`wgsl`]); both read the same
//! [`PackedScene`], [`Proxy`] and [`View`]s, which module `packed` alone narrows from f64.

pub mod edge;
pub mod enclosure;
pub mod eval;
pub mod fragment;
mod lanes;
mod layout;
pub mod mask;
pub mod newton;
mod packed;
mod patches;
mod pieces;
mod proxy;
pub mod sight;
mod technique;
pub mod trim;
pub mod wgsl;

pub use lanes::Lanes;
pub use layout::{BOUNDED, FaceRecord, Parameters, PieceRecord, RATIONAL, REVERSED, SEARCHED, Vertex, View};
pub use packed::{PackError, PackedFrame, PackedScene, Program, Scheme, TrimMethod, Trims};
pub use proxy::{Batch, DEFAULT_CHORD_PX, Proxy, ProxyError};
pub use sight::{Footprint, Sight};
pub use technique::Technique;

//! The f32 side: a packed scene, and the program that runs at every fragment.
//!
//! `raster` runs [`fragment`] from this crate, `gpu` runs its twin in WGSL ([`wgsl`]); both read the same
//! [`PackedScene`], [`Mesh`]es and [`View`]s, which module `packed` alone narrows from f64.
//!
//! # Examples
//! ```
//! use pipeline::{PackedScene, Scheme};
//!
//! let teapot = models::builtin("teapot").expect("it is built in");
//! let scene = PackedScene::new(&teapot, Scheme::General)?;
//! assert_eq!(scene.frames().len(), 32, "each face has a frame of its own");
//! # Ok::<(), pipeline::PackError>(())
//! ```

pub mod edge;
pub mod enclosure;
pub mod eval;
pub mod fragment;
mod layout;
pub mod mask;
mod mesh;
mod packed;
pub mod sight;
pub mod trim;
mod vector;
pub mod wgsl;

pub use lanes::Lanes;
pub use layout::{BOUNDED, FaceRecord, Parameters, RATIONAL, REVERSED, SEARCHED, Vertex, View};
pub use mesh::{Batch, GREATEST_TRIANGLES, Mesh, in_drawing_order};
pub use packed::{PackError, PackedFrame, PackedScene, Program, Scheme, TrimMethod, Trims};
pub use sight::{Footprint, Sight};

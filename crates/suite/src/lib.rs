//! The conformance suite: which scenes, how each is drawn and judged, and the report of it.
//!
//! A library of its own, so that whoever judges calls the same functions: `isophote conform`, and the judge that a browser runs
//! as WebAssembly. A [`stage`] is one model, seen; [`corpus`] lists the suite's scenes, [`run`] goes through them with whoever
//! draws, and [`report`] is what it leaves.
//!
//! # Examples
//! ```
//! use scene::{Camera, Viewport};
//! use suite::stage::{Plan, Stage};
//!
//! let teapot = models::builtin("teapot").expect("it is built in");
//! let viewport = Viewport::new(64, 64)?;
//! let stage = Stage::new(&teapot, Camera::framing(&teapot, viewport), viewport, Plan::default())?;
//! assert!(stage.raster().covered() > 500);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod bits;
pub mod corpus;
pub mod difference;
pub mod embedded;
pub mod named;
pub mod progress;
pub mod report;
pub mod run;
pub mod shard;
pub mod stage;
pub mod text;
pub mod wrong;

//! Techniques: where the surface is evaluated, and what carries (u, v, face) to a pixel.
//!
//! A technique is a folder here, one of `shaders/`, and a line in [`ALL`]. It prepares a scene; the CPU rasterizer draws that by
//! its `Visibility`, the GPU by its `Pass`, and both run the same fragment program at what it finds.
//!
//! # Examples
//! ```
//! let names: Vec<&str> = techniques::ALL.iter().map(|technique| technique.name()).collect();
//! assert_eq!(names, ["fragment", "exact", "grid", "zones"]);
//! assert!(techniques::named("plaid").is_none());
//! ```

mod error;
pub mod exact;
pub mod fragment;
pub mod grid;
mod limits;
mod resolve;
mod subnormals;
mod technique;
mod triangles;
pub mod zones;

pub use error::PrepareError;
pub use limits::{DEFAULT_ZONES, GREATEST_LEVEL, Limits, PAPER_ZONES, ZONE_WORDS};
pub use technique::{Prepared, Setting, Technique};
pub use triangles::arithmetic::wrong_arithmetic;
pub use triangles::compute::ByCompute;

/// All of them; the first is the default.
pub const ALL: &[&dyn Technique] = &[&fragment::Fragment, &exact::Exact, &grid::Grid, &zones::ByZones];

/// Chord error in pixels to which triangles are made unless another is asked for.
pub const DEFAULT_CHORD_PX: f64 = 0.25;

/// The technique of a name.
pub fn named(name: &str) -> Option<&'static dyn Technique> {
    ALL.iter().copied().find(|technique| technique.name() == name)
}

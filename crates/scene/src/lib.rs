//! What is drawn, and from where: faces and their trimmed regions, models and what was noted as they were read, cameras,
//! viewports and the samples of a pixel, all in f64.
//!
//! # Examples
//! ```
//! use glam::DVec3;
//! use nurbs::{KnotVector, Surface};
//! use scene::{Camera, Model, Viewport};
//!
//! let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0])?;
//! let points = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::X + DVec3::Y];
//! let model = Model::of_surfaces("square", vec![Surface::new(knots.clone(), knots, points, None)?])?;
//! let viewport = Viewport::new(640, 480)?;
//! let camera = Camera::framing(&model, viewport);
//! let (pixel, _) = camera.project(viewport, DVec3::new(0.5, 0.5, 0.0)).expect("in front of the eye");
//! assert!((0.0..640.0).contains(&pixel.x) && (0.0..480.0).contains(&pixel.y));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod camera;
mod edges;
mod error;
mod extent;
mod face;
mod model;
mod name;
mod note;
mod profile;
mod region;
mod samples;
mod viewport;

pub use camera::{Camera, Projection, Ray};
pub use edges::{SharedEdge, closed};
pub use error::{SceneError, TrimPlace};
pub use face::{Face, FaceId, Loop, Trim};
pub use model::Model;
pub use name::escaped;
pub use note::Note;
pub use profile::{Profile, loops_from_profiles};
pub use region::{ClosedLoop, Piece, Region, Repairs, Segment, WideGap};
pub use samples::SamplePattern;
pub use viewport::Viewport;

/// The longest side of a viewport, in pixels: what wgpu devices take as a texture at least in practice.
pub const MAX_SIDE: usize = 16384;

/// The most pixels of a viewport: 8K. A G-buffer takes 116 bytes a covered pixel, a GPU's targets 68 a pixel.
pub const MAX_PIXELS: usize = 7680 * 4320;

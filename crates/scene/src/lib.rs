//! What is drawn, and from where: faces and their trimmed regions, models and what was noted as they were read, cameras,
//! viewports and the samples of a pixel, all in f64.

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
pub use edges::SharedEdge;
pub use error::{SceneError, TrimPlace};
pub use face::{Face, FaceId, Loop, Trim};
pub use model::Model;
pub use name::escaped;
pub use note::Note;
pub use profile::{Profile, loops_from_profiles};
pub use region::{ClosedLoop, Piece, Region, Repairs, Segment, WideGap};
pub use samples::SamplePattern;
pub use viewport::{MAX_PIXELS, MAX_SIDE, Viewport};

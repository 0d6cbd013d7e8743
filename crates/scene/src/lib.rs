//! What is drawn, and from where: faces, models, cameras and viewports, all in f64.

mod camera;
mod error;
mod face;
mod model;
mod viewport;

pub use camera::{Camera, Projection, Ray};
pub use error::SceneError;
pub use face::{Face, FaceId, Loop, Trim};
pub use model::Model;
pub use viewport::{MAX_PIXELS, MAX_SIDE, Viewport};

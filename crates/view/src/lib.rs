//! A window, and what a mouse does in it to a camera, a light and a control point.
//!
//! The window ([`Display`]) is a thin shell: winit brings events, egui lays the panel out, [`Canvas`] paints what egui asks for on the
//! processor, and softbuffer hands the pixels to the display. So it needs no adapter that can present, and a [`Screen`] without
//! a window has the same pixels. What gestures do is plain functions of a camera ([`orbit`], [`light`]) or a surface ([`control`]).
//!
//! # Examples
//! ```
//! use glam::DVec3;
//! use scene::{Camera, Viewport};
//! use view::orbit;
//!
//! let sphere = models::builtin("sphere").expect("it is built in");
//! let camera = Camera::framing(&sphere, Viewport::new(64, 64)?);
//! let turned = orbit::turned(&camera, DVec3::Z, 0.5, 0.0)?;
//! let away = |camera: &Camera| camera.eye().distance(camera.target());
//! assert!((away(&turned) - away(&camera)).abs() < 1e-9 && turned.eye() != camera.eye());
//! # Ok::<(), scene::SceneError>(())
//! ```

mod canvas;
pub mod control;
mod error;
mod input;
mod letters;
pub mod light;
pub mod orbit;
mod screen;
mod textures;
mod window;

pub use canvas::Canvas;
pub use egui;
pub use error::ViewError;
pub use screen::{Screen, Shown};
pub use window::Display;

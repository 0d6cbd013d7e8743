//! Lines on a model's surfaces as curves: isophotes, reflection and highlight lines, silhouettes, sections, borders and lines of
//! equal parameter, as far as they are seen in a picture.
//!
//! A [`Family`] says which lines. `equation` makes each the zeros of a polynomial on a Bézier patch, and `trace` finds them as chords
//! that are proven to be within [`TOLERANCE`] of their line in the picture, none left out; `border` does so for where faces end.
//! Chords are cut where a face has no material, `join`ed, and cut again where something hides them (`cut`): both are asked of an
//! [`Eye`]. What leaves the surface is a [`Wire`]: the control [`net()`], and curvature [`combs()`] along borders and sections.
//! [`svg()`] writes what the picture shows, [`dxf()`] the same lines in space.
//!
//! # Examples
//! ```
//! use glam::DVec2;
//! use lines::{Eye, Family, Place, draw, svg};
//! use scene::{Camera, FaceId, Viewport};
//!
//! /// Nothing is cut away, and nothing hides anything.
//! struct Glass;
//!
//! impl Eye for Glass {
//!     fn has_material(&self, _: FaceId, _: DVec2) -> bool {
//!         true
//!     }
//!
//!     fn sees(&self, _: &Place, _: f64) -> bool {
//!         true
//!     }
//! }
//!
//! let sphere = models::builtin("sphere").expect("it is built in");
//! let viewport = Viewport::new(64, 64)?;
//! let camera = Camera::framing(&sphere, viewport);
//! let drawing = draw(&sphere, &camera, viewport, &[Family::Silhouettes], &Glass);
//! assert!(svg(&drawing, &camera, viewport, "sphere", false).contains("<path"));
//! # Ok::<(), scene::SceneError>(())
//! ```

mod bernstein;
mod border;
mod comb;
mod cut;
mod dxf;
mod equation;
mod family;
mod frame;
mod join;
mod line;
mod net;
mod place;
mod svg;
mod trace;
mod wire;

pub use comb::{Combs, combs};
pub use dxf::dxf;
pub use family::Family;
pub use line::{Drawing, Line, TOLERANCE, Unfinished, draw};
pub use net::net;
pub use place::{Eye, Place};
pub use svg::svg;
pub use wire::{Wire, WireKind};

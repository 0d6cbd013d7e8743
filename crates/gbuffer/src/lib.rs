//! What a renderer returns: one [`Hit`] a pixel, with the facts of its making.
//!
//! All renderers fill the same [`GBuffer`]; it goes to and from files as NumPy's `.npz` ([`GBuffer::write_npz`],
//! [`GBuffer::read_npz`]). Pictures are made from it afterwards, by one [`Shading`] for all ([`GBuffer::shaded`]), whose
//! WGSL twin is `shaders/shade.wgsl`; along trim edges they are blended ([`GBuffer::resolved`]) where a renderer was asked for
//! them; the numbers themselves go to an OpenEXR file ([`GBuffer::write_exr`]); a [`Picture`] goes to a PNG file. A [`Quantity`], and any number a pixel, is drawn by a [`Scale`] ([`GBuffer::plotted`]), highlight lines by
//! [`GBuffer::highlighted`].
//!
//! # Examples
//! ```
//! use gbuffer::{GBuffer, Meta};
//! use glam::DVec3;
//! use nurbs::{KnotVector, Surface};
//! use scene::{Camera, Model, Viewport};
//!
//! let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0])?;
//! let points = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::X + DVec3::Y];
//! let model = Model::of_surfaces("square", vec![Surface::new(knots.clone(), knots, points, None)?])?;
//! let viewport = Viewport::new(4, 3)?;
//! let meta = Meta::new("mine", "exact", &model, &Camera::framing(&model, viewport));
//! // A renderer gives rows of hits; this one sees nothing.
//! let buffer = GBuffer::from_rows(viewport, meta, vec![vec![None; 4]; 3]);
//! assert_eq!(buffer.covered(), 0);
//! assert!(buffer.npz_bytes()?.starts_with(b"PK"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bits;
mod buffer;
mod columns;
mod error;
mod exr;
mod highlight;
mod hit;
mod legend;
mod lettering;
mod npy;
mod npz;
mod picture;
mod plot;
mod resolve;
mod scale;
mod shade;

pub use bits::{Unlike, UnlikeNumber};
pub use buffer::{GBuffer, Meta, Rows, Trims};
pub use columns::{Column, Pixel, columns_of_hits};
pub use error::GBufferError;
pub use highlight::{HungLamps, Lamps};
pub use hit::{EDGE_REACH_PX, Hit, LocalParameters, PrincipalCurvatures};
pub use picture::Picture;
pub use plot::Quantity;
pub use resolve::{Mixture, coverage};
pub use scale::Scale;
pub use shade::{ShadeInput, ShadeKind, ShadeUniform, Shading, background, shade_pixel, shade_tolerant, unorm8};

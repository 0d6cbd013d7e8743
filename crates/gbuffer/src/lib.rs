//! What a renderer returns: one [`Hit`] a pixel, with the facts of its making.
//!
//! All renderers fill the same [`GBuffer`]; pictures are made from it afterwards, by one shading code for all.

mod buffer;
mod hit;

pub use buffer::{GBuffer, Meta};
pub use hit::{Hit, PrincipalCurvatures};

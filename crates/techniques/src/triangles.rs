//! What techniques by flat triangles share: bounds of derivatives, what is in the picture, who is seen on the CPU, and the pass
//! that draws on a GPU.

pub mod bounds;
pub mod cpu;
mod cut;
pub mod frustum;
pub mod gpu;
pub mod patches;

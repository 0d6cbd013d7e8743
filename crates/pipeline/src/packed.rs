//! A scene in f32: how it is packed, what it holds, how it is seen, and how its answers become f64 again.

mod error;
mod frame;
mod numbers;
mod pack;
mod scene;
mod view;
mod widen;

pub(crate) use error::GREATEST_COUNT;
pub use error::PackError;
pub use frame::PackedFrame;
pub(crate) use numbers::Numbers;
pub use pack::Scheme;
pub use scene::{PackedScene, Program, TrimMethod, Trims};

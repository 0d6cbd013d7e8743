//! Isophote as a module of Python: models in, NumPy arrays out.
//!
//! A layer over `isophote`, the library below the command line, so that both give the same numbers. The package is
//! `python/isophote`; this is its `_isophote`. `docs/python.md` tells users of it. Arrays are made in Rust and given to
//! NumPy with their memory, so that none is copied. Work goes on without the interpreter's lock, and stops on Ctrl-C.

mod arrays;
mod camera;
mod errors;
mod evaluation;
mod gbuffer;
mod json;
mod model;
mod rays;
mod verdict;
mod work;

/// The native half of the package `isophote`.
#[pyo3::pymodule]
mod _isophote {
    #[pymodule_export]
    use crate::camera::Camera;
    #[pymodule_export]
    use crate::errors::{CameraError, EvalError, GBufferError, IsophoteError, ReadError, RenderError};
    #[pymodule_export]
    use crate::gbuffer::GBuffer;
    #[pymodule_export]
    use crate::model::{Face, Model, open};
    #[pymodule_export]
    use crate::verdict::Verdict;
}

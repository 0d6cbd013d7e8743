//! What Python raises: the library's errors in its own words, by what was asked for.

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyValueError};
use pyo3::prelude::*;

create_exception!(
    isophote,
    IsophoteError,
    PyException,
    "What isophote cannot do; its subclasses say what was asked for."
);
create_exception!(isophote, ReadError, IsophoteError, "There is no such model, or its file cannot be read.");
create_exception!(isophote, CameraError, IsophoteError, "The options make no camera.");
create_exception!(isophote, RenderError, IsophoteError, "The model cannot be drawn so.");
create_exception!(isophote, EvalError, IsophoteError, "A surface cannot be evaluated there.");
create_exception!(
    isophote,
    GBufferError,
    IsophoteError,
    "Arrays or a file make no G-buffer, or not one of this scene."
);

/// An error of Python's type `E` with the library's text.
pub fn raise<E: pyo3::PyTypeInfo>(error: impl Into<anyhow::Error>) -> PyErr {
    PyErr::new::<E, _>(format!("{:#}", error.into()))
}

/// A word that is none of those that are legal.
pub fn no_word(what: &str, word: &str, legal: &[&str]) -> PyErr {
    PyValueError::new_err(format!("{what} {word:?} is none of {}", legal.join(", ")))
}

//! What Rust says in JSON, as Python's own dictionaries and lists.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Serialize;

/// The same value in Python.
///
/// # Errors
/// Where it is no JSON, as infinities are none.
pub fn to_python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| PyValueError::new_err(error.to_string()))?;
    of_text(py, &text)
}

/// The value of a text.
///
/// # Errors
/// Where it is no JSON.
pub fn of_text<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}

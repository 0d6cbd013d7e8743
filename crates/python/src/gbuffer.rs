//! `GBuffer`: what a renderer returned, each array by its name.

use crate::arrays::taken;
use crate::errors::{GBufferError, raise};
use crate::json;
use gbuffer::{Column, GBuffer as Buffer, Pixel};
use numpy::Element;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// What a renderer returned, as read-only arrays of height × width: `face`, `u`, `v`, `t`, `pos`, `normal` and the others of
/// docs/gbuffer.md. An array is made when it is first asked for, and kept.
#[pyclass(frozen, module = "isophote")]
pub struct GBuffer {
    buffer: Arc<Buffer>,
    made: Mutex<HashMap<&'static str, Py<PyAny>>>,
}

impl From<Buffer> for GBuffer {
    fn from(buffer: Buffer) -> Self {
        Self { buffer: Arc::new(buffer), made: Mutex::default() }
    }
}

impl GBuffer {
    /// The same in Rust.
    pub fn shared(&self) -> Arc<Buffer> {
        self.buffer.clone()
    }

    /// One array, made now.
    fn array<'py>(&self, py: Python<'py>, column: Column) -> PyResult<Bound<'py, PyAny>> {
        match column {
            Column::Byte(value) => self.plane(py, value),
            Column::Integer(value) => self.plane(py, value),
            Column::Number(value) => self.plane(py, value),
            Column::Integers(value) => self.planes(py, value),
            Column::Pair(value) => self.planes(py, value),
            Column::Triple(value) => self.planes(py, value),
        }
    }

    fn plane<'py, T: Element + Send>(&self, py: Python<'py>, value: fn(Pixel) -> T) -> PyResult<Bound<'py, PyAny>> {
        let viewport = self.buffer.viewport();
        let values = py.detach(|| self.buffer.values(value).collect());
        taken(py, values, &[viewport.height(), viewport.width()])
    }

    fn planes<'py, T: Element + Send, const N: usize>(
        &self,
        py: Python<'py>,
        value: fn(Pixel) -> [T; N],
    ) -> PyResult<Bound<'py, PyAny>> {
        let viewport = self.buffer.viewport();
        let values = py.detach(|| self.buffer.values(value).collect::<Vec<[T; N]>>().into_flattened());
        taken(py, values, &[viewport.height(), viewport.width(), N])
    }
}

#[pymethods]
impl GBuffer {
    /// What a file of docs/gbuffer.md's form holds.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        Buffer::read_npz(path).map(Self::from).map_err(raise::<GBufferError>)
    }

    /// What the bytes of such a file hold.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        Buffer::from_npz_bytes(bytes, "arrays").map(Self::from).map_err(raise::<GBufferError>)
    }

    /// Writes a file of docs/gbuffer.md's form.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.buffer.write_npz(path)).map_err(raise::<GBufferError>)
    }

    /// Width and height, pixels.
    #[getter]
    fn size(&self) -> (usize, usize) {
        (self.buffer.viewport().width(), self.buffer.viewport().height())
    }

    /// How many pixels show something.
    #[getter]
    fn covered(&self) -> usize {
        self.buffer.covered()
    }

    /// Where it comes from: model, camera, renderer, technique.
    #[getter]
    fn meta<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::of_text(py, &self.buffer.meta_text())
    }

    /// The names of its arrays.
    fn keys(&self) -> Vec<&'static str> {
        self.buffer.columns().map(|(name, _)| name).collect()
    }

    /// All that a file holds of it: the arrays, and `meta` as a text. `numpy.savez` makes a file of them, and
    /// `isophote.gbuffer` a G-buffer.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let arrays = PyDict::new(py);
        for name in self.keys() {
            arrays.set_item(name, self.__getitem__(py, name)?)?;
        }
        arrays.set_item("meta", self.buffer.meta_text())?;
        Ok(arrays)
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let made = || self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(array) = made().get(name) {
            return Ok(array.bind(py).clone());
        }
        let Some((name, column)) = self.buffer.columns().find(|(known, _)| *known == name) else {
            return Err(PyKeyError::new_err(format!("this G-buffer has {}, and no {name:?}", self.keys().join(", "))));
        };
        let array = self.array(py, column)?;
        // Where two threads ask at once both get the first one's.
        Ok(made().entry(name).or_insert_with(|| array.unbind()).bind(py).clone())
    }

    fn __getattr__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let is_array = self.buffer.columns().any(|(known, _)| known == name);
        if !is_array {
            let what = format!("this G-buffer has no array {name:?} ({})", self.keys().join(", "));
            return Err(pyo3::exceptions::PyAttributeError::new_err(what));
        }
        self.__getitem__(py, name)
    }

    fn __dir__(&self) -> Vec<&'static str> {
        let own = ["arrays", "covered", "from_bytes", "keys", "meta", "read", "size", "write"];
        self.keys().into_iter().chain(own).collect()
    }

    fn __repr__(&self) -> String {
        let (meta, (width, height)) = (self.buffer.meta(), self.size());
        format!(
            "GBuffer({:?} by {} {}, {width}x{height}, {} covered)",
            meta.model,
            meta.renderer,
            meta.technique,
            self.covered()
        )
    }
}

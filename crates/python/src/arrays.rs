//! NumPy arrays whose memory is a Rust vector's.

use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{Element, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// An array that takes a vector's memory over, and that nobody writes to: what a G-buffer says and what is judged stay one.
///
/// # Errors
/// Where the shape is not the vector's.
pub fn taken<'py, T: Element>(py: Python<'py>, values: Vec<T>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let array = ArrayD::from_shape_vec(IxDyn(shape), values).map_err(|e| PyValueError::new_err(e.to_string()))?;
    let array = PyArrayDyn::from_owned_array(py, array);
    array.readwrite().make_nonwriteable();
    Ok(array.into_any())
}

/// Rows of `N` numbers of anything that NumPy makes an array of.
///
/// # Errors
/// Where it is not of that shape.
pub fn rows<const N: usize>(values: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<[f64; N]>> {
    let py = values.py();
    let options = PyDict::new(py);
    options.set_item("dtype", "float64")?;
    options.set_item("ndmin", 2)?;
    let array = py.import("numpy")?.call_method("array", (values,), Some(&options))?;
    let wrong = |shape: &dyn std::fmt::Debug| {
        PyValueError::new_err(format!("{what} has shape {shape:?}, where rows of {N} numbers are asked for"))
    };
    let array: PyReadonlyArray2<f64> = array.extract().map_err(|_| wrong(&"of more than two dimensions"))?;
    if array.shape()[1] != N {
        return Err(wrong(&array.shape()));
    }
    let row = |row: numpy::ndarray::ArrayView1<f64>| std::array::from_fn(|k| row[k]);
    Ok(array.as_array().rows().into_iter().map(row).collect())
}

/// Numbers of faces: one for all of `count` rows, or one a row.
///
/// # Errors
/// Where they are no integers, or as many as neither.
pub fn faces(values: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<i64>> {
    if let Ok(face) = values.extract::<i64>() {
        return Ok(vec![face; count]);
    }
    let array = values.call_method1("astype", ("int64", "K", "safe"))?;
    let array = array.cast_into::<PyArray1<i64>>().map_err(|_| PyValueError::new_err("face is no row of integers"))?;
    let faces = array.readonly().as_array().to_vec();
    match faces.len() == count {
        true => Ok(faces),
        false => Err(PyValueError::new_err(format!("there are {} faces and {count} points", faces.len()))),
    }
}

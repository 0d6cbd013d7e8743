//! `Model.eval`: what is known of surfaces at given parameters, as arrays.

use crate::arrays::taken;
use crate::errors::EvalError;
use isophote::eval::{check, finite, scalars, vectors};
use nurbs::{Curvature, Normal, SurfacePoint};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use scene::{FaceId, Model};

/// What is known at each of some points of faces.
///
/// # Errors
/// Where the model has no such face, its surface no such parameters, or f64 does not hold a value; which.
pub fn points(model: &Model, faces: &[i64], uv: &[[f64; 2]]) -> anyhow::Result<Vec<SurfacePoint>> {
    let point = |(k, (&face, &[u, v])): (usize, (&i64, &[f64; 2]))| {
        let count = model.faces().len();
        let id = usize::try_from(face).ok().filter(|id| *id < count);
        let id = id.ok_or_else(|| anyhow::anyhow!("face[{k}] is {face}; the model has {count}"))?;
        let surface = model.surface(FaceId(id as u32));
        let place = |error: anyhow::Error| error.context(format!("uv[{k}] on face {face}"));
        check(surface, u, v).map_err(place)?;
        let point = oriented(surface.inspect(u, v), model.faces()[id].reversed);
        let named = vectors(&point).into_iter().flat_map(|(name, x)| x.to_array().map(|x| (name, x)));
        let scalars = scalars(&point).into_iter().filter_map(|(name, x)| Some((name, x?)));
        named.chain(scalars).try_for_each(|(name, x)| finite(name, x).map(|_| ())).map_err(place)?;
        Ok(point)
    };
    faces.par_iter().zip(uv).enumerate().map(point).collect()
}

/// A point as a reversed face has it: normal and curvatures change signs, the derivatives do not.
fn oriented(point: SurfacePoint, reversed: bool) -> SurfacePoint {
    if !reversed {
        return point;
    }
    let normal = match point.normal {
        Normal::Regular(n) => Normal::Regular(-n),
        Normal::Limit(n) => Normal::Limit(-n),
        Normal::Undefined => Normal::Undefined,
    };
    let curvature = point.curvature.map(|k| Curvature { gaussian: k.gaussian, mean: -k.mean, k1: -k.k2, k2: -k.k1 });
    SurfacePoint { normal, curvature, ..point }
}

/// The same as arrays by the names of `isophote eval`; NaN where there is none.
///
/// # Errors
/// Where Python has no memory left.
pub fn arrays<'py>(py: Python<'py>, points: &[SurfacePoint]) -> PyResult<Bound<'py, PyDict>> {
    let (arrays, count) = (PyDict::new(py), points.len());
    let triples = |values: Vec<[f64; 3]>| taken(py, values.into_flattened(), &[count, 3]);
    let names = |k: usize| points.first().map(|point| vectors(point)[k].0);
    for k in 0..6 {
        if let Some(name) = names(k) {
            arrays.set_item(name, triples(points.iter().map(|point| vectors(point)[k].1.to_array()).collect())?)?;
        }
    }
    let normal = |point: &SurfacePoint| point.normal.unit().map_or([f64::NAN; 3], |n| n.to_array());
    arrays.set_item("normal", triples(points.iter().map(normal).collect())?)?;
    let status = points.iter().map(|point| point.normal.status() as u8).collect();
    arrays.set_item("status", taken::<u8>(py, status, &[count])?)?;
    for k in 0..10 {
        if let Some(name) = points.first().map(|point| scalars(point)[k].0) {
            let values = points.iter().map(|point| scalars(point)[k].1.unwrap_or(f64::NAN)).collect();
            arrays.set_item(name, taken::<f64>(py, values, &[count])?)?;
        }
    }
    Ok(arrays)
}

/// An error of this module's in Python.
pub fn raised(error: anyhow::Error) -> PyErr {
    crate::errors::raise::<EvalError>(error)
}

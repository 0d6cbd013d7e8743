//! `Model.rays`: all hits of given rays, as arrays.

use crate::arrays::taken;
use crate::work::Patience;
use anyhow::bail;
use gbuffer::{Column, Hit, Pixel, columns_of_hits};
use glam::DVec3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use raycast::{AllHits, Caster};
use rayon::prelude::*;
use scene::{Model, Ray};

/// Casts rays, each from an origin along a direction of any length but zero; t is in model units.
///
/// # Errors
/// Where there are not as many origins as directions, or a ray is none.
pub fn cast(
    model: &Model,
    origins: &[[f64; 3]],
    directions: &[[f64; 3]],
    near: f64,
    patience: &Patience,
) -> anyhow::Result<Vec<AllHits>> {
    if origins.len() != directions.len() {
        bail!("there are {} origins and {} directions", origins.len(), directions.len());
    }
    if near.is_nan() {
        bail!("near is not a number");
    }
    let ray = |(k, (&origin, &direction)): (usize, (&[f64; 3], &[f64; 3]))| {
        let origin = DVec3::from_array(origin);
        match DVec3::from_array(direction).try_normalize() {
            Some(direction) if origin.is_finite() => Ok(Ray { origin, direction, near }),
            Some(_) => bail!("origins[{k}] is {origin}, which is no place"),
            None => bail!("directions[{k}] is {direction:?}, which has no direction"),
        }
    };
    let rays: Vec<Ray> = origins.iter().zip(directions).enumerate().map(ray).collect::<anyhow::Result<_>>()?;
    let caster = Caster::new(model);
    let all = |ray: &Ray| {
        patience.check();
        caster.all(ray)
    };
    Ok(rays.par_iter().map(all).collect())
}

/// Hits by ray and then by t, an array a name: `ray` says whose each is, `undecided` how many places of each ray stay open.
///
/// # Errors
/// Where Python has no memory left.
pub fn arrays<'py>(py: Python<'py>, found: &[AllHits]) -> PyResult<Bound<'py, PyDict>> {
    let arrays = PyDict::new(py);
    let hits: Vec<&Hit> = found.iter().flat_map(|all| &all.hits).collect();
    let rays: Vec<i64> = (0..).zip(found).flat_map(|(k, all)| all.hits.iter().map(move |_| k)).collect();
    arrays.set_item("ray", taken(py, rays, &[hits.len()])?)?;
    let pixels = || hits.iter().map(|hit| Pixel { hit: Some(hit), is_undecided: false });
    let (row, pair, triple) = ([hits.len()], [hits.len(), 2], [hits.len(), 3]);
    for (name, column) in columns_of_hits() {
        let array = match column {
            Column::Byte(value) => taken(py, pixels().map(value).collect(), &row),
            Column::Integer(value) => taken(py, pixels().map(value).collect(), &row),
            Column::Number(value) => taken(py, pixels().map(value).collect(), &row),
            Column::Integers(value) => taken(py, pixels().map(value).collect::<Vec<_>>().into_flattened(), &pair),
            Column::Pair(value) => taken(py, pixels().map(value).collect::<Vec<_>>().into_flattened(), &pair),
            Column::Triple(value) => taken(py, pixels().map(value).collect::<Vec<_>>().into_flattened(), &triple),
        };
        arrays.set_item(name, array?)?;
    }
    let open: Vec<i64> = found.iter().map(|all| all.undecided.len() as i64).collect();
    arrays.set_item("undecided", taken(py, open, &[found.len()])?)?;
    Ok(arrays)
}

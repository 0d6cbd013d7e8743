//! `Camera`: the options of the command line, checked by the command line.

use crate::errors::{CameraError, no_word, raise};
use clap::{Parser, ValueEnum};
use isophote::view::{Side, ViewArgs};
use isophote::words;
use pyo3::prelude::*;
use scene::{Model, Viewport};

/// The options of a camera alone.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct Options {
    #[command(flatten)]
    view: ViewArgs,
}

/// Where the camera stands, in the words of the command line; what is left out is found from the model.
#[pyclass(frozen, module = "isophote")]
pub struct Camera(ViewArgs);

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (*, view=None, azimuth=None, elevation=None, zoom=None, eye=None, target=None, up=None, fov=None, ortho=None, near=None, lens_shift=None))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        view: Option<&str>,
        azimuth: Option<f64>,
        elevation: Option<f64>,
        zoom: Option<f64>,
        eye: Option<[f64; 3]>,
        target: Option<[f64; 3]>,
        up: Option<[f64; 3]>,
        fov: Option<f64>,
        ortho: Option<f64>,
        near: Option<f64>,
        lens_shift: Option<[f64; 2]>,
    ) -> PyResult<Self> {
        let side = |name: &str| {
            let names: Vec<String> = Side::value_variants().iter().map(words::value_name).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            Side::from_str(name, false).map_err(|_| no_word("view", name, &names))
        };
        let [eye, target, up] = [eye, target, up].map(|vector| vector.map(|vector| vector.to_vec()));
        let lens_shift = lens_shift.map(|shift| shift.to_vec());
        let view = view.map(side).transpose()?;
        let asked =
            ViewArgs { view, azimuth, elevation, zoom, eye, target, up, fov, ortho, near, lens_shift, size: None };
        match Options::try_parse_from(asked.words().into_iter().flatten()) {
            Ok(options) => Ok(Self(options.view)),
            Err(error) => {
                let text = error.render().to_string();
                let line = text.lines().next().unwrap_or_default();
                Err(CameraError::new_err(line.trim_start_matches("error: ").to_owned()))
            }
        }
    }

    fn __repr__(&self) -> String {
        format!("Camera({})", words::line(self.0.words().into_iter().flatten()))
    }
}

/// The camera that sees a model; the command line's own where none is given.
///
/// # Errors
/// Where the values make none.
pub fn seeing(camera: Option<&Camera>, model: &Model, viewport: Viewport) -> PyResult<scene::Camera> {
    let framing = match camera {
        Some(camera) => camera.0.clone(),
        None => Options::try_parse_from([""; 0]).map(|options| options.view).map_err(raise::<CameraError>)?,
    };
    framing.camera(model, viewport).map_err(raise::<CameraError>)
}

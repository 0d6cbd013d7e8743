//! `open`, `Model` and `Face`: what a file holds, and what can be asked of it.

use crate::arrays::{faces, rows};
use crate::camera::{Camera, seeing};
use crate::errors::{GBufferError, ReadError, RenderError, no_word, raise};
use crate::gbuffer::GBuffer;
use crate::verdict::Verdict;
use crate::work::{self, Patience};
use crate::{evaluation, json, rays};
use clap::ValueEnum;
use formats::Document;
use gbuffer::GBuffer as Buffer;
use isophote::compare::Saved;
use isophote::stage::{Plan, Stage};
use isophote::view::ModelArgs;
use isophote::with::With;
use isophote::{info, number, words};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use raycast::Caster;
use scene::Viewport;
use std::ffi::CString;
use std::path::PathBuf;
use std::sync::Arc;

/// Warnings that one file may give; `Model.notes` has all.
const WARNINGS: usize = 10;

/// A model as it was read from its file.
#[pyclass(frozen, module = "isophote")]
pub struct Model(Arc<Document>);

/// A face of a model.
#[pyclass(frozen, get_all, module = "isophote")]
pub struct Face {
    /// The number of its surface.
    surface: usize,
    /// Whether its normal is −(Su × Sv).
    reversed: bool,
    /// Parameters of its surface: ((u0, u1), (v0, v1)).
    domain: ((f64, f64), (f64, f64)),
    /// Degrees of its surface in u and v.
    degree: (usize, usize),
    /// How many loops bound it; 0 where it is whole.
    loops: usize,
    /// Its name in the file, or that of what it is a part of.
    name: Option<String>,
    /// Its colour, `#rrggbb`.
    colour: Option<String>,
    /// What its surface is in the file.
    kind: String,
}

#[pymethods]
impl Face {
    fn __repr__(&self) -> String {
        let Self { surface, kind, loops, .. } = self;
        format!("Face(surface {surface}, {kind}, {loops} loops)")
    }
}

/// Opens a model: a built-in one by its name, or a file. What is lost of it is a warning, and all that is known of how it was
/// read is in `Model.notes`.
#[pyfunction]
pub fn open(py: Python<'_>, path: PathBuf) -> PyResult<Model> {
    let name = path.into_os_string().into_string();
    let name = name.map_err(|path| ReadError::new_err(format!("{path:?}: its name is not Unicode text")))?;
    let args = ModelArgs::named(&name);
    let document = work::done(py, move |_| args.read())?.map_err(raise::<ReadError>)?;
    for note in document.notes.iter().filter(|note| note.kind.is_loss()).take(WARNINGS) {
        let text = CString::new(format!("{name}: {note}").replace('\0', " ")).expect("no zero is left");
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
    }
    Ok(Model(Arc::new(document)))
}

/// How a picture is drawn.
struct Drawing {
    camera: scene::Camera,
    viewport: Viewport,
    with: With,
    plan: Plan,
    adapter: Option<String>,
}

impl Drawing {
    fn drawn(&self, document: &Document, patience: &Patience) -> anyhow::Result<Buffer> {
        let Self { camera, viewport, plan, adapter, .. } = self;
        let model = &document.model;
        let check = |_| patience.check();
        let stage = || Stage::new(model, *camera, *viewport, *plan);
        match self.with {
            With::Raycast => Ok(Caster::new(model).with_edges(plan.edges).render(camera, *viewport, &check)),
            With::Raster => {
                let stage = stage()?;
                let options = raster::Options { curvature: true, vertex_normals: false };
                Ok(stage.rasterizer(options).render(stage.meta("raster"), &check))
            }
            With::Gpu => {
                let device = gpu::Device::open(adapter.as_deref())?;
                Ok(stage()?.gpu(&device, None, gpu::Overrides::default())?.gbuffer)
            }
        }
    }
}

#[pymethods]
impl Model {
    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        self.0.model.name()
    }

    /// All that `isophote info --format json` says.
    #[getter]
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &info::describe(&self.0, None))
    }

    /// What of the file is not drawn as it stands there, and what was approximated.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.notes.iter().map(ToString::to_string).collect()
    }

    /// Its faces; a G-buffer's `face` is an index into them.
    #[getter]
    fn faces(&self) -> Vec<Face> {
        let model = &self.0.model;
        let face = |(face, said): (&scene::Face, &formats::Attributes)| {
            let surface = &model.surfaces()[face.surface];
            let ([[u0, u1], [v0, v1]], [p, q]) = (surface.domain(), surface.degree());
            Face {
                surface: face.surface,
                reversed: face.reversed,
                domain: ((u0, u1), (v0, v1)),
                degree: (p, q),
                loops: face.loops.len(),
                name: said.name.as_ref().map(ToString::to_string),
                colour: said.colour.map(|colour| colour.to_string()),
                kind: said.surface.to_string(),
            }
        };
        model.faces().iter().zip(&self.0.attributes).map(face).collect()
    }

    /// Draws the model as `isophote render --gbuffer` does.
    ///
    /// `renderer` is "raycast" (f64, rays), "raster" (f32, the CPU) or "gpu"; the last two draw by `technique`, whose triangles
    /// are within `error` pixels. `edges` asks for the array `edge`. `adapter` is a part of a GPU's name.
    #[pyo3(signature = (camera=None, size=(512, 512), renderer="raycast", *, technique="fragment", error=techniques::DEFAULT_CHORD_PX, edges=false, adapter=None))]
    #[expect(clippy::too_many_arguments, reason = "most are keywords")]
    fn render(
        &self,
        py: Python<'_>,
        camera: Option<&Camera>,
        size: (usize, usize),
        renderer: &str,
        technique: &str,
        error: f64,
        edges: bool,
        adapter: Option<String>,
    ) -> PyResult<GBuffer> {
        let renderers: Vec<String> = With::value_variants().iter().map(words::value_name).collect();
        let renderers: Vec<&str> = renderers.iter().map(String::as_str).collect();
        let with = With::from_str(renderer, false).map_err(|_| no_word("renderer", renderer, &renderers))?;
        let viewport = Viewport::new(size.0, size.1).map_err(raise::<RenderError>)?;
        let camera = seeing(camera, &self.0.model, viewport)?;
        let plan = Plan { edges, ..plan(technique, error)? };
        let (drawing, document) = (Drawing { camera, viewport, with, plan, adapter }, self.0.clone());
        let buffer = work::done(py, move |patience| drawing.drawn(&document, patience))?;
        buffer.map(GBuffer::from).map_err(raise::<RenderError>)
    }

    /// What is known at parameters `uv`, a row (u, v) a point, of one face or of a face a point: arrays S, Su, Sv, Suu, Suv, Svv,
    /// normal, status, K, H, k1, k2, E, F, G, L, M, N, as `isophote eval` names them. Signs are those of the face's normal.
    fn eval<'py>(
        &self,
        py: Python<'py>,
        face: &Bound<'py, PyAny>,
        uv: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let uv = rows::<2>(uv, "uv")?;
        let (faces, document) = (faces(face, uv.len())?, self.0.clone());
        let points = work::done(py, move |_| evaluation::points(&document.model, &faces, &uv))?;
        evaluation::arrays(py, &points.map_err(evaluation::raised)?)
    }

    /// Every hit with t ≥ `near` of each ray, by ray and then by t: arrays ray, face, u, v, span, local, t, pos, normal, status,
    /// k1, k2. `undecided` has a count a ray: 0 where the list of its hits is proven complete.
    #[pyo3(signature = (origins, directions, *, near=0.0))]
    fn rays<'py>(
        &self,
        py: Python<'py>,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        near: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (origins, directions) = (rows::<3>(origins, "origins")?, rows::<3>(directions, "directions")?);
        let document = self.0.clone();
        let found = work::done(py, move |patience| rays::cast(&document.model, &origins, &directions, near, patience))?;
        rays::arrays(py, &found.map_err(raise::<RenderError>)?)
    }

    /// Judges a G-buffer of this model against rays that are cast now, as `isophote compare A.npz` does; of two, the second
    /// against the first as well. Flat triangles are allowed `error` pixels; by technique "exact" nobody is.
    #[pyo3(signature = (gbuffer, other=None, *, technique="fragment", error=techniques::DEFAULT_CHORD_PX))]
    fn judge(
        &self,
        py: Python<'_>,
        gbuffer: &GBuffer,
        other: Option<&GBuffer>,
        technique: &str,
        error: f64,
    ) -> PyResult<Verdict> {
        let plan = plan(technique, error)?;
        let named = |(name, buffer): (&str, &GBuffer)| (PathBuf::from(name), buffer.shared());
        let buffers = [Some(("the G-buffer", gbuffer)), other.map(|other| ("the other G-buffer", other))];
        let buffers: Vec<(PathBuf, Arc<Buffer>)> = buffers.into_iter().flatten().map(named).collect();
        let document = self.0.clone();
        let comparison = work::done(py, move |_| {
            let buffers = buffers.into_iter().map(|(name, buffer)| (name, Buffer::clone(&buffer))).collect();
            Saved::of_buffers(document.model.clone(), buffers)?.compare(plan, None)
        })?;
        comparison.map(Verdict::from).map_err(raise::<GBufferError>)
    }

    fn __repr__(&self) -> String {
        format!("Model({:?}, {} faces)", self.name(), self.0.model.faces().len())
    }
}

/// The plan of a technique by its name, within an error in pixels.
fn plan(technique: &str, error: f64) -> PyResult<Plan> {
    let names: Vec<&str> = techniques::ALL.iter().map(|technique| technique.name()).collect();
    let technique = techniques::named(technique).ok_or_else(|| no_word("technique", technique, &names))?;
    let chord_px = number::error_px(&words::number(error))
        .map_err(|what| RenderError::new_err(format!("an error of {error} pixels: {what}")))?;
    Ok(Plan { technique, chord_px, ..Plan::default() })
}

//! `bless`: the goldens of the CPU rasterizer.

use anyhow::{Context, Result};
use clap::Args;
use gbuffer::GBuffer;
use glam::DVec3;
use isophote::say;
use isophote::stage::{Plan, Stage};
use pipeline::Scheme;
use scene::{Camera, Model, Projection, Viewport};
use std::path::PathBuf;

/// A golden's size, pixels: small enough that all of them stay under a megabyte.
const SIZE: [usize; 2] = [64, 48];

/// Write the golden G-buffers of the CPU rasterizer anew; nothing else may write them
#[derive(Debug, Args)]
pub struct BlessArgs {
    /// Only the scene of this name
    scene: Option<String>,
}

/// A scene whose G-buffer is kept: a built-in model, a view, a scheme.
pub struct Golden {
    /// Its name, and that of its file.
    pub name: &'static str,
    model: &'static str,
    scheme: Scheme,
    /// Eye, target and height, for an orthographic view; the framing camera without it.
    ortho: Option<([f64; 3], [f64; 3], f64)>,
}

/// All goldens.
pub const GOLDENS: &[Golden] = &[
    Golden { name: "teapot", model: "teapot", scheme: Scheme::Specialised, ortho: None },
    Golden {
        name: "sphere-poles",
        model: "sphere",
        scheme: Scheme::General,
        ortho: Some(([0.3, 0.2, 4.0], [0.0, 0.0, 0.0], 2.4)),
    },
    Golden { name: "surface-14x6", model: "surface", scheme: Scheme::Specialised, ortho: None },
    Golden { name: "degrees-5-2", model: "quintic-quadratic", scheme: Scheme::General, ortho: None },
    Golden { name: "periodic", model: "periodic", scheme: Scheme::Specialised, ortho: None },
];

impl Golden {
    /// The model.
    pub fn model(&self) -> Model {
        models::builtin(self.model).expect("goldens use built-in models")
    }

    /// The rasterizer's G-buffer of the scene.
    ///
    /// # Errors
    /// Where the scene cannot be drawn.
    pub fn render(&self, model: &Model) -> Result<GBuffer> {
        let viewport = Viewport::new(SIZE[0], SIZE[1])?;
        let camera = match self.ortho {
            None => Camera::framing(model, viewport),
            Some((eye, target, height)) => {
                let projection = Projection::Orthographic { height };
                Camera::look_at(DVec3::from_array(eye), DVec3::from_array(target), DVec3::Y, projection)?
            }
        };
        let stage = Stage::new(model, camera, viewport, Plan { scheme: self.scheme, ..Plan::default() })?;
        Ok(stage.raster())
    }

    /// Where its file lies.
    pub fn path(&self) -> PathBuf {
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../testdata/golden").join(format!("{}.npz", self.name))
    }
}

/// Runs the command.
///
/// # Errors
/// Where there is no such scene, or a file cannot be written.
pub fn run(args: &BlessArgs) -> Result<()> {
    let chosen: Vec<&Golden> =
        GOLDENS.iter().filter(|golden| args.scene.as_deref().is_none_or(|name| name == golden.name)).collect();
    let names = || GOLDENS.iter().map(|golden| golden.name).collect::<Vec<_>>().join(", ");
    chosen.first().with_context(|| format!("no such golden; there are {}", names()))?;
    for golden in chosen {
        let path = golden.path();
        golden.render(&golden.model())?.write_npz(&path)?;
        say!("{}: {} bytes", golden.name, std::fs::metadata(&path)?.len())?;
    }
    Ok(())
}

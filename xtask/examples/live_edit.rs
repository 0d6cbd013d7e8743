//! Pulls a control point of the plate with 100 holes up and down, frame by frame, on the GPU: nothing is tessellated anew,
//! no trim curve is touched, and each frame says how many bytes went to the device.
//!
//! `cargo run --release -p xtask --example live_edit [FOLDER [FRAMES]]` writes FOLDER/frame-00.png and so on.

use anyhow::{Context, Result};
use gbuffer::{ShadeKind, Shading};
use glam::DVec3;
use pipeline::{PackedScene, Scheme};
use scene::{Camera, FaceId, Model, Viewport};
use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::Arc;
use techniques::{Limits, Prepared, Setting};

/// The control point that is pulled.
const PULLED: [usize; 2] = [2, 2];

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().unwrap_or_else(|| "out/live-edit".to_owned()));
    let frames: usize = arguments.next().map_or(Ok(12), |n| n.parse()).context("FRAMES")?;
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let device = gpu::Device::open(None)?;
    let model = models::builtin("plate").context("built in")?;
    let viewport = Viewport::new(480, 360)?;
    let camera = Camera::framing(&model, viewport);
    let start = model.surfaces()[0].clone();
    let columns = start.control_counts()[1];
    let rest = start.points()[PULLED[0] * columns + PULLED[1]];
    let height = 0.25 * model.hull().diagonal();
    // What each frame shows, and the corners of the first one's triangles moved along.
    let mut shown: Vec<(Model, PackedScene, Arc<dyn Prepared>)> = vec![];
    for frame in 0..frames {
        let lift = height * (TAU * frame as f64 / frames as f64).sin();
        let model = model.with_surface(0, start.with_point(PULLED, rest + DVec3::Z * lift)?);
        let scene = PackedScene::new(&model, Scheme::Specialised)?;
        let chord_px = techniques::DEFAULT_CHORD_PX;
        let setting = Setting {
            model: &model,
            scene: &scene,
            camera: &camera,
            viewport,
            chord_px,
            limits: Limits::default(),
            vertex_normals: false,
        };
        let prepared: Arc<dyn Prepared> = match shown.last() {
            None => techniques::ALL[0].prepare(&setting)?,
            Some((_, _, before)) => Prepared::edited(&**before, &setting, FaceId(0))?,
        };
        shown.push((model, scene, prepared));
    }
    let (_, scene, prepared) = &shown[0];
    let mut renderer = gpu::Renderer::new(&device, scene, &**prepared, gpu::RendererOptions::default())?;
    for (frame, (model, scene, prepared)) in shown.iter().enumerate() {
        let (_, before, triangles) = &shown[frame.saturating_sub(1)];
        let bytes = renderer.edit((before, &**triangles), (scene, &**prepared))?;
        let shading = Shading::new(ShadeKind::Isophotes).uniform(&camera, model.hull().diagonal());
        let picture = renderer.shaded(&scene.views(model, &camera, viewport), &shading, viewport)?;
        let path = folder.join(format!("frame-{frame:02}.png"));
        picture.write_png(&path)?;
        println!("{}: {bytes} bytes, {} triangles", path.display(), prepared.triangles());
    }
    Ok(())
}

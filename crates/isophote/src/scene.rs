//! `scene`: a model and a camera in one JSON file, for a renderer that is not ours to draw.

use crate::view::{ModelArgs, ViewArgs};
use crate::{output, terminal};
use ::scene::{Camera, Model, Viewport};
use anyhow::Result;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Write a scene as JSON, for a renderer of your own to draw
///
/// It holds surfaces, faces, the camera, and the meta of the G-buffer that your renderer writes.
///
/// docs/gbuffer.md describes the file, and the G-buffer that `compare` then judges.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  isophote scene teapot --size 64x64 --out scene.json")]
pub struct SceneArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    view: ViewArgs,
    /// Write to this file instead of standard output; folders on the way are made
    #[arg(long, help_heading = "Output", value_name = "X.json", allow_hyphen_values = true)]
    out: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Where input is bad or the file cannot be written.
pub fn run(args: &SceneArgs) -> Result<()> {
    args.out.iter().try_for_each(|path| output::check(path, "json"))?;
    let model = args.model.open()?;
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&model, viewport)?;
    let document = document(&model, &camera, viewport)?;
    match &args.out {
        Some(path) => output::write(path, (document.to_string() + "\n").as_bytes()),
        None => terminal::json(&document),
    }
}

/// The scene as `docs/gbuffer.md` describes it.
///
/// # Errors
/// Where the model cannot be written as JSON.
pub fn document(model: &Model, camera: &Camera, viewport: Viewport) -> Result<Value> {
    let mut document: Value = serde_json::from_str(&formats::json::write(model)?)?;
    for (value, face) in document["faces"].as_array_mut().into_iter().flatten().zip(model.faces()) {
        value["pixel"] = json!(camera.pixel_at(viewport, model.surfaces()[face.surface].hull()));
    }
    document["view"] = json!({
        "right": camera.right(),
        "above": camera.above(),
        "forward": camera.forward(),
        "half_height": camera.half_height(),
    });
    document["meta"] = json!({
        "model": model.name(),
        "model_hash": model.hash(),
        "camera": camera,
        "size": [viewport.width(), viewport.height()],
    });
    Ok(document)
}

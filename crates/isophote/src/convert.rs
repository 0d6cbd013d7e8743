//! `convert`: a model as a file of another format, surfaces or triangles.

use crate::view::ModelArgs;
use crate::{number, output, say, terminal};
use anyhow::{Context, Result, bail};
use clap::Args;
use export::mesh::Facts;
use export::{Asked, Written, export, exported, writer_of};
use scene::escaped;
use std::path::PathBuf;

/// Without `--error`, triangles are within this share of the diagonal of the model's box.
const USUAL_SHARE: f64 = 1e-3;

/// Write a model as exact surfaces or as proven triangles
///
/// The extension of --out chooses the format. JSON and STEP keep every control point, knot and weight, and every trim's curve in
/// (u, v), bit for bit; STEP adds edges in space, one for two faces where the model names it.
/// Names and colours of faces go along, but into STL.
/// OBJ, STL and glTF get triangles, each proven to be within --error of its surface; they are watertight where the model names the
/// edges that its faces share. The last line says what was written: triangles, the proven distance, edges left open.
///
///   isophote convert part.step --out part.glb --error 0.01
///   isophote convert teapot --out teapot.step
///
/// docs/export.md says what each format keeps and loses.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct ConvertArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// The file to write: .json, .step, .stp, .obj, .stl or .glb; `-.step` and so on for standard output
    #[arg(long, value_name = "FILE", allow_hyphen_values = true)]
    out: PathBuf,
    /// How far a triangle may be from its surface [default: 1/1000 of the model's diagonal]
    #[arg(long, value_name = "LEN", value_parser = number::positive, allow_hyphen_values = true)]
    error: Option<f64>,
}

/// Runs the command.
///
/// # Errors
/// Where input is bad, the extension is unknown, the triangles are too many, or the file cannot be written.
pub fn run(args: &ConvertArgs) -> Result<()> {
    // Before a large file is read for nothing.
    let writer = writer_of(&args.out)?;
    let is_standard = output::is_standard(&args.out);
    if !is_standard {
        output::check_place(&args.out)?;
    }
    if args.error.is_some() && !writer.is_tessellated() {
        bail!(
            "--error is how far triangles may be from the surface, and {} has the surfaces themselves",
            writer.name()
        );
    }
    let document = args.model.document()?;
    let error = args.error.unwrap_or_else(|| USUAL_SHARE * document.model.hull().diagonal());
    let bar = terminal::progress("faces", document.model.faces().len());
    let asked = Asked { error, progress: &|faces| bar.set_position(faces as u64) };
    let path = args.out.display().to_string();
    let written = if is_standard {
        let (written, bytes) = exported(writer, &document, asked)?;
        output::write(&args.out, &bytes)?;
        written
    } else {
        export(&args.out, &document, asked).with_context(|| escaped(&path).to_string())?
    };
    bar.finish_and_clear();
    for note in &written.notes {
        terminal::note(format_args!("note: {}: {}", escaped(&path), escaped(note)));
    }
    let told = told(&path, writer.name(), error, &written);
    // Standard output has the file's bytes and nothing else.
    if is_standard {
        terminal::note(format_args!("{told}"));
        return Ok(());
    }
    say!("{told}")
}

/// What was written: the last line says the most.
fn told(path: &str, format: &str, error: f64, written: &Written) -> String {
    let faces = written.faces;
    let Some(facts) = &written.mesh else {
        return format!(
            "{path}: {format}, {faces} faces, control points, knots and weights of their surfaces bit for bit"
        );
    };
    let Facts { triangles, distance, border, moved, open, non_manifold, euler, left_out } = facts;
    let lost = match &left_out[..] {
        [] => String::new(),
        lost => format!("left out: faces {lost:?}, whose trims cross too often, or which are a point\n"),
    };
    format!(
        "{lost}borders within {border:.3e} of the trims; corners moved by up to {moved:.1e} to meet their neighbours'; Euler \
         characteristic {euler}\n\
         {path}: {format}, {faces} faces, {triangles} triangles within {distance:.3e} of the surface, proven (asked: {error:.3e}), \
         {open} open and {non_manifold} non-manifold edges"
    )
}

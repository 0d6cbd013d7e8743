//! Solids that OpenCASCADE wrote, with what it found of them: the number of faces, the area, the volume.

use crate::green::area_and_volume;
use formats::Document;
use glam::DVec2;
use serde_json::Value;
use std::path::Path;

/// Relative error of area and volume, beside what the file's tolerance all over the surface comes to: OpenCASCADE
/// integrates over trims that it approximates itself.
const ERROR: f64 = 2e-5;

/// The rows of a folder's `solids.json`.
pub fn rows(folder: &Path) -> Vec<Value> {
    let text =
        std::fs::read_to_string(folder.join("solids.json")).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    serde_json::from_str(&text).expect("a list")
}

/// How a file differs from its row, if it does; the volume counts where the file says which side is out.
pub fn difference(document: &Document, row: &Value, path: &Path, is_solid: bool) -> Option<String> {
    let number = |key: &str| row[key].as_f64().expect("a number");
    let known = |v: DVec2| if is_solid { v } else { DVec2::new(v.x, 0.0) };
    let expected = DVec2::new(number("area"), number("volume"));
    let found = area_and_volume(&document.model);
    let tolerance = document.model.faces()[0].tolerance * DVec2::new(expected.x.sqrt(), expected.x);
    let error = (known((found - expected).abs() - tolerance) / expected).max_element();
    let faces = document.model.faces().len();
    let is_wrong = error > ERROR || error.is_nan() || faces as f64 != number("faces");
    is_wrong.then(|| {
        let notes: Vec<String> = document.notes.iter().map(ToString::to_string).collect();
        format!(
            "{}: {faces} faces of {}, off by {error:.1e}: {found} for {expected}; {}",
            path.display(),
            number("faces"),
            notes.join("; ")
        )
    })
}

//! What the integration tests share: where the data is, and equality bit for bit.

use glam::DVec2;
use nurbs::{Curve, Direction};
use scene::{Loop, Model, Trim};
use std::path::{Path, PathBuf};

/// The workspace root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The folder of real models, `ISOPHOTE_MODELS` (relative to the workspace root) or `../shared/models` beside the
/// workspace; `None`, said on stderr, where it does not exist.
pub fn models() -> Option<PathBuf> {
    let named = std::env::var_os("ISOPHOTE_MODELS");
    let folder = root().join(named.as_deref().unwrap_or("../shared/models".as_ref()));
    if folder.is_dir() {
        return Some(folder);
    }
    // A folder that was asked for by name must exist: a misspelt path is not an absent one.
    assert!(named.is_none(), "ISOPHOTE_MODELS names {}, which is not a folder", folder.display());
    eprintln!("no folder {}: only the project's own files were tested", folder.display());
    None
}

/// The `.json` model files of a folder, sorted.
pub fn json_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.ends_with(".json") && !name.ends_with(".eval.json") && name != "INDEX.json"
    });
    files.sort();
    assert!(!files.is_empty(), "{} has no models", folder.display());
    files
}

fn bits(numbers: impl IntoIterator<Item = f64>) -> Vec<u64> {
    numbers.into_iter().map(f64::to_bits).collect()
}

fn trim_bits(trim: &Trim) -> impl PartialEq + std::fmt::Debug {
    (
        (trim.knots.degree(), bits(trim.knots.knots().iter().copied())),
        bits(trim.points.iter().flat_map(|p| p.to_array())),
        trim.weights.as_ref().map(|w| bits(w.iter().copied())),
        (trim.reversed, trim.seam, trim.degenerate, trim.edge),
    )
}

/// All that a model holds except its name, with numbers as bits, so that −0 differs from 0.
pub fn model_bits(model: &Model) -> impl PartialEq + std::fmt::Debug {
    let surfaces: Vec<_> = model
        .surfaces()
        .iter()
        .map(|s| {
            let knots = [Direction::U, Direction::V].map(|d| bits(s.knots(d).knots().iter().copied()));
            let points = bits(s.points().iter().flat_map(|p| p.to_array()));
            (s.degree(), knots, points, s.weights().map(|w| bits(w.iter().copied())))
        })
        .collect();
    let faces: Vec<_> = model
        .faces()
        .iter()
        .map(|f| {
            let loops: Vec<_> =
                f.loops.iter().map(|l| (l.outer, l.trims.iter().map(trim_bits).collect::<Vec<_>>())).collect();
            (f.surface, f.reversed, f.tolerance.to_bits(), loops)
        })
        .collect();
    (surfaces, faces)
}

/// Straight pieces by which a curve is followed, for each of its spans.
const PIECES: usize = 200;

/// Straight pieces close to loops of trims, in their direction.
pub fn outline(loops: &[Loop]) -> Vec<[DVec2; 2]> {
    let mut sides = vec![];
    for trim in loops.iter().flat_map(|boundary| &boundary.trims) {
        let curve = Curve::new(trim.knots.clone(), &trim.points, trim.weights.as_deref()).unwrap();
        let (start, end) = trim.knots.domain();
        let count = if trim.knots.degree() == 1 { 1 } else { PIECES } * trim.knots.spans().count();
        let at = |k: usize| curve.point(start + (end - start) * k as f64 / count as f64);
        let points: Vec<DVec2> = (0..=count).map(at).collect();
        sides.extend(points.windows(2).map(|side| if trim.reversed { [side[1], side[0]] } else { [side[0], side[1]] }));
    }
    sides
}

/// How often an outline runs counter-clockwise round a point, by the sides that cross the ray from it along u.
pub fn winding(outline: &[[DVec2; 2]], about: DVec2) -> i32 {
    let crossing = |[a, b]: &[DVec2; 2]| match (a.y > about.y, b.y > about.y) {
        (false, true) if (*b - *a).perp_dot(about - *a) > 0.0 => 1,
        (true, false) if (*b - *a).perp_dot(about - *a) < 0.0 => -1,
        _ => 0,
    };
    outline.iter().map(crossing).sum()
}

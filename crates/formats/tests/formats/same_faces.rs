//! Files against another reading of them: faces, degrees, loops, trims, places and material.

use glam::DVec2;
use nurbs::{Projection, Projector};
use raycast::Classifier;
use scene::{FaceId, Model};
use std::path::Path;

/// Places along each side of a face's domain.
const GRID: usize = 20;

/// What may be off besides, as shares of the face's size and of its distance from the origin: files print 13 to 16 digits.
pub const PRINTED: f64 = 1e-9;
const PRINTED_FAR: f64 = 1e-13;

/// How the faces of a file differ from the oracle's.
#[derive(Debug, Default)]
pub struct Differences {
    pub lines: Vec<String>,
    /// Places whose side was compared, and the farthest that a place of the oracle's face is from ours, in units of the face's size.
    pub compared: usize,
    pub farthest: f64,
    pub degenerate: usize,
}

/// Compares face by face, in the order of the file.
///
/// The oracle's lengths are millimetres; ours are `unit` of these.
pub fn differences(ours: &Model, oracle: &Model, unit: f64, tolerance: f64) -> Differences {
    let mut found = Differences::default();
    if ours.faces().len() != oracle.faces().len() {
        found.lines.push(format!("{} faces for {}", ours.faces().len(), oracle.faces().len()));
        return found;
    }
    for k in 0..ours.faces().len() {
        let id = FaceId(k as u32);
        let number = ours.number_in_file(id);
        let [a, b] = [ours, oracle].map(|model| model.surface(id));
        if a.degree() != b.degree() {
            found.lines.push(format!("face {k} #{number}: degrees {:?} for {:?}", a.degree(), b.degree()));
        }
        if a.weights().is_some() != b.weights().is_some() {
            found.lines.push(format!(
                "face {k} #{number}: rational {} for {}",
                a.weights().is_some(),
                b.weights().is_some()
            ));
        }
        let trims = |model: &Model| -> Vec<usize> {
            let mut counts: Vec<usize> =
                model.faces()[k].loops.iter().map(|l| l.trims.iter().filter(|t| !t.degenerate).count()).collect();
            counts.sort_unstable();
            counts
        };
        found.degenerate += oracle.faces()[k].loops.iter().flat_map(|l| &l.trims).filter(|t| t.degenerate).count();
        let is_whole = |model: &Model| model.region(id).is_none_or(scene::Region::is_whole);
        if trims(ours) != trims(oracle) && !(trims(oracle).is_empty() && is_whole(ours)) {
            found.lines.push(format!("face {k} #{number}: trims {:?} for {:?}", trims(ours), trims(oracle)));
        }
        if ours.faces()[k].reversed != oracle.faces()[k].reversed {
            found.lines.push(format!("face {k} #{number}: reversed {}", ours.faces()[k].reversed));
        }
        let classifiers = [ours, oracle].map(|model| model.region(id).map(Classifier::new));
        let projector = Projector::new(a);
        let size = a.hull().diagonal();
        let far = a.hull().min.abs().max(a.hull().max.abs()).max_element();
        let enough = (PRINTED * size).max(PRINTED_FAR * far).max(tolerance);
        let [[u0, u1], [v0, v1]] = b.domain();
        let mut near = None;
        for i in 0..GRID * GRID {
            let share = DVec2::new((i / GRID) as f64 + 0.37, (i % GRID) as f64 + 0.41) / GRID as f64;
            let uv = DVec2::new(u0 + (u1 - u0) * share.x, v0 + (v1 - v0) * share.y);
            let d = b.first_derivatives(uv.x, uv.y);
            let (point, speeds) = (d.s / unit, DVec2::new(d.su.length(), d.sv.length()) / unit);
            let side = classifiers[1].as_ref().map(|c| c.side(uv, speeds));
            // The tolerance on either side.
            if side.is_some_and(|side| side.distance <= 4.0 * enough) {
                continue;
            }
            let inside = side.is_none_or(|side| side.inside);
            // A surface that the oracle kept has the same parameters.
            let same = Projection { uv, distance: a.point(uv.x, uv.y).distance(point) };
            let place = if same.distance <= enough { same } else { projector.nearest(point, near, 0.1 * enough) };
            near = Some(place.uv);
            if inside {
                found.farthest = found.farthest.max(place.distance / enough);
            }
            let is_ours = place.distance <= 2.0 * enough && classifiers[0].as_ref().is_none_or(|c| c.inside(place.uv));
            found.compared += 1;
            if inside != is_ours {
                found.lines.push(format!(
                    "face {k} #{number}: at {uv} inside {inside}, ours {is_ours} at {}, {:.2e} away, edge {:.2e}",
                    place.uv,
                    place.distance,
                    side.map_or(0.0, |side| side.distance)
                ));
            }
        }
    }
    found
}

pub fn compare(model: &Path, oracle: &Path) -> Differences {
    let document = formats::open(model).unwrap_or_else(|error| panic!("{error}"));
    let oracle = formats::read(oracle).unwrap_or_else(|error| panic!("{error}"));
    let tolerance = document.model.faces()[0].tolerance;
    let unit = document.unit.as_ref().map_or(1.0, |unit| unit.millimetres);
    let found = differences(&document.model, &oracle, unit, tolerance);
    eprintln!(
        "{}: {} faces, {} degenerate edges added by the oracle, {} sides compared, places within {:.2} tolerances, {} differences",
        model.file_name().unwrap_or_default().display(),
        document.model.faces().len(),
        found.degenerate,
        found.compared,
        found.farthest,
        found.lines.len()
    );
    found
}

/// Compares, and wants no difference: of so many sides at least.
pub fn assert_same(model: &Path, oracle: &Path, sides: usize) {
    let found = compare(model, oracle);
    assert!(found.lines.is_empty(), "{}:\n{}", model.display(), found.lines[..found.lines.len().min(12)].join("\n"));
    assert!(sides <= found.compared && found.farthest <= 1.0, "{}: {found:?}", model.display());
}

//! Real files against OpenCASCADE's reading of them: faces, degrees, loops, trims, places and material.

use crate::common::models;
use glam::DVec2;
use nurbs::{Projection, Projector};
use raycast::Classifier;
use scene::{FaceId, Model};
use std::path::Path;

/// Places along each side of a face's domain.
const GRID: usize = 20;

/// What may be off besides, as shares of the face's size and of its distance from the origin: files print 13 to 16 digits.
const PRINTED: f64 = 1e-9;
const PRINTED_FAR: f64 = 1e-13;

/// How the faces of a file differ from the oracle's.
#[derive(Debug, Default)]
struct Differences {
    lines: Vec<String>,
    /// Places whose side was compared, and the farthest that a place of the oracle's face is from ours, in units of the face's size.
    compared: usize,
    farthest: f64,
    degenerate: usize,
}

/// Compares face by face, in the order of the file.
///
/// The oracle's lengths are millimetres; ours are `unit` of these.
fn differences(ours: &Model, oracle: &Model, unit: f64, tolerance: f64) -> Differences {
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

fn compare(model: &Path, oracle: &Path) -> Differences {
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
fn assert_same(model: &Path, oracle: &Path, sides: usize) {
    let found = compare(model, oracle);
    assert!(found.lines.is_empty(), "{}:\n{}", model.display(), found.lines[..found.lines.len().min(12)].join("\n"));
    assert!(sides <= found.compared && found.farthest <= 1.0, "{}: {found:?}", model.display());
}

#[test]
fn real_files_are_read_as_opencascade_reads_them() {
    let Some(models) = models() else { return };
    let pairs = [
        ("nist/NIST_MBE_PMI_1.stp", "nist_1"),
        ("nist/NIST_MBE_PMI_11.stp", "nist_11"),
        ("nist/NIST_MBE_PMI_2.stp", "nist_2"),
        ("nist/NIST_MBE_PMI_3.stp", "nist_3"),
        ("nist/NIST_MBE_PMI_4.stp", "nist_4"),
        ("nist/NIST_MBE_PMI_5.stp", "nist_5"),
        ("nist/NIST_MBE_PMI_6.stp", "nist_6"),
        ("tigl/nacelle.stp", "nacelle"),
        ("tigl/D150WithGuides_fusedAircraftMirrored.step", "D150WithGuides_fusedAircraftMirrored"),
    ];
    for (model, oracle) in pairs {
        assert_same(&models.join(model), &models.join(format!("../oracle/neutral/{oracle}.json")), 2000);
    }
}

#[test]
fn hard_cases_are_read_as_they_were_written() {
    let Some(models) = models() else { return };
    let mut paths: Vec<_> =
        std::fs::read_dir(models.join("../cases")).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "step"));
    paths.sort();
    for path in paths {
        assert_same(&path, &path.with_extension("json"), 200);
    }
}

/// The comparison itself is tried on wrong faces: another order, a hole left out, a surface moved by ten tolerances.
#[test]
fn wrong_readings_are_told_apart() {
    let Some(models) = models() else { return };
    let right = formats::read(models.join("nist/NIST_MBE_PMI_11.stp")).unwrap();
    let (surfaces, faces) = (right.surfaces().to_vec(), right.faces().to_vec());
    let wrong = |surfaces: Vec<nurbs::Surface>, faces| {
        let model = Model::new("wrong", surfaces, faces).unwrap();
        let tolerance = right.faces()[0].tolerance;
        !differences(&model, &right, 1.0, tolerance).lines.is_empty()
    };
    assert!(!wrong(surfaces.clone(), faces.clone()));
    let mut swapped = faces.clone();
    swapped.swap(0, 2);
    assert!(wrong(surfaces.clone(), swapped));
    let mut filled = faces.clone();
    let holed = filled.iter_mut().find(|face| 1 < face.loops.len()).unwrap();
    holed.loops.retain(|l| l.outer);
    assert!(wrong(surfaces.clone(), filled));
    let moved = surfaces.iter().map(|surface| {
        let [u, v] = [nurbs::Direction::U, nurbs::Direction::V].map(|d| surface.knots(d).clone());
        let by = glam::DVec3::splat(10.0 * right.faces()[0].tolerance.max(PRINTED * surface.hull().diagonal()));
        let points = surface.points().iter().map(|p| *p + by).collect();
        nurbs::Surface::new(u, v, points, surface.weights().map(<[f64]>::to_vec)).unwrap()
    });
    assert!(wrong(moved.collect(), faces));
}

//! Real files against OpenCASCADE's reading of them.

use crate::common::{models, root};
use crate::green::of_face;
use crate::same_faces::{assert_same, compare};
use scene::Model;

/// Places whose side has to be compared on a file, at least so many a face.
const SIDES_A_FACE: usize = 200;

/// Relative error of an area: OpenCASCADE's own, which it is asked to keep below 1e-10, and its trims'.
const AREA: f64 = 1e-7;

#[test]
fn real_files_are_read_as_opencascade_reads_them() {
    let Some(models) = models() else { return };
    let oracle = models.join("../oracle/neutral/D150WithGuides_wing.json");
    assert_same(&models.join("tigl/D150WithGuides_wing.igs"), &oracle, 8 * SIDES_A_FACE);
}

/// 238 faces: the area of each eighth is that which OpenCASCADE integrates, in `testdata/iges`.
#[test]
fn the_faces_of_a_fuselage_have_the_areas_that_opencascade_finds() {
    let Some(models) = models() else { return };
    let text = std::fs::read_to_string(root().join("testdata/iges/fuselage-areas.json")).expect("areas");
    let areas: Vec<f64> = serde_json::from_str(&text).expect("a list");
    let model = formats::read(models.join("tigl/D150WithGuides_fuselage.igs")).unwrap();
    assert_eq!(model.faces().len(), areas.len());
    for (k, area) in areas.into_iter().enumerate().step_by(8) {
        let found = of_face(&model, k).x;
        assert!((found / area - 1.0).abs() < AREA, "face {k}: {found} for {area}");
    }
}

/// OpenCASCADE cuts curves at their corners, and this reader does not: all else is the same.
#[test]
fn curves_with_corners_stay_whole() {
    let Some(models) = models() else { return };
    let (file, oracle) = (models.join("gpucast/part.igs"), models.join("../oracle/neutral/gpucast_part.json"));
    let found = compare(&file, &oracle);
    let others: Vec<&String> = found.lines.iter().filter(|line| !line.contains(": trims [")).collect();
    assert!(others.is_empty(), "{others:?}");
    assert!(134 * SIDES_A_FACE <= found.compared && found.farthest <= 1.0, "{found:?}");
    let trims = |model: &Model, k: usize| model.faces()[k].loops.iter().map(|l| l.trims.len()).sum::<usize>();
    let [ours, oracle] = [file, oracle].map(|path| formats::read(path).unwrap());
    let counts: Vec<[usize; 2]> = (0..ours.faces().len()).map(|k| [trims(&ours, k), trims(&oracle, k)]).collect();
    assert!(counts.iter().all(|[ours, oracle]| ours <= oracle), "{counts:?}");
    // The lines (110) and splines (126) that the file says are parts of its boundaries.
    assert_eq!(counts.iter().map(|[ours, _]| ours).sum::<usize>(), 476 + 124);
}

/// Its global section is cut short and its cards are numbered 1, 2, 1, 2: OpenCASCADE reads nothing of it.
#[test]
fn a_damaged_file_is_read_and_its_damage_is_told() {
    let Some(models) = models() else { return };
    let document = formats::open(models.join("gpucast/teapot.igs")).unwrap();
    assert_eq!((document.model.faces().len(), document.unit), (32, None));
    let notes: Vec<String> = document.notes.iter().map(ToString::to_string).collect();
    for part in ["line 5: the numbers of section D", "line 68: the numbers of section P", "the global section ends"] {
        assert!(notes.iter().any(|note| note.contains(part)), "{part}: {notes:?}");
    }
    // Newell's teapot stands beside it: the same patches, with the bottom that he left out.
    let hull = document.model.hull();
    let newell = formats::read(models.join("newell/teapot.json")).unwrap().hull();
    assert!((hull.max - hull.min).distance(newell.max - newell.min) < 1e-9, "{hull:?} {newell:?}");
}

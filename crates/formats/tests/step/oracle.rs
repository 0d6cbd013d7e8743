//! Real files against OpenCASCADE's reading of them.

use crate::common::models;
use crate::same_faces::{PRINTED, assert_same, differences};
use scene::Model;

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

//! That each model has the counts of its publication, and is what it is called.

use super::*;
use crate::builtin;
use glam::DVec3;
use nurbs::Direction;
use scene::FaceId;

fn patches(model: &Model) -> usize {
    let of = |surface: &Surface, direction| surface.knots(direction).spans().count();
    model.surfaces().iter().map(|s| of(s, Direction::U) * of(s, Direction::V)).sum()
}

fn trims(model: &Model) -> impl Iterator<Item = &scene::Trim> {
    model.faces().iter().flat_map(|face| &face.loops).flat_map(|boundary| &boundary.trims)
}

fn is_bicubic(model: &Model) -> bool {
    model.surfaces().iter().all(|surface| surface.degree() == [3, 3] && surface.weights().is_none())
}

/// The sum of S · (S_u × S_v) over a third, which is the volume that closed faces with outward normals hold.
fn volume(surfaces: &[Surface]) -> f64 {
    let cells = 40;
    let share = |[a, b]: [f64; 2], k: usize| a + (b - a) * (k as f64 + 0.5) / cells as f64;
    let of = |surface: &Surface| {
        let [u, v] = surface.domain();
        let area = (u[1] - u[0]) * (v[1] - v[0]) / (cells * cells) as f64;
        let at = |k: usize| surface.first_derivatives(share(u, k / cells), share(v, k % cells));
        (0..cells * cells).map(at).map(|d| d.s.dot(d.su.cross(d.sv)) * area / 3.0).sum::<f64>()
    };
    surfaces.iter().map(of).sum()
}

#[test]
fn the_aircraft_has_geigers_counts() {
    let model = builtin("aircraft").unwrap();
    assert_eq!((model.faces().len(), patches(&model), trims(&model).count()), (158, 3157, 6134));
    assert!(is_bicubic(&model));
    assert!(trims(&model).all(|trim| trim.points.len() == 4 && trim.knots.degree() == 3 && trim.weights.is_none()));
    assert!((0..158).all(|face| model.trimmed_region(FaceId(face)).is_some()), "a face without an opening");
    assert!(model.notes().is_empty());
}

#[test]
fn the_turbine_has_geigers_counts() {
    let model = builtin("turbine").unwrap();
    assert_eq!((model.faces().len(), patches(&model)), (221, 87_383));
    assert!(is_bicubic(&model) && !model.is_trimmed());
}

#[test]
fn concheiros_scenes_have_the_counts_of_his_table() {
    for (number, scene) in (1..).zip(SCENES) {
        let model = builtin(scene.name).unwrap();
        assert_eq!(scene.name, format!("tea-s{number}"));
        assert_eq!((model.faces().len(), patches(&model)), (scene.patches, scene.patches), "{}", scene.name);
        assert!(is_bicubic(&model));
        // His uniform counts are 2 (2^(l + 1) − 1)² triangles a surface, in units of 1,024: that checks the numbers typed in.
        for (level, stated) in [(4, scene.uniform_4), (6, scene.uniform_6)] {
            let cells = (1usize << (level + 1)) - 1;
            let thousands = (scene.patches * 2 * cells * cells) as f64 / 1024.0;
            // One is misprinted: S7 has 1,464.02 by that rule.
            let stated = if stated == 1465.02 { 1464.02 } else { stated };
            assert!((thousands - stated).abs() <= 0.0051, "{} at {level}: {thousands}, {stated}", scene.name);
        }
    }
    assert_eq!(SCENES.len(), 16);
}

#[test]
fn quilts_have_the_patches_of_their_names_and_share_borders_to_the_bit() {
    for (name, [columns, rows]) in QUILTS {
        assert_eq!(name.strip_prefix("quilt-").unwrap().parse(), Ok(columns * rows));
    }
    let [columns, rows] = QUILTS[1].1;
    let model = builtin(QUILTS[1].0).unwrap();
    assert_eq!((model.faces().len(), patches(&model)), (columns * rows, columns * rows));
    for k in 0..columns * rows {
        let points = |k: usize| model.surfaces()[k].points();
        if k % rows + 1 < rows {
            assert!((0..4).all(|i| points(k)[4 * i + 3] == points(k + 1)[4 * i]));
        }
        if k + rows < columns * rows {
            assert!((0..4).all(|j| points(k)[12 + j] == points(k + rows)[j]));
        }
    }
}

#[test]
fn every_published_model_opens_by_its_own_name() {
    for (name, _) in &PUBLISHED[..PUBLISHED.len() - 1] {
        let model = builtin(name).unwrap();
        assert_eq!(model.name(), *name);
    }
    assert_eq!(PUBLISHED.len(), 2 + SCENES.len() + QUILTS.len());
    assert!(builtin("quilt-101").is_none() && builtin("tea-s17").is_none());
}

#[test]
fn bodies_are_the_right_way_out() {
    let aircraft = builtin("aircraft").unwrap();
    // The fuselage is closed but for its end, a disc of one part in two hundred.
    let fuselage = volume(&aircraft.surfaces()[..48]);
    assert!((0.04..0.07).contains(&fuselage), "{fuselage}");
    for (name, range) in [("right wing", 48..72), ("left wing", 97..121)] {
        let normal = |s: &Surface| {
            let [u, v] = s.domain();
            let d = s.first_derivatives((u[0] + u[1]) / 2.0, (v[0] + v[1]) / 2.0);
            (d.s, d.su.cross(d.sv))
        };
        // A wing's upper panel at half the span has its normal up.
        let upper = aircraft.surfaces()[range].iter().map(normal).filter(|(_, n)| n.z.abs() > 0.0);
        let (ups, downs): (Vec<_>, Vec<_>) = upper.partition(|(_, n)| n.z > 0.0);
        let mean = |of: &[(DVec3, DVec3)]| of.iter().map(|(s, _)| s.z).sum::<f64>() / of.len() as f64;
        assert!(ups.len() == 12 && downs.len() == 12 && mean(&downs) < mean(&ups), "{name}");
    }
    let turbine = builtin("turbine").unwrap();
    assert!(volume(&turbine.surfaces()[..1]) > 0.0, "a blade of the fan");
    assert!(volume(&turbine.surfaces()[22..=22]) > 0.0, "the hub behind it");
}

#[test]
fn published_models_are_the_same_numbers_on_every_machine() {
    assert_eq!(builtin("aircraft").unwrap().hash(), "64dcec8e2681a7aa");
    assert_eq!(builtin("turbine").unwrap().hash(), "a8f2a0a23e05961b");
    assert_eq!(builtin("tea-s8").unwrap().hash(), "edb3667549358a51");
    assert_eq!(builtin("quilt-1000").unwrap().hash(), "8c068495a04692dd");
}

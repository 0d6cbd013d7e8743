//! Seams whose gap, angle and curvature have closed forms, in every way that two surfaces may share them.

mod seams;

use continuity::{Class, EdgeReport, Limits, Report, Settings, Verdict, report};
use glam::{DMat3, DVec3};
use nurbs::{Direction, KnotVector, Surface};
use scene::Model;
use seams::{flipped, transposed};

/// What doubles leave of nought, for models of size one to forty.
const NOUGHT: f64 = 1e-11;

fn judged(surfaces: Vec<Surface>) -> Report {
    let model = Model::of_surfaces("seam", surfaces).expect("surfaces");
    let limits = Limits { curvature: Some(0.1), ..Class::A.limits() };
    report(&model, Settings { reach: 0.2, ..Settings::new(limits, &model) })
}

fn edge(surfaces: Vec<Surface>) -> EdgeReport {
    let mut found = judged(surfaces).edges;
    assert_eq!(found.len(), 1, "one shared edge");
    found.remove(0)
}

/// The square x, y in 0 … 1 moved by a rotation and an offset, side x = 1 first to meet another.
fn square(turn: DMat3, offset: DVec3) -> Surface {
    let corner = |x: f64, y: f64| turn * DVec3::new(x, y, 0.0) + offset;
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("one span");
    let points = vec![corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 0.0), corner(1.0, 1.0)];
    Surface::new(knots(), knots(), points, None).expect("a square")
}

/// A quarter of a cylinder of radius `radius` that begins along x = 1, y in 0 … 1, tangent to z = 0.
fn quarter(radius: f64) -> Surface {
    let arc = |w: f64, x: f64, z: f64| [0.0, 1.0].map(|y| (DVec3::new(1.0 + x * radius, y, z * radius), w));
    let rows = [arc(1.0, 0.0, 0.0), arc(0.5f64.sqrt(), 1.0, 0.0), arc(1.0, 1.0, 1.0)];
    let (points, weights) = rows.into_iter().flatten().unzip();
    let along = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).expect("one span");
    let across = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("one span");
    Surface::new(along, across, points, Some(weights)).expect("a cylinder")
}

/// The surface in eight parametrizations: with u and v exchanged, each run backwards.
fn turns(surface: &Surface) -> Vec<Surface> {
    let mut all = vec![];
    for base in [surface.clone(), transposed(surface)] {
        for (u, v) in [(false, false), (true, false), (false, true), (true, true)] {
            let mut turned = base.clone();
            if u {
                turned = flipped(&turned, Direction::U);
            }
            if v {
                turned = flipped(&turned, Direction::V);
            }
            all.push(turned);
        }
    }
    all
}

#[test]
fn coplanar_squares_pass_with_nought_everywhere() {
    for other in turns(&square(DMat3::IDENTITY, DVec3::X)) {
        let found = edge(vec![square(DMat3::IDENTITY, DVec3::ZERO), other]);
        assert_eq!((found.verdict, found.class), (Verdict::Pass, Some(Class::A)));
        assert!(found.gap.bound <= NOUGHT && found.angle_deg.bound <= 1e-6, "{found:?}");
        assert!(found.curvature.bound <= NOUGHT && found.is_perpendicular, "{found:?}");
    }
}

#[test]
fn squares_a_step_apart_have_a_gap_and_nothing_else() {
    for (step, verdict) in [(0.009, Verdict::Pass), (0.011, Verdict::Fail)] {
        for other in turns(&square(DMat3::IDENTITY, DVec3::new(1.0, 0.0, step))) {
            let found = edge(vec![square(DMat3::IDENTITY, DVec3::ZERO), other]);
            assert_eq!(found.gap.verdict, Some(verdict));
            assert!((found.gap.seen - step).abs() <= NOUGHT && (found.gap.bound - step).abs() <= NOUGHT, "{found:?}");
            assert!(found.angle_deg.bound <= 1e-6 && found.curvature.bound <= NOUGHT, "{found:?}");
        }
    }
}

#[test]
fn a_crease_of_thirty_degrees_is_thirty_degrees() {
    let bend = DMat3::from_rotation_y(-30f64.to_radians());
    for other in turns(&square(bend, DVec3::X)) {
        let found = edge(vec![square(DMat3::IDENTITY, DVec3::ZERO), other]);
        assert_eq!((found.verdict, found.class), (Verdict::Fail, None));
        assert!(
            (found.angle_deg.seen - 30.0).abs() <= 1e-9 && (found.angle_deg.bound - 30.0).abs() <= 1e-9,
            "{found:?}"
        );
        assert!(found.gap.bound <= NOUGHT, "{found:?}");
    }
}

/// A sheet folded back on itself is no smooth joint, though its tangent planes are one.
#[test]
fn a_sheet_folded_back_is_half_a_turn() {
    let back = DMat3::from_cols(-DVec3::X, DVec3::Y, DVec3::Z);
    for other in turns(&square(back, DVec3::X)) {
        // It lies on the first one, whose other sides it meets, too.
        let found = judged(vec![square(DMat3::IDENTITY, DVec3::ZERO), other]);
        assert_eq!(found.edges.len(), 4);
        assert!(found.edges.iter().all(|edge| (edge.angle_deg.seen - 180.0).abs() <= 1e-3), "{found:?}");
    }
}

#[test]
fn a_plane_and_a_cylinder_differ_by_the_cylinders_curvature() {
    for radius in [0.5, 2.0, 40.0] {
        for other in turns(&quarter(radius)) {
            let found = edge(vec![square(DMat3::IDENTITY, DVec3::ZERO), other]);
            assert_eq!(found.curvature.verdict, Some(Verdict::Fail));
            let difference = &found.curvature_difference;
            let near = |x: f64| (x * radius - 1.0).abs() <= 1e-9;
            assert!(near(difference.seen) && near(difference.bound), "{radius}: {difference:?}");
            assert!((found.curvature.seen - 1.0).abs() <= 1e-9, "{found:?}");
            assert!(found.gap.bound <= NOUGHT && found.angle_deg.bound <= 1e-6, "{found:?}");
        }
    }
}

/// The same cylinder on both sides, one of them bent the other way: an inflection.
#[test]
fn an_inflection_of_equal_radii_differs_by_two() {
    let first = quarter(3.0);
    let half_turn = |p: DVec3| DVec3::new(2.0 - p.x, p.y, -p.z);
    let points = first.points().iter().map(|p| half_turn(*p)).collect();
    let [u, v] = [Direction::U, Direction::V].map(|direction| first.knots(direction).clone());
    let second = Surface::new(u, v, points, first.weights().map(<[f64]>::to_vec)).expect("a cylinder");
    let found = edge(vec![first, second]);
    assert!((found.curvature.seen - 2.0).abs() <= 1e-9 && found.angle_deg.bound <= 1e-6, "{found:?}");
    assert!((found.curvature_difference.seen - 2.0 / 3.0).abs() <= 1e-9, "{found:?}");
}

#[test]
fn the_least_radius_of_a_cylinder_is_its_radius() {
    let found = judged(vec![quarter(2.0)]);
    let face = &found.faces[0];
    let seen = face.least_radius_seen.expect("it is curved");
    assert!((seen - 2.0).abs() <= 1e-9 && face.least_radius_bound <= 2.0 && 1.8 <= face.least_radius_bound, "{face:?}");
}

/// Model units of 1e-6 and 1e6, and a part ten kilometres from the origin.
#[test]
fn size_and_place_change_no_answer() {
    let moved = |surface: Surface, scale: f64, offset: DVec3| {
        let points = surface.points().iter().map(|p| *p * scale + offset).collect();
        let [u, v] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
        Surface::new(u, v, points, surface.weights().map(<[f64]>::to_vec)).expect("the same surface")
    };
    for (scale, offset) in [(1e-6, DVec3::ZERO), (1e6, DVec3::ZERO), (1.0, DVec3::new(1e7, -1e7, 1e7))] {
        let surfaces = vec![square(DMat3::IDENTITY, DVec3::ZERO), quarter(2.0)];
        let surfaces = surfaces.into_iter().map(|surface| moved(surface, scale, offset)).collect();
        let model = Model::of_surfaces("moved", surfaces).expect("surfaces");
        let limits = Limits { gap: 1e-3 * scale, angle_deg: 0.1, curvature: None };
        let found = report(&model, Settings { reach: 0.01 * scale, ..Settings::new(limits, &model) });
        let edge = &found.edges[0];
        // Ten kilometres leave 2e-9 of a unit, which is all that the points themselves have.
        assert!(edge.gap.bound <= 1e-8 * scale && edge.angle_deg.bound <= 1e-5, "{edge:?}");
        assert!((edge.curvature_difference.seen * 2.0 * scale - 1.0).abs() <= 1e-6, "{edge:?}");
    }
}

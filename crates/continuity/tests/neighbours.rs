//! Neighbours that no file names: partial borders, junctions, three sheets at an edge, seams, poles; and peaks that samples miss.

mod seams;

use continuity::{Class, Limits, Report, Settings, Verdict, report};
use glam::{DVec2, DVec3};
use nurbs::{Direction, KnotVector, Surface};
use scene::{Face, Loop, Model, Trim};
use seams::flipped;

/// The rectangle from `origin` along `u` and `v`.
fn sheet(origin: DVec3, u: DVec3, v: DVec3) -> Surface {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("one span");
    Surface::new(knots(), knots(), vec![origin, origin + v, origin + u, origin + u + v], None).expect("a sheet")
}

fn judged(surfaces: Vec<Surface>) -> Report {
    let model = Model::of_surfaces("sheets", surfaces).expect("surfaces");
    report(&model, Settings { reach: 1e-3, ..Settings::new(Class::A.limits(), &model) })
}

#[test]
fn one_side_beside_two_is_two_edges_and_a_junction() {
    let long = sheet(DVec3::ZERO, DVec3::X, 3.0 * DVec3::Y);
    let lower = sheet(DVec3::X, DVec3::X, DVec3::Y);
    let upper = flipped(&sheet(DVec3::new(1.0, 1.0, 0.0), DVec3::X, 2.0 * DVec3::Y), Direction::V);
    let found = judged(vec![long, lower, upper]);
    assert_eq!((found.edges.len(), found.free.len(), found.non_manifold.len()), (3, 7, 0));
    let lengths: Vec<i64> = found.edges.iter().map(|edge| edge.borders[0].length.round() as i64).collect();
    assert_eq!(lengths.iter().sum::<i64>(), 4, "1 and 2 beside the long side, 1 between the short ones: {lengths:?}");
    let is_there = |position: [f64; 3]| DVec3::from_array(position).distance(DVec3::new(1.0, 1.0, 0.0)) < 1e-12;
    assert!(found.t_junctions.iter().all(|junction| junction.through.face == 0 && is_there(junction.position)));
    assert_eq!(found.t_junctions.len(), 1);
    assert_eq!((found.verdict, found.is_matched), (Verdict::Pass, true));
}

#[test]
fn three_sheets_at_an_edge_are_named() {
    let found = judged(vec![
        sheet(DVec3::ZERO, DVec3::X, DVec3::Y),
        sheet(DVec3::ZERO, DVec3::Z, DVec3::Y),
        sheet(DVec3::ZERO, -DVec3::X, DVec3::Y),
    ]);
    assert_eq!(found.non_manifold.len(), 1);
    assert_eq!(found.non_manifold[0].borders.len(), 3);
    let mut angles: Vec<f64> = found.edges.iter().map(|edge| edge.angle_deg.seen.round()).collect();
    angles.sort_by(f64::total_cmp);
    assert_eq!(angles, [0.0, 90.0]);
}

#[test]
fn sheets_apart_share_nothing() {
    let found = judged(vec![sheet(DVec3::ZERO, DVec3::X, DVec3::Y), sheet(2.0 * DVec3::X, DVec3::X, DVec3::Y)]);
    assert_eq!((found.edges.len(), found.free.len()), (0, 8));
}

#[test]
fn a_strip_that_is_narrower_than_the_reach_is_a_sliver() {
    let found = judged(vec![sheet(DVec3::ZERO, 5e-4 * DVec3::X, DVec3::Y), sheet(DVec3::X, DVec3::X, DVec3::Y)]);
    assert!(found.faces[0].is_sliver && !found.faces[1].is_sliver, "{:?}", found.faces);
}

/// The built-in sphere has a seam, which is an edge of the face with itself, and two poles.
#[test]
fn a_sphere_is_smooth_across_its_seam_and_has_two_poles() {
    let model = models::builtin("sphere").expect("built in");
    let settings = Settings::new(Class::A.limits(), &model);
    let found = report(&model, settings);
    assert_eq!(found.verdict, Verdict::Pass, "{:?}", found.edges);
    assert!(!found.edges.is_empty() && !found.points.is_empty(), "{:?}", found.points);
    let degenerate: usize = found.faces.iter().map(|face| face.degenerate_normals.len()).sum();
    assert!(degenerate >= 2, "{:?}", found.faces);
    let radius = found.faces.iter().filter_map(|face| face.least_radius_seen).fold(f64::INFINITY, f64::min);
    let size = model.hull().max.x - model.hull().center().x;
    assert!((radius / size - 1.0).abs() < 2e-3, "radius {radius} of a sphere {size}");
}

/// A sheet over 0 … 1 whose rows at its side x = 1 have a bump of width 4e-4 at y = 0.505: between 100 samples, and 1000.
fn bumped(gap: f64, lift: f64) -> Surface {
    let knots = |n: usize, inner: &[f64]| {
        KnotVector::new(n, [&vec![0.0; n + 1][..], inner, &vec![1.0; n + 1][..]].concat()).expect("knots")
    };
    let along = knots(3, &[0.5053, 0.5054, 0.5055, 0.5056, 0.5057]);
    let across = knots(2, &[]);
    let greville = |k: usize| along.knots()[k + 1..k + 4].iter().sum::<f64>() / 3.0;
    let mut points = vec![];
    for i in 0..3 {
        for j in 0..along.control_count() {
            let is_bump = j == 4;
            let z = match i {
                2 if is_bump => gap,
                1 if is_bump => gap + lift,
                _ => 0.0,
            };
            points.push(DVec3::new(i as f64 / 2.0, greville(j), z));
        }
    }
    Surface::new(across, along, points, None).expect("a sheet")
}

/// The greatest value of the cubic B-spline of those knots' middle basis function.
fn bump_height() -> f64 {
    let surface = bumped(1.0, 0.0);
    (0..=100_000).map(|i| surface.point(1.0, 0.505 + 1e-8 * f64::from(i)).z).fold(0.0, f64::max)
}

#[test]
fn a_peak_between_samples_is_found() {
    let flat = sheet(DVec3::X, DVec3::X, DVec3::Y);
    let height = bump_height();
    for (gap, lift) in [(0.02, 0.0), (0.0, 0.02), (0.02, 0.02)] {
        let bumped = bumped(gap, lift);
        // What sampling sees, 1000 places: nothing.
        let sampled = (0..=1000).map(|i| bumped.point(1.0, f64::from(i) / 1000.0).z.abs()).fold(0.0, f64::max);
        assert!(sampled < 1e-15, "{sampled}");
        let model = Model::of_surfaces("peak", vec![bumped, flat.clone()]).expect("surfaces");
        let limits = Limits { gap: 0.01, angle_deg: 0.1, curvature: None };
        let found = report(&model, Settings { reach: 0.1, ..Settings::new(limits, &model) });
        let edge = &found.edges[0];
        let place = edge.gap.at.position[1];
        if 0.0 < gap {
            assert_eq!(edge.gap.verdict, Some(Verdict::Fail));
            assert!((edge.gap.seen / (gap * height) - 1.0).abs() < 0.02, "{:?}", edge.gap);
            assert!((0.5053..0.5057).contains(&place), "{place}");
        } else {
            assert!(edge.gap.bound < 1e-9, "{:?}", edge.gap);
        }
        if 0.0 < lift {
            let expected = (lift * height / 0.5f64).atan().to_degrees();
            assert_eq!(edge.angle_deg.verdict, Some(Verdict::Fail));
            assert!(expected * 0.9 <= edge.angle_deg.seen, "{expected}° at least: {:?}", edge.angle_deg);
            assert!((0.5053..0.5057).contains(&edge.angle_deg.at.position[1]), "{:?}", edge.angle_deg);
        }
    }
}

/// The faces of a file that names its edges are neighbours by these, wherever their curves run.
#[test]
fn edges_that_a_file_names_are_taken_as_named() {
    let model = models::builtin("seam-pair").expect("built in");
    let found = report(&model, Settings::new(Class::A.limits(), &model));
    let edge = found.edges.iter().find(|edge| edge.edge.is_some()).expect("a named edge");
    assert!(edge.gap.verdict == Some(Verdict::Pass) && edge.gap.bound < 1.1e-6, "{edge:?}");
    let shared = &model.shared_edges()[0];
    assert!(edge.gap.bound >= shared.gap * (1.0 - 1e-3), "{} sampled, {:?}", shared.gap, edge.gap);
}

/// A face on the whole of a sheet within a loop, counter-clockwise; each corner with the number of the edge that begins there.
fn bounded(surface: usize, corners: &[(DVec2, i64)]) -> Face {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("one span");
    let side = |k: usize| {
        let (from, edge) = corners[k];
        let to = corners[(k + 1) % corners.len()].0;
        Trim { edge: Some(edge), ..Trim::new(knots(), vec![from, to], None) }
    };
    let trims = (0..corners.len()).map(side).collect();
    Face { loops: vec![Loop { outer: true, trims }], ..Face::whole(surface) }
}

/// Readers cut an edge where its curve has a corner, or crosses its own end; another face may have it in one trim.
#[test]
fn an_edge_in_several_trims_is_one_edge() {
    let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
    let [low, high] = [0.3, 0.8].map(|v| DVec2::new(1.0, v));
    let left = bounded(0, &[(a, 0), (b, 7), (low, 7), (high, 7), (c, 1), (d, 2)]);
    let right = bounded(1, &[(a, 3), (b, 4), (c, 5), (d, 7)]);
    // 0.05 apart: only the file can know that they are neighbours.
    let surfaces = vec![sheet(DVec3::ZERO, DVec3::X, DVec3::Y), sheet(1.05 * DVec3::X, DVec3::X, DVec3::Y)];
    let model = Model::new("cut", surfaces, vec![left, right]).expect("two faces");
    let found = report(&model, Settings { reach: 1e-3, ..Settings::new(Class::A.limits(), &model) });
    assert_eq!((found.edges.len(), found.non_manifold.len(), found.free.len()), (1, 0, 6));
    let edge = &found.edges[0];
    assert_eq!(edge.edge, Some(7));
    assert!(edge.borders.iter().all(|border| (border.length - 1.0).abs() < 1e-12), "{:?}", edge.borders);
    assert!((0.05 - 1e-9..0.05 * 1.011).contains(&edge.gap.bound) && edge.angle_deg.bound < 1e-9, "{edge:?}");
}

/// The trims of a seam are one edge of one face, too, but the second comes back along the first.
#[test]
fn the_two_sides_of_a_seam_stay_two_borders() {
    let model = models::builtin("window").expect("built in");
    let found = report(&model, Settings::new(Class::A.limits(), &model));
    let seam = found.edges.iter().find(|edge| edge.edge.is_some()).expect("a named edge");
    let [a, b] = &seam.borders;
    assert_eq!((a.face, a.face), (b.face, 0));
    assert!((a.length - b.length).abs() <= 1e-12 * a.length && a.border != b.border, "{:?}", seam.borders);
}

/// 0.005 inches are 0.127 mm, and 0.005 mm are class A.
#[test]
fn classes_are_in_millimetres_whatever_the_unit() {
    let surfaces = vec![sheet(DVec3::ZERO, DVec3::X, DVec3::Y), sheet(1.005 * DVec3::X, DVec3::X, DVec3::Y)];
    let model = Model::of_surfaces("sheets", surfaces).expect("surfaces");
    let class = |millimetres: f64| {
        let limits = Class::A.limits().in_units_of(millimetres);
        let found = report(&model, Settings { millimetres, reach: 0.01, ..Settings::new(limits, &model) });
        (found.class, found.verdict)
    };
    assert_eq!(class(1.0), (Some(Class::A), Verdict::Pass));
    assert_eq!(class(3.0), (Some(Class::B), Verdict::Fail));
    assert_eq!(class(25.4), (None, Verdict::Fail));
}

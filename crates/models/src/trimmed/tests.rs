//! That each model is what its name and line promise.

use super::*;
use crate::{BUILTINS, HARD, builtin};
use formats::json;
use nurbs::basis_derivatives;

/// C(t) in homogeneous coordinates and its first derivative, by the general basis algorithm.
fn homogeneous(trim: &Trim, t: f64) -> [DVec3; 2] {
    let span = trim.knots.find_span(t);
    let basis = basis_derivatives(&trim.knots, span, t, 1);
    let p = trim.knots.degree();
    [0, 1].map(|order| {
        let term = |r: usize| {
            let k = span - p + r;
            let weight = trim.weights.as_ref().map_or(1.0, |w| w[k]);
            trim.points[k].extend(1.0) * weight * basis[order][r]
        };
        (0..=p).map(term).sum()
    })
}

fn at(trim: &Trim, share: f64) -> DVec2 {
    let (a, b) = trim.knots.domain();
    let share = if trim.reversed { 1.0 - share } else { share };
    let h = homogeneous(trim, if share == 1.0 { b } else { a + (b - a) * share })[0];
    h.truncate() / h.z
}

/// Points along a trim in the order of its loop, both ends included.
fn walk(trim: &Trim) -> Vec<DVec2> {
    let steps = 16 * trim.knots.spans().count();
    (0..=steps).map(|k| at(trim, k as f64 / steps as f64)).collect()
}

/// Twice the signed area of a polygon through the loop's points.
fn double_area(boundary: &Loop) -> f64 {
    let points: Vec<DVec2> = boundary.trims.iter().flat_map(walk).collect();
    points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum()
}

/// The largest distance from the end of a trim to the start of the next.
fn gap(boundary: &Loop) -> f64 {
    let next = boundary.trims.iter().cycle().skip(1);
    boundary.trims.iter().zip(next).map(|(a, b)| at(a, 1.0).distance(at(b, 0.0))).fold(0.0, f64::max)
}

fn model(name: &str) -> Model {
    builtin(name).expect("a built-in name")
}

#[test]
fn every_trimmed_model_opens_under_its_own_name_with_its_counts() {
    let expected: [(&str, usize, usize, usize); 9] = [
        ("plate", 1, 101, 104),
        ("window", 1, 4, 14),
        ("cap", 2, 2, 8),
        ("islands", 1, 4, 13),
        ("cusp", 1, 2, 4),
        ("sliver", 1, 1, 4),
        ("text", 1, 13, 143),
        ("pieces", 16, 160, 800),
        ("seam-pair", 2, 2, 8),
    ];
    assert_eq!(TRIMMED.len(), expected.len());
    for ((name, _), (expected_name, faces, loops, trims)) in TRIMMED.iter().zip(expected) {
        let model = model(name);
        assert_eq!((*name, model.name(), model.is_trimmed()), (expected_name, expected_name, true));
        let all: Vec<&Loop> = model.faces().iter().flat_map(|face| &face.loops).collect();
        let count = all.iter().map(|boundary| boundary.trims.len()).sum::<usize>();
        assert_eq!((model.faces().len(), all.len(), count), (faces, loops, trims), "{name}");
        assert!(BUILTINS.iter().chain(HARD).all(|(other, _)| other != name));
        assert!((1.0..4.0).contains(&model.hull().diagonal()), "{name}");
    }
    assert!(builtin("plates").is_none());
}

#[test]
fn every_loop_closes() {
    for (name, _) in TRIMMED {
        for face in model(name).faces() {
            let [[u0, u1], [v0, v1]] = model(name).surfaces()[face.surface].domain();
            let size = (u1 - u0).max(v1 - v0);
            for (k, boundary) in face.loops.iter().enumerate() {
                assert!(gap(boundary) <= 4.0 * f64::EPSILON * size, "{name}, loop {k}: {}", gap(boundary));
            }
        }
    }
    // What is measured is a gap: without one of its trims a loop has one.
    let mut boundary = model("cusp").faces()[0].loops[0].clone();
    boundary.trims.pop();
    assert!(gap(&boundary) > 0.5);
}

#[test]
fn the_outer_loop_runs_counter_clockwise_and_inner_ones_by_their_depth() {
    for (name, _) in TRIMMED {
        for (f, face) in model(name).faces().iter().enumerate() {
            let outers = face.loops.iter().filter(|boundary| boundary.outer).count();
            assert!(outers == 1 && face.loops[0].outer, "{name}, face {f}");
            for (k, boundary) in face.loops.iter().enumerate() {
                let island = match *name {
                    "islands" => k % 2 == 0,
                    // Counters of o, p, o and e.
                    "text" => [0, 3, 6, 8, 12].contains(&k),
                    _ => k == 0,
                };
                assert_eq!(double_area(boundary) > 0.0, island, "{name}, face {f}, loop {k}");
            }
        }
    }
}

#[test]
fn trims_stay_in_the_domain_except_across_a_seam() {
    for (name, _) in TRIMMED {
        let model = model(name);
        for face in model.faces() {
            let [[u0, u1], [v0, v1]] = model.surfaces()[face.surface].domain();
            for p in face.loops.iter().flat_map(|boundary| &boundary.trims).flat_map(walk) {
                let inside = (u0..=u1).contains(&p.x) || *name == "window";
                assert!(inside && (v0..=v1).contains(&p.y), "{name}: {p}");
            }
        }
    }
}

#[test]
fn trimmed_models_survive_being_written_and_read() {
    for (name, _) in TRIMMED {
        let model = model(name);
        assert_eq!(json::parse(&json::write(&model).unwrap(), "x.json").unwrap(), model, "{name}");
    }
}

#[test]
fn holes_of_the_plate_are_circles() {
    let plate = model("plate");
    let mut backwards = 0;
    for (k, hole) in plate.faces()[0].loops[1..].iter().enumerate() {
        let center = dvec2((k / 10) as f64 + 0.5, (k % 10) as f64 + 0.5) / 10.0;
        let radii: Vec<f64> = hole.trims.iter().flat_map(walk).map(|p| p.distance(center)).collect();
        assert!(radii.iter().all(|r| (r - radii[0]).abs() <= 1e-15) && (0.019..0.041).contains(&radii[0]), "{k}");
        backwards += usize::from(hole.trims[0].reversed);
    }
    assert_eq!(backwards, 50);
}

#[test]
fn windows_run_beyond_both_ends_of_the_domain() {
    let window = model("window");
    let range = |k: usize| {
        let loops = &window.faces()[0].loops[k];
        let u: Vec<f64> = loops.trims.iter().flat_map(walk).map(|p| p.x).collect();
        [u.iter().copied().fold(f64::MAX, f64::min), u.iter().copied().fold(f64::MIN, f64::max)]
    };
    assert_eq!((range(1), range(3).map(|u| (u * 100.0).round())), ([-0.12, 0.12], [73.0, 83.0]));
    assert!(range(2)[0] < 0.92 && range(2)[1] > 1.08);
}

#[test]
fn degenerate_trims_of_the_cap_are_points_and_seams_coincide() {
    let cap = model("cap");
    let mut points = 0;
    for face in cap.faces() {
        let surface = &cap.surfaces()[face.surface];
        let space = |trim: &Trim| walk(trim).iter().map(|p| surface.point(p.x, p.y)).collect::<Vec<_>>();
        let trims = &face.loops[0].trims;
        for trim in trims.iter().filter(|trim| trim.degenerate) {
            let points_of = space(trim);
            assert!(points_of.iter().all(|p| p.distance(points_of[0]) <= 1e-15));
            points += 1;
        }
        let seams: Vec<Vec<DVec3>> = trims.iter().filter(|trim| trim.seam).map(space).collect();
        if let [up, down] = seams.as_slice() {
            assert!(up.iter().zip(down.iter().rev()).all(|(a, b)| a.distance(*b) <= 1e-15));
        } else {
            assert!(seams.is_empty());
        }
    }
    assert_eq!(points, 2);
}

#[test]
fn cusps_have_no_tangent_in_their_middle() {
    let cusp = model("cusp");
    for (boundary, which, apex) in [(0, 1, dvec2(0.5, 0.875)), (1, 0, dvec2(0.5, 0.525))] {
        let trim = &cusp.faces()[0].loops[boundary].trims[which];
        let [c, derivative] = homogeneous(trim, 0.5);
        assert!(derivative.length() <= 1e-15 && c.truncate().distance(apex) <= 1e-15);
        // It is no smooth stop: the tangent turns about.
        let [before, after] = [0.499, 0.501].map(|t| homogeneous(trim, t)[1].truncate().normalize());
        assert!(before.dot(after) < -0.99);
    }
}

#[test]
fn the_waist_of_the_sliver_is_as_wide_as_it_says() {
    let sliver = model("sliver");
    let trims = &sliver.faces()[0].loops[0].trims;
    let width = |share: f64| at(&trims[2], 1.0 - share).y - at(&trims[0], share).y;
    assert!((width(0.5) - WAIST).abs() <= 1e-15);
    assert!((0..=1000).all(|k| width(k as f64 / 1000.0) >= WAIST - 1e-15) && width(0.0) > 0.5);
}

#[test]
fn pieces_are_fifty_a_face_single_and_monotone() {
    for face in model("pieces").faces() {
        let trims: Vec<&Trim> = face.loops.iter().flat_map(|boundary| &boundary.trims).collect();
        assert_eq!(trims.len(), 50);
        for trim in trims {
            assert_eq!(trim.knots.spans().count(), 1);
            let points = walk(trim);
            let steps: Vec<DVec2> = points.windows(2).map(|w| w[1] - w[0]).collect();
            let monotone =
                |d: &dyn Fn(&DVec2) -> f64| steps.iter().all(|s| d(s) >= -1e-15) || steps.iter().all(|s| d(s) <= 1e-15);
            assert!(monotone(&|s| s.x) && monotone(&|s| s.y), "{trim:?}");
        }
    }
}

#[test]
fn the_shared_edge_agrees_to_a_millionth_and_not_much_better() {
    let pair = model("seam-pair");
    let edge_of = |face: usize| {
        let trims = &pair.faces()[face].loops[0].trims;
        trims.iter().find(|trim| trim.edge == Some(1)).expect("both name it")
    };
    let [lower, upper] = [0, 1].map(edge_of);
    assert_eq!((lower.reversed, upper.reversed), (true, false));
    let mut largest = 0.0f64;
    for k in 0..=10_000 {
        let share = k as f64 / 10_000.0;
        // Both run along x at the same rate, against each other.
        let [a, b] = [at(lower, 1.0 - share), at(upper, share)];
        let [a, b] = [pair.surfaces()[0].point(a.x, a.y), pair.surfaces()[1].point(b.x, b.y)];
        assert!((a.x - b.x).abs() <= 1e-14, "{a} {b}");
        largest = largest.max(a.distance(b));
    }
    assert!((2e-7..=1e-6).contains(&largest), "{largest}");
}

//! Evaluation against 50-digit arithmetic: `testdata/oracle/eval`, frozen by `tests/oracle/freeze.py`.
//!
//! Errors are relative to the largest value of that quantity among the surface's points, or to what the surface's size
//! over its domain makes of it, whichever is larger: a second derivative that is exactly zero has no relative error.

use glam::{DVec2, DVec3};
use nurbs::{BezierPatch, Direction, KnotVector, NormalStatus, Surface};
use serde_json::Value;
use std::path::PathBuf;

/// S and derivatives, relative.
const DERIVATIVES: f64 = 1e-12;
/// Curvatures, relative to the larger principal curvature of the point, or to 1 / size.
const CURVATURES: f64 = 1e-9;

struct Case {
    name: String,
    surface: Surface,
    answers: Value,
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("an array").iter().map(|x| x.as_f64().expect("a number")).collect()
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&numbers(value))
}

fn cases() -> Vec<Case> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../testdata/oracle/eval");
    let mut files: Vec<PathBuf> =
        folder.read_dir().expect("frozen answers").map(|e| e.expect("an entry").path()).collect();
    files.sort();
    let mut cases = vec![];
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a readable file");
        let frozen: Value = serde_json::from_str(&text).expect("JSON");
        for entry in frozen["surfaces"].as_array().expect("surfaces") {
            let s = &entry["surface"];
            let degree = numbers(&s["degree"]);
            let knots = |name: &str, p: f64| KnotVector::new(p as usize, numbers(&s[name])).expect("legal knots");
            let points = s["points"].as_array().expect("points").iter().map(vector).collect();
            let weights = (!s["weights"].is_null()).then(|| numbers(&s["weights"]));
            let surface = Surface::new(knots("knots_u", degree[0]), knots("knots_v", degree[1]), points, weights);
            cases.push(Case {
                name: entry["name"].as_str().expect("a name").to_owned(),
                surface: surface.expect("a legal surface"),
                answers: entry.clone(),
            });
        }
    }
    cases
}

/// Every disagreement with the frozen answers, worst first, and the number of points checked.
fn disagreements(cases: &[Case]) -> (Vec<String>, usize) {
    let mut found: Vec<(f64, String)> = vec![];
    let mut points = 0;
    for case in cases {
        let uv: Vec<Vec<f64>> = case.answers["uv"].as_array().expect("uv").iter().map(numbers).collect();
        points += uv.len();
        let size = case.surface.hull().diagonal();
        // An ulp of a coordinate is what S itself can carry, far from the origin.
        let ulp = case.surface.hull().max.abs().max(case.surface.hull().min.abs()).max_element() * f64::EPSILON;
        let [length_u, length_v] = [Direction::U, Direction::V].map(|d| case.surface.knots(d).length());
        let floors = [
            ("S", size),
            ("Su", size / length_u),
            ("Sv", size / length_v),
            ("Suu", size / (length_u * length_u)),
            ("Suv", size / (length_u * length_v)),
            ("Svv", size / (length_v * length_v)),
        ];
        let mut together = vec![];
        let places: Vec<DVec2> = uv.iter().map(|uv| DVec2::new(uv[0], uv[1])).collect();
        case.surface.evaluate_many(&places, &mut together);
        let mine: Vec<_> = uv.iter().map(|uv| case.surface.inspect(uv[0], uv[1])).collect();
        for (which, (name, floor)) in floors.into_iter().enumerate() {
            let expected: Vec<DVec3> = case.answers[name].as_array().expect("answers").iter().map(vector).collect();
            let scale = expected.iter().map(|x| x.length()).fold(floor, f64::max);
            let scale = if name == "S" { size } else { scale };
            for (i, (point, expected)) in mine.iter().zip(&expected).enumerate() {
                let d = point.derivatives;
                let value = [d.s, d.su, d.sv, d.suu, d.suv, d.svv][which];
                let first = together[i].derivatives;
                let in_bulk = [first.s, first.su, first.sv].get(which).copied().unwrap_or(value);
                let slack = if name == "S" { ulp } else { 0.0 };
                let error = (value - *expected).length().max((in_bulk - *expected).length());
                let share = (error - slack).max(0.0) / scale / DERIVATIVES;
                if share.is_nan() || share > 1.0 {
                    found.push((share, format!("{} {name} at {:?}: {share:.2} of the tolerance", case.name, uv[i])));
                }
            }
        }
        for (i, point) in mine.iter().enumerate() {
            let kind = case.answers["normal_kind"][i].as_str().expect("a kind");
            let status = point.normal.status();
            // The oracle stops at first order; a higher one may find the limit that it does not.
            let agree = matches!(
                (kind, status),
                ("regular", NormalStatus::Regular)
                    | ("limit", NormalStatus::Limit)
                    | ("none", NormalStatus::Limit | NormalStatus::Undefined)
            );
            if !agree {
                found.push((f64::INFINITY, format!("{} normal at {:?}: {kind}, found {status:?}", case.name, uv[i])));
            }
            if kind != "none" {
                let expected = vector(&case.answers["normal"][i]);
                let error = point.normal.unit().map_or(f64::INFINITY, |n| n.distance(expected));
                if error > CURVATURES {
                    found
                        .push((error / CURVATURES, format!("{} normal at {:?}: off by {error:.2e}", case.name, uv[i])));
                }
            }
            if let Some(k) = point.curvature.filter(|_| kind == "regular") {
                let answer = |name: &str| case.answers[name][i].as_f64().expect("a curvature");
                let largest = answer("k1").abs().max(answer("k2").abs()).max(1.0 / size);
                let values = [
                    ("K", k.gaussian, largest * largest),
                    ("H", k.mean, largest),
                    ("k1", k.k1, largest),
                    ("k2", k.k2, largest),
                ];
                for (name, value, scale) in values {
                    let share = (value - answer(name)).abs() / scale / CURVATURES;
                    if share.is_nan() || share > 1.0 {
                        found
                            .push((share, format!("{} {name} at {:?}: {share:.2} of the tolerance", case.name, uv[i])));
                    }
                }
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    (found.into_iter().map(|(_, text)| text).collect(), points)
}

#[test]
fn evaluation_agrees_with_fifty_digit_arithmetic() {
    let cases = cases();
    let (found, points) = disagreements(&cases);
    assert!(cases.len() >= 200 && points >= 20 * cases.len(), "{} surfaces, {points} points", cases.len());
    assert!(found.is_empty(), "{} of {points} points:\n{}", found.len(), found[..found.len().min(40)].join("\n"));
}

#[test]
fn a_wrong_answer_of_the_oracle_is_noticed() {
    let mut cases = cases();
    cases.truncate(2);
    let (clean, _) = disagreements(&cases);
    let x = cases[1].answers["Suv"][3][1].as_f64().expect("a number");
    let size = cases[1].surface.hull().diagonal();
    cases[1].answers["Suv"][3][1] = Value::from(x + 1e-6 * (x.abs() + size));
    assert_eq!(disagreements(&cases).0.len(), clean.len() + 1);
}

/// The same surface evaluated from its extracted Bézier patches, after elevation, refinement and splitting.
#[test]
fn every_other_form_of_a_surface_evaluates_alike() {
    for case in cases().iter().filter(|case| !case.name.starts_with("tiny")) {
        let s = &case.surface;
        let near = |a: DVec3, b: DVec3, what: &str| {
            let allowed = 1e-12 * (s.hull().diagonal() + s.hull().center().length());
            assert!(a.distance(b) <= allowed, "{} {what}: {:e}", case.name, a.distance(b));
        };
        let inside = |patch: &BezierPatch| patch.domain.map(|[a, b]| a + 0.37 * (b - a));
        let mut refined = s.clone();
        for direction in [Direction::U, Direction::V] {
            let (start, end) = s.knots(direction).domain();
            refined = refined
                .refined(direction, &[start + 0.31 * (end - start), start + 0.77 * (end - start)])
                .expect("inside");
            if refined.knots(direction).degree() < nurbs::MAX_DEGREE {
                refined = refined.elevated(direction).expect("below the cap");
            }
        }
        let (start, end) = s.knots(Direction::U).domain();
        let cut = start + 0.43 * (end - start);
        let halves = s.split(Direction::U, cut).expect("inside");
        for patch in s.bezier_patches() {
            let [u, v] = inside(&patch);
            let expected = s.point(u, v);
            near(patch.first_derivatives(u, v).s, expected, "Bézier patch");
            near(refined.point(u, v), expected, "refined and elevated");
            near(halves[usize::from(u >= cut)].point(u, v), expected, "split");
            let hull = patch.hull();
            assert!(
                hull.min.cmple(expected + 1e-300).all() && hull.max.cmpge(expected - 1e-300).all(),
                "{} hull",
                case.name
            );
        }
    }
}

/// The bounds that size a tessellation hold at every point of a dense grid.
#[test]
fn derivative_bounds_hold_everywhere() {
    for case in cases() {
        for patch in case.surface.bezier_patches() {
            let bounds = patch.derivative_bounds();
            let [[u0, u1], [v0, v1]] = patch.domain;
            for i in 0..8 {
                for j in 0..8 {
                    // Strictly inside, so that the span is the patch's own.
                    let (u, v) = (u0 + (u1 - u0) * (i as f64 + 0.5) / 8.0, v0 + (v1 - v0) * (j as f64 + 0.5) / 8.0);
                    let d = case.surface.second_derivatives(u, v);
                    for (value, bound) in
                        [(d.su, bounds.u), (d.sv, bounds.v), (d.suu, bounds.uu), (d.suv, bounds.uv), (d.svv, bounds.vv)]
                    {
                        assert!(
                            value.length() <= bound * (1.0 + 1e-9) + 1e-300,
                            "{} at ({u}, {v}): {} > {bound}",
                            case.name,
                            value.length()
                        );
                    }
                }
            }
        }
    }
}

//! Seams whose greatest gap, angle and difference of curvature mpmath found: `testdata/oracle/continuity.json`, frozen by
//! `tests/oracle/make_continuity.py`.

use continuity::{Limits, Settings, report};
use glam::DVec3;
use nurbs::{KnotVector, Surface};
use scene::Model;
use serde_json::Value;

/// What doubles leave of them.
const NOISE: [f64; 3] = [1e-11, 1e-7, 1e-8];

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

fn surface(patch: &Value) -> Surface {
    let knots = |n: &f64| {
        let order = *n as usize + 1;
        KnotVector::new(order - 1, [vec![0.0; order], vec![1.0; order]].concat()).expect("one span")
    };
    let degree = numbers(&patch["degree"]);
    let points = patch["points"].as_array().expect("points").iter().map(numbers).map(|p| DVec3::new(p[0], p[1], p[2]));
    Surface::new(knots(&degree[0]), knots(&degree[1]), points.collect(), Some(numbers(&patch["weights"])))
        .expect("a patch")
}

#[test]
fn every_bound_holds_what_mpmath_found_and_is_near_it() {
    let text = std::fs::read_to_string("../../testdata/oracle/continuity.json").expect("frozen answers");
    let document: Value = serde_json::from_str(&text).expect("JSON");
    let seams = document["seams"].as_array().expect("seams");
    assert_eq!(seams.len(), 24);
    for (index, seam) in seams.iter().enumerate() {
        let surfaces = seam["patches"].as_array().expect("two").iter().map(surface).collect();
        let model = Model::of_surfaces("seam", surfaces).expect("surfaces");
        // Limits far below, so that all bounds are made close.
        let limits = Limits { gap: 1e-9, angle_deg: 1e-5, curvature: Some(1e-6) };
        let found = report(&model, Settings { limits, millimetres: 1.0, reach: 0.1, flat: 1e-6 });
        let edge = found
            .edges
            .iter()
            .find(|edge| edge.borders[0].border == "side u1" || edge.borders[1].border == "side u1")
            .expect("the seam");
        let answers = [
            ("gap", edge.gap.seen, edge.gap.bound),
            ("angle", edge.angle_deg.seen.to_radians(), edge.angle_deg.bound.to_radians()),
            ("difference", edge.curvature_difference.seen, edge.curvature_difference.bound),
        ];
        for ((name, seen, bound), noise) in answers.into_iter().zip(NOISE) {
            let there = seam[name].as_f64().expect("a number");
            assert!(there * (1.0 - 1e-12) <= bound + noise, "seam {index}, {name}: bound {bound:e} below {there:e}");
            assert!(seen <= there * (1.0 + 1e-6) + noise, "seam {index}, {name}: seen {seen:e} above {there:e}");
            // The difference is bounded beside the relative one, which alone decides how close bounds are made.
            let close = if name == "difference" { 0.3 } else { 0.011 };
            assert!(
                bound <= there * (1.0 + close) + 10.0 * noise,
                "seam {index}, {name}: {bound:e} far above {there:e}"
            );
        }
    }
}

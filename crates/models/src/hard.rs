//! Surfaces for conformance: each is hard for a renderer in the one way that its line in [`HARD`] names.
//!
//! They open by name like the other built-in models, so that any pixel of a conformance report can be asked for again.
//! Those of `testdata/cases` are embedded; the rest are made here.

use crate::construction::{clamped, embedded, even, revolved, sampled, surface};
use glam::DVec3;
use libm::{cos, sin};
use nurbs::Surface;
use scene::Model;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Names of the hard models, each with a line on what it stresses.
pub const HARD: &[(&str, &str)] = &[
    ("degree-1x9", "degree 1 x 9"),
    ("degree-2x8", "degree 2 x 8"),
    ("degree-3x7", "degree 3 x 7"),
    ("degree-4x6", "degree 4 x 6"),
    ("degree-5x5", "degree 5 x 5"),
    ("degree-6x4", "degree 6 x 4"),
    ("degree-7x3", "degree 7 x 3"),
    ("degree-8x2", "degree 8 x 2"),
    ("degree-9x1", "degree 9 x 1"),
    ("crease", "bicubic, knots of full multiplicity both ways: ridges where the normal jumps"),
    ("weights-1000", "bicubic, rows of weights by turns 1 and 1000"),
    ("weights-629", "degree 4 x 4, weights over a ratio of 629"),
    ("far", "a wave of unit size, a million units from the origin each way"),
    ("huge", "coordinates up to 1e9"),
    ("tiny-spans", "knot spans from 0.3 down to 1e-8"),
    ("fold", "folds over and cuts itself"),
    ("lens", "two opposite sides collapsed to points"),
    ("petal", "one side collapsed to a point"),
    ("cone", "rational, degree 2 x 1, with an apex"),
    ("hyperboloid", "rational, degree 2 x 2: a branch of a hyperbola, turned"),
    ("tube", "bicubic, closed by clamped ends that meet in a seam"),
    ("unclamped-rational", "degree 4 x 3, rational, uniform knots not repeated at the ends"),
    ("dish", "a shallow bowl: views from the side are near its tangent planes"),
];

/// The hard model of that name.
pub(crate) fn hard(name: &str) -> Option<Model> {
    let made = match name {
        "crease" => crease(),
        "weights-1000" => weights(),
        "far" => far(),
        "petal" => petal(),
        "cone" => revolved(&[[0.8, -0.6, 1.0], [0.0, 0.7, 1.0]], clamped(1, &[])),
        "hyperboloid" => hyperboloid(),
        "tube" => tube(),
        "dish" => dish(),
        "weights-629" => return Some(case(name, include_str!("../../../testdata/cases/weights_2.json"))),
        "huge" => return Some(case(name, include_str!("../../../testdata/cases/huge_2.json"))),
        "tiny-spans" => return Some(case(name, include_str!("../../../testdata/cases/tiny_0.json"))),
        "fold" => return Some(case(name, include_str!("../../../testdata/cases/fold_0.json"))),
        "lens" => return Some(case(name, include_str!("../../../testdata/cases/pole_3.json"))),
        "unclamped-rational" => return Some(case(name, include_str!("../../../testdata/cases/unclamped_2.json"))),
        _ => {
            let (name, _) = HARD.iter().find(|(known, _)| *known == name)?;
            let (p, q) = name.strip_prefix("degree-")?.split_once('x')?;
            degree(p.parse().ok()?, q.parse().ok()?)
        }
    };
    Some(Model::of_surfaces(name, vec![made]).expect("there is a surface"))
}

/// An embedded file under the name that it has here.
fn case(name: &str, text: &str) -> Model {
    let model = embedded(text);
    Model::new(name, model.surfaces().to_vec(), model.faces().to_vec()).expect("it was a model before")
}

/// A rolling surface of three spans each way; a direction of degree 1 has eight, or it would be a prism.
fn degree(p: usize, q: usize) -> Surface {
    let knots = |degree: usize| even(degree, if degree == 1 { 9 } else { degree + 3 });
    sampled(knots(p), knots(q), |u, v| {
        let (x, y) = (1.6 * u - 0.8, 1.6 * v - 0.8);
        DVec3::new(x, y, 0.3 * sin(4.0 * x + 0.5) * cos(3.0 * y) + 0.15 * x * y)
    })
}

/// Ridges at u = ½ and v = ⅓, where a control point of the net is a point of the surface.
fn crease() -> Surface {
    let (knots_u, knots_v) = (clamped(3, &[0.5, 0.5, 0.5]), clamped(3, &[1.0 / 3.0; 3]));
    sampled(knots_u, knots_v, |u, v| {
        let roof = 0.5 - (u - 0.5).abs() - 0.7 * (v - 1.0 / 3.0).abs();
        DVec3::new(1.6 * u - 0.8, 1.4 * v - 0.7, roof + 0.1 * sin(9.0 * u) * sin(7.0 * v))
    })
}

/// Heavy rows of control points pull the surface to themselves: flat between, sharp around. Rows only, as the bound on
/// second derivatives that a tessellation rests on grows with the ratio, and one span, as it grows again with each: 4 x 4
/// spans weighted both ways ask for half a million triangles.
fn weights() -> Surface {
    let (knots_u, knots_v) = (even(3, 4), even(3, 4));
    let even = sampled(knots_u.clone(), knots_v.clone(), |u, v| {
        let (x, y) = (1.6 * u - 0.8, 1.6 * v - 0.8);
        DVec3::new(x, y, 0.35 * cos(4.0 * x) * sin(3.0 * y + 0.4))
    });
    let weights = (0..16).map(|k| if k / 4 % 2 == 0 { 1.0 } else { 1000.0 }).collect();
    surface(knots_u, knots_v, even.points().to_vec(), Some(weights))
}

fn far() -> Surface {
    sampled(clamped(3, &[0.25, 0.5, 0.5]), even(3, 6), |u, v| {
        let (x, y) = (2.0 * u - 1.0, 1.4 * v - 0.7);
        DVec3::new(1e6 + x, -1e6 + y, 1e6 + 0.2 * sin(5.0 * x) * cos(3.0 * y))
    })
}

/// Bicubic over a triangle: the side u = 0 is its tip.
fn petal() -> Surface {
    sampled(clamped(3, &[0.4]), clamped(3, &[0.5]), |u, v| {
        let angle = 1.3 * (v - 0.5);
        DVec3::new(1.2 * u * sin(angle), 0.6 - 1.2 * u * cos(angle), 0.5 * u * (1.0 - u) + 0.1 * u * cos(6.0 * angle))
    })
}

/// x² − z² = ¼ with its vertex in the middle: a middle weight above 1.
fn hyperboloid() -> Surface {
    // The arc between asymptotic ends (cosh a, ± sinh a) / 2 with cosh a = 5/3: tangents meet at (½ / cosh a, 0).
    let [cosh, sinh] = [5.0 / 3.0, 4.0 / 3.0];
    let profile = [[0.5 * cosh, -0.5 * sinh, 1.0], [0.5 / cosh, 0.0, cosh], [0.5 * cosh, 0.5 * sinh, 1.0]];
    revolved(&profile, clamped(2, &[]))
}

/// A fluted tube: first and last column of control points are the same, so are the tangents there.
fn tube() -> Surface {
    let (knots_u, knots_v) = (even(3, 12), clamped(3, &[0.3, 0.6]));
    let open = sampled(knots_u.clone(), knots_v.clone(), |u, v| {
        let angle = TAU * u;
        let radius = (0.4 + 0.1 * sin(6.0 * v)) * (1.0 + 0.12 * cos(3.0 * angle));
        DVec3::new(radius * cos(angle), radius * sin(angle), 1.3 * v - 0.65)
    });
    let (rows, columns) = (12, open.control_counts()[1]);
    let mut points = open.points().to_vec();
    for j in 0..columns {
        let middle = (points[columns + j] + points[(rows - 2) * columns + j]) / 2.0;
        points[j] = middle;
        points[(rows - 1) * columns + j] = middle;
    }
    surface(knots_u, knots_v, points, None)
}

fn dish() -> Surface {
    let meridian = [[0.0, -0.12, 1.0], [0.5, -0.12, FRAC_1_SQRT_2], [1.0, 0.12, 1.0]];
    revolved(&meridian, clamped(2, &[]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BUILTINS, builtin};

    #[test]
    fn every_hard_model_opens_and_no_name_is_taken_twice() {
        for (name, _) in HARD {
            let model = builtin(name).unwrap();
            assert_eq!((model.name(), model.is_trimmed()), (*name, false));
            assert!(model.hull().diagonal() > 0.5, "{name}");
            assert!(BUILTINS.iter().all(|(other, _)| other != name));
        }
        assert!(builtin("degree-3x3").is_none() && builtin("degree-").is_none());
    }

    #[test]
    fn degrees_are_as_named() {
        for p in 1..=9 {
            let model = builtin(&format!("degree-{p}x{}", 10 - p)).unwrap();
            assert_eq!(model.surfaces()[0].degree(), [p, 10 - p]);
        }
    }

    #[test]
    fn the_hyperboloid_satisfies_its_equation() {
        let surface = hyperboloid();
        for k in 0..=400 {
            let s = surface.point((k % 20) as f64 / 20.0, (k / 20) as f64 / 20.0);
            assert!((s.x * s.x + s.y * s.y - s.z * s.z - 0.25).abs() <= 1e-14, "{s}");
        }
    }

    #[test]
    fn the_tube_closes_with_one_tangent() {
        let surface = tube();
        for v in [0.0, 0.37, 1.0] {
            let [a, b] = [0.0, 1.0].map(|u| surface.first_derivatives(u, v));
            assert!(a.s.distance(b.s) <= 1e-15 && a.su.distance(b.su) <= 1e-12, "{v}");
        }
    }

    #[test]
    fn sides_collapse_where_the_name_says_so() {
        for (name, sides) in [("petal", 1), ("lens", 2), ("cone", 1), ("dish", 1)] {
            let model = builtin(name).unwrap();
            let surface = &model.surfaces()[0];
            let [[u0, u1], [v0, v1]] = surface.domain();
            let length = |a: [f64; 2], b: [f64; 2]| {
                let at = |t: f64| surface.point(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
                (0..8).map(|k| at(k as f64 / 8.0).distance(at((k + 1) as f64 / 8.0))).sum::<f64>()
            };
            let ends = [([u0, v0], [u0, v1]), ([u1, v0], [u1, v1]), ([u0, v0], [u1, v0]), ([u0, v1], [u1, v1])];
            assert_eq!(ends.iter().filter(|(a, b)| length(*a, *b) < 1e-12).count(), sides, "{name}");
        }
    }
}

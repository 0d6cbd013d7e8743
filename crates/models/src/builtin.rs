//! The models that are built in: Newell's tea set, and surfaces that are made here to be hard in one way each.
//!
//! The made ones are about a unit in size, z up, and good to look at from the direction (1, −1.6, 0.9). They are the
//! same numbers on every machine: `+ − × ÷ √` and the sine and cosine of the `libm` crate.

use crate::construction::{
    CIRCLE, QUARTERS, clamped, even, greville, knots, revolved, sample, sampled, sphere, surface,
};
use crate::hard::hard;
use crate::published::published;
use crate::tea_set;
use crate::trimmed::trimmed;
use glam::{DVec3, DVec4};
use libm::{cos, sin};
use nurbs::{KnotVector, Surface};
use scene::Model;
use std::f64::consts::TAU;

/// Names of the built-in models, each with a line on what it is.
pub const BUILTINS: &[(&str, &str)] = &[
    ("teapot", "Newell's teapot: 32 bicubic Bézier patches, some with a collapsed side"),
    ("teacup", "Newell's cup: 26 bicubic Bézier patches, y up"),
    ("teaspoon", "Newell's spoon: 16 bicubic Bézier patches"),
    ("sphere", "the unit sphere: rational, degree 2 x 2, 9 x 5 control points, a pole at each end"),
    ("torus", "a torus: rational, degree 2 x 2, 9 x 9 control points, closed both ways"),
    ("surface", "a wave: bicubic, 14 x 6 control points, non-uniform, with double and triple knots"),
    ("rational", "the wave with weights from 0.5 to 2"),
    ("bilinear-quartic", "a pleated fan: degree 1 x 4, sharp creases"),
    ("quintic-quadratic", "a saddle: degree 5 x 2"),
    ("septic", "a ripple: degree 7 x 7"),
    ("unclamped", "a dome: bicubic, knots not repeated at the ends"),
    ("periodic", "a fluted vase: bicubic, closed with periodic knots"),
    ("spray", "a fountain of leaves: 266 bicubic surfaces of 18 x 18 control points"),
];

/// The built-in model of that name; `None` where [`all`](crate::all) has no such name.
pub fn builtin(name: &str) -> Option<Model> {
    let surfaces = match name {
        "teapot" => return Some(tea_set::teapot()),
        "teacup" => return Some(tea_set::teacup()),
        "teaspoon" => return Some(tea_set::teaspoon()),
        "sphere" => vec![sphere()],
        "torus" => vec![torus()],
        "surface" => vec![wave(|_, _| 1.0)],
        "rational" => vec![wave(|i, j| 1.25 + 0.75 * sin((17 * i + 23 * j) as f64 / 10.0))],
        "bilinear-quartic" => vec![fan()],
        "quintic-quadratic" => vec![saddle()],
        "septic" => vec![ripple()],
        "unclamped" => vec![dome()],
        "periodic" => vec![vase()],
        "spray" => spray(),
        _ => return hard(name).or_else(|| trimmed(name)).or_else(|| published(name)),
    };
    Some(Model::of_surfaces(name, surfaces).expect("each has a surface"))
}

/// Radii 0.75 and 0.25.
fn torus() -> Surface {
    let tube = CIRCLE.map(|[x, y, w]| [0.75 + 0.25 * x, 0.25 * y, w]);
    revolved(&tube, clamped(2, &QUARTERS))
}

/// A wave whose knots in u include a double and a triple one, and a double one in v; C¹ throughout, with jumps of
/// curvature. A weight of 1 everywhere makes it polynomial.
fn wave(weight: impl Fn(usize, usize) -> f64) -> Surface {
    let u = [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 3.5, 4.0, 4.0, 4.0, 5.5, 6.0, 7.0, 8.0, 8.0, 8.0, 8.0];
    let (knots_u, knots_v) = (knots(3, &u), clamped(3, &[0.35, 0.35]));
    let points = sample(&knots_u, &knots_v, |u, v| {
        let (x, y) = (2.0 * u - 1.0, 1.2 * v - 0.6);
        DVec3::new(x, y, 0.2 * sin(5.5 * x + 0.8) * cos(2.2 * y) + 0.1 * sin(4.0 * y - 2.0 * x))
    });
    let columns = knots_v.control_count();
    let homogeneous = |(k, p): (usize, &DVec3)| {
        let w = weight(k / columns, k % columns);
        (*p * w).extend(w)
    };
    let mut control: Vec<DVec4> = points.iter().enumerate().map(homogeneous).collect();
    // Control point 7 is the one at the triple knot, u[8] = u[9] = u[10]: put it where the first derivatives of
    // both sides are equal.
    let (below, above) = (u[8] - u[7], u[11] - u[10]);
    for j in 0..columns {
        let [before, after] = [6, 8].map(|i| control[i * columns + j]);
        control[7 * columns + j] = (above * before + below * after) / (below + above);
    }
    let points = control.iter().map(|c| c.truncate() / c.w).collect();
    let weights: Vec<f64> = control.iter().map(|c| c.w).collect();
    let rational = weights.iter().any(|&w| w != 1.0);
    surface(knots_u, knots_v, points, rational.then_some(weights))
}

fn fan() -> Surface {
    // Ridges and valleys by turns: a shape that is itself piecewise linear in u, so taken by its corners.
    let knots_u = even(1, 9);
    sampled(knots_u, clamped(4, &[0.3, 0.5, 0.8]), |u, v| {
        let fold = (8.0 * u) as i64 % 2;
        let angle = 2.2 * (0.5 - u);
        let radius = 0.35 + 0.75 * v;
        let height = 0.12 * v * (1 - 2 * fold) as f64 + 0.25 * sin(3.0 * v);
        DVec3::new(radius * sin(angle), 0.7 - radius * cos(angle), height)
    })
}

fn saddle() -> Surface {
    sampled(clamped(5, &[0.2, 0.5, 0.5, 0.9]), clamped(2, &[0.25, 0.4, 0.4, 0.7]), |u, v| {
        let (x, y) = (1.8 * u - 0.9, 1.4 * v - 0.7);
        DVec3::new(x, y, 0.5 * (x * x - y * y) + 0.08 * sin(6.0 * x))
    })
}

fn ripple() -> Surface {
    sampled(clamped(7, &[0.3, 0.55, 0.8]), clamped(7, &[0.4, 0.6]), |u, v| {
        let (x, y) = (1.8 * u - 0.9, 1.8 * v - 0.9);
        let r2 = x * x + y * y;
        DVec3::new(x, y, 0.35 * cos(5.0 * r2.sqrt()) / (1.0 + r2))
    })
}

fn dome() -> Surface {
    let u = knots(3, &[-3.0, -1.5, -1.0, 0.0, 0.75, 2.0, 2.5, 4.0, 5.0, 5.5, 7.0]);
    let v = knots(3, &[-2.0, -1.5, -1.0, 0.0, 1.0, 1.5, 3.0, 4.0, 4.25, 6.0, 7.0, 8.0]);
    sampled(u, v, |u, v| {
        let (x, y) = (1.6 * u - 0.8, 1.6 * v - 0.8);
        DVec3::new(x, y, 0.6 - 0.5 * (x * x + y * y) + 0.06 * sin(7.0 * x) * sin(6.0 * y))
    })
}

/// Control points of one round of the vase.
const VASE_COUNT: usize = 16;

fn vase() -> Surface {
    // One period of 16 spans, not all of the same length.
    let period: Vec<f64> = (0..=VASE_COUNT).map(|i| i as f64 + 0.125 * (i % 4) as f64).collect();
    let knots_u = KnotVector::periodic(3, &period).expect("sorted, and as long as asked for");
    let knots_v = clamped(3, &[0.2, 0.45, 0.7, 0.85]);
    let mut points = vec![];
    // As many more as the degree close it: the first ones again.
    for i in 0..knots_u.control_count() {
        let angle = TAU * greville(&knots_u, i % VASE_COUNT);
        for j in 0..knots_v.control_count() {
            let v = greville(&knots_v, j);
            let radius = (0.36 + 0.16 * sin(5.5 * v + 0.3)) * (1.0 + 0.14 * cos(4.0 * angle + 2.0 * v));
            points.push(DVec3::new(radius * cos(angle), radius * sin(angle), 1.3 * v - 0.65));
        }
    }
    surface(knots_u, knots_v, points, None)
}

/// Jets of the fountain.
const JETS: usize = 38;

/// Leaves on each jet; 38 × 7 = 266.
const LEAVES: usize = 7;

/// Control points along each side of a leaf.
const LEAF_COUNT: usize = 18;

/// 2π over the square of the golden ratio: no two jets lie in one plane.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

fn spray() -> Vec<Surface> {
    (0..JETS).flat_map(|jet| (0..LEAVES).map(move |leaf| spray_leaf(jet, leaf))).collect()
}

/// A leaf that flies along the parabola of its jet, turned a little about its own path, cupped and rippled.
fn spray_leaf(jet: usize, leaf: usize) -> Surface {
    let azimuth = GOLDEN_ANGLE * jet as f64;
    let outward = DVec3::new(cos(azimuth), sin(azimuth), 0.0);
    let side = DVec3::new(-outward.y, outward.x, 0.0);
    // Steps of 13 round 38 mix far and near jets; r = reach t, z = 4 height t (1 − t), t from 0 to 1.
    let reach = 0.3 + 0.7 * (jet * 13 % JETS) as f64 / (JETS - 1) as f64;
    let height = 1.15 - 0.5 * reach;
    let t = (leaf as f64 + 0.75 + 0.5 * (jet % 2) as f64) / (LEAVES + 1) as f64;
    let center = outward * (reach * t) + DVec3::Z * (4.0 * height * t * (1.0 - t));
    let along = (outward * reach + DVec3::Z * (4.0 * height * (1.0 - 2.0 * t))).normalize();
    let above = along.cross(side);
    let turn = 0.9 * sin((17 * jet + 23 * leaf) as f64 / 10.0);
    let across = side * cos(turn) + above * sin(turn);
    let normal = along.cross(across);
    let (half_length, half_width) = (0.07 + 0.05 * t, 0.03 + 0.025 * t);
    sampled(even(3, LEAF_COUNT), even(3, LEAF_COUNT), |u, v| {
        let (s, q) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let bend = -0.3 * half_length * s * s - 0.45 * half_width * q * q;
        let veins = 0.012 * sin(9.0 * s) * cos(5.0 * q);
        center
            + along * (half_length * s)
            + across * (half_width * q * (1.0 - 0.8 * s * s))
            + normal * (bend + veins * (1.0 - s * s))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs::Direction;

    #[test]
    fn every_builtin_opens_with_its_degrees_and_counts() {
        let expected = [
            ("teapot", 32, [3, 3], [4, 4], false),
            ("teacup", 26, [3, 3], [4, 4], false),
            ("teaspoon", 16, [3, 3], [4, 4], false),
            ("sphere", 1, [2, 2], [9, 5], true),
            ("torus", 1, [2, 2], [9, 9], true),
            ("surface", 1, [3, 3], [14, 6], false),
            ("rational", 1, [3, 3], [14, 6], true),
            ("bilinear-quartic", 1, [1, 4], [9, 8], false),
            ("quintic-quadratic", 1, [5, 2], [10, 7], false),
            ("septic", 1, [7, 7], [11, 10], false),
            ("unclamped", 1, [3, 3], [7, 8], false),
            ("periodic", 1, [3, 3], [19, 8], false),
            ("spray", 266, [3, 3], [18, 18], false),
        ];
        assert_eq!(BUILTINS.len(), expected.len());
        for ((name, _), (expected_name, count, degree, counts, rational)) in BUILTINS.iter().zip(expected) {
            assert_eq!(*name, expected_name);
            let model = builtin(name).unwrap();
            assert_eq!((model.name(), model.surfaces().len(), model.faces().len()), (*name, count, count));
            assert!(!model.is_trimmed());
            for surface in model.surfaces() {
                assert_eq!((surface.degree(), surface.control_counts()), (degree, counts), "{name}");
                assert_eq!(surface.weights().is_some(), rational, "{name}");
            }
        }
        assert!(builtin("teapots").is_none() && builtin("").is_none());
    }

    /// Parameters spread over the domain of a surface, its borders included.
    fn grid(surface: &Surface) -> Vec<[f64; 2]> {
        let [[u0, u1], [v0, v1]] = surface.domain();
        let at = |a: f64, b: f64, k: usize| if k == 40 { b } else { a + (b - a) * k as f64 / 40.0 };
        (0..41 * 41).map(|k| [at(u0, u1, k / 41), at(v0, v1, k % 41)]).collect()
    }

    #[test]
    fn sphere_and_torus_satisfy_their_equations_and_face_outward() {
        let sphere = sphere();
        for [u, v] in grid(&sphere) {
            let d = sphere.first_derivatives(u, v);
            assert!((d.s.length() - 1.0).abs() <= 1e-14, "{u} {v}: {}", d.s.length());
            assert!(d.su.cross(d.sv).dot(d.s) >= -1e-13);
        }
        let torus = torus();
        for [u, v] in grid(&torus) {
            let d = torus.first_derivatives(u, v);
            let axis = d.s.truncate().normalize().extend(0.0) * 0.75;
            assert!((d.s.distance(axis) - 0.25).abs() <= 1e-14);
            assert!(d.su.cross(d.sv).dot(d.s - axis) > 0.0);
        }
    }

    #[test]
    fn the_wave_has_equal_first_derivatives_on_both_sides_of_its_multiple_knots() {
        for name in ["surface", "rational"] {
            let model = builtin(name).unwrap();
            let surface = &model.surfaces()[0];
            let knots = surface.knots(Direction::U);
            assert_eq!((knots.multiplicity(2.0), knots.multiplicity(4.0)), (2, 3));
            assert_eq!(surface.knots(Direction::V).multiplicity(0.35), 2);
            for (u, [below, above]) in [(2.0, [4, 6]), (4.0, [7, 10])] {
                for v in [0.0, 0.2, 0.6, 1.0] {
                    let span_v = surface.knots(Direction::V).find_span(v);
                    let [a, b] = [below, above].map(|span| surface.first_derivatives_on(span, span_v, u, v));
                    assert!(a.s.distance(b.s) < 1e-14 && a.su.distance(b.su) < 1e-13, "{name} at {u}, {v}");
                }
            }
        }
        let rational = builtin("rational").unwrap();
        let weights = rational.surfaces()[0].weights().unwrap().to_vec();
        let (least, greatest) = weights.iter().fold((9.0f64, 0.0f64), |(a, b), &w| (a.min(w), b.max(w)));
        assert!((0.5..0.52).contains(&least) && (1.98..=2.0).contains(&greatest), "{least} {greatest}");
    }

    #[test]
    fn the_periodic_vase_closes_with_equal_derivatives() {
        let vase = vase();
        let [[start, end], _] = vase.domain();
        for v in [0.0, 0.3, 1.0] {
            let [a, b] = [start, end].map(|u| vase.second_derivatives(u, v));
            assert!(a.s.distance(b.s) < 1e-14 && a.su.distance(b.su) < 1e-14 && a.suu.distance(b.suu) < 1e-13);
        }
        assert!(!vase.knots(Direction::U).is_clamped());
    }

    #[test]
    fn the_unclamped_dome_is_not_clamped() {
        let dome = dome();
        for direction in [Direction::U, Direction::V] {
            let knots = dome.knots(direction);
            assert!(!knots.is_clamped() && knots.knots().windows(2).all(|k| k[0] < k[1]));
        }
    }

    #[test]
    fn made_models_are_about_a_unit_in_size_and_regular_inside() {
        for (name, _) in &BUILTINS[3..] {
            let model = builtin(name).unwrap();
            let diagonal = model.hull().diagonal();
            assert!((1.0..4.0).contains(&diagonal), "{name}: {diagonal}");
            for surface in model.surfaces() {
                let [[u0, u1], [v0, v1]] = surface.domain();
                let d = surface.first_derivatives(u0 + 0.4 * (u1 - u0), v0 + 0.6 * (v1 - v0));
                assert!(d.su.cross(d.sv).length() > 1e-4, "{name}");
            }
        }
    }

    #[test]
    fn made_models_are_the_same_numbers_on_every_machine() {
        // Written down from x86-64 Linux: what must not differ is any other machine, or a later libm.
        assert_eq!(builtin("spray").unwrap().hash(), "28f9e14feb9cc9c8");
        assert_eq!(builtin("surface").unwrap().hash(), "8f8332ab8bf0c784");
    }
}

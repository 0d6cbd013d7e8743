//! Real and random models survive reading and writing bit for bit.

use crate::common::{json_files, model_bits, models, root};
use formats::{json, read};
use glam::{DVec2, DVec3};
use models::{BUILTINS, builtin};
use nurbs::{KnotVector, Surface};
use proptest::collection::vec;
use proptest::prelude::*;
use scene::{Face, Loop, Model, Trim};

fn assert_round_trip(model: &Model) {
    let text = json::write(model).unwrap();
    let again = json::parse(&text, "again.json").unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(model.name(), again.name());
    assert!(model_bits(model) == model_bits(&again), "{}", model.name());
    assert_eq!(text, json::write(&again).unwrap());
}

#[test]
fn builtin_models_survive_writing() {
    for (name, _) in BUILTINS {
        assert_round_trip(&builtin(name).unwrap());
    }
}

#[test]
fn the_cases_of_the_repository_survive_writing() {
    for path in json_files(&root().join("testdata/cases")) {
        assert_round_trip(&read(&path).unwrap_or_else(|e| panic!("{e}")));
    }
}

#[test]
fn embedded_models_are_written_as_the_project_writes_them() {
    for path in json_files(&root().join("testdata/models")) {
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text, json::write(&json::parse(&text, "a").unwrap()).unwrap(), "{}", path.display());
    }
}

#[test]
fn real_models_and_hard_cases_open_and_survive_writing() {
    let Some(models) = models() else { return };
    let mut trims = 0;
    for folder in [models.join("../cases"), models.join("../oracle/neutral"), models.join("newell")] {
        for path in json_files(&folder) {
            let model = read(&path).unwrap_or_else(|e| panic!("{e}"));
            assert_round_trip(&model);
            trims += model.faces().iter().flat_map(|f| &f.loops).map(|l| l.trims.len()).sum::<usize>();
        }
    }
    assert!(trims > 10_000, "{trims} trim curves: they should have been kept");
}

#[test]
fn newells_patches_are_the_same_in_every_form() {
    let Some(models) = models() else { return };
    for name in ["teapot", "teacup", "teaspoon"] {
        let patches = read(models.join("newell").join(format!("{name}.bpt"))).unwrap();
        let neutral = read(models.join("newell").join(format!("{name}.json"))).unwrap();
        assert_eq!(patches.name(), neutral.name());
        assert!(model_bits(&patches) == model_bits(&neutral), "{name}.bpt");
        assert!(model_bits(&builtin(name).unwrap()) == model_bits(&neutral), "built-in {name}");
    }
}

/// Any f64 that is a legal coordinate, the subnormal and −0 among them.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits).prop_filter("a usable size", |x| x.abs() <= 1e60),
        -10.0..10.0,
        Just(-0.0)
    ]
}

/// Legal knots: steps that are sums of positive lengths, interior knots of any allowed multiplicity, ends clamped or not.
fn knot_vector() -> impl Strategy<Value = KnotVector> {
    (1usize..=5, vec((1e-3..10.0, 1usize..=5), 1..4), any::<bool>(), -5.0..5.0).prop_map(
        |(p, steps, is_clamped, start)| {
            let mut knots = vec![start; if is_clamped { p + 1 } else { 1 }];
            let mut push = |step: f64, multiplicity: usize| {
                let next = knots.last().unwrap() + step;
                knots.extend(vec![next; multiplicity]);
            };
            if !is_clamped {
                (0..p).for_each(|i| push(0.1 + i as f64, 1));
            }
            steps.iter().for_each(|(step, multiplicity)| push(*step, *multiplicity.min(&p)));
            push(0.7, if is_clamped { p + 1 } else { 1 });
            if !is_clamped {
                (0..p).for_each(|i| push(0.3 + i as f64, 1));
            }
            KnotVector::new(p, knots).unwrap()
        },
    )
}

fn weights(count: usize) -> impl Strategy<Value = Option<Vec<f64>>> {
    prop::option::of(vec(1e-5f64..1e5, count))
}

fn surface() -> impl Strategy<Value = Surface> {
    (knot_vector(), knot_vector()).prop_flat_map(|(u, v)| {
        let count = u.control_count() * v.control_count();
        (vec([coordinate(), coordinate(), coordinate()], count), weights(count)).prop_map(move |(points, weights)| {
            let points = points.into_iter().map(DVec3::from_array).collect();
            Surface::new(u.clone(), v.clone(), points, weights).unwrap()
        })
    })
}

/// A closed loop about the middle of a domain, `reach` (0 to 1) of the way to its borders. Its corners stand on a
/// convex curve and its trims are straight, so that no two cross, whatever their degrees, knots and weights.
fn boundary(domain: [[f64; 2]; 2], reach: f64, outer: bool) -> impl Strategy<Value = Loop> {
    let corner = move |i: usize| {
        let [x, y] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][if outer { i % 4 } else { (4 - i) % 4 }];
        let at = |[low, high]: [f64; 2], x: f64| 0.5 * (low + high) + 0.5 * (high - low) * x * reach;
        DVec2::new(at(domain[0], x), at(domain[1], y))
    };
    let trim = move |i: usize| {
        knot_vector().prop_filter("ends at its points", KnotVector::is_clamped).prop_flat_map(move |knots| {
            let count = knots.control_count();
            (vec(0.0f64..=1.0, count), weights(count), any::<[bool; 3]>(), any::<Option<i64>>()).prop_map(
                move |(mut shares, weights, [reversed, seam, degenerate], edge)| {
                    shares.sort_by(f64::total_cmp);
                    (shares[0], shares[count - 1]) = (0.0, 1.0);
                    let (from, to) = if reversed { (corner(i + 1), corner(i)) } else { (corner(i), corner(i + 1)) };
                    let points = shares.iter().map(|t| from * (1.0 - t) + to * *t).collect();
                    Trim { reversed, seam, degenerate, edge, ..Trim::new(knots.clone(), points, weights) }
                },
            )
        })
    };
    [trim(0), trim(1), trim(2), trim(3)].prop_map(move |trims| Loop { outer, trims: trims.to_vec() })
}

fn model() -> impl Strategy<Value = Model> {
    let face = |count: usize, domains: Vec<[[f64; 2]; 2]>| {
        (0..count, 0usize..3).prop_flat_map(move |(surface, loops)| {
            let domain = domains[surface];
            let loops: Vec<_> = (0..loops).map(|i| boundary(domain, 0.9 / (i + 1) as f64, i == 0)).collect();
            (Just(surface), any::<bool>(), 0.0..1.0, loops).prop_map(|(surface, reversed, tolerance, loops)| Face {
                surface,
                reversed,
                tolerance,
                loops,
            })
        })
    };
    (".*", vec(surface(), 1..4)).prop_flat_map(move |(name, surfaces)| {
        let domains = surfaces.iter().map(Surface::domain).collect();
        let faces = vec(face(surfaces.len(), domains), 1..4);
        faces.prop_map(move |faces| Model::new(name.clone(), surfaces.clone(), faces).unwrap())
    })
}

proptest! {
    #[test]
    fn random_models_survive_writing(model in model()) {
        assert_round_trip(&model);
    }
}

//! A scene's scale, and a common factor of its weights, change nothing; and many faces on one surface are no burden.

mod common;

use common::{Random, one, sphere};
use gbuffer::Hit;
use glam::{DVec2, DVec3};
use nurbs::{Direction, KnotVector, Surface};
use raycast::{Caster, Classifier};
use scene::{Camera, Face, FaceId, Loop, Model, Region, Trim, Viewport};
use std::time::Instant;

/// The surface with its points times `by_points` and its weights times `by_weights`.
fn scaled(surface: &Surface, by_points: f64, by_weights: f64) -> Surface {
    let [u, v] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
    let ones = vec![1.0; surface.points().len()];
    let weights = surface.weights().unwrap_or(&ones).iter().map(|w| w * by_weights).collect();
    let points = surface.points().iter().map(|&p| p * by_points).collect();
    Surface::new(u, v, points, Some(weights)).unwrap()
}

/// A surface of degree 3 × 2 about the origin, bent and, every second time, rational.
fn random_net(random: &mut Random) -> Surface {
    let knots = |p: usize| KnotVector::new(p, [vec![0.0; p + 1], vec![0.375], vec![1.0; p + 1]].concat()).unwrap();
    let (u, v) = (knots(3), knots(2));
    let at = |i: usize, n: usize| i as f64 / (n - 1) as f64 - 0.5;
    let points = (0..20).map(|k| DVec3::new(at(k / 4, 5), at(k % 4, 4), 0.0) + 0.2 * random.direction()).collect();
    let rational = random.below(2) == 0;
    let weights = rational.then(|| (0..20).map(|_| random.between(0.5, 2.0)).collect());
    Surface::new(u, v, points, weights).unwrap()
}

fn picture(surface: Surface) -> Vec<Option<Hit>> {
    let (model, viewport) = (one(surface), Viewport::new(24, 18).unwrap());
    let buffer = Caster::new(&model).render(&Camera::framing(&model, viewport), viewport, &|_| ());
    (0..18).flat_map(|y| (0..24).map(move |x| (x, y))).map(|(x, y)| buffer.get(x, y).copied()).collect()
}

#[test]
fn scaling_by_powers_of_two_changes_no_bit() {
    let mut random = Random(77);
    let mut hits = 0;
    for surface in (0..6).map(|_| random_net(&mut random)).chain([sphere(2.0, DVec3::new(0.5, 0.25, -1.0))]) {
        let plain = picture(scaled(&surface, 1.0, 1.0));
        for (points, weights) in [(130, 0), (-130, 0), (190, 60), (-190, -60), (0, 1000), (0, -900), (3, 120)] {
            let [by_points, by_weights] = [points, weights].map(|exponent| 2f64.powi(exponent));
            for (a, b) in plain.iter().zip(picture(scaled(&surface, by_points, by_weights))) {
                assert_eq!(a.is_some(), b.is_some(), "2^{points}, 2^{weights}");
                let (Some(a), Some(b)) = (a, b) else { continue };
                hits += 1;
                assert_eq!((a.uv, a.t * by_points, a.position * by_points), (b.uv, b.t, b.position));
                assert_eq!(a.normal, b.normal);
                let curvature = |hit: &Hit, by: f64| hit.curvature.map(|k| (k.k1 * by, k.k2 * by));
                assert_eq!(curvature(a, 1.0), curvature(&b, by_points));
            }
        }
    }
    assert!(1000 < hits, "{hits}");
}

#[test]
fn scaling_by_other_factors_changes_what_rounding_does() {
    let mut random = Random(78);
    for surface in (0..4).map(|_| random_net(&mut random)).chain([sphere(2.0, DVec3::new(0.5, 0.25, -1.0))]) {
        let plain = picture(scaled(&surface, 1.0, 1.0));
        for (by_points, by_weights) in [(1e39, 1.0), (1e-39, 1.0), (1.0, 1e-290), (1.0, 1e296), (1e58, 3e-7)] {
            let mut differ = 0;
            for (a, b) in plain.iter().zip(picture(scaled(&surface, by_points, by_weights))) {
                match (a, b) {
                    (Some(a), Some(b)) => differ += usize::from(1e-9 < (a.t - b.t / by_points).abs() / a.t),
                    (a, b) => differ += usize::from(a.is_some() != b.is_some()),
                }
            }
            // A pixel's centre may lie on a silhouette.
            assert!(differ <= 1, "{by_points:e}, {by_weights:e}: {differ} pixels");
        }
    }
}

fn rectangle([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> Loop {
    let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]].map(DVec2::from_array).to_vec();
    let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0]).unwrap();
    Loop { outer: true, trims: vec![Trim::new(knots, corners, None)] }
}

/// A plane of `side` × `side` spans over the unit square.
fn plane(side: usize) -> Surface {
    let at = |i: usize| i as f64 / side as f64;
    let knots = KnotVector::new(1, [vec![0.0], (0..=side).map(at).collect(), vec![1.0]].concat()).unwrap();
    let points =
        (0..(side + 1) * (side + 1)).map(|k| DVec3::new(at(k / (side + 1)), at(k % (side + 1)), 0.0)).collect();
    Surface::new(knots.clone(), knots, points, None).unwrap()
}

#[test]
fn two_thousand_faces_share_a_surface_of_many_spans() {
    const SIDE: usize = 45;
    let started = Instant::now();
    let at = |i: usize| (i as f64 + 0.1) / SIDE as f64;
    let far = |i: usize| (i as f64 + 0.9) / SIDE as f64;
    let face = |k: usize| {
        let (i, j) = (k / SIDE, k % SIDE);
        Face { loops: vec![rectangle([at(i), at(j)], [far(i), far(j)])], ..Face::whole(0) }
    };
    let model = Model::new("tiles", vec![plane(59)], (0..SIDE * SIDE).map(face).collect()).unwrap();
    let built = started.elapsed();
    let caster = Caster::new(&model);
    let ready = started.elapsed();
    for (i, j) in [(0, 0), (3, 44), (22, 22), (44, 1)] {
        let over = |x: f64, y: f64| caster.first(&common::ray(DVec3::new(x, y, 1.0), DVec3::NEG_Z)).hit;
        let middle = |i: usize| (i as f64 + 0.5) / SIDE as f64;
        assert_eq!(over(middle(i), middle(j)).map(|hit| hit.face), Some(FaceId((i * SIDE + j) as u32)));
        assert_eq!(over(i as f64 / SIDE as f64 + 1e-3, middle(j)), None);
    }
    let viewport = Viewport::new(64, 64).unwrap();
    let camera = Camera::framing(&model, viewport);
    let framed = started.elapsed();
    caster.render(&camera, viewport, &|_| ());
    let cast = started.elapsed();
    let times = [built, ready - built, framed - ready, cast - framed];
    println!("model, caster, framing, 4096 pixels: {times:?}");
}

#[test]
fn a_metric_that_is_not_finite_is_near_to_nothing_at_once() {
    let face = Face { loops: vec![rectangle([0.25, 0.25], [0.75, 0.75])], ..Face::whole(0) };
    let region = Region::new(0, &face, &plane(1), 0.0).unwrap().unwrap();
    let classifier = Classifier::new(&region);
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(!classifier.is_at_edge(DVec2::splat(0.5), DVec2::new(1.0, bad), 1e-9));
        assert!(!classifier.inside(DVec2::new(0.5, bad)));
        classifier.side(DVec2::splat(0.5), DVec2::splat(bad));
    }
}

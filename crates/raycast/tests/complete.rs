//! No root is missed: rays through known points, and a brute-force search beside the caster's.

mod common;

use common::{Random, allowed, bezier_knots, check, one, random_surface};
use glam::{DVec2, DVec3};
use nurbs::{Direction, Surface};
use proptest::prelude::*;
use raycast::Caster;
use scene::{FaceId, Ray};

/// A parameter inside, at an end, at a knot or just beside one.
fn parameter(random: &mut Random, surface: &Surface, direction: Direction) -> f64 {
    let knots = surface.knots(direction);
    let (start, end) = knots.domain();
    let inner: Vec<f64> = knots.knots().iter().copied().filter(|k| (start..=end).contains(k)).collect();
    match random.below(6) {
        0 => start,
        1 => end,
        2 => inner[random.below(inner.len())],
        3 => inner[random.below(inner.len())].next_down().max(start),
        _ => random.between(start, end),
    }
}

fn ray_through_a_point_hits_it(seed: u64) -> Result<(), TestCaseError> {
    let mut random = Random(seed);
    let model = one(random_surface(&mut random));
    let surface = &model.surfaces()[0];
    let caster = Caster::new(&model);
    let size = surface.hull().diagonal();
    for _ in 0..40 {
        // Far from the origin the ray itself is rounded to coordinates and passes beside a border or a tangent.
        let far = surface.origin().length() > 10.0 * size;
        let mut pick = |direction| {
            let (start, end) = surface.knots(direction).domain();
            let inside = random.between(start + 0.1 * (end - start), end - 0.1 * (end - start));
            if far { inside } else { parameter(&mut random, surface, direction) }
        };
        let uv = DVec2::new(pick(Direction::U), pick(Direction::V));
        let d = surface.first_derivatives(uv.x, uv.y);
        // One ray in four along the tangent plane.
        let (a, b) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        let tangent = d.su.normalize_or_zero() * a + d.sv.normalize_or_zero() * b;
        let direction = match random.below(4) {
            0 if !far => tangent.try_normalize().unwrap_or(DVec3::X),
            _ => random.direction(),
        };
        let sine = d.su.normalize_or_zero().cross(d.sv.normalize_or_zero()).normalize_or_zero().dot(direction).abs();
        let distance = size * [1.0, 3.0, 100.0][random.below(3)];
        let ray = Ray { origin: d.s - direction * distance, direction, near: 0.0 };
        let off = allowed(&caster, &ray, FaceId(0), uv);
        if far && off > 1e-6 * sine * size {
            continue;
        }
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
        // How far along the surface a root may move when the ray moves by `off`: by the angle, at a tangent by a root.
        let slip = off + (off / sine).min(100.0 * (off * size).sqrt());
        // At a tangent of a flat place or of a cusp the run is longer still; there any run through the point will do.
        let near = |position: DVec3| position.distance(d.s) <= 64.0 * slip;
        let connected = |hit: DVec2| {
            (1..32).all(|k| {
                let at = hit + (uv - hit) * (f64::from(k) / 32.0);
                let p = surface.point(at.x, at.y) - ray.origin;
                p.cross(direction).length() <= 4.0 * off
            })
        };
        let reported = all.hits.iter().any(|hit| near(hit.position) || connected(hit.uv))
            || all.undecided.iter().any(|u| (u.t - distance).abs() <= 0.1 * size);
        prop_assert!(
            reported,
            "seed {seed}: S{uv:?} = {:?} along {direction:?} at {distance} is not among {all:#?}; slip {slip:e}, sine {sine:e}",
            d.s
        );
        let first = caster.first(&ray);
        let nearest = first.hit.map_or(f64::INFINITY, |hit| hit.t).min(first.undecided.map_or(f64::INFINITY, |u| u.t));
        prop_assert!(
            nearest <= distance + 64.0 * slip + 0.1 * size * f64::from(u8::from(first.undecided.is_some()))
                || all.hits.iter().any(|hit| connected(hit.uv))
        );
    }
    Ok(())
}

/// Every root that Newton's method reaches from a grid of seeds.
fn brute_force(surface: &Surface, ray: &Ray, tolerance: f64) -> Vec<DVec2> {
    const SEEDS: usize = 20;
    let [[u0, u1], [v0, v1]] = surface.domain();
    let n1 = ray.direction.any_orthonormal_vector();
    let n2 = ray.direction.cross(n1);
    let mut roots: Vec<DVec2> = vec![];
    for i in 0..=SEEDS {
        for j in 0..=SEEDS {
            let mut uv = DVec2::new(u0 + (u1 - u0) * i as f64 / SEEDS as f64, v0 + (v1 - v0) * j as f64 / SEEDS as f64);
            for _ in 0..30 {
                let d = surface.first_derivatives(uv.x, uv.y);
                let e = d.s - ray.origin;
                let f = DVec2::new(n1.dot(e), n2.dot(e));
                if f.length() <= tolerance {
                    if !roots.iter().any(|r| r.distance(uv) < 1e-7) {
                        roots.push(uv);
                    }
                    break;
                }
                let (a, b) = (DVec2::new(n1.dot(d.su), n2.dot(d.su)), DVec2::new(n1.dot(d.sv), n2.dot(d.sv)));
                let det = a.perp_dot(b);
                let step = DVec2::new(f.perp_dot(b), a.perp_dot(f)) / det;
                let next = (uv - step).clamp(DVec2::new(u0, v0), DVec2::new(u1, v1));
                if !next.is_finite() || next == uv {
                    break;
                }
                uv = next;
            }
        }
    }
    roots
}

#[test]
fn brute_force_finds_nothing_more() {
    let mut random = Random(31);
    let mut total = 0;
    let mut several = 0;
    for case in 0..120 {
        let (p, q) = (1 + random.below(4), 1 + random.below(4));
        let wild = random.below(2) == 0;
        let points: Vec<DVec3> = (0..(p + 1) * (q + 1))
            .map(|k| {
                let base = DVec3::new((k / (q + 1)) as f64 / p as f64, (k % (q + 1)) as f64 / q as f64, 0.0);
                if wild { random.direction() } else { base + 0.5 * random.direction() }
            })
            .collect();
        let weights =
            (random.below(2) == 0).then(|| points.iter().map(|_| 10f64.powf(random.between(-1.0, 1.0))).collect());
        let model = one(Surface::new(bezier_knots(p), bezier_knots(q), points, weights).unwrap());
        let surface = &model.surfaces()[0];
        let caster = Caster::new(&model);
        for _ in 0..40 {
            let d = random.direction();
            let target = surface.point(random.unit(), random.unit()) + random.direction() * random.unit() * 0.05;
            let ray = Ray { origin: target - d * 4.0, direction: d, near: 0.0 };
            let all = caster.all(&ray);
            check(&caster, &ray, &all);
            assert!(all.undecided.is_empty(), "case {case}: {all:?}");
            let roots = brute_force(surface, &ray, 1e-13);
            for uv in &roots {
                assert!(
                    all.hits.iter().any(|hit| hit.uv.distance(*uv) < 1e-5),
                    "case {case}: {uv:?} is not among {:?} for {ray:?}",
                    all.hits
                );
            }
            total += all.hits.len();
            several += usize::from(all.hits.len() > 2);
        }
    }
    assert!(total > 4000 && several > 200, "{total} {several}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn every_point_of_a_surface_is_hit_by_a_ray_through_it(seed: u64) {
        ray_through_a_point_hits_it(seed)?;
    }
}

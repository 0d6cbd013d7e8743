//! Cases that break ray casters: rays inside surfaces, collapsed and folded nets, borders, extreme scales.

mod common;

use common::{Random, bezier_knots, bilinear, check, cylinder, one, random_surface, ray, sphere, torus};
use glam::DVec3;
use nurbs::{KnotVector, Surface};
use raycast::Caster;
use scene::{Camera, Face, FaceId, Model, Projection, Ray, Viewport};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Boxes that a single piece may take in these cases, on average over the pieces: far below the cap of 4096.
const BOXES_A_PIECE: u64 = 400;

#[test]
fn ray_inside_a_flat_patch_enters_at_its_edge() {
    let model = one(bilinear([[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0))));
    let caster = Caster::new(&model);
    for (origin, direction, t) in [
        (DVec3::new(-3.0, 0.2, 0.0), DVec3::X, 2.0),
        (DVec3::new(0.3, 3.0, 0.0), -DVec3::Y, 2.0),
        (DVec3::new(-3.0, -3.0, 0.0), DVec3::new(1.0, 1.0, 0.0), 2.0 * 2f64.sqrt()),
        (DVec3::new(-3.0, -1.0, 0.0), DVec3::X, 2.0),
    ] {
        let ray = ray(origin, direction);
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
        assert!(all.hits.len() == 1 && all.undecided.is_empty(), "{all:?}");
        assert!((all.hits[0].t - t).abs() < 1e-12, "{} {t}", all.hits[0].t);
        assert!(all.boxes < 100);
    }
    let beside = caster.all(&ray(DVec3::new(-3.0, 1.0 + 1e-9, 0.0), DVec3::X));
    assert!(beside.hits.is_empty() && beside.undecided.is_empty());
    let above = caster.all(&ray(DVec3::new(-3.0, 0.0, 1e-9), DVec3::X));
    assert!(above.hits.is_empty() && above.undecided.is_empty());
}

#[test]
fn ray_inside_a_flat_bicubic_patch_is_a_hit() {
    let mut random = Random(21);
    let points: Vec<DVec3> = (0..16)
        .map(|k| {
            DVec3::new(f64::from(k / 4) + random.between(-0.3, 0.3), f64::from(k % 4) + random.between(-0.3, 0.3), 0.0)
        })
        .collect();
    let model = one(Surface::new(bezier_knots(3), bezier_knots(3), points, None).unwrap());
    let caster = Caster::new(&model);
    for _ in 0..200 {
        let angle = random.between(0.0, 6.3);
        let d = DVec3::new(angle.cos(), angle.sin(), 0.0);
        let ray = ray(DVec3::new(1.5, 1.5, 0.0) - d * 6.0, d);
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
        assert!(!all.hits.is_empty() && all.undecided.is_empty(), "{all:?}");
        assert!(all.boxes < BOXES_A_PIECE * caster.piece_count() as u64);
    }
}

#[test]
fn ruling_of_a_cylinder_is_a_hit_at_its_end() {
    let model = one(cylinder(0.5, 1.0, DVec3::ZERO));
    let caster = Caster::new(&model);
    for (x, y) in [(0.5, 0.0), (0.3, 0.4), (0.0, -0.5)] {
        let ray = ray(DVec3::new(x, y, -3.0), DVec3::Z);
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
        assert!(all.hits.len() == 1 && all.undecided.is_empty(), "{all:?}");
        assert!((all.hits[0].t - 2.0).abs() < 1e-12);
        assert!(all.boxes < BOXES_A_PIECE * caster.piece_count() as u64);
    }
}

#[test]
fn rulings_of_a_saddle_are_hits_and_end() {
    // z = x y over the square; both families of rulings, along parameter lines.
    let corner = |x: f64, y: f64| DVec3::new(x, y, x * y);
    let model = one(bilinear([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, -1.0), corner(1.0, 1.0)]));
    let caster = Caster::new(&model);
    for k in 0..20 {
        let x = -1.0 + f64::from(k) / 10.0;
        let direction = DVec3::new(0.0, 1.0, x);
        let ray = ray(DVec3::new(x, 0.0, 0.0) - direction.normalize() * 4.0, direction);
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
        assert!(!all.hits.is_empty() && all.undecided.is_empty(), "{all:?}");
        assert!(all.boxes < BOXES_A_PIECE * caster.piece_count() as u64, "{}", all.boxes);
    }
}

#[test]
fn ray_inside_a_curved_surface_across_its_parameters_ends_and_hits() {
    // The same saddle turned by 45° in its parameters: z = s² − t², biquadratic, rulings along s = ± t + c.
    let knots = bezier_knots(2);
    let blossom = |a: f64, b: f64| (a * b, 0.5 * (a + b));
    let ends = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    let mut points = vec![];
    for (a, b) in ends {
        for (c, d) in ends {
            let ((ss, s), (tt, t)) = (blossom(a, b), blossom(c, d));
            points.push(DVec3::new(s, t, ss - tt));
        }
    }
    let model = one(Surface::new(knots.clone(), knots, points, None).unwrap());
    let caster = Caster::new(&model);
    for k in 0..10 {
        let c = -0.9 + 0.17 * f64::from(k);
        // s = t + c: z = c (2 t + c).
        let direction = DVec3::new(1.0, 1.0, 2.0 * c);
        let ray = ray(DVec3::new(c, 0.0, c * c) - direction.normalize() * 5.0, direction);
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
        assert!(!all.hits.is_empty(), "{all:?}");
        assert!(all.boxes <= 4200 * caster.piece_count() as u64, "{}", all.boxes);
    }
}

#[test]
fn collapsed_surfaces_end() {
    let knots = bezier_knots(3);
    let make = |f: &dyn Fn(f64, f64) -> DVec3| {
        let points = (0..16).map(|k| f(f64::from(k / 4) / 3.0, f64::from(k % 4) / 3.0)).collect();
        one(Surface::new(knots.clone(), knots.clone(), points, None).unwrap())
    };
    let point = make(&|_, _| DVec3::new(1.0, 2.0, 3.0));
    let line = make(&|u, _| DVec3::new(u, 2.0, 3.0));
    let folded_line = make(&|u, v| DVec3::new(u + v, 0.5, 0.25));
    let curve = make(&|u, _| DVec3::new(u, u * u, u * u * u));
    let mut random = Random(22);
    for (model, through) in [
        (&point, DVec3::new(1.0, 2.0, 3.0)),
        (&line, DVec3::new(0.5, 2.0, 3.0)),
        (&folded_line, DVec3::new(0.5, 0.5, 0.25)),
        (&curve, DVec3::ZERO),
    ] {
        let caster = Caster::new(model);
        for _ in 0..100 {
            let d = random.direction();
            let ray = ray(through - d * 3.0, d);
            let all = caster.all(&ray);
            check(&caster, &ray, &all);
            assert!(!all.hits.is_empty() || !all.undecided.is_empty(), "{ray:?} {all:?}");
            assert!(all.boxes < BOXES_A_PIECE * caster.piece_count() as u64, "{}", all.boxes);
            let aside = d.cross(random.direction()).normalize() * 1e-6;
            let missed = Ray { origin: ray.origin + aside, ..ray };
            let all = caster.all(&missed);
            assert!(all.hits.iter().all(|hit| hit.t > 0.0));
            assert!(all.boxes < BOXES_A_PIECE * caster.piece_count() as u64, "{}", all.boxes);
        }
    }
}

#[test]
fn no_ray_through_a_shared_border_leaks() {
    // Two bicubic patches with a common row of control points, as two faces, and as one surface with a knot there.
    let mut random = Random(23);
    for _ in 0..200 {
        let mut row = |x: f64| -> Vec<DVec3> {
            (0..4).map(|j| DVec3::new(x + random.between(-0.1, 0.1), f64::from(j), random.between(-0.3, 0.3))).collect()
        };
        let rows: Vec<Vec<DVec3>> = (0..7).map(|i| row(f64::from(i))).collect();
        let left = rows[..4].concat();
        let right = rows[3..].concat();
        let knots = bezier_knots(3);
        let patch = |points: Vec<DVec3>| Surface::new(knots.clone(), knots.clone(), points, None).unwrap();
        let two = Model::of_surfaces("two", vec![patch(left.clone()), patch(right)]).unwrap();
        let whole = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.3, 0.3, 0.3, 1.0, 1.0, 1.0, 1.0]).unwrap();
        let joined = one(Surface::new(whole, knots.clone(), rows.concat(), None).unwrap());
        let (two, joined) = (Caster::new(&two), Caster::new(&joined));
        for _ in 0..50 {
            let target = patch(left.clone()).point(1.0, random.unit());
            let d = (random.direction() * 0.8 - DVec3::Z).normalize();
            let ray = ray(target - d * random.between(1.0, 30.0), d);
            for caster in [&two, &joined] {
                let all = caster.all(&ray);
                check(caster, &ray, &all);
                assert!(
                    all.hits.iter().any(|hit| hit.position.distance(target) < 1e-9),
                    "leak at {target:?} along {d:?}: {all:?}"
                );
            }
            assert!(joined.all(&ray).hits.iter().filter(|hit| hit.position.distance(target) < 1e-9).count() == 1);
        }
    }
}

#[test]
fn near_cuts_hits_off_and_nothing_else() {
    let model = one(sphere(1.0, DVec3::ZERO));
    let caster = Caster::new(&model);
    let ray = ray(DVec3::new(-3.0, 0.1, 0.2), DVec3::X);
    let both = caster.all(&ray).hits;
    assert_eq!(both.len(), 2);
    let from = |near: f64| caster.all(&Ray { near, ..ray }).hits;
    assert_eq!(from(both[0].t), both);
    assert_eq!(from(both[0].t.next_up()), both[1..]);
    assert_eq!(from(3.0), both[1..]);
    assert_eq!(from(both[1].t), both[1..]);
    assert!(from(both[1].t.next_up()).is_empty());
    assert!(from(f64::INFINITY).is_empty());
    assert_eq!(from(f64::NEG_INFINITY), both);
    assert_eq!(caster.first(&Ray { near: 3.0, ..ray }).hit, Some(both[1]));
    let nan = Ray { origin: DVec3::NAN, ..ray };
    assert_eq!(caster.first(&nan).hit, None);
}

#[test]
fn scenes_far_from_the_origin_are_hit() {
    let mut random = Random(24);
    for offset in [1e6, 1e9] {
        let center = DVec3::new(offset, -0.7 * offset, 0.3 * offset);
        let model = Model::of_surfaces("far", vec![sphere(1.0, center), torus(2.0, 0.3, center)]).unwrap();
        let caster = Caster::new(&model);
        // The control points are only as round as their coordinates' ulp allows.
        let rough = 8.0 * offset * f64::EPSILON;
        for _ in 0..2000 {
            let d = random.direction();
            let ray = ray(center + random.direction() * 0.9 - d * 4.0, d);
            let hits = caster.all(&ray);
            check(&caster, &ray, &hits);
            let o = ray.origin - center;
            let b = o.dot(d);
            let disc = b * b - (o.dot(o) - 1.0);
            if disc > 100.0 * rough {
                let of_sphere: Vec<f64> = hits.hits.iter().filter(|h| h.face == FaceId(0)).map(|h| h.t).collect();
                assert_eq!(of_sphere.len(), 2, "{ray:?}");
                assert!((of_sphere[0] - (-b - disc.sqrt())).abs() < 10.0 * rough / disc.sqrt());
            }
        }
    }
}

#[test]
fn extreme_sizes_are_cast() {
    for size in [1e-100, 1e-20, 1e20, 1e55] {
        let model = one(sphere(size, DVec3::ZERO));
        let caster = Caster::new(&model);
        let ray = ray(DVec3::new(-3.0, 0.1, 0.2) * size, DVec3::X);
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
        assert_eq!(all.hits.len(), 2);
        let half = (1.0f64 - 0.05).sqrt();
        assert!((all.hits[0].t / size - (3.0 - half)).abs() < 1e-14);
    }
}

#[test]
fn random_nets_of_high_degree_end() {
    let mut random = Random(25);
    for degree in [7, 15] {
        for _ in 0..5 {
            let n = degree + 1;
            let points: Vec<DVec3> = (0..n * n).map(|_| random.direction()).collect();
            let weights = (0..n * n).map(|_| random.between(0.2, 5.0)).collect();
            let surface = Surface::new(bezier_knots(degree), bezier_knots(degree), points, Some(weights)).unwrap();
            let model = one(surface);
            let caster = Caster::new(&model);
            for _ in 0..100 {
                let (u, v) = (random.unit(), random.unit());
                let target = model.surfaces()[0].point(u, v);
                let d = random.direction();
                let ray = ray(target - d * 3.0, d);
                let all = caster.all(&ray);
                check(&caster, &ray, &all);
                assert!(all.hits.iter().any(|hit| (hit.t - 3.0).abs() < 1e-6), "{all:?}");
                assert!(all.boxes < BOXES_A_PIECE * caster.piece_count() as u64, "{}", all.boxes);
            }
        }
    }
}

#[test]
fn faces_share_surfaces_and_turn_normals() {
    let surface = sphere(1.0, DVec3::ZERO);
    let faces = vec![Face::whole(0), Face { reversed: true, ..Face::whole(0) }];
    let model = Model::new("both sides", vec![surface], faces).unwrap();
    let caster = Caster::new(&model);
    let ray = ray(DVec3::new(-3.0, 0.1, 0.2), DVec3::X);
    let hits = caster.all(&ray).hits;
    assert_eq!(hits.iter().map(|h| h.face.0).collect::<Vec<_>>(), [0, 1, 0, 1]);
    assert_eq!(hits[0].normal.unit().unwrap(), -hits[1].normal.unit().unwrap());
    let (a, b) = (hits[0].curvature.unwrap(), hits[1].curvature.unwrap());
    assert_eq!((a.k1, a.k2), (-b.k2, -b.k1));
    assert_eq!(caster.first(&ray).hit, Some(hits[0]));
}

#[test]
fn a_picture_is_its_rays_and_says_how_far_it_is() {
    let model = Model::of_surfaces("picture", vec![sphere(1.0, DVec3::ZERO), torus(2.0, 0.3, DVec3::ZERO)]).unwrap();
    let caster = Caster::new(&model);
    let viewport = Viewport::new(90, 70).unwrap();
    let eye = DVec3::new(4.0, -5.0, 3.0);
    for projection in [Projection::Perspective { fov_deg: 40.0 }, Projection::Orthographic { height: 6.0 }] {
        let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::Z, projection).unwrap();
        let rows = AtomicUsize::new(0);
        let buffer = caster.render(&camera, viewport, &|n| {
            rows.fetch_add(n, Ordering::Relaxed);
        });
        assert_eq!(rows.into_inner(), 70);
        assert_eq!((buffer.meta().renderer.as_str(), buffer.meta().technique.as_str()), ("raycast", "rays"));
        assert_eq!(buffer.undecided(), 0);
        assert!(buffer.covered() > 500);
        for y in 0..70 {
            for x in 0..90 {
                let cast = caster.first(&camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5));
                assert_eq!(buffer.get(x, y), cast.hit.as_ref());
            }
        }
    }
}

#[test]
fn many_patches_stay_within_their_memory() {
    let mut random = Random(26);
    let surfaces: Vec<Surface> = (0..100)
        .map(|k| {
            let knots =
                KnotVector::new(3, [vec![0.0; 3], (0..=10).map(f64::from).collect(), vec![10.0; 3]].concat()).unwrap();
            let shift = DVec3::new(f64::from(k / 10), f64::from(k % 10), 0.0) * 13.0;
            let points = (0..169)
                .map(|i| shift + DVec3::new(f64::from(i / 13), f64::from(i % 13), random.between(-3.0, 3.0)))
                .collect();
            Surface::new(knots.clone(), knots, points, None).unwrap()
        })
        .collect();
    let model = Model::of_surfaces("many", surfaces).unwrap();
    let caster = Caster::new(&model);
    // 10,000 patches; 0.7 kB a piece.
    assert!((10_000..=170_000).contains(&caster.piece_count()), "{}", caster.piece_count());
    for _ in 0..1000 {
        let d = (DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), -0.3)).normalize();
        let target = DVec3::new(random.between(10.0, 100.0), random.between(10.0, 100.0), 0.0);
        let ray = ray(target - d * 300.0, d);
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
    }
}

#[test]
fn random_surfaces_give_the_same_hits_when_built_again() {
    let mut random = Random(27);
    for _ in 0..30 {
        let model = one(random_surface(&mut random));
        let (a, b) = (Caster::new(&model), Caster::new(&model));
        let hull = model.hull();
        for _ in 0..50 {
            let d = random.direction();
            let ray = ray(hull.center() + random.direction() * 0.2 * hull.diagonal() - d * hull.diagonal(), d);
            assert_eq!(a.all(&ray), b.all(&ray));
            assert_eq!(a.first(&ray), b.first(&ray));
        }
    }
}

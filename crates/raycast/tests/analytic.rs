//! Spheres, tori, cylinders and planes against formulas and solvers of their own.

mod common;

use common::{Random, bilinear, check, cylinder, one, ray, sphere, torus};
use glam::DVec3;
use raycast::Caster;
use scene::Ray;

/// Roots of c0 + c1 t + … in [low, high], by bisection between the roots of the derivative.
fn polynomial_roots(c: &[f64], low: f64, high: f64) -> Vec<f64> {
    let value = |t: f64| c.iter().rev().fold(0.0, |s, c| s * t + c);
    let mut ends = vec![low];
    if c.len() > 2 {
        let derivative: Vec<f64> = c.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect();
        ends.extend(polynomial_roots(&derivative, low, high));
    }
    ends.push(high);
    let mut roots = vec![];
    for w in ends.windows(2) {
        let (mut a, mut b) = (w[0], w[1]);
        if (value(a) > 0.0) == (value(b) > 0.0) {
            continue;
        }
        for _ in 0..200 {
            let m = 0.5 * (a + b);
            if (value(m) > 0.0) == (value(a) > 0.0) { a = m } else { b = m }
        }
        roots.push(0.5 * (a + b));
    }
    roots
}

/// The quartic of a ray and a torus about the z axis.
fn torus_roots(ray: &Ray, major: f64, minor: f64) -> Vec<f64> {
    // About the point nearest to the centre, so that the coefficients stay small.
    let foot = -ray.origin.dot(ray.direction);
    let (o, d) = (ray.at(foot), ray.direction);
    let (oo, od) = (o.dot(o), o.dot(d));
    let k = oo + major * major - minor * minor;
    let r2 = 4.0 * major * major;
    // (t² + 2 od t + k)² − 4 R² ((ox + t dx)² + (oy + t dy)²)
    let c = [
        k * k - r2 * (o.x * o.x + o.y * o.y),
        4.0 * od * k - r2 * 2.0 * (o.x * d.x + o.y * d.y),
        4.0 * od * od + 2.0 * k - r2 * (d.x * d.x + d.y * d.y),
        4.0 * od,
        1.0,
    ];
    let far = 2.0 * (major + minor);
    polynomial_roots(&c, -far, far).into_iter().map(|t| t + foot).collect()
}

#[test]
fn torus_has_the_roots_of_its_quartic() {
    let mut random = Random(11);
    let (major, minor) = (1.0, 0.35);
    let model = one(torus(major, minor, DVec3::ZERO));
    let caster = Caster::new(&model);
    let mut counts = [0; 5];
    for _ in 0..20_000 {
        let target = random.direction() * random.unit() * 1.2;
        let d = random.direction();
        let ray = ray(target - d * 4.0, d);
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
        let roots = torus_roots(&ray, major, minor);
        // Roots closer than this are those of a ray 1e-10 from a tangent, which the quartic does not tell apart.
        if roots.windows(2).any(|w| w[1] - w[0] < 1e-5) {
            continue;
        }
        assert!(all.undecided.is_empty());
        assert_eq!(all.hits.len(), roots.len(), "{ray:?}: {roots:?} {:?}", all.hits);
        counts[roots.len()] += 1;
        for (hit, root) in all.hits.iter().zip(&roots) {
            assert!((hit.t - root).abs() < 1e-9, "{} {root}", hit.t);
        }
    }
    assert!(counts[4] > 100 && counts[2] > 1000 && counts[0] > 1000, "{counts:?}");
}

#[test]
fn sphere_is_hit_where_the_quadratic_says() {
    let mut random = Random(12);
    for distance in [2.0, 4.0, 1e4] {
        let model = one(sphere(1.0, DVec3::ZERO));
        let caster = Caster::new(&model);
        for _ in 0..5000 {
            let d = random.direction();
            let across = d.cross(random.direction()).normalize();
            let offset = random.between(0.0, 0.999);
            let ray = ray(across * offset - d * distance, d);
            let all = caster.all(&ray);
            check(&caster, &ray, &all);
            let half = (1.0 - offset * offset).sqrt();
            assert_eq!(all.hits.len(), 2, "{ray:?} {:?}", all.hits);
            for (hit, t) in all.hits.iter().zip([distance - half, distance + half]) {
                assert!((hit.t - t).abs() < 1e-14 * distance / half + 1e-14, "{} {t}", hit.t);
                let n = hit.normal.unit().unwrap();
                assert!(n.dot(hit.position).abs() > 1.0 - 1e-9);
            }
        }
    }
}

#[test]
fn silhouette_has_two_roots_inside_and_none_outside() {
    let mut random = Random(13);
    let model = one(sphere(1.0, DVec3::ZERO));
    let caster = Caster::new(&model);
    let again = Caster::new(&model);
    for exponent in 3..=12 {
        let delta = 10f64.powi(-exponent);
        for _ in 0..300 {
            let d = random.direction();
            let across = d.cross(random.direction()).normalize();
            let at = |offset: f64| ray(across * offset - d * 3.0, d);
            let inside = caster.all(&at(1.0 - delta));
            check(&caster, &at(1.0 - delta), &inside);
            assert_eq!((inside.hits.len(), inside.undecided.len()), (2, 0), "1 − 1e-{exponent}, {d:?}: {inside:?}");
            let outside = caster.all(&at(1.0 + delta));
            assert_eq!((outside.hits.len(), outside.undecided.len()), (0, 0), "1 + 1e-{exponent}, {d:?}: {outside:?}");
            let tangent = caster.all(&at(1.0));
            check(&caster, &at(1.0), &tangent);
            assert!(tangent.hits.len() + tangent.undecided.len() <= 2, "{tangent:?}");
            assert!(tangent.boxes < 3000, "{}", tangent.boxes);
            assert_eq!(tangent, again.all(&at(1.0)));
            assert_eq!(inside, again.all(&at(1.0 - delta)));
        }
    }
}

#[test]
fn tangent_of_a_sphere_along_an_axis_is_one_hit() {
    let model = one(sphere(1.0, DVec3::ZERO));
    let caster = Caster::new(&model);
    for (origin, d) in [
        (DVec3::new(-3.0, 1.0, 0.0), DVec3::X),
        (DVec3::new(-3.0, 0.0, 1.0), DVec3::X),
        (DVec3::new(1.0, 0.0, -3.0), DVec3::Z),
        (DVec3::new(0.6, -3.0, 0.8), DVec3::Y),
    ] {
        let ray = ray(origin, d);
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
        assert!(all.hits.len() == 1 && all.undecided.is_empty(), "{all:?}");
        assert!((all.hits[0].t - 3.0).abs() < 1e-6);
    }
}

#[test]
fn rays_through_the_poles_hit_them_once() {
    let model = one(sphere(1.0, DVec3::ZERO));
    let caster = Caster::new(&model);
    let mut random = Random(14);
    for _ in 0..200 {
        let d = random.direction();
        let pole = DVec3::new(0.0, 0.0, -d.z.signum());
        let ray = ray(pole - d * 3.0, d);
        let all = caster.all(&ray);
        check(&caster, &ray, &all);
        assert_eq!((all.hits.len(), all.undecided.len()), (2, 0), "{d:?} {all:?}");
        assert!((all.hits[0].t - 3.0).abs() < 1e-12 / d.z.abs());
    }
    let axis = ray(DVec3::new(0.0, 0.0, -4.0), DVec3::Z);
    let all = caster.all(&axis);
    assert_eq!((all.hits.len(), all.undecided.len()), (2, 0), "{all:?}");
}

#[test]
fn cylinder_and_plane_are_hit_where_formulas_say() {
    let mut random = Random(15);
    let model = one(cylinder(0.5, 1.0, DVec3::ZERO));
    let caster = Caster::new(&model);
    let square =
        one(bilinear([[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.25))));
    let plane = Caster::new(&square);
    for _ in 0..10_000 {
        let (d, target) = (random.direction(), random.direction() * random.unit());
        let ray = ray(target - d * 3.0, d);
        let o = ray.origin;
        let (a, b, c) = (d.x * d.x + d.y * d.y, o.x * d.x + o.y * d.y, o.x * o.x + o.y * o.y - 0.25);
        let disc = b * b - a * c;
        if disc.abs() > 1e-9 {
            let roots = if disc < 0.0 { vec![] } else { vec![(-b - disc.sqrt()) / a, (-b + disc.sqrt()) / a] };
            let expected: Vec<f64> = roots.into_iter().filter(|&t| ray.at(t).z.abs() < 1.0 && t >= 0.0).collect();
            let all = caster.all(&ray);
            check(&caster, &ray, &all);
            assert_eq!(all.hits.len(), expected.len(), "{ray:?} {expected:?} {all:?}");
            for (hit, t) in all.hits.iter().zip(expected) {
                assert!((hit.t - t).abs() < 1e-9);
            }
        }
        let t = (0.25 - o.z) / d.z;
        let p = ray.at(t);
        let all = plane.all(&ray);
        check(&plane, &ray, &all);
        let inside = p.x.abs() <= 1.0 && p.y.abs() <= 1.0 && t >= 0.0;
        assert_eq!((all.hits.len(), all.undecided.len()), (usize::from(inside), 0), "{ray:?} {p:?}");
    }
}

//! Profiles in space, projected: on a plane, across a seam, over a pole, and off the surface.

use glam::DVec3;
use nurbs::{KnotVector, SpaceCurve, Surface};
use scene::{Face, FaceId, Model, Profile, SceneError, loops_from_profiles};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

fn knots(degree: usize, spans: usize) -> KnotVector {
    let inner = (1..spans).flat_map(|i| vec![i as f64; degree]);
    let (start, end) = (vec![0.0; degree + 1], vec![spans as f64; degree + 1]);
    KnotVector::new(degree, start.into_iter().chain(inner).chain(end).collect()).unwrap()
}

/// A circle about `center` with the half axes `a` and `b`, as one curve of four arcs.
fn circle(center: DVec3, a: DVec3, b: DVec3) -> SpaceCurve {
    let around = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
    let points = around.map(|(x, y)| center + f64::from(x) * a + f64::from(y) * b);
    let weights: Vec<f64> = (0..9).map(|i| if i % 2 == 1 { FRAC_1_SQRT_2 } else { 1.0 }).collect();
    SpaceCurve::new(knots(2, 4), &points, Some(&weights)).unwrap()
}

/// A full turn about z of a profile of points (radius, z).
fn revolved(profile: &[(f64, f64)], weights: &[f64]) -> Surface {
    let around = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
    let (mut points, mut all) = (vec![], vec![]);
    for (i, (x, y)) in around.into_iter().enumerate() {
        for (&(radius, z), weight) in profile.iter().zip(weights) {
            points.push(DVec3::new(f64::from(x) * radius, f64::from(y) * radius, z));
            all.push(weight * if i % 2 == 1 { FRAC_1_SQRT_2 } else { 1.0 });
        }
    }
    Surface::new(knots(2, 4), knots(profile.len() - 1, 1), points, Some(all)).unwrap()
}

fn dome() -> Surface {
    revolved(&[(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], &[1.0, FRAC_1_SQRT_2, 1.0])
}

fn trimmed(surface: &Surface, profiles: &[Profile], tolerance: f64) -> Model {
    let loops = loops_from_profiles(surface, profiles, tolerance).unwrap();
    let face = Face { tolerance: 2.0 * tolerance, loops, ..Face::whole(0) };
    Model::new("profiles", vec![surface.clone()], vec![face]).unwrap()
}

/// The area in space of the region, by a lattice of cells of the domain.
fn area_in_space(model: &Model, count: usize) -> f64 {
    let (surface, region) = (&model.surfaces()[0], model.region(FaceId(0)).unwrap());
    let (min, size) = (region.domain().min, region.domain().size());
    let mut sum = 0.0;
    for k in 0..count * count {
        let share = glam::DVec2::new((k % count) as f64 + 0.5, (k / count) as f64 + 0.5) / count as f64;
        let uv = min + size * share;
        let crossings = region.pieces().iter().filter(|p| 0 != p.winding()).map(|p| {
            let (a, b) = (p.curve.start(), p.curve.end());
            if uv.y < a.y.min(b.y) || a.y.max(b.y) <= uv.y {
                return 0;
            }
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..30 {
                let middle = 0.5 * (low + high);
                if (p.curve.point(middle).y <= uv.y) == (a.y < b.y) { low = middle } else { high = middle }
            }
            p.winding() * i32::from(uv.x < p.curve.point(low).x)
        });
        if crossings.sum::<i32>() != 0 {
            let d = surface.first_derivatives(uv.x, uv.y);
            sum += d.su.cross(d.sv).length() * size.x * size.y / (count * count) as f64;
        }
    }
    sum
}

#[test]
fn circles_on_a_plane_are_within_the_tolerance_of_themselves() {
    let line = knots(1, 1);
    let (x, y) = (DVec3::new(3.0, 1.0, 0.0), DVec3::new(-1.0, 3.0, 2.0));
    let plane = Surface::new(line.clone(), line, vec![DVec3::ZERO, y, x, x + y], None).unwrap();
    let at = 0.5 * (x + y);
    // Half axes along the plane's own: in (u, v) a circle of radius 0.3, whatever the shear.
    let outer = Profile { outer: true, curves: vec![circle(at, 0.3 * x, 0.3 * y)] };
    let hole = Profile { outer: false, curves: vec![circle(at, 0.1 * y, 0.1 * x)] };
    let mut trims = vec![];
    for tolerance in [1e-3, 1e-6, 1e-9] {
        let model = trimmed(&plane, &[outer.clone(), hole.clone()], tolerance);
        let region = model.region(FaceId(0)).unwrap();
        assert!((region.area() - 0.08 * PI).abs() < 2.0 * PI * 0.4 * tolerance, "{}", region.area() - 0.08 * PI);
        assert!(region.pieces().iter().all(|p| {
            let radius = p.curve.point(0.5).distance(glam::DVec2::splat(0.5));
            (radius - 0.3).abs().min((radius - 0.1).abs()) <= tolerance
        }));
        trims.push(model.faces()[0].loops[0].trims.len());
    }
    // Fourth order: a thousandth of the tolerance costs about 1000^(1/4) times the cubics.
    assert!(trims[2] <= 12 * trims[1] && trims[1] <= 12 * trims[0], "{trims:?}");
}

#[test]
fn a_window_across_the_seam_of_a_cylinder_is_projected_to_one_loop() {
    // The cylinder of radius 1 about z and the sphere of radius r about (1, 0, 0) meet in a closed curve, which no
    // NURBS is: here a square of four lines on the cylinder's own rulings and rims instead.
    let cylinder = revolved(&[(1.0, -1.0), (1.0, 1.0)], &[1.0, 1.0]);
    let (c, s) = (0.8, 0.6);
    let arc = |z: f64, turn: f64| {
        let points = [DVec3::new(c, -turn * s, z), DVec3::new(1.0 / c, 0.0, z), DVec3::new(c, turn * s, z)];
        SpaceCurve::new(knots(2, 1), &points, Some(&[1.0, c, 1.0])).unwrap()
    };
    let ruling = |y: f64, from: f64, to: f64| {
        SpaceCurve::new(knots(1, 1), &[DVec3::new(c, y, from), DVec3::new(c, y, to)], None).unwrap()
    };
    let curves = vec![arc(-0.5, 1.0), ruling(s, -0.5, 0.5), arc(0.5, -1.0), ruling(-s, 0.5, -0.5)];
    let model = trimmed(&cylinder, &[Profile { outer: true, curves }], 1e-7);
    let region = model.region(FaceId(0)).unwrap();
    assert_eq!(region.repairs().across_seam, [0]);
    let exact = 2.0 * s.asin();
    let area = area_in_space(&model, 300);
    assert!((area - exact).abs() < 0.03, "{area} {exact}");
}

#[test]
fn a_curve_over_the_pole_bounds_half_a_dome() {
    // From the rim over the pole to the rim, and back along it.
    let over: Vec<DVec3> =
        [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)].map(|(x, z)| DVec3::new(f64::from(x), 0.0, f64::from(z))).to_vec();
    let rim: Vec<DVec3> = [(-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
        .map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), 0.0))
        .to_vec();
    let weights = [1.0, FRAC_1_SQRT_2, 1.0, FRAC_1_SQRT_2, 1.0];
    let curves = [over, rim].map(|points| SpaceCurve::new(knots(2, 2), &points, Some(&weights)).unwrap()).to_vec();
    let model = trimmed(&dome(), &[Profile { outer: true, curves }], 1e-6);
    let area = area_in_space(&model, 300);
    assert!((area - PI).abs() < 0.03, "{area}");
}

#[test]
fn a_cap_about_the_pole_and_a_cap_aside_have_their_areas() {
    // Circles on the unit sphere at angle 0.5 from an axis: their caps have the area 2 π (1 − cos 0.5).
    let (sin, cos) = 0.5f64.sin_cos();
    for axis in [DVec3::Z, DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.3, 0.4, 0.8).normalize()] {
        let a = axis.any_orthonormal_vector();
        let curves = vec![circle(cos * axis, sin * a, sin * axis.cross(a))];
        let model = trimmed(&dome(), &[Profile { outer: true, curves }], 1e-6);
        let area = area_in_space(&model, 300);
        assert!((area - 2.0 * PI * (1.0 - cos)).abs() < 0.03, "{axis}: {area}");
    }
}

#[test]
fn a_point_off_the_surface_is_named() {
    let curves = vec![circle(DVec3::new(0.0, 0.0, 0.5), DVec3::X * 0.5, DVec3::Y * 0.5)];
    let error = loops_from_profiles(&dome(), &[Profile { outer: true, curves }], 1e-6).unwrap_err();
    let SceneError::ProfilePoint { profile: 0, curve: 0, t: 0.0, distance, .. } = error else { panic!("{error}") };
    assert!((distance - (1.0 - 0.5f64.sqrt())).abs() < 1e-9, "{distance}");
    assert!(error.to_string().starts_with("profile 0, curve 0: the point at parameter 0 is 2.929e-1"), "{error}");
}

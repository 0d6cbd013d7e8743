//! Evaluation by the span's own parameter: the same surface, and nothing lost where knots are far from zero or close.

use glam::{DVec2, DVec3};
use nurbs::{Direction, KnotVector, Normal, Surface};
use proptest::prelude::*;

/// A rational surface of degree 3 × 2 whose knots are `place` of those of an ordinary one, with a short span in u.
fn surface(place: impl Fn(f64) -> f64 + Copy) -> Surface {
    let knots = |degree, inner: &[f64]| {
        let ends = |t: f64| std::iter::repeat_n(t, degree + 1);
        let all = ends(0.0).chain(inner.iter().copied()).chain(ends(1.0)).map(place).collect();
        KnotVector::new(degree, all).unwrap()
    };
    let (u, v) = (knots(3, &[0.25, 0.25 + 1.0 / 1024.0, 0.75]), knots(2, &[0.5]));
    let (nu, nv) = (u.control_count(), v.control_count());
    let wave = |i: usize, j: usize| ((3 * i + 5 * j) as f64).sin();
    let points = (0..nu * nv).map(|k| (k / nv, k % nv)).map(|(i, j)| DVec3::new(i as f64, j as f64, wave(i, j)));
    let weights = (0..nu * nv).map(|k| 1.0 + 0.5 * (k as f64).cos()).collect();
    Surface::new(u, v, points.collect(), Some(weights)).unwrap()
}

fn spans(surface: &Surface) -> Vec<[usize; 2]> {
    let [u, v] = [Direction::U, Direction::V].map(|d| surface.knots(d).spans().collect::<Vec<_>>());
    u.iter().flat_map(|&k| v.iter().map(move |&l| [k, l])).collect()
}

proptest! {
    #[test]
    fn a_spans_own_parameter_names_the_same_point(s in 0.0f64..=1.0, t in 0.0f64..=1.0) {
        let surface = surface(|t| t);
        for span in spans(&surface) {
            let [u, v] = [(Direction::U, span[0], s), (Direction::V, span[1], t)].map(|(direction, span, t)| {
                let (start, length) = surface.knots(direction).span(span);
                start + t * length
            });
            let local = surface.inspect_local(span, DVec2::new(s, t));
            let global = surface.inspect_on(span[0], span[1], u, v);
            let (a, b) = (local.derivatives, global.derivatives);
            // Derivatives are large in the short span: errors are relative to the largest there.
            for (a, b, size) in [
                (a.s, b.s, 6.0),
                (a.su, b.su, 1e3),
                (a.sv, b.sv, 1e2),
                (a.suu, b.suu, 1e6),
                (a.suv, b.suv, 1e4),
                (a.svv, b.svv, 1e3),
            ] {
                prop_assert!(a.distance(b) <= 1e-11 * size, "{span:?} ({s}, {t}): {a} and {b}");
            }
            let (Normal::Regular(n), Normal::Regular(m)) = (local.normal, global.normal) else { panic!("regular") };
            prop_assert!(n.distance(m) <= 1e-9);
            let first = surface.first_derivatives_local(span, DVec2::new(s, t));
            prop_assert!(first.s.distance(a.s) <= 1e-14 && first.su.distance(a.su) <= 1e-11);
            prop_assert_eq!(surface.point_local(span, DVec2::new(s, t)), first.s);
        }
    }

    /// Moved by 2³⁰ and shrunk by 2⁻¹², every knot is exact and the surface the same: so must be every bit.
    #[test]
    fn a_domain_far_from_zero_loses_nothing(s in 0.0f64..=1.0, t in 0.0f64..=1.0) {
        let (near, far) = (surface(|t| t), surface(|t| 1073741824.0 + t / 4096.0));
        for span in spans(&near) {
            let [a, b] = [&near, &far].map(|surface| surface.inspect_local(span, DVec2::new(s, t)).derivatives);
            prop_assert_eq!(a.s, b.s);
            prop_assert_eq!(a.su * 4096.0, b.su);
            prop_assert_eq!(a.sv * 4096.0, b.sv);
            prop_assert_eq!(a.suu * 16777216.0, b.suu);
            prop_assert_eq!(a.suv * 16777216.0, b.suv);
            prop_assert_eq!(a.svv * 16777216.0, b.svv);
        }
    }
}

#[test]
fn forming_the_parameter_there_loses_what_the_local_one_keeps() {
    let (near, far) = (surface(|t| t), surface(|t| 1073741824.0 + t / 4096.0));
    let span = spans(&near)[2];
    let (start, length) = far.knots(Direction::U).span(span[0]);
    let (v, _) = far.knots(Direction::V).span(span[1]);
    let exact = near.point_local(span, DVec2::new(0.3, 0.0));
    let formed = far.first_derivatives_on(span[0], span[1], start + 0.3 * length, v).s;
    assert!(formed.distance(exact) > 1e-4, "{}", formed.distance(exact));
    assert_eq!(far.point_local(span, DVec2::new(0.3, 0.0)), exact);
}

#[test]
fn a_span_of_the_least_length_keeps_its_second_derivatives_finite() {
    // 1 / length is finite, 1 / length² is not.
    let tiny = 1e-200;
    let knots = KnotVector::new(1, vec![0.0, 0.0, tiny, tiny]).unwrap();
    let points = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::new(1.0, 1.0, 0.5)];
    let surface = Surface::new(knots.clone(), knots, points, None).unwrap();
    let d = surface.second_derivatives_local([1, 1], DVec2::new(0.5, 0.5));
    assert_eq!(d.s, DVec3::new(0.5, 0.5, 0.125));
    assert!((d.su.x * tiny - 1.0).abs() < 1e-15 && d.suu == DVec3::ZERO, "{d:?}");
}

/// Two neighbouring control points of a corner coincide: S_u is zero there, and at no other point of the side.
#[test]
fn a_corner_whose_limit_depends_on_the_direction_has_no_normal() {
    let knots = |p: usize| KnotVector::new(p, [vec![0.0; p + 1], vec![1.0; p + 1]].concat()).unwrap();
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let rows = |side: [DVec3; 3]| {
        let lifted = |i: usize, p: DVec3, j: usize| p + j as f64 * at(0.1, 1.0, 0.3 * i as f64);
        side.into_iter().enumerate().flat_map(|(i, p)| (0..3).map(move |j| lifted(i, p, j))).collect()
    };
    let normal = |side, u, v| Surface::new(knots(2), knots(2), rows(side), None).unwrap().inspect(u, v).normal;
    let corner = [DVec3::ZERO, DVec3::ZERO, at(1.0, 0.0, 0.5)];
    assert_eq!(normal(corner, 0.0, 0.0), Normal::Undefined);
    assert!(matches!(normal(corner, 0.1, 0.0), Normal::Regular(_)));
    // A side that is a point has one limit at each of its parameters, the corners' too.
    let fan: Vec<DVec3> =
        (0..9).map(|k| (k / 3, k % 3)).map(|(i, j)| at((i * j) as f64, j as f64, (i * i * j) as f64)).collect();
    let fan = Surface::new(knots(2), knots(2), fan, None).unwrap();
    for u in [0.0, 0.3, 1.0] {
        let Normal::Limit(n) = fan.inspect(u, 0.0).normal else { panic!("a limit at {u}") };
        let near = fan.inspect(u, 1e-6).normal.unit().unwrap();
        assert!(n.distance(near) < 1e-9, "{n} and {near}");
    }
}

//! The classifier of points in trimmed faces, against the region's own pieces, exact distances and areas.

use glam::{DVec2, DVec3};
use nurbs::{BezierCurve, KnotVector, Surface};
use proptest::prelude::*;
use raycast::Classifier;
use scene::{Face, Loop, Region, Trim};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

fn knots(degree: usize, spans: usize, length: f64) -> KnotVector {
    let step = length / spans as f64;
    let inner = (1..spans).flat_map(|i| vec![i as f64 * step; degree]);
    let (start, end) = (vec![0.0; degree + 1], vec![length; degree + 1]);
    KnotVector::new(degree, start.into_iter().chain(inner).chain(end).collect()).unwrap()
}

/// The square from 0 to `side` in the plane, with (x, y) = (u, v).
fn plane(side: f64) -> Surface {
    let line = knots(1, 1, side);
    let corners = [(0.0, 0.0), (0.0, side), (side, 0.0), (side, side)];
    Surface::new(line.clone(), line, corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(), None).unwrap()
}

fn closed(outer: bool, degree: usize, points: Vec<DVec2>, weights: Vec<f64>) -> Loop {
    let knots = knots(degree, (points.len() - 1) / degree, 1.0);
    let weights = Some(weights);
    Loop { outer, trims: vec![Trim { reversed: !outer, ..Trim::new(knots, points, weights) }] }
}

fn circle(outer: bool, center: DVec2, radius: f64) -> Loop {
    let around = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
    let points = around.map(|(x, y)| center + radius * DVec2::new(f64::from(x), f64::from(y))).to_vec();
    closed(outer, 2, points, (0..9).map(|i| if i % 2 == 1 { FRAC_1_SQRT_2 } else { 1.0 }).collect())
}

fn region(surface: &Surface, loops: Vec<Loop>) -> Region {
    Region::new(0, &Face { loops, ..Face::whole(0) }, surface, 0.0).unwrap().unwrap()
}

/// The winding number by the region's monotone pieces: the rasterizers' way, with nothing of the classifier's.
fn by_pieces(region: &Region, point: DVec2) -> bool {
    let mut sum = 0;
    for piece in region.pieces() {
        let (a, b) = (piece.curve.start(), piece.curve.end());
        if a.y.min(b.y) <= point.y && point.y < a.y.max(b.y) {
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if (piece.curve.point(middle).y <= point.y) == (a.y < b.y) { low = middle } else { high = middle }
            }
            sum += piece.winding() * i32::from(point.x < piece.curve.point(low).x);
        }
    }
    sum != 0
}

#[test]
fn a_plate_of_holes_is_told_to_the_last_bits_of_its_circles() {
    let centers: Vec<DVec2> =
        (0..100).map(|i| DVec2::new(0.05 + 0.1 * f64::from(i % 10), 0.05 + 0.1 * f64::from(i / 10))).collect();
    let mut loops: Vec<Loop> = centers.iter().map(|c| circle(false, *c, 0.04)).collect();
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];
    loops.push(closed(true, 1, corners.map(DVec2::from).to_vec(), vec![1.0; 5]));
    let region = region(&plane(1.0), loops);
    assert!((region.area() - (1.0 - 100.0 * PI * 0.0016)).abs() < 1e-12);
    let classifier = Classifier::new(&region);
    for (i, center) in centers.iter().enumerate() {
        for k in 0..50 {
            let angle = f64::from(k) + i as f64;
            let direction = DVec2::new(angle.cos(), angle.sin());
            for off in [1e-14, 1e-9, 1e-3] {
                assert!(!classifier.inside(*center + direction * (0.04 - off)), "hole {i}, {angle}, {off:e}");
                assert!(classifier.inside(*center + direction * (0.04 + off)), "hole {i}, {angle}, {off:e}");
                let distance = classifier.side(*center + direction * (0.04 - off), DVec2::ONE).distance;
                assert!((0.98 * off - 1e-15..=off + 1e-15).contains(&distance), "{distance:e} for {off:e}");
            }
        }
    }
    // The border of the domain is as its neighbour inside, on all four sides.
    assert!(
        [(0.0, 0.5), (1.0, 0.5), (0.5, 0.0), (0.5, 1.0), (1.0, 1.0)]
            .map(DVec2::from)
            .iter()
            .all(|p| classifier.inside(*p))
    );
}

#[test]
fn a_segment_that_closes_on_itself_winds_about_what_is_in_it() {
    // The full circle as one rational quintic (Chou 1995).
    let points = [(0.0, -1.0), (4.0, -1.0), (2.0, 3.0), (-2.0, 3.0), (-4.0, -1.0), (0.0, -1.0)];
    let points = points.map(|(x, y)| DVec2::splat(5.0) + 2.0 * DVec2::new(x, y)).to_vec();
    let region = region(&plane(10.0), vec![closed(true, 5, points, vec![5.0, 1.0, 1.0, 1.0, 1.0, 5.0])]);
    assert!((region.area() - 4.0 * PI).abs() < 1e-12);
    let classifier = Classifier::new(&region);
    for k in 0..2000 {
        let point = DVec2::new(f64::from(k % 50) + 0.3, f64::from(k / 40) + 0.7) / 5.0;
        let away = point.distance(DVec2::splat(5.0));
        let side = classifier.side(point, DVec2::ONE);
        assert_eq!(side.inside, away < 2.0, "{point}");
        assert!((0.98 * (away - 2.0).abs()..=(away - 2.0).abs() + 1e-14).contains(&side.distance), "{point}");
    }
}

#[test]
fn distances_are_in_the_metric_that_is_asked_for() {
    let classifier = Classifier::new(&region(&plane(10.0), vec![circle(true, DVec2::splat(5.0), 2.0)]));
    let side = classifier.side(DVec2::new(5.0, 6.5), DVec2::new(100.0, 3.0));
    assert!(side.inside && (0.98 * 1.5..=1.5).contains(&side.distance), "{side:?}");
    let side = classifier.side(DVec2::new(8.0, 5.0), DVec2::ONE);
    assert!(!side.inside && (0.98..=1.0).contains(&side.distance), "{side:?}");
}

/// A closed star of random radii about the middle of a square of 10: rational, of any degree.
fn star(outer: bool, radii: &[f64], degree: usize, weights: &[f64]) -> Loop {
    let count = radii.len() / degree * degree;
    let point = |i: usize| {
        let angle = 2.0 * PI * i as f64 / count as f64;
        DVec2::splat(5.0) + radii[i % count] * DVec2::new(angle.cos(), angle.sin())
    };
    let points = (0..count).chain([0]).map(point).collect();
    closed(outer, degree, points, (0..count).chain([0]).map(|i| weights[i % weights.len()]).collect())
}

/// The distance of a point from a curve by samples, about the nearest of which samples lie as close again: unequal
/// weights may put nearly all of the first ones at one end.
fn sampled_distance(curve: &BezierCurve, point: DVec2) -> f64 {
    let (mut low, mut high, mut least) = (0.0, 1.0, f64::INFINITY);
    for _ in 0..3 {
        let at = |i: u32| low + (high - low) * f64::from(i) / 100.0;
        let distance = |i: u32| curve.point(at(i)).distance(point);
        let nearest = (0..=100).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).expect("samples");
        least = least.min(distance(nearest));
        (low, high) = (at(nearest.saturating_sub(1)), at((nearest + 1).min(100)));
    }
    least
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn pieces_and_subdivision_agree_and_no_edge_is_within_the_distance(
        radii in prop::collection::vec(2.5f64..4.5, 14..40),
        weights in prop::collection::vec(0.2f64..5.0, 5),
        degree in 1usize..8,
        points in prop::collection::vec((0.0f64..10.0, 0.0f64..10.0), 40),
        level in 0usize..20,
    ) {
        let inner: Vec<f64> = radii.iter().map(|r| 0.3 * r).collect();
        let region = region(&plane(10.0), vec![star(true, &radii, degree, &weights), star(false, &inner, degree, &weights)]);
        let classifier = Classifier::new(&region);
        // Points at the heights of the pieces' ends, too, where crossings are counted by a half-open rule.
        let height = region.pieces()[level % region.pieces().len()].curve.start().y;
        let points = points.iter().flat_map(|&(u, v)| [DVec2::new(u, v), DVec2::new(u, height)]);
        for point in points {
            let side = classifier.side(point, DVec2::ONE);
            prop_assert_eq!(side.inside, classifier.inside(point));
            let sampled = region.pieces().iter().map(|p| sampled_distance(&p.curve, point)).fold(f64::INFINITY, f64::min);
            prop_assert!(side.distance <= sampled && sampled <= 1.03 * side.distance + 0.05, "{} {sampled}", side.distance);
            if 1e-12 < side.distance {
                prop_assert_eq!(side.inside, by_pieces(&region, point), "{} at {:e}", point, side.distance);
            }
        }
    }

    #[test]
    fn the_share_of_random_points_inside_is_the_area(radii in prop::collection::vec(2.5f64..4.5, 14..40), degree in 1usize..6) {
        let region = region(&plane(10.0), vec![star(true, &radii, degree, &[1.0, 0.5, 2.0])]);
        let classifier = Classifier::new(&region);
        // A lattice of equal cells: the error is at most the cells that the edge passes through.
        let count = 200;
        let at = |i: usize| (i as f64 + 0.5) * 10.0 / count as f64;
        let inside = (0..count * count).filter(|k| classifier.inside(DVec2::new(at(k % count), at(k / count)))).count();
        let area = inside as f64 * (10.0 / count as f64).powi(2);
        prop_assert!((area - region.area()).abs() < 0.3, "{area} {}", region.area());
    }
}

#[test]
fn a_missing_hole_or_a_moved_edge_would_be_noticed() {
    let plate = |radius: f64, hole: bool| {
        let holes = hole.then(|| circle(false, DVec2::splat(5.0), 1.0));
        region(&plane(10.0), [circle(true, DVec2::splat(5.0), radius)].into_iter().chain(holes).collect())
    };
    let truth = Classifier::new(&plate(4.0, true));
    for (wrong, least) in [(plate(4.0, false), 300), (plate(4.01, true), 20)] {
        let other = (0..10_000u32).map(|k| DVec2::new(f64::from(k % 100) + 0.37, f64::from(k / 100) + 0.21) / 10.0);
        let differ = other.filter(|point| truth.inside(*point) != by_pieces(&wrong, *point)).count();
        assert!(least <= differ, "{differ}");
    }
}

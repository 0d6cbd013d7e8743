//! What a face's loops are made into: exact cases, seeded random loops, and every way in which loops can be wrong.

use glam::{DVec2, DVec3};
use nurbs::{KnotVector, NurbsError, Surface};
use proptest::prelude::*;
use scene::{Face, Loop, Model, Region, SceneError, Trim, TrimPlace};
use std::f64::consts::PI;

const HALF_SQRT: f64 = std::f64::consts::FRAC_1_SQRT_2;

fn knots(degree: usize, breaks: &[f64]) -> KnotVector {
    let inner = breaks[1..breaks.len() - 1].iter().flat_map(|&t| vec![t; degree]);
    let ends = [breaks[0], breaks[breaks.len() - 1]].map(|t| vec![t; degree + 1]);
    KnotVector::new(degree, ends[0].iter().copied().chain(inner).chain(ends[1].iter().copied()).collect()).unwrap()
}

/// The square from 0 to `side` in the plane, with (x, y) = (u, v).
fn plane(side: f64) -> Surface {
    let line = knots(1, &[0.0, side]);
    let corners = [(0.0, 0.0), (0.0, side), (side, 0.0), (side, side)];
    Surface::new(line.clone(), line, corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(), None).unwrap()
}

/// A full turn in u (0 to 4) about z of a profile of points (radius, z) over v in 0 to 1.
fn revolved(profile: &[(f64, f64)], weights: &[f64]) -> Surface {
    let circle = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
    let (mut points, mut all) = (vec![], vec![]);
    for (i, (x, y)) in circle.into_iter().enumerate() {
        for (&(radius, z), weight) in profile.iter().zip(weights) {
            points.push(DVec3::new(f64::from(x) * radius, f64::from(y) * radius, z));
            all.push(weight * if i % 2 == 1 { HALF_SQRT } else { 1.0 });
        }
    }
    let (u, v) = (knots(2, &[0.0, 1.0, 2.0, 3.0, 4.0]), knots(profile.len() - 1, &[0.0, 1.0]));
    Surface::new(u, v, points, Some(all)).unwrap()
}

fn cylinder() -> Surface {
    revolved(&[(1.0, 0.0), (1.0, 2.0)], &[1.0, 1.0])
}

/// Half a sphere: the pole is v = 1.
fn dome() -> Surface {
    revolved(&[(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], &[1.0, HALF_SQRT, 1.0])
}

fn trim(degree: usize, points: Vec<DVec2>, weights: Option<Vec<f64>>) -> Trim {
    let spans = (points.len() - 1) / degree;
    let breaks: Vec<f64> = (0..=spans).map(|i| i as f64).collect();
    let knots = knots(degree, &breaks);
    Trim::new(knots, points, weights)
}

fn path(points: &[(f64, f64)]) -> Vec<Trim> {
    points.windows(2).map(|w| trim(1, w.iter().map(|&(u, v)| DVec2::new(u, v)).collect(), None)).collect()
}

fn polygon(outer: bool, points: &[(f64, f64)]) -> Loop {
    Loop { outer, trims: path(&[points, &points[..1]].concat()) }
}

fn square(outer: bool, low: f64, high: f64) -> Loop {
    polygon(outer, &[(low, low), (high, low), (high, high), (low, high)])
}

/// A circle as one trim of four arcs, counter-clockwise.
fn circle(outer: bool, center: (f64, f64), radius: f64) -> Loop {
    let around = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
    let point = |(x, y): (i32, i32)| DVec2::from(center) + radius * DVec2::new(f64::from(x), f64::from(y));
    let weights = (0..9).map(|i| if i % 2 == 1 { HALF_SQRT } else { 1.0 }).collect();
    Loop { outer, trims: vec![trim(2, around.map(point).to_vec(), Some(weights))] }
}

fn backwards(mut boundary: Loop) -> Loop {
    boundary.trims.reverse();
    boundary.trims.iter_mut().for_each(|t| t.reversed = !t.reversed);
    boundary
}

fn build(surface: &Surface, loops: Vec<Loop>) -> Result<Region, SceneError> {
    let face = Face { loops, ..Face::whole(0) };
    let region = Region::new(7, &face, surface, 0.0)?.expect("the face has loops");
    assert_watertight(&region);
    Ok(region)
}

/// Each loop's segments and pieces are closed chains to the bit; pieces stay inside the domain.
fn assert_watertight(region: &Region) {
    for (index, boundary) in region.loops().iter().enumerate() {
        let s = &boundary.segments;
        assert!((0..s.len()).all(|i| s[i].curve.end() == s[(i + 1) % s.len()].curve.start()), "loop {index}");
        let p: Vec<_> = region.pieces().iter().filter(|p| p.loop_index == index).collect();
        assert!((0..p.len()).all(|i| p[i].curve.end() == p[(i + 1) % p.len()].curve.start()), "loop {index}");
        let hull = region.hull();
        assert!(region.domain().union(hull) == region.domain(), "{hull:?}");
    }
}

/// The winding number of the pieces about a point inside the domain, counted along the ray toward +u.
fn winding(region: &Region, point: DVec2) -> i32 {
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
    sum
}

fn material(region: &Region, u: f64, v: f64) -> bool {
    let winding = winding(region, DVec2::new(u, v));
    assert!(winding == 0 || winding == 1, "({u}, {v}): {winding}");
    winding != 0
}

#[test]
fn a_face_without_loops_has_no_region() {
    assert_eq!(Region::new(0, &Face::whole(0), &plane(1.0), 0.0), Ok(None));
}

#[test]
fn a_circle_has_the_area_of_a_circle_and_four_pieces() {
    let region = build(&plane(10.0), vec![circle(true, (4.0, 5.0), 3.0)]).unwrap();
    assert!((region.area() - 9.0 * PI).abs() < 1e-12 * 100.0, "{}", region.area());
    assert_eq!((region.pieces().len(), region.is_whole(), region.largest_gap()), (4, false, 0.0));
    assert!(material(&region, 4.0, 5.0) && material(&region, 6.999, 5.0) && !material(&region, 7.001, 5.0));
}

#[test]
fn islands_in_holes_are_material_however_loops_are_turned_and_listed() {
    let radii = [4.0, 3.0, 2.0, 1.0];
    let area = PI * (16.0 - 9.0 + 4.0 - 1.0);
    for turned in 0..16 {
        for first in 0..4 {
            let loops = (0..4).map(|i| (i + first) % 4).map(|i| {
                let boundary = circle(i % 2 == 0, (5.0, 5.0), radii[i]);
                if turned >> i & 1 == 1 { backwards(boundary) } else { boundary }
            });
            let region = build(&plane(10.0), loops.collect()).unwrap();
            assert!((region.area() - area).abs() < 1e-11, "{}", region.area());
            for (r, expected) in [(0.5, false), (1.5, true), (2.5, false), (3.5, true), (4.5, false)] {
                assert_eq!(material(&region, 5.0 + r, 5.0), expected, "{r}");
            }
            let expected: Vec<usize> = (0..4)
                .filter(|i| {
                    let k = (i + first) % 4;
                    (turned >> k & 1 == 1) == (k % 2 == 0)
                })
                .collect();
            assert_eq!(region.repairs().reoriented, expected);
        }
    }
}

#[test]
fn a_wrong_flag_is_noticed_where_direction_and_place_agree() {
    let loops = vec![square(false, 1.0, 9.0), backwards(square(true, 2.0, 3.0))];
    let region = build(&plane(10.0), loops).unwrap();
    assert_eq!((region.repairs().mislabelled.clone(), region.area()), (vec![0, 1], 63.0));
}

#[test]
fn holes_alone_are_cut_from_the_natural_boundary() {
    let region = build(&plane(10.0), vec![backwards(circle(false, (5.0, 5.0), 1.0))]).unwrap();
    assert!((region.area() - (100.0 - PI)).abs() < 1e-10);
    assert!(material(&region, 1.0, 1.0) && !material(&region, 5.0, 5.0));
}

/// How long the edges are along u and along v, by their ends.
fn edge_lengths(region: &Region) -> DVec2 {
    region.edges().map(|piece| (piece.curve.end() - piece.curve.start()).abs()).sum()
}

#[test]
fn a_face_ends_at_its_loops_and_at_sides_but_not_at_a_seam_nor_in_a_pole() {
    let hole = || backwards(square(false, 0.25, 0.75));
    let hole_alone = DVec2::splat(1.0);
    let region = build(&plane(1.0), vec![hole()]).unwrap();
    assert_eq!(edge_lengths(&region), hole_alone + DVec2::splat(2.0));
    // Closed in u, 4 around; v ends at both rims, or at one and a pole.
    let region = build(&cylinder(), vec![hole()]).unwrap();
    assert_eq!(edge_lengths(&region), hole_alone + DVec2::new(8.0, 0.0));
    assert!(region.ends_at(1, 0) && region.ends_at(1, 1) && !region.ends_at(0, 0) && !region.ends_at(0, 1));
    let region = build(&dome(), vec![hole()]).unwrap();
    assert_eq!(edge_lengths(&region), hole_alone + DVec2::new(4.0, 0.0));
    assert!(region.ends_at(1, 0) && !region.ends_at(1, 1));
}

#[test]
fn a_sliver_and_a_cusp_keep_their_area() {
    let region =
        build(&plane(1.0), vec![polygon(true, &[(0.1, 0.5), (0.9, 0.5), (0.9, 0.5001), (0.1, 0.5001)])]).unwrap();
    assert!((region.area() - 0.8e-4).abs() < 1e-12);
    assert!(material(&region, 0.5, 0.50005) && !material(&region, 0.5, 0.50011));
    // u and v both stand still at (1/2, 1) of this cubic.
    let cusp = [(2.0, 0.0), (0.0, 2.0), (0.0, 0.0), (2.0, 2.0)].map(|(u, v)| DVec2::new(u, v)).to_vec();
    let loops =
        vec![Loop { outer: true, trims: [vec![trim(3, cusp, None)], path(&[(2.0, 2.0), (2.0, 0.0)])].concat() }];
    let region = build(&plane(2.0), loops).unwrap();
    assert!((region.area() - cusp_area()).abs() < 1e-12, "{}", region.area());
}

/// The area between that cubic and the line u = 2, of a polygon of so many corners that it is right to 1e-12.
fn cusp_area() -> f64 {
    let at = |t: f64| {
        let s = 1.0 - t;
        let b = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        DVec2::new(2.0 * b[0] + 2.0 * b[3], 2.0 * b[1] + 2.0 * b[3])
    };
    let steps = 1 << 21;
    let sum: f64 =
        (0..steps).map(|i| at(f64::from(i) / f64::from(steps)).perp_dot(at(f64::from(i + 1) / f64::from(steps)))).sum();
    let closing = DVec2::new(2.0, 2.0).perp_dot(DVec2::new(2.0, 0.0));
    (0.5 * (sum + closing)).abs()
}

#[test]
fn the_natural_boundary_is_whole_even_with_rounding() {
    let corners = [(1e-13, -1e-13), (10.0 - 1e-13, 0.0), (10.0 + 1e-12, 10.0), (0.0, 10.0 + 1e-13)];
    let region = build(&plane(10.0), vec![polygon(true, &corners)]).unwrap();
    assert!(region.is_whole() && (region.area() - 100.0).abs() < 1e-12, "{region:?}");
    let region = build(&plane(10.0), vec![square(true, 0.0, 10.0), backwards(square(false, 4.0, 4.1))]).unwrap();
    assert!(!region.is_whole());
}

#[test]
fn what_leaves_an_open_surface_is_clamped_to_its_domain() {
    let region = build(&plane(10.0), vec![circle(true, (10.0, 5.0), 3.0)]).unwrap();
    assert!((region.area() - 4.5 * PI).abs() < 1e-11, "{}", region.area());
    assert!(region.repairs().across_seam.is_empty());
}

#[test]
fn a_window_across_the_seam_opens_on_both_sides() {
    let whole = polygon(true, &[(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (0.0, 1.0)]);
    for center in [0.0, 4.0, 8.0] {
        let window = backwards(circle(false, (center, 0.5), 0.25));
        let region = build(&cylinder(), vec![whole.clone(), window]).unwrap();
        assert!((region.area() - (4.0 - PI / 16.0)).abs() < 1e-11, "{}", region.area());
        assert!(!material(&region, 0.1, 0.5) && !material(&region, 3.9, 0.5) && material(&region, 2.0, 0.5));
        assert_eq!(region.repairs().across_seam, [1]);
    }
}

/// A loop once around the cylinder at about height `v`, in the direction of u or against it, beginning at `start`.
fn ring(start: f64, v: f64, forward: bool) -> Loop {
    let line: Vec<(f64, f64)> = (0..=4).map(|i| (start + f64::from(i), v + 0.1 * f64::from(i % 2))).collect();
    let ring = Loop { outer: true, trims: path(&[&line[..4], &[(start + 4.0, v)]].concat()) };
    if forward { ring } else { backwards(ring) }
}

#[test]
fn rings_around_a_closed_surface_bound_the_band_between_them() {
    for start in [0.0, 1.5, -3.0, 9.0] {
        let bottom = ring(start, 0.2, true);
        let band = build(&cylinder(), vec![ring(start, 0.7, false), bottom.clone()]).unwrap();
        assert!((band.area() - 2.0).abs() < 1e-12, "{}", band.area());
        assert!(material(&band, 2.0, 0.5) && !material(&band, 2.0, 0.1) && !material(&band, 2.0, 0.9));
        assert_eq!(band.repairs().across_seam, [0, 1]);
        // One ring leaves material to the natural boundary on its left.
        let above = build(&cylinder(), vec![bottom.clone()]).unwrap();
        let below = build(&cylinder(), vec![backwards(bottom)]).unwrap();
        assert!((above.area() + below.area() - 4.0).abs() < 1e-12);
        assert!(material(&above, 2.0, 0.9) && !material(&above, 2.0, 0.1) && material(&below, 2.0, 0.1));
    }
}

/// A torus, closed in u and in v (both 0 to 4).
fn torus() -> Surface {
    let around = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
    let (mut points, mut weights) = (vec![], vec![]);
    for (i, (x, y)) in around.into_iter().enumerate() {
        for (j, (r, z)) in around.into_iter().enumerate() {
            let radius = 3.0 + f64::from(r);
            points.push(DVec3::new(f64::from(x) * radius, f64::from(y) * radius, f64::from(z)));
            weights.push(HALF_SQRT.powi((i % 2 + j % 2) as i32));
        }
    }
    let turn = knots(2, &[0.0, 1.0, 2.0, 3.0, 4.0]);
    Surface::new(turn.clone(), turn, points, Some(weights)).unwrap()
}

#[test]
fn rings_of_a_torus_bound_a_band_in_either_direction_and_across_the_other_seam() {
    for shift in [0.0, 1.95, 3.98, -4.03] {
        let rings = [ring(0.5, 0.5 + shift, true), ring(0.5, 1.5 + shift, false)];
        let exchanged = rings.clone().map(|mut ring| {
            ring.trims.iter_mut().flat_map(|t| &mut t.points).for_each(|p| *p = DVec2::new(p.y, p.x));
            backwards(ring)
        });
        for (loops, turned) in [(rings, false), (exchanged, true)] {
            let band = build(&torus(), loops.to_vec()).unwrap();
            assert!((band.area() - 4.0).abs() < 1e-12, "{shift}: {}", band.area());
            let at = |across: f64| {
                let (a, b) = (2.2, across.rem_euclid(4.0));
                if turned { material(&band, b, a) } else { material(&band, a, b) }
            };
            assert!(at(1.0 + shift) && !at(2.0 + shift) && !at(0.2 + shift), "{shift} {turned}");
            assert!(band.repairs().reoriented.is_empty());
        }
    }
}

#[test]
fn the_direction_of_a_lone_loop_says_which_side_of_a_closed_surface_is_meant() {
    let region = build(&torus(), vec![circle(true, (4.0, 2.0), 0.5)]).unwrap();
    assert!((region.area() - PI / 4.0).abs() < 1e-11 && material(&region, 0.1, 2.0));
    let region = build(&torus(), vec![backwards(circle(true, (4.0, 2.0), 0.5))]).unwrap();
    assert!((region.area() - (16.0 - PI / 4.0)).abs() < 1e-11 && !material(&region, 0.1, 2.0));
}

#[test]
fn a_cap_over_the_pole_needs_no_edge_along_it() {
    // A wedge of the dome: from the rim up to the pole, where u jumps from 1 to 3.5, and down again.
    let wedge = Loop { outer: true, trims: [path(&[(3.5, 1.0), (3.5, 0.0), (1.0, 0.0), (1.0, 1.0)])].concat() };
    let region = build(&dome(), vec![backwards(wedge)]).unwrap();
    assert_eq!(region.area(), 2.5);
    assert!(region.largest_gap() < 1e-15);
    // A cap bounded by a single ring.
    let cap = build(&dome(), vec![ring(0.0, 0.5, true)]).unwrap();
    assert!(material(&cap, 1.0, 0.99) && !material(&cap, 1.0, 0.3));
}

#[test]
fn small_gaps_are_healed_and_the_largest_is_told() {
    let mut boundary = square(true, 1.0, 9.0);
    boundary.trims[2].points[0].x -= 3e-7;
    let region = build(&plane(10.0), vec![boundary.clone()]).unwrap();
    assert!((region.largest_gap() - 3e-7).abs() < 1e-12, "{}", region.largest_gap());
    boundary.trims[2].points[0].x -= 1e-4;
    let error = build(&plane(10.0), vec![boundary.clone()]).unwrap_err();
    assert!(
        matches!(error, SceneError::TrimGap { face: 7, boundary: 0, trim: 2, gap, .. } if (gap - 1.003e-4).abs() < 1e-9)
    );
    assert!(error.to_string().starts_with("face 7, loop 0: 1.003"), "{error}");
    let face = Face { tolerance: 1e-3, loops: vec![boundary], ..Face::whole(0) };
    assert!(Region::new(0, &face, &plane(10.0), 0.0).is_ok());
}

#[test]
fn loops_that_bound_nothing_are_refused() {
    let none = build(&plane(10.0), vec![square(true, 1.0, 9.0), Loop { outer: false, trims: vec![] }]);
    assert_eq!(none, Err(SceneError::EmptyLoop { face: 7, boundary: 1 }));
    let flat = build(&plane(10.0), vec![polygon(true, &[(1.0, 1.0), (5.0, 4.0)])]);
    assert_eq!(flat, Err(SceneError::EmptyLoop { face: 7, boundary: 0 }));
    let mut boundary = square(true, 1.0, 9.0);
    boundary.trims[3].points[1] = DVec2::NAN;
    let error = build(&plane(10.0), vec![boundary.clone()]).unwrap_err();
    assert!(matches!(
        error,
        SceneError::TrimCurve { face: 7, boundary: 0, trim: 3, cause: NurbsError::PointNotFinite { index: 1, .. } }
    ));
    boundary.trims[3].points.pop();
    let cause = NurbsError::PointCount { expected: 2, found: 1 };
    let expected = SceneError::TrimCurve { face: 7, boundary: 0, trim: 3, cause };
    assert_eq!(build(&plane(10.0), vec![boundary]), Err(expected));
    let twice = Loop { outer: true, trims: path(&[(0.0, 0.5), (4.0, 0.6), (8.0, 0.5)]) };
    assert_eq!(build(&cylinder(), vec![twice]), Err(SceneError::LoopPeriod { face: 7, boundary: 0, u: 2, v: 0 }));
}

#[test]
fn crossings_are_found_and_touching_is_not_one() {
    let place = |boundary, trim| TrimPlace { boundary: Some(boundary), trim: Some(trim) };
    let bow_tie = polygon(true, &[(1.0, 1.0), (9.0, 8.0), (9.0, 1.0), (1.0, 9.0)]);
    let Err(SceneError::TrimsCross { face: 7, first, second, at }) = build(&plane(10.0), vec![bow_tie]) else {
        panic!()
    };
    assert!([(first, second), (second, first)].contains(&(place(0, 0), place(0, 2))), "{first} {second}");
    assert!(DVec2::from(at).distance(DVec2::new(5.0 + 1.0 / 3.0, 1.0 + 7.0 * 13.0 / 24.0)) < 1.0, "{at:?}");
    let circles = vec![circle(true, (4.0, 5.0), 2.0), circle(true, (6.0, 5.5), 2.0)];
    let Err(SceneError::TrimsCross { first, second, .. }) = build(&plane(10.0), circles) else { panic!() };
    assert_ne!(first.boundary, second.boundary);
    let touching = vec![
        square(true, 0.0, 10.0),
        backwards(square(false, 2.0, 4.0)),
        backwards(square(false, 4.0, 6.0)),
        backwards(circle(false, (5.0, 3.0), 1.0)),
    ];
    assert!((build(&plane(10.0), touching).unwrap().area() - (92.0 - PI)).abs() < 1e-10);
}

#[test]
fn loops_whose_flag_and_direction_both_contradict_their_place_are_refused() {
    let stray_hole = vec![square(true, 1.0, 4.0), backwards(square(false, 5.0, 6.0))];
    let expected = SceneError::Nesting { face: 7, boundary: 1, depth: 0, outer: false };
    assert_eq!(build(&plane(10.0), stray_hole), Err(expected));
    let two_outer = vec![square(true, 1.0, 9.0), square(true, 2.0, 3.0)];
    let expected = SceneError::Nesting { face: 7, boundary: 1, depth: 1, outer: true };
    assert_eq!(build(&plane(10.0), two_outer), Err(expected));
}

/// As [`build`], for a face with a tolerance in a model with coordinates up to `extent`.
fn build_to(surface: &Surface, tolerance: f64, extent: f64, loops: Vec<Loop>) -> Result<Region, SceneError> {
    let region = Region::new(7, &Face { tolerance, loops, ..Face::whole(0) }, surface, extent)?.expect("loops");
    assert_watertight(&region);
    Ok(region)
}

fn rectangle(outer: bool, low: (f64, f64), high: (f64, f64)) -> Loop {
    polygon(outer, &[low, (high.0, low.1), high, (low.0, high.1)])
}

#[test]
fn a_hole_may_share_any_sides_with_its_parent() {
    for shared in 0..15 {
        let side = |k: usize, inner: f64, outer: f64| if shared >> k & 1 == 1 { outer } else { inner };
        let (low, high) = ((side(0, 3.0, 1.0), side(1, 4.0, 1.0)), (side(2, 7.0, 9.0), side(3, 6.0, 9.0)));
        let hole = rectangle(false, low, high);
        let area = 64.0 - (high.0 - low.0) * (high.1 - low.1);
        for variant in 0..4 {
            let hole = if variant & 1 == 0 { hole.clone() } else { backwards(hole.clone()) };
            let mut loops = vec![square(true, 1.0, 9.0), hole];
            if variant & 2 != 0 {
                loops.reverse();
            }
            let region = build(&plane(10.0), loops).unwrap_or_else(|error| panic!("{shared:04b}, {variant}: {error}"));
            assert!((region.area() - area).abs() < 1e-11, "{shared:04b}: {} {area}", region.area());
            let inside = (low.0 + 0.31 * (high.0 - low.0), low.1 + 0.37 * (high.1 - low.1));
            assert!(!material(&region, inside.0, inside.1), "{shared:04b}");
        }
    }
    let all = vec![square(true, 1.0, 9.0), backwards(square(false, 1.0, 9.0))];
    assert_eq!(build(&plane(10.0), all), Err(SceneError::NoMaterial { face: 7 }));
}

/// A slice of a disc: from its centre along u, a quarter of the circle in two halves, and back.
fn slice(outer: bool, center: (f64, f64), radius: f64) -> Loop {
    let center = DVec2::from(center);
    let at = |angle: f64| center + radius * DVec2::new(angle.cos(), angle.sin());
    let arc = |from: f64, to: f64| {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let corner = center + (at(middle) - center) / half.cos();
        trim(2, vec![at(from), corner, at(to)], Some(vec![1.0, half.cos(), 1.0]))
    };
    let line = |a: DVec2, b: DVec2| trim(1, vec![a, b], None);
    let trims = vec![line(center, at(0.0)), arc(0.0, 0.6), arc(0.6, PI / 2.0), line(at(PI / 2.0), center)];
    Loop { outer, trims }
}

#[test]
fn a_hole_may_share_a_curved_side_with_its_parent_however_it_is_written() {
    for offset in [0.0, 1e-12, 3e-9, -3e-9] {
        let radius = 3.0 + offset;
        for turned in [false, true] {
            let hole = slice(false, (4.0, 5.0), radius);
            let hole = if turned { backwards(hole) } else { hole };
            let region = build(&plane(10.0), vec![circle(true, (4.0, 5.0), 3.0), hole]).unwrap();
            assert!((region.area() - 9.0 * PI * 0.75).abs() < 1e-7, "{offset:e}: {}", region.area());
            assert!(!material(&region, 5.5, 6.5) && material(&region, 2.5, 6.5) && material(&region, 5.5, 3.5));
        }
    }
    // Two millionths of the domain are more than its tolerance.
    let proud = vec![circle(true, (4.0, 5.0), 3.0), slice(false, (4.0, 5.0), 3.0 + 1e-4)];
    assert!(matches!(build(&plane(10.0), proud), Err(SceneError::TrimsCross { .. })));
}

/// A square of side 0.01 whose trims pass their joints by `over`.
fn overshooting(over: f64) -> Loop {
    let corners = [(0.001, 0.001), (0.009, 0.001), (0.009, 0.009), (0.001, 0.009)].map(DVec2::from);
    let line = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        let along = (b - a).normalize() * over;
        trim(1, vec![a - along, b + along], None)
    };
    Loop { outer: true, trims: (0..4).map(line).collect() }
}

#[test]
fn trims_may_overshoot_their_joint_by_the_tolerance_but_not_by_more() {
    let surface = plane(0.01);
    let region = build_to(&surface, 1e-7, 0.0, vec![overshooting(6e-8)]).unwrap();
    assert!((region.area() - 6.4e-5).abs() < 1e-11, "{}", region.area());
    let error = build_to(&surface, 1e-7, 0.0, vec![overshooting(5e-5)]).unwrap_err();
    assert!(matches!(error, SceneError::TrimGap { trim: 1, .. }), "{error}");
    let mut wide = overshooting(5e-5);
    wide.trims.iter_mut().for_each(|t| t.edge_tolerance = 1e-4);
    assert!(build_to(&surface, 1e-7, 0.0, vec![wide]).is_ok());
    // A tolerance as large as the face explains no crossing that is seen.
    let bow_tie = polygon(true, &[(0.001, 0.001), (0.009, 0.008), (0.009, 0.001), (0.001, 0.009)]);
    assert!(matches!(build_to(&surface, 1.0, 0.0, vec![bow_tie]), Err(SceneError::TrimsCross { .. })));
}

#[test]
fn gaps_are_healed_by_the_tolerances_of_edges_and_vertices_and_of_large_models() {
    let gap = 1e-4;
    let mut boundary = square(true, 1.0, 9.0);
    boundary.trims[2].points[0].x -= gap;
    let with = |edge: f64, vertex: Option<f64>, extent: f64| {
        let mut boundary = boundary.clone();
        boundary.trims[2].edge_tolerance = edge;
        boundary.trims[2].vertex_tolerance = vertex;
        build_to(&plane(10.0), 1e-7, extent, vec![boundary]).map(|region| region.repairs().wide_gaps.clone())
    };
    assert_eq!(with(1.1 * gap, None, 0.0), Ok(vec![]));
    assert_eq!(with(0.0, Some(0.51 * gap), 0.0), Ok(vec![]));
    assert_eq!(with(0.0, None, 1e4), Ok(vec![]));
    let refused = with(0.0, Some(0.49 * gap), 0.0).unwrap_err();
    assert!(matches!(refused, SceneError::TrimGap { face: 7, boundary: 0, trim: 2, .. }), "{refused}");
    // A modeller's face whose vertices' tolerances are lost: closed, and noted.
    let noted = with(0.0, None, 0.0).unwrap();
    assert!(noted.len() == 1 && noted[0].trim == 2 && (noted[0].gap - gap).abs() < 1e-9, "{noted:?}");
    // Nothing closes a gap that a picture shows.
    boundary.trims[2].points[0].x -= 0.03;
    let error = build_to(&plane(10.0), 1e-7, 0.0, vec![boundary]).unwrap_err();
    assert!(matches!(error, SceneError::TrimGap { trim: 2, .. }), "{error}");
}

#[test]
fn loops_that_cross_just_in_their_corners_cross() {
    let hole = polygon(false, &[(8.0, 3.0), (8.0, 5.0), (9.0, 5.0), (9.5, 4.0), (9.0, 3.0)]);
    let error = build(&plane(10.0), vec![square(true, 1.0, 9.0), hole]).unwrap_err();
    let SceneError::TrimsCross { at, .. } = error else { panic!("{error}") };
    let is_near = |corner: (f64, f64)| DVec2::from(at).distance(DVec2::from(corner)) < 1e-9;
    assert!(is_near((9.0, 3.0)) || is_near((9.0, 5.0)), "{at:?}");
    // The same corners from within: they touch.
    let hole = polygon(false, &[(8.0, 3.0), (8.0, 5.0), (9.0, 5.0), (8.5, 4.0), (9.0, 3.0)]);
    assert!((build(&plane(10.0), vec![square(true, 1.0, 9.0), hole]).unwrap().area() - 62.5).abs() < 1e-11);
}

#[test]
fn loops_that_cross_outside_the_domain_are_refused_with_the_place() {
    let bow_tie = polygon(true, &[(5.0, 2.0), (12.0, 2.0), (14.0, 8.0), (14.0, 2.0), (12.0, 8.0), (5.0, 8.0)]);
    let error = build(&plane(10.0), vec![bow_tie]).unwrap_err();
    let SceneError::TrimsCross { at, .. } = error else { panic!("{error}") };
    assert!(DVec2::from(at).distance(DVec2::new(13.0, 5.0)) < 1e-5, "{at:?}");
    let hole = polygon(false, &[(11.0, 4.0), (13.0, 4.0), (13.0, 5.0), (11.0, 5.0)]);
    let error = build(&plane(10.0), vec![rectangle(true, (5.0, 2.0), (12.0, 8.0)), hole]).unwrap_err();
    assert!(matches!(error, SceneError::TrimsCross { at: [12.0, _], .. }), "{error}");
}

#[test]
fn a_loop_without_place_in_the_domain_leaves_no_material() {
    let outside = vec![square(true, 12.0, 13.0)];
    assert_eq!(build(&plane(10.0), outside), Err(SceneError::NoMaterial { face: 7 }));
}

#[test]
fn a_loop_that_encloses_nothing_is_dropped_and_the_others_count() {
    let slit = polygon(false, &[(3.0, 3.0), (6.0, 5.0)]);
    let point = Loop { outer: false, trims: path(&[(4.0, 4.0), (4.0, 4.0)]) };
    let region = build(&plane(10.0), vec![slit.clone(), square(true, 1.0, 9.0), point]).unwrap();
    assert_eq!((region.area(), region.loops().len()), (64.0, 1));
    let mut dropped = region.repairs().dropped.clone();
    dropped.sort_unstable();
    assert_eq!(dropped, [0, 2]);
    // Without its outer loop nobody knows what the hole is in.
    let flat = Loop { outer: true, ..slit };
    let hole = backwards(square(false, 1.0, 9.0));
    assert_eq!(build(&plane(10.0), vec![flat, hole]), Err(SceneError::EmptyLoop { face: 7, boundary: 0 }));
}

#[test]
fn no_tolerance_closes_a_surface_that_is_open_nor_a_ring_that_goes_around() {
    for tolerance in [1e-3, 1.0, 10.0, 1e9] {
        let notch = rectangle(true, (5.0, 2.0), (13.0, 8.0));
        let region = build_to(&plane(10.0), tolerance, 0.0, vec![notch]).unwrap();
        assert!((region.area() - 30.0).abs() < 1e-9 && region.loops().len() == 1, "{tolerance}: {}", region.area());
        assert!(region.ends_at(0, 0) && region.ends_at(1, 1));
        let huge = rectangle(true, (-1e9, -1e9), (1e9, 1e9));
        assert!(build_to(&plane(10.0), tolerance, 0.0, vec![huge]).unwrap().is_whole());
        let rings = vec![ring(0.0, 0.2, true), ring(0.0, 0.7, false)];
        assert!((build_to(&cylinder(), tolerance, 0.0, rings).unwrap().area() - 2.0).abs() < 1e-9, "{tolerance}");
    }
}

#[test]
fn an_odd_number_of_rings_on_a_torus_bounds_nothing() {
    let at = |v: f64, forward: bool| ring(0.5, v, forward);
    let odd = SceneError::OddRings { face: 7, boundaries: vec![0] };
    assert_eq!(build(&torus(), vec![at(0.5, true)]), Err(odd));
    let three = vec![at(0.5, true), at(1.5, false), at(2.5, true)];
    assert!(matches!(build(&torus(), three), Err(SceneError::OddRings { .. })));
}

#[test]
fn loops_repeated_by_the_period_are_counted_before_and_must_not_overlap() {
    let wide = |reach: f64| rectangle(true, (-reach, 0.2), (reach, 0.8));
    let error = build(&cylinder(), vec![wide(4e5)]).unwrap_err();
    assert_eq!(error, SceneError::LoopReach { face: 7, boundary: 0, copies: 2e5, limit: 64 });
    let error = build(&cylinder(), vec![wide(6.0)]).unwrap_err();
    assert!(matches!(error, SceneError::LoopOverlap { face: 7, boundary: 0, .. }), "{error}");
    // A spiral of two turns that leaves room between them.
    let spiral = polygon(true, &[(0.0, 0.1), (8.0, 1.1), (8.0, 1.3), (0.0, 0.3)].map(|(u, v)| (u, 0.5 * v)));
    let region = build(&cylinder(), vec![spiral]).unwrap();
    assert!((region.area() - 0.8).abs() < 1e-12, "{}", region.area());
}

#[test]
fn hundreds_of_loops_that_coincide_take_no_time_by_the_square() {
    let start = std::time::Instant::now();
    for exact in [true, false] {
        let radius = |i: usize| if exact { 3.0 } else { 3.0 + 1e-9 * i as f64 };
        let loops = (0..100).map(|i| circle(i == 0, (5.0, 5.0), radius(i))).collect();
        assert!(build(&plane(10.0), loops).is_err());
    }
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    // A plate with a thousand holes is no such thing.
    let hole = |i: usize| backwards(circle(false, (0.15 + 0.3 * (i % 32) as f64, 0.15 + 0.3 * (i / 32) as f64), 0.1));
    let region = build(&plane(10.0), [square(true, 0.0, 10.0)].into_iter().chain((0..1000).map(hole)).collect());
    assert!((region.unwrap().area() - (100.0 - 10.0 * PI)).abs() < 1e-9);
}

/// Holes that touch a seam meet it thousands of times: they are looked at once each, and not once for each other one.
#[test]
fn holes_that_touch_a_seam_cost_no_more_than_others() {
    const HOLES: usize = 4000;
    let (side, height) = (0.3 / HOLES as f64, 1.0 / (HOLES + 1) as f64);
    let hole = |k: usize| {
        let v = (k + 1) as f64 * height;
        polygon(false, &[(0.0, v), (0.4, v + side), (0.8, v), (0.4, v - side)])
    };
    let outer = polygon(true, &[(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (0.0, 1.0)]);
    let start = std::time::Instant::now();
    let region = build(&cylinder(), [outer].into_iter().chain((0..HOLES).map(hole)).collect()).unwrap();
    assert!(start.elapsed().as_secs_f64() < 6.0, "{:?}", start.elapsed());
    assert!((region.area() - (4.0 - HOLES as f64 * 0.8 * side)).abs() < 1e-9, "{}", region.area());
}

#[test]
fn models_keep_regions_and_their_hash_knows_loops() {
    let model = |loops| Model::new("m", vec![plane(10.0)], vec![Face { loops, ..Face::whole(0) }]);
    let (a, b) = (model(vec![square(true, 1.0, 9.0)]).unwrap(), model(vec![square(true, 1.0, 8.0)]).unwrap());
    assert_eq!(a.region(scene::FaceId(0)).unwrap().area(), 64.0);
    let hashes = [a.hash(), b.hash(), model(vec![]).unwrap().hash()];
    assert!(hashes[0] != hashes[1] && hashes[1] != hashes[2] && hashes[0] != hashes[2]);
    assert!(matches!(
        model(vec![Loop { outer: true, trims: vec![] }]),
        Err(SceneError::EmptyLoop { face: 0, boundary: 0 })
    ));
}

/// A random star: `p` control points a side at growing angles, so that it cannot cross itself too wildly.
fn star(radii: &[f64], degree: usize, weights: &[f64]) -> Loop {
    let count = radii.len() / degree * degree;
    let point = |i: usize| {
        let angle = 2.0 * PI * i as f64 / count as f64;
        DVec2::splat(5.0) + radii[i % count] * DVec2::new(angle.cos(), angle.sin())
    };
    let points: Vec<DVec2> = (0..count).chain([0]).map(point).collect();
    let weights = (0..count).chain([0]).map(|i| weights[i % weights.len()]).collect();
    Loop { outer: true, trims: vec![trim(degree, points, Some(weights))] }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn random_rational_loops_have_the_area_of_their_polygons_limit(
        radii in prop::collection::vec(2.0f64..4.0, 12..40),
        weights in prop::collection::vec(0.3f64..3.0, 5),
        degree in 1usize..6,
        turned: bool,
    ) {
        let boundary = star(&radii, degree, &weights);
        let trim = &boundary.trims[0];
        let curve = nurbs::Curve::new(trim.knots.clone(), &trim.points, trim.weights.as_deref()).unwrap();
        let (start, end) = trim.knots.domain();
        let polygon = |count: usize| {
            let at = |i: usize| curve.point(start + (end - start) * i as f64 / count as f64) - DVec2::splat(5.0);
            (0..count).map(|i| 0.5 * at(i).perp_dot(at(i + 1))).sum::<f64>()
        };
        // Spans are cut evenly, so that the error falls by four: Richardson's limit of the two.
        let spans = trim.knots.spans().count();
        let (coarse, fine) = (polygon(spans * 200), polygon(spans * 400));
        let limit = fine + (fine - coarse) / 3.0;
        let boundary = if turned { backwards(boundary) } else { boundary };
        let region = build(&plane(10.0), vec![boundary]).unwrap();
        prop_assert!((region.area() - limit).abs() < 1e-6, "{} {limit}", region.area());
        prop_assert_eq!(region.repairs().reoriented.len(), usize::from(turned));
        prop_assert!(material(&region, 5.0, 5.0) && !material(&region, 0.5, 0.5));
    }
}

use super::*;
use crate::Meta;
use glam::DVec3;
use nurbs::Normal;
use scene::{FaceId, Projection, Viewport};
use serde_json::Value;

/// Side of the pictures.
const SIDE: usize = 24;

/// Places along each side of a pixel at which an area is sampled.
const SAMPLES: usize = 256;

/// Looks straight down at z = 0, where a pixel is a unit.
fn camera() -> Camera {
    let center = DVec3::new(SIDE as f64 / 2.0, SIDE as f64 / -2.0, 0.0);
    let projection = Projection::Orthographic { height: SIDE as f64 };
    Camera::look_at(center + 10.0 * DVec3::Z, center, DVec3::Y, projection).unwrap()
}

fn hit(face: u32, at: DVec2, depth: f64, edge: Option<DVec2>) -> Hit {
    Hit {
        face: FaceId(face),
        uv: at,
        local: None,
        t: depth,
        position: DVec3::new(at.x, -at.y, 10.0 - depth),
        normal: Normal::Regular(DVec3::Z),
        curvature: None,
        edge,
    }
}

fn buffer(pixel: impl Fn(DVec2) -> Option<Hit>) -> GBuffer {
    let viewport = Viewport::new(SIDE, SIDE).unwrap();
    let meta = Meta {
        renderer: "test".to_owned(),
        technique: "rays".to_owned(),
        trims: crate::Trims::Exact,
        model: String::new(),
        model_hash: String::new(),
        camera: Value::Null,
        adapter: None,
        driver: None,
        compiler: None,
        version: String::new(),
    };
    let row = |y: usize| (0..SIDE).map(|x| pixel(DVec2::new(x as f64 + 0.5, y as f64 + 0.5))).collect();
    GBuffer::from_rows(viewport, meta, (0..SIDE).map(row)).with_edges(true)
}

/// The foot of the perpendicular where it is within reach.
fn foot(offset: DVec2) -> Option<DVec2> {
    (offset.length() <= crate::EDGE_REACH_PX).then_some(offset)
}

/// The part of the pixel with its centre at `at` where `inside` holds, by samples.
fn area(at: DVec2, inside: impl Fn(DVec2) -> bool) -> f64 {
    let share = |k: usize| (k as f64 + 0.5) / SAMPLES as f64 - 0.5;
    let all = (0..SAMPLES * SAMPLES).map(|i| at + DVec2::new(share(i % SAMPLES), share(i / SAMPLES)));
    all.filter(|p| inside(*p)).count() as f64 / (SAMPLES * SAMPLES) as f64
}

fn part(mixture: &Mixture, of: impl Fn([usize; 2]) -> bool) -> f64 {
    mixture.parts.iter().filter(|(place, _)| of(*place)).map(|(_, part)| part).sum()
}

/// Straight lines at every slope, and at places that have nothing to do with pixels.
fn lines() -> impl Iterator<Item = (DVec2, f64)> {
    (0..60).map(|i| {
        let normal = DVec2::from_angle(f64::from(i) * 0.1047 + 1e-3);
        (normal, normal.dot(DVec2::splat(SIDE as f64 / 2.0)) + (f64::from(i) * 0.618).fract() - 0.5)
    })
}

#[test]
fn the_coverage_by_a_straight_edge_is_the_exact_area() {
    for i in 0..40 {
        for distance in [0.01, 0.2, 0.4, 0.5, 0.6, 0.7, 0.9] {
            let edge = distance * DVec2::from_angle(f64::from(i) * 0.157);
            let exact = area(DVec2::ZERO, |p| p.dot(edge) < distance * distance);
            assert!((coverage(edge) - exact).abs() <= SAMPLED, "{edge}: {} of {exact}", coverage(edge));
        }
    }
    assert_eq!((coverage(DVec2::ZERO), coverage(DVec2::X)), (0.5, 1.0));
}

/// How far sampling may leave an area from the exact one: a straight line passes through two samples a row at most.
const SAMPLED: f64 = 1.0 / SAMPLES as f64;

/// Every pixel that the line crosses, on either side, holds as much of the face as it should.
#[test]
fn a_face_that_ends_in_a_straight_edge_covers_the_exact_area_of_each_pixel() {
    for (normal, distance) in lines() {
        let buffer = buffer(|at| {
            let left = distance - normal.dot(at);
            (0.0 <= left).then(|| hit(0, at, 5.0, foot(left * normal)))
        });
        let (mut sum, mut exact_sum) = (0.0, 0.0);
        for y in 1..SIDE - 1 {
            for x in 1..SIDE - 1 {
                let mixture = buffer.mixture(&camera(), x, y);
                let covered = part(&mixture, |[x, y]| buffer.get(x, y).is_some());
                let exact = area(DVec2::new(x as f64 + 0.5, y as f64 + 0.5), |p| normal.dot(p) <= distance);
                assert!((covered - exact).abs() <= SAMPLED, "{normal} ({x}, {y}): {covered} of {exact}");
                sum += covered;
                exact_sum += exact;
            }
        }
        assert!((sum - exact_sum).abs() <= 0.02, "{normal}: {sum} of {exact_sum}");
    }
}

/// Red on one side, green beyond, on planes that lean; behind them nothing is to be seen.
#[test]
fn an_edge_that_two_faces_share_shows_these_two_alone_and_each_by_its_area() {
    for (normal, distance) in lines() {
        let buffer = buffer(|at| {
            let left = distance - normal.dot(at);
            let depth = 5.0 + 0.9 * at.x + 0.4 * left.abs();
            Some(hit(u32::from(left < 0.0), at, depth, foot(left * normal)))
        });
        for y in 1..SIDE - 1 {
            for x in 1..SIDE - 1 {
                let mixture = buffer.mixture(&camera(), x, y);
                let red = part(&mixture, |[x, y]| buffer.get(x, y).is_some_and(|hit| hit.face.0 == 0));
                let exact = area(DVec2::new(x as f64 + 0.5, y as f64 + 0.5), |p| normal.dot(p) <= distance);
                assert!((red - exact).abs() <= SAMPLED, "{normal} ({x}, {y}): {red} of {exact}");
                assert!((part(&mixture, |_| true) - 1.0).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn what_lies_behind_does_not_spill_over_what_is_nearer() {
    // The left half is far and ends at 12.3; the right half is near, whole, and begins at 12.
    let of = |near_depth: f64| {
        buffer(|at| {
            let left = 12.3 - at.x;
            Some(if at.x < 12.0 { hit(0, at, 5.0, foot(DVec2::new(left, 0.0))) } else { hit(1, at, near_depth, None) })
        })
    };
    let behind = of(2.0).mixture(&camera(), 12, 5);
    assert_eq!(behind.parts, [([12, 5], 1.0)]);
    let in_front = of(8.0).mixture(&camera(), 12, 5);
    assert!((part(&in_front, |[x, _]| x == 11) - 0.3).abs() < 1e-12, "{in_front:?}");
}

#[test]
fn light_is_blended_and_not_its_encoding() {
    let buffer = buffer(|at| (at.x < 12.0).then(|| hit(0, at, 5.0, foot(DVec2::new(11.5 - at.x, 0.0)))));
    let white_on_black =
        Picture::new(SIDE, SIDE, (0..SIDE * SIDE).map(|i| if i % SIDE < 12 { [255; 3] } else { [0; 3] }).collect())
            .unwrap();
    let resolved = buffer.resolved(&white_on_black, &camera()).unwrap();
    // Half the light of white is 188 in sRGB.
    assert_eq!([10, 11, 12].map(|x| resolved.pixel(x, 7)[0]), [255, 188, 0]);
    let small = Picture::new(1, 1, vec![[0; 3]]).unwrap();
    assert!(matches!(buffer.resolved(&small, &camera()), Err(GBufferError::PictureSizesDiffer { .. })));
    let plain = buffer.clone().with_edges(false);
    assert_eq!(plain.resolved(&white_on_black, &camera()).unwrap().width(), SIDE);
}

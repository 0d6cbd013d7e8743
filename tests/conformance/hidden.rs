//! What is shown of a surface that another part hides, beside the silhouette of that part: the judge excuses what is seen beside
//! the pixel, and nothing else.

use compare::{Cause, PairReport, Verdict};
use gbuffer::{GBuffer, Hit};
use glam::DVec3;
use isophote::stage::{Plan, Stage};
use nurbs::{KnotVector, Surface};
use pipeline::Parameters;
use raycast::Caster;
use scene::{Camera, Face, Model, Projection, Ray, Viewport};

const SIDE: usize = 32;
/// Pixels to a model unit.
const PIXELS: f64 = 8.0;
/// The pixel that is changed.
const AT: [usize; 2] = [16, 16];

/// A ribbon along y: seen from above an arch, its fold at x = 1; under it, from the left to beyond the fold, a sheet that climbs by
/// four model units to one; and under all, level, a floor.
fn ribbon() -> Model {
    let profile = [
        [0.0, 3.0],
        [2.0, 2.0],
        [0.0, 1.0],
        [-0.2, -3.0],
        [-0.5, -8.0],
        [1.0, -2.0],
        [2.5, 4.0],
        [3.0, -4.0],
        [3.0, -12.0],
        [1.0, -12.0],
        [-1.0, -12.0],
    ];
    let points = profile.iter().flat_map(|[x, z]| [-2.0, 2.0].map(|y| DVec3::new(*x, y, *z))).collect();
    let u = [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 5.0, 5.0, 5.0];
    let u = KnotVector::new(2, u.to_vec()).expect("sorted");
    let v = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("sorted");
    let surface = Surface::new(u, v, points, None).expect("legal");
    Model::new("ribbon".to_owned(), vec![surface], vec![Face::whole(0)]).expect("legal")
}

/// From above, with the fold as many pixels to the right of the centre of the pixel that is changed.
fn camera(fold_px: f64) -> Camera {
    let at = DVec3::new(1.0 - (0.5 + fold_px) / PIXELS, 0.0, 0.0);
    let projection = Projection::Orthographic { height: SIDE as f64 / PIXELS };
    Camera::look_at(at + 10.0 * DVec3::Z, at, DVec3::Y, projection).expect("legal")
}

/// What the judge says where the pixel shows the surface's `layer`, seen from the front, and all others what they should.
fn judged(fold_px: f64, layer: usize) -> PairReport {
    let model = ribbon();
    let viewport = Viewport::new(SIDE, SIDE).expect("a legal size");
    let stage = Stage::new(&model, camera(fold_px), viewport, Plan::default()).expect("a stage");
    let caster = Caster::new(&model);
    let raycast = stage.raycast(&caster);
    let ray = stage.camera.ray(viewport, AT[0] as f64 + 0.5, AT[1] as f64 + 0.5);
    let layers = caster.all(&ray).hits;
    let shown = drawn(&stage, &layers[layer], &ray);
    let raster = stage.raster();
    let row =
        |y: usize| (0..SIDE).map(|x| if [x, y] == AT { Some(shown) } else { raster.get(x, y).copied() }).collect();
    let changed = GBuffer::from_rows(viewport, raster.meta().clone(), (0..SIDE).map(row).collect::<Vec<_>>());
    stage.against_raycast(&caster, &raycast, &changed).expect("comparable")
}

/// What the judge says of a picture from so far away that shows what lies behind all else, in each pixel.
fn judged_from(distance: f64) -> PairReport {
    let model = ribbon();
    let viewport = Viewport::new(SIDE, SIDE).expect("a legal size");
    let projection = Projection::Orthographic { height: SIDE as f64 / PIXELS };
    let camera = Camera::look_at(distance * DVec3::Z, DVec3::ZERO, DVec3::Y, projection).expect("legal");
    let stage = Stage::new(&model, camera, viewport, Plan::default()).expect("a stage");
    let caster = Caster::new(&model);
    let raycast = stage.raycast(&caster);
    let farthest = |x: usize, y: usize| {
        let ray = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5);
        caster.all(&ray).hits.last().map(|hit| drawn(&stage, hit, &ray))
    };
    let rows = (0..SIDE).map(|y| (0..SIDE).map(|x| farthest(x, y)).collect::<Vec<_>>());
    let picture = GBuffer::from_rows(viewport, stage.meta("raster"), rows);
    stage.against_raycast(&caster, &raycast, &picture).expect("comparable")
}

/// What the program makes of a place that a ray meets.
pub(crate) fn drawn(stage: &Stage, hit: &Hit, ray: &Ray) -> Hit {
    let [[u0, u1], [v0, v1]] = stage.model.surface(hit.face).domain();
    let uv = [(hit.uv.x - u0) / (u1 - u0), (hit.uv.y - v0) / (v1 - v0)].map(|t| t as f32);
    let fragment = pipeline::fragment::fragment(&stage.scene, hit.face.0, Parameters::searched(uv), true);
    stage.scene.hit(&fragment, ray)
}

/// Layers of the ribbon left of its fold, after the arch.
const UNDERSIDE: usize = 1;
const CLIMBING: usize = 2;
const FLOOR: usize = 3;

/// Triangles fall short of the fold, and what climbs behind it is nearer beside the pixel than at it.
#[test]
fn a_sheet_that_climbs_into_view_beside_the_pixel_may_be_shown() {
    let report = judged(0.1, CLIMBING);
    assert_eq!(report.causes.len(), 0, "{:?}", report.worst);
}

#[test]
fn a_sheet_that_comes_into_view_a_pixel_away_is_hidden() {
    for fold_px in [0.4, 1.0, 2.0] {
        let report = judged(fold_px, CLIMBING);
        assert_eq!(report.causes.get(&Cause::Depth), Some(&1), "{fold_px}: {:?}", report.worst);
    }
}

#[test]
fn neither_the_far_side_nor_a_neighbouring_sheet_comes_into_view_where_another_does() {
    for (fold_px, layer) in [(0.1, FLOOR), (0.4, FLOOR), (0.4, UNDERSIDE), (1.0, UNDERSIDE)] {
        let report = judged(fold_px, layer);
        assert_eq!(report.causes.get(&Cause::Depth), Some(&1), "{fold_px}, {layer}: {:?}", report.worst);
    }
}

/// From ten million units away f32 tells no depths of this model apart. What it then shows may be what it must, but nobody knows:
/// only the columns agree in which there is nothing but the floor.
#[test]
fn where_depths_are_rounded_by_more_than_layers_are_apart_nothing_agrees() {
    let near = judged_from(1e2);
    assert!(near.causes.get(&Cause::Depth).is_some_and(|count| *count > 500), "{:?}", near.causes);
    for distance in [1e7, 1e8, 1e9] {
        let far = judged_from(distance);
        let (agree, covered) = (far.agree, far.covered);
        assert!(far.verdict != Verdict::Agree && agree <= covered / 6, "{distance}: {agree} of {covered}");
    }
}

//! The skirts of bounded faces: what a ray meets of a face, its triangles show, however the face's border is seen.

mod common;

use common::{Random, software};
use glam::{DVec2, DVec3};
use gpu::{Renderer, RendererOptions};
use nurbs::{KnotVector, Surface};
use pipeline::{PackedScene, Scheme};
use raster::Drawing;
use raycast::Caster;
use scene::{Camera, Face, FaceId, Loop, Model, Projection, Trim, Viewport};
use techniques::{Limits, Setting, Technique};

/// Pixels along the sides of a picture.
const SIDES: [usize; 2] = [48, 36];

fn clamped(degree: usize) -> KnotVector {
    KnotVector::new(degree, [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat()).expect("legal")
}

/// A surface with a loop along its whole border.
fn bounded(name: &str, surface: Surface) -> Model {
    let [[u0, u1], [v0, v1]] = surface.domain();
    let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]].map(DVec2::from_array);
    let line = |k: usize| Trim::new(clamped(1), vec![corners[k], corners[(k + 1) % 4]], None);
    let border = Loop { outer: true, trims: (0..4).map(line).collect() };
    Model::new(name, vec![surface], vec![Face { loops: vec![border], ..Face::whole(0) }]).expect("legal")
}

/// A third of a cylinder of radius 1 and length 1; u runs around.
fn cylinder() -> Model {
    let (sin, cos) = (std::f64::consts::PI / 3.0).sin_cos();
    let arc = [[cos, -sin, 1.0], [1.0 / cos, 0.0, cos], [cos, sin, 1.0]];
    let points = arc.iter().flat_map(|[x, y, _]| [0.0, 1.0].map(|z| DVec3::new(*x, *y, z))).collect();
    let weights = arc.iter().flat_map(|[_, _, w]| [*w; 2]).collect();
    bounded("cylinder", Surface::new(clamped(2), clamped(1), points, Some(weights)).expect("legal"))
}

/// A parabolic cylinder: its bound on the error is what its triangles are off, where it bends most.
fn trough() -> Model {
    let points = [[0.0, 0.5], [0.5, -0.7], [1.0, 0.5]];
    let points = points.iter().flat_map(|[x, z]| [0.0, 1.0].map(|y| DVec3::new(*x, y, *z))).collect();
    bounded("trough", Surface::new(clamped(2), clamped(1), points, None).expect("legal"))
}

/// A biquadratic patch over a square, bent along both diagonals.
fn bent() -> Model {
    let height = [[0.0, 0.25, 0.1], [0.2, 0.5, 0.3], [0.0, 0.3, -0.1]];
    let points = (0..9).map(|k| DVec3::new((k / 3) as f64 / 2.0, (k % 3) as f64 / 2.0, height[k / 3][k % 3])).collect();
    bounded("bent", Surface::new(clamped(2), clamped(2), points, None).expect("legal"))
}

fn plane() -> Model {
    let points = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.2 * x + 0.1 * y));
    bounded("plane", Surface::new(clamped(1), clamped(1), points.to_vec(), None).expect("legal"))
}

/// A view of a place on a border, across it and 1 to 10 degrees off the surface there.
fn grazing(model: &Model, random: &mut Random) -> Camera {
    let surface = model.surface(FaceId(0));
    let along = random.between(0.2, 0.8);
    let side = (random.unit() * 4.0) as usize;
    let at = if side < 2 { [side as f64, along] } else { [along, (side - 2) as f64] };
    let d = surface.first_derivatives(at[0], at[1]);
    let border = if side < 2 { d.sv } else { d.su }.normalize();
    let normal = d.su.cross(d.sv).normalize();
    let sign = |t: f64| if t < 0.5 { -1.0 } else { 1.0 };
    let turn = random.between(-0.5, 0.5);
    let across = normal.cross(border) * turn.cos() + border * turn.sin();
    let angle = random.between(1.0, 10.0f64).to_radians() * sign(random.unit());
    let away = across * sign(random.unit()) * angle.cos() + normal * angle.sin();
    let (distance, height) = (4.0, random.between(0.4, 1.6));
    let projection = if random.unit() < 0.5 {
        Projection::Orthographic { height }
    } else {
        Projection::Perspective { fov_deg: 2.0 * (0.5 * height / distance).atan().to_degrees() }
    };
    let up = DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    Camera::look_at(d.s + away * distance, d.s, up, projection).expect("legal")
}

/// Whether the face turns away within the error of a place in the picture, or within a cell of what is seen there: beyond a fold
/// triangles may fall short, and where one meets a border the skirt turns over.
fn has_fold_near(seen: &Seen, center: DVec2, uv: DVec2, cell: [f64; 2]) -> bool {
    let Seen { caster, camera, viewport, px } = *seen;
    let surface = caster.model().surface(FaceId(0));
    let towards = |k: usize| {
        let at = DVec2::new((k / 201) as f64, (k % 201) as f64) / 200.0;
        let d = surface.first_derivatives(at.x, at.y);
        let picture = camera.picture(viewport, d.s).expect("in front");
        let ray = camera.ray(viewport, picture.x, picture.y);
        let is_near = picture.distance(center) <= 1.25 * px || (0..2).all(|k| (at[k] - uv[k]).abs() <= cell[k]);
        is_near.then(|| d.su.cross(d.sv).dot(ray.direction) < 0.0)
    };
    let mut near = (0..201 * 201).filter_map(towards);
    let first = near.next();
    near.any(|other| Some(other) != first)
}

/// A face, and who sees it.
struct Seen<'a> {
    caster: &'a Caster<'a>,
    camera: &'a Camera,
    viewport: Viewport,
    /// The error.
    px: f64,
}

/// What is wrong in a picture of a bounded face, pixel by pixel.
#[derive(Debug, Default)]
struct Wrong {
    /// Pixels that were judged.
    judged: usize,
    /// The ray caster sees the face, and nothing is shown.
    missing: Vec<DVec2>,
    /// The face is shown, and no ray near by meets it.
    strange: Vec<DVec2>,
}

impl Wrong {
    fn add(&mut self, view: &Seen, cell: [f64; 2], is_shown: impl Fn(usize) -> bool) {
        let Seen { caster, camera, viewport, px } = *view;
        let all = |at: DVec2| caster.all(&camera.ray(viewport, at.x, at.y)).hits;
        let hits = |at: DVec2| all(at).len();
        for pixel in 0..viewport.pixels() {
            let center = DVec2::new((pixel % SIDES[0]) as f64 + 0.5, (pixel / SIDES[0]) as f64 + 0.5);
            let near = |radius: f64| {
                (0..16).map(move |k| center + radius * DVec2::from_angle(std::f64::consts::TAU * k as f64 / 16.0))
            };
            let (seen, is_shown) = (hits(center), is_shown(pixel));
            self.judged += seen.min(1);
            if seen == 1 && !is_shown && !has_fold_near(view, center, all(center)[0].uv, cell) {
                self.missing.push(center);
            }
            let rings = || [0.25, 0.5, 1.0, 1.25].into_iter().flat_map(|k| near(k * px));
            if seen == 0 && is_shown && !rings().any(|at| hits(at) > 0) {
                self.strange.push(center);
            }
        }
    }
}

/// The three techniques by triangles, on the CPU and on a device.
fn seen_at_a_slant(model: &Model, views: usize) -> [Wrong; 2] {
    let device = software();
    let viewport = Viewport::new(SIDES[0], SIDES[1]).expect("a legal size");
    let scene = PackedScene::new(model, Scheme::Specialised).expect("it packs");
    let caster = Caster::new(model);
    let mut random = Random(3);
    let mut wrong = [Wrong::default(), Wrong::default()];
    for (view, chord_px) in (0..views).flat_map(|view| [0.25, 0.5].map(|chord_px| (view, chord_px))) {
        let camera = grazing(model, &mut random);
        let techniques: [&dyn Technique; 3] =
            [&techniques::fragment::Fragment, &techniques::grid::Grid, &techniques::zones::ByZones];
        let technique = techniques[view % 3];
        let setting = Setting {
            model,
            scene: &scene,
            camera: &camera,
            viewport,
            chord_px,
            limits: Limits::default(),
            vertex_normals: false,
        };
        let prepared = technique.prepare(&setting).expect("few triangles");
        let views = scene.views(model, &camera, viewport);
        let drawing = Drawing { scene: &scene, views: &views, camera: &camera, viewport, options: Default::default() };
        let visibility = prepared.visibility(drawing);
        let samples = visibility.samples();
        let by_raster = |pixel: usize| {
            let (x, y) = ((pixel % SIDES[0]) as f64 + 0.5, (pixel / SIDES[0]) as f64 + 0.5);
            !samples.layers(x, y).is_empty()
        };
        let mut renderer = Renderer::new(&device, &scene, &*prepared, RendererOptions::default()).expect("it fits");
        let fragments = renderer.fragments(&views, viewport).expect("drawn");
        let seen = Seen { caster: &caster, camera: &camera, viewport, px: chord_px };
        let cell = prepared.cells()[0][0].sizes[0];
        wrong[0].add(&seen, cell, by_raster);
        wrong[1].add(&seen, cell, |pixel| fragments[pixel].is_some());
    }
    wrong
}

#[test]
fn a_bounded_face_seen_at_a_slant_shows_every_pixel_whose_ray_meets_it() {
    for model in [plane(), cylinder(), trough(), bent()] {
        for wrong in seen_at_a_slant(&model, 6) {
            assert!(wrong.judged > 1000 && wrong.missing.is_empty(), "{}: {wrong:?}", model.name());
            assert!(wrong.strange.is_empty(), "{}: {wrong:?}", model.name());
        }
    }
}

#[test]
fn a_picture_that_lacks_pixels_or_has_too_many_is_found_out() {
    let model = trough();
    let viewport = Viewport::new(SIDES[0], SIDES[1]).expect("a legal size");
    let (camera, caster) = (Camera::framing(&model, viewport), Caster::new(&model));
    let seen = Seen { caster: &caster, camera: &camera, viewport, px: 0.25 };
    let [mut sparse, mut all] = [Wrong::default(), Wrong::default()];
    sparse.add(&seen, [0.01; 2], |pixel| pixel % 29 > 0);
    all.add(&seen, [0.01; 2], |_| true);
    assert!(sparse.judged > 100 && 60 * sparse.missing.len() > sparse.judged, "{sparse:?}");
    assert!(all.missing.is_empty() && all.strange.len() > 100, "{all:?}");
}

//! Technique `grid`: where its corners are; and that patches of `grid` and of `fragment` meet vertex on vertex.

mod common;

use common::{Random, software};
use glam::DVec3;
use gpu::{Drawable, Renderer, RendererOptions};
use nurbs::{Direction, KnotVector, Surface};
use pipeline::{PackedScene, Scheme};
use raster::Drawing;
use scene::{Camera, FaceId, Model, Projection, Viewport};
use std::collections::BTreeSet;
use techniques::fragment::Fragment;
use techniques::grid::{Grid, Grids};
use techniques::{Limits, Prepared, Setting, Technique};

const TECHNIQUES: [&dyn Technique; 2] = [&Grid, &Fragment];

fn setting<'a>(
    model: &'a Model,
    scene: &'a PackedScene,
    camera: &'a Camera,
    viewport: Viewport,
    chord_px: f64,
) -> Setting<'a> {
    Setting { model, scene, camera, viewport, chord_px, limits: Limits::default(), vertex_normals: false }
}

fn grids(model: &Model, error_px: f64) -> (PackedScene, Grids) {
    let viewport = Viewport::new(256, 256).expect("a legal size");
    let camera = Camera::framing(model, viewport);
    let scene = PackedScene::new(model, Scheme::Specialised).expect("it packs");
    let grids = Grids::new(&setting(model, &scene, &camera, viewport, error_px)).expect("few triangles");
    (scene, grids)
}

#[test]
fn every_corner_is_on_its_face_at_its_own_parameters() {
    for name in ["teapot", "torus", "sphere", "surface", "rational", "spray"] {
        let model = models::builtin(name).expect("built in");
        let (scene, grids) = grids(&model, 0.25);
        for vertex in &grids.picture.mesh.vertices {
            let surface = model.surface(FaceId(vertex.face));
            let uv = scene.frames()[vertex.face as usize].uv(vertex.span, vertex.uv);
            let expected = surface.point(uv.x, uv.y);
            let found = scene.frames()[vertex.frame as usize].world(vertex.position);
            let size = model.hull().diagonal();
            assert!(found.distance(expected) < 1e-5 * size, "{name}: {vertex:?} at {found}, not {expected}");
        }
    }
}

/// Flat triangles against the surface at 36 places of each.
#[test]
fn no_triangle_is_farther_from_its_face_than_the_chord_says() {
    let viewport = Viewport::new(256, 256).expect("a legal size");
    for name in ["teapot", "torus", "sphere", "surface", "rational"] {
        let model = models::builtin(name).expect("built in");
        let camera = Camera::framing(&model, viewport);
        let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
        for (technique, error_px) in TECHNIQUES.iter().flat_map(|technique| [(technique, 0.25), (technique, 2.0)]) {
            let setting = setting(&model, &scene, &camera, viewport, error_px);
            let prepared = technique.prepare(&setting).expect("few triangles");
            let mesh = prepared.mesh().expect("triangles");
            for corners in mesh.indices.chunks_exact(3) {
                let corners = [0, 1, 2].map(|k| mesh.vertices[corners[k] as usize]);
                let (face, span) = (corners[0].face, corners[0].span);
                let frame = &scene.frames()[face as usize];
                let positions = corners.map(|v| scene.frames()[v.frame as usize].world(v.position));
                let index = span[0] as usize * (frame.breaks[1].len() - 1) + span[1] as usize;
                let chord = prepared.chord()[face as usize][index];
                for (i, j) in (0..8).flat_map(|i| (0..8 - i).map(move |j| (i, j))) {
                    let weights = [f64::from(i) / 7.0, f64::from(j) / 7.0, f64::from(7 - i - j) / 7.0];
                    let flat: glam::DVec3 = (0..3).map(|k| positions[k] * weights[k]).sum();
                    let uv = [0, 1].map(|c| (0..3).map(|k| f64::from(corners[k].uv[c]) * weights[k]).sum::<f64>());
                    let [u, v] = [0, 1].map(|k| {
                        let [start, end] = frame.span(k, span[k]);
                        start + (end - start) * uv[k]
                    });
                    let off = flat.distance(model.surface(FaceId(face)).point(u, v));
                    assert!(off <= chord, "{name}, {technique:?}, {error_px} px: {off} beyond {chord} at {corners:?}");
                }
            }
        }
    }
}

fn direction(random: &mut Random) -> DVec3 {
    let z = 2.0 * random.unit() - 1.0;
    let angle = std::f64::consts::TAU * random.unit();
    DVec3::new((1.0 - z * z).sqrt() * angle.cos(), (1.0 - z * z).sqrt() * angle.sin(), z)
}

/// The surface with u and v exchanged, or with u turned round.
fn turned(surface: &Surface, transposed: bool) -> Surface {
    let [rows, columns] = surface.control_counts();
    let [ku, kv] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
    let order: Vec<usize> = if transposed {
        (0..columns).flat_map(|j| (0..rows).map(move |i| i * columns + j)).collect()
    } else {
        (0..rows).rev().flat_map(|i| (0..columns).map(move |j| i * columns + j)).collect()
    };
    let points = order.iter().map(|&k| surface.points()[k]).collect();
    let weights = surface.weights().map(|weights| order.iter().map(|&k| weights[k]).collect());
    let (u0, u1) = ku.domain();
    let backwards = ku.knots().iter().rev().map(|t| u0 + u1 - t).collect();
    let [ku, kv] = if transposed { [kv, ku] } else { [KnotVector::new(ku.degree(), backwards).expect("legal"), kv] };
    Surface::new(ku, kv, points, weights).expect("as legal as before")
}

/// A closed surface in six pieces, each a face in coordinates of its own, whose parameters run in all ways.
fn in_pieces(name: &str) -> Model {
    let whole = models::builtin(name).expect("built in").surfaces()[0].clone();
    let [[u0, u1], [v0, v1]] = whole.domain();
    let at = |[a, b]: [f64; 2], t: f64| a + (b - a) * t;
    let [low, rest] = whole.split(Direction::U, at([u0, u1], 0.3)).expect("inside");
    let [middle, high] = rest.split(Direction::U, at([u0, u1], 0.71)).expect("inside");
    let halves = [low, middle, high].map(|strip| strip.split(Direction::V, at([v0, v1], 0.45)).expect("inside"));
    let surfaces = halves.into_iter().flatten().enumerate();
    let turned = surfaces.map(|(k, surface)| match k % 3 {
        0 => surface,
        1 => turned(&surface, true),
        _ => turned(&surface, false),
    });
    Model::of_surfaces(name, turned.collect()).expect("faces")
}

/// How many positions of so many views a ray of which meets an odd number of triangles: a closed mesh is left as often as it is
/// entered. `levels` collects those of grids.
fn odd_positions(
    model: &Model,
    technique: &dyn Technique,
    views: usize,
    vertex_normals: bool,
    levels: &mut BTreeSet<[u32; 2]>,
) -> usize {
    let viewport = Viewport::new(64, 64).expect("a legal size");
    let scene = PackedScene::new(model, Scheme::Specialised).expect("it packs");
    let mut random = Random(7);
    let mut odd = 0;
    let size = model.hull().diagonal();
    for _ in 0..views {
        let eye = model.hull().center() + direction(&mut random) * size * (0.8 + random.unit());
        let target = model.hull().center() + direction(&mut random) * size * 0.2;
        let projection = Projection::Perspective { fov_deg: 40.0 };
        let Ok(camera) = Camera::look_at(eye, target, direction(&mut random), projection) else { continue };
        let chord_px = 40.0f64.powf(random.unit()) * 0.05;
        let setting = Setting { vertex_normals, ..setting(model, &scene, &camera, viewport, chord_px) };
        let prepared = technique.prepare(&setting).expect("prepared");
        if let Ok(grids) = (&*prepared as &dyn Drawable).of::<Grids>("grid") {
            levels.extend(grids.picture.records.iter().map(|record| record.level));
        }
        let cameras_views = scene.views(model, &camera, viewport);
        let drawing =
            Drawing { scene: &scene, views: &cameras_views, camera: &camera, viewport, options: Default::default() };
        let visibility = prepared.visibility(drawing);
        let samples = visibility.samples();
        for pixel in 0..viewport.pixels() {
            let (x, y) = ((pixel % 64) as f64 + 0.5, (pixel / 64) as f64 + 0.5);
            odd += samples.layers(x, y).len() % 2;
        }
    }
    odd
}

#[test]
fn a_closed_surface_in_pieces_has_no_crack_at_any_mix_of_levels() {
    let mut levels = BTreeSet::new();
    for name in ["torus", "sphere"] {
        let model = in_pieces(name);
        let odd = TECHNIQUES.map(|technique| odd_positions(&model, technique, 100, false, &mut levels));
        assert_eq!(odd, [0, 0], "{name}");
    }
    assert!(levels.len() > 12, "{levels:?}");
}

/// Floors are those of patches, and other faces have other ones along a border that they share.
#[test]
fn least_levels_for_normals_at_corners_open_no_crack() {
    let mut levels = BTreeSet::new();
    for name in ["torus", "sphere"] {
        let model = in_pieces(name);
        let odd = TECHNIQUES.map(|technique| odd_positions(&model, technique, 30, true, &mut levels));
        assert_eq!(odd, [0, 0], "{name}");
    }
    assert!(levels.len() > 12, "{levels:?}");
}

/// The device draws what the twin draws, in which no ray passes between two grids: every pixel shows the same side of the body.
#[test]
fn no_pixel_of_the_device_shows_what_lies_behind_a_closed_surface() {
    let device = software();
    let viewport = Viewport::new(48, 48).expect("a legal size");
    for name in ["torus", "sphere"] {
        let model = in_pieces(name);
        let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
        let (size, center) = (model.hull().diagonal(), model.hull().center());
        let mut random = Random(11);
        let looks = |random: &mut Random| {
            let eye = center + direction(random) * size * (0.55 + random.unit());
            let projection = Projection::Perspective { fov_deg: 40.0 };
            Camera::look_at(eye, center + direction(random) * size * 0.2, direction(random), projection).expect("legal")
        };
        let (mut levels, mut covered) = (BTreeSet::new(), 0);
        for error_px in [0.1, 1.0, 6.0] {
            let camera = looks(&mut random);
            let grids = Grids::new(&setting(&model, &scene, &camera, viewport, error_px)).expect("few triangles");
            let mut renderer = Renderer::new(&device, &scene, &grids, RendererOptions::default()).expect("it fits");
            for _ in 0..34 {
                let camera = looks(&mut random);
                let views = scene.views(&model, &camera, viewport);
                let seen = grids.seen(&scene, &views);
                levels.extend(seen.records.iter().map(|record| record.level));
                let drawing =
                    Drawing { scene: &scene, views: &views, camera: &camera, viewport, options: Default::default() };
                let visibility = grids.visibility(drawing);
                let samples = visibility.samples();
                for (pixel, fragment) in renderer.fragments(&views, viewport).expect("drawn").iter().enumerate() {
                    let (x, y) = ((pixel % 48) as f64 + 0.5, (pixel / 48) as f64 + 0.5);
                    let nearest =
                        |x: f64, y: f64| samples.layers(x, y).iter().map(|seen| seen.depth).fold(0.0, f32::max);
                    let nearest_here = nearest(x, y);
                    // Along an outline the two may take a pixel differently.
                    let is_alike = |(i, j): (f64, f64)| (nearest(x + i, y + j) / nearest_here - 1.0).abs() < 0.02;
                    let around = [(-0.5, 0.0), (0.4, 0.0), (0.0, -0.5), (0.0, 0.4)];
                    if nearest_here == 0.0 || !around.into_iter().all(is_alike) {
                        continue;
                    }
                    let fragment = fragment.unwrap_or_else(|| panic!("{name}, {error_px} px: nothing at ({x}, {y})"));
                    let nearest = nearest_here;
                    covered += 1;
                    let position = scene.frames()[fragment.face as usize].world(fragment.position);
                    let depth = camera.near() / camera.depth(position);
                    // The far side of the body is a tenth of its size away, or more.
                    let off = (depth / f64::from(nearest) - 1.0).abs() * camera.depth(position);
                    assert!(off < 0.05 * size, "{name}, {error_px} px at ({x}, {y}): {off}");
                }
            }
        }
        assert!(levels.len() > 12 && covered > 30_000, "{levels:?}, {covered}");
    }
}

/// Where a border runs along a part of another one, each face has corners of its own.
#[test]
fn borders_that_are_not_whole_leave_cracks() {
    let whole = models::builtin("torus").expect("built in").surfaces()[0].clone();
    let [[u0, u1], [v0, v1]] = whole.domain();
    let strips = whole.split(Direction::U, u0 + 0.3 * (u1 - u0)).expect("inside");
    let at = |t: f64| v0 + t * (v1 - v0);
    let halves =
        [(0, 0.45), (1, 0.6)].map(|(k, t): (usize, f64)| strips[k].split(Direction::V, at(t)).expect("inside"));
    let model = Model::of_surfaces("torus", halves.into_iter().flatten().collect()).expect("faces");
    let odd = TECHNIQUES.map(|technique| odd_positions(&model, technique, 20, false, &mut BTreeSet::new()));
    assert!(odd.iter().all(|odd| *odd > 0), "the check finds no crack where there are some: {odd:?}");
}

/// A cubic border between two ends of which another face has a straight one.
#[test]
fn borders_of_other_degrees_between_the_same_ends_are_not_taken_for_one() {
    let knots = |degree: usize| {
        let ends = std::iter::repeat_n(0.0, degree + 1).chain(std::iter::repeat_n(1.0, degree + 1));
        KnotVector::new(degree, ends.collect()).expect("legal")
    };
    let row = |y: f64, bend: f64| [(0.0, 0.0), (1.0, bend), (2.0, bend), (3.0, 0.0)].map(|(x, z)| DVec3::new(x, y, z));
    let curved = Surface::new(knots(1), knots(3), [row(0.0, 1.0), row(1.0, 1.0)].concat(), None).expect("legal");
    let ends = [row(1.0, 0.0), row(2.0, 0.0)].map(|row| [row[0], row[3]]).concat();
    let flat = Surface::new(knots(1), knots(1), ends, None).expect("legal");
    let model = Model::of_surfaces("two degrees", vec![curved, flat]).expect("faces");
    for vertex in &grids(&model, 0.25).1.picture.mesh.vertices {
        assert!(vertex.frame == vertex.face || vertex.uv.iter().all(|t| *t == 0.0 || *t == 1.0), "{vertex:?}");
    }
}

/// A weight that is a thousand times the others' cuts its patch into parts: then there are more grids, and all are uploaded.
#[test]
fn an_edit_shows_on_the_device_what_the_edited_model_shows() {
    let device = software();
    let model = models::builtin("rational").expect("built in");
    let surface = &model.surfaces()[0];
    let middle = surface.points().len() / 2;
    let [u, v] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
    let edited = |weight: f64| {
        let mut weights = surface.weights().expect("rational").to_vec();
        weights[middle] *= weight;
        let heavy = Surface::new(u.clone(), v.clone(), surface.points().to_vec(), Some(weights));
        model.with_surface(0, heavy.expect("as legal as before"))
    };
    let viewport = Viewport::new(256, 256).expect("a legal size");
    for (weight, most) in [(1.1, 6000), (1000.0, 4_000_000)] {
        let model_after = edited(weight);
        let camera = Camera::framing(&model_after, viewport);
        let made = |model: &Model| {
            let scene = PackedScene::new(model, Scheme::Specialised).expect("it packs");
            let grids = Grids::new(&setting(model, &scene, &camera, viewport, 2.0)).expect("few triangles");
            let views = scene.views(model, &camera, viewport);
            (scene, grids, views)
        };
        let (before, after) = (made(&model), made(&model_after));
        let mut renderer = Renderer::new(&device, &before.0, &before.1, RendererOptions::default()).expect("it fits");
        renderer.fragments(&before.2, viewport).expect("drawn");
        let written = renderer.edit((&before.0, &before.1), (&after.0, &after.1)).expect("uploaded");
        assert!(written > 0 && written < most, "{written} bytes for a weight of {weight}");
        let mut fresh = Renderer::new(&device, &after.0, &after.1, RendererOptions::default()).expect("it fits");
        let [shown, expected] =
            [&mut renderer, &mut fresh].map(|renderer| renderer.fragments(&after.2, viewport).expect("drawn"));
        assert!(shown == expected, "a weight of {weight}");
    }
}

//! Technique `exact` on the software adapter: what its kernels keep of many pieces at one pixel.

use crate::models::assorted;
use crate::picture::{CURVATURE, Shot, from_above, square};
use crate::software;
use crate::twin::differences;
use gbuffer::{ShadeKind, Shading};
use glam::DVec3;
use gpu::{DepthOrder, GpuError, Overrides, Renderer, RendererOptions};
use pipeline::fragment::fragment;
use pipeline::{PackedScene, Parameters, Scheme};
use scene::{Camera, FaceId, Model, Projection, Viewport};
use techniques::exact::Hulls;
use techniques::fragment::Tessellation;

fn hulls(model: Model, scheme: Scheme, camera: Camera, viewport: Viewport) -> Shot<Hulls> {
    let scene = PackedScene::new(&model, scheme).unwrap();
    let drawn = Hulls::new(&model, &scene, &camera, viewport).unwrap();
    Shot { model, scene, drawn, camera, viewport }
}

/// Squares one above the other, the lowest drawn first: each hides what was met before it.
fn stack(count: usize) -> Shot<Hulls> {
    let squares = (0..count).map(|i| square(i as f64 / count as f64)).collect();
    let model = Model::of_surfaces("stack", squares).unwrap();
    hulls(model, Scheme::Specialised, from_above(1.5), Viewport::new(48, 32).unwrap())
}

fn with_depth(depth: DepthOrder) -> RendererOptions<'static> {
    RendererOptions { overrides: Overrides { depth, ..Overrides::default() }, ..CURVATURE }
}

#[test]
fn every_fragment_has_the_bits_of_the_program_in_rust_at_its_own_parameters() {
    let device = software();
    let viewport = Viewport::new(48, 40).unwrap();
    for scheme in [Scheme::General, Scheme::Specialised] {
        let model = assorted(7);
        let camera = Camera::framing(&model, viewport);
        let shot = hulls(model, scheme, camera, viewport);
        let mut renderer = Renderer::new(&device, &shot.scene, &shot.drawn, CURVATURE).unwrap();
        let fragments = renderer.fragments(&shot.views(), viewport).unwrap();
        let drawn: Vec<_> = fragments.iter().flatten().collect();
        assert!(drawn.len() > 300, "{} pixels drawn", drawn.len());
        for f in drawn {
            let expected = fragment(&shot.scene, f.face, Parameters { span: f.span, uv: f.uv }, true);
            assert_eq!(differences(f, &expected), [""; 0], "{f:?} is not {expected:?}");
        }
    }
}

/// The squares take 32 rows' two thirds of 48 columns; there is room at first for two meetings a pixel of the picture.
#[test]
fn the_nearest_of_more_pieces_than_there_is_room_for_at_first_is_seen() {
    let device = software();
    let shot = stack(24);
    for (depth, seen) in [(DepthOrder::Nearest, FaceId(23)), (DepthOrder::Farthest, FaceId(0))] {
        let gbuffer = shot.gbuffer(&device, with_depth(depth)).unwrap();
        assert!(gbuffer.covered() > 400, "{} pixels covered", gbuffer.covered());
        for (index, hit) in gbuffer.pixels().enumerate() {
            assert!(hit.is_none_or(|hit| hit.face == seen), "{depth:?}, pixel {index}: {hit:?}");
        }
    }
}

#[test]
fn at_equal_depth_the_piece_drawn_first_stays() {
    let squares = (0..9).map(|_| square(0.25)).collect();
    let model = Model::of_surfaces("nine times", squares).unwrap();
    let shot = hulls(model, Scheme::Specialised, from_above(1.0), Viewport::new(24, 24).unwrap());
    let gbuffer = shot.gbuffer(&software(), CURVATURE).unwrap();
    assert_eq!(gbuffer.covered(), 24 * 24);
    assert!(gbuffer.pixels().flatten().all(|hit| hit.face == FaceId(0)));
}

/// The eye stands half a unit above the middle of an edge and looks along the square: half of the hull is behind it.
#[test]
fn a_hull_that_reaches_behind_the_eye_is_seen_where_the_plane_is() {
    let perspective = Projection::Perspective { fov_deg: 60.0 };
    let camera = Camera::look_at(DVec3::new(0.0, 0.0, 0.1), DVec3::new(0.5, 0.0, 0.0), DVec3::Z, perspective).unwrap();
    let model = Model::of_surfaces("square", vec![square(0.0)]).unwrap();
    let shot = hulls(model, Scheme::Specialised, camera, Viewport::new(40, 40).unwrap());
    let gbuffer = shot.gbuffer(&software(), CURVATURE).unwrap();
    for y in 0..40 {
        for x in 0..40 {
            let ray = shot.camera.ray(shot.viewport, x as f64 + 0.5, y as f64 + 0.5);
            let down = ray.at(1.0).z - ray.at(0.0).z;
            let place = ray.at(ray.at(0.0).z / -down);
            let inside = down < 0.0 && place.x.abs() < 0.5 && place.y.abs() < 0.5;
            assert_eq!(gbuffer.get(x, y).is_some(), inside, "pixel ({x}, {y}), {place}");
        }
    }
    assert!(gbuffer.covered() > 400, "{} pixels covered", gbuffer.covered());
}

#[test]
fn a_picture_is_the_same_every_time_and_the_same_after_other_pieces() {
    let device = software();
    let shot = stack(5);
    let other = Hulls::new(&shot.model, &shot.scene, &from_above(4.0), shot.viewport).unwrap();
    let mut renderer = Renderer::new(&device, &shot.scene, &shot.drawn, CURVATURE).unwrap();
    let first = renderer.fragments(&shot.views(), shot.viewport).unwrap();
    assert!(renderer.fragments(&shot.views(), shot.viewport).unwrap() == first);
    renderer.set(&other).unwrap();
    assert!(renderer.fragments(&shot.views(), shot.viewport).unwrap().iter().any(Option::is_some));
    renderer.set(&shot.drawn).unwrap();
    assert!(renderer.fragments(&shot.views(), shot.viewport).unwrap() == first);
    let empty_batches = shot.drawn.mesh.batches.iter().map(|b| pipeline::Batch { count: 0, ..*b }).collect();
    let mut without = shot.drawn.clone();
    without.mesh.batches = empty_batches;
    renderer.set(&without).unwrap();
    assert!(renderer.fragments(&shot.views(), shot.viewport).unwrap().iter().all(Option::is_none));
    let triangles = Tessellation::uniform(&shot.model, &shot.scene, 1).unwrap();
    let expected = GpuError::Technique { expected: "exact", found: "fragment" };
    assert_eq!(renderer.set(&triangles), Err(expected));
}

/// The first frame looks past the stack, so only later ones need more room.
#[test]
fn timing_counts_the_frames_asked_for_however_many_pieces_a_later_one_meets() {
    let device = software();
    let shot = stack(24);
    let past = Camera::look_at(
        DVec3::new(9.0, 0.0, 5.0),
        DVec3::new(9.0, 0.0, 0.0),
        DVec3::Y,
        Projection::Orthographic { height: 1.5 },
    );
    let away = shot.scene.views(&shot.model, &past.unwrap(), shot.viewport);
    let mut renderer = Renderer::new(&device, &shot.scene, &shot.drawn, RendererOptions::default()).unwrap();
    let uniform = Shading::new(ShadeKind::Phong).uniform(&shot.camera, 1.0);
    let timing = renderer.time_shaded(&[away, shot.views(), shot.views()], &uniform, shot.viewport).unwrap();
    assert_eq!(timing.frames, 3);
    assert_eq!(timing.gpu_s.map(|s| s.len()), device.has_timestamps().then_some(3));
}

#[test]
fn a_shader_without_its_kernel_is_refused_with_its_name() {
    let device = software();
    let shot = stack(1);
    let source = |variant| pipeline::wgsl::source(variant).replace("fn meet_large(", "fn meet_other(");
    let overrides = Overrides { source: Some(&source), ..Overrides::default() };
    let error = shot.gbuffer(&device, RendererOptions { overrides, ..CURVATURE }).unwrap_err();
    assert!(matches!(&error, GpuError::Shader { entry: "meet_large", .. }), "{error}");
}

//! Whole pictures on the software adapter.

use crate::models::{Random, assorted, sheet};
use crate::software;
use crate::twin::differences;
use gbuffer::{GBuffer, Hit, Meta, ShadeInput, ShadeKind, Shading, background, shade_tolerant};
use glam::DVec3;
use gpu::{DepthOrder, Device, Drawable, MaskBlend, Overrides, Renderer, RendererOptions};
use nurbs::{KnotVector, Normal, Surface};
use pipeline::fragment::fragment;
use pipeline::wgsl::{self, Variant};
use pipeline::{PackedScene, Parameters, Scheme};
use scene::{Camera, FaceId, Model, Projection, Viewport};
use techniques::fragment::Tessellation;

pub(crate) const CURVATURE: RendererOptions<'static> = RendererOptions {
    curvature: true,
    vertex_normals: false,
    overrides: Overrides { source: None, depth: DepthOrder::Nearest, mask: MaskBlend::Parity },
};

/// A model packed, tessellated and seen.
pub(crate) struct Shot<D = Tessellation> {
    pub(crate) model: Model,
    pub(crate) scene: PackedScene,
    pub(crate) drawn: D,
    pub(crate) camera: Camera,
    pub(crate) viewport: Viewport,
}

impl Shot {
    fn new(model: Model, scheme: Scheme, camera: Camera, viewport: Viewport, cells: usize) -> Self {
        let scene = PackedScene::new(&model, scheme).unwrap();
        let drawn = Tessellation::uniform(&model, &scene, cells).unwrap();
        Self { model, scene, drawn, camera, viewport }
    }
}

impl<D: Drawable> Shot<D> {
    pub(crate) fn views(&self) -> Vec<pipeline::View> {
        self.scene.views(&self.model, &self.camera, self.viewport)
    }

    pub(crate) fn gbuffer(&self, device: &Device, options: RendererOptions<'_>) -> Result<GBuffer, gpu::GpuError> {
        let meta = Meta::new("gpu", self.drawn.technique(), &self.model, &self.camera);
        let mut renderer = Renderer::new(device, &self.scene, &self.drawn, options)?;
        renderer.gbuffer(&self.views(), &self.camera, self.viewport, meta)
    }
}

/// The square −½ … ½ of the plane z = `z`, degree 1.
pub(crate) fn square(z: f64) -> Surface {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
    let points = [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)].map(|(x, y)| DVec3::new(x, y, z));
    Surface::new(knots(), knots(), points.to_vec(), None).unwrap()
}

/// From above, y upward in the picture, `height` model units high.
pub(crate) fn from_above(height: f64) -> Camera {
    let projection = Projection::Orthographic { height };
    Camera::look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, projection).unwrap()
}

fn assorted_shots() -> Vec<Shot> {
    let viewport = Viewport::new(71, 53).unwrap();
    let mut shots = vec![];
    for scheme in [Scheme::General, Scheme::Specialised] {
        let model = assorted(7);
        let camera = Camera::framing(&model, viewport);
        shots.push(Shot::new(model, scheme, camera, viewport, 4));
    }
    shots
}

#[test]
fn every_fragment_has_the_bits_of_the_program_in_rust_at_its_own_parameters() {
    let device = software();
    for shot in assorted_shots() {
        let mut renderer = Renderer::new(&device, &shot.scene, &shot.drawn, CURVATURE).unwrap();
        let fragments = renderer.fragments(&shot.views(), shot.viewport).unwrap();
        let drawn: Vec<_> = fragments.iter().flatten().collect();
        assert!(drawn.len() > 500, "{} pixels drawn", drawn.len());
        for f in drawn {
            let expected = fragment(&shot.scene, f.face, Parameters { span: f.span, uv: f.uv }, true);
            assert_eq!(differences(f, &expected), [""; 0], "{f:?} is not {expected:?}");
        }
    }
}

#[test]
fn a_gbuffer_holds_the_hits_of_the_fragments() {
    let device = software();
    for shot in assorted_shots() {
        let gbuffer = shot.gbuffer(&device, CURVATURE).unwrap();
        let mut renderer = Renderer::new(&device, &shot.scene, &shot.drawn, CURVATURE).unwrap();
        let fragments = renderer.fragments(&shot.views(), shot.viewport).unwrap();
        for (index, (hit, f)) in gbuffer.pixels().zip(&fragments).enumerate() {
            let (x, y) = (index % shot.viewport.width(), index / shot.viewport.width());
            let ray = shot.camera.ray(shot.viewport, x as f64 + 0.5, y as f64 + 0.5);
            assert_eq!(hit.copied(), f.map(|f| shot.scene.hit(&f, &ray)), "pixel ({x}, {y})");
        }
        assert!(gbuffer.meta().adapter.as_deref().unwrap().contains("llvmpipe"));
        assert!(gbuffer.meta().driver.is_some());
    }
}

#[test]
fn a_picture_is_the_same_every_time() {
    let device = software();
    let shot = &assorted_shots()[1];
    assert!(shot.gbuffer(&device, CURVATURE).unwrap() == shot.gbuffer(&device, CURVATURE).unwrap());
}

#[test]
fn without_curvature_hits_have_none_and_the_rest_stays() {
    let device = software();
    let shot = &assorted_shots()[1];
    let with = shot.gbuffer(&device, CURVATURE).unwrap();
    let without = shot.gbuffer(&device, RendererOptions::default()).unwrap();
    assert_eq!(with.covered(), without.covered());
    for (a, b) in with.pixels().flatten().zip(without.pixels().flatten()) {
        assert_eq!((a.position, a.normal, b.curvature), (b.position, b.normal, None));
    }
}

/// The plane is 1 unit wide, so 64 of 96 columns and rows, 16 from each side.
#[test]
fn a_flat_square_covers_its_pixels_and_each_lies_on_its_ray() {
    let model = Model::of_surfaces("square", vec![square(0.25)]).unwrap();
    let viewport = Viewport::new(96, 96).unwrap();
    let shot = Shot::new(model, Scheme::Specialised, from_above(1.5), viewport, 3);
    let gbuffer = shot.gbuffer(&software(), CURVATURE).unwrap();
    on_rays(&shot, &gbuffer, 16..80, 16..80);
}

/// 6144 columns of 64 bytes are 21 rows a band of readback: 40 rows make two bands, the second a short one.
#[test]
fn a_picture_read_back_in_several_bands_has_no_seam() {
    let model = Model::of_surfaces("square", vec![square(0.0)]).unwrap();
    let viewport = Viewport::new(6144, 40).unwrap();
    let shot = Shot::new(model, Scheme::Specialised, from_above(2.0), viewport, 1);
    let gbuffer = shot.gbuffer(&software(), CURVATURE).unwrap();
    on_rays(&shot, &gbuffer, 3062..3082, 10..30);
}

/// How far an attribute interpolated in f32 may be off, in pixels a pixel of the picture's width: rasterizers evaluate
/// a plane equation from a corner of the picture, so a rounding error grows with the distance from there.
const INTERPOLATION: f64 = 4.0 * f32::EPSILON as f64;

fn on_rays(shot: &Shot, gbuffer: &GBuffer, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) {
    let (width, pixel) = (shot.viewport.width() as f64, 1.0 / shot.camera.pixels_per_unit(shot.viewport, 1.0));
    for y in 0..shot.viewport.height() {
        for x in 0..shot.viewport.width() {
            let hit = gbuffer.get(x, y);
            assert_eq!(hit.is_some(), columns.contains(&x) && rows.contains(&y), "pixel ({x}, {y})");
            let Some(hit) = hit else { continue };
            let ray = shot.camera.ray(shot.viewport, x as f64 + 0.5, y as f64 + 0.5);
            let distance = hit.position.distance(ray.at(hit.t));
            assert!(distance < INTERPOLATION * width * pixel, "pixel ({x}, {y}), off by {distance:e}: {hit:?}");
            assert_eq!(hit.normal.unit(), Some(DVec3::Z));
        }
    }
}

#[test]
fn the_nearest_of_two_squares_is_seen_and_the_farthest_where_the_depth_test_is_at_fault() {
    let device = software();
    let viewport = Viewport::new(24, 24).unwrap();
    for order in [[0.0, 0.5], [0.5, 0.0]] {
        let model = Model::of_surfaces("squares", order.map(square).to_vec()).unwrap();
        let near = FaceId(if order[0] > order[1] { 0 } else { 1 });
        let eye = DVec3::new(0.1, 0.1, 3.0);
        let perspective = Projection::Perspective { fov_deg: 20.0 };
        let cameras = [from_above(1.0), Camera::look_at(eye, DVec3::ZERO, DVec3::Y, perspective).unwrap()];
        for camera in cameras {
            let shot = Shot::new(model.clone(), Scheme::Specialised, camera, viewport, 1);
            let faces = |depth| {
                let overrides = Overrides { depth, ..Overrides::default() };
                let options = RendererOptions { overrides, ..RendererOptions::default() };
                let gbuffer = shot.gbuffer(&device, options).unwrap();
                gbuffer.get(12, 12).unwrap().face
            };
            assert_eq!(faces(DepthOrder::Nearest), near);
            assert_ne!(faces(DepthOrder::Farthest), near);
        }
    }
}

#[test]
fn at_equal_depth_the_face_drawn_first_stays() {
    let model = Model::of_surfaces("twice", vec![square(0.0), square(0.0)]).unwrap();
    let shot = Shot::new(model, Scheme::Specialised, from_above(1.0), Viewport::new(16, 16).unwrap(), 2);
    let gbuffer = shot.gbuffer(&software(), CURVATURE).unwrap();
    assert_eq!(gbuffer.covered(), 256);
    assert!(gbuffer.pixels().flatten().all(|hit| hit.face == FaceId(0)));
}

#[test]
fn a_fault_in_the_source_shows_in_the_gbuffer() {
    let device = software();
    let model = assorted(7);
    let viewport = Viewport::new(48, 40).unwrap();
    let camera = Camera::framing(&model, viewport);
    let shot = Shot::new(model, Scheme::Specialised, camera, viewport, 3);
    let sound = shot.gbuffer(&device, CURVATURE).unwrap();
    let with = |from: &'static str, to: &'static str| {
        let source = move |variant: Variant| {
            let source = wgsl::source(variant);
            assert!(source.contains(from), "{from}");
            source.replace(from, to)
        };
        let overrides = Overrides { source: Some(&source), ..Overrides::default() };
        shot.gbuffer(&device, RendererOptions { overrides, ..CURVATURE }).unwrap()
    };
    let pairs = |faulty: &GBuffer| -> Vec<_> {
        let hits = sound.pixels().flatten().copied().zip(faulty.pixels().flatten().copied());
        hits.filter(|(a, _)| a.normal.unit().is_some()).collect()
    };

    let long = with("n = n / length;", "n = n / n_squared;");
    let lengths = pairs(&long).iter().filter(|(_, b)| (b.normal.unit().unwrap().length() - 1.0).abs() > 0.01).count();
    assert!(lengths > sound.covered() / 2, "{lengths} of {} normals are not unit", sound.covered());

    let displaced = with("out.position = d.s;", "out.position = d.s + vec3<f32>(0.25);");
    assert!(pairs(&displaced).iter().all(|(a, b)| a.uv == b.uv && a.position.distance(b.position) > 0.1));

    let not_a_number = with("out.position = d.s;", "out.position = d.s * bitcast<f32>(face.flags | 0x7fc00000u);");
    assert!(pairs(&not_a_number).iter().all(|(_, b)| b.position.is_nan() && b.t.is_nan()));
}

/// Inputs of both shadings differ by rounding; a banded argument may then stand on the other side of an edge.
#[test]
fn a_shaded_picture_is_that_of_the_gbuffer_to_a_step_of_each_channel() {
    let device = software();
    let mut random = Random::new(5);
    let model = Model::of_surfaces("sheet", vec![sheet(&mut random, [3, 3], true, 0.1)]).unwrap();
    let viewport = Viewport::new(96, 64).unwrap();
    let camera = Camera::framing(&model, viewport);
    let shot = Shot::new(model, Scheme::Specialised, camera, viewport, 24);
    let gbuffer = shot.gbuffer(&device, CURVATURE).unwrap();
    assert!(gbuffer.covered() > 1000, "{} pixels covered", gbuffer.covered());
    let mut renderer = Renderer::new(&device, &shot.scene, &shot.drawn, CURVATURE).unwrap();
    for kind in ShadeKind::ALL {
        let uniform = Shading::new(kind).uniform(&shot.camera, shot.model.hull().diagonal());
        let picture = renderer.shaded(&shot.views(), &uniform, viewport).unwrap();
        for (index, hit) in gbuffer.pixels().enumerate() {
            let (x, y) = (index % 96, index / 96);
            let colours = match hit {
                None => vec![background()],
                Some(hit) => {
                    let ray = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5);
                    let input = ShadeInput::new(hit, &shot.model, &ray).unwrap();
                    shade_tolerant(&uniform, &input, 4.0 * f32::EPSILON)
                }
            };
            let seen = picture.pixel(x, y);
            let close = |colour: &[u8; 3]| (0..3).all(|c| colour[c].abs_diff(seen[c]) <= 1);
            assert!(colours.iter().any(close), "{kind:?} at ({x}, {y}): {seen:?} is none of {colours:?}");
        }
    }
}

#[test]
fn vertex_normals_change_normals_and_positions_only() {
    let device = software();
    let mut random = Random::new(6);
    let model = Model::of_surfaces("sheet", vec![sheet(&mut random, [3, 3], false, 0.3)]).unwrap();
    let viewport = Viewport::new(64, 48).unwrap();
    let camera = Camera::framing(&model, viewport);
    let shot = Shot::new(model, Scheme::Specialised, camera, viewport, 2);
    let options = RendererOptions { vertex_normals: true, ..CURVATURE };
    let own = shot.gbuffer(&device, CURVATURE).unwrap();
    let interpolated = shot.gbuffer(&device, options).unwrap();
    for (a, b) in own.pixels().zip(interpolated.pixels()) {
        let plain =
            |hit: &Hit| Hit { normal: Normal::Undefined, position: DVec3::ZERO, t: 0.0, curvature: None, ..*hit };
        assert_eq!(a.map(plain), b.map(plain));
    }
    assert!(own.pixels().flatten().zip(interpolated.pixels().flatten()).any(|(a, b)| a.normal != b.normal));
    let uniform = Shading::new(ShadeKind::Normal).uniform(&shot.camera, 1.0);
    let pictures = [CURVATURE, options].map(|options| {
        let mut renderer = Renderer::new(&device, &shot.scene, &shot.drawn, options).unwrap();
        renderer.shaded(&shot.views(), &uniform, viewport).unwrap()
    });
    let pairs = pictures[0].rgb().iter().zip(pictures[1].rgb());
    assert!(pairs.filter(|(a, b)| a != b).count() > own.covered() / 2);
}

#[test]
fn other_triangles_of_the_same_scene_are_drawn_in_place_of_the_first() {
    let device = software();
    let shot = &assorted_shots()[1];
    let views = shot.views();
    let mut renderer = Renderer::new(&device, &shot.scene, &shot.drawn, CURVATURE).unwrap();
    let first = renderer.fragments(&views, shot.viewport).unwrap();
    let finer = Tessellation::uniform(&shot.model, &shot.scene, 6).unwrap();
    renderer.set(&finer).unwrap();
    assert!(renderer.fragments(&views, shot.viewport).unwrap() != first);
    let nothing = Tessellation::default();
    renderer.set(&nothing).unwrap();
    assert!(renderer.fragments(&views, shot.viewport).unwrap().iter().all(Option::is_none));
    let empty_batches = shot.drawn.mesh.batches.iter().map(|b| pipeline::Batch { count: 0, ..*b }).collect();
    let mut without = shot.drawn.clone();
    without.mesh.batches = empty_batches;
    renderer.set(&without).unwrap();
    assert!(renderer.fragments(&views, shot.viewport).unwrap().iter().all(Option::is_none));
}

#[test]
fn timing_counts_the_frames_asked_for() {
    let device = software();
    let shot = &assorted_shots()[1];
    let mut renderer = Renderer::new(&device, &shot.scene, &shot.drawn, RendererOptions::default()).unwrap();
    let uniform = Shading::new(ShadeKind::Phong).uniform(&shot.camera, 1.0);
    let frames = vec![shot.views(); 7];
    let timing = renderer.time_shaded(&frames, &uniform, shot.viewport).unwrap();
    assert_eq!(timing.frames, 7);
    assert!(timing.wall_s > 0.0 && timing.frames_per_second().is_finite());
    assert_eq!(timing.gpu_s.map(|s| s.len()), device.has_timestamps().then_some(7));
    let none = renderer.time_shaded(&[], &uniform, shot.viewport).unwrap();
    assert_eq!((none.frames, none.wall_s), (0, 0.0));
}

//! What does not fit or does not compile comes back as an error that names it.

use crate::models::assorted;
use crate::software;
use glam::DVec3;
use gpu::{Device, GpuError, Overrides, Renderer, RendererOptions, probe};
use nurbs::{KnotVector, Surface};
use pipeline::wgsl::{self, Variant};
use pipeline::{PackedScene, Parameters, Program, Scheme};
use scene::{Camera, Face, Model, Viewport};
use techniques::fragment::Tessellation;

#[test]
fn an_adapter_that_is_not_there_is_answered_with_those_that_are() {
    let error = Device::open(Some("no such adapter")).unwrap_err();
    let GpuError::NoSuchAdapter { found, .. } = &error else { panic!("{error}") };
    assert!(!found.is_empty());
    assert_eq!(found.len(), gpu::adapters().len());
}

#[test]
fn a_scene_above_the_adapters_limit_is_refused_with_the_limit() {
    let device = software();
    let small = assorted(1);
    let scene = PackedScene::new(&small, Scheme::General).unwrap();
    let drawn = Tessellation::uniform(&small, &scene, 1).unwrap();
    // A terrain of 2¹³ × (2¹⁰ + 1) heights: 16 bytes each are just above 2²⁷.
    let (rows, columns) = (1 << 13, (1 << 10) + 1);
    let heights = (0..rows * columns).map(|k| DVec3::new((k / columns) as f64, (k % columns) as f64, 0.0)).collect();
    let knots = |count: usize| {
        let inner = (0..count).map(|k| k as f64);
        KnotVector::new(1, [0.0].into_iter().chain(inner).chain([(count - 1) as f64]).collect()).unwrap()
    };
    let surface = Surface::new(knots(rows), knots(columns), heights, None).unwrap();
    let model = Model::new("terrain".to_owned(), vec![surface], vec![Face::whole(0)]).unwrap();
    let scene = PackedScene::new(&model, Scheme::General).unwrap();
    let Err(error) = Renderer::new(&device, &scene, &drawn, RendererOptions::default()) else { panic!("it fits") };
    let GpuError::Limit { what, limit, needed, available } = error else { panic!("{error}") };
    assert_eq!((what, limit), ("control points", "max_storage_buffer_binding_size"));
    assert_eq!(needed, 16 * (rows * columns) as u64);
    assert!(available < needed);
}

fn renderer_with(from: &str, to: &str) -> GpuError {
    let device = software();
    let model = assorted(1);
    let scene = PackedScene::new(&model, Scheme::Specialised).unwrap();
    let drawn = Tessellation::uniform(&model, &scene, 1).unwrap();
    let source = |variant: Variant| wgsl::source(variant).replace(from, to);
    let overrides = Overrides { source: Some(&source), ..Overrides::default() };
    let options = RendererOptions { overrides, ..RendererOptions::default() };
    let viewport = Viewport::new(8, 8).unwrap();
    let views = scene.views(&model, &Camera::framing(&model, viewport), viewport);
    match Renderer::new(&device, &scene, &drawn, options) {
        Err(error) => error,
        Ok(mut renderer) => renderer.fragments(&views, viewport).expect_err("the source is at fault"),
    }
}

#[test]
fn an_illegal_shader_is_refused_with_the_compilers_message() {
    let error = renderer_with("fn is_regular(", "fn is_regular(!");
    let GpuError::Shader { entry: "source", message, .. } = &error else { panic!("{error}") };
    assert!(message.contains("fn is_regular(!"), "{message}");
}

#[test]
fn a_shader_that_does_not_type_is_refused() {
    let error = renderer_with("out.status = REGULAR;", "out.status = 1.0;");
    assert!(matches!(&error, GpuError::Shader { entry: "source", .. }), "{error}");
}

#[test]
fn a_shader_without_its_entry_point_is_refused_when_drawn_with() {
    let error = renderer_with("fn fragment_gbuffer(", "fn fragment_other(");
    assert!(matches!(&error, GpuError::Shader { entry: "fragment_gbuffer", .. }), "{error}");
}

#[test]
fn a_face_that_is_not_there_is_refused_with_its_pixel() {
    let error = renderer_with("vec4<u32>(face + 1u, f.status", "vec4<u32>(face + 1000u, f.status");
    assert!(matches!(&error, GpuError::Malformed { face: 999.., count: 20, .. }), "{error}");
}

#[test]
fn views_of_another_scene_are_refused() {
    let device = software();
    let model = assorted(1);
    let scene = PackedScene::new(&model, Scheme::Specialised).unwrap();
    let drawn = Tessellation::uniform(&model, &scene, 1).unwrap();
    let mut renderer = Renderer::new(&device, &scene, &drawn, RendererOptions::default()).unwrap();
    let viewport = Viewport::new(8, 8).unwrap();
    let mut views = scene.views(&model, &Camera::framing(&model, viewport), viewport);
    views.pop();
    assert_eq!(renderer.fragments(&views, viewport), Err(GpuError::ViewCount { expected: 20, found: 19 }));
}

#[test]
fn a_probe_of_another_programs_face_is_refused() {
    let device = software();
    let scene = PackedScene::new(&assorted(1), Scheme::Specialised).unwrap();
    for face in [0, 20] {
        let error = probe(&device, &scene, Program::Degree(5), &[(face, Parameters::searched([0.5; 2]))]).unwrap_err();
        assert!(matches!(error, GpuError::ProbeFace { index: 0, .. }), "{error}");
    }
    assert_eq!(probe(&device, &scene, Program::Degree(5), &[]), Ok(vec![]));
}

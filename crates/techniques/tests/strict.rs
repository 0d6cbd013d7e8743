//! Triangles drawn by strict kernels: every number of the G-buffer has the CPU rasterizer's bits.

mod common;

use common::software;
use gbuffer::Meta;
use gpu::{Renderer, RendererOptions};
use pipeline::{PackedScene, Scheme};
use raster::{Drawing, Options, Rasterizer};
use scene::{Camera, Viewport};
use techniques::{ByCompute, Limits, Setting};

#[test]
fn a_strict_gbuffer_has_the_rasterizers_bits() {
    let device = software();
    let viewport = Viewport::new(64, 64).expect("a legal size");
    let model = models::builtin("teapot").expect("built in");
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
    let camera = Camera::framing(&model, viewport);
    let limits = Limits::default();
    let setting = Setting {
        model: &model,
        scene: &scene,
        camera: &camera,
        viewport,
        chord_px: 0.25,
        limits,
        vertex_normals: false,
    };
    let prepared = techniques::named("fragment").expect("a technique").prepare(&setting).expect("few triangles");
    let views = scene.views(&model, &camera, viewport);
    let options = Options { curvature: true, vertex_normals: false };
    let drawing = Drawing { scene: &scene, views: &views, camera: &camera, viewport, options };
    let meta = |renderer: &str| Meta::new(renderer, prepared.technique(), &model, &camera);
    let raster = Rasterizer::new(drawing, prepared.visibility(drawing)).render(meta("raster"), &|_| {});
    let drawn = ByCompute::strict(prepared.clone()).expect("it has triangles");
    let options = RendererOptions { curvature: true, ..RendererOptions::default() };
    let mut renderer = Renderer::new(&device, &scene, &drawn, options).expect("it fits");
    let gpu = renderer.gbuffer(&views, &camera, viewport, meta("gpu")).expect("drawn");
    assert!(raster.covered() > 1000, "{}", raster.covered());
    let unlike = raster.unlike(&gpu);
    assert_eq!(unlike.pixels, 0, "{unlike}");
    assert_eq!(raster.hash().to_string(), gpu.hash().to_string());
}

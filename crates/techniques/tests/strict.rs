//! Strict programs: every number of the G-buffer has the CPU rasterizer's bits.

mod common;

use common::software;
use gbuffer::{GBuffer, Meta};
use gpu::{Device, Drawable, Renderer, RendererOptions};
use pipeline::mask::{MaskFill, MaskOptions, MaskPlan, Masks};
use pipeline::{PackedScene, Scheme};
use raster::{Drawing, Options, Rasterizer};
use scene::{Camera, Model, Viewport};
use std::sync::Arc;
use techniques::{ByCompute, Limits, Prepared, Setting};

/// A model as a technique draws it.
struct Shot<'a> {
    model: &'a Model,
    scene: &'a PackedScene,
    camera: Camera,
    viewport: Viewport,
    prepared: Arc<dyn Prepared>,
}

impl<'a> Shot<'a> {
    fn new(model: &'a Model, scene: &'a PackedScene, side: usize, technique: &str) -> Self {
        let viewport = Viewport::new(side, side).expect("a legal size");
        let camera = Camera::framing(model, viewport);
        let limits = Limits::default();
        let setting =
            Setting { model, scene, camera: &camera, viewport, chord_px: 0.25, limits, vertex_normals: false };
        let prepared = techniques::named(technique).expect("a technique").prepare(&setting).expect("few triangles");
        Self { model, scene, camera, viewport, prepared }
    }

    fn meta(&self, renderer: &str) -> Meta {
        Meta::new(renderer, self.prepared.technique(), self.model, &self.camera)
    }

    fn raster(&self) -> GBuffer {
        let Self { scene, camera, viewport, ref prepared, .. } = *self;
        let views = scene.views(self.model, &camera, viewport);
        let options = Options { curvature: true, vertex_normals: false };
        let drawing = Drawing { scene, views: &views, camera: &camera, viewport, options };
        Rasterizer::new(drawing, prepared.visibility(drawing)).render(self.meta("raster"), &|_| {})
    }

    fn gpu(&self, device: &Device, drawn: &dyn Drawable) -> GBuffer {
        let views = self.scene.views(self.model, &self.camera, self.viewport);
        let options = RendererOptions { curvature: true, ..RendererOptions::default() };
        let mut renderer = Renderer::new(device, self.scene, drawn, options).expect("it fits");
        renderer.gbuffer(&views, &self.camera, self.viewport, self.meta("gpu")).expect("drawn")
    }
}

fn same(shot: &Shot, drawn: &dyn Drawable, least: usize) {
    let raster = shot.raster();
    assert!(raster.covered() > least, "{}", raster.covered());
    let gpu = shot.gpu(&software(), drawn);
    let unlike = raster.unlike(&gpu);
    assert_eq!(unlike.pixels, 0, "{unlike}");
    assert_eq!(raster.hash().to_string(), gpu.hash().to_string());
}

#[test]
fn triangles_have_the_rasterizers_bits() {
    let model = models::builtin("teapot").expect("built in");
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
    let shot = Shot::new(&model, &scene, 64, "fragment");
    assert!(shot.prepared.strict().is_none());
    same(&shot, &ByCompute::strict(shot.prepared.clone()).expect("it has triangles"), 1000);
}

#[test]
fn searches_have_the_rasterizers_bits() {
    let model = models::builtin("fold").expect("built in");
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
    let shot = Shot::new(&model, &scene, 24, "exact");
    assert!(ByCompute::strict(shot.prepared.clone()).is_none());
    same(&shot, &*shot.prepared.strict().expect("it searches"), 200);
}

#[test]
fn masks_of_strict_programs_are_the_cpus() {
    let device = software();
    let model = models::builtin("islands").expect("built in");
    let viewport = Viewport::new(64, 64).expect("a legal size");
    let camera = Camera::framing(&model, viewport);
    let plan = MaskPlan::new(&model, &camera, viewport, &MaskOptions::default()).expect("it fits");
    let mut masks = Masks::new(plan, MaskFill::default());
    // One that no rasterizer would draw.
    for texel in masks.texels.iter_mut().step_by(3) {
        *texel = 255 - *texel;
    }
    let atlas = gpu::MaskAtlas::of(&device, &masks).expect("it fits");
    assert!(masks.texels.contains(&0) && masks.texels.contains(&255));
    assert_eq!(atlas.texels(&device).expect("read back"), masks.texels);
}

//! Triangles drawn by kernels: who covers a pixel, and who is nearest there, to the bit as on the CPU.

mod common;

use common::software;
use gbuffer::{GBuffer, Hit, Meta};
use glam::{DVec2, DVec3};
use gpu::{Atomics, DepthOrder, Device, Overrides, Renderer, RendererOptions};
use pipeline::wgsl::{self, Variant};
use pipeline::{PackedScene, Scheme, View};
use raster::{Drawing, Rasterizer};
use scene::{Camera, Model, Projection, Viewport};
use std::sync::Arc;
use techniques::{ByCompute, Limits, Prepared, Setting};

/// All forms of atomics that the device has.
fn atomics(device: &Device) -> Vec<Atomics> {
    let mut forms = vec![Atomics::Bits32];
    forms.extend(Some(device.atomics()).filter(|form| *form != Atomics::Bits32));
    forms
}

/// A picture of a packed model.
struct Shot<'m> {
    model: &'m Model,
    scene: &'m PackedScene,
    camera: Camera,
    viewport: Viewport,
    prepared: Arc<dyn Prepared>,
}

impl<'m> Shot<'m> {
    fn new(
        technique: &str,
        model: &'m Model,
        scene: &'m PackedScene,
        (camera, viewport): (Camera, Viewport),
        chord_px: f64,
    ) -> Self {
        let setting = Setting {
            model,
            scene,
            camera: &camera,
            viewport,
            chord_px,
            limits: Limits::default(),
            vertex_normals: false,
        };
        let prepared = techniques::named(technique).expect("a technique").prepare(&setting).expect("few triangles");
        Self { model, scene, camera, viewport, prepared }
    }

    fn meta(&self, renderer: &str) -> Meta {
        Meta::new(renderer, self.prepared.technique(), self.model, &self.camera)
    }

    fn views(&self) -> Vec<View> {
        self.scene.views(self.model, &self.camera, self.viewport)
    }

    fn by_raster(&self) -> GBuffer {
        let Self { scene, camera, viewport, prepared, .. } = self;
        let views = self.views();
        let drawing = Drawing { scene, views: &views, camera, viewport: *viewport, options: Default::default() };
        Rasterizer::new(drawing, prepared.visibility(drawing)).render(self.meta("raster"), &|_| {})
    }

    fn by_compute(&self, atomics: Atomics) -> ByCompute {
        ByCompute::new(self.prepared.clone(), atomics).expect("it has triangles")
    }

    fn drawn_by(&self, renderer: &mut Renderer) -> GBuffer {
        renderer.gbuffer(&self.views(), &self.camera, self.viewport, self.meta("gpu")).expect("drawn")
    }

    /// The covered pixels, those that show another face or another knot span or that one of both shows alone, and how far from a
    /// pixel's centre the second buffer shows the surface, pixels.
    fn apart(&self, a: &GBuffer, b: &GBuffer) -> (usize, usize, f64) {
        let (mut covered, mut others, mut farthest) = (0, 0, 0.0f64);
        let width = self.viewport.width();
        for (x, y) in (0..self.viewport.pixels()).map(|pixel| (pixel % width, pixel / width)) {
            let place = |hit: &Hit| (hit.face, hit.local.expect("both know it").span);
            match (a.get(x, y), b.get(x, y)) {
                (None, None) => {}
                (Some(a), Some(b)) if place(a) == place(b) => {
                    covered += 1;
                    let at = self.camera.project(self.viewport, b.position).expect("it is seen").0;
                    farthest = farthest.max(at.distance(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)));
                }
                _ => others += 1,
            }
        }
        (covered, others, farthest)
    }
}

/// Cameras that see all of a model, that are inside its box, and that skim it.
fn cameras(model: &Model, viewport: Viewport) -> Vec<Camera> {
    let framed = Camera::framing(model, viewport);
    let hull = model.hull();
    let (center, size) = (hull.center(), hull.diagonal());
    let from = |eye: DVec3, at: DVec3| {
        let projection = Projection::Perspective { fov_deg: 80.0 };
        Camera::look_at(eye, at, DVec3::new(0.1, 0.2, 1.0), projection).expect("not along up")
    };
    vec![
        framed,
        from(center + size * DVec3::new(0.01, 0.02, 0.03), center + size * DVec3::X),
        from(center + size * DVec3::new(0.0, -0.3, 0.1), center + size * DVec3::new(0.3, 0.3, 0.1)),
        from(center + size * DVec3::new(0.45, 0.0, 0.22), center - size * DVec3::X),
    ]
}

#[test]
fn coverage_and_the_nearest_triangle_are_those_of_the_cpu_rasterizer() {
    let device = software();
    let viewport = Viewport::new(101, 75).expect("a legal size");
    for (technique, name, chord_px) in
        [("fragment", "teapot", 1.0), ("fragment", "spray", 16.0), ("grid", "torus", 1.0), ("zones", "sphere", 1.0)]
    {
        let model = models::builtin(name).expect("built in");
        let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
        let shots: Vec<Shot> = cameras(&model, viewport)
            .into_iter()
            .map(|camera| Shot::new(technique, &model, &scene, (camera, viewport), chord_px))
            .collect();
        let expected: Vec<GBuffer> = shots.iter().map(Shot::by_raster).collect();
        for form in atomics(&device) {
            let drawn = shots[0].by_compute(form);
            let mut renderer = Renderer::new(&device, &scene, &drawn, RendererOptions::default()).expect("it fits");
            for (view, (shot, expected)) in shots.iter().zip(&expected).enumerate() {
                renderer.set(&shot.by_compute(form)).expect("it fits");
                let (covered, others, farthest) = shot.apart(expected, &shot.drawn_by(&mut renderer));
                let what = format!("{name} by {technique}, view {view}, {form:?}");
                assert!(covered > 500, "{what}: {covered} pixels are covered");
                assert_eq!(others, 0, "{what}: of {covered} pixels");
                // Snapping moves corners by √2 / 512 of a pixel.
                let allowed = shot.prepared.built_px().expect("it has a chord error") + 1.0 / 64.0;
                assert!(farthest < allowed, "{what}: {farthest} px of {allowed}");
            }
        }
    }
}

#[test]
fn the_farthest_triangle_is_another_one() {
    let device = software();
    let viewport = Viewport::new(64, 48).expect("a legal size");
    let model = models::builtin("torus").expect("built in");
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
    let shot = Shot::new("fragment", &model, &scene, (Camera::framing(&model, viewport), viewport), 1.0);
    let expected = shot.by_raster();
    for form in atomics(&device) {
        let overrides = Overrides { depth: DepthOrder::Farthest, ..Overrides::default() };
        let options = RendererOptions { overrides, ..RendererOptions::default() };
        let drawn = shot.by_compute(form);
        let mut renderer = Renderer::new(&device, &scene, &drawn, options).expect("it fits");
        let (covered, others, _) = shot.apart(&expected, &shot.drawn_by(&mut renderer));
        assert!(others > 100, "{form:?}: {others} of {} differ", covered + others);
    }
}

#[test]
fn questions_that_find_no_room_have_the_same_answers() {
    let device = software();
    let viewport = Viewport::new(64, 48).expect("a legal size");
    let model = models::builtin("islands").expect("built in");
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
    let shot = Shot::new("fragment", &model, &scene, (Camera::framing(&model, viewport), viewport), 1.0);
    let drawn = shot.by_compute(device.atomics());
    let picture = |room: &str| {
        let source = |variant: Variant| {
            let source = wgsl::source(variant);
            assert!(source.contains("call.room"));
            source.replace("call.room", room)
        };
        let overrides = Overrides { source: Some(&source), ..Overrides::default() };
        let options = RendererOptions { overrides, ..RendererOptions::default() };
        shot.drawn_by(&mut Renderer::new(&device, &scene, &drawn, options).expect("it fits"))
    };
    let (all, few) = (picture("call.room"), picture("7u"));
    assert!(all.covered() > 500);
    assert!(all.pixels().eq(few.pixels()));
}

#[test]
fn a_technique_without_triangles_is_not_drawn_by_these_kernels() {
    let viewport = Viewport::new(16, 12).expect("a legal size");
    let model = models::builtin("torus").expect("built in");
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
    let shot = Shot::new("exact", &model, &scene, (Camera::framing(&model, viewport), viewport), 1.0);
    assert!(ByCompute::new(shot.prepared, Atomics::Bits32).is_none());
}

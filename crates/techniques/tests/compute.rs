//! Triangles drawn by kernels: who covers a pixel, and who is nearest there, to the bit as on the CPU.

use gbuffer::{GBuffer, Hit, Meta};
use glam::DVec3;
use gpu::{Atomics, DepthOrder, Device, Overrides, Renderer, RendererOptions};
use pipeline::{PackedScene, Scheme};
use raster::{Drawing, Rasterizer};
use scene::{Camera, Model, Projection, Viewport};
use std::sync::Arc;
use techniques::{ByCompute, Limits, Prepared, Setting};

fn software() -> Device {
    Device::open(Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`")
}

/// All forms of atomics that the device has.
fn atomics(device: &Device) -> Vec<Atomics> {
    let mut forms = vec![Atomics::Bits32];
    forms.extend(Some(device.atomics()).filter(|form| *form != Atomics::Bits32));
    forms
}

struct Shot<'m> {
    model: &'m Model,
    camera: Camera,
    viewport: Viewport,
    scene: PackedScene,
    prepared: Arc<dyn Prepared>,
}

impl<'m> Shot<'m> {
    fn new(technique: &str, model: &'m Model, camera: Camera, viewport: Viewport, chord_px: f64) -> Self {
        let scene = PackedScene::new(model, Scheme::Specialised).expect("it packs");
        let setting = Setting { model, scene: &scene, camera: &camera, viewport, chord_px, limits: Limits::default() };
        let prepared = techniques::named(technique).expect("a technique").prepare(&setting).expect("few triangles");
        Self { model, camera, viewport, scene, prepared }
    }

    fn meta(&self, renderer: &str) -> Meta {
        Meta::new(renderer, "fragment", self.model, &self.camera)
    }

    fn by_raster(&self) -> GBuffer {
        let Self { model, camera, viewport, scene, prepared } = self;
        let views = scene.views(model, camera, *viewport);
        let drawing = Drawing { scene, views: &views, camera, viewport: *viewport, options: Default::default() };
        Rasterizer::new(drawing, prepared.visibility(drawing)).render(self.meta("raster"), &|_| {})
    }

    fn by_kernels(&self, device: &Device, atomics: Atomics, overrides: Overrides) -> GBuffer {
        let Self { model, camera, viewport, scene, prepared } = self;
        let drawn = ByCompute::new(prepared.clone(), atomics).expect("it has triangles");
        let options = RendererOptions { overrides, ..Default::default() };
        let mut renderer = Renderer::new(device, scene, &drawn, options).expect("it fits");
        let views = scene.views(model, camera, *viewport);
        renderer.gbuffer(&views, camera, *viewport, self.meta("gpu")).expect("drawn")
    }
}

/// The covered pixels, those that show another face or another knot span or that one of both shows alone, and how far apart all
/// others are in the picture, pixels.
fn apart(shot: &Shot, a: &GBuffer, b: &GBuffer) -> (usize, usize, f64) {
    let (mut covered, mut others, mut farthest) = (0, 0, 0.0f64);
    let viewport = shot.viewport;
    for pixel in 0..viewport.pixels() {
        let at = |buffer: &GBuffer| buffer.get(pixel % viewport.width(), pixel / viewport.width()).copied();
        let place = |hit: &Hit| (hit.face, hit.local.expect("both know it").span);
        match (at(a), at(b)) {
            (None, None) => {}
            (Some(a), Some(b)) if place(&a) == place(&b) => {
                covered += 1;
                let [a, b] = [a, b].map(|hit| shot.camera.project(viewport, hit.position).expect("it is seen").0);
                farthest = farthest.max(a.distance(b));
            }
            _ => others += 1,
        }
    }
    (covered, others, farthest)
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
    let cases: [(&str, &str, &[f64]); 5] = [
        ("fragment", "teapot", &[0.25, 4.0]),
        ("fragment", "spray", &[16.0]),
        ("fragment", "torus", &[2.0]),
        ("grid", "teacup", &[1.0]),
        ("zones", "sphere", &[1.0]),
    ];
    for (technique, name, chords) in cases {
        let model = models::builtin(name).expect("built in");
        for (view, camera) in cameras(&model, viewport).into_iter().enumerate() {
            for &chord_px in chords {
                let shot = Shot::new(technique, &model, camera, viewport, chord_px);
                let expected = shot.by_raster();
                for form in atomics(&device) {
                    let found = shot.by_kernels(&device, form, Overrides::default());
                    let (covered, others, farthest) = apart(&shot, &expected, &found);
                    let what = format!("{name} by {technique}, view {view}, {chord_px} px, {form:?}");
                    assert!(covered > 500, "{what}: {covered} pixels are covered");
                    assert_eq!(others, 0, "{what}: of {covered} pixels");
                    // Snapping moves corners by √2 / 512 of a pixel, and the kernels interpolate from snapped ones.
                    assert!(farthest < 1.0 / 64.0, "{what}: {farthest} px");
                }
            }
        }
    }
}

#[test]
fn the_farthest_triangle_is_another_one() {
    let device = software();
    let viewport = Viewport::new(64, 48).expect("a legal size");
    let model = models::builtin("torus").expect("built in");
    let shot = Shot::new("fragment", &model, Camera::framing(&model, viewport), viewport, 1.0);
    let expected = shot.by_raster();
    for form in atomics(&device) {
        let overrides = Overrides { depth: DepthOrder::Farthest, ..Overrides::default() };
        let (covered, others, farthest) = apart(&shot, &expected, &shot.by_kernels(&device, form, overrides));
        assert!(others > 100 && farthest < 1.0, "{form:?}: {others} of {} differ", covered + others);
    }
}

#[test]
fn a_technique_without_triangles_is_not_drawn_by_these_kernels() {
    let viewport = Viewport::new(16, 12).expect("a legal size");
    let model = models::builtin("torus").expect("built in");
    let shot = Shot::new("exact", &model, Camera::framing(&model, viewport), viewport, 1.0);
    assert!(ByCompute::new(shot.prepared, Atomics::Bits32).is_none());
}

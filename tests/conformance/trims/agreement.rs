//! The three renderers agree on trimmed models, and tell a face whose loop is missing.

use super::frozen;
use compare::{Cause, PairReport, Verdict};
use glam::DVec3;
use isophote::stage::{Plan, Rendered, Stage};
use pipeline::PackedScene;
use raycast::Caster;
use scene::{Camera, Face, Model, Projection, Viewport};
use techniques::Technique;

/// Side of the pictures, pixels.
const SIDE: usize = 56;

const ADAPTER: &str = "a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`";

/// Framed, and from close by at a slant.
fn cameras(model: &Model, viewport: Viewport) -> [Camera; 2] {
    let (center, size) = (model.hull().center(), model.hull().diagonal());
    let eye = center + size * DVec3::new(0.35, -0.3, 0.25);
    let projection = Projection::Perspective { fov_deg: 60.0 };
    [Camera::framing(model, viewport), Camera::look_at(eye, center, DVec3::Z, projection).expect("legal")]
}

/// What the pairs say of a model by a technique from each camera. One renderer draws both views: compiling is most of the
/// work of a software GPU.
fn differing(
    device: &gpu::Device,
    model: &Model,
    technique: &'static dyn Technique,
    viewport: Viewport,
) -> Vec<String> {
    let caster = Caster::new(model);
    let plan = Plan { technique, ..Plan::default() };
    let stages = cameras(model, viewport).map(|camera| Stage::new(model, camera, viewport, plan).expect("a stage"));
    let options = gpu::RendererOptions { curvature: true, ..Default::default() };
    let first = &stages[0];
    let mut renderer = gpu::Renderer::new(device, &first.scene, &*first.prepared, options).expect("the GPU takes it");
    let mut found = vec![];
    for (view, stage) in stages.iter().enumerate() {
        renderer.set(&*stage.prepared).expect("the same technique");
        let gbuffer =
            renderer.gbuffer(&stage.views, &stage.camera, viewport, stage.meta("gpu")).expect("the GPU draws");
        let on_gpu = isophote::stage::OnGpu { gbuffer, shaded: None, moves_px: None };
        let rendered = Rendered { raycast: stage.raycast(&caster), raster: stage.raster(), gpu: Ok(on_gpu) };
        let pairs = stage.compare(&caster, &rendered).expect("comparable");
        assert!(pairs.iter().all(|pair| pair.covered > 50), "{} shows too little", model.name());
        let words = |pair: &PairReport| {
            let worst = pair.worst.iter().take(4).map(|p| format!("({}, {}) {:?}: {}", p.x, p.y, p.cause, p.detail));
            let worst = worst.collect::<Vec<_>>().join("\n    ");
            let (a, b) = (&pair.reference, &pair.candidate);
            format!(
                "{} {technique:?} view {view}, {a} | {b}: {:?} {:?}\n    {worst}",
                model.name(),
                pair.causes,
                pair.explanation
            )
        };
        found.extend(pairs.iter().filter(|pair| pair.verdict != Verdict::Agree).map(words));
    }
    found
}

fn assert_agreement<'m>(models: impl IntoIterator<Item = &'m Model>, side: usize) {
    let device = gpu::Device::open(None).expect(ADAPTER);
    let viewport = Viewport::new(side, side).expect("a legal size");
    let mut found = vec![];
    for model in models {
        for &technique in techniques::ALL {
            found.extend(differing(&device, model, technique, viewport));
        }
    }
    assert!(found.is_empty(), "{} pairs differ\n{}", found.len(), found.join("\n"));
}

#[test]
fn three_renderers_agree_on_every_trimmed_model_in_both_techniques() {
    let models: Vec<Model> = models::TRIMMED.iter().map(|(name, _)| models::builtin(name).expect("built in")).collect();
    assert_agreement(&models, SIDE);
}

#[test]
fn three_renderers_agree_on_real_trimmed_models() {
    let Some(folder) = frozen::neutral() else { return };
    let models = ["nacelle.json", "nist_11.json"].map(|file| formats::read(folder.join(file)).expect("a model"));
    assert_agreement(&models, 64);
}

/// The model without one of its inner loops.
fn without(model: &Model, index: usize) -> Model {
    let mut loops = model.faces()[0].loops.clone();
    loops.remove(index);
    let face = Face { loops, ..model.faces()[0].clone() };
    Model::new(model.name(), model.surfaces().to_vec(), vec![face]).expect("as legal as before")
}

#[test]
fn a_missing_inner_loop_differs_along_the_trim() {
    let device = gpu::Device::open(None).expect(ADAPTER);
    let viewport = Viewport::new(SIDE, SIDE).expect("a legal size");
    for (name, index) in [("islands", 3), ("cusp", 1), ("plate", 45)] {
        let model = models::builtin(name).expect("built in");
        let caster = Caster::new(&model);
        let camera = Camera::framing(&model, viewport);
        let stage = Stage::new(&model, camera, viewport, Plan::default()).expect("a stage");
        // From there on the first that a pixel's centre looks into.
        let shown = |model: &Model| Caster::new(model).render(&camera, viewport, &|_| ()).covered();
        let missing = (index..).map(|index| (index, without(&model, index)));
        let (index, other) = missing.into_iter().find(|(_, other)| shown(other) != shown(&model)).expect("a loop");
        // The same triangles: they are those of the surface, whatever is cut out of it.
        let faulty = PackedScene::new(&other, stage.plan.scheme).expect("it packs");
        let options = gpu::RendererOptions { curvature: true, ..Default::default() };
        let mut renderer = gpu::Renderer::new(&device, &faulty, &*stage.prepared, options).expect("the GPU takes it");
        let on_gpu = renderer.gbuffer(&stage.views, &camera, viewport, stage.meta("gpu")).expect("the GPU draws");
        let on_cpu =
            Stage { scene: faulty.into(), ..Stage::new(&model, camera, viewport, stage.plan).expect("a stage") }
                .raster();
        for buffer in [&on_gpu, &on_cpu] {
            let pair = stage.against_raycast(&caster, &stage.raycast(&caster), buffer).expect("comparable");
            let of_trim = pair.causes.get(&Cause::Trim).copied().unwrap_or(0);
            assert!(
                pair.verdict == Verdict::Differ && pair.main_cause() == Some(Cause::Trim),
                "{name} {index}: {:?} {:?} {:?}",
                pair.verdict,
                pair.causes,
                pair.explanation
            );
            assert_eq!(of_trim, pair.differing(), "{name} {index}: {:?}", pair.causes);
        }
    }
}

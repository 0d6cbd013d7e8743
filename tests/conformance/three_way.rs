//! The three renderers agree on every model of the first release, from everywhere.

use compare::{PairReport, Verdict};
use gbuffer::{ShadeKind, Shading};
use glam::DVec3;
use isophote::stage::{Plan, Stage};
use pipeline::Scheme;
use raycast::Caster;
use scene::{Camera, Model, Projection, Viewport};

/// Side of the pictures: software Vulkan is slow at small triangles with heavy fragments.
const SIDE: usize = 72;

/// Models, each for what it stresses.
const MODELS: &[&str] = &[
    "teapot",
    "teacup",
    "teaspoon",
    "sphere",
    "torus",
    "surface",
    "rational",
    "bilinear-quartic",
    "quintic-quadratic",
    "septic",
    "unclamped",
    "periodic",
];

/// From outside, inside and grazing, in perspective and orthographically.
fn cameras(model: &Model, viewport: Viewport) -> Vec<(String, Camera)> {
    let (center, size) = (model.hull().center(), model.hull().diagonal());
    let framing = Camera::framing(model, viewport);
    let places = [
        ("outside", framing.eye(), center),
        ("inside", center + size * DVec3::new(0.02, 0.03, 0.05), center + size * DVec3::new(0.4, 0.3, -0.1)),
        ("grazing", center + size * DVec3::new(1.1, 0.2, 0.06), center),
    ];
    let projections = [Projection::Perspective { fov_deg: 45.0 }, Projection::Orthographic { height: 0.55 * size }];
    let mut cameras = vec![];
    for (name, eye, target) in places {
        for projection in projections {
            let camera = Camera::look_at(eye, target, DVec3::Z, projection).expect("a legal camera");
            cameras.push((format!("{name}, {projection:?}"), camera));
        }
    }
    cameras
}

/// What differs, pair by pair, with the worst pixels.
pub fn words(name: &str, view: &str, pairs: &[PairReport]) -> Vec<String> {
    let differing = pairs.iter().filter(|pair| pair.verdict != Verdict::Agree);
    differing
        .map(|pair| {
            let worst = pair.worst.iter().take(5).map(|p| format!("({}, {}) {:?}: {}", p.x, p.y, p.cause, p.detail));
            let worst = worst.collect::<Vec<_>>().join("\n    ");
            let explanation = pair.explanation.iter();
            let causes = format!("{:?} {}", pair.causes, explanation.cloned().collect::<String>());
            format!("{name} {view}: {} | {}: {causes}\n    {worst}", pair.reference, pair.candidate)
        })
        .collect()
}

#[test]
fn three_renderers_agree_on_every_model_from_everywhere() {
    let viewport = Viewport::new(SIDE, SIDE).expect("a legal size");
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    let shading = Shading::new(ShadeKind::Isophotes);
    let mut failures = vec![];
    let mut views = 0;
    for name in MODELS {
        let model = models::builtin(name).expect("built in");
        let caster = Caster::new(&model);
        for (view, camera) in cameras(&model, viewport) {
            let stage = Stage::new(&model, camera, viewport, Plan::default()).expect("a stage");
            let raycast = stage.raycast(&caster);
            // An orthographic picture from inside may see nothing; there is then nothing to agree on.
            if raycast.covered() == 0 {
                continue;
            }
            views += 1;
            let raster = stage.raster();
            let on_gpu = stage.gpu(&device, Some(&shading), gpu::Overrides::default()).expect("the GPU draws");
            let pairs = [
                stage.against_raycast(&caster, &raycast, &raster),
                stage.against_raycast(&caster, &raycast, &on_gpu.gbuffer),
                stage.against_raster(&raster, &on_gpu.gbuffer),
            ]
            .map(|pair| pair.expect("comparable"));
            failures.extend(words(name, &view, &pairs));
            let shaded = on_gpu.shaded.expect("a picture was asked for");
            let shaded = stage.judge_shading(&shading, &on_gpu.gbuffer, &shaded).expect("the same size");
            if shaded.differ > 0 {
                failures.push(format!("{name} {view}: shading: {shaded:?}"));
            }
        }
    }
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
    assert!(views >= 5 * MODELS.len(), "only {views} views showed anything");
}

#[test]
fn technique_exact_agrees_to_a_hundredth_of_a_pixel_from_everywhere() {
    let viewport = Viewport::new(48, 48).expect("a legal size");
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    let plan = Plan { technique: &techniques::exact::Exact, ..Plan::default() };
    let (mut failures, mut covered, mut unconverged) = (vec![], 0, 0);
    for name in MODELS {
        let model = models::builtin(name).expect("built in");
        let caster = Caster::new(&model);
        for (view, camera) in cameras(&model, viewport) {
            let stage = Stage::new(&model, camera, viewport, plan).expect("a stage");
            let raycast = stage.raycast(&caster);
            if raycast.covered() == 0 {
                continue;
            }
            let raster = stage.raster();
            let mut pairs = vec![stage.against_raycast(&caster, &raycast, &raster).expect("comparable")];
            // A software adapter takes a second to compile the kernels: one view a model.
            if view.starts_with("outside, P") {
                let on_gpu = stage.gpu(&device, None, gpu::Overrides::default()).expect("the GPU draws").gbuffer;
                pairs.push(stage.against_raycast(&caster, &raycast, &on_gpu).expect("comparable"));
            }
            failures.extend(words(name, &view, &pairs));
            covered += raycast.covered();
            unconverged += raster.undecided();
            assert!(pairs.iter().all(|pair| pair.max_px <= compare::EXACT_PX), "{name} {view}");
        }
    }
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
    assert!(unconverged * 1000 <= covered, "{unconverged} of {covered}");
}

/// A weight of 1,000 beside 1 has S run a thousand times as fast at a border, where the parameter is near 0 and so as fine as that.
/// What f32 leaves of it near 1 let 44 pixels show a border up to 0.23 pixel away.
#[test]
fn where_parameters_are_fast_technique_exact_shows_no_border_beside_the_pixel() {
    let viewport = Viewport::new(512, 512).expect("a legal size");
    let model = models::builtin("weights-1000").expect("built in");
    let plan = Plan { technique: &techniques::exact::Exact, ..Plan::default() };
    let stage = Stage::new(&model, Camera::framing(&model, viewport), viewport, plan).expect("a stage");
    let caster = Caster::new(&model);
    let (raycast, raster) = (stage.raycast(&caster), stage.raster());
    let pair = stage.against_raycast(&caster, &raycast, &raster).expect("comparable");
    assert_eq!((pair.verdict, raster.undecided()), (Verdict::Agree, 0), "{:?}", pair.worst.first());
    assert!(pair.covered > 44_000 && pair.max_px <= compare::EXACT_PX, "{} {}", pair.covered, pair.max_px);
}

/// Where a fold's edge runs through a pixel, a triangle seen edge-on may be interpolated far along the ray by one
/// rasterizer and hidden in the other.
#[test]
fn a_triangle_seen_edge_on_at_a_fold_is_granted_its_chord_and_no_more() {
    let viewport = Viewport::new(56, 56).expect("a legal size");
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    for name in ["degree-1x9", "degree-8x2"] {
        let model = models::builtin(name).expect("built in");
        let stage = Stage::new(&model, Camera::framing(&model, viewport), viewport, Plan::default()).expect("a stage");
        let on_gpu = stage.gpu(&device, None, gpu::Overrides::default()).expect("the GPU draws").gbuffer;
        let pair = stage.against_raster(&stage.raster(), &on_gpu).expect("comparable");
        assert!(pair.verdict == compare::Verdict::Agree, "{name}: {:?}", pair.worst.first());
    }
}

#[test]
fn the_general_program_and_the_specialised_ones_give_the_same_answer() {
    let viewport = Viewport::new(SIDE, SIDE).expect("a legal size");
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    for name in ["teapot", "bilinear-quartic", "quintic-quadratic", "septic", "rational"] {
        let model = models::builtin(name).expect("built in");
        let camera = Camera::framing(&model, viewport);
        let stages = [Scheme::Specialised, Scheme::General]
            .map(|scheme| Stage::new(&model, camera, viewport, Plan { scheme, ..Plan::default() }).expect("a stage"));
        let mut specialised = stages[0].raster();
        let general = stages[1].gpu(&device, None, gpu::Overrides::default()).expect("the GPU draws").gbuffer;
        let pair = stages[1].against_raster(&specialised, &general).expect("comparable");
        assert!(words(name, "general on the GPU", std::slice::from_ref(&pair)).is_empty(), "{:?}", pair.worst);
        let caster = Caster::new(&model);
        let raycast = stages[1].raycast(&caster);
        for buffer in [&general, &stages[1].raster()] {
            let pair = stages[1].against_raycast(&caster, &raycast, buffer).expect("comparable");
            assert!(words(name, "general", std::slice::from_ref(&pair)).is_empty(), "{:?}", pair.worst);
        }
        // Bicubic faces run the same statements in both.
        if name == "teapot" {
            specialised = stages[1].raster();
            assert!(specialised.pixels().eq(stages[0].raster().pixels()));
        }
    }
}

#[test]
fn real_models_that_need_another_eye_agree_too() {
    // Faces of very different size and degree, reversed ones, trim loops that are kept: what CAD files bring.
    let folder = std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../testdata/cases");
    let viewport = Viewport::new(48, 48).expect("a legal size");
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    let mut files: Vec<_> = folder.read_dir().expect("cases").map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    let mut failures = vec![];
    for file in files.iter().filter(|file| file.extension().is_some_and(|e| e == "json")) {
        let model = formats::read(file).expect("a readable case");
        let caster = Caster::new(&model);
        let camera = Camera::framing(&model, viewport);
        let stage = Stage::new(&model, camera, viewport, Plan::default()).expect("a stage");
        let (raycast, raster) = (stage.raycast(&caster), stage.raster());
        let on_gpu = stage.gpu(&device, None, gpu::Overrides::default()).expect("the GPU draws").gbuffer;
        let pairs = [
            stage.against_raycast(&caster, &raycast, &raster),
            stage.against_raycast(&caster, &raycast, &on_gpu),
            stage.against_raster(&raster, &on_gpu),
        ]
        .map(|pair| pair.expect("comparable"));
        failures.extend(words(model.name(), "framed", &pairs));
    }
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

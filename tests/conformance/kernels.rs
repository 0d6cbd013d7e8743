//! `--path compute`: the three renderers agree by it, and faults in its kernels are found.

use crate::three_way::words;
use compare::{PairReport, Verdict};
use glam::DVec3;
use isophote::stage::{Path, Plan, Stage};
use pipeline::wgsl::{self, Variant};
use raycast::Caster;
use scene::{Camera, Model, Projection, Viewport};

/// What is drawn: a trimmed model in a frame, or a pot from inside, whose triangles are large.
#[derive(Debug, Clone, Copy)]
enum Scene {
    Framed,
    Inside,
}

/// A fault: its name, where it shows, and what is replaced by what.
const FAULTS: &[(&str, Scene, [&str; 2])] = &[
    ("depth by the slope of another edge", Scene::Inside, ["values.y * t.scale", "values.z * t.scale"]),
    (
        "rows without their last column",
        Scene::Framed,
        ["floor(max(columns.y, 0.0))", "floor(max(columns.y - 1.5, 0.0))"],
    ),
    (
        "large triangles are left out",
        Scene::Inside,
        ["atomicAdd(&queue[call.counts], 1u)", "atomicAdd(&queue[call.counts], 0u)"],
    ),
    (
        "the third corner's parameters are the second's",
        Scene::Framed,
        ["weights.z * (corners.z - a)", "weights.z * (corners.y - a)"],
    ),
    ("no face is asked whether it is there", Scene::Framed, ["return TRIMMED && (faces[", "return false && (faces["]),
    (
        "corners are snapped to whole pixels",
        Scene::Framed,
        ["round(position * SUBPIXEL_ONE)", "round(position) * SUBPIXEL_ONE"],
    ),
    ("parameters are not in perspective", Scene::Inside, ["w / max(max(w.x, w.y), w.z)", "vec3<f32>(1.0)"]),
];

fn model_of(scene: Scene) -> Model {
    let name = match scene {
        Scene::Framed => "islands",
        Scene::Inside => "teapot",
    };
    models::builtin(name).expect("built in")
}

/// What all pairs say of a scene that the GPU draws by a path.
fn judged(scene: Scene, path: Path, overrides: gpu::Overrides) -> Vec<PairReport> {
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    let model = model_of(scene);
    let viewport = Viewport::new(96, 72).expect("a legal size");
    let (center, size) = (model.hull().center(), model.hull().diagonal());
    let (chord_px, camera) = match scene {
        Scene::Framed => (1.0, Camera::framing(&model, viewport)),
        Scene::Inside => {
            let (eye, target) =
                (center + size * DVec3::new(0.02, 0.03, 0.05), center + size * DVec3::new(0.4, 0.3, -0.1));
            let projection = Projection::Perspective { fov_deg: 60.0 };
            (8.0, Camera::look_at(eye, target, DVec3::Z, projection).expect("a legal camera"))
        }
    };
    let stage = Stage::new(&model, camera, viewport, Plan { path, chord_px, ..Plan::default() }).expect("a stage");
    let caster = Caster::new(&model);
    let (rays, raster) = (stage.raycast(&caster), stage.raster());
    let on_gpu = stage.gpu(&device, None, overrides).expect("the GPU draws").gbuffer;
    vec![
        stage.against_raycast(&caster, &rays, &raster).expect("comparable"),
        stage.against_raycast(&caster, &rays, &on_gpu).expect("comparable"),
        stage.against_raster(&raster, &on_gpu).expect("comparable"),
    ]
}

#[test]
fn three_renderers_agree_where_kernels_find_the_triangles() {
    for scene in [Scene::Framed, Scene::Inside] {
        for path in [Path::Compute, Path::Compute32] {
            let pairs = judged(scene, path, gpu::Overrides::default());
            let differing = words(&format!("{scene:?}"), &format!("{path:?}"), &pairs);
            assert!(differing.is_empty(), "{}", differing.join("\n"));
            assert!(pairs.iter().all(|pair| pair.verdict == Verdict::Agree));
        }
    }
}

#[test]
fn faults_of_the_kernels_are_found() {
    for (name, scene, [from, to]) in FAULTS {
        let source = |variant: Variant| {
            let source = wgsl::source(variant);
            assert!(source.contains(from), "{name}: the source no longer says {from:?}");
            source.replace(from, to)
        };
        let pairs = judged(*scene, Path::Compute, gpu::Overrides { source: Some(&source), ..Default::default() });
        let found: Vec<_> = pairs.iter().map(PairReport::main_cause).collect();
        println!("{name}: {found:?}");
        assert_eq!(pairs[0].verdict, Verdict::Agree, "{name}: the CPU has no fault");
        assert!(pairs[1..].iter().any(|pair| pair.verdict == Verdict::Differ), "{name} is not found");
    }
}

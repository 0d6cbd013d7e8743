//! `--normals vertex`: what triangles carry agrees with what is proven of it, and what is wrong does not.

use compare::{Cause, PairReport, Verdict};
use gbuffer::{GBuffer, Hit};
use glam::DVec3;
use isophote::stage::{Plan, Stage};
use nurbs::Normal;
use pipeline::wgsl::{self, Variant};
use raycast::Caster;
use scene::{Camera, Model, Viewport};
use techniques::Technique;
use techniques::exact::Exact;
use techniques::fragment::Fragment;
use techniques::grid::Grid;
use techniques::zones::ByZones;

fn stage<'m>(model: &'m Model, technique: &'static dyn Technique) -> Result<Stage<'m>, String> {
    let viewport = Viewport::new(160, 120).expect("a legal size");
    let plan = Plan { technique, chord_px: 0.25, vertex_normals: true, ..Plan::default() };
    Stage::new(model, Camera::framing(model, viewport), viewport, plan).map_err(|error| error.to_string())
}

fn device() -> gpu::Device {
    gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`")
}

/// In pictures so small that half a pixel of error knows nothing of how a cell turns.
#[test]
fn cells_are_so_small_that_their_normals_are_known() {
    let device = device();
    let case = |name: &str| {
        let path = format!("{}/../testdata/cases/{name}.json", env!("CARGO_MANIFEST_DIR"));
        formats::read(std::path::Path::new(&path)).expect("a readable case")
    };
    let spray = models::builtin("spray").expect("built in");
    let models = [case("mixed_3"), case("weights_2"), case("solid_3"), spray];
    let viewport = Viewport::new(96, 72).expect("a legal size");
    for model in &models {
        let caster = Caster::new(model);
        // By technique `fragment` llvmpipe interpolates one pixel of `spray` far beyond a cell that it sees edge-on.
        let all = [&Fragment as &'static dyn Technique, &Grid, &ByZones];
        for &technique in &all[usize::from(model.name() == "spray")..] {
            let plan = Plan { technique, chord_px: 0.5, vertex_normals: true, ..Plan::default() };
            let stage = Stage::new(model, Camera::framing(model, viewport), viewport, plan).expect("a stage");
            let (rays, raster) = (stage.raycast(&caster), stage.raster());
            let on_gpu = stage.gpu(&device, None, gpu::Overrides::default()).expect("the GPU draws").gbuffer;
            for pair in [
                stage.against_raycast(&caster, &rays, &raster).expect("comparable"),
                stage.against_raycast(&caster, &rays, &on_gpu).expect("comparable"),
                stage.against_raster(&raster, &on_gpu).expect("comparable"),
            ] {
                let (name, found) = (model.name(), (pair.unbounded, &pair.causes));
                assert_eq!(pair.verdict, Verdict::Agree, "{name}, {technique:?}: {found:?}");
            }
        }
    }
}

#[test]
fn what_triangles_carry_agrees() {
    let device = device();
    for name in ["teapot", "sphere", "rational", "islands", "cone"] {
        let model = models::builtin(name).expect("built in");
        let caster = Caster::new(&model);
        for technique in [&Fragment as &'static dyn Technique, &Grid, &ByZones] {
            let stage = stage(&model, technique).expect("a stage");
            let (rays, raster) = (stage.raycast(&caster), stage.raster());
            let on_gpu = stage.gpu(&device, None, gpu::Overrides::default()).expect("the GPU draws").gbuffer;
            for pair in [
                stage.against_raycast(&caster, &rays, &raster).expect("comparable"),
                stage.against_raycast(&caster, &rays, &on_gpu).expect("comparable"),
                stage.against_raster(&raster, &on_gpu).expect("comparable"),
            ] {
                assert_eq!(pair.verdict, Verdict::Agree, "{name}, {technique:?}: {:?}", pair.causes);
                assert!(pair.normal_share > 0.05, "{name}, {technique:?}: nothing is claimed of normals");
            }
        }
    }
}

/// Every hit changed.
fn changed(buffer: &GBuffer, change: impl Fn(Hit) -> Hit) -> GBuffer {
    let viewport = buffer.viewport();
    let row = |y: usize| (0..viewport.width()).map(|x| buffer.get(x, y).copied().map(&change)).collect();
    GBuffer::from_rows(viewport, buffer.meta().clone(), (0..viewport.height()).map(row).collect::<Vec<_>>())
}

fn main_cause(report: &PairReport) -> Option<Cause> {
    assert_eq!(report.verdict, Verdict::Differ, "{:?}", report.causes);
    report.main_cause()
}

#[test]
fn what_no_triangle_carries_differs() {
    let model = models::builtin("sphere").expect("built in");
    let caster = Caster::new(&model);
    let stage = stage(&model, &Grid).expect("a stage");
    let (rays, raster) = (stage.raycast(&caster), stage.raster());
    let cause = |change: &dyn Fn(Hit) -> Hit| {
        main_cause(&stage.against_raycast(&caster, &rays, &changed(&raster, change)).expect("comparable"))
    };
    let with = |hit: Hit, normal: DVec3| Hit { normal: Normal::Regular(normal), ..hit };
    let normal = |hit: &Hit| hit.normal.unit().expect("a sphere has one");
    let tilted = |hit: Hit| with(hit, (normal(&hit) + 0.4 * normal(&hit).any_orthonormal_vector()).normalize());
    assert_eq!(cause(&tilted), Some(Cause::Derivative));
    assert_eq!(cause(&|hit| with(hit, -normal(&hit))), Some(Cause::Derivative));
    assert_eq!(cause(&|hit| with(hit, 0.9 * normal(&hit))), Some(Cause::NormalLength));
    assert_eq!(cause(&|hit| with(hit, DVec3::NAN)), Some(Cause::NotFinite));
    assert_eq!(cause(&|hit| Hit { normal: Normal::Undefined, ..hit }), Some(Cause::DegenerateNormal));
    let lifted = |hit: Hit| Hit { position: hit.position + 0.05 * normal(&hit), ..hit };
    assert!(cause(&lifted).is_some());
}

/// The causes of what differs, and how many of the covered pixels do.
fn differing(stage: &Stage, caster: &Caster, rays: &GBuffer, changed: &GBuffer) -> (PairReport, f64) {
    let report = stage.against_raycast(caster, rays, changed).expect("comparable");
    let share = report.differing() as f64 / report.covered as f64;
    (report, share)
}

/// Less than half of a cell's own cone is what bounds of control points add to it: a normal from two cells on is none of the cell's.
#[test]
fn a_normal_of_a_cell_beside_or_of_a_coarser_level_differs() {
    let model = models::builtin("sphere").expect("built in");
    let caster = Caster::new(&model);
    for technique in [&Fragment as &'static dyn Technique, &Grid] {
        let stage = stage(&model, technique).expect("a stage");
        let (rays, raster) = (stage.raycast(&caster), stage.raster());
        // Of the piece that a hit is on, where it starts and the greatest cell along u and along v.
        let cell = |hit: &Hit| {
            let face = hit.face.0 as usize;
            let patches = model.surface(hit.face).bezier_patches();
            let is_on = |k: usize, domain: &[[f64; 2]; 2]| (domain[k][0]..=domain[k][1]).contains(&hit.uv[k]);
            let piece = patches.iter().position(|patch| is_on(0, &patch.domain) && is_on(1, &patch.domain));
            let piece = piece.expect("a piece");
            let compare::Cells { parts, sizes } = &stage.prepared.cells()[face][piece];
            [0, 1].map(|k| {
                let [start, end] = patches[piece].domain[k];
                let greatest = sizes.iter().map(|size| size[k]).fold(0.0, f64::max);
                (start, end, (end - start) * greatest / parts[k] as f64)
            })
        };
        let of = |hit: Hit, u: f64, v: f64| Hit { normal: model.surface(hit.face).inspect(u, v).normal, ..hit };
        let beside = changed(&raster, |hit| {
            let [(start, end, size), _] = cell(&hit);
            let u = if hit.uv.x + 2.0 * size < end { hit.uv.x + 2.0 * size } else { hit.uv.x - 2.0 * size };
            of(hit, u.max(start), hit.uv.y)
        });
        let (report, share) = differing(&stage, &caster, &rays, &beside);
        // Near a pole normals hardly change along u.
        assert!(share > 0.6 && report.main_cause() == Some(Cause::Derivative), "{share}: {:?}", report.causes);
        // The whole cell of a level that is coarser by four has the normal of its first corner.
        let coarse = changed(&raster, |hit| {
            let [u, v] = [0, 1].map(|k| {
                let (start, _, size) = cell(&hit)[k];
                start + ((hit.uv[k] - start) / (4.0 * size)).floor() * 4.0 * size
            });
            of(hit, u, v)
        });
        let (report, share) = differing(&stage, &caster, &rays, &coarse);
        assert!(share > 0.5 && report.main_cause() == Some(Cause::Derivative), "{share}: {:?}", report.causes);
    }
}

/// A point may be off S by the chord where it lies on the pixel's ray, and by no more there; off the ray it is no triangle's.
#[test]
fn a_point_that_is_off_by_more_than_a_chord_or_beside_the_ray_differs() {
    let model = models::builtin("sphere").expect("built in");
    let caster = Caster::new(&model);
    for technique in [&Fragment as &'static dyn Technique, &Grid] {
        let stage = stage(&model, technique).expect("a stage");
        let (rays, raster) = (stage.raycast(&caster), stage.raster());
        let chord = |hit: &Hit| stage.prepared.chord()[hit.face.0 as usize].iter().copied().fold(0.0, f64::max);
        let nearer = changed(&raster, |hit| {
            let position = hit.position + 3.0 * chord(&hit) * (stage.camera.eye() - hit.position).normalize();
            Hit { position, ..hit }
        });
        let (report, share) = differing(&stage, &caster, &rays, &nearer);
        assert!(share > 0.95 && !report.causes.contains_key(&Cause::Interpolation), "{share}: {:?}", report.causes);
        let beside = changed(&raster, |hit| {
            let pixels = stage.camera.pixels_per_unit(stage.viewport, stage.camera.depth(hit.position));
            Hit { position: hit.position + 0.05 / pixels * stage.camera.right(), ..hit }
        });
        let (report, share) = differing(&stage, &caster, &rays, &beside);
        assert!(share > 0.95 && report.main_cause() == Some(Cause::Interpolation), "{share}: {:?}", report.causes);
    }
}

/// Triangles of a coarser tessellation, normals and all.
#[test]
fn a_picture_of_a_coarser_level_differs() {
    let model = models::builtin("sphere").expect("built in");
    let caster = Caster::new(&model);
    let fine = stage(&model, &Fragment).expect("a stage");
    let plan = Plan { chord_px: 4.0, ..fine.plan };
    let coarse = Stage::new(&model, fine.camera, fine.viewport, plan).expect("a stage").raster();
    let (report, share) = differing(&fine, &caster, &fine.raycast(&caster), &coarse);
    assert!(report.verdict == Verdict::Differ && share > 0.2, "{share}: {:?}", report.causes);
}

#[test]
fn faults_of_the_vertex_stage_differ() {
    let device = device();
    let model = models::builtin("torus").expect("built in");
    let caster = Caster::new(&model);
    for (technique, from, to) in [
        (&Grid as &'static dyn Technique, "out.normal = own.normal;", "out.normal = own.normal.zxy;"),
        (&ByZones, "out.normal = v.normal;", "out.normal = corners[zone * ACROSS * ACROSS].normal;"),
        (&Fragment, "select(vec3<f32>(0.0), in.normal / length", "select(vec3<f32>(0.0), in.normal"),
        (&Grid, "f.position = in.local;", "f.position = in.local * 1.01;"),
    ] {
        let source = |variant: Variant| {
            let source = wgsl::source(variant);
            assert!(source.contains(from), "the source no longer says {from:?}");
            source.replace(from, to)
        };
        let stage = stage(&model, technique).expect("a stage");
        let overrides = gpu::Overrides { source: Some(&source), ..Default::default() };
        let on_gpu = stage.gpu(&device, None, overrides).expect("the GPU draws").gbuffer;
        let pair = stage.against_raycast(&caster, &stage.raycast(&caster), &on_gpu).expect("comparable");
        assert_eq!(pair.verdict, Verdict::Differ, "{to}");
    }
}

#[test]
fn a_technique_without_corners_on_the_surface_refuses() {
    let model = models::builtin("teapot").expect("built in");
    let error = stage(&model, &Exact).err().expect("refused");
    assert!(error.contains("exact") && error.contains("vertex normals"), "{error}");
}

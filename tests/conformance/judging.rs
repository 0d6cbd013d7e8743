//! The judge on pixels that are wrong in one known way.

use compare::{Cause, Claims, PairReport, UNBOUNDED_SHARE, Verdict};
use gbuffer::{GBuffer, Hit};
use glam::DVec3;
use isophote::stage::{Plan, Stage};
use nurbs::{Direction, Surface};
use pipeline::{PackedScene, Parameters};
use raycast::Caster;
use scene::{Camera, Model, Viewport};
use std::sync::Arc;

const SIDE: usize = 32;
/// A pixel in the middle of the teapot's body.
const AT: [usize; 2] = [16, 18];

fn staged(model: &Model, plan: Plan) -> Stage<'_> {
    let viewport = Viewport::new(SIDE, SIDE).expect("a legal size");
    Stage::new(model, Camera::framing(model, viewport), viewport, plan).expect("a stage")
}

fn stage(model: &Model, unbounded_share: f64) -> Stage<'_> {
    staged(model, Plan { unbounded_share, ..Plan::default() })
}

/// The buffer with one pixel changed.
fn changed(buffer: &GBuffer, change: impl Fn(Option<Hit>) -> Option<Hit>) -> GBuffer {
    let rows = (0..SIDE).map(|y| {
        let pixel = |x: usize| {
            let hit = buffer.get(x, y).copied();
            if [x, y] == AT { change(hit) } else { hit }
        };
        (0..SIDE).map(pixel).collect()
    });
    GBuffer::from_rows(buffer.viewport(), buffer.meta().clone(), rows.collect::<Vec<_>>())
}

fn only_cause(report: &PairReport) -> Option<Cause> {
    assert_eq!(report.causes.values().sum::<usize>(), 1, "{:?}", report.causes);
    report.main_cause()
}

#[test]
fn a_surface_that_is_not_shown_is_named_by_what_the_technique_claims_and_by_what_the_renderers_say() {
    let model = models::builtin("teapot").expect("built in");
    let caster = Caster::new(&model);
    let at = (AT[0], AT[1]);
    for &technique in techniques::ALL {
        let stage = staged(&model, Plan { technique, ..Plan::default() });
        let (raycast, raster) = (stage.raycast(&caster), stage.raster());
        let ray = stage.camera.ray(stage.viewport, AT[0] as f64 + 0.5, AT[1] as f64 + 0.5);
        let farther = caster.all(&ray).hits.into_iter().nth(1).expect("the teapot has two sides");
        let judge = |reference: &GBuffer, candidate: &GBuffer| {
            only_cause(&stage.against_raycast(&caster, reference, candidate).expect("comparable"))
        };
        let hole = || changed(&raster, |_| None);
        let searches = technique.claims() == Claims::OnRay;
        let of = |of_triangles| Some(if searches { Cause::MissedRoot } else { of_triangles });
        assert_eq!(judge(&raycast, &hole()), of(Cause::Coverage), "{technique:?}");
        // Only a search may be without an answer.
        if searches {
            assert_eq!(judge(&raycast, &hole().with_undecided([at])), Some(Cause::NewtonNotConverged));
        }
        assert_eq!(judge(&raycast.clone().with_undecided([at]), &hole()), Some(Cause::Undecided));
        // The farther side, evaluated by the program at the f32 parameters nearest to the ray's.
        let [[u0, u1], [v0, v1]] = model.surface(farther.face).domain();
        let uv = [(farther.uv.x - u0) / (u1 - u0), (farther.uv.y - v0) / (v1 - v0)].map(|t| t as f32);
        let fragment = pipeline::fragment::fragment(&stage.scene, farther.face.0, Parameters::searched(uv), true);
        let hidden = changed(&raster, |_| Some(stage.scene.hit(&fragment, &ray)));
        assert_eq!(judge(&raycast, &hidden), of(Cause::Depth), "{technique:?}");
    }
}

#[test]
fn a_candidate_that_did_not_converge_is_counted_even_where_it_is_right() {
    let model = models::builtin("teapot").expect("built in");
    let (stage, caster) = (stage(&model, UNBOUNDED_SHARE), Caster::new(&model));
    let raster = stage.raster().with_undecided([(AT[0], AT[1])]);
    let report = stage.against_raycast(&caster, &stage.raycast(&caster), &raster).expect("comparable");
    assert_eq!((report.verdict, report.unconverged), (Verdict::Agree, 1), "{:?}", report.causes);
    let bounded = report.covered - report.unbounded;
    let counted: usize = report.shares.position.0.iter().sum();
    assert!(counted <= report.covered && counted + report.coverage.partial >= bounded, "{report:?}");
    assert!(0.0 < report.position_share && report.position_share < 0.5, "{}", report.position_share);
}

#[test]
fn a_value_just_outside_its_interval_is_rounding() {
    let model = models::builtin("teapot").expect("built in");
    let (stage, caster) = (stage(&model, UNBOUNDED_SHARE), Caster::new(&model));
    let (raycast, raster) = (stage.raycast(&caster), stage.raster());
    let enclosures = stage.enclosures(raster.get(AT[0], AT[1]).expect("covered"), true);
    let enclosure = *enclosures.iter().next().expect("one");
    let scale = stage.scene.frames()[raster.get(AT[0], AT[1]).expect("covered").face.0 as usize].scale;
    for (half_widths, cause) in [(0.5, None), (3.0, Some(Cause::Rounding))] {
        let moved = changed(&raster, |hit| {
            let mut hit = hit.expect("covered");
            let x = enclosure.position.expect("a bound")[0];
            hit.position.x += half_widths * x.half_width * scale;
            Some(hit)
        });
        let report = stage.against_raycast(&caster, &raycast, &moved).expect("comparable");
        assert_eq!(report.main_cause(), cause, "{half_widths}: {:?}", report.worst.first());
    }
}

#[test]
fn a_control_point_that_was_packed_wrongly_is_noticed_though_the_program_is_right() {
    let model = models::builtin("teapot").expect("built in");
    let caster = Caster::new(&model);
    let mut stage = stage(&model, UNBOUNDED_SHARE);
    let raycast = stage.raycast(&caster);
    // Far below what moves a pixel: only the numbers can tell.
    let wider = |surface: &Surface| {
        let [u, v] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
        let points = surface.points().iter().map(|p| *p * DVec3::new(1.0 + 3e-6, 1.0, 1.0)).collect();
        Surface::new(u, v, points, surface.weights().map(<[f64]>::to_vec)).expect("as legal as before")
    };
    let surfaces = model.surfaces().iter().map(wider).collect();
    let wider = Model::new("wider".to_owned(), surfaces, model.faces().to_vec()).expect("as legal as before");
    stage.scene = Arc::new(PackedScene::new(&wider, stage.plan.scheme).expect("it packs"));
    let report = stage.against_raycast(&caster, &raycast, &stage.raster()).expect("comparable");
    assert_eq!(report.verdict, Verdict::Differ);
    assert!(report.worst[0].detail.contains("the packed face is off"), "{:?}", report.worst[0]);
}

#[test]
fn too_many_pixels_without_a_bound_are_no_agreement() {
    let model = models::builtin("sphere").expect("built in");
    let caster = Caster::new(&model);
    let mut verdicts = vec![];
    for share in [0.0, UNBOUNDED_SHARE, 1.0] {
        let stage = stage(&model, share);
        let report = stage.against_raycast(&caster, &stage.raycast(&caster), &stage.raster()).expect("comparable");
        let few = report.unbounded as f64 <= share * report.covered as f64;
        assert_eq!(report.verdict == Verdict::Agree, few, "{} {:?}", report.unbounded, report.explanation);
        assert_eq!(report.explanation.is_none(), few);
        verdicts.push(report.verdict);
    }
    assert_eq!(verdicts[2], Verdict::Agree);
}

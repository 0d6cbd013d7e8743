//! Whether "agree" means anything: pictures that a person would see to be wrong are judged, and must differ.

use compare::Verdict;
use isophote::conform::corpus::Suite;
use isophote::conform::wrong::Vacuity;
use isophote::stage::{Plan, Stage};
use raycast::Caster;
use scene::Viewport;

/// The scenes of a suite from the first of its viewpoints: what of them differs without a fault, agrees with one, or is
/// made of nothing.
fn failures(suite: Suite) -> Vec<String> {
    let mut failures = vec![];
    for scene in suite.scenes() {
        let model = models::builtin(scene.model).expect("built in");
        let caster = Caster::new(&model);
        let viewport = Viewport::new(suite.side(), suite.side()).expect("a legal size");
        let camera = scene.viewpoints[0].camera(&model, viewport);
        let raycast = caster.render(&camera, viewport, &|_| {});
        for plan in Suite::Smoke.plans(scene) {
            let plan = Plan { unbounded_share: scene.unbounded_share, ..plan };
            let stage = Stage::new(&model, camera, viewport, plan).expect("a stage");
            let raster = stage.raster();
            let pair = stage.against_raycast(&caster, &raycast, &raster).expect("comparable");
            let found = Vacuity::of(&stage, &caster, &raycast, &raster).expect("comparable");
            let name = format!("{}, {}", scene.name, plan.technique.name());
            println!(
                "{name}: {} of {} caught, {} of {} pixels, unbounded {} of {}: {:?}; greatest bound {:.4} px of {:.4}",
                found.caught,
                found.made,
                found.differing,
                found.pixels,
                pair.unbounded,
                pair.covered,
                pair.reasons(),
                pair.greatest_bound_px,
                pair.limit_px
            );
            if pair.verdict != Verdict::Agree {
                failures.push(format!("{name}: {:?} {:?} {:?}", pair.verdict, pair.causes, pair.explanation));
            }
            if !found.missed.is_empty() || found.made < 5 {
                failures.push(format!("{name}: {found:?}"));
            }
        }
    }
    failures
}

#[test]
fn every_picture_that_is_seen_to_be_wrong_differs_on_the_standard_suite() {
    let failures = failures(Suite::Standard);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

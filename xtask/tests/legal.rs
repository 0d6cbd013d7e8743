//! Adapters that make the worst of WGSL's arithmetic, against the judge; and the machine that they run on, against the twin.

use compare::Verdict;
use isophote::conform::corpus::{Scene, Suite};
use isophote::stage::{Plan, Stage};
use raycast::Caster;
use scene::Viewport;
use techniques::Technique;
use xtask::legal::Judged;
use xtask::legal::arithmetic::Fault;
use xtask::legal::picture::{self, Adapter};

const FRAGMENT: &dyn Technique = &techniques::fragment::Fragment;
const EXACT: &dyn Technique = &techniques::exact::Exact;

/// Draws a scene of the smoke suite small, and hands it to `visit`.
fn with(name: &str, side: usize, technique: &'static dyn Technique, visit: impl FnOnce(&Judged, &picture::Scene)) {
    let scenes = Suite::Smoke.scenes();
    let scene: &Scene = scenes.iter().find(|scene| scene.name == name).expect("a scene of the suite");
    let model = scene.open().expect("built in");
    let viewport = Viewport::new(side, side).expect("legal");
    let camera = scene.viewpoints[0].camera(&model, viewport);
    let plan = Plan { technique, unbounded_share: 0.05, ..Plan::default() };
    let stage = Stage::new(&model, camera, viewport, plan).expect("it can be drawn");
    let caster = Caster::new(&model);
    visit(&Judged::new(&stage, &caster), &picture::Scene::new(&stage).expect("its programs can be run"));
}

/// Not a pasted number: another reading of the program, compiled by another compiler, with each bit the same.
#[test]
fn the_wgsl_program_run_strictly_gives_the_rasterizers_bits() {
    let mut pixels = 0;
    for scene in Suite::Smoke.scenes().into_iter().filter(|scene| !scene.masked) {
        for technique in [FRAGMENT, EXACT] {
            with(scene.name, 20, technique, |judged, drawn| {
                let picture = drawn.draw(Adapter::STRICT).expect("it ends");
                let differing = picture.pixels().zip(judged.raster().pixels()).filter(|(a, b)| a != b).count();
                assert_eq!(differing, 0, "{} by {} of {} pixels", scene.name, technique.name(), picture.covered());
                assert_eq!(picture.undecided(), judged.raster().undecided(), "{}", scene.name);
                pixels += picture.covered();
            });
        }
    }
    assert!(pixels > 3_000, "{pixels}");
}

#[test]
fn a_hundred_legal_adapters_agree() {
    let scenes = [
        ("repeated-knots", FRAGMENT),
        ("weights-1-to-1000", FRAGMENT),
        ("trim-nested-islands", FRAGMENT),
        ("silhouette", EXACT),
    ];
    for (name, technique) in scenes {
        with(name, 10, technique, |judged, drawn| {
            let mut most = 0.0f64;
            for seed in 0..100 {
                let picture = drawn.draw(Adapter::legal(seed)).expect("it ends");
                for report in judged.reports(&picture).expect("comparable") {
                    assert!(
                        report.verdict == Verdict::Agree,
                        "{name}, seed {seed}: {:?} {:?}",
                        report.worst.first(),
                        report.explanation
                    );
                    most = most.max(report.position_share);
                }
            }
            // The worst of one operation at a time uses more of the bound than rounding to nearest, which uses a sixth.
            assert!(most > 0.2, "{name}: {most}");
        });
    }
}

/// How many of six adapters with a fault differ.
fn caught(name: &str, fault: Fault) -> usize {
    let mut caught = 0;
    with(name, 24, FRAGMENT, |judged, drawn| {
        let differs = |seed: &u64| {
            let picture = drawn.draw(Adapter { fault: Some(fault), ..Adapter::legal(*seed) }).expect("it ends");
            judged.reports(&picture).expect("comparable").iter().any(|report| report.verdict == Verdict::Differ)
        };
        caught = (0..6).filter(differs).count();
    });
    caught
}

#[test]
fn a_division_off_by_4_ulp_a_product_by_2_and_a_root_by_8_are_caught() {
    assert!(caught("repeated-knots", Fault::Division) > 0);
    assert!(caught("repeated-knots", Fault::Product) > 0);
    assert!(caught("patches-teapot", Fault::Root) > 0);
}

/// Of a sum that is off by 2 ulp the bounds say nothing yet: they allow the worst of every operation at once.
#[test]
fn a_sum_off_by_2_ulp_is_not_caught() {
    assert_eq!(caught("repeated-knots", Fault::Sum), 0);
}

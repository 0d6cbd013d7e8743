//! A model drawn by bicubic patches: judged by its own surfaces, with the proven distance added and nothing else.

use compare::{PairReport, Verdict};
use isophote::approximate::{Approximated, approximated};
use isophote::stage::{Plan, Stage};
use nurbs::{Direction, KnotVector, Surface};
use raycast::Caster;
use scene::{Camera, Model, Viewport};
use techniques::Technique;

fn viewport() -> Viewport {
    Viewport::new(72, 56).expect("a legal size")
}

/// The rasterizer's picture of `drawn` in the place of `model` against rays cast at that, as `claimed` says how near it is.
fn judged(model: &Model, drawn: &Approximated, claimed: &Approximated, plan: Plan) -> PairReport {
    let camera = Camera::framing(model, viewport());
    let stage = Stage::new(&drawn.model, camera, viewport(), plan).expect("a stage");
    let stage = stage.in_place_of(model, &claimed.stand_in).expect("it packs");
    let caster = Caster::new(stage.truth());
    stage.against_raycast(&caster, &stage.raycast(&caster), &stage.raster()).expect("comparable")
}

/// Septic, with a hole, an island in it and a hole in that.
fn trimmed() -> Model {
    let [islands, septic] = ["islands", "septic"].map(|name| models::builtin(name).expect("built in"));
    let [to_u, to_v] = islands.surfaces()[0].domain();
    let surface = &septic.surfaces()[0];
    let moved = |direction: Direction, [start, end]: [f64; 2]| {
        let knots = surface.knots(direction);
        let (from, to) = knots.domain();
        let at = |t: &f64| if *t == to { end } else { start + (t - from) / (to - from) * (end - start) };
        KnotVector::new(knots.degree(), knots.knots().iter().map(at).collect()).expect("as legal")
    };
    let weights = surface.weights().map(<[f64]>::to_vec);
    let knots = [moved(Direction::U, to_u), moved(Direction::V, to_v)];
    let [ku, kv] = knots;
    let surface = Surface::new(ku, kv, surface.points().to_vec(), weights).expect("as legal");
    Model::new("septic with islands", vec![surface], islands.faces().to_vec()).expect("as legal")
}

fn pixel(model: &Model) -> f64 {
    Camera::framing(model, viewport()).pixel_at(viewport(), model.hull())
}

#[test]
fn bicubic_patches_agree_with_the_surfaces_that_they_stand_for() {
    let builtin = ["surface", "septic", "unclamped-rational", "bilinear-quartic", "sphere", "window"];
    for model in builtin.iter().filter_map(|name| models::builtin(name)).chain([trimmed()]) {
        let name = model.name();
        for share in [0.3, 0.01] {
            let drawn = approximated(&model, share * pixel(&model)).expect("it can be met");
            assert!(drawn.facts.bound <= share * pixel(&model) * 1.001, "{name}: {:?}", drawn.facts);
            for technique in techniques::ALL {
                let plan = Plan { technique: *technique, ..Plan::default() };
                let pair = judged(&model, &drawn, &drawn, plan);
                assert_eq!(pair.verdict, Verdict::Agree, "{name} by {}: {pair:#?}", technique.name());
                assert!(pair.covered > 300);
                // Of what is only near, a normal has no bound; of what is the same it has.
                assert_eq!(pair.normal_share == 0.0, drawn.facts.bound > 0.0, "{name}");
                assert!(pair.position_share > 0.0);
            }
        }
    }
}

/// Patches that are farther off than they are said to be, and those of another shape.
#[test]
fn a_picture_that_is_off_by_more_than_the_bound_is_caught() {
    let grid: &dyn Technique = techniques::named("grid").expect("there");
    for model in [models::builtin("septic").expect("built in"), trimmed()] {
        let name = model.name();
        let [coarse, fine] =
            [2.0, 0.01].map(|share| approximated(&model, share * pixel(&model)).expect("it can be met"));
        assert!(coarse.facts.bound > 4.0 * fine.facts.bound, "{name}");
        for technique in [techniques::ALL[0], grid] {
            let plan = Plan { technique, chord_px: 0.1, ..Plan::default() };
            let as_said = judged(&model, &coarse, &coarse, plan);
            assert_eq!(as_said.verdict, Verdict::Agree, "{name}: {as_said:#?}");
            // The same picture, whose pieces are said to be as near as the finer ones are.
            let mut claimed = approximated(&model, 2.0 * pixel(&model)).expect("as before");
            claimed.stand_in.error = fine.stand_in.error.clone();
            let pair = judged(&model, &coarse, &claimed, plan);
            assert_eq!(pair.verdict, Verdict::Differ, "{name}: {pair:#?}");
        }
    }
}

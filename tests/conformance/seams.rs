//! Pixels left out where two faces meet: a renderer whose triangles meet there vertex on vertex leaves out none.

use crate::hidden::drawn;
use compare::Cause;
use gbuffer::{GBuffer, Hit};
use isophote::stage::{Plan, Stage};
use raycast::Caster;
use scene::{Camera, Model, Viewport};

const WIDTH: usize = 96;
const HEIGHT: usize = 72;

/// What a pixel at a seam is made to show.
#[derive(Clone, Copy)]
enum Shown {
    Nothing,
    /// What lies behind both faces.
    Behind,
}

/// Whether a pixel is beside another face, and not beside an outline: all around it is about as far away.
fn is_at_seam(raycast: &GBuffer, x: usize, y: usize) -> bool {
    let Some(own) = raycast.get(x, y) else { return false };
    if x == 0 || y == 0 || x + 1 == WIDTH || y + 1 == HEIGHT {
        return false;
    }
    let around: Vec<Option<&Hit>> = (0..9).map(|k| raycast.get(x + k % 3 - 1, y + k / 3 - 1)).collect();
    let is_near = |hit: &Option<&Hit>| hit.is_some_and(|hit| (hit.t / own.t - 1.0).abs() < 0.03);
    around.iter().all(is_near) && around.iter().flatten().any(|hit| hit.face != own.face)
}

/// How many pixels at seams were made wrong, and how many of them the judge let pass, against rays and against the CPU's picture.
fn let_pass(model: &Model, plan: Plan, shown: Shown) -> (usize, [usize; 2]) {
    let viewport = Viewport::new(WIDTH, HEIGHT).expect("a legal size");
    let stage = Stage::new(model, Camera::framing(model, viewport), viewport, plan).expect("a stage");
    let caster = Caster::new(model);
    let (raycast, raster) = (stage.raycast(&caster), stage.raster());
    let mut wrong = 0;
    let mut pixel = |x: usize, y: usize| {
        let own = raster.get(x, y).copied();
        if !is_at_seam(&raycast, x, y) {
            return own;
        }
        let behind = || {
            let ray = stage.camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5);
            let first = raycast.get(x, y)?.t;
            caster.all(&ray).hits.iter().find(|hit| hit.t > 1.05 * first).map(|hit| drawn(&stage, hit, &ray))
        };
        let made = match shown {
            Shown::Nothing => None,
            Shown::Behind => behind(),
        };
        wrong += 1;
        made
    };
    let rows: Vec<Vec<Option<Hit>>> = (0..HEIGHT).map(|y| (0..WIDTH).map(|x| pixel(x, y)).collect()).collect();
    let picture = GBuffer::from_rows(viewport, stage.meta("gpu"), rows);
    let reports = [
        stage.against_raycast(&caster, &raycast, &picture).expect("comparable"),
        stage.against_raster(&raster, &picture).expect("comparable"),
    ];
    let found = reports.map(|report| {
        let of = |cause| report.causes.get(&cause).copied().unwrap_or(0);
        wrong - (of(Cause::Coverage) + of(Cause::Depth))
    });
    (wrong, found)
}

/// Near a corner of a face the judge makes allowances: where a seam ends, not all of its faces need meet.
#[test]
fn what_is_left_out_at_a_seam_is_found() {
    for technique in techniques::ALL.iter().filter(|technique| technique.claims() == compare::Claims::Chord) {
        for shown in [Shown::Nothing, Shown::Behind] {
            let model = models::builtin("teapot").expect("built in");
            let plan = Plan { technique: *technique, ..Plan::default() };
            let (wrong, passed) = let_pass(&model, plan, shown);
            assert!(
                wrong > 400 && passed.iter().all(|passed| 20 * passed < wrong),
                "{technique:?}: {wrong}, {passed:?}"
            );
        }
    }
}

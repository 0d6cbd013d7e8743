//! Verdicts over the named inputs: "agree" is never said over a bound that says nothing, nor over nothing.

use super::field;
use compare::{PairReport, UNBOUNDED_SHARE, Unbounded, Verdict};
use gbuffer::{GBuffer, Hit};
use glam::{DVec2, DVec3};
use isophote::conform::wrong::wrong;
use isophote::stage::{Plan, Stage};
use raycast::Caster;
use scene::{Camera, Model, Projection, Viewport};
use techniques::Technique;

fn model(name: &str) -> Model {
    let path = field(name).to_str().expect("UTF-8").to_owned();
    isophote::view::ModelArgs::named(&path).open().expect("a model")
}

fn viewport() -> Viewport {
    Viewport::new(96, 72).expect("a legal size")
}

fn plan(technique: &'static dyn Technique) -> Plan {
    Plan { technique, ..Plan::default() }
}

/// What "agree" promises, without the judge: of what is shown S(u, v) is near its pixel, and what the rays see all around is
/// shown.
fn is_kept(stage: &Stage, raycast: &GBuffer, shown: &GBuffer, limit_px: f64) -> Result<(), String> {
    let (width, height) = (stage.viewport.width(), stage.viewport.height());
    let (mut off, mut holes) = (0, 0);
    let mut allowed = 0.0;
    for y in 1..height - 1 {
        for x in 1..width - 1 {
            allowed += UNBOUNDED_SHARE * f64::from(u8::from(raycast.get(x, y).is_some()));
            let center = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            if let Some(hit) = shown.get(x, y) {
                let s = stage.model.surface(hit.face).point(hit.uv.x, hit.uv.y);
                let seen = stage.camera.picture(stage.viewport, s);
                off += usize::from(!seen.is_some_and(|p| p.distance(center) <= 2.0 * limit_px));
            } else {
                let around = [(x, y), (x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
                holes += usize::from(around.iter().all(|&(x, y)| raycast.get(x, y).is_some()));
            }
        }
    }
    let is_kept = (off + holes) as f64 <= allowed;
    if is_kept { Ok(()) } else { Err(format!("{off} pixels off and {holes} holes, {allowed:.1} allowed")) }
}

/// The judge's answer for the CPU's picture, which must be sound: counts add up, and no pixel agrees over a loose bound.
fn judged(model: &Model, camera: Camera, technique: &'static dyn Technique, name: &str) -> PairReport {
    let stage = Stage::new(model, camera, viewport(), plan(technique)).expect("a stage");
    let caster = Caster::new(model);
    let (raycast, raster) = (stage.raycast(&caster), stage.raster());
    let pair = stage.against_raycast(&caster, &raycast, &raster).expect("comparable");
    let counts = pair.counts();
    assert_eq!(
        pair.agree + counts.differing + counts.undecided + counts.unanswered + counts.unbounded,
        pair.covered,
        "{name}"
    );
    assert_eq!(pair.unbounded_causes.values().sum::<usize>(), pair.unbounded, "{name}");
    assert!(pair.agree == 0 || pair.greatest_bound_px < pair.limit_px, "{name}: {}", pair.greatest_bound_px);
    println!("{name}: {:?} {} of {}, {:?} {:?}", pair.verdict, pair.agree, pair.covered, pair.causes, pair.reasons());
    if pair.verdict == Verdict::Agree {
        let kept = is_kept(&stage, &raycast, &raster, pair.limit_px);
        assert_eq!(kept, Ok(()), "{name} agrees");
    }
    // Wrong pictures never agree, whether the right one does or not.
    for wrong in wrong(&stage, &raster).expect("drawn") {
        let pair = stage.against_raycast(&caster, &raycast, &wrong.buffer).expect("comparable");
        assert_ne!(pair.verdict, Verdict::Agree, "{name}, {} in {} pixels", wrong.name, wrong.pixels);
    }
    pair
}

/// A camera that looks at the middle of the first face, `distance` model units from it, at a slant.
fn near(model: &Model, distance: f64) -> Camera {
    let [[u0, u1], [v0, v1]] = model.surfaces()[0].domain();
    let d = model.surfaces()[0].first_derivatives(0.5 * (u0 + u1), 0.5 * (v0 + v1));
    let normal = d.su.cross(d.sv).normalize();
    let eye = d.s + distance * (normal + 0.7 * d.su.normalize());
    let projection = Projection::Perspective { fov_deg: 50.0 };
    Camera::look_at(eye, d.s, d.sv, projection).expect("a legal camera")
}

#[test]
fn narrow_spans_large_weights_and_wide_amplitudes_agree_only_within_their_bound() {
    let names = [
        "01-min-span-1e-08",
        "01-amp-deg2-0.2",
        "28-weight-one-100",
        "28-weight-one-1000",
        "C4-span-triple-1e-3",
        "C4-span-triple-1e-6",
    ];
    for name in names {
        let model = model(name);
        let camera = Camera::framing(&model, viewport());
        for &technique in techniques::ALL {
            judged(&model, camera, technique, &format!("{name}, {}", technique.name()));
        }
    }
}

#[test]
fn close_ups_agree_only_within_their_bound_and_never_when_shifted() {
    let model = model("46-close-up");
    for distance in [0.3, 0.03, 0.003, 0.0003] {
        judged(&model, near(&model, distance), &techniques::fragment::Fragment, &format!("at {distance}"));
    }
}

/// The near plane is behind the surface in part of the picture, and triangles reach the eye.
#[test]
fn an_eye_on_the_surface_gets_no_agreement_over_an_empty_picture() {
    let model = models::builtin("petal").expect("built in");
    let camera = near(&model, 1e-9);
    let stage = Stage::new(&model, camera, viewport(), Plan::default()).expect("a stage");
    let caster = Caster::new(&model);
    let raycast = stage.raycast(&caster);
    assert!(raycast.covered() > 0);
    let nothing = GBuffer::from_rows(viewport(), stage.meta("raster"), vec![vec![None; 96]; 72]);
    let pair = stage.against_raycast(&caster, &raycast, &nothing).expect("comparable");
    assert_ne!(pair.verdict, Verdict::Agree, "{pair:?}");
}

/// Of a sliver thinner than a pixel the rasterizers may cover nothing: they then compare nothing with each other, and the
/// pairs with the ray caster are reported all the same.
#[test]
fn a_pair_that_shows_nothing_has_no_verdict_and_ends_no_other() {
    let model = model("25-sliver-100000");
    let caster = Caster::new(&model);
    let stages = (24..256).step_by(8).map(|side| {
        let viewport = Viewport::new(side, side).expect("a legal size");
        Stage::new(&model, Camera::framing(&model, viewport), viewport, Plan::default()).expect("a stage")
    });
    let is_of_that_kind = |stage: &Stage| stage.raster().covered() == 0 && stage.raycast(&caster).covered() > 0;
    let stage = stages.into_iter().find(is_of_that_kind).expect("some size is of that kind");
    let rendered = stage.render(&caster, None, None);
    let pairs = stage.compare(&caster, &rendered).expect("pairs are reported");
    assert_eq!(pairs.len(), 3);
    for pair in &pairs {
        let expected = if pair.covered == 0 { Verdict::NoVerdict } else { Verdict::Agree };
        assert_eq!(pair.verdict, expected, "{} | {}: {:?}", pair.reference, pair.candidate, pair.causes);
        assert_eq!(pair.explanation.is_some(), pair.covered == 0);
    }
    assert!(pairs[0].covered > 0, "the case is one of that kind");
}

/// f64 tells 8,400 parameters apart in the whole domain, where f32 tells 2²⁴: the same picture as if drawn by others.
#[test]
fn parameters_that_f64_cannot_hold_are_counted_and_are_no_difference() {
    let model = model("49-domain-1e+09-0.00100005");
    let camera = Camera::framing(&model, viewport());
    let stage = Stage::new(&model, camera, viewport(), plan(&techniques::exact::Exact)).expect("a stage");
    let caster = Caster::new(&model);
    let raycast = stage.raycast(&caster);
    let of_domain = |(x, y)| raycast.get(x, y).map(|hit| Hit { local: None, ..*hit });
    let rows =
        (0..raycast.viewport().height()).map(|y| (0..raycast.viewport().width()).map(|x| of_domain((x, y))).collect());
    let foreign = GBuffer::from_rows(raycast.viewport(), stage.meta("foreign"), rows);
    let pair = stage.against_raycast(&caster, &raycast, &foreign).expect("comparable");
    assert!(pair.covered > 1000);
    assert_eq!((pair.differing(), pair.reasons()), (0, vec![(Unbounded::Parameters, pair.covered)]));
    assert_eq!(pair.verdict, Verdict::NoVerdict, "nothing was judged, so nothing agrees");
    // Ours say on which piece they are, and where on it.
    let pair = stage.against_raycast(&caster, &raycast, &stage.raster()).expect("comparable");
    assert_eq!((pair.verdict, pair.unbounded), (Verdict::Agree, 0), "{:?} {:?}", pair.causes, pair.worst.first());
}

/// One pixel's centre is a little beyond a border that v comes to at a slant: it shows the nearest place of the border.
#[test]
fn a_pixel_beyond_a_slanted_border_shows_the_nearest_place_of_it() {
    let model = model("truth-gear_face116");
    let eye = DVec3::new(-291.527116618492, 325.0387085421903, -143.46960427109516);
    let target = DVec3::new(-52.411109499999995, 38.0995, 0.0);
    let projection = Projection::Perspective { fov_deg: 50.0 };
    let camera = Camera::look_at(eye, target, DVec3::Z, projection).expect("a legal camera");
    let viewport = Viewport::new(192, 144).expect("a legal size");
    let caster = Caster::new(&model);
    for &technique in techniques::ALL {
        let stage = Stage::new(&model, camera, viewport, plan(technique)).expect("a stage");
        let raycast = stage.raycast(&caster);
        let pair = stage.against_raycast(&caster, &raycast, &stage.raster()).expect("comparable");
        println!("{}: {:?} {:?} {:?}", technique.name(), pair.verdict, pair.causes, pair.worst);
        assert_eq!(pair.differing(), 0, "{:?}", pair.worst);
    }
}

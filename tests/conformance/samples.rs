//! Several samples a pixel: where they are, what their mean shows, and that each is judged.

use crate::three_way::words;
use compare::{CompareError, PairReport, Verdict};
use gbuffer::{GBuffer, Meta, Picture, ShadeKind, Shading};
use glam::{DVec2, DVec3, dvec2};
use isophote::stage::{Plan, Rendered, Stage};
use nurbs::{KnotVector, Surface};
use raycast::Caster;
use scene::{Camera, Face, Loop, Model, Projection, SamplePattern, Trim, Viewport};
use std::f64::consts::PI;

const ADAPTER: &str = "a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`";

/// The patterns with several samples.
const PATTERNS: [SamplePattern; 3] = [SamplePattern::Four, SamplePattern::Eight, SamplePattern::Sixteen];

fn curve(degree: usize, points: Vec<DVec2>, weights: Option<Vec<f64>>) -> Trim {
    let knots = [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat();
    let knots = KnotVector::new(degree, knots).expect("legal");
    Trim::new(knots, points, weights)
}

/// A polygon of (u, v), anticlockwise.
fn polygon(corners: &[DVec2]) -> Loop {
    let next = corners.iter().cycle().skip(1);
    let trims = corners.iter().zip(next).map(|(&a, &b)| curve(1, vec![a, b], None)).collect();
    Loop { outer: true, trims }
}

/// A circle about the origin, in four exact quarters.
fn circle(radius: f64) -> Loop {
    let compass = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y].map(|p| radius * p);
    let quarter = |k: usize| {
        let [a, b] = [compass[k], compass[(k + 1) % 4]];
        curve(2, vec![a, a + b, b], Some(vec![1.0, 0.5f64.sqrt(), 1.0]))
    };
    Loop { outer: true, trims: (0..4).map(quarter).collect() }
}

/// The square from −2 to 2 where (x, y) = (u, v), a face for each loop.
fn flat(loops: &[Loop]) -> Model {
    let knots = || KnotVector::new(1, vec![-2.0, -2.0, 2.0, 2.0]).expect("legal");
    let points = [(-2.0, -2.0), (-2.0, 2.0), (2.0, -2.0), (2.0, 2.0)].map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let surface = Surface::new(knots(), knots(), points, None).expect("legal");
    let face = |outline: &Loop| Face { loops: vec![outline.clone()], ..Face::whole(0) };
    Model::new("flat", vec![surface], loops.iter().map(face).collect()).expect("legal")
}

/// Looks straight down at a slope to rows and columns.
fn above(height: f64) -> Camera {
    let (eye, target) = (DVec3::new(0.0123, 0.0071, 5.0), DVec3::new(0.0123, 0.0071, 0.0));
    let projection = Projection::Orthographic { height };
    Camera::look_at(eye, target, DVec3::new(0.3, 1.0, 0.0), projection).expect("legal")
}

fn cast(caster: &Caster, camera: &Camera, viewport: Viewport) -> GBuffer {
    caster.render(camera, viewport, &|_| {})
}

/// The anti-aliased picture of rays.
fn averaged(model: &Model, pattern: SamplePattern, viewport: Viewport) -> Picture {
    let (caster, shading) = (Caster::new(model), Shading::new(ShadeKind::Phong));
    let cameras = pattern.cameras(&above(3.0), viewport);
    let shaded = |camera: &Camera| cast(&caster, camera, viewport).shaded(&shading, model, camera).expect("its faces");
    Picture::average(&cameras.iter().map(shaded).collect::<Vec<_>>()).expect("of one size")
}

/// Linear light of an sRGB value, 0 to 255.
fn light(value: u8) -> f64 {
    let x = f64::from(value) / 255.0;
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

#[test]
fn grey_levels_of_a_sloping_edge_are_those_of_the_published_positions() {
    let viewport = Viewport::new(24, 24).expect("legal");
    let corners = [dvec2(-0.8, -0.7), dvec2(0.9, -0.6), dvec2(0.7, 0.85), dvec2(-0.75, 0.65)];
    let (model, camera) = (flat(&[polygon(&corners)]), above(3.0));
    let seen = corners.map(|p| camera.picture(viewport, p.extend(0.0)).expect("in front"));
    // Rows run downward in the picture, so that the corners turn clockwise there.
    let depth_inside = |p: DVec2| {
        let side = |k: usize| (seen[(k + 1) % 4] - seen[k]).normalize().perp_dot(seen[k] - p);
        (0..4).map(side).fold(f64::INFINITY, f64::min)
    };
    for pattern in PATTERNS {
        let picture = averaged(&model, pattern, viewport);
        let count = pattern.positions().len();
        let (full, none) = (picture.pixel(12, 12), gbuffer::background());
        let mut levels = vec![0; count + 1];
        for (y, x) in (0..24).flat_map(|y| (0..24).map(move |x| (y, x))) {
            let depths =
                pattern.positions().iter().map(|p| depth_inside(dvec2(x as f64, y as f64) + DVec2::from_array(*p)));
            let depths: Vec<f64> = depths.collect();
            assert!(depths.iter().all(|depth| depth.abs() > 1e-9), "a sample on the very edge shows nothing");
            let covered = depths.iter().filter(|depth| **depth > 0.0).count();
            levels[covered] += 1;
            for channel in 0..3 {
                let share = covered as f64 / count as f64;
                let mean = share * light(full[channel]) + (1.0 - share) * light(none[channel]);
                let off = light(picture.pixel(x, y)[channel]) - mean;
                // Half a step of 8 bits, where steps of light are widest: 1.055 · 2.4 / 255 / 2 at white.
                assert!(off.abs() < 0.005, "{pattern:?} ({x}, {y}): {covered} of {count}, off by {off}");
            }
        }
        assert!(levels.iter().filter(|n| **n > 0).count() >= count.min(12), "{pattern:?}: {levels:?}");
    }
}

#[test]
fn two_faces_that_share_an_edge_show_nothing_of_what_is_behind_them() {
    let viewport = Viewport::new(24, 24).expect("legal");
    let corners = [dvec2(-0.8, -0.7), dvec2(0.9, -0.6), dvec2(0.7, 0.85), dvec2(-0.75, 0.65)];
    let [a, b, c, d] = corners;
    let [whole, split] = [flat(&[polygon(&corners)]), flat(&[polygon(&[a, b, c]), polygon(&[a, c, d])])];
    for pattern in PATTERNS {
        assert_eq!(averaged(&whole, pattern, viewport), averaged(&split, pattern, viewport), "{pattern:?}");
    }
}

#[test]
fn areas_by_samples_are_nearer_the_exact_ones_by_the_root_of_their_number_at_least() {
    // How far one sample a pixel is off depends on the radius in pixels (it is Gauss' circle problem), so that several
    // sizes are taken as well: by arithmetic over 200 of them the three patterns come to 0.37, 0.21 and 0.13 of it.
    const VIEWS: u32 = 96;
    let viewport = Viewport::new(40, 40).expect("legal");
    let sphere = models::builtin("sphere").expect("built in");
    for (model, radius) in [(sphere, 1.0), (flat(&[circle(0.83)]), 0.83)] {
        let caster = Caster::new(&model);
        let root_mean_square = |pattern: SamplePattern| {
            let error_px = |k: u32| {
                // Plastic numbers: places in a pixel that are spread evenly, and of no pattern's grid.
                let place = (DVec2::new(0.754_877_666_246_69, 0.569_840_290_998_05) * f64::from(k)).fract();
                let height = 2.6 + 1.3 * f64::from(k) / f64::from(VIEWS);
                let camera = above(height).with_lens_shift(place / 40.0).expect("finite");
                let cameras = pattern.cameras(&camera, viewport);
                let covered: usize = cameras.iter().map(|camera| cast(&caster, camera, viewport).covered()).sum();
                covered as f64 / cameras.len() as f64 - PI * (radius * 40.0 / height).powi(2)
            };
            ((0..VIEWS).map(|k| error_px(k).powi(2)).sum::<f64>() / f64::from(VIEWS)).sqrt()
        };
        let one = root_mean_square(SamplePattern::One);
        for pattern in PATTERNS {
            let (several, count) = (root_mean_square(pattern), pattern.positions().len() as f64);
            assert!(several * count.sqrt() <= one, "{} {pattern:?}: {several} of {one}", model.name());
        }
    }
}

#[test]
fn three_renderers_agree_on_every_sample_of_trimmed_faces() {
    let device = gpu::Device::open(None).expect(ADAPTER);
    let viewport = Viewport::new(40, 40).expect("legal");
    let mut found = vec![];
    for (name, pattern) in [("window", SamplePattern::Four), ("cusp", SamplePattern::Eight)] {
        let model = models::builtin(name).expect("built in");
        let caster = Caster::new(&model);
        for &technique in techniques::ALL {
            let plan = Plan { technique, ..Plan::default() };
            let stage = Stage::new(&model, Camera::framing(&model, viewport), viewport, plan).expect("a stage");
            let mut renderer = stage.renderer(&device, gpu::Overrides::default()).expect("the GPU takes it");
            let mut samples: Vec<Vec<PairReport>> = vec![];
            for sample in stage.samples(pattern) {
                let gpu = Ok(sample.drawn_by(&mut renderer, None).expect("the GPU draws"));
                let rendered = Rendered { raycast: sample.raycast(&caster), raster: sample.raster(), gpu };
                samples.push(sample.compare(&caster, &rendered).expect("comparable"));
            }
            let count = |k: usize| samples.iter().map(|pairs| pairs[k].covered).sum::<usize>();
            let merged = |k: usize| PairReport::of_samples(samples.iter().map(|pairs| pairs[k].clone()));
            let pairs: Vec<PairReport> = (0..3).map(|k| merged(k).expect("there are samples")).collect();
            assert!(pairs.iter().enumerate().all(|(k, pair)| pair.covered == count(k)));
            assert!(pairs[0].covered > 50 * samples.len(), "{name} shows too little");
            found.extend(words(name, &format!("{technique:?}"), &pairs));
        }
    }
    assert!(found.is_empty(), "{} pairs differ\n{}", found.len(), found.join("\n"));
}

#[test]
fn a_sample_taken_for_another_is_refused_or_found_and_named() {
    let viewport = Viewport::new(40, 40).expect("legal");
    let model = models::builtin("window").expect("built in");
    let caster = Caster::new(&model);
    let plan = Plan { technique: &techniques::exact::Exact, ..Plan::default() };
    let stage = Stage::new(&model, Camera::framing(&model, viewport), viewport, plan).expect("a stage");
    let samples: Vec<Stage> = stage.samples(SamplePattern::Four).collect();
    let buffers: Vec<GBuffer> = samples.iter().map(Stage::raster).collect();
    let judged =
        |k: usize, candidate: &GBuffer| samples[k].against_raycast(&caster, &samples[k].raycast(&caster), candidate);
    let error = judged(2, &buffers[1]).expect_err("another sample's");
    assert!(matches!(error.downcast_ref(), Some(CompareError::OtherScene { what: "camera", .. })), "{error:#}");
    // The same, lying about where it was taken.
    let camera = buffers[2].meta().camera.clone();
    let false_sample = buffers[1].clone().with_meta(Meta { camera, ..buffers[1].meta().clone() });
    let reports = (0..4).map(|k| judged(k, if k == 2 { &false_sample } else { &buffers[k] }).expect("comparable"));
    let report = PairReport::of_samples(reports).expect("four");
    assert_eq!(report.verdict, Verdict::Differ);
    assert!(report.differing() > 100, "{:?}", report.causes);
    assert!(report.worst.iter().all(|pixel| pixel.sample == Some(2)), "{:?}", report.worst[0]);
}

#[test]
fn a_picture_of_many_samples_agrees_only_where_each_of_them_does() {
    let viewport = Viewport::new(24, 24).expect("legal");
    let model = models::builtin("sphere").expect("built in");
    let caster = Caster::new(&model);
    let report = |unbounded_share: f64| {
        let plan = Plan { unbounded_share, ..Plan::default() };
        let stage = Stage::new(&model, Camera::framing(&model, viewport), viewport, plan).expect("a stage");
        stage.against_raycast(&caster, &stage.raycast(&caster), &stage.raster()).expect("comparable")
    };
    let (good, none) = (report(1.0), PairReport::of_samples([]));
    assert_eq!((good.verdict, none), (Verdict::Agree, None));
    assert_eq!(PairReport::of_samples([good.clone()]), Some(good.clone()));
    let bad = PairReport { verdict: Verdict::Differ, explanation: Some("too many".to_owned()), ..good.clone() };
    for (reports, sample) in [([bad.clone(), good.clone()], 0), ([good, bad], 1)] {
        let merged = PairReport::of_samples(reports).expect("two");
        assert_eq!(merged.verdict, Verdict::Differ);
        assert_eq!(merged.explanation, Some(format!("sample {sample}: too many")));
    }
}

#[test]
fn a_lens_shift_is_written_where_there_is_one_and_read_back_to_the_bit() {
    let plain = serde_json::json!(above(3.0));
    let mut keys: Vec<&String> = plain.as_object().expect("an object").keys().collect();
    keys.sort_unstable();
    assert_eq!(keys, ["eye", "near", "projection", "target", "up"]);
    let camera = above(3.0).with_lens_shift(dvec2(0.1, -1.0 / 3.0)).expect("finite");
    let text = serde_json::to_string(&camera).expect("finite numbers");
    assert_eq!(serde_json::from_str::<Camera>(&text).expect("a camera"), camera);
    assert!(text.contains("lens_shift") && camera != above(3.0));
}

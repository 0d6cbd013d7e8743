//! A renderer that is not ours: `docs/examples/foreign_renderer.py` drew these files, and is judged like one of ours.

use compare::{Cause, PairReport, Verdict};
use gbuffer::{GBuffer, Hit, Meta, PrincipalCurvatures};
use glam::{DVec2, DVec3, Vec2Swizzles};
use isophote::compare::Saved;
use isophote::stage::Plan;
use nurbs::{Direction, Normal};
use raycast::Caster;
use scene::{Camera, FaceId, Model, Ray, Viewport};
use std::path::{Path, PathBuf};

/// A file that NumPy wrote.
fn frozen(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../testdata/foreign").join(name)
}

fn drawn() -> GBuffer {
    GBuffer::read_npz(frozen("teapot.npz")).expect("the frozen file is readable")
}

fn written(name: &str, buffer: &GBuffer) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("foreign-{name}.npz"));
    buffer.write_npz(&path).expect("a file can be written");
    path
}

fn judged(paths: &[PathBuf]) -> Vec<PairReport> {
    let saved = Saved::open(paths, None).unwrap_or_else(|error| panic!("{error:#}"));
    saved.compare(Plan::default(), None).unwrap_or_else(|error| panic!("{error:#}")).pairs
}

/// Why files are not compared at all.
fn refusal(paths: &[PathBuf], model: Option<&str>) -> String {
    let result = Saved::open(paths, model).and_then(|saved| saved.compare(Plan::default(), None));
    format!("{:#}", result.err().expect("it is refused"))
}

/// The buffer with each pixel replaced by what `pixel` makes of its place.
fn changed(buffer: &GBuffer, pixel: impl Fn(usize, usize) -> Option<Hit>) -> GBuffer {
    let viewport = buffer.viewport();
    let rows = (0..viewport.height()).map(|y| (0..viewport.width()).map(|x| pixel(x, y)).collect());
    GBuffer::from_rows(viewport, buffer.meta().clone(), rows)
}

/// The buffer with each hit changed.
fn each(buffer: &GBuffer, change: impl Fn(Hit) -> Hit) -> GBuffer {
    changed(buffer, |x, y| buffer.get(x, y).map(|hit| change(*hit)))
}

fn labelled(buffer: GBuffer, renderer: &str, technique: &str) -> GBuffer {
    let meta = Meta { renderer: renderer.to_owned(), technique: technique.to_owned(), ..buffer.meta().clone() };
    buffer.with_meta(meta)
}

/// The teapot as the ray caster sees it, by its rays shifted by `shift` pixels and changed by `aim`.
fn cast(buffer: &GBuffer, shift: f64, aim: impl Fn(&Caster, Ray) -> Ray) -> GBuffer {
    let (model, camera, viewport) = teapot(buffer);
    let caster = Caster::new(&model);
    changed(buffer, |x, y| {
        let ray = camera.ray(viewport, x as f64 + 0.5 + shift, y as f64 + 0.5 + shift);
        caster.first(&aim(&caster, ray)).hit
    })
}

fn teapot(buffer: &GBuffer) -> (Model, Camera, Viewport) {
    let model = models::builtin("teapot").expect("built in");
    let camera = serde_json::from_value(buffer.meta().camera.clone()).expect("a camera");
    (model, camera, buffer.viewport())
}

#[test]
fn a_numpy_renderer_agrees_with_the_ray_caster() {
    let pairs = judged(&[frozen("teapot.npz")]);
    let [pair] = &pairs[..] else { panic!("one pair, not {}", pairs.len()) };
    assert_eq!((pair.reference.as_str(), pair.candidate.as_str()), ("raycast", "numpy-example"));
    assert_eq!(pair.verdict, Verdict::Agree, "{:?} {:?}", pair.causes, pair.worst.first());
    // It evaluates in f64 by another algorithm. Its (u, v) are no f32's, so the interval is that of both neighbours and its
    // middle is not the value itself; a tenth holds what that amounts to.
    assert!(pair.covered > 700 && pair.position_share < 0.1 && pair.normal_share < 0.1, "{pair:?}");
    // What flat triangles are off by is there to be seen, and within the claim and the snapping.
    assert!(0.01 < pair.max_px && pair.greatest_bound_px < 0.26, "{} {}", pair.max_px, pair.greatest_bound_px);
}

#[test]
fn arrays_that_numpy_stored_plainly_and_in_single_precision_are_judged_alike() {
    let pairs = judged(&[frozen("plain.npz")]);
    assert_eq!(pairs[0].verdict, Verdict::Agree, "{:?}", pairs[0].causes);
    assert!(pairs[0].covered > 90);
}

#[test]
fn what_numpy_may_store_and_is_not_read_is_refused_in_words() {
    for (name, words) in [
        ("fortran.npz", "\"pos\" is in Fortran order"),
        ("big-endian.npz", "\"u\" has dtype \">f8\""),
        ("half.npz", "\"normal\" has dtype \"<f2\""),
        ("misspelt.npz", "\"curvature.npy\" is none of the arrays"),
    ] {
        let message = refusal(&[frozen(name)], None);
        assert!(message.contains(name) && message.contains(words), "{message}");
    }
}

#[test]
fn each_mistake_of_a_foreign_renderer_is_caught_and_its_cause_named() {
    let sound = drawn();
    let (model, camera, viewport) = teapot(&sound);
    let count = model.faces().len() as u32;
    let on_ray = |x: usize, y: usize| {
        let hit = sound.get(x, y)?;
        let position = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5).at(hit.t);
        Some(Hit { position, ..*hit })
    };
    let turned =
        |hit: Hit, turn: fn(DVec3) -> Normal| Hit { normal: hit.normal.unit().map_or(hit.normal, turn), ..hit };
    let second = |caster: &Caster, ray: Ray| {
        let behind = caster.first(&ray).hit.map(|hit| Ray { near: hit.t + 1e-6, ..ray });
        behind.filter(|ray| caster.first(ray).hit.is_some()).unwrap_or(ray)
    };
    let last = viewport.height() - 1;
    let faults = [
        ("u and v exchanged", each(&sound, |hit| Hit { uv: hit.uv.yx(), ..hit }), Cause::Parameters),
        ("normals flipped", each(&sound, |hit| turned(hit, |n| Normal::Regular(-n))), Cause::Derivative),
        (
            "normals not of unit length",
            each(&sound, |hit| turned(hit, |n| Normal::Regular(1.01 * n))),
            Cause::NormalLength,
        ),
        ("no normals", each(&sound, |hit| Hit { normal: Normal::Undefined, ..hit }), Cause::DegenerateNormal),
        (
            "the next face's number",
            each(&sound, |hit| Hit { face: FaceId((hit.face.0 + 1) % count), ..hit }),
            Cause::Face,
        ),
        ("positions of the flat triangles", changed(&sound, on_ray), Cause::Position),
        (
            "curvatures of another unit",
            each(&sound, |hit| Hit { curvature: Some(PrincipalCurvatures { k1: 900.0, k2: -900.0 }), ..hit }),
            Cause::Curvature,
        ),
        ("upside down", changed(&sound, |x, y| sound.get(x, last - y).copied()), Cause::Interpolation),
        ("at the pixels' corners", cast(&sound, -0.5, |_, ray| ray), Cause::Interpolation),
        ("flat triangles that are called exact", labelled(sound.clone(), "solver", "exact"), Cause::Interpolation),
        ("the hidden side", cast(&sound, 0.0, second), Cause::Depth),
        (
            "the hidden side, at no distance",
            each(&cast(&sound, 0.0, second), |hit| Hit { t: 0.0, ..hit }),
            Cause::Depth,
        ),
        ("no distance", each(&sound, |hit| Hit { t: 0.0, ..hit }), Cause::Distance),
        ("half of the distance", each(&sound, |hit| Hit { t: 0.5 * hit.t, ..hit }), Cause::Distance),
        ("a distance in thousandths more", each(&sound, |hit| Hit { t: 1.001 * hit.t, ..hit }), Cause::Distance),
        ("a distance in millionths more", each(&sound, |hit| Hit { t: 1.00001 * hit.t, ..hit }), Cause::Distance),
        ("a distance behind the eye", each(&sound, |hit| Hit { t: -hit.t, ..hit }), Cause::Distance),
        ("depth from 0 to 1", each(&sound, |hit| Hit { t: 1.0 / hit.t, ..hit }), Cause::Distance),
        (
            "a hole in the middle",
            changed(&sound, |x, y| sound.get(x, y).filter(|_| x % 8 != 0).copied()),
            Cause::Coverage,
        ),
    ];
    let mut failures = vec![];
    for (name, buffer, cause) in faults {
        let pair = judged(&[written(&name.replace(' ', "-"), &buffer)]).remove(0);
        if (pair.verdict, pair.main_cause()) != (Verdict::Differ, Some(cause)) {
            failures.push(format!("{name}: {:?} {:?} {:?}", pair.verdict, pair.causes, pair.worst.first()));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Homogeneous coordinates about the world's origin, where ours are about the face's own.
#[test]
fn a_quotient_that_a_foreign_renderer_forgot_is_named() {
    let model = models::builtin("rational").expect("built in");
    let viewport = Viewport::new(32, 24).expect("a legal size");
    let caster = Caster::new(&model);
    let sound = caster.render(&Camera::framing(&model, viewport), viewport, &|_| ());
    let weight = |hit: &Hit| {
        let surface = model.surface(hit.face);
        let [u, v] = [(Direction::U, hit.uv.x), (Direction::V, hit.uv.y)].map(|(direction, t)| {
            let knots = surface.knots(direction);
            let span = knots.find_span(t);
            (span - knots.degree(), nurbs::basis_derivatives(knots, span, t, 0)[0])
        });
        let (weights, columns) = (surface.weights().expect("rational"), surface.control_counts()[1]);
        (0..4)
            .flat_map(|i| (0..4).map(move |j| (i, j)))
            .map(|(i, j)| u.1[i] * v.1[j] * weights[(u.0 + i) * columns + v.0 + j])
            .sum::<f64>()
    };
    let faulty = each(&sound, |hit| Hit { position: weight(&hit) * hit.position, ..hit });
    let pair = judged(&[written("numerator", &labelled(faulty, "homogeneous", "rays"))]).remove(0);
    assert_eq!(pair.main_cause(), Some(Cause::Rational), "{:?}", pair.causes);
}

#[test]
fn a_renderer_that_solves_on_the_ray_is_held_to_a_hundredth_of_a_pixel() {
    let shifted = |shift: f64| {
        let buffer = labelled(cast(&drawn(), shift, |_, ray| ray), "solver", "exact");
        judged(&[written(&format!("solver{shift}"), &buffer)]).remove(0)
    };
    let pair = shifted(0.0);
    assert_eq!(pair.verdict, Verdict::Agree, "{:?} {:?}", pair.causes, pair.worst.first());
    assert!(pair.max_px < 1e-6 && pair.greatest_bound_px < 1.01 * compare::EXACT_PX, "{pair:?}");
    assert_eq!(shifted(0.005).verdict, Verdict::Agree);
    assert_eq!(shifted(0.02).main_cause(), Some(Cause::Interpolation));
}

#[test]
fn two_files_are_judged_against_rays_and_against_each_other() {
    let solver = written("beside", &labelled(cast(&drawn(), 0.0, |_, ray| ray), "solver", "exact"));
    let names = |pairs: &[PairReport]| -> Vec<[String; 2]> {
        pairs.iter().map(|pair| [pair.reference.clone(), pair.candidate.clone()]).collect()
    };
    let pairs = judged(&[frozen("teapot.npz"), solver.clone()]);
    assert_eq!(names(&pairs), [["raycast", "numpy-example"], ["raycast", "solver"], ["numpy-example", "solver"]]);
    assert!(pairs.iter().all(|pair| pair.verdict == Verdict::Agree), "{pairs:?}");
    // A difference between the two shows in the last pair, too.
    let flipped = each(&GBuffer::read_npz(&solver).expect("readable"), |hit| Hit {
        normal: Normal::Regular(-hit.normal.unit().unwrap_or(DVec3::Z)),
        ..hit
    });
    let pairs = judged(&[frozen("teapot.npz"), written("flipped", &flipped)]);
    assert_eq!(
        pairs.iter().map(|pair| pair.verdict).collect::<Vec<_>>(),
        [Verdict::Agree, Verdict::Differ, Verdict::Differ]
    );
    // Two of one renderer are told apart by what they differ in, here the technique.
    let same_name = written("same-name", &labelled(cast(&drawn(), 0.0, |_, ray| ray), "numpy-example", "exact"));
    let pairs = judged(&[frozen("teapot.npz"), same_name]);
    assert_eq!(names(&pairs)[2], ["numpy-example (fragment)", "numpy-example (exact)"]);
}

#[test]
fn no_file_is_the_reference_whatever_it_calls_itself() {
    let sound = labelled(cast(&drawn(), 0.0, |_, ray| ray), "raycast", "rays");
    let half = changed(&sound, |x, y| sound.get(x, y).filter(|_| x < sound.viewport().width() / 2).copied());
    let names = |pairs: &[PairReport]| -> Vec<[String; 2]> {
        pairs.iter().map(|pair| [pair.reference.clone(), pair.candidate.clone()]).collect()
    };
    for (name, buffer, verdict) in [("rays", sound, Verdict::Agree), ("half", half, Verdict::Differ)] {
        let own = written(name, &buffer);
        let pairs = judged(std::slice::from_ref(&own));
        assert_eq!(names(&pairs), [["raycast", "raycast (saved)"]]);
        assert_eq!(pairs[0].verdict, verdict, "{:?}", pairs[0].causes);
        let pairs = judged(&[own, frozen("teapot.npz")]);
        let expected =
            [["raycast", "raycast (saved)"], ["raycast", "numpy-example"], ["raycast (saved)", "numpy-example"]];
        assert_eq!(names(&pairs), expected);
        assert_eq!(pairs.iter().map(|pair| pair.verdict).collect::<Vec<_>>(), [verdict, Verdict::Agree, verdict]);
    }
}

/// A field of `meta`, or a mark, that would otherwise allow something.
#[test]
fn nothing_that_a_file_says_of_itself_allows_it_more() {
    let sound = cast(&drawn(), 0.0, |_, ray| ray);
    let all = || (0..sound.viewport().height()).flat_map(|y| (0..sound.viewport().width()).map(move |x| (x, y)));
    let hole = changed(&sound, |x, y| sound.get(x, y).filter(|_| (x, y) != (30, 36)).copied());
    assert!(sound.get(30, 36).is_some());
    let one = |buffer: &GBuffer| judged(&[written("marked", buffer)]).remove(0);
    for (renderer, technique) in [("raycast", "rays"), ("raster", "fragment"), ("gpu", "exact"), ("solver", "rays")] {
        let pair = one(&labelled(hole.clone(), renderer, technique).with_undecided(all()));
        assert_eq!(
            (pair.verdict, pair.differing()),
            (Verdict::Differ, 1),
            "{renderer}, {technique}: {:?}",
            pair.causes
        );
    }
    // As the second of two files: marks of the first do not excuse what differs between them.
    let marked = written("first", &labelled(sound.clone(), "first", "exact").with_undecided(all()));
    let pairs = judged(&[marked, written("second", &labelled(hole.clone(), "second", "exact"))]);
    assert_eq!(pairs.iter().map(|pair| pair.differing()).collect::<Vec<_>>(), [0, 1, 1]);
    // Flat triangles are the caller's to allow.
    let triangles = written("triangles", &drawn());
    let saved = Saved::open(&[triangles], None).expect("readable");
    let exact = Plan { technique: &techniques::exact::Exact, ..Plan::default() };
    let pair = saved.compare(exact, None).expect("comparable").pairs.remove(0);
    assert_eq!(pair.main_cause(), Some(Cause::Interpolation));
}

#[test]
fn our_own_saved_files_are_compared_as_the_twins_that_they_are() {
    let model = models::builtin("torus").expect("built in");
    let viewport = Viewport::new(32, 24).expect("a legal size");
    let stage = isophote::stage::Stage::new(&model, Camera::framing(&model, viewport), viewport, Plan::default());
    let raster = stage.expect("a stage").raster();
    let other = labelled(raster.clone(), "gpu", "fragment");
    let pairs = judged(&[written("raster", &raster), written("gpu", &other)]);
    assert_eq!(pairs.len(), 3);
    assert!(pairs.iter().all(|pair| pair.verdict == Verdict::Agree), "{pairs:?}");
    assert!(pairs[2].greatest_bound_px < 0.1 * pairs[0].greatest_bound_px, "of the same triangles, no chord");
}

#[test]
fn files_that_do_not_belong_together_are_refused_by_name() {
    let sound = drawn();
    let with = |name: &str, change: &dyn Fn(&mut Meta)| {
        let mut meta = sound.meta().clone();
        change(&mut meta);
        written(name, &sound.clone().with_meta(meta))
    };
    let here = || frozen("teapot.npz");
    let cases: [(Vec<PathBuf>, Option<&str>, &[&str]); 10] = [
        (vec![here(), here()], None, &["both come from the renderer \"numpy-example\""]),
        (
            vec![here(), with("hash", &|meta| meta.model_hash = "0".repeat(16))],
            None,
            &["hash.npz", "000", "844900446074a0dd"],
        ),
        (vec![with("hash1", &|meta| meta.model_hash = "1".repeat(16))], None, &["hash1.npz", "1111", "\"teapot\""]),
        (vec![here()], Some("sphere"), &["teapot.npz", "\"sphere\""]),
        (vec![here(), frozen("plain.npz")], None, &["plain.npz", "size 24x24", "64x64"]),
        (
            vec![here(), with("camera", &|meta| meta.camera["eye"][0] = 3.5.into())],
            None,
            &["camera.npz", "camera", "3.5"],
        ),
        (
            vec![with("model", &|meta| meta.model = "boat.json".to_owned())],
            None,
            &["model.npz", "boat.json", "--model"],
        ),
        (vec![with("eye", &|meta| meta.camera["eye"] = meta.camera["target"].clone())], None, &["eye.npz", "coincide"]),
        (
            vec![with("technique", &|meta| meta.technique = "magic".to_owned())],
            None,
            &["technique.npz", "\"magic\"", "exact"],
        ),
        (vec![with("name", &|meta| meta.renderer = "a\u{1b}[2J".to_owned())], None, &["name.npz", "printable"]),
    ];
    for (paths, model, words) in cases {
        let message = refusal(&paths, model);
        assert!(words.iter().all(|word| message.contains(word)), "{words:?}: {message}");
    }
}

#[test]
fn values_that_no_model_has_are_refused_with_file_and_pixel() {
    let sound = drawn();
    let first = sound.pixels().position(|hit| hit.is_some()).expect("something is seen");
    let (x, y) = (first % sound.viewport().width(), first / sound.viewport().width());
    let spoilt = |name: &str, spoil: &dyn Fn(Hit) -> Hit| {
        let buffer =
            changed(&sound, |i, j| sound.get(i, j).map(|hit| if (i, j) == (x, y) { spoil(*hit) } else { *hit }));
        refusal(&[written(name, &buffer)], None)
    };
    for (message, words) in [
        (spoilt("nan-pos", &|hit| Hit { position: DVec3::NAN, ..hit }), "pos"),
        (spoilt("nan-u", &|hit| Hit { uv: DVec2::new(f64::NAN, 0.0), ..hit }), "u at"),
        (spoilt("inf-t", &|hit| Hit { t: f64::INFINITY, ..hit }), "t at"),
        (spoilt("face", &|hit| Hit { face: FaceId(32), ..hit }), "is 32; the model has 32"),
        (spoilt("outside", &|hit| Hit { uv: DVec2::new(hit.uv.x, 1.0001), ..hit }), "v at"),
    ] {
        let place = format!("pixel ({x}, {y})");
        assert!(message.contains(words) && message.contains(&place) && message.contains("foreign-"), "{message}");
    }
}

/// Any finite numbers on legal faces are judged, and nothing panics.
#[test]
fn random_numbers_are_judged_and_differ() {
    let sound = GBuffer::read_npz(frozen("plain.npz")).expect("readable");
    // Marsaglia's xorshift, seeded; a number of any size.
    let state = std::cell::Cell::new(0x2545_f491_4f6c_dd1du64);
    let next = || {
        let mut s = state.get();
        s ^= s << 13;
        s ^= s >> 7;
        s ^= s << 17;
        state.set(s);
        s
    };
    let any = || {
        let x = f64::from_bits(next());
        if x.is_finite() { x } else { 0.0 }
    };
    let unit = || (next() >> 11) as f64 / (1u64 << 53) as f64;
    for round in 0..8 {
        let vector =
            || if round % 2 == 0 { DVec3::new(any(), any(), any()) } else { DVec3::new(unit(), unit(), unit()) };
        let buffer = changed(&sound, |_, _| {
            Some(Hit {
                face: FaceId((next() % 32) as u32),
                uv: DVec2::new(unit(), unit()),
                local: None,
                t: if round % 4 < 2 { any() } else { unit() },
                position: vector(),
                normal: Normal::Regular(vector()),
                curvature: Some(PrincipalCurvatures { k1: any(), k2: any() }),
                edge: Some(DVec2::new(any(), any())),
            })
        })
        .with_edges(true);
        let pair = judged(&[written(&format!("random{round}"), &buffer)]).remove(0);
        assert_eq!((pair.verdict, pair.covered), (Verdict::Differ, sound.viewport().pixels()));
    }
}

/// The document that a foreign renderer draws holds the model to the bit, and the camera.
#[test]
fn a_scene_written_for_others_is_the_scene() {
    for name in ["teapot", "rational", "unclamped"] {
        let model = models::builtin(name).expect("built in");
        let viewport = Viewport::new(40, 30).expect("a legal size");
        let camera = Camera::framing(&model, viewport);
        let text = isophote::scene::document(&model, &camera, viewport).expect("a document").to_string();
        assert_eq!(formats::json::parse(&text, name).expect("a model").hash(), model.hash());
        let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(value["meta"]["model_hash"], model.hash());
        assert_eq!(serde_json::from_value::<Camera>(value["meta"]["camera"].clone()).expect("a camera"), camera);
    }
}

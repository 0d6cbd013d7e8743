//! The command line as a user meets it: exit codes, streams, and messages that name the file, the place and the value.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn isophote(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_isophote")).args(arguments).output().expect("isophote starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A file of its own for each test, in a folder that cargo gives to tests.
fn file(name: &str, content: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, content).expect("a file can be written");
    path
}

/// Asserts exit code 2, nothing on standard output, and every word in the message.
fn refused(arguments: &[&str], words: &[&str]) {
    let output = isophote(arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?}: {}", text(&output.stdout));
    assert!(!message.contains("panicked"), "{message}");
    for word in words {
        assert!(message.contains(word), "{arguments:?}: no {word:?} in: {message}");
    }
}

fn square() -> Value {
    json!({"format": "nurbs-neutral", "version": 1, "surfaces": [{
        "degree": [1, 1], "knots_u": [0.0, 0.0, 1.0, 1.0], "knots_v": [0.0, 0.0, 1.0, 1.0], "nu": 2, "nv": 2,
        "points": [[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0]], "weights": null,
    }]})
}

#[test]
fn bad_models_are_refused_with_file_place_and_value() {
    /// Name of the file, where the value goes, the value, what the message must contain.
    type Case = (&'static str, &'static str, Value, &'static [&'static str]);
    let cases: [Case; 6] = [
        ("decreasing", "/surfaces/0/knots_u/2", json!(-1.0), &["knots_u", "-1"]),
        ("weights", "/surfaces/0/weights", json!([1.0, 0.0, 1.0, 1.0]), &["surfaces[0]", "weight 1"]),
        ("counts", "/surfaces/0/nu", json!(3), &["surfaces[0]"]),
        ("degree", "/surfaces/0/degree", json!([16, 1]), &["degree", "16"]),
        ("empty", "/surfaces", json!([]), &["surfaces is []"]),
        ("format", "/version", json!(9), &["version", "9"]),
    ];
    for (name, place, value, words) in cases {
        let mut model = square();
        *model.pointer_mut(place).expect("a place in the model") = value;
        let file_name = format!("bad-{name}.json");
        let path = file(&file_name, &model.to_string());
        let words: Vec<&str> = [file_name.as_str()].into_iter().chain(words.iter().copied()).collect();
        refused(&["info", path.to_str().expect("UTF-8")], &words);
    }
    let text = square().to_string();
    let path = file("truncated.json", &text[..text.len() / 2]);
    refused(&["compare", path.to_str().expect("UTF-8")], &["truncated.json", "line 1"]);
    let path = file("nan.json", &text.replace("-1.0", "NaN"));
    refused(&["render", path.to_str().expect("UTF-8")], &["nan.json", "line 1", "NaN"]);
    refused(&["info", "no-such-model"], &["no-such-model", "teapot"]);
    refused(&["info", "no-such-file.json"], &["no-such-file.json"]);
}

#[test]
fn bad_views_are_refused_with_the_value() {
    refused(&["compare", "--size", "0x64"], &["0x64"]);
    refused(&["compare", "--size", "large"], &["large"]);
    refused(&["compare", "--size", "99999999x99999999"], &["99999999"]);
    refused(&["compare", "--size", "16384x16384"], &["16384x16384"]);
    refused(&["render", "--fov", "180"], &["180"]);
    refused(&["render", "--ortho", "-1"], &["-1"]);
    refused(&["render", "--eye", "0", "0", "1", "--target", "0", "0", "1"], &["coincide"]);
    refused(&["render", "--eye", "0", "0", "9", "--target", "0", "0", "0"], &["up vector"]);
    refused(&["render", "--eye", "NaN", "0", "9"], &["eye", "NaN"]);
    refused(&["render", "--near", "0"], &["near"]);
    refused(&["render", "--lens-shift", "0", "inf"], &["--lens-shift", "inf"]);
    refused(&["render", "--antialias", "3"], &["3", "4, 8, 16"]);
    for chord in ["0", "-1", "nan", "inf", "1e9"] {
        refused(&["compare", "--chord", chord], &["--chord", chord, "at most 64 pixels"]);
    }
    for share in ["nan", "5", "-0.01", "inf", "1e-400x"] {
        refused(&["compare", "--unbounded", share], &["--unbounded", share, "a share from 0 to 1"]);
    }
    for (option, value) in [("--fov", "nan"), ("--ortho", "inf"), ("--near", "-1e-9"), ("--mask-px", "NaN")] {
        refused(&["render", option, value], &[option, value]);
    }
    refused(&["render", "--eye", "0", "0", "--size", "8x8"], &["--eye", "--size"]);
    refused(&["pixel", "teapot", "600,1"], &["600"]);
    refused(&["no-such-command"], &["no-such-command"]);
}

#[test]
fn negative_numbers_may_have_exponents_in_every_command() {
    let model = file("negative.json", &square().to_string());
    let model = model.to_str().expect("UTF-8");
    let view = ["--eye", "-8e-05", "-.5", "2", "--target", "-1E-3", "0", "-2e-4", "--up", "-1e-7", "1", "0"];
    let shift = ["--lens-shift", "-1e-05", "0"];
    let output = isophote(&[&["scene", model], &view[..], &shift[..]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let scene: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let camera = &scene["meta"]["camera"];
    assert_eq!((&camera["eye"], &camera["target"]), (&json!([-8e-05, -0.5, 2.0]), &json!([-1e-3, 0.0, -2e-4])));
    assert_eq!(camera["lens_shift"], json!([-1e-05, 0.0]));
    let commands: [&[&str]; 3] =
        [&["render", model, "--with", "raycast"], &["compare", model, "--format", "json"], &["pixel", model, "4,4"]];
    for command in commands {
        let output = isophote(&[command, &view[..], &["--size", "8x8"]].concat());
        assert!(output.status.success(), "{command:?}: {}", text(&output.stderr));
    }
}

#[test]
fn without_an_adapter_the_other_two_are_compared_and_the_exit_code_is_2() {
    let output = Command::new(env!("CARGO_BIN_EXE_isophote"))
        .args(["compare", "--size", "48x48", "--format", "json"])
        // The Vulkan loader's two names for the list of drivers.
        .env("VK_DRIVER_FILES", "/nonexistent.json")
        .env("VK_ICD_FILENAMES", "/nonexistent.json")
        .output()
        .expect("isophote starts");
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object and nothing else");
    assert_eq!(report["pairs"].as_array().map(Vec::len), Some(1));
    assert_eq!(report["pairs"][0]["verdict"], "agree");
    let why = report["gpu_not_run"].as_str().expect("a reason");
    assert!(why.contains("apt-get install mesa-vulkan-drivers"), "{why}");
}

#[test]
fn compare_prints_one_json_object_that_agrees() {
    let output = isophote(&["compare", "--size", "64x64", "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object and nothing else");
    assert_eq!((&report["model"], &report["technique"]), (&json!("teapot"), &json!("fragment")));
    assert_eq!(report["size"], json!([64, 64]));
    let pairs: Vec<_> =
        report["pairs"].as_array().expect("pairs").iter().map(|p| [&p["reference"], &p["candidate"]]).collect();
    assert_eq!(pairs, [["raycast", "raster"], ["raycast", "gpu"], ["raster", "gpu"]]);
    for pair in report["pairs"].as_array().expect("pairs") {
        assert!(pair["covered"].as_u64() > Some(500) && pair["covered"] == pair["agree"], "{pair}");
        assert!(pair["causes"].is_object() && pair["max_px"].is_number());
    }
}

#[test]
fn samples_are_compared_together_and_saved_one_by_one() {
    let output = isophote(&["compare", "window", "--size", "40x40", "--antialias", "4", "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object and nothing else");
    let samples = report["samples"].as_array().expect("samples");
    let positions: Vec<&Value> = samples.iter().map(|sample| &sample["position"]).collect();
    assert_eq!(
        positions,
        [&json!([0.375, 0.125]), &json!([0.875, 0.375]), &json!([0.125, 0.625]), &json!([0.625, 0.875])]
    );
    assert_eq!(samples[0]["lens_shift"], json!([-0.125 / 40.0, 0.375 / 40.0]));
    let pairs = report["pairs"].as_array().expect("pairs");
    assert!(pairs.len() == 3 && pairs.iter().all(|pair| pair["covered"].as_u64() > Some(1000)), "{pairs:?}");
    // Each sample's file is a G-buffer like any other; together they are covered as the comparison counted.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    let arguments = ["render", "window", "--with", "raycast", "--size", "40x40", "--antialias", "4", "--gbuffer"];
    let output = isophote(&[&arguments[..], &[&path("of-many.npz")]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(!Path::new(&path("of-many.npz")).exists());
    let arguments = ["render", "window", "--size", "40x40", "--lens-shift", "-0.003125", "0.009375", "--gbuffer"];
    assert_eq!(isophote(&[&arguments[..], &[&path("first.npz")]].concat()).status.code(), Some(0));
    let judged = |sample: &str| isophote(&["compare", &path(sample), &path("first.npz"), "--format", "json"]);
    let output = judged("of-many-0.npz");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let output = judged("of-many-1.npz");
    assert!(output.status.code() == Some(2) && text(&output.stderr).contains("camera"), "{}", text(&output.stderr));
    refused(&["compare", &path("first.npz"), "--antialias", "4"], &["--antialias", "lens shift"]);
}

/// A G-buffer of the teapot that NumPy wrote, 64 x 64.
const FOREIGN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/foreign/teapot.npz");

#[test]
fn a_saved_gbuffer_is_judged_with_the_same_report_pictures_and_exit_codes() {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("foreign");
    let output = isophote(&["compare", FOREIGN, "--format", "json", "--out", out.to_str().expect("UTF-8")]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object and nothing else");
    assert_eq!((&report["model"], &report["size"]), (&json!("teapot"), &json!([64, 64])));
    assert_eq!(report["files"][0]["renderer"], "numpy-example");
    assert_eq!((&report["pairs"][0]["verdict"], &report["pairs"][0]["causes"]), (&json!("agree"), &json!({})));
    for name in ["raycast.png", "numpy-example.png", "difference-raycast-numpy-example.png", "report.json"] {
        assert!(out.join(name).exists(), "{name}");
    }
    // Granted less than it needs, it differs.
    let output = isophote(&["compare", FOREIGN, "--chord", "0.01"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    assert!(table.contains("numpy-example") && table.contains("DIFFER") && table.contains("interpolation"), "{table}");
}

/// A pixel that agrees, and the same with its neighbour's values, of which a ray says the cause.
#[test]
fn a_pixel_of_a_saved_gbuffer_is_told_in_words() {
    let path = |name: &str| Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let told = |path: &Path, pixel: &str| {
        let output = isophote(&["pixel", path.to_str().expect("UTF-8"), pixel]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let good = path("pixel-good.npz");
    let drawn = ["render", "teapot", "--size", "48x48", "--gbuffer", good.to_str().expect("UTF-8")];
    assert!(isophote(&drawn).status.success());
    let said = told(&good, "24,24");
    for words in ["pixel (24, 24) of 48x48", "raster, technique fragment", "the same face", "verdict: it agrees"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let buffer = gbuffer::GBuffer::read_npz(&good).expect("a readable G-buffer");
    let rows =
        (0..48).map(|y| (0..48).map(|x| buffer.get(x, if (x, y) == (24, 24) { 26 } else { y }).copied()).collect());
    let meta = gbuffer::Meta { renderer: "other".to_owned(), ..buffer.meta().clone() };
    let bad = path("pixel-bad.npz");
    gbuffer::GBuffer::from_rows(buffer.viewport(), meta, rows).write_npz(&bad).expect("a folder to write to");
    let said = told(&bad, "24,24");
    assert!(said.contains("verdict: it differs, by ") && said.contains("next: isophote compare"), "{said}");
    assert!(told(&bad, "0,0").contains("nothing"));
    let bad = bad.to_str().expect("UTF-8");
    refused(&["pixel", bad, "48,0"], &["outside the picture of 48x48"]);
    refused(&["pixel", bad, "1,1", "--view", "top"], &["--view does not go with a saved G-buffer"]);
    refused(&["pixel", "teapot", "1,1", "--model", "teapot"], &["--model names what a saved G-buffer"]);
}

#[test]
fn saved_gbuffers_that_cannot_be_judged_are_refused() {
    let cut = file("cut.npz", "");
    std::fs::write(&cut, &std::fs::read(FOREIGN).expect("the frozen file")[..20_000]).expect("a file can be written");
    refused(&["compare", cut.to_str().expect("UTF-8")], &["cut.npz", "not a readable .npz"]);
    refused(&["compare", "absent.npz"], &["absent.npz", "No such file"]);
    refused(&["compare", FOREIGN, "--model", "sphere"], &["teapot.npz", "hash", "sphere"]);
    refused(&["compare", FOREIGN, FOREIGN], &["teapot.npz", "numpy-example", "no check"]);
    refused(&["compare", FOREIGN, "--size", "64x64"], &["--size", "saved"]);
    refused(&["compare", FOREIGN, "--adapter", "NVIDIA"], &["--adapter", "saved"]);
    refused(&["compare", FOREIGN, "--chord", "-1"], &["chord", "-1"]);
    refused(&["compare", FOREIGN, "teapot"], &["--model", "teapot"]);
    refused(&["compare", "teapot", "sphere", "torus"], &["unexpected", "torus"]);
    refused(&["compare", "teapot", "--model", "sphere"], &["--model", "teapot"]);
}

/// A megabyte of zeros becomes a gigabyte of arrays: its model's hash is looked at before that.
#[cfg(target_os = "linux")]
#[test]
fn a_small_file_of_large_arrays_costs_nothing_before_its_model_is_known() {
    use scene::{Camera, FaceId, Viewport};
    let model = models::builtin("sphere").expect("built in");
    let viewport = Viewport::new(4000, 1800).expect("a legal size");
    let camera = Camera::framing(&model, viewport);
    let mut meta = gbuffer::Meta::new("other", "exact", &model, &camera);
    meta.model_hash = "0".repeat(16);
    let hit = gbuffer::Hit {
        face: FaceId(0),
        uv: Default::default(),
        local: None,
        t: 0.0,
        position: Default::default(),
        normal: nurbs::Normal::Undefined,
        curvature: None,
        edge: None,
    };
    let row = |_| vec![Some(hit); viewport.width()];
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("zeros.npz");
    let buffer = gbuffer::GBuffer::from_rows(viewport, meta, (0..viewport.height()).map(row));
    buffer.write_npz(&path).expect("a folder to write to");
    assert!(std::fs::metadata(&path).expect("there").len() < 16_000_000);
    // Address space, kB: what the program itself takes, and far below the arrays' 700 MB.
    let line = format!("ulimit -v 600000; exec {} compare {}", env!("CARGO_BIN_EXE_isophote"), path.display());
    let output = Command::new("bash").args(["-c", &line]).output().expect("bash starts");
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("zeros.npz") && message.contains("hash"), "{message}");
}

#[test]
fn a_scene_is_written_for_others_to_draw() {
    let output = isophote(&["scene", "torus", "--size", "40x30", "--ortho", "3"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let scene: Value = serde_json::from_slice(&output.stdout).expect("one JSON object and nothing else");
    assert_eq!(scene["meta"]["size"], json!([40, 30]));
    assert_eq!(scene["meta"]["camera"]["projection"], json!({"orthographic": {"height": 3.0}}));
    assert_eq!((&scene["view"]["half_height"], &scene["faces"][0]["pixel"]), (&json!(1.5), &json!(0.1)));
}

#[test]
fn eval_answers_in_the_conventions_of_the_oracle() {
    let queries = file("queries.json", r#"{"queries": [{"surface": 0, "uv": [[0.25, 0.5], [1, 1]]}]}"#);
    let model = file("square.json", &square().to_string());
    let output = isophote(&["eval", model.to_str().expect("UTF-8"), "--queries", queries.to_str().expect("UTF-8")]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let first = &answer["queries"][0]["results"][0];
    assert_eq!(first["S"], json!([-0.5, 0.0, 0.0]));
    assert_eq!((&first["normal_kind"], &first["normal"]), (&json!("regular"), &json!([0.0, 0.0, 1.0])));
    assert_eq!(answer["queries"][0]["results"][1]["S"], json!([1.0, 1.0, 0.0]));
    let outside = file("outside.json", r#"{"queries": [{"surface": 0, "uv": [[1.5, 0]]}]}"#);
    refused(
        &["eval", model.to_str().expect("UTF-8"), "--queries", outside.to_str().expect("UTF-8")],
        &["uv[0]", "1.5"],
    );
}

#[test]
fn render_writes_a_picture_and_a_gbuffer_that_reads_back() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (png, npz) = (folder.join("sphere.png"), folder.join("sphere.npz"));
    for with in ["raster", "gpu", "raycast"] {
        let output = isophote(&[
            "render",
            "sphere",
            "--with",
            with,
            "--size",
            "40x30",
            "--shade",
            "mean",
            "--legend",
            "--out",
            png.to_str().expect("UTF-8"),
            "--gbuffer",
            npz.to_str().expect("UTF-8"),
        ]);
        assert!(output.status.success() && output.stdout.is_empty(), "{}", text(&output.stderr));
        let buffer = gbuffer::GBuffer::read_npz(&npz).expect("a readable G-buffer");
        assert_eq!(buffer.meta().renderer, with);
        let hit = buffer.get(20, 15).expect("the sphere is in the middle");
        let curvature = hit.curvature.expect("a sphere has curvature");
        assert!((hit.position.length() - 1.0).abs() < 1e-6);
        assert!((curvature.k1.abs() - 1.0).abs() < 1e-4 && (curvature.k2.abs() - 1.0).abs() < 1e-4, "{curvature:?}");
        assert!(std::fs::metadata(&png).expect("a picture").len() > 100);
    }
}

#[test]
fn overlays_go_with_pictures_and_with_what_they_need() {
    for (arguments, words) in [
        (&["--overlay", "sections"][..], "--overlay sections goes with --section PLANE"),
        (&["--section", "z=1"], "--section goes with --overlay sections, or with --overlay combs"),
        (&["--isoparams", "3", "--overlay", "net"], "--parameters goes with --overlay parameters"),
        (&["--overlay", "net", "--out", "x.svg"], "--out is one of lines (--lines)"),
        (&["--overlay", "net", "--out", "x.exr"], "--overlay goes with a picture"),
        (&["--overlay", "bands", "--shade", "phong", "--out", "x.png"], "--shade isophotes, zebra or highlight"),
        (&["--overlay", "plaid"], "borders, parameters, trims, net, combs"),
    ] {
        refused(&[&["render", "teapot", "--size", "16x16"], arguments].concat(), &[words]);
    }
    let picture = |name: &str, overlay: &[&str]| {
        let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name).display().to_string();
        let drawn = isophote(&[&["render", "islands", "--size", "96x96", "--out", &out], overlay].concat());
        assert!(drawn.status.success(), "{}", text(&drawn.stderr));
        (std::fs::read(&out).expect("a picture"), text(&drawn.stderr))
    };
    let plain = picture("overlay-none.png", &[]).0;
    for kind in ["borders", "isoparams", "trims", "net", "combs", "silhouettes", "bands", "continuity,net"] {
        let (drawn, said) = picture("overlay.png", &["--overlay", kind]);
        assert_ne!(drawn, plain, "{kind}");
        assert_eq!(said.contains("pixels are a curvature of"), kind == "combs", "{said}");
    }
}

#[test]
fn shadings_for_people_are_drawn_and_their_options_go_with_nothing_else() {
    for (arguments, words) in [
        (&["--shade", "phong", "--environment", "x.png"][..], "--environment goes with --shade reflection"),
        (&["--shade", "reflection", "--pattern", "dots"], "--pattern goes with --shade zebra"),
        (&["--shade", "reflection", "--light", "0", "0", "1"], "--light goes with --shade"),
        (&["--shade", "reflection", "--environment", "absent.png"], "absent.png"),
        (&["--shadow", "ground", "--out", "x.svg"], "--shadow goes with a picture"),
        (&["--shadow", "ground", "--background", "transparent", "--out", "x.png"], "--shadow goes with a picture"),
        (&["--shade", "zebra", "--pattern", "dots", "--lines", "bands", "--out", "x.svg"], "lines of bands go with"),
    ] {
        refused(&[&["render", "teapot", "--size", "16x16"], arguments].concat(), &[words]);
    }
    let picture = |look: &[&str]| {
        let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("look.png").display().to_string();
        let drawn = isophote(&[&["render", "teapot", "--size", "64x64", "--out", &out], look].concat());
        assert!(drawn.status.success(), "{look:?}: {}", text(&drawn.stderr));
        std::fs::read(&out).expect("a picture")
    };
    let looks: [&[&str]; 8] = [
        &["--shade", "phong"],
        &["--shade", "phong", "--light", "-0.5", "0.6", "1"],
        &["--shade", "reflection"],
        &["--shade", "zebra"],
        &["--shade", "zebra", "--pattern", "checker"],
        &["--shade", "zebra", "--pattern", "dots"],
        &["--shade", "phong", "--background", "white"],
        &["--shade", "phong", "--background", "white", "--shadow", "ground"],
    ];
    let drawn: Vec<Vec<u8>> = looks.iter().map(|look| picture(look)).collect();
    for (k, own) in drawn.iter().enumerate() {
        assert!(!drawn[..k].contains(own), "{:?} is drawn as another", looks[k]);
    }
    assert_eq!(picture(&["--shade", "zebra", "--pattern", "stripes"]), drawn[3]);
}

#[test]
fn masks_are_reported_and_too_little_memory_makes_them_coarser_or_is_refused() {
    let texture =
        |more: &[&'static str]| [&["compare", "islands", "--trim", "texture", "--format", "json"], more].concat();
    let output = isophote(&texture(&["--size", "48x48"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let masks = &report["masks"];
    assert_eq!((report["trim"].as_str(), masks["faces"].as_u64()), (Some("texture"), Some(1)), "{report}");
    assert!(masks["error_px"].as_f64().is_some_and(|px| (0.2..=0.5 + 1e-9).contains(&px)) && masks["note"].is_null());
    let coarser = isophote(&[
        "render",
        "islands",
        "--trim",
        "texture",
        "--mask-memory",
        "1",
        "--mask-px",
        "0.05",
        "--size",
        "64x64",
    ]);
    assert!(coarser.status.success(), "{}", text(&coarser.stderr));
    assert!(text(&coarser.stderr).contains("masks are coarser than asked"), "{}", text(&coarser.stderr));
    refused(&texture(&["--mask-memory", "0"]), &["1 trimmed faces", "0 bytes"]);
    refused(&texture(&["--mask-px", "-1"]), &["--mask-px", "-1", "positive"]);
}

#[test]
fn grids_keep_to_their_limits_and_what_does_not_fit_is_named() {
    let grids = |more: &[&'static str]| {
        [&["compare", "teapot", "--technique", "zones", "--size", "48x36", "--error", "0.5", "--format", "json"], more]
            .concat()
    };
    let output = isophote(&grids(&["--batch", "3", "--emit", "1024"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    refused(&grids(&["--batch", "3", "--emit", "4"]), &["patch (0, 0) of face", "zones", "may emit 1"]);
    // Two cells a side are far off, and said to be: pixels have no verdict, and none differs.
    let coarse = isophote(&grids(&["--level", "1"]));
    assert_eq!(coarse.status.code(), Some(1), "{}", text(&coarse.stderr));
    assert!(text(&coarse.stderr).contains("triangles keep to"), "{}", text(&coarse.stderr));
    let report: Value = serde_json::from_slice(&coarse.stdout).expect("JSON");
    assert_eq!(report["pairs"][0]["verdict"], "no_verdict", "{report}");
}

#[test]
fn trim_edges_are_recorded_blended_and_judged_on_request() {
    let of = |antialias: &str| {
        let [picture, buffer] = ["png", "npz"].map(|end| file(&format!("edges-{antialias}.{end}"), ""));
        let [out, gbuffer] = [&picture, &buffer].map(|path| path.to_str().expect("UTF-8"));
        let output = isophote(&[
            "render",
            "islands",
            "--size",
            "24x24",
            "--antialias",
            antialias,
            "--out",
            out,
            "--gbuffer",
            gbuffer,
        ]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        (std::fs::read(out).expect("a picture"), gbuffer.to_owned())
    };
    let ((hard, without), (soft, with)) = (of("none"), of("trims"));
    assert!(hard != soft);
    // Of saved buffers those are judged by their edges that have some.
    let edges = |path: &str| {
        let output = isophote(&["compare", path, "--format", "json"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        report["pairs"][0]["edges"]["recorded"].as_u64()
    };
    assert_eq!(edges(&without), None);
    assert!(edges(&with).is_some_and(|recorded| recorded > 10));
    refused(&["render", "islands", "--antialias", "trims", "--trim", "texture"], &["--antialias", "--trim texture"]);
}

/// A square twice, one of them with a gap of a third in its loop.
fn half_bad() -> Value {
    let line = |a: [f64; 2], b: [f64; 2]| json!({"degree": 1, "knots": [0, 0, 1, 1], "points": [a, b]});
    let corners = [[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]];
    let trims: Vec<Value> = (0..4).map(|i| line(corners[i], corners[(i + 1) % 4])).collect();
    let mut model = square();
    let good = json!({"surface": 0, "loops": [{"outer": true, "trims": trims}]});
    let mut bad = good.clone();
    bad["loops"][0]["trims"][2]["points"][0] = json!([0.5, 0.5]);
    model["faces"] = json!([bad, good]);
    model
}

#[test]
fn info_counts_faces_by_layer_and_says_the_layers_of_each() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/step/layers.step");
    let path = path.to_str().expect("UTF-8");
    let shown = text(&isophote(&["info", path]).stdout);
    assert!(shown.contains("layers: 11 on \"Gehäuse außen\", 6 on \"42\", 1 on \"seals, tight\""), "{shown}");
    let info: Value = serde_json::from_slice(&isophote(&["info", path, "--format", "json"]).stdout).expect("JSON");
    assert_eq!(info["layers"], json!({"Gehäuse außen": 11, "42": 6, "seals, tight": 1}));
    assert_eq!(info["faces"][0]["layers"], json!(["seals, tight"]), "a face's own");
    assert_eq!(info["faces"][17].get("layers"), None);
}

#[test]
fn a_bad_face_is_named_and_the_good_one_is_drawn_unless_strict() {
    let path = file("half-bad.json", &half_bad().to_string());
    let path = path.to_str().expect("UTF-8");
    let picture = Path::new(env!("CARGO_TARGET_TMPDIR")).join("half-bad.png");
    let named = "left out: face 0, loop 0: ";
    let render = ["render", path, "--size", "16x16", "--out", picture.to_str().expect("UTF-8")];
    for arguments in [&["info", path][..], &render, &["eval", path]] {
        let output = isophote(arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {message}");
        assert!(message.contains(named) && message.contains("trim 2"), "{arguments:?}: {message}");
        // `info` counts them by kind, too, with the first of each.
        let is_told = arguments[0] == "info";
        assert_eq!(text(&output.stdout).contains(named), is_told, "notes go to standard error");
        refused(&[arguments, &["--strict"]].concat(), &[named, "--strict"]);
    }
    let info: Value = serde_json::from_slice(&isophote(&["info", path, "--format", "json"]).stdout).expect("JSON");
    assert!(info["notes"][0].as_str().expect("a note").starts_with(named), "{}", info["notes"]);
    assert_eq!((&info["faces"][0]["face"], &info["faces"][0]["number_in_file"]), (&json!(0), &json!(1)));
}

#[test]
fn continuity_answers_with_its_exit_code_and_names_the_place() {
    // Two squares of side 2 that meet along x = 1, the second one's far side lifted by `lift`, all of it raised by `step`.
    let pair = |name: &str, step: f64, lift: f64| {
        let mut model = square();
        let mut other = model["surfaces"][0].clone();
        other["points"] =
            json!([[1.0, -1.0, step], [1.0, 1.0, step], [3.0, -1.0, step + lift], [3.0, 1.0, step + lift]]);
        model["surfaces"].as_array_mut().expect("a list").push(other);
        file(name, &model.to_string()).to_str().expect("UTF-8").to_owned()
    };
    let (smooth, stepped, bent) =
        (pair("smooth.json", 0.0, 0.0), pair("stepped.json", 0.004, 0.0), pair("bent.json", 0.0, 0.1));
    let code = |arguments: &[&str]| isophote(arguments).status.code();
    assert_eq!(code(&["continuity", &smooth]), Some(0));
    assert_eq!(code(&["continuity", &stepped]), Some(0), "0.004 is below 0.01");
    assert_eq!(code(&["continuity", &stepped, "--gap", "0.003", "--reach", "0.01"]), Some(1));
    assert_eq!(code(&["continuity", &bent]), Some(1));
    assert_eq!(code(&["continuity", &bent, "--class", "C"]), Some(1), "2.9 degrees");
    assert_eq!(code(&["continuity", &bent, "--angle", "3"]), Some(0));
    // Nothing that is shared is nothing that passes.
    let alone = file("alone.json", &square().to_string());
    assert_eq!(code(&["continuity", alone.to_str().expect("UTF-8")]), Some(2));
    refused(&["continuity", &smooth, "--gap", "0"], &["--gap", "positive"]);
    let output = isophote(&["continuity", &bent, "--format", "json"]);
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let edge = &report["edges"][0];
    assert_eq!((&report["verdict"], &edge["verdict"]), (&json!("fail"), &json!("fail")));
    let angle = edge["angle_deg"]["seen"].as_f64().expect("a number");
    assert!((angle - 0.05f64.atan().to_degrees()).abs() < 1e-9, "{angle}");
    assert_eq!(edge["angle_deg"]["at"]["position"][0], json!(1.0));
    assert_eq!((&report["codes"]["gap"], &report["codes"]["free"]), (&json!("G-SH-LG"), &json!("G-SH-FR")));
    let table = isophote(&["continuity", &bent]);
    let table = String::from_utf8_lossy(&table.stdout);
    assert!(
        ["G-SH-LG", "G-SH-NT", "G-SH-NS", "free edges (G-SH-FR): 6"].iter().all(|code| table.contains(code)),
        "{table}"
    );
    let page = file("bent.html", "");
    let output = isophote(&["continuity", &bent, "--format", "html", "--out", page.to_str().expect("UTF-8")]);
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
    let page = std::fs::read_to_string(page).expect("a page");
    for word in [
        "data:image/png;base64,",
        "no class: 1",
        "free: 6",
        "Signature",
        "free edges (G-SH-FR): 6",
        report["hash"].as_str().expect("a hash"),
        "fail",
    ] {
        assert!(page.contains(word), "no {word:?} in the page");
    }
}

#[test]
fn info_says_how_many_bicubic_patches_stand_for_a_model_and_names_the_patch_that_cannot_be() {
    let info = |tolerance| isophote(&["info", "quintic-quadratic", "--approximate", tolerance, "--format", "json"]);
    let found: Value = serde_json::from_slice(&info("1e-4").stdout).expect("JSON");
    let approximation = &found["approximation"];
    assert_eq!(approximation["patches"], found["bezier_patches"]);
    assert!(approximation["bicubic_patches"].as_u64() > approximation["patches"].as_u64(), "{approximation}");
    let bound = approximation["bound"].as_f64().expect("a number");
    assert!(0.0 < bound && bound <= 1e-4, "{approximation}");
    let refused = info("1e-18");
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{message}");
    assert!(message.contains("surface 0, patch 0 on [") && message.contains("1e-18"), "{message}");
    let plain: Value = serde_json::from_slice(&isophote(&["info", "teapot", "--format", "json"]).stdout).expect("JSON");
    assert!(plain.get("approximation").is_none());
}

#[test]
fn info_of_a_folder_is_a_line_a_file_and_a_bad_one_ends_nothing() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("info-folder");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(folder.join("inner")).expect("folders");
    std::fs::write(folder.join("inner/square.json"), square().to_string()).expect("written");
    std::fs::write(folder.join("half.json"), half_bad().to_string()).expect("written");
    std::fs::write(folder.join("bad.step"), "ISO-10303-21;").expect("written");
    std::fs::write(folder.join("notes.txt"), "no model").expect("written");
    let path = folder.to_str().expect("UTF-8");
    let output = isophote(&["info", path, "teapot", "--format", "json"]);
    assert_eq!(output.status.code(), Some(2));
    let lines: Vec<Value> =
        text(&output.stdout).lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let names: Vec<&str> = lines.iter().map(|line| line["file"].as_str().expect("a name")).collect();
    let expected = ["bad.step", "half.json", "inner/square.json"].map(|name| format!("{path}/{name}"));
    assert_eq!(names, expected.iter().map(String::as_str).chain(["teapot"]).collect::<Vec<_>>());
    let error = lines[0]["error"].as_str().expect("an error");
    assert!(error.contains("bad.step") && error.contains("no instances"), "{error}");
    assert_eq!(lines[1]["notes_by_kind"][0]["kind"], "left out");
    assert_eq!((&lines[3]["face_count"], &lines[3]["surfaces"]["b-spline"]), (&json!(32), &json!(32)));
    // What is lost is an error where --strict asks; all files of a pattern are one run.
    let pattern = format!("{path}/*.json");
    for (arguments, code) in [(vec!["info", &pattern], 0), (vec!["info", &pattern, "--strict"], 2)] {
        let output = isophote(&arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert!(text(&output.stdout).contains("half.json: 1 faces: 1 b-spline"), "{}", text(&output.stdout));
    }
    let empty = folder.join("empty");
    std::fs::create_dir(&empty).expect("a folder");
    let output = isophote(&["info", empty.to_str().expect("UTF-8")]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stdout).contains("holds no model file"), "{}", text(&output.stdout));
}

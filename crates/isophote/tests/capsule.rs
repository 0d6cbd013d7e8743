//! Capsules: what is played of one is what was drawn, to the bit; and one that is damaged says so.

use gbuffer::{GBuffer, Meta};
use glam::DVec3;
use gpu::capsule::{CapsuleError, Contents, Played, Recording, gbuffer, play};
use isophote::stage::{Plan, Stage};
use isophote::view::ModelArgs;
use scene::{Camera, Viewport};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Scenes that have all that capsules hold: vertices and indices, masks and blending, kernels, indirect calls, steps.
const SCENES: [&[&str]; 6] = [
    &["teapot", "--technique", "fragment"],
    &["plate", "--technique", "fragment", "--trim", "texture"],
    &["islands", "--technique", "exact"],
    &["torus", "--technique", "grid"],
    &["sphere", "--technique", "zones", "--scheme", "general"],
    &["teapot", "--path", "compute"],
];

fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("capsule").join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).expect("a folder can be made");
    path
}

fn isophote(arguments: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_isophote")).args(arguments).output().expect("isophote starts");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Records a scene into `folder/capsule`, and the G-buffer that was drawn for it into `folder/drawn.npz`.
fn record(scene: &[&str], folder: &Path) -> PathBuf {
    let at = |name: &str| folder.join(name).display().to_string();
    let output = ["--size", "40x30", "--out", &at("capsule"), "--gbuffer", &at("drawn.npz")];
    isophote(&[&["capsule"], scene, &output].concat());
    folder.join("capsule")
}

fn valid(schema: &str, document: &Value) -> bool {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/schema").join(schema);
    let schema: Value = serde_json::from_slice(&std::fs::read(path).expect("a schema")).expect("JSON");
    let schema = jsonschema::validator_for(&schema).expect("a schema");
    schema.iter_errors(document).for_each(|fault| eprintln!("{fault} at {}", fault.instance_path()));
    schema.is_valid(document)
}

fn document(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("a document")).expect("JSON")
}

#[test]
fn the_played_picture_is_the_drawn_one_to_the_bit() {
    for (number, scene) in SCENES.into_iter().enumerate() {
        let folder = folder(&format!("played-{number}"));
        let capsule = record(scene, &folder);
        let at = |name: &str| folder.join(name).display().to_string();
        isophote(&["capsule", "play", &at("capsule"), "--answer", &at("answer")]);
        isophote(&["capsule", "read", &at("capsule"), "--answer", &at("answer"), "--gbuffer", &at("played.npz")]);
        let bytes = |name: &str| std::fs::read(folder.join(name)).expect("a G-buffer");
        assert!(bytes("drawn.npz") == bytes("played.npz"), "{scene:?}");
        let covered = GBuffer::read_npz(folder.join("played.npz")).expect("a G-buffer").covered();
        assert!(covered > 100, "{scene:?} shows {covered} pixels");
        assert!(valid("capsule-1.json", &document(&capsule.join("capsule.json"))), "{scene:?}");
        assert!(valid("answer-1.json", &document(&folder.join("answer/answer.json"))), "{scene:?}");
    }
}

#[test]
fn of_a_picture_that_is_drawn_anew_for_want_of_room_the_last_is_kept() {
    let model = ModelArgs::named("teapot").read().expect("a built-in model").model;
    let viewport = Viewport::new(48, 48).expect("a legal size");
    let near = Camera::framing(&model, viewport);
    let eye = near.target() + 1e3 * (near.eye() - near.target());
    let far = Camera::look_at(eye, near.target(), DVec3::Z, near.projection()).expect("a camera");
    let technique = techniques::named("grid").expect("a technique");
    let plan = Plan { technique, chord_px: 0.002, ..Plan::default() };
    // Prepared for a few pixels, and drawn large.
    let stage = Stage::new(&model, far, viewport, plan).expect("it is drawn");
    let recording = Recording::new(None).expect("an adapter");
    let views = stage.scene.views(&model, &near, viewport);
    let mut renderer = stage.renderer(recording.device(), Default::default()).expect("it is uploaded");
    let meta = Meta::new("gpu", "grid", &model, &near);
    let drawn = renderer.gbuffer(&views, &near, viewport, meta).expect("a picture");
    drop(renderer);
    let contents = recording.finish(&stage.scene, &drawn, true).expect("a capsule");
    // At first there is room for 1024 tiles, and then for half as many again as there were.
    assert!(contents.capsule().room > Some(1536), "{:?}", contents.capsule().room);
    let played = gbuffer(&contents, &play(&contents, None).expect("it is played")).expect("a picture");
    assert!(played.npz_bytes().expect("bytes") == drawn.npz_bytes().expect("bytes"));
}

#[test]
fn a_damaged_capsule_is_told_from_a_sound_one() {
    let folder = folder("damaged");
    let capsule = record(&["sphere"], &folder);
    let sound = document(&capsule.join("capsule.json"));
    let write = |document: &Value| {
        std::fs::write(capsule.join("capsule.json"), document.to_string()).expect("a file can be written");
        Contents::read(&capsule)
    };
    let first = sound["files"][0]["name"].as_str().expect("a name").to_owned();

    let bytes = std::fs::read(capsule.join(&first)).expect("a file");
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    std::fs::write(capsule.join(&first), flipped).expect("a file can be written");
    assert!(matches!(Contents::read(&capsule), Err(CapsuleError::Damaged { name, .. }) if name == first));
    std::fs::write(capsule.join(&first), &bytes[1..]).expect("a file can be written");
    assert!(matches!(Contents::read(&capsule), Err(CapsuleError::Length { name, .. }) if name == first));
    std::fs::remove_file(capsule.join(&first)).expect("it is there");
    assert!(matches!(Contents::read(&capsule), Err(CapsuleError::Read { path, .. }) if path.ends_with(&first)));
    std::fs::write(capsule.join(&first), &bytes).expect("a file can be written");

    let with = |pointer: &str, value: Value| {
        let mut changed = sound.clone();
        *changed.pointer_mut(pointer).expect("it is there") = value;
        write(&changed)
    };
    assert!(matches!(with("/schemaVersion", json!(2)), Err(CapsuleError::Version { found: 2, expected: 1, .. })));
    assert!(matches!(with("/schema", json!("isophote-answer")), Err(CapsuleError::Document { .. })));
    assert!(matches!(with("/buffers", json!([{"size": 1}])), Err(CapsuleError::Document { .. })));
    assert!(matches!(with("/files/0/name", json!("../up.bin")), Err(CapsuleError::Name { .. })));
    assert!(!valid("capsule-1.json", &json!({"schema": "isophote-capsule"})));
    assert!(write(&sound).is_ok());
}

#[test]
fn a_capsule_that_contradicts_itself_is_refused_by_whoever_plays_it() {
    let folder = folder("contradiction");
    let capsule = record(&["sphere"], &folder);
    let sound = document(&capsule.join("capsule.json"));
    let played = |changed: &Value| {
        std::fs::write(capsule.join("capsule.json"), changed.to_string()).expect("a file can be written");
        play(&Contents::read(&capsule).expect("files are sound"), None)
    };
    let with = |pointer: &str, value: Value| {
        let mut changed = sound.clone();
        *changed.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer}")) = value;
        played(&changed)
    };
    let draw = place(&sound, "drawIndexed");
    assert!(matches!(with(&format!("{draw}/0"), json!(1 << 30)), Err(CapsuleError::Gpu(_))));
    assert!(matches!(with(&format!("{draw}/2"), json!(-1)), Err(CapsuleError::Malformed { .. })));
    let write = place(&sound, "write");
    assert!(matches!(with(&format!("{write}/offset"), json!(1u64 << 40)), Err(CapsuleError::Beyond { .. })));
    assert!(matches!(with(&format!("{write}/buffer"), json!(99)), Err(CapsuleError::NoSuch { index: 99, .. })));
    assert!(matches!(with(&format!("{write}/file"), json!("none")), Err(CapsuleError::NoFile { .. })));
    let indices = place(&sound, "indexBuffer");
    assert!(matches!(with(&format!("{indices}/range/size"), json!(1u64 << 40)), Err(CapsuleError::Beyond { .. })));
    assert!(matches!(with("/buffers/0/size", json!(1u64 << 60)), Err(CapsuleError::Gpu(_))));
    assert!(matches!(with("/groups/0/layout", json!(7)), Err(CapsuleError::NoSuch { .. })));
    assert!(played(&sound).is_ok());
}

#[test]
fn an_answer_that_is_wrong_makes_no_picture() {
    let folder = folder("answer");
    let capsule = record(&["sphere", "--technique", "exact"], &folder);
    let (contents, answer) = (Contents::read(&capsule).expect("a capsule"), folder.join("answer"));
    play(&contents, None).expect("it is played").write(&answer).expect("a folder can be written");
    let read = || gbuffer(&contents, &Played::read(&answer).expect("files are sound"));
    assert!(read().is_ok());

    let sound = document(&answer.join("answer.json"));
    let put = |changed: &Value| std::fs::write(answer.join("answer.json"), changed.to_string()).expect("a file");
    let replaced = |name: &str, bytes: &[u8]| {
        std::fs::write(answer.join(name), bytes).expect("a file");
        let mut changed = sound.clone();
        let file = changed["files"].as_array_mut().expect("files").iter_mut().find(|file| file["name"] == name);
        let file = file.expect("it is there");
        (file["bytes"], file["hash"]) = (json!(bytes.len()), json!(files::hash(bytes)));
        put(&changed);
    };
    // More meetings than there is room for: some of the picture was lost.
    let count = std::fs::read(answer.join("count.bin")).expect("a count");
    replaced("count.bin", &u32::MAX.to_le_bytes());
    assert!(matches!(read(), Err(CapsuleError::NoRoom { needed: 0xffff_ffff, .. })));
    std::fs::write(answer.join("count.bin"), count).expect("a file");
    let identity = std::fs::read(answer.join("identity.bin")).expect("a target");
    replaced("identity.bin", &identity[16..]);
    assert!(matches!(read(), Err(CapsuleError::Length { .. })));
    // No scene has as many faces.
    replaced("identity.bin", &vec![7; identity.len()]);
    assert!(matches!(read(), Err(CapsuleError::Gpu(gpu::GpuError::Malformed { .. }))));
    std::fs::write(answer.join("identity.bin"), identity).expect("a file");
    let mut other = sound.clone();
    other["capsule"] = json!("0000000000000000");
    put(&other);
    assert!(matches!(read(), Err(CapsuleError::OtherCapsule { .. })));
}

/// The JSON pointer of the first member of that name among the commands.
fn place(document: &Value, name: &str) -> String {
    fn within(value: &Value, name: &str, at: &str) -> Option<String> {
        match value {
            Value::Object(members) => members.iter().find_map(|(key, value)| {
                let at = format!("{at}/{key}");
                if key == name { Some(at) } else { within(value, name, &at) }
            }),
            Value::Array(all) => (0..).zip(all).find_map(|(k, value)| within(value, name, &format!("{at}/{k}"))),
            _ => None,
        }
    }
    within(&document["commands"], name, "/commands").unwrap_or_else(|| panic!("no {name}"))
}

//! The page of `hosts/browser` in a real browser: it plays a capsule, and its answer is judged like any picture.

use crate::devtools::{Page, is_there};
use crate::setting::folder;
use base64::Engine;
use gpu::capsule::{Played, gbuffer};
use isophote::capsule::recorded;
use isophote::conform::report::Pair;
use isophote::stage::{Plan, Stage};
use isophote::view::ModelArgs;
use raycast::Caster;
use scene::{Camera, Viewport};
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};

/// An adapter without a GPU, and modules from files.
const FLAGS: &[&str] =
    &["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--allow-file-access-from-files"];

/// The longest wait for a picture.
const PATIENCE: Duration = Duration::from_secs(40);

#[test]
fn the_page_plays_a_capsule_and_its_answer_agrees_with_the_rays() {
    if !is_there("the_page_plays_a_capsule_and_its_answer_agrees_with_the_rays", "a capsule") {
        return;
    }
    let folder = folder("player");
    let model = ModelArgs::named("sphere").read().expect("a built-in model").model;
    let viewport = Viewport::new(24, 24).expect("a legal size");
    let camera = Camera::framing(&model, viewport);
    let stage = Stage::new(&model, camera, viewport, Plan::default()).expect("it is drawn");
    let (contents, _) = recorded(&stage, None, gpu::Overrides::default()).expect("an adapter");
    let (capsule, answer) = (folder.join("capsule"), folder.join("answer"));
    contents.write(&capsule).expect("a folder can be written");
    std::fs::create_dir_all(&answer).expect("a folder can be made");

    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../hosts/browser/index.html");
    let page = page.canonicalize().expect("the page is there");
    let mut page = Page::open_with(FLAGS, &page, folder.join("profile"), [800, 600]);
    page.choose("#capsule", &[capsule]);
    let started = Instant::now();
    while !["drawn", "failed"].map(Value::from).contains(&page.evaluate("document.querySelector('#state').className")) {
        assert!(started.elapsed() < PATIENCE, "nothing was drawn: {:?}", page.complaints);
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(page.evaluate("document.querySelector('#state').textContent"), "Drawn.");
    page.screenshot(&folder.join("page.png"));
    let all = "Promise.all([...document.querySelectorAll('#answer a')].map(async (a) => [a.download, \
               btoa(Array.from(new Uint8Array(await (await fetch(a.href)).arrayBuffer()), (b) => String.fromCharCode(b)).join(''))]))";
    let saved: Vec<(String, String)> = serde_json::from_value(page.evaluate(all)).expect("names and bytes");
    for (name, text) in saved {
        let bytes = base64::engine::general_purpose::STANDARD.decode(text).expect("base64");
        std::fs::write(answer.join(name), bytes).expect("a file can be written");
    }
    let played = Played::read(&answer).expect("an answer");
    let drawn = gbuffer(&contents, &played).expect("a picture");
    let caster = Caster::new(&model);
    let raycast = caster.render(&camera, viewport, &|_| {});
    let against = stage.against_raycast(&caster, &raycast, &drawn).expect("it is judged");
    let pair = Pair::new(&against, &raycast, &drawn);
    assert!(pair.agree && pair.covered > 100, "{pair:?}");
    assert_ne!(drawn.meta().compiler.as_deref(), Some(gpu::COMPILER));
}

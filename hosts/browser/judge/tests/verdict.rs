//! What the page judges: the same answers as `conform` gives, and wrong pictures differ.

use gpu::capsule::{Contents, Host, Played, Recording, edges, play};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;
use suite::corpus::{Scene, Suite};
use suite::report::{Report, State};
use suite::run::{Adapter, Gpu, Plans};
use suite::shard::Shard;
use suite::stage::{Path, Stage};

type Files = BTreeMap<String, Vec<u8>>;

/// A scene of the smoke suite that is quick.
const SCENE: &str = "pole";

fn plans() -> Plans {
    let shard = Shard::new(1, 18).expect("a shard");
    Plans { suite: Suite::Smoke, scenes: Suite::Smoke.scenes(), shard, path: Path::default() }
}

/// A picture of the scene: the options of its case, its capsule, and what this machine's adapter makes of it.
struct Drawn {
    options: String,
    capsule: Files,
    answer: Files,
}

/// The pictures of the scene, who drew them, and its answer to the measurement.
struct Page {
    pictures: Vec<Drawn>,
    host: Host,
    edges: Files,
}

static PAGE: LazyLock<Page> = LazyLock::new(|| {
    let played = |contents: &Contents| play(contents, None).expect("`apt-get install mesa-vulkan-drivers libvulkan1`");
    let scene: &Scene = plans().mine().next().expect("a scene");
    assert_eq!(scene.name, SCENE);
    let (model, viewport) = (scene.open().expect("a built-in model"), Suite::Smoke.viewport());
    let camera = scene.viewpoints[0].camera(&model, viewport);
    let drawn = |plan| {
        let stage = Stage::new(&model, camera, viewport, plan).expect("it is drawn");
        let recording = Recording::new(None).expect("an adapter");
        let gbuffer = stage.gpu(recording.device(), None, gpu::Overrides::default()).expect("a picture").gbuffer;
        let contents = recording.finish(&stage.scene, &gbuffer, true).expect("a capsule");
        let answer = played(&contents).into_files();
        Drawn { options: scene.options(&camera, viewport, plan), capsule: contents.into_files(), answer }
    };
    let measured: Played = played(&edges());
    let pictures = Suite::Smoke.plans(scene).into_iter().map(drawn).collect();
    Page { pictures, host: measured.answer().host.clone(), edges: measured.into_files() }
});

/// What the judge says of a request, whose files are put behind it.
fn asked(mut head: Value, files: &[(String, &[u8])]) -> anyhow::Result<Value> {
    head["suite"] = json!("smoke");
    head["shard"] = json!({"index": 1, "count": 18});
    head["files"] = files.iter().map(|(path, bytes)| json!([path, bytes.len()])).collect();
    let mut request = format!("{head}\n").into_bytes();
    files.iter().for_each(|(_, bytes)| request.extend_from_slice(bytes));
    Ok(serde_json::from_slice(&judge::verdict(&request)?)?)
}

fn within<'f>(folder: &str, files: &'f Files) -> Vec<(String, &'f [u8])> {
    files.iter().map(|(name, bytes)| (format!("{folder}/{name}"), &bytes[..])).collect()
}

/// The verdict on the scene, with each answer, by its place, as `change` leaves it.
fn judged(change: impl Fn(usize, &mut Files)) -> Value {
    let Page { pictures, host, edges } = &*PAGE;
    let drawn_by = json!({"host": {"host": host, "platform": "Linux"}});
    let begun = asked(json!({"drawnBy": drawn_by, "edges": "edges"}), &within("edges", edges)).expect("a report");
    let answers: Vec<Files> = pictures
        .iter()
        .enumerate()
        .map(|(k, picture)| {
            let mut answer = picture.answer.clone();
            change(k, &mut answer);
            answer
        })
        .collect();
    let (mut list, mut files) = (vec![], vec![]);
    for (k, (picture, answer)) in pictures.iter().zip(&answers).enumerate() {
        let [capsule, answered] = ["capsule", "answer"].map(|name| format!("{k}/{name}"));
        files.extend(within(&capsule, &picture.capsule));
        files.extend(within(&answered, answer));
        list.push(json!({"options": picture.options, "capsule": capsule, "answer": answered}));
    }
    let (report, moves_px) = (&begun["report"], &begun["movesPx"]);
    let head = json!({"drawnBy": drawn_by, "report": report, "movesPx": moves_px, "scene": SCENE, "pictures": list});
    asked(head, &files).expect("a verdict")
}

/// Files of an answer changed, and its document so that it says the same of them.
fn replaced(answer: &mut Files, change: impl Fn(&str, &mut Vec<u8>)) {
    let mut document: Value = serde_json::from_slice(&answer["answer.json"]).expect("JSON");
    for file in document["files"].as_array_mut().expect("files") {
        let name = file["name"].as_str().expect("a name").to_owned();
        let bytes = answer.get_mut(&name).expect("it is there");
        change(&name, bytes);
        file["hash"] = json!(files::hash(bytes));
    }
    answer.insert("answer.json".to_owned(), document.to_string().into_bytes());
}

fn is_target(name: &str) -> bool {
    ["identity.bin", "position.bin", "normal.bin", "shape.bin"].contains(&name)
}

fn words(verdict: &Value) -> Vec<&str> {
    let rows = verdict["rows"].as_array().expect("rows");
    rows.iter().map(|row| row["verdict"].as_str().expect("a word")).collect()
}

#[test]
fn the_page_gives_the_numbers_that_conform_gives() {
    let plans = plans();
    let gpu = Gpu::open(None).expect("an adapter");
    let mut own = plans.report(vec![gpu.subject()]);
    plans.run(&mut [Box::new(gpu)], &mut own, &AtomicBool::new(false), &mut |_| Ok(())).expect("nothing to write");
    let verdict = judged(|_, _| {});
    let report: Report = serde_json::from_value(verdict["report"].clone()).expect("a report");
    assert_eq!((words(&verdict), &verdict["state"]), (vec!["agree"; 4], &json!("agree")), "{}", verdict["line"]);
    assert_eq!((report.state(), own.state()), (State::Agree, State::Agree));
    assert_eq!((&report.corpus, &report.planned), (&own.corpus, &own.planned));
    for (page, own) in report.cases.iter().zip(&own.cases) {
        assert_eq!((&page.key, &page.options, page.undecided), (&own.key, &own.options, own.undecided));
        let pairs = |case: &suite::report::Case| case.outcomes.iter().map(|o| o.pairs.clone()).collect::<Vec<_>>();
        assert_eq!(pairs(page), pairs(own), "{}", page.key);
    }
}

#[test]
fn one_wrong_pixel_and_a_shifted_picture_differ() {
    // The middle shows what is eight pixels beside it.
    let one = |bytes: &mut Vec<u8>| bytes.copy_within(16 * (32 * 64 + 40)..16 * (32 * 64 + 41), 16 * (32 * 64 + 32));
    let shifted = |bytes: &mut Vec<u8>| bytes.rotate_right(16);
    let verdict = judged(|k, answer| {
        replaced(answer, |name, bytes| match k {
            _ if !is_target(name) => {}
            0 | 1 => one(bytes),
            _ => shifted(bytes),
        })
    });
    assert_eq!((words(&verdict), &verdict["state"]), (vec!["differ"; 4], &json!("differ")), "{}", verdict["line"]);
    let differing: Vec<u64> = verdict["rows"]
        .as_array()
        .expect("rows")
        .iter()
        .map(|row| row["differing"].as_u64().expect("a count"))
        .collect();
    assert!(differing[..2] == [1, 1] && differing[2..].iter().all(|count| *count > 100), "{differing:?}");
    assert!(verdict["line"].as_str().expect("a line").starts_with("4 of 4 pictures differ"), "{}", verdict["line"]);
}

#[test]
fn an_answer_that_is_damaged_or_not_there_is_no_agreement() {
    let verdict = judged(|k, answer| match k {
        0 | 1 => answer.get_mut("identity.bin").expect("it is read")[5] ^= 1,
        _ => drop(answer.remove("normal.bin")),
    });
    assert_eq!((words(&verdict), &verdict["state"]), (vec!["partial"; 4], &json!("partial")));
    assert!(verdict["line"].as_str().expect("a line").contains("Not all could be judged"), "{}", verdict["line"]);
    let absent = json!({"drawnBy": {"absent": {"why": "there is no adapter"}}});
    let absent = asked(absent, &[]).expect("a report");
    assert_eq!(
        (&absent["state"], &absent["line"]),
        (&json!("partial"), &json!("Nothing was judged: there is no adapter."))
    );
}

#[test]
fn requests_that_make_no_sense_are_refused_by_name() {
    let host = json!({"absent": {"why": "nobody"}});
    let of = |head: Value, files: &[(String, &[u8])]| format!("{:#}", asked(head, files).expect_err("refused"));
    assert!(of(json!({"drawnBy": host, "scene": "attic"}), &[]).contains("\"attic\" is not in shard 1/18"));
    let next = Suite::Smoke.scenes()[1].name;
    assert!(of(json!({"drawnBy": host, "scene": next}), &[]).contains("is not in shard"));
    assert!(of(json!({"drawnBy": host, "edges": "edges"}), &[]).contains("edges/answer.json"));
    let refused = |bytes: &[u8]| format!("{:#}", judge::verdict(bytes).expect_err("refused"));
    assert!(refused(b"{}").contains("no line end"));
    assert!(refused(b"{}\n").contains("missing field"));
    let head = json!({"suite": "smoke", "shard": {"index": 1, "count": 1}, "drawnBy": host, "files": [["a.bin", 9]]});
    assert!(refused(format!("{head}\nabc").as_bytes()).contains("a.bin is cut off"));
    assert!(refused(format!("{head}\n0123456789").as_bytes()).contains("1 bytes follow"));
}

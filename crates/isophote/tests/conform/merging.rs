//! `conform merge`: shards joined, and each way in which they may not belong together.

use crate::setting::{AGREEING, DIFFERING, folder, plans, smoke};
use anyhow::Result;
use isophote::conform::corpus::Suite;
use isophote::conform::merge;
use isophote::conform::report::{Report, State};
use isophote::conform::shard::Shard;
use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

/// The part of a whole report that a shard would have measured.
fn shard(whole: &Report, index: usize, count: usize) -> (Report, PathBuf) {
    let mut part = whole.clone();
    part.shard = Shard { index, count };
    part.sources[0].shard = part.shard;
    let place = |name: &str| whole.scenes.iter().position(|scene| scene.name == name).expect("a scene");
    part.cases.retain(|case| part.shard.holds(place(&case.key.scene)));
    (part, PathBuf::from(format!("shard-{index}.json")))
}

/// The reports joined as those of the three scenes.
fn merged(reports: &[(Report, PathBuf)]) -> Result<Report> {
    merge::merged(reports, &plans().corpus())
}

fn shards(whole: &Report) -> Vec<(Report, PathBuf)> {
    (1..=3).map(|index| shard(whole, index, 3)).collect()
}

fn refused(reports: &[(Report, PathBuf)], words: &[&str]) {
    let message = format!("{:#}", merged(reports).expect_err("they do not belong together"));
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}

#[test]
fn shards_in_any_order_make_the_whole() {
    let mut parts = shards(&AGREEING);
    assert!(parts.iter().all(|(part, _)| part.cases.len() == 1 && part.state() == State::Agree));
    parts.rotate_left(1);
    let whole = merged(&parts).expect("they belong together");
    assert_eq!((&whole.cases, &whole.subjects), (&AGREEING.cases, &AGREEING.subjects));
    assert_eq!((whole.state(), whole.sources.len(), whole.shard), (State::Agree, 3, Shard::WHOLE));
    assert_eq!(merged(&[(whole.clone(), PathBuf::new())]).expect("once more").cases, whole.cases);
}

#[test]
fn adapters_of_two_machines_stand_side_by_side() {
    let mut other = DIFFERING.clone();
    other.subjects[1].id = "another card".to_owned();
    other.subjects[1].name = "another card".to_owned();
    other.sources[0].subjects[1] = "another card".to_owned();
    for case in &mut other.cases {
        case.outcomes[1].subject = "another card".to_owned();
    }
    let both = merged(&[(AGREEING.clone(), "a".into()), (other, "b".into())]).expect("they belong together");
    let states: Vec<State> = both.subjects.iter().map(|subject| both.state_of(subject)).collect();
    assert_eq!((states, both.state()), (vec![State::Agree, State::Agree, State::Differ], State::Differ));
    assert!(both.cases.iter().all(|case| case.outcomes.len() == 3));
}

#[test]
fn a_missing_shard_is_named_and_the_rest_is_kept() {
    let mut parts = shards(&AGREEING);
    parts.remove(1);
    let partial = merged(&parts).expect("they belong together");
    assert_eq!((partial.state(), partial.cases.len()), (State::NotRun, 2));
    assert!(partial.notes[0].contains("shard 2/3 is missing"), "{:?}", partial.notes);
    assert_eq!(partial.missing(&partial.subjects[1].id)[0].scene, "repeated-knots");
}

#[test]
fn a_shard_that_is_there_twice_is_refused_with_both_files() {
    let mut parts = shards(&AGREEING);
    parts.push((parts[1].0.clone(), "again.json".into()));
    refused(&parts, &["shard 2/3", "twice", "shard-2.json", "again.json"]);
    let halves = vec![shard(&AGREEING, 1, 3), shard(&AGREEING, 1, 2)];
    refused(&halves, &["pole/above", "twice"]);
}

#[test]
fn other_programs_suites_and_corpora_are_refused() {
    let with = |change: fn(&mut Report)| {
        let mut parts = shards(&AGREEING);
        change(&mut parts[2].0);
        parts
    };
    refused(&with(|part| part.program = "9.9.9".to_owned()), &["shard-3.json", "9.9.9", "program version"]);
    refused(&with(|part| part.suite = Suite::Full), &["shard-3.json", "full", "smoke"]);
    refused(&with(|part| part.scenes[0].unbounded_share = 0.5), &["shard-3.json", "another corpus"]);
    refused(&with(|part| part.corpus = "0".repeat(16)), &["shard-3.json", "another corpus", "hash"]);
}

#[test]
fn a_cpu_that_gives_two_answers_is_refused() {
    let mut other = AGREEING.clone();
    other.subjects.truncate(1);
    other.sources[0].subjects.truncate(1);
    for case in &mut other.cases {
        case.outcomes.truncate(1);
    }
    assert!(merged(&[(AGREEING.clone(), "a".into()), (other.clone(), "b".into())]).is_ok());
    other.cases[1].outcomes[0].pairs[0].position.max *= 0.5;
    refused(&[(AGREEING.clone(), "a".into()), (other, "b".into())], &["two answers", "repeated-knots"]);
}

fn run(name: &str, files: &[(&str, String)]) -> Output {
    let folder = folder(name);
    let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
    for (path, (_, text)) in paths.iter().zip(files) {
        std::fs::write(path, text).expect("a file can be written");
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_isophote"));
    command.args(["conform", "merge"]).args(&paths).arg("--out").arg(folder.join("merged"));
    command.output().expect("isophote starts")
}

#[test]
fn exit_codes_tell_agreement_difference_and_partial_apart() {
    let text = |report: &Report| serde_json::to_string(report).expect("JSON");
    let parts: Vec<String> = shards(&smoke(&AGREEING)).iter().map(|(part, _)| text(part)).collect();
    let [a, b, c] = [0, 1, 2].map(|i| parts[i].clone());
    let cases = [
        ("merge-0", vec![("a.json", a.clone()), ("b.json", b.clone()), ("c.json", c.clone())], 0, "all agree"),
        ("merge-1", vec![("whole.json", text(&smoke(&DIFFERING)))], 1, "DIFFERS"),
        ("merge-2", vec![("a.json", a.clone()), ("c.json", c)], 2, "shard 2/3 is missing"),
    ];
    for (name, files, code, words) in cases {
        let output = run(name, &files);
        let said = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(code), "{name}: {said} {}", String::from_utf8_lossy(&output.stderr));
        assert!(said.contains(words), "{name}: {said}");
    }
    let damaged = [
        ("cut.json", a[..a.len() / 2].to_owned(), "cut off"),
        ("empty.json", String::new(), "cut off"),
        ("foreign.json", "{\"model\": \"teapot\"}".to_owned(), "not a conformance report"),
        ("picture.json", "\u{89}PNG".to_owned(), "not JSON"),
        ("later.json", a.replacen("\"schema_version\":2", "\"schema_version\":7", 1), "schema_version 7"),
        ("changed.json", a.replacen("\"covered\":", "\"covert\":", 1), "damaged"),
        (
            "stray.json",
            a.replacen("\"cases\":[{\"key\":{\"scene\":\"pole\"", "\"cases\":[{\"key\":{\"scene\":\"hole\"", 1),
            "not planned",
        ),
    ];
    for (file, content, words) in damaged {
        let output = run(&format!("merge-{file}"), &[("b.json", b.clone()), (file, content)]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{file}: {message}");
        assert!(
            message.contains(file) && message.contains(words) && !message.contains("panicked"),
            "{file}: {message}"
        );
    }
}

#[test]
fn what_a_report_says_of_itself_is_not_believed() {
    let pair = |report: &mut Report| report.cases[0].outcomes[1].pairs[0].clone();
    let with = |change: &dyn Fn(&mut Report)| {
        let mut report = AGREEING.clone();
        change(&mut report);
        vec![(report, PathBuf::from("r.json"))]
    };
    let of_pair = |change: &dyn Fn(&mut isophote::conform::report::Pair)| {
        with(&|report| {
            let mut changed = pair(report);
            change(&mut changed);
            report.cases[0].outcomes[1].pairs[0] = changed;
        })
    };
    let named = ["r.json", "pole/above"];
    // "Agree" over counts that say otherwise.
    refused(
        &of_pair(&|pair| {
            pair.differing = 40;
            pair.causes.insert("coverage".to_owned(), 40);
        }),
        &[&named[..], &["40 pixels differ"]].concat(),
    );
    refused(&of_pair(&|pair| pair.differing = 40), &[&named[..], &["40 pixels differ, by causes 0"]].concat());
    refused(&of_pair(&|pair| pair.unbounded = pair.covered), &[&named[..], &["by reasons 0"]].concat());
    refused(
        &of_pair(&|pair| {
            pair.unbounded = pair.covered;
            pair.unbounded_causes = [("a pole".to_owned(), pair.covered)].into();
        }),
        &[&named[..], &["says that all agree", "has a verdict"]].concat(),
    );
    refused(&of_pair(&|pair| pair.unanswered = 7), &["7 pixels have no answer"]);
    refused(&of_pair(&|pair| pair.causes = [("undecided".to_owned(), 99)].into()), &["undecided"]);
    refused(
        &of_pair(&|pair| {
            pair.covered = 0;
            pair.unbounded = 0;
            pair.unbounded_causes.clear();
            pair.ambiguous = 0;
            pair.coverage = [0, 0, 64 * 64];
        }),
        &[&named[..], &["neither covers"]].concat(),
    );
    refused(&of_pair(&|pair| pair.covered = usize::MAX), &["covered"]);
    refused(&of_pair(&|pair| pair.coverage = [usize::MAX; 3]), &["coverage"]);
    refused(&of_pair(&|pair| pair.across_px = [Some(3.0), Some(0.25)]), &["3 px off"]);
    refused(&of_pair(&|pair| pair.difference = Some("https://example.org/a.png".to_owned())), &["PNG"]);
    // Nothing compared, or not what should have been.
    refused(&with(&|report| report.cases[0].outcomes[1].pairs.clear()), &["compared as []"]);
    refused(&with(&|report| drop(report.cases[0].outcomes[1].pairs.pop())), &["compared as"]);
    refused(&with(&|report| report.cases[1].size = [1, 1]), &["size", "repeated-knots"]);
    refused(&with(&|report| report.cases[1].options.push_str(" --chord 64")), &["options"]);
    refused(&with(&|report| report.cases[1].undecided = 5000), &["5000"]);
    refused(&with(&|report| report.subjects[1].kind = "cpu".to_owned()), &["kind"]);
    refused(&with(&|report| report.cases.push(report.cases[0].clone())), &["twice"]);
    // A shorter plan, whose every case agrees.
    refused(
        &with(&|report| {
            report.planned.truncate(1);
            report.cases.truncate(1);
        }),
        &["another corpus", "repeated-knots"],
    );
    refused(
        &with(&|report| {
            report.planned.truncate(1);
            report.scenes.truncate(1);
            report.cases.truncate(1);
        }),
        &["another corpus"],
    );
    // Without a GPU nothing was judged.
    let alone = with(&|report| {
        report.subjects.truncate(1);
        report.sources[0].subjects.truncate(1);
        report.cases.iter_mut().for_each(|case| case.outcomes.truncate(1));
    });
    assert_eq!(merged(&alone).expect("it belongs together").state(), State::NotRun);
}

#[test]
fn hostile_shards_are_refused_for_what_is_wrong_with_them() {
    let hostile = |name: &str| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/hostile").join(name);
        serde_json::from_slice::<Value>(&std::fs::read(path).expect("a hostile file")).expect("JSON")
    };
    let whole = smoke(&AGREEING);
    for (name, words) in [("short-plan.json", "corpus"), ("huge-shard.json", "at most 1000 parts")] {
        // As it is, of a layout of before; and brought up to date but for what is wrong with it.
        let old = hostile(name);
        let members = "\"unanswered\":0,\"unbounded_causes\":{},\"ambiguous\":";
        let new = old.to_string().replace("\"ambiguous\":", members);
        let mut new: Value = serde_json::from_str(&new).expect("JSON");
        new["schema_version"] = 2.into();
        new["corpus"] = whole.corpus.clone().into();
        for (label, document, words) in [("old", old, "schema_version 1"), ("new", new, words)] {
            let output = run(&format!("hostile-{label}-{name}"), &[(name, document.to_string())]);
            let message = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{label} {name}: {message}");
            assert!(message.contains(name) && message.contains(words), "{label} {name}: {message}");
        }
    }
}

#[cfg(unix)]
#[test]
fn endless_reports_are_refused_before_they_are_read() {
    let pipe = folder("merge-pipe").join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
    for path in [pipe.as_path(), std::path::Path::new("/dev/zero")] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_isophote"));
        let output = command.args(["conform", "merge"]).arg(path).arg("--out").arg(folder("merge-out")).output();
        let output = output.expect("isophote starts");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("not a regular file"), "{message}");
    }
}

#[test]
fn names_of_a_report_neither_move_the_cursor_nor_turn_a_line() {
    let mut report = smoke(&DIFFERING);
    let bad = "card\u{1b}]0;pwn\u{7}\u{1b}[2J\u{202e}\nall agree";
    let id = std::mem::replace(&mut report.subjects[1].id, bad.to_owned());
    report.subjects[1].name = bad.to_owned();
    report.subjects[1].driver = bad.to_owned();
    report.sources[0].subjects[1] = bad.to_owned();
    for outcome in report.cases.iter_mut().flat_map(|case| &mut case.outcomes).filter(|o| o.subject == id) {
        outcome.subject = bad.to_owned();
        outcome.pairs[0].reasons = vec![bad.to_owned()];
        outcome.pairs[0].worst[0].detail = bad.to_owned();
    }
    let output = run("names", &[("r.json", serde_json::to_string(&report).expect("JSON"))]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let out = folder("names-read");
    let merged = out.parent().expect("a folder").join("names/merged");
    let mut texts = vec![("table", String::from_utf8(output.stdout).expect("UTF-8"))];
    for name in ["report.html", "junit.xml"] {
        texts.push((name, std::fs::read_to_string(merged.join(name)).expect("written")));
    }
    for (name, text) in texts {
        assert!(!text.contains(['\u{1b}', '\u{7}', '\u{202e}']), "{name}");
        assert!(!text.lines().any(|line| line.trim_start().starts_with("all agree")), "{name}");
        // In the page's data the backslash is escaped itself.
        assert!(text.contains("\\u{202e}"), "{name}");
    }
}

#[test]
fn a_folder_takes_one_run_at_a_time_and_one_shard() {
    let whole = smoke(&AGREEING);
    let parts = shards(&whole);
    let folder = folder("claimed");
    let out = folder.join("out");
    std::fs::create_dir_all(&out).expect("a folder can be made");
    let merge = |reports: &[PathBuf]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_isophote"));
        command.args(["conform", "merge"]).args(reports).arg("--out").arg(&out).output().expect("isophote starts")
    };
    let paths: Vec<PathBuf> = (0..3).map(|k| folder.join(format!("{k}.json"))).collect();
    for (path, (part, _)) in paths.iter().zip(&parts) {
        std::fs::write(path, serde_json::to_string(part).expect("JSON")).expect("a file can be written");
    }
    let held = files::lock(&out).expect("nobody else");
    let output = merge(&paths);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("claimed") && message.contains("another run"), "{message}");
    drop(held);
    // A shard lies there already: neither the joined report nor another shard takes its place.
    std::fs::copy(&paths[1], out.join("report.json")).expect("a file can be copied");
    let before = std::fs::read(out.join("report.json")).expect("there");
    let again = Command::new(env!("CARGO_BIN_EXE_isophote"))
        .args(["conform", "--shard", "3/3", "--out"])
        .arg(&out)
        .output()
        .expect("isophote starts");
    for output in [merge(&paths), again] {
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("shard 2/3") && message.contains("--out"), "{message}");
    }
    assert_eq!(std::fs::read(out.join("report.json")).expect("there"), before);
    std::fs::remove_file(out.join("report.json")).expect("our own");
    assert_eq!(merge(&paths).status.code(), Some(0));
    assert_eq!(merge(&paths).status.code(), Some(0), "a whole report is replaced by a whole one");
}

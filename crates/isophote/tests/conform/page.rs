//! The page of `conform page` in a real browser: it judges what the browser draws, and its report is merged.

use crate::devtools::{Page, is_there};
use crate::setting::{folder, smoke};
use isophote::conform::report::{Report, State};
use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// Names the judge, a module of WebAssembly, that `hosts/browser/check` builds; then it must be there.
const JUDGE: &str = "ISOPHOTE_JUDGE";

/// An adapter without a GPU.
const SOFTWARE: &[&str] = &["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader"];

/// The longest wait for the pictures of a scene: SwiftShader and the judge stay below it on a loaded machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// Keeps what the page offers for saving.
const KEEP: &str = "{ const make = URL.createObjectURL.bind(URL); \
                    URL.createObjectURL = (blob) => { globalThis.kept = blob; return make(blob); }; 0 }";

/// The judge, where the test is to run; where it is not, says so.
fn judge(test: &str) -> Option<PathBuf> {
    let Some(judge) = std::env::var_os(JUDGE) else {
        let line = format!("NOT RUN: page::{test}: {JUDGE} names no judge; hosts/browser/check builds one\n");
        std::io::stderr().write_all(line.as_bytes()).expect("standard error takes a line");
        return None;
    };
    is_there(test, "a page with a judge").then(|| judge.into())
}

fn isophote(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_isophote")).args(arguments).output().expect("isophote starts")
}

/// Writes the page of one scene.
fn written(folder: &Path, judge: &Path) -> PathBuf {
    let file = folder.join("page.html");
    let [at, judge] = [&file, judge].map(|path| path.display().to_string());
    let output = isophote(&["conform", "page", &at, "--judge", &judge, "--shard", "1/18"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    file
}

/// What comes of the page in a browser with these flags, where `spoil` ran before it drew: its last line, a verdict a row, and its
/// report.
fn outcome(flags: &[&str], file: &Path, folder: &Path, spoil: &str) -> (String, Vec<String>, Report) {
    let mut page = Page::open_with(flags, file, folder.join("profile"), [1200, 900]);
    let started = Instant::now();
    let wait = |page: &mut Page, expression: &str, expected: Value| {
        while page.evaluate(expression) != expected {
            assert!(started.elapsed() < PATIENCE, "{expression} stays {}", page.evaluate(expression));
            std::thread::sleep(Duration::from_millis(50));
        }
    };
    wait(&mut page, "document.querySelectorAll('#adapter dt').length > 1", true.into());
    page.evaluate(KEEP);
    page.evaluate(spoil);
    page.evaluate("document.querySelector('#start').click()");
    wait(&mut page, "document.body.dataset.state !== 'running'", true.into());
    page.screenshot(&folder.join("page.png"));
    let line = page.evaluate("document.querySelector('#verdict').textContent").as_str().expect("text").to_owned();
    assert_eq!(page.evaluate("document.body.dataset.state"), "done", "{line}");
    let words = page.evaluate("[...document.querySelectorAll('#cases .badge')].map((badge) => badge.textContent)");
    let report = page.evaluate("kept.text()");
    assert_eq!(page.complaints, Vec::<String>::new());
    let report = serde_json::from_str(report.as_str().expect("text")).expect("a report");
    (line, serde_json::from_value(words).expect("words"), report)
}

/// How `conform merge` ends on a report.
fn merged(report: &Report, folder: &Path) -> Option<i32> {
    let [file, out] = ["saved.json", "merged"].map(|name| folder.join(name));
    std::fs::write(&file, serde_json::to_vec(report).expect("JSON")).expect("a file can be written");
    let output = isophote(&["conform", "merge", &file.display().to_string(), "--out", &out.display().to_string()]);
    assert!(out.join("report.json").exists(), "{}", String::from_utf8_lossy(&output.stderr));
    output.status.code()
}

/// Gives the page other bytes of each target than the GPU wrote.
fn spoiled(change: &str) -> String {
    format!(
        "{{ const mapped = GPUBuffer.prototype.getMappedRange;
            GPUBuffer.prototype.getMappedRange = function (...range) {{
              const bytes = new Uint8Array(mapped.apply(this, range));
              if (bytes.length === 64 * 64 * 16) {{ {change} }}
              return bytes.buffer;
            }}; 0 }}"
    )
}

#[test]
fn the_page_agrees_and_its_report_is_merged() {
    let Some(judge) = judge("the_page_agrees_and_its_report_is_merged") else { return };
    let folder = folder("page-agrees");
    let (line, words, report) = outcome(SOFTWARE, &written(&folder, &judge), &folder, "0");
    assert_eq!(words, ["agrees"; 4], "{line}");
    assert!(line.contains("in all 4 pictures"), "{line}");
    assert_eq!(report.state(), State::Agree);
    assert_eq!(report.subjects[1].backend, "webgpu");
    // A part of the suite is no whole, and what every scene gives as this one did is.
    assert_eq!([merged(&report, &folder), merged(&smoke(&report), &folder)], [Some(2), Some(0)]);
}

#[test]
fn one_wrong_pixel_differs_in_the_page_and_in_the_merged_report() {
    let Some(judge) = judge("one_wrong_pixel_differs_in_the_page_and_in_the_merged_report") else { return };
    let folder = folder("page-pixel");
    let spoil = spoiled("const middle = 16 * (64 * 32 + 32); bytes.copyWithin(middle, middle + 128, middle + 144);");
    let (line, words, report) = outcome(SOFTWARE, &written(&folder, &judge), &folder, &spoil);
    assert_eq!((words, report.state()), (vec!["differs".to_owned(); 4], State::Differ), "{line}");
    let gpu = &report.subjects[1].id;
    assert!(report.outcomes(gpu).all(|(_, outcome)| outcome.pairs.iter().all(|pair| pair.differing == 1)), "{line}");
    assert_eq!(merged(&smoke(&report), &folder), Some(1));
}

#[test]
fn a_shifted_picture_differs_in_the_page_and_in_the_merged_report() {
    let Some(judge) = judge("a_shifted_picture_differs_in_the_page_and_in_the_merged_report") else { return };
    let folder = folder("page-shifted");
    let (line, words, report) =
        outcome(SOFTWARE, &written(&folder, &judge), &folder, &spoiled("bytes.copyWithin(16, 0);"));
    assert_eq!((words, report.state()), (vec!["differs".to_owned(); 4], State::Differ), "{line}");
    assert_eq!(merged(&smoke(&report), &folder), Some(1));
}

#[test]
fn without_an_adapter_nothing_is_judged_and_the_report_says_so() {
    let Some(judge) = judge("without_an_adapter_nothing_is_judged_and_the_report_says_so") else { return };
    let folder = folder("page-absent");
    let spoil = "0";
    let (line, words, report) =
        outcome(&["--disable-gpu", "--disable-features=WebGPU"], &written(&folder, &judge), &folder, spoil);
    assert!(line.starts_with("Nothing was judged: "), "{line}");
    assert_eq!((words.len(), report.state()), (0, State::NotRun));
    assert_eq!(merged(&report, &folder), Some(2));
}

#[test]
fn a_judge_that_is_none_makes_no_page() {
    let folder = folder("page-refused");
    let [page, text] = ["page.html", "judge.wasm"].map(|name| folder.join(name).display().to_string());
    std::fs::write(&text, "no module").expect("a file can be written");
    for judge in [&text, "nowhere.wasm"] {
        let output = isophote(&["conform", "page", &page, "--judge", judge]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(&format!("the judge, {judge}")), "{said}");
    }
    assert!(!Path::new(&page).exists());
}

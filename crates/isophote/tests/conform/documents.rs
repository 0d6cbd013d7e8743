//! JUnit and JSON against their schemas, with wrong documents to show that the schemas look.

use crate::setting::{AGREEING, DIFFERING, Losing, folder, gpu, run};
use crate::xsd::Schema;
use isophote::conform::report::{Report, State};
use isophote::conform::wrong::Vacuity;
use isophote::conform::{html, junit, table};
use serde_json::{Value, json};
use std::path::Path;

fn schema(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/schema").join(name)
}

/// What the schema says of a document; empty where it is valid.
fn invalid_junit(document: &[u8]) -> Vec<String> {
    let text = std::fs::read_to_string(schema("junit-10.xsd")).expect("the schema is there");
    Schema::read(&text).complaints(document)
}

/// What the schema says of a document; empty where it is valid.
fn invalid_json(document: &Value) -> Vec<String> {
    let text = std::fs::read_to_string(schema("conform-2.json")).expect("the schema is there");
    let schema = serde_json::from_str(&text).expect("the schema is JSON");
    let validator = jsonschema::validator_for(&schema).expect("the schema is one");
    validator.iter_errors(document).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

/// Agreeing, differing, cut short by a lost adapter whose driver says what XML cannot hold.
fn reports() -> Vec<(&'static str, Report)> {
    let mut lost = run(Box::new(Losing { gpu: gpu(), left: 1 }));
    lost.subjects[1].failure = Some("lost: <\u{1b}[31m&\"gone\"\u{0}>]]>".to_owned());
    lost.notes.push("</script><script>alert(1)</script>".to_owned());
    vec![("agreeing", AGREEING.clone()), ("differing", DIFFERING.clone()), ("lost", lost)]
}

#[test]
fn junit_is_valid_and_counts_what_the_report_says() {
    for (name, report) in reports() {
        let bytes = junit::xml(&report).expect("XML");
        assert_eq!(invalid_junit(&bytes), [""; 0], "{name}");
        let text = String::from_utf8(bytes).expect("UTF-8");
        let (failures, errors) = (text.matches("<failure").count(), text.matches("<error").count());
        match name {
            "agreeing" => assert_eq!((failures, errors, text.matches("<testcase").count()), (0, 0, 3 + 6)),
            // Both comparisons of each picture.
            "differing" => assert_eq!((failures, errors), (6, 0)),
            _ => assert_eq!((failures, errors), (0, 2)),
        }
        assert!(text.contains(&format!("failures=\"{failures}\" errors=\"{errors}\"")), "{text}");
    }
}

/// A wrong picture that agrees, and a scene of which nothing can be said, fail like a difference.
#[test]
fn what_was_not_caught_and_what_has_no_verdict_is_red() {
    let mut missed = AGREEING.clone();
    let names = vec!["shifted by 1 pixel (100 pixels)".to_owned()];
    missed.cases[0].outcomes[0].wrong =
        Some(Vacuity { made: 7, caught: 6, missed: names, pixels: 900, differing: 800 });
    let mut open = AGREEING.clone();
    let pair = &mut open.cases[0].outcomes[0].pairs[0];
    (pair.agree, pair.unbounded, pair.reasons) = (false, pair.covered, vec!["none has a verdict".to_owned()]);
    pair.unbounded_causes.insert("normal without a bound in f32".to_owned(), pair.covered);
    for (name, words, report) in
        [("missed", "1 of 7 pictures made wrong", missed), ("open", "none has a verdict", open)]
    {
        let bytes = junit::xml(&report).expect("XML");
        assert_eq!(invalid_junit(&bytes), Vec::<String>::new(), "{name}");
        let text = String::from_utf8(bytes).expect("UTF-8");
        assert!(text.matches("<failure").count() == 1 && text.contains(words), "{text}");
        assert_eq!(report.state(), State::Differ);
        assert_eq!(invalid_json(&serde_json::to_value(&report).expect("JSON")), Vec::<String>::new());
        assert!(table::text(&report).contains("SOMETHING DIFFERS"));
    }
}

#[test]
fn the_junit_schema_refuses_what_is_wrong() {
    let text = String::from_utf8(junit::xml(&AGREEING).expect("XML")).expect("UTF-8");
    let first = |from: &str, to: &str| text.replacen(from, to, 1);
    let wrong = [
        ("no name", first("<testcase name=", "<testcase nome=")),
        ("bad time", first("time=\"", "time=\"soon")),
        ("a time of four decimals", first("time=\"", "time=\"0.1234")),
        ("a stray element", first("<properties>", "<verdict/><properties>")),
        ("a stray element of the schema", first("<properties>", "<property name=\"a\" value=\"b\"/><properties>")),
        ("another root", text.replace("testsuites", "verdicts")),
        ("no count", first(" errors=", " wrongs=")),
        ("text between", first("<properties>", "words<properties>")),
        ("an attribute twice", first("<property name=", "<property name=\"again\" name=")),
        ("no value", first(" value=\"", " worth=\"")),
        ("an unknown reference", first("classname=\"", "classname=\"&verdict;")),
        ("a control character", first("classname=\"", "classname=\"\u{1b}")),
        ("a hidden control character", first("classname=\"", "classname=\"&#27;")),
        ("markup in a value", first("classname=\"", "classname=\"<")),
        ("two documents", text.clone() + &text),
        ("cut off", text[..text.len() / 2].to_owned()),
        ("nothing", String::new()),
    ];
    for (name, document) in wrong {
        assert_ne!(invalid_junit(document.as_bytes()), [""; 0], "{name}");
    }
    assert_ne!(invalid_junit(b"<testsuites>\xff</testsuites>"), [""; 0]);
}

#[test]
fn json_is_valid_and_reads_back_as_it_was() {
    for (name, report) in reports() {
        let document = serde_json::to_value(&report).expect("JSON");
        assert_eq!(invalid_json(&document), [""; 0], "{name}");
        let folder = folder(&format!("json-{name}"));
        report.write(&folder).expect("a folder to write to");
        assert_eq!(Report::read(&folder.join("report.json")).expect("readable"), report);
    }
}

#[test]
fn the_json_schema_refuses_what_is_wrong() {
    let whole = serde_json::to_value(&*DIFFERING).expect("JSON");
    let wrong: [(&str, Value); 9] = [
        ("/schema", json!("other")),
        ("/schema_version", json!(1)),
        ("/cases/0/outcomes/0/pairs/0/covered", json!(-1)),
        ("/cases/0/picture", json!("https://example.org/a.png")),
        ("/cases/0/outcomes/1/pairs/0/worst/0/candidate", json!({"face": 0})),
        ("/subjects/0/kind", json!("toaster")),
        ("/shard", json!("1/3")),
        ("/shard/count", json!(4_000_000_000u64)),
        ("/corpus", json!("")),
    ];
    for (place, value) in wrong {
        let mut document = whole.clone();
        *document.pointer_mut(place).unwrap_or_else(|| panic!("no {place}")) = value;
        assert!(!invalid_json(&document).is_empty(), "{place}");
    }
    let mut document = whole.clone();
    document.as_object_mut().expect("an object").remove("planned");
    assert!(!invalid_json(&document).is_empty(), "planned");
}

#[test]
fn the_page_fetches_nothing_and_no_text_of_the_report_becomes_markup() {
    for (name, report) in reports() {
        let page = html::page(&report).expect("a page");
        for outside in ["http://", "https://", "@import", "src=\"//"] {
            let found = page.replace("http://www.w3.org/2000/svg", "");
            assert!(!found.contains(outside), "{name}: {outside}");
        }
        assert_eq!((page.matches("<script").count(), page.matches("</script").count()), (2, 2), "{name}");
    }
}

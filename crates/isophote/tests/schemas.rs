//! What `--format json` prints keeps to the schemas that are written of it.

use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

const FOREIGN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/foreign/teapot.npz");

fn schema(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/schema").join(name);
    serde_json::from_slice(&std::fs::read(path).expect("a schema")).expect("JSON")
}

fn printed(arguments: &[&str]) -> Value {
    json_of(&[arguments, &["--format", "json"]].concat())
}

fn json_of(arguments: &[&str]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_isophote")).args(arguments).output();
    let output = output.expect("isophote starts");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
}

#[test]
fn each_document_keeps_to_its_schema_and_a_broken_one_does_not() {
    let documents = [
        ("compare-1.json", printed(&["compare", "teapot", "--size", "32x32", "--no-gpu"])),
        ("compare-1.json", printed(&["compare", "islands", "--size", "24x24", "--no-gpu", "--antialias", "4"])),
        ("judge-1.json", printed(&["compare", FOREIGN])),
        ("info-1.json", printed(&["info", "sphere"])),
        ("info-1.json", printed(&["info", "islands"])),
        ("info-1.json", printed(&["info", &format!("{}/../../testdata/step/layers.step", env!("CARGO_MANIFEST_DIR"))])),
        ("versions-1.json", printed(&["compare", "islands", "petal", "--size", "24x24", "--within", "0.2"])),
        (
            "versions-1.json",
            printed(&["compare", "islands", "petal", "--eye", "9", "0", "0", "--target", "10", "0", "0"]),
        ),
        ("eval-1.json", json_of(&["eval", "sphere"])),
    ];
    for (name, mut document) in documents {
        let schema = jsonschema::validator_for(&schema(name)).expect("a schema");
        let faults: Vec<String> = schema.iter_errors(&document).map(|fault| fault.to_string()).collect();
        assert!(faults.is_empty(), "{name}: {faults:?}");
        let place = ["/pairs/0/verdict", "/faces/0/degree", "/queries/0/results/0/S", "/seen"]
            .into_iter()
            .find(|p| document.pointer(p).is_some());
        *document.pointer_mut(place.expect("a place")).expect("it is there") = json!("perhaps");
        assert!(!schema.is_valid(&document), "{name}");
    }
}

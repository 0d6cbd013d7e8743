//! The crates depend on each other as ARCHITECTURE.md draws it, and in no other way.

use crate::metadata::metadata;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Every arrow that may be drawn: a crate and those it may use.
const ARROWS: &[(&str, &[&str])] = &[
    ("files", &[]),
    ("lanes", &[]),
    ("nurbs", &["lanes"]),
    ("scene", &["nurbs"]),
    ("formats", &["files", "nurbs", "scene"]),
    ("export", &["files", "nurbs", "scene", "formats"]),
    ("models", &["nurbs", "scene", "formats"]),
    ("gbuffer", &["files", "nurbs", "scene"]),
    ("pipeline", &["lanes", "nurbs", "scene", "gbuffer"]),
    ("raster", &["nurbs", "scene", "gbuffer", "pipeline"]),
    ("gpu", &["files", "nurbs", "scene", "gbuffer", "pipeline"]),
    ("raycast", &["nurbs", "scene", "gbuffer"]),
    ("compare", &["nurbs", "scene", "gbuffer", "pipeline"]),
    ("continuity", &["nurbs", "scene"]),
    ("lines", &["nurbs", "scene"]),
    ("view", &["nurbs", "scene", "gbuffer"]),
    (
        "suite",
        &[
            "files",
            "scene",
            "formats",
            "models",
            "gbuffer",
            "pipeline",
            "raster",
            "gpu",
            "raycast",
            "compare",
            "techniques",
        ],
    ),
    ("techniques", &["lanes", "nurbs", "scene", "pipeline", "raster", "gpu", "compare"]),
];

/// On top of all: these may use any crate. `isophote` is what users run, and the others drive it.
const ON_TOP: &[&str] = &["isophote", "python", "xtask", "conformance", "processors", "judge", "fuzz"];

/// Crates and the workspace crates that they use, not counting what only their own tests use.
fn drawn(metadata: &Value) -> BTreeMap<String, BTreeSet<String>> {
    let packages = metadata["packages"].as_array().expect("metadata lists packages");
    let name = |p: &Value| p["name"].as_str().expect("a package has a name").to_owned();
    let members: BTreeSet<String> = packages.iter().map(name).collect();
    packages
        .iter()
        .map(|package| {
            let dependencies = package["dependencies"].as_array().expect("a package lists dependencies");
            let used = dependencies.iter().filter(|d| d["kind"] != "dev").map(name).filter(|d| members.contains(d));
            (name(package), used.collect())
        })
        .collect()
}

/// Arrows that are drawn and may not be, as "from -> to".
fn forbidden(drawn: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    let allowed: BTreeMap<&str, &[&str]> = ARROWS.iter().copied().collect();
    drawn
        .iter()
        .filter(|(from, _)| !ON_TOP.contains(&from.as_str()))
        .flat_map(|(from, to)| {
            let may = allowed.get(from.as_str()).copied().unwrap_or_default();
            to.iter().filter(move |to| !may.contains(&to.as_str())).map(move |to| format!("{from} -> {to}"))
        })
        .collect()
}

#[test]
fn crates_use_each_other_only_as_the_architecture_draws_it() {
    let metadata = metadata(&["--no-deps"]);
    let drawn = drawn(&metadata);
    assert_eq!(forbidden(&drawn), Vec::<String>::new());
    let crates: BTreeSet<&str> = drawn.keys().map(String::as_str).collect();
    let expected: BTreeSet<&str> = ARROWS.iter().map(|(name, _)| *name).chain(ON_TOP.iter().copied()).collect();
    assert_eq!(crates, expected);
}

#[test]
fn an_arrow_from_the_oracle_to_the_pipeline_is_rejected() {
    let metadata = serde_json::json!({"packages": [
        {"name": "pipeline", "dependencies": []},
        {"name": "raycast", "dependencies": [{"name": "pipeline", "kind": null}, {"name": "glam", "kind": null}]},
        {"name": "xtask", "dependencies": [{"name": "pipeline", "kind": null}]},
    ]});
    assert_eq!(forbidden(&drawn(&metadata)), ["raycast -> pipeline"]);
}

#[test]
fn the_architecture_document_names_every_crate_and_arrow() {
    let text = include_str!("../../ARCHITECTURE.md");
    for (name, uses) in ARROWS {
        let line = format!("| `{name}` | {} |", if uses.is_empty() { "—".to_owned() } else { uses.join(", ") });
        assert!(text.contains(&line), "ARCHITECTURE.md lacks the line {line}");
    }
}

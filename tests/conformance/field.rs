//! Inputs from public bug reports (`testdata/field`, each with what is right beside it) and hostile ones (`testdata/hostile`).

mod models;
mod rays;
mod verdicts;

use std::path::PathBuf;

/// Where a file of `testdata/field` lies.
fn field(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../testdata/field")).join(format!("{name}.json"))
}

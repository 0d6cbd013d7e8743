//! What cargo says of the workspace's packages.

use serde_json::Value;
use std::process::Command;

/// Options of `cargo metadata` by which it lists what this platform builds, too, and not the workspace alone.
pub(crate) const BUILT: &[&str] = &["--filter-platform", "host-tuple"];

/// All of `cargo metadata`, without a network.
pub(crate) fn metadata(options: &[&str]) -> Value {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--offline"])
        .args(options)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON")
}

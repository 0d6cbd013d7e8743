//! The oldest Rust that `Cargo.toml` promises is one that every package takes.
//!
//! clippy refuses what the standard library got later (`incompatible_msrv`). What the language got later only a build by that
//! toolchain finds: `cargo +1.90 check --workspace`.

use crate::metadata::{BUILT, metadata};
use serde_json::Value;

/// The parts of a version; what is left out is 0.
fn version(text: &str) -> [u32; 3] {
    let mut parts = text.split('.').map(|part| part.parse().expect("a number"));
    std::array::from_fn(|_| parts.next().unwrap_or(0))
}

/// Packages that ask for a newer Rust than `promised`.
fn newer<'p>(packages: &'p [Value], promised: &str) -> Vec<&'p str> {
    let asks = |p: &&Value| p["rust_version"].as_str().is_some_and(|own| version(promised) < version(own));
    packages.iter().filter(asks).map(|p| p["name"].as_str().expect("a name")).collect()
}

#[test]
fn no_package_asks_for_a_newer_rust_than_is_promised() {
    let metadata = metadata(BUILT);
    let packages = metadata["packages"].as_array().expect("metadata lists packages");
    let promised = env!("CARGO_PKG_RUST_VERSION");
    assert!(packages.len() > 100 && packages.iter().any(|p| p["rust_version"] == promised));
    assert_eq!(newer(packages, promised), [""; 0]);
    // A promise that is too old is found.
    assert!(!newer(packages, "1.56").is_empty());
    assert!(version("1.9") < version("1.90.1") && version("1.90") < version("1.90.1"));
}

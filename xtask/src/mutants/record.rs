//! The reviewed list of mutants that no scene can catch, each with its reason: `testdata/mutants/reviewed.json`.

use super::mutant::Key;
use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Why no scene can catch a mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// It computes the same on every legal input.
    Equivalent,
    /// It may compute something else, but only what the program's contract leaves open.
    Permitted,
}

/// Mutants that survive for one reason.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// Which sort of reason.
    pub kind: Kind,
    /// The reason.
    pub reason: String,
    /// The mutants.
    pub mutants: Vec<Key>,
}

/// The list as it stands in the repository.
///
/// # Errors
/// Where it cannot be read, or a reason is missing.
pub fn reviewed() -> Result<Vec<Group>> {
    let path = path();
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let groups: Vec<Group> = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
    if let Some(index) = groups.iter().position(|group| group.reason.trim().is_empty() || group.mutants.is_empty()) {
        bail!("{}: group {index} has no reason or no mutants", path.display());
    }
    Ok(groups)
}

/// Where the list stands.
pub fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../testdata/mutants/reviewed.json")
}

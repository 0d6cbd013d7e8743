//! Files and folders that commands write, by the one way that [`files`] has; each error names its path.

use anyhow::{Context, Result};
use serde::Serialize;
use std::path::Path;

/// Makes a folder, and those that it is in.
///
/// # Errors
/// Where it cannot be made.
pub fn folder(path: &Path) -> Result<()> {
    std::fs::create_dir_all(path).with_context(|| path.display().to_string())
}

/// Writes a file, whole or not at all.
///
/// # Errors
/// Where it cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    files::write_bytes(path, bytes).with_context(|| path.display().to_string())
}

/// Writes a JSON document, laid out over lines.
///
/// # Errors
/// Where it cannot be written.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    write(path, &serde_json::to_vec_pretty(value)?)
}

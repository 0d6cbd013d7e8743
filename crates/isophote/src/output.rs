//! Files and folders that commands write, by the one way that [`files`] has; each error names its path.

use crate::terminal;
use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::path::Path;

/// The path that stands for standard output.
const STANDARD: &str = "-";

/// Makes a folder, and those that it is in.
///
/// # Errors
/// Where it cannot be made.
pub fn folder(path: &Path) -> Result<()> {
    std::fs::create_dir_all(path).with_context(|| path.display().to_string())
}

/// A folder that is made if need be, and that nobody else writes to until this is dropped.
///
/// # Errors
/// Where it cannot be made, or another run writes there.
pub fn claim(folder: &Path) -> Result<files::Lock> {
    files::lock(folder).with_context(|| folder.display().to_string())
}

/// Whether a path stands for standard output.
pub fn is_standard(path: &Path) -> bool {
    path == Path::new(STANDARD)
}

/// Refuses a path that cannot be written, before there is anything to write: its name must end in `.` and `ending`, unless a
/// pipe or a device is there, and its folder is made.
///
/// # Errors
/// What is wrong with it.
pub fn check(path: &Path, ending: &str) -> Result<()> {
    let place = || path.display().to_string();
    let is_file = std::fs::metadata(path).map_or(true, |there| there.is_file() || there.is_dir());
    if is_file && !path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending)) {
        bail!("{}: its name must end in .{ending}, which is what is written", place());
    }
    check_place(path)
}

/// Refuses a path at which nothing can be written, whatever its name, before there is anything to write; its folder is made.
///
/// # Errors
/// What is wrong with it.
pub fn check_place(path: &Path) -> Result<()> {
    if let Some(parent) = path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        folder(parent)?;
    }
    files::check(path).with_context(|| path.display().to_string())
}

/// Writes a file, whole or not at all; to standard output where the path is `-`.
///
/// # Errors
/// Where it cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    if is_standard(path) {
        return terminal::bytes(bytes);
    }
    files::write_bytes(path, bytes).with_context(|| path.display().to_string())
}

/// Writes a JSON document, laid out over lines.
///
/// # Errors
/// Where it cannot be written.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    write(path, &serde_json::to_vec_pretty(value)?)
}

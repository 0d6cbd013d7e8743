//! Files and folders that commands write, by the one way that [`files`] has; each error names its path.

use crate::terminal;
use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::ffi::OsStr;
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

/// Whether a path stands for standard output: `-`, or `-.svg` where a command writes files of several kinds.
pub fn is_standard(path: &Path) -> bool {
    path.file_stem() == Some(OsStr::new(STANDARD)) && path.components().count() == 1
}

/// Which of the kinds of file that a command writes a path is to hold, by its ending; refuses what cannot be written, before there
/// is anything to write. The folder is made. Standard output, a pipe or a device without one of these endings holds the first kind.
///
/// # Errors
/// What is wrong with it.
pub fn kind(path: &Path, endings: &[&'static str]) -> Result<&'static str> {
    let own = path.extension();
    let known = endings.iter().find(|ending| own.is_some_and(|own| own.eq_ignore_ascii_case(ending)));
    let is_file = std::fs::metadata(path).map_or(true, |there| there.is_file() || there.is_dir());
    let is_plain = if is_standard(path) { own.is_some() } else { is_file };
    let kind = match (known, endings) {
        (Some(kind), _) => kind,
        (None, [first, ..]) if !is_plain => first,
        (None, [only]) => bail!("{}: its name must end in .{only}, which is what is written", path.display()),
        (None, _) => {
            let all = endings.iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(", ");
            bail!("{}: its name must end in one of {all}, which are what is written", path.display())
        }
    };
    if !is_standard(path) {
        check_place(path)?;
    }
    Ok(kind)
}

/// Refuses a path that cannot be written as one kind of file, as [`kind`] does.
///
/// # Errors
/// What is wrong with it.
pub fn check(path: &Path, ending: &'static str) -> Result<()> {
    kind(path, &[ending]).map(|_| ())
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

/// Writes a file, whole or not at all, or to standard output.
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

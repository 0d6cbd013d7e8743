//! The journal of a run: what became of each mutant, a line each as soon as it is known, so that a run that is cut off
//! goes on where it was.

use super::mutant::Key;
use super::report::Tried;
use super::worker::Outcome;
use anyhow::{Context, Result};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Mutex;

/// A file of outcomes, or none.
#[derive(Debug, Default)]
pub struct Journal {
    known: HashMap<Key, Outcome>,
    file: Option<Mutex<File>>,
}

impl Journal {
    /// Reads what stands in the file, which is made where there is none. A last line without an end was being written when
    /// its run was killed; it is left out, and written over.
    ///
    /// # Errors
    /// Where the file cannot be read or written, or a line is none of a journal.
    pub fn open(path: &Path) -> Result<Self> {
        let named = || path.display().to_string();
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).with_context(named)?;
        let mut text = String::new();
        file.read_to_string(&mut text).with_context(named)?;
        let whole = text.rfind('\n').map_or(0, |newline| newline + 1);
        let read = |(index, line): (usize, &str)| {
            let tried: Tried = serde_json::from_str(line).with_context(|| format!("{}:{}", named(), index + 1))?;
            Ok((tried.mutant.key, tried.outcome))
        };
        let known = text[..whole].lines().enumerate().map(read).collect::<Result<_>>()?;
        file.set_len(whole as u64).with_context(named)?;
        file.seek(SeekFrom::End(0)).with_context(named)?;
        Ok(Self { known, file: Some(Mutex::new(file)) })
    }

    /// What became of a mutant in an earlier run.
    pub fn known(&self, key: &Key) -> Option<&Outcome> {
        self.known.get(key)
    }

    /// Adds a line.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn add(&self, tried: &Tried) -> Result<()> {
        let Some(file) = &self.file else { return Ok(()) };
        let line = serde_json::to_string(tried)? + "\n";
        file.lock().expect("no holder panics").write_all(line.as_bytes()).context("the journal")
    }
}

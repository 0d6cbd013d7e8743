//! What the page asks: a line of JSON, and the bytes of the files that it lists, one after the other.

use anyhow::{Context, Result, ensure};
use gpu::capsule::Host;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use suite::corpus::Suite;
use suite::report::Report;
use suite::shard::Shard;

/// The first line.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Request {
    /// Of which suite.
    pub suite: Suite,
    /// Of which part of it.
    pub shard: Shard,
    /// What was found so far; none at the beginning.
    pub report: Option<Report>,
    /// The scene to be judged.
    pub scene: Option<String>,
    /// Who drew.
    pub drawn_by: DrawnBy,
    /// The folder of the answer to [`gpu::capsule::edges`], where the rasterizer is to be measured.
    pub edges: Option<PathBuf>,
    /// How far corners are moved, as a verdict said that was measured, pixels.
    pub moves_px: Option<f64>,
    /// What was drawn of the scene.
    #[serde(default)]
    pub pictures: Vec<Picture>,
    /// The files that follow: a path, and how many bytes.
    #[serde(default)]
    pub files: Vec<(PathBuf, usize)>,
}

/// Who drew.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub enum DrawnBy {
    /// An adapter of this browser.
    Host {
        /// As its answers say.
        host: Host,
        /// What the browser calls its operating system.
        platform: String,
    },
    /// Nobody.
    Absent {
        /// Why.
        why: String,
    },
}

/// What was drawn of one case.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Picture {
    /// [`PlannedCase::options`](suite::corpus::PlannedCase::options) of the case.
    pub options: String,
    /// The folder of its capsule.
    pub capsule: PathBuf,
    /// The folder of the answer, where there is one.
    pub answer: Option<PathBuf>,
    /// Why there is none.
    pub failure: Option<String>,
}

/// Files by path.
pub type Files = BTreeMap<PathBuf, Vec<u8>>;

impl Request {
    /// Takes a request apart.
    ///
    /// # Errors
    /// Where its first line is no such JSON, or the files' lengths are not those of the bytes that follow.
    pub fn read(bytes: &[u8]) -> Result<(Self, Files)> {
        let end = bytes.iter().position(|byte| *byte == b'\n').context("the request has no line end")?;
        let (head, mut rest) = (&bytes[..end], &bytes[end + 1..]);
        let request: Self = serde_json::from_slice(head).context("the request")?;
        let mut files = Files::new();
        for (path, length) in &request.files {
            let taken;
            (taken, rest) = rest.split_at_checked(*length).with_context(|| format!("{} is cut off", path.display()))?;
            files.insert(path.clone(), taken.to_vec());
        }
        ensure!(rest.is_empty(), "{} bytes follow the files", rest.len());
        Ok((request, files))
    }
}

//! Parts of a suite, for several machines.

use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The most parts that a suite is cut into: more than it has scenes, and few enough to count them one by one.
pub const MAX_SHARDS: usize = 1000;

/// Part `index` (from 1) of `count` of a suite, at most [`MAX_SHARDS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "RawShard")]
pub struct Shard {
    /// Which part, from 1.
    pub index: usize,
    /// Of how many.
    pub count: usize,
}

/// A part as it stands in a file, before it is judged.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawShard {
    index: usize,
    count: usize,
}

impl TryFrom<RawShard> for Shard {
    type Error = anyhow::Error;

    fn try_from(raw: RawShard) -> Result<Self> {
        Self::new(raw.index, raw.count)
    }
}

impl Shard {
    /// Part `index` of `count`.
    ///
    /// # Errors
    /// Where there is no such part, or too many.
    pub fn new(index: usize, count: usize) -> Result<Self> {
        if index < 1 || index > count {
            bail!("shard {index}/{count}: the first number goes from 1 to the second");
        }
        if count > MAX_SHARDS {
            bail!("shard {index}/{count}: a suite has at most {MAX_SHARDS} parts");
        }
        Ok(Self { index, count })
    }

    /// The whole suite.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Whether this part runs the scene at `place` of the suite's list.
    pub fn holds(self, place: usize) -> bool {
        place % self.count == self.index - 1
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        let (index, count) = parts.with_context(|| format!("{text:?} is not K/N, as in 2/3"))?;
        Self::new(index, count)
    }
}

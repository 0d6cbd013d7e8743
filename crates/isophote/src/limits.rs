//! How fine grids may be, and how many zones are drawn at once, as the command line asks for it.

use crate::words::{self, Words};
use clap::{Args, value_parser};
use techniques::{DEFAULT_ZONES, GREATEST_LEVEL, Limits, ZONE_WORDS};

/// What bounds techniques `grid` and `zones`.
#[derive(Debug, Clone, Copy, Args)]
pub struct LimitArgs {
    /// Of techniques grid and zones: at most 2^LEVEL cells along each side of a patch. Concheiro's L is about LEVEL = L + 1
    #[arg(long, hide_short_help = true, value_name = "LEVEL", default_value_t = GREATEST_LEVEL, value_parser = value_parser!(u32).range(0..=i64::from(GREATEST_LEVEL)))]
    level: u32,
    /// Of technique zones: patches that one step draws, all of each [default: parts of patches, as many as one step may emit]
    #[arg(long, hide_short_help = true, value_name = "PATCHES", value_parser = value_parser!(u32).range(1..))]
    batch: Option<u32>,
    /// Of technique zones: numbers of 32 bits that one step may emit, four a zone; 1024 in the paper. With --batch a patch that
    /// takes more is refused
    #[arg(long, hide_short_help = true, value_name = "WORDS", default_value_t = ZONE_WORDS * DEFAULT_ZONES, value_parser = value_parser!(u32).range(i64::from(ZONE_WORDS)..))]
    emit: u32,
}

impl LimitArgs {
    /// As they stand on a command line.
    pub fn words(self) -> Vec<Words> {
        let own = [words::option("--level", self.level), words::option("--emit", self.emit)];
        own.into_iter().chain(self.batch.map(|batch| words::option("--batch", batch))).collect()
    }

    /// The same in the techniques' own words.
    pub fn limits(self) -> Limits {
        Limits { level: self.level, zones: self.emit / ZONE_WORDS, batch: self.batch, ..Limits::default() }
    }
}

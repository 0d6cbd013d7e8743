//! The command line of Isophote: one file a command, and what they share.
//!
//! A library, so that `cargo xtask` offers the same commands, and the conformance tests drive the same [`stage`] as a user
//! does.
//!
//! # Examples
//! ```
//! use clap::Parser;
//! use isophote::commands::Cli;
//!
//! assert!(Cli::try_parse_from(["isophote", "compare", "teapot", "--no-gpu"]).is_ok());
//! assert!(Cli::try_parse_from(["isophote", "compare", "teapot", "--no-cpu"]).is_err());
//! ```

pub mod adapters;
pub mod angles;
pub mod antialias;
pub mod approximate;
pub mod brush;
pub mod capsule;
pub mod commands;
pub mod compare;
pub mod completions;
pub mod conform;
pub mod continuity;
pub mod convert;
pub mod cost;
pub mod curves;
pub mod entry;
pub mod eval;
pub mod format;
pub mod info;
pub mod leaf;
pub mod limits;
pub mod lines;
pub mod listing;
pub mod look;
pub mod man;
pub mod masks;
pub mod number;
pub mod output;
pub mod overlay;
pub mod pixel;
pub mod render;
pub mod scene;
pub mod shadow;
pub mod sight;
pub mod study;
pub mod technique;
pub mod terminal;
pub mod versions;
pub mod view;
pub mod viewer;
pub mod with;
pub mod words;

// What the suite shares with judges that are not this program.
pub use suite::{embedded, stage, text};

//! The command line of Isophote: one file a command, and what they share.
//!
//! A library, so that the conformance tests drive the same [`stage`] as a user does.

pub mod adapters;
pub mod antialias;
pub mod approximate;
pub mod bench;
pub mod bless;
pub mod ci;
pub mod compare;
pub mod conform;
pub mod continuity;
pub mod convert;
pub mod cost;
pub mod eval;
pub mod format;
pub mod geiger;
pub mod info;
pub mod kanai;
pub mod limits;
pub mod listing;
pub mod masks;
pub mod mutants;
pub mod number;
pub mod output;
pub mod overlay;
pub mod pixel;
pub mod render;
pub mod scene;
pub mod stage;
pub mod study;
pub mod technique;
pub mod terminal;
pub mod text;
pub mod view;

//! The tables of `docs/formats.md` against what the code lists.

use crate::common::root;
use formats::{FORMATS, Support};

/// Compares the table in the section of a format with what its reader lists.
pub fn assert_table_is_listed(name: &str) {
    let text = std::fs::read_to_string(root().join("docs/formats.md")).expect("the tables");
    let section = text.split("\n## ").find(|section| section.lines().next() == Some(name)).expect("a section");
    let rows: Vec<Vec<&str>> = section
        .lines()
        .filter(|line| line.starts_with("| "))
        .skip(2)
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    let word = |support: &Support| match support {
        Support::Exact => "exact",
        Support::Approximated => "approximated",
        Support::Followed => "followed",
        Support::LeftOut => "left out",
    };
    let format = FORMATS.iter().find(|format| format.name() == name).expect("it is in the list");
    let listed: Vec<Vec<&str>> = format.entities().iter().map(|(name, support)| vec![*name, word(support)]).collect();
    assert_eq!(rows, listed);
}

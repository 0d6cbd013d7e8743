//! Every package that is built has a licence of `deny.toml`'s list.

use crate::metadata::{BUILT, metadata};
use serde_json::Value;

/// The licences that `deny.toml` allows.
fn allowed() -> Vec<&'static str> {
    let text = include_str!("../../deny.toml");
    let list = text.split_once("allow = [").and_then(|(_, rest)| rest.split_once(']')).expect("a list").0;
    list.split(',').map(|item| item.trim().trim_matches('"')).filter(|item| !item.is_empty()).collect()
}

/// The parts of an SPDX expression between the word, where that stands outside of brackets.
fn parts(expression: &str, word: &str) -> Vec<String> {
    let (mut depth, mut parts) = (0, vec![vec![]]);
    let spaced = expression.replace('(', " ( ").replace(')', " ) ");
    for token in spaced.split_whitespace() {
        depth += i32::from(token == "(") - i32::from(token == ")");
        match parts.last_mut() {
            Some(last) if token != word || depth > 0 => last.push(token),
            _ => parts.push(vec![]),
        }
    }
    parts.into_iter().map(|tokens| tokens.join(" ")).collect()
}

/// Whether an expression can be met. `AND` binds tighter than `OR`; the older `/` is an `OR`.
fn is_met(expression: &str, allowed: &[&str]) -> bool {
    let (alternatives, all) = (parts(&expression.replace('/', " OR "), "OR"), parts(expression, "AND"));
    if alternatives.len() > 1 {
        return alternatives.iter().any(|part| is_met(part, allowed));
    }
    if all.len() > 1 {
        return all.iter().all(|part| is_met(part, allowed));
    }
    match all[0].strip_prefix("( ").and_then(|rest| rest.strip_suffix(" )")) {
        Some(inner) => is_met(inner, allowed),
        None => allowed.contains(&all[0].as_str()),
    }
}

#[test]
fn every_package_has_a_licence_of_the_list() {
    let metadata = metadata(BUILT);
    let packages = metadata["packages"].as_array().expect("metadata lists packages");
    assert!(packages.len() > 100, "{} packages: the resolved ones, too", packages.len());
    let allowed = allowed();
    let named = |package: &&Value| !is_met(package["license"].as_str().unwrap_or("none"), &allowed);
    let others: Vec<String> =
        packages.iter().filter(named).map(|p| format!("{} {}", p["name"], p["license"])).collect();
    assert_eq!(others, [""; 0]);
}

#[test]
fn licences_that_are_not_on_the_list_are_refused() {
    let allowed = allowed();
    for met in [
        "MIT",
        "Apache-2.0/MIT",
        "Unlicense OR MIT",
        "(MIT OR Apache-2.0) AND Unicode-3.0",
        "Apache-2.0 WITH LLVM-exception OR GPL-3.0",
        "MIT AND (GPL-2.0 OR Zlib)",
    ] {
        assert!(is_met(met, &allowed), "{met}");
    }
    for unmet in
        ["LGPL-3.0", "", "none", "MIT AND LGPL-3.0-or-later", "(MIT OR Apache-2.0) AND GPL-2.0", "AGPL-3.0 OR MPL-2.0"]
    {
        assert!(!is_met(unmet, &allowed), "{unmet}");
    }
}

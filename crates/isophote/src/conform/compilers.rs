//! What several compilers make of one program: each by each adapter, added up.

use comfy_table::{CellAlignment, Table, presets::UTF8_FULL_CONDENSED};
use std::collections::BTreeSet;
use suite::report::{Report, State, Subject};
use suite::text::escaped;

/// A line for each compiler and adapter, where there are several; at most 80 characters wide.
pub fn table(report: &Report) -> Option<Table> {
    let subjects: Vec<&Subject> = report.subjects.iter().filter(|subject| subject.kind != "cpu").collect();
    let compilers: BTreeSet<&str> = subjects.iter().map(|subject| subject.compiler.as_str()).collect();
    if compilers.len() < 2 {
        return None;
    }
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["compiler", "adapter", "cases", "agree", "differ", "budget", "unlike"]);
    for subject in subjects {
        let outcomes: Vec<_> = report.outcomes(&subject.id).map(|(_, outcome)| outcome).collect();
        let agree = outcomes.iter().filter(|outcome| outcome.state() == State::Agree).count();
        let pairs = || outcomes.iter().flat_map(|outcome| &outcome.pairs);
        let shares = pairs().flat_map(|pair| [pair.position.max, pair.normal.max, pair.curvature.max]);
        let budget = shares.fold(0.0, f64::max);
        let unlike: Vec<usize> = outcomes.iter().filter_map(|outcome| outcome.unlike).collect();
        table.add_row([
            if subject.compiler.is_empty() { "—".to_owned() } else { escaped(&subject.compiler).into_owned() },
            escaped(&subject.name.chars().take(NAME).collect::<String>()).into_owned(),
            outcomes.len().to_string(),
            agree.to_string(),
            pairs().map(|pair| pair.differing).sum::<usize>().to_string(),
            format!("{:.1} %", 100.0 * budget),
            if unlike.is_empty() { "—".to_owned() } else { unlike.iter().sum::<usize>().to_string() },
        ]);
    }
    for column in 2..7 {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    Some(table)
}

/// Characters of an adapter's name.
const NAME: usize = 22;

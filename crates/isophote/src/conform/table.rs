//! A report on the terminal: a table for each subject, the worst scenes first.

use super::compilers;
use crate::terminal;
use comfy_table::{Attribute, Cell, CellAlignment, Color, Table};
use std::collections::BTreeMap;
use std::fmt::Write;
use suite::bits::Bits;
use suite::report::{Outcome, Report, State, Subject};
use suite::text::escaped;

/// Missing cases that are named.
const NAMED: usize = 3;

/// What the table's columns are, for those who see it for the first time.
const HEADINGS: &str = concat!(
    "  open: pixels without a verdict; caught: of pictures made wrong; budget: the greatest\n",
    "  share of what position, normal and curvatures are allowed; verdict: of so many cases",
);

/// A scene's outcomes for one subject, added up.
#[derive(Default)]
struct Row<'a> {
    scene: &'a str,
    cases: usize,
    agree: usize,
    not_run: usize,
    covered: usize,
    differing: usize,
    unbounded: usize,
    undecided: usize,
    /// Pictures made wrong: those that differ, and all.
    wrong: [usize; 2],
    /// The greatest of position, normal and curvatures.
    share: f64,
}

impl Row<'_> {
    fn add(&mut self, outcome: &Outcome, undecided: usize) {
        self.cases += 1;
        self.agree += usize::from(outcome.state() == State::Agree);
        self.not_run += usize::from(outcome.state() == State::NotRun);
        self.undecided += undecided;
        if let Some(wrong) = &outcome.wrong {
            self.wrong[0] += wrong.caught;
            self.wrong[1] += wrong.made;
        }
        for pair in &outcome.pairs {
            self.covered += pair.covered;
            self.differing += pair.differing;
            self.unbounded += pair.unbounded;
            let budgets = [&pair.position, &pair.normal, &pair.curvature];
            self.share = budgets.iter().map(|budget| budget.max).fold(self.share, f64::max);
        }
    }
}

/// The whole report in words, with colours where standard output is a terminal; names in it are escaped.
pub fn text(report: &Report) -> String {
    let mut out = String::new();
    for subject in &report.subjects {
        let _ = writeln!(out, "{}", heading(subject));
        let rows = rows(report, subject);
        if !rows.is_empty() {
            let _ = writeln!(out, "{}\n{HEADINGS}", table(&rows));
        }
        if let Some(line) = same_bits(report, subject) {
            let _ = writeln!(out, "  {line}");
        }
        for (key, reason) in differences(report, subject) {
            let _ = writeln!(out, "  {}: {}", escaped(&key), escaped(&reason));
        }
        for (reason, count) in without_verdict(report, subject) {
            let _ = writeln!(out, "  {count} pixels without a verdict: {}", escaped(reason));
        }
        let missing = report.missing(&subject.id);
        if let Some(why) = &subject.failure {
            let _ = writeln!(out, "  NOT RUN: {}", escaped(why));
        }
        if !missing.is_empty() {
            let names: Vec<String> = missing.iter().take(NAMED).map(|key| key.to_string()).collect();
            let more = if missing.len() > NAMED { " …" } else { "" };
            let _ = writeln!(out, "  {} cases are missing: {}{more}", missing.len(), names.join(", "));
        }
    }
    for case in report.cases.iter().filter(|case| case.error.is_some()) {
        let error = case.error.as_deref().unwrap_or_default();
        let _ = writeln!(out, "{}: {}", escaped(&case.key.to_string()), escaped(error));
    }
    if let Some(table) = compilers::table(report) {
        let _ = writeln!(out, "by compiler; unlike: pixels whose bits are not those of the first\n{table}");
    }
    for note in &report.notes {
        let _ = writeln!(out, "note: {}", escaped(note));
    }
    let _ = write!(out, "{}", verdict(report));
    out
}

fn heading(subject: &Subject) -> String {
    let facts = [&subject.driver, &subject.backend, &subject.compiler, &subject.host];
    let facts: Vec<&str> = facts.into_iter().map(String::as_str).filter(|fact| !fact.is_empty()).collect();
    format!("{} ({})", escaped(&subject.name), escaped(&facts.join(", ")))
}

/// One row a scene: those that differ first, then by the largest share of a budget.
fn rows<'a>(report: &'a Report, subject: &'a Subject) -> Vec<Row<'a>> {
    let mut rows: Vec<Row> = vec![];
    for (case, outcome) in report.outcomes(&subject.id) {
        let place = rows.iter().position(|row| row.scene == case.key.scene).unwrap_or_else(|| {
            rows.push(Row { scene: &case.key.scene, ..Row::default() });
            rows.len() - 1
        });
        rows[place].add(outcome, case.undecided);
    }
    rows.sort_by(|a, b| {
        let failed = |row: &Row| row.cases - row.agree;
        failed(b).cmp(&failed(a)).then(b.share.total_cmp(&a.share))
    });
    rows
}

fn table(rows: &[Row]) -> Table {
    let mut table = terminal::narrow_table();
    table.set_header(["scene", "pixels", "differ", "open", "caught", "budget", "verdict"]);
    // A long name is cut between its words.
    if let Some(scenes) = table.column_mut(0) {
        scenes.set_delimiter('-');
    }
    let mut total = Row { scene: "all", ..Row::default() };
    for row in rows {
        table.add_row(cells(row));
        total.cases += row.cases;
        total.agree += row.agree;
        total.not_run += row.not_run;
        total.covered += row.covered;
        total.differing += row.differing;
        total.undecided += row.undecided;
        total.unbounded += row.unbounded;
        total.wrong = [0, 1].map(|k| total.wrong[k] + row.wrong[k]);
        total.share = total.share.max(row.share);
    }
    table.add_row(cells(&total));
    for column in 1..6 {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

fn cells(row: &Row) -> Vec<Cell> {
    let (word, colour) = match (row.not_run, row.agree == row.cases) {
        (0, true) => ("agree", Color::Green),
        (0, false) => ("DIFFER", Color::Red),
        _ => ("NOT RUN", Color::Yellow),
    };
    let [caught, made] = row.wrong;
    let caught = if made == 0 { "—".to_owned() } else { format!("{caught}/{made}") };
    vec![
        Cell::new(escaped(row.scene)),
        Cell::new(row.covered),
        Cell::new(row.differing),
        Cell::new(row.undecided + row.unbounded),
        Cell::new(caught),
        Cell::new(format!("{:.1} %", 100.0 * row.share)),
        Cell::new(format!("{word} {}/{}", row.agree, row.cases)).fg(colour).add_attribute(Attribute::Bold),
    ]
}

/// How many pictures have the CPU rasterizer's bits, where that was asked.
fn same_bits(report: &Report, subject: &Subject) -> Option<String> {
    let bits: Vec<&Bits> = report.outcomes(&subject.id).filter_map(|(_, outcome)| outcome.bits.as_ref()).collect();
    let same = bits.iter().filter(|bits| bits.unlike == 0).count();
    let unlike: usize = bits.iter().map(|bits| bits.unlike).sum();
    (!bits.is_empty()).then(|| {
        format!(
            "to the bit: {same} of {} pictures are the CPU rasterizer's; {unlike} pixels have other bits",
            bits.len()
        )
    })
}

/// Each case that does not agree, and why.
fn differences(report: &Report, subject: &Subject) -> Vec<(String, String)> {
    let mut found = vec![];
    for (case, outcome) in report.outcomes(&subject.id) {
        if let Some(error) = &outcome.error {
            found.push((case.key.to_string(), error.clone()));
        }
        if let Some(first) = outcome.bits.as_ref().and_then(|bits| bits.first.as_ref()) {
            found.push((case.key.to_string(), format!("other bits than the CPU rasterizer's: {first}")));
        }
        for missed in outcome.wrong.iter().flat_map(|wrong| &wrong.missed) {
            found.push((case.key.to_string(), format!("made wrong, and does not differ: {missed}")));
        }
        for pair in outcome.pairs.iter().filter(|pair| !pair.agree) {
            let pixel = pair.worst.first();
            let at = pixel.map_or(String::new(), |p| format!("; worst at ({}, {}): {}", p.x, p.y, p.detail));
            let what = format!("{} | {}: {}{at}", pair.reference, pair.candidate, pair.reasons.join(", "));
            found.push((case.key.to_string(), what));
        }
    }
    found
}

/// Pixels without a verdict of all cases, by reason.
fn without_verdict<'a>(report: &'a Report, subject: &'a Subject) -> BTreeMap<&'a str, usize> {
    let mut found = BTreeMap::new();
    let pairs = report.outcomes(&subject.id).flat_map(|(_, outcome)| &outcome.pairs);
    for (reason, count) in pairs.flat_map(|pair| &pair.unbounded_causes) {
        *found.entry(reason.as_str()).or_default() += count;
    }
    found
}

fn verdict(report: &Report) -> String {
    let (suite, shard) = (report.suite.name(), report.shard);
    let what = match report.state() {
        State::Agree => "all agree",
        State::Differ => "SOMETHING DIFFERS",
        State::NotRun => "PARTIAL: something could not run or is missing",
    };
    format!("suite {suite}, shard {shard}: {what}")
}

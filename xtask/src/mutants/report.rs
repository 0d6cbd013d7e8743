//! What became of the mutants, for people and for machines.

use super::mutant::{Key, Mutant, tried_by};
use super::record::{Group, Kind};
use super::way::Way;
use super::worker::Outcome;
use anyhow::Result;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use isophote::format::Format;
use isophote::{say, terminal};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::Duration;

/// A mutant and what became of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Tried {
    /// The change.
    #[serde(flatten)]
    pub mutant: Mutant,
    /// What became of it.
    pub outcome: Outcome,
}

/// A run.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Mutants generated that compile.
    pub generated: usize,
    /// Mutants that do not compile; they do not count.
    pub stillborn: usize,
    /// Mutants tried.
    pub tried: usize,
    /// Mutants for which no time was left.
    pub untried: usize,
    /// Of these, caught.
    pub caught: usize,
    /// Survivors that are on the reviewed list, by kind of reason.
    pub reviewed: BTreeMap<Kind, usize>,
    /// Survivors that are not.
    pub survivors: Vec<Mutant>,
    /// Mutants on the reviewed list that were caught: their reason is wrong.
    pub refuted: Vec<Key>,
    /// Entries of the reviewed list that no mutant matches: the source has changed.
    pub unknown: Vec<Key>,
    /// Caught mutants by scene.
    pub by_scene: BTreeMap<String, usize>,
    /// Caught mutants by the cause that was named.
    pub by_cause: BTreeMap<String, usize>,
    /// Tried and caught mutants by operator.
    pub by_operator: BTreeMap<String, [usize; 2]>,
    /// Tried and caught mutants by file.
    pub by_file: BTreeMap<String, [usize; 2]>,
    /// Seconds that the trials took.
    pub seconds: f64,
    /// Each mutant and what became of it.
    pub mutants: Vec<Tried>,
}

/// Entries of the list that match no mutant, those apart of parts that are tried another way or whose files are not wanted.
pub fn unknown(reviewed: &[Group], mutants: &[Mutant], way: Way, is_wanted: &dyn Fn(&str) -> bool) -> Vec<Key> {
    let is_of_another = |key: &Key| key.part().is_some_and(|part| tried_by(part) != way);
    let keys = reviewed.iter().flat_map(|group| &group.mutants);
    let keys = keys.filter(|key| is_wanted(&key.file) && !is_of_another(key));
    keys.filter(|key| !mutants.iter().any(|m| m.key == **key)).cloned().collect()
}

impl Report {
    /// Adds up a run; the counts are of the mutants that compile, of those that do not, and of those that were not tried.
    pub fn new(
        [generated, stillborn, untried]: [usize; 3],
        mut tried: Vec<Tried>,
        reviewed: &[Group],
        unknown: Vec<Key>,
        time: Duration,
    ) -> Self {
        tried.sort_by(|a, b| (&a.mutant.key.file, a.mutant.start).cmp(&(&b.mutant.key.file, b.mutant.start)));
        let mut report = Self {
            generated,
            stillborn,
            tried: tried.len(),
            untried,
            caught: 0,
            reviewed: BTreeMap::new(),
            survivors: vec![],
            refuted: vec![],
            unknown,
            by_scene: BTreeMap::new(),
            by_cause: BTreeMap::new(),
            by_operator: BTreeMap::new(),
            by_file: BTreeMap::new(),
            seconds: time.as_secs_f64(),
            mutants: vec![],
        };
        for Tried { mutant, outcome } in &tried {
            let group = reviewed.iter().find(|group| group.mutants.contains(&mutant.key));
            let caught = matches!(outcome, Outcome::Caught(_));
            let counts = [
                report.by_operator.entry(mutant.key.operator.clone()).or_default(),
                report.by_file.entry(mutant.key.file.clone()).or_default(),
            ];
            for [all, of_them] in counts {
                *all += 1;
                *of_them += usize::from(caught);
            }
            match (outcome, group) {
                (Outcome::Caught(catch), group) => {
                    report.caught += 1;
                    *report.by_scene.entry(catch.scene.clone()).or_default() += 1;
                    *report.by_cause.entry(catch.cause.clone()).or_default() += 1;
                    report.refuted.extend(group.map(|_| mutant.key.clone()));
                }
                (Outcome::Survived(_), Some(group)) => *report.reviewed.entry(group.kind).or_default() += 1,
                (Outcome::Survived(_), None) => report.survivors.push(mutant.clone()),
            }
        }
        report.mutants = tried;
        report
    }

    /// Whether every mutant that can be caught was, and the reviewed list holds.
    pub fn is_proof(&self) -> bool {
        self.tried > 0
            && self.untried == 0
            && self.survivors.is_empty()
            && self.refuted.is_empty()
            && self.unknown.is_empty()
    }

    /// The report for people.
    ///
    /// # Errors
    /// Where standard output takes no more.
    pub fn print(&self) -> Result<()> {
        say!(
            "{} mutants compile ({} do not); {} tried in {:.0} s, {} not: {} caught, {} equivalent, {} permitted, {} survive",
            self.generated,
            self.stillborn,
            self.tried,
            self.seconds,
            self.untried,
            self.caught,
            self.reviewed.get(&Kind::Equivalent).unwrap_or(&0),
            self.reviewed.get(&Kind::Permitted).unwrap_or(&0),
            self.survivors.len()
        )?;
        shares("operator", &self.by_operator)?;
        shares("file", &self.by_file)?;
        counts("caught on scene", &self.by_scene)?;
        counts("caught as", &self.by_cause)?;
        for mutant in &self.survivors {
            say!("SURVIVES {}", words(mutant))?;
        }
        for key in &self.refuted {
            say!(
                "CAUGHT, though reviewed as one that cannot be: {}: {:?} -> {:?}",
                key.line,
                key.original,
                key.replacement
            )?;
        }
        for key in &self.unknown {
            say!("STALE on the reviewed list: {} {}: {:?}", key.file, key.function, key.line)?;
        }
        Ok(())
    }
}

fn shares(heading: &str, rows: &BTreeMap<String, [usize; 2]>) -> Result<()> {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([heading, "tried", "caught"]);
    for (name, [tried, caught]) in rows {
        table.add_row([name.clone(), tried.to_string(), caught.to_string()]);
    }
    terminal::table(&table)
}

fn counts(heading: &str, rows: &BTreeMap<String, usize>) -> Result<()> {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([heading, "mutants"]);
    for (name, count) in rows {
        table.add_row([name.clone(), count.to_string()]);
    }
    terminal::table(&table)
}

/// File, place and change, in one line.
fn words(mutant: &Mutant) -> String {
    let Mutant { key, line, column, .. } = mutant;
    format!(
        "{}:{line}:{column} {}: {:?} -> {:?}\n    {}",
        key.file, key.operator, key.original, key.replacement, key.line
    )
}

/// Prints mutants that were not tried.
///
/// # Errors
/// Where standard output takes no more.
pub fn list(mutants: &[Mutant], format: Format) -> Result<()> {
    match format {
        Format::Json => terminal::json(&mutants),
        Format::Table => mutants.iter().try_for_each(|mutant| say!("{}", words(mutant))),
    }
}

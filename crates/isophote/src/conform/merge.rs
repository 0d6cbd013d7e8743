//! `conform merge`: shards and adapters of several machines, joined into one report.

use super::answer::{OutputArgs, claim, finish};
use super::check::check;
use super::own::OwnArgs;
use anyhow::{Context, Result, bail};
use clap::Args;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use suite::corpus::Corpus;
use suite::report::{Case, Outcome, Report, Subject};
use suite::shard::Shard;

/// Missing shards that are named.
const NAMED: usize = 8;

/// Join the reports of shards and of several machines into one
///
/// Exit code 0: all agree; 1: something differs; 2: a report is damaged or of another program, suite or corpus, one
/// shard is there twice, or a shard or a case is missing: then the joined report says which.
#[derive(Debug, Args)]
pub struct MergeArgs {
    /// Folders with a report.json, or such files
    #[arg(required = true, value_name = "DIR_OR_REPORT")]
    reports: Vec<PathBuf>,
    #[command(flatten)]
    models: OwnArgs,
    #[command(flatten)]
    output: OutputArgs,
}

/// Runs the command.
///
/// # Errors
/// Where a report cannot be read or does not belong with the others: the file is named.
pub fn run(args: &MergeArgs) -> Result<ExitCode> {
    let mut read = vec![];
    for path in &args.reports {
        let path = if path.is_dir() { path.join("report.json") } else { path.clone() };
        read.push((Report::read(&path)?, path));
    }
    let (suite, path) = read.first().map(|(report, _)| (report.suite, report.path)).context("nothing to merge")?;
    let merged = merged(&read, &Corpus::new(suite, &args.models.scenes(suite), path))?;
    let _lock = claim(&args.output.out, suite, Shard::WHOLE)?;
    finish(&merged, &args.output)
}

/// One report of several, at least one, of which nothing is believed that `corpus` or its own counts contradict.
///
/// Subjects are joined by their identity. The CPU rasterizer is the same everywhere, and so must be what it gave;
/// an adapter's shard may be there only once.
///
/// # Errors
/// Where a report does not pass [`check`], a shard of an adapter is there twice, or the CPU rasterizer gave two
/// answers: the files and what they differ in are named.
pub fn merged(reports: &[(Report, PathBuf)], corpus: &Corpus) -> Result<Report> {
    let [(first, _), ..] = reports else { bail!("nothing to merge") };
    let mut whole = Report {
        shard: Shard::WHOLE,
        sources: vec![],
        subjects: vec![],
        cases: vec![],
        notes: vec![],
        ..first.clone()
    };
    let mut from: BTreeMap<(String, String), &Path> = BTreeMap::new();
    for (report, path) in reports {
        check(report, corpus).with_context(|| path.display().to_string())?;
        whole.sources.extend(report.sources.iter().cloned());
        for note in &report.notes {
            whole.notes.push(format!("{}: {note}", path.display()));
        }
        for subject in &report.subjects {
            let key = (format!("shard {}", report.shard), subject.id.clone());
            if let (false, Some(other)) = (subject.kind == "cpu", from.insert(key, path)) {
                let (shard, name) = (report.shard, &subject.name);
                bail!("shard {shard} of {name} is there twice: {} and {}", other.display(), path.display());
            }
            join_subject(&mut whole.subjects, subject);
        }
        for case in &report.cases {
            for outcome in &case.outcomes {
                let key = (case.key.to_string(), outcome.subject.clone());
                if let Some(other) = from.insert(key, path) {
                    same_answer(&whole, case, outcome, [other, path])?;
                }
            }
            join_case(&mut whole.cases, case);
        }
    }
    let place: BTreeMap<_, usize> = whole.planned.iter().enumerate().map(|(place, key)| (key, place)).collect();
    whole.cases.sort_by_key(|case| place[&case.key]);
    let missing = missing_shards(&whole);
    whole.notes.extend(missing);
    Ok(whole)
}

fn join_subject(subjects: &mut Vec<Subject>, subject: &Subject) {
    match subjects.iter_mut().find(|known| known.id == subject.id) {
        Some(known) => known.failure = known.failure.take().or_else(|| subject.failure.clone()),
        None => subjects.push(subject.clone()),
    }
}

fn join_case(cases: &mut Vec<Case>, case: &Case) {
    let Some(known) = cases.iter_mut().find(|known| known.key == case.key) else {
        cases.push(case.clone());
        return;
    };
    for outcome in &case.outcomes {
        if known.outcomes.iter().all(|other| other.subject != outcome.subject) {
            known.outcomes.push(outcome.clone());
        }
    }
    known.picture = known.picture.take().or_else(|| case.picture.clone());
    known.error = known.error.take().or_else(|| case.error.clone());
}

/// Nothing where an outcome that is there twice is the CPU rasterizer's, with the same answer.
fn same_answer(whole: &Report, case: &Case, outcome: &Outcome, [first, second]: [&Path; 2]) -> Result<()> {
    let subject = whole.subjects.iter().find(|s| s.id == outcome.subject).expect("a report's outcomes are checked");
    let (a, b) = (first.display(), second.display());
    if subject.kind != "cpu" {
        bail!("{} is there twice for {}: in {a} and in {b}", case.key, subject.name);
    }
    let known = whole.case(&case.key).and_then(|known| known.outcomes.iter().find(|o| o.subject == outcome.subject));
    match known {
        Some(known) if known.pairs != outcome.pairs => {
            bail!("the CPU rasterizer gave two answers to {}: in {a} and in {b}", case.key)
        }
        _ => Ok(()),
    }
}

/// Words for each shard of a subject that no report brought.
fn missing_shards(whole: &Report) -> Vec<String> {
    let mut notes = vec![];
    for subject in whole.subjects.iter().filter(|subject| subject.kind != "cpu") {
        let of = whole.sources.iter().filter(|source| source.subjects.contains(&subject.id));
        let shards: BTreeSet<Shard> = of.map(|source| source.shard).collect();
        for count in shards.iter().map(|shard| shard.count).collect::<BTreeSet<_>>() {
            let missing = (1..=count).map(|index| Shard { index, count }).filter(|shard| !shards.contains(shard));
            let missing: Vec<String> = missing.map(|shard| shard.to_string()).collect();
            if !missing.is_empty() && !whole.missing(&subject.id).is_empty() {
                let more = if missing.len() > NAMED {
                    format!(" (and {} more)", missing.len() - NAMED)
                } else {
                    String::new()
                };
                let named = missing[..missing.len().min(NAMED)].join(", ");
                notes.push(format!("{}: shard {named} is missing{more}", subject.name));
            }
        }
    }
    notes
}

//! What a report from a file must be before it is believed: of this program's own corpus, complete in itself, with
//! verdicts that follow from its counts.

use anyhow::{Context, Result, bail, ensure};
use compare::{Cause, Counts, Verdict};
use std::collections::{BTreeMap, BTreeSet};
use suite::bits::Bits;
use suite::corpus::{CaseKey, Corpus, PlannedCase};
use suite::report::{Case, Outcome, Pair, Report, Subject};
use suite::run::CPU;
use suite::stage::Path as DrawnBy;
use suite::wrong::Vacuity;

/// How a picture begins: nothing else may stand in the page.
const PICTURE: &str = "data:image/png;base64,";

/// Nothing where a report holds what a run of `corpus` by this program could have found, complete or not.
///
/// # Errors
/// What contradicts what, in words, with the case.
pub fn check(report: &Report, corpus: &Corpus) -> Result<()> {
    let own = env!("CARGO_PKG_VERSION");
    ensure!(report.program == own, "it is of program version {}, this is {own}", report.program);
    let suite = corpus.suite.name();
    ensure!(report.suite == corpus.suite, "it is of suite {}, not {suite}", report.suite.name());
    let planned: Vec<&CaseKey> = corpus.cases.iter().map(|case| &case.key).collect();
    if let Some(lost) = planned.iter().find(|key| !report.planned.contains(key)) {
        bail!("it is of another corpus: suite {suite} has {lost}, which is not planned");
    }
    ensure!(
        report.scenes == corpus.scenes && report.planned.iter().eq(planned),
        "it is of another corpus: its scenes or cases are not those of suite {suite}"
    );
    ensure!(report.corpus == corpus.hash, "it is of another corpus: hash {:?}, not {}", report.corpus, corpus.hash);
    check_subjects(report)?;
    let planned: BTreeMap<&CaseKey, &PlannedCase> = corpus.cases.iter().map(|case| (&case.key, case)).collect();
    let shares: BTreeMap<&str, f64> =
        report.scenes.iter().map(|scene| (scene.name.as_str(), scene.unbounded_share)).collect();
    let mut seen = BTreeSet::new();
    for case in &report.cases {
        let Some(planned) = planned.get(&case.key).filter(|_| seen.insert(&case.key)) else {
            bail!("case {} is not planned, or there twice", case.key);
        };
        check_case(report, case, planned, shares[case.key.scene.as_str()])
            .with_context(|| format!("case {}", case.key))?;
    }
    Ok(())
}

fn check_subjects(report: &Report) -> Result<()> {
    let mut ids = BTreeSet::new();
    for subject in &report.subjects {
        ensure!(ids.insert(&subject.id), "subject {:?} is there twice", subject.id);
        let is_cpu = subject.id.starts_with(CPU);
        ensure!(is_cpu == (subject.kind == "cpu"), "subject {:?} is of kind {:?}", subject.id, subject.kind);
    }
    ensure!(!report.sources.is_empty(), "it comes from no run");
    for source in &report.sources {
        if let Some(stranger) = source.subjects.iter().find(|id| !ids.contains(id)) {
            bail!("a run judged {stranger:?}, which is not a subject");
        }
    }
    Ok(())
}

fn check_case(report: &Report, case: &Case, planned: &PlannedCase, unbounded_share: f64) -> Result<()> {
    ensure!(case.size == [planned.side; 2], "its size is {:?}, not {}", case.size, planned.side);
    ensure!(case.options == planned.options, "its options are not those of the corpus: {}", case.options);
    check_picture(&case.picture)?;
    let pixels = planned.side * planned.side;
    ensure!(case.undecided <= pixels, "{} pixels are undecided, of {pixels}", case.undecided);
    ensure!(case.error.is_none() || case.outcomes.is_empty(), "nobody could draw it, and yet it has outcomes");
    let mut once = BTreeSet::new();
    for outcome in &case.outcomes {
        let subject = report.subjects.iter().find(|subject| subject.id == outcome.subject);
        let Some(subject) = subject.filter(|_| once.insert(&outcome.subject)) else {
            bail!("{} is not a subject, or there twice", outcome.subject);
        };
        check_outcome(outcome, subject, pixels, &case.key.technique, unbounded_share)?;
        let asks = report.path == DrawnBy::Strict && subject.kind != "cpu" && outcome.error.is_none();
        ensure!(asks == outcome.bits.is_some(), "{}: its bits are told, or not, against its path", subject.name);
    }
    Ok(())
}

fn check_outcome(
    outcome: &Outcome,
    subject: &Subject,
    pixels: usize,
    technique: &str,
    unbounded_share: f64,
) -> Result<()> {
    check_picture(&outcome.picture)?;
    outcome.wrong.as_ref().map_or(Ok(()), check_wrong)?;
    check_bits(outcome, pixels)?;
    let unlike = outcome.unlike.unwrap_or(0);
    ensure!(unlike <= pixels, "{unlike} pixels are unlike another's, of {pixels}");
    let expected: &[[&str; 2]] = match subject.kind.as_str() {
        "cpu" => &[["raycast", "raster"]],
        _ => &[["raycast", "gpu"], ["raster", "gpu"]],
    };
    let pairs: Vec<[&str; 2]> =
        outcome.pairs.iter().map(|pair| [pair.reference.as_str(), pair.candidate.as_str()]).collect();
    // Where it could not be judged it may have none.
    ensure!(
        pairs == expected || (pairs.is_empty() && outcome.error.is_some()),
        "{} was compared as {pairs:?}, not as {expected:?}",
        subject.name
    );
    for pair in &outcome.pairs {
        check_pair(pair, pixels, technique, unbounded_share)
            .with_context(|| format!("{} | {}", pair.reference, pair.candidate))?;
    }
    Ok(())
}

/// The bits that --path strict asks for are counted, and of no more pixels than there are.
fn check_bits(outcome: &Outcome, pixels: usize) -> Result<()> {
    if let Some(Bits { unlike, first }) = &outcome.bits {
        ensure!(*unlike <= pixels, "{unlike} pixels have other bits, of {pixels}");
        ensure!((*unlike > 0) == first.is_some(), "{unlike} pixels have other bits, and the first is {first:?}");
    }
    Ok(())
}

/// The counts of a pair do not contradict each other, and allow its verdict.
fn check_pair(pair: &Pair, pixels: usize, technique: &str, unbounded_share: f64) -> Result<()> {
    check_picture(&pair.difference)?;
    let [full, partial, none] = pair.coverage;
    let sum = |counts: &mut dyn Iterator<Item = usize>| counts.fold(0, usize::saturating_add);
    ensure!(sum(&mut [full, partial, none].into_iter()) == pixels, "coverage {:?} is not of {pixels}", pair.coverage);
    ensure!(full + partial == pair.covered, "{} pixels are covered, by coverage {}", pair.covered, full + partial);
    for (what, count, most) in [
        ("unbounded", pair.unbounded, pair.covered),
        ("ambiguous", pair.ambiguous, pair.covered),
        ("unconverged", pair.unconverged, pixels),
    ] {
        ensure!(count <= most, "{count} pixels are {what}, of {most}");
    }
    let of = |cause: Cause| pair.causes.get(cause.label()).copied().unwrap_or(0);
    let undecided = of(Cause::Undecided);
    let unanswered = pair.unanswered;
    ensure!(unanswered <= of(Cause::NewtonNotConverged), "{unanswered} pixels have no answer, by causes fewer");
    let counted = sum(&mut pair.causes.values().copied());
    ensure!(counted <= pixels, "{counted} pixels differ or are undecided, of {pixels}");
    let differing = counted - undecided - unanswered;
    ensure!(differing == pair.differing, "{} pixels differ, by causes {differing}", pair.differing);
    ensure!(pair.worst.len() <= counted, "{} pixels are listed, of {counted}", pair.worst.len());
    let reasons = sum(&mut pair.unbounded_causes.values().copied());
    ensure!(reasons == pair.unbounded, "{} pixels have no bound, by reasons {reasons}", pair.unbounded);
    let counts = Counts { covered: pair.covered, differing, undecided, unanswered, unbounded: pair.unbounded };
    // Only a search for roots may be without an answer here and there.
    let unanswered_share = techniques::named(technique).map_or(0.0, |known| known.claims().unanswered_share());
    let (verdict, why) = counts.verdict(unanswered_share, unbounded_share);
    if pair.agree {
        let why = why.unwrap_or_else(|| format!("{differing} pixels differ"));
        ensure!(verdict == Verdict::Agree, "it says that all agree, and {why}");
        ensure!(pair.reasons.is_empty(), "it says that all agree, and why not: {}", pair.reasons.join(", "));
        if let [Some(off), Some(bound)] = pair.across_px {
            ensure!(off <= bound, "it says that all agree, and a point is {off} px off, of {bound}");
        }
    } else {
        ensure!(verdict != Verdict::Agree, "it does not agree, and its counts do");
        ensure!(!pair.reasons.is_empty(), "it does not agree, for no reason");
    }
    Ok(())
}

/// A wrong picture is caught or named, and of those named none is hidden.
fn check_wrong(wrong: &Vacuity) -> Result<()> {
    let (made, told) = (wrong.made, wrong.caught.saturating_add(wrong.missed.len()));
    ensure!(made == told, "{made} pictures were made wrong, and {told} are told of");
    Ok(())
}

fn check_picture(picture: &Option<String>) -> Result<()> {
    ensure!(picture.as_ref().is_none_or(|picture| picture.starts_with(PICTURE)), "a picture is no PNG of its own");
    Ok(())
}

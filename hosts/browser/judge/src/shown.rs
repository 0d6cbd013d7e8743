//! What the page shows of a report: a row a case, and one plain line.

use serde::Serialize;
use suite::report::{Case, Outcome, Report, State, Subject};

/// A case, as the page lists it.
#[derive(Debug, Serialize)]
pub struct Row {
    scene: String,
    viewpoint: String,
    technique: String,
    scheme: String,
    /// As [`word`] says it.
    verdict: &'static str,
    /// Pixels that the GPU or the rays cover.
    covered: usize,
    /// Pixels that differ, of the pair with the most.
    differing: usize,
    /// The largest share of an allowance that was used.
    share: f64,
    /// Why it does not agree.
    why: Vec<String>,
    /// `data:` URIs, where pictures are kept: what the GPU drew, and how far that is from the rays.
    picture: Option<String>,
    difference: Option<String>,
}

/// A state in the page's words.
pub fn word(state: State) -> &'static str {
    match state {
        State::Agree => "agree",
        State::Differ => "differ",
        State::NotRun => "partial",
    }
}

/// The cases of a report from the one numbered `first` on, as its subject drew them.
pub fn rows(report: &Report, first: usize, subject: &Subject) -> Vec<Row> {
    report.cases[first..].iter().map(|case| row(case, subject)).collect()
}

fn row(case: &Case, subject: &Subject) -> Row {
    let outcome = case.outcomes.iter().find(|outcome| outcome.subject == subject.id);
    let pairs = outcome.map_or(&[][..], |outcome| &outcome.pairs);
    let error = match outcome {
        Some(outcome) => outcome.error.clone(),
        None => case.error.clone().or(subject.failure.clone()),
    };
    let mut why: Vec<String> = error.into_iter().chain(pairs.iter().flat_map(|pair| pair.reasons.clone())).collect();
    why.dedup();
    let key = case.key.clone();
    Row {
        scene: key.scene,
        viewpoint: key.viewpoint,
        technique: key.technique,
        scheme: key.scheme,
        verdict: word(outcome.map_or(State::NotRun, Outcome::state)),
        covered: pairs.iter().map(|pair| pair.covered).max().unwrap_or(0),
        differing: pairs.iter().map(|pair| pair.differing).max().unwrap_or(0),
        share: pairs.iter().map(|pair| pair.share()).fold(0.0, f64::max),
        why,
        picture: outcome.and_then(|outcome| outcome.picture.clone()),
        difference: pairs.first().and_then(|pair| pair.difference.clone()),
    }
}

/// Who agrees in how much, or what differs, or what is missing.
pub fn line(report: &Report, subject: &Subject) -> String {
    let name = &subject.name;
    if let Some(why) = &subject.failure {
        return format!("Nothing was judged: {why}.");
    }
    let rows = rows(report, 0, subject);
    let of = |verdict| rows.iter().filter(move |row| row.verdict == verdict);
    let (all, differing) = (report.expected().len(), of("differ").count());
    if let Some(first) = of("differ").max_by_key(|row| row.differing) {
        let Row { scene, viewpoint, technique, .. } = first;
        let why = first.why.first().map_or(String::new(), |why| format!(": {why}"));
        return format!("{differing} of {all} pictures differ, first of all {scene}/{viewpoint}/{technique}{why}.");
    }
    if let Some(first) = of("partial").next() {
        let why = first.why.first().map_or("", String::as_str);
        return format!("Not all could be judged: {}/{}/{}: {why}.", first.scene, first.viewpoint, first.technique);
    }
    let cpu = report.subjects.iter().filter(|other| other.kind == "cpu" && report.state_of(other) == State::Differ);
    if cpu.count() > 0 {
        return "The CPU rasterizer of this page differs from its own rays: its judge cannot be relied on.".to_owned();
    }
    if rows.len() < all {
        return format!("{} of {all} pictures agree so far.", rows.len());
    }
    let pixels: usize = rows.iter().map(|row| row.covered).sum();
    let share = rows.iter().map(|row| row.share).fold(0.0, f64::max);
    format!(
        "{name} agrees with the CPU rasterizer and the rays in all {all} pictures, {pixels} pixels; \
         at most {:.1} % of an allowance is used.",
        100.0 * share
    )
}

//! The answer in one plain line: the last that is printed.

use crate::text::grouped;
use compare::{Diagnosis, PairReport, Verdict};
use std::collections::BTreeSet;

/// A comparison in a sentence: who agrees on how many pixels and how far off the worst is, or how many differ and why.
///
/// `diagnoses` belong to the pairs, in their order, and may be fewer. `gpu_not_run` is why the GPU was not compared, `shaded`
/// how many pixels of its own picture differ.
pub(super) fn line(
    pairs: &[PairReport],
    diagnoses: &[Option<Diagnosis>],
    gpu_not_run: Option<&str>,
    shaded: usize,
) -> String {
    let told = |pair: &PairReport| format!("{} | {}", pair.reference, pair.candidate);
    let worst = pairs.iter().enumerate().filter(|(_, pair)| pair.differing() > 0);
    // Of as many the first: what differs from rays is told before what differs between two rasterizers.
    if let Some((k, pair)) = worst.max_by_key(|(k, pair)| (pair.differing(), std::cmp::Reverse(*k))) {
        let counts =
            format!("{} of {} pixels differ ({})", grouped(pair.differing()), grouped(pair.covered), told(pair));
        return match (diagnoses.get(k).and_then(Option::as_ref), pair.main_cause()) {
            (Some(diagnosis), _) => format!("{counts}: {diagnosis}."),
            (None, Some(cause)) => format!("{counts}, mostly by {}.", cause.label()),
            (None, None) => format!("{counts}."),
        };
    }
    if shaded > 0 {
        return format!(
            "{} pixels of the picture that the GPU shaded itself differ from its G-buffer.",
            grouped(shaded)
        );
    }
    if let Some(why) = gpu_not_run {
        return format!("Not all were compared: the GPU did not run: {why}. Without it: {}", agreement(pairs));
    }
    match pairs.iter().find(|pair| pair.covered > 0 && pair.verdict == Verdict::NoVerdict) {
        Some(pair) => {
            let why = pair.explanation.as_deref().unwrap_or("too many pixels have none");
            format!("No verdict: {why} ({}).", told(pair))
        }
        None => agreement(pairs),
    }
}

/// Where fewer than this share of the pixels with a normal have curvatures, too, the plain line says so: what a renderer leaves out
/// is not judged.
const MOST: f64 = 0.9;

/// Who agrees, where no pixel differs.
fn agreement(pairs: &[PairReport]) -> String {
    let covered = pairs.iter().map(|pair| pair.covered).max().unwrap_or(0);
    if covered == 0 {
        return "No verdict: no renderer shows anything, so nothing was compared.".to_owned();
    }
    let names: BTreeSet<&str> = pairs.iter().flat_map(|pair| [&*pair.reference, &*pair.candidate]).collect();
    let who = match (names.len(), pairs) {
        (3, _) => "All three renderers".to_owned(),
        (_, [pair, ..]) => format!("{} and {}", pair.reference, pair.candidate),
        (_, []) => unreachable!("something is covered"),
    };
    let open = pairs.iter().map(|pair| pair.covered - pair.agree).max().unwrap_or(0);
    let all = match open {
        0 => format!("all {} pixels", grouped(covered)),
        open => {
            format!("{} of {} pixels, and {} have no verdict", grouped(covered - open), grouped(covered), grouped(open))
        }
    };
    let farthest = pairs.iter().filter(|pair| pair.agree > 0).max_by(|a, b| a.max_px.total_cmp(&b.max_px));
    let off = farthest.map_or(String::new(), |pair| {
        format!("; worst distance {} px where {} is allowed", short(pair.max_px), short(pair.bound_px))
    });
    let given = |pair: &PairReport| (pair.shares.curvature.count(), pair.shares.normal.count());
    let fewest = pairs.iter().map(given).find(|&(curvatures, normals)| (curvatures as f64) < MOST * normals as f64);
    let left_out = fewest.map_or(String::new(), |(curvatures, _)| match curvatures {
        0 => "; no curvatures are given, so none were judged".to_owned(),
        _ => format!("; curvatures are given, and were judged, at {} of them", grouped(curvatures)),
    });
    format!("{who} agree on {all}{off}{left_out}.")
}

/// A number of four digits that keeps them where it is small.
pub(super) fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e4).contains(&size) => format!("{x:.4}"),
        size if size.is_finite() => format!("{x:.1e}"),
        _ => "without bound".to_owned(),
    }
}

//! Faults with known causes, put into the WGSL and into G-buffers: the comparison fails on each and names the cause.

mod buffers;
mod scenes;
mod sources;

use compare::{Cause, PairReport, Verdict};
use scenes::Shown;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The share of faults, and of their differing pixels, whose cause must be named right.
const SHARE: f64 = 0.95;

/// A fault on a scene, the cause that must be named, and what the comparison said.
struct Labelled {
    name: String,
    cause: Cause,
    report: PairReport,
}

impl Labelled {
    fn is_right(&self) -> bool {
        self.report.verdict == Verdict::Differ && self.report.main_cause() == Some(self.cause)
    }

    fn words(&self) -> String {
        let worst = self.report.worst.first().map(|p| format!("({}, {}) {}", p.x, p.y, p.detail));
        format!("{}: not {:?} but {:?}, {worst:?}", self.name, self.cause, self.report.causes)
    }
}

/// Rows are the labels, columns what was named, in pixels.
fn confusion(all: &[Labelled]) -> String {
    let mut rows: BTreeMap<Cause, BTreeMap<Cause, usize>> = BTreeMap::new();
    for fault in all {
        let row = rows.entry(fault.cause).or_default();
        fault.report.causes.iter().for_each(|(cause, count)| *row.entry(*cause).or_default() += count);
    }
    let mut text = String::new();
    for (label, row) in &rows {
        let total: usize = row.values().sum();
        let right = row.get(label).copied().unwrap_or(0);
        let named: Vec<String> = row.iter().map(|(cause, count)| format!("{} {count}", cause.label())).collect();
        let share = 100.0 * right as f64 / total.max(1) as f64;
        writeln!(text, "{:26} {share:5.1} % of {total:6} pixels: {}", label.label(), named.join(", ")).expect("memory");
    }
    text
}

#[test]
fn each_fault_is_caught_and_its_cause_named() {
    let mut all = sources::labelled();
    all.extend(buffers::labelled());
    let missed: Vec<&Labelled> = all.iter().filter(|fault| fault.report.verdict != Verdict::Differ).collect();
    let wrong: Vec<&Labelled> = all.iter().filter(|fault| !fault.is_right()).collect();
    let pixels = |right: bool| -> usize {
        let counts = |fault: &Labelled| -> usize {
            fault.report.causes.iter().filter(|(cause, _)| !right || **cause == fault.cause).map(|(_, n)| n).sum()
        };
        all.iter().map(counts).sum()
    };
    let (right, total) = (pixels(true), pixels(false));
    let summary = format!(
        "{} of {} faults and {right} of {total} pixels ({:.1} %) named right\n{}\n{}",
        all.len() - wrong.len(),
        all.len(),
        100.0 * right as f64 / total as f64,
        confusion(&all),
        wrong.iter().map(|fault| fault.words()).collect::<Vec<_>>().join("\n")
    );
    println!("{summary}");
    assert!(all.len() >= 40, "only {} faults", all.len());
    assert!(missed.is_empty(), "some faults are not caught\n{summary}");
    assert!((all.len() - wrong.len()) as f64 >= SHARE * all.len() as f64, "{summary}");
    assert!(right as f64 >= SHARE * total as f64, "{summary}");
}

#[test]
fn the_scenes_of_the_faults_agree_without_them() {
    for scene in scenes::ALL {
        let shown = Shown::new(*scene);
        let report = shown.on_gpu(gpu::Overrides::default());
        assert_eq!(report.verdict, Verdict::Agree, "{scene:?}: {:?} {:?}", report.causes, report.worst.first());
        let report = shown.changed(|_, _, hit| hit.copied());
        assert_eq!(report.verdict, Verdict::Agree, "{scene:?}: {:?} {:?}", report.causes, report.worst.first());
    }
}

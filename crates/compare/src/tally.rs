//! The pixels of two buffers, added up.

use crate::judge::Difference;
use crate::pair::Pair;
use crate::report::{Coverage, Edges, Identical, PairReport, PixelReport, Verdict, WORST};
use crate::{Cause, Histograms};

/// The share of covered pixels that may stay undecided in an agreement.
pub const UNDECIDED_SHARE: f64 = 1e-3;

/// The share of covered pixels that may have a value without a bound, unless a scene states another.
pub const UNBOUNDED_SHARE: f64 = 1e-2;

/// Running sums of a comparison.
pub(crate) struct Tally {
    report: PairReport,
}

impl Tally {
    pub fn new(pair: &Pair) -> Self {
        let report = PairReport {
            reference: pair.reference.meta().renderer.clone(),
            candidate: pair.candidate.meta().renderer.clone(),
            covered: 0,
            agree: 0,
            causes: Default::default(),
            coverage: Coverage::default(),
            unbounded: 0,
            unbounded_share: pair.judge.unbounded_share,
            ambiguous: 0,
            unconverged: 0,
            identical: (!pair.exact).then(Identical::default),
            max_px: 0.0,
            bound_px: 0.0,
            greatest_bound_px: 0.0,
            edges: pair.candidate.has_edges().then(Edges::default),
            max_along: 0.0,
            position_share: 0.0,
            normal_share: 0.0,
            curvature_share: 0.0,
            shares: Histograms::default(),
            bounds: pair.deviation.text.clone(),
            worst: vec![],
            verdict: Verdict::Differ,
            explanation: None,
        };
        Self { report }
    }

    pub fn add(&mut self, x: usize, y: usize, pair: &Pair) {
        let report = &mut self.report;
        let reference = pair.reference.get(x, y);
        let covered = reference.is_some() || pair.candidate.get(x, y).is_some();
        report.covered += usize::from(covered);
        report.unconverged += usize::from(pair.candidate.is_undecided(x, y));
        if let (Some(same), Some(a), Some(b)) = (&mut report.identical, reference, pair.candidate.get(x, y)) {
            let alike = a.face == b.face && a.uv == b.uv;
            same.alike += usize::from(alike);
            same.identical += usize::from(alike && a == b);
        }
        let class = match (reference, pair.candidate.get(x, y)) {
            (Some(_), Some(_)) => &mut report.coverage.full,
            (None, None) => &mut report.coverage.none,
            _ => &mut report.coverage.partial,
        };
        *class += 1;
        match pair.pixel(x, y) {
            Ok(None) => {}
            Ok(Some(found)) => {
                report.agree += 1;
                report.unbounded += usize::from(found.shares.unbounded);
                report.ambiguous += usize::from(found.shares.ambiguous);
                report.shares.add(&found.shares);
                if found.across_px.is_finite() && found.across_px > report.max_px && found.across_px <= found.bound_px {
                    (report.max_px, report.bound_px) = (found.across_px, found.bound_px);
                }
                report.greatest_bound_px = report.greatest_bound_px.max(found.bound_px);
                if let (Some(edges), Some(edge)) = (&mut report.edges, found.edge) {
                    edges.merge(&Edges {
                        recorded: 1,
                        max_px: edge.off_px,
                        bound_px: edge.bound_px,
                        greatest_bound_px: edge.bound_px,
                    });
                }
                report.max_along = report.max_along.max(found.along);
                report.position_share =
                    found.shares.position.map_or(report.position_share, |share| share.max(report.position_share));
                report.normal_share =
                    found.shares.normal.map_or(report.normal_share, |share| share.max(report.normal_share));
                report.curvature_share =
                    found.shares.curvature.map_or(report.curvature_share, |share| share.max(report.curvature_share));
            }
            Err(Difference { cause, excess, detail }) => {
                *report.causes.entry(cause).or_default() += 1;
                report.worst.push(PixelReport { x, y, cause, excess, detail });
                if report.worst.len() > 4 * WORST {
                    keep_worst(&mut report.worst);
                }
            }
        }
    }

    pub fn merged(mut self, other: Self) -> Self {
        let (a, b) = (&mut self.report, other.report);
        a.covered += b.covered;
        a.agree += b.agree;
        a.unbounded += b.unbounded;
        a.ambiguous += b.ambiguous;
        a.unconverged += b.unconverged;
        if let (Some(a), Some(b)) = (&mut a.identical, b.identical) {
            a.alike += b.alike;
            a.identical += b.identical;
        }
        if let (Some(a), Some(b)) = (&mut a.edges, b.edges) {
            a.merge(&b);
        }
        a.shares.merge(&b.shares);
        a.coverage.full += b.coverage.full;
        a.coverage.partial += b.coverage.partial;
        a.coverage.none += b.coverage.none;
        for (cause, count) in b.causes {
            *a.causes.entry(cause).or_default() += count;
        }
        if b.max_px > a.max_px {
            (a.max_px, a.bound_px) = (b.max_px, b.bound_px);
        }
        a.greatest_bound_px = a.greatest_bound_px.max(b.greatest_bound_px);
        a.max_along = a.max_along.max(b.max_along);
        a.position_share = a.position_share.max(b.position_share);
        a.normal_share = a.normal_share.max(b.normal_share);
        a.curvature_share = a.curvature_share.max(b.curvature_share);
        a.worst.extend(b.worst);
        keep_worst(&mut a.worst);
        self
    }

    pub fn finished(mut self) -> PairReport {
        let report = &mut self.report;
        keep_worst(&mut report.worst);
        let undecided = report.causes.get(&Cause::Undecided).copied().unwrap_or(0);
        let limits = [
            (undecided, UNDECIDED_SHARE, "are undecided"),
            (report.unbounded, report.unbounded_share, "have a value without a bound in f32"),
        ];
        let exceeded = limits.into_iter().find(|&(count, share, _)| count as f64 > share * report.covered as f64);
        report.explanation = exceeded.map(|(count, share, what)| {
            format!("{count} of {} covered pixels {what}; {:.2} % may", report.covered, 100.0 * share)
        });
        if report.differing() == 0 && report.explanation.is_none() {
            report.verdict = Verdict::Agree;
        }
        self.report
    }
}

/// Sorts worst first (ties by position) and drops the rest.
fn keep_worst(pixels: &mut Vec<PixelReport>) {
    pixels.sort_by(|a, b| b.excess.total_cmp(&a.excess).then((a.y, a.x).cmp(&(b.y, b.x))));
    pixels.truncate(WORST);
}

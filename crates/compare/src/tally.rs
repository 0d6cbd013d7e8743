//! The pixels of two buffers, added up.

use crate::Histograms;
use crate::difference::Difference;
use crate::pair::{Finding, Pair};
use crate::report::{Coverage, Edges, Identical, PairReport, PixelReport, Verdict, WORST, keep_worst};

/// Running sums of a comparison.
pub(crate) struct Tally {
    report: PairReport,
}

impl Tally {
    pub fn new(pair: &Pair, unbounded_share: f64) -> Self {
        let report = PairReport {
            reference: pair.reference.meta().renderer.clone(),
            candidate: pair.candidate.meta().renderer.clone(),
            covered: 0,
            agree: 0,
            causes: Default::default(),
            coverage: Coverage::default(),
            unbounded: 0,
            unbounded_causes: Default::default(),
            unbounded_share,
            unanswered_share: pair.deviation.unanswered_share,
            limit_px: pair.deviation.limit_px,
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
            verdict: Verdict::NoVerdict,
            explanation: None,
            uses: vec![],
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
        let finding = pair.pixel(x, y);
        report.uses.push(finding.used());
        match finding {
            Finding::Uncovered => {}
            Finding::Unbounded(reason, _) => {
                report.unbounded += 1;
                *report.unbounded_causes.entry(reason).or_default() += 1;
            }
            Finding::Agrees(found) => {
                report.agree += 1;
                report.ambiguous += usize::from(found.shares.ambiguous);
                report.shares.add(&found.shares);
                if found.across_px.is_finite() && found.across_px > report.max_px && found.across_px <= found.bound_px {
                    (report.max_px, report.bound_px) = (found.across_px, found.bound_px);
                }
                report.greatest_bound_px = report.greatest_bound_px.max(found.whole_bound_px);
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
            Finding::Differs(Difference { cause, excess, detail }) => {
                *report.causes.entry(cause).or_default() += 1;
                report.worst.push(PixelReport { x, y, sample: None, cause, excess, detail });
                if report.worst.len() > 4 * WORST {
                    keep_worst(&mut report.worst);
                }
            }
        }
    }

    pub fn merged(self, other: Self) -> Self {
        Self { report: self.report.with(other.report) }
    }

    pub fn finished(mut self) -> PairReport {
        let report = &mut self.report;
        keep_worst(&mut report.worst);
        let counts = report.counts();
        (report.verdict, report.explanation) = counts.verdict(report.unanswered_share, report.unbounded_share);
        self.report
    }
}

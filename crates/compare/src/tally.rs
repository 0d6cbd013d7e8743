//! The pixels of two buffers, added up.

use crate::judge::Difference;
use crate::pair::Pair;
use crate::report::{Coverage, PairReport, PixelReport, Verdict, WORST};
use crate::{Cause, Deviation};
use gbuffer::GBuffer;
use glam::DVec2;

/// The share of covered pixels that may stay undecided in an agreement.
pub const UNDECIDED_SHARE: f64 = 1e-3;

/// Running sums of a comparison.
pub(crate) struct Tally {
    report: PairReport,
}

impl Tally {
    pub fn new(reference: &GBuffer, candidate: &GBuffer, deviation: &Deviation) -> Self {
        let report = PairReport {
            reference: reference.meta().renderer.clone(),
            candidate: candidate.meta().renderer.clone(),
            covered: 0,
            agree: 0,
            causes: Default::default(),
            coverage: Coverage::default(),
            unbounded: 0,
            max_px: 0.0,
            bound_px: 0.0,
            greatest_bound_px: 0.0,
            max_along: 0.0,
            position_share: 0.0,
            normal_share: 0.0,
            curvature_share: 0.0,
            bounds: deviation.text.clone(),
            worst: vec![],
            verdict: Verdict::Differ,
        };
        Self { report }
    }

    pub fn add(&mut self, x: usize, y: usize, pair: &Pair) {
        let report = &mut self.report;
        let reference = pair.reference.get(x, y);
        let covered = reference.is_some() || pair.candidate.get(x, y).is_some();
        report.covered += usize::from(covered);
        let center = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let class = if pair.is_partial(x, y, center) {
            &mut report.coverage.partial
        } else if reference.is_some() {
            &mut report.coverage.full
        } else {
            &mut report.coverage.none
        };
        *class += 1;
        match pair.pixel(x, y) {
            Ok(None) => {}
            Ok(Some(found)) => {
                report.agree += 1;
                report.unbounded += usize::from(found.shares.unbounded);
                if found.across_px.is_finite() && found.across_px > report.max_px && found.across_px <= found.bound_px {
                    (report.max_px, report.bound_px) = (found.across_px, found.bound_px);
                }
                report.greatest_bound_px = report.greatest_bound_px.max(found.bound_px);
                report.max_along = report.max_along.max(found.along);
                report.position_share = report.position_share.max(found.shares.position);
                report.normal_share = report.normal_share.max(found.shares.normal);
                report.curvature_share = report.curvature_share.max(found.shares.curvature);
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
        let few = undecided as f64 <= UNDECIDED_SHARE * report.covered as f64;
        if report.differing() == 0 && few {
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

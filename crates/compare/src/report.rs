//! What a comparison found, for people and for machines.

use crate::{Cause, Histograms, Shares, Unbounded};
use serde::Serialize;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// How many of the worst pixels a report keeps.
pub(crate) const WORST: usize = 32;

/// The share of covered pixels that the reference may leave undecided in an agreement.
pub const UNDECIDED_SHARE: f64 = 1e-3;

/// The share of covered pixels that may have no verdict for want of a bound, unless a scene states another.
pub const UNBOUNDED_SHARE: f64 = 1e-2;

/// How many of the worst of each cause it keeps at least.
pub(crate) const WORST_OF_CAUSE: usize = 2;

/// The answer for a pair of renderers. The greater wins where several are put together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every pixel agrees, but for shares without a verdict below their limits.
    Agree,
    /// No pixel differs, and that says nothing: no pixel was compared, or too many have no verdict.
    NoVerdict,
    /// Some pixel differs.
    Differ,
}

/// What a verdict follows from: covered pixels, by what was found of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// All of them.
    pub covered: usize,
    /// Those that differ.
    pub differing: usize,
    /// Those that the reference could not decide.
    pub undecided: usize,
    /// Those that the candidate has no answer for, where it may say so.
    pub unanswered: usize,
    /// Those without a useful bound.
    pub unbounded: usize,
}

impl Counts {
    /// The verdict, and why there is none: shares are of the covered pixels.
    pub fn verdict(&self, unanswered_share: f64, unbounded_share: f64) -> (Verdict, Option<String>) {
        if self.differing > 0 {
            return (Verdict::Differ, None);
        }
        if self.covered == 0 {
            return (Verdict::NoVerdict, Some("neither covers a pixel: nothing was compared".to_owned()));
        }
        let limits = [
            (self.undecided, UNDECIDED_SHARE, "are undecided"),
            (self.unanswered, unanswered_share, "have no answer"),
            (self.unbounded, unbounded_share, "have no useful bound, and so no verdict"),
        ];
        let judged = self.covered - (self.undecided + self.unanswered + self.unbounded).min(self.covered);
        if judged == 0 {
            return (Verdict::NoVerdict, Some(format!("none of {} covered pixels has a verdict", self.covered)));
        }
        // A share that is no number allows nothing.
        let holds = |count: usize, share: f64| count as f64 <= share * self.covered as f64;
        match limits.into_iter().find(|&(count, share, _)| count > 0 && !holds(count, share)) {
            None => (Verdict::Agree, None),
            Some((count, share, what)) => {
                let text = format!("{count} of {} covered pixels {what}; {:.2} % may", self.covered, 100.0 * share);
                (Verdict::NoVerdict, Some(text))
            }
        }
    }
}

/// Pixels by who covers them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Coverage {
    /// Covered by both.
    pub full: usize,
    /// Covered by one alone: beside an edge within the bound, or else a difference of coverage.
    pub partial: usize,
    /// Covered by neither.
    pub none: usize,
}

/// One differing pixel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PixelReport {
    /// Column, from the left.
    pub x: usize,
    /// Row, from the top.
    pub y: usize,
    /// Which of the pixel's samples, from 0, where it has several (see [`PairReport::of_samples`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample: Option<usize>,
    /// Why it differs.
    pub cause: Cause,
    /// How many times over what was allowed the deciding quantity is; infinite where nothing is allowed.
    pub excess: f64,
    /// The deciding quantity and its bound in words.
    pub detail: String,
}

/// What the comparison says of one pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelVerdict {
    /// Why it differs; `None` where it does not.
    pub cause: Option<Cause>,
    /// The deciding quantity and its bound in words; where it agrees, what was shown.
    pub detail: String,
    /// Why it has no verdict: then it neither agrees nor differs.
    pub unbounded: Option<Unbounded>,
    /// What its values use of their intervals, where they lie inside.
    pub shares: Shares,
}

/// Pixels of two rasterizers at the same parameters of the same face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Identical {
    /// How many there are.
    pub alike: usize,
    /// How many of them agree in every bit of every value.
    pub identical: usize,
}

/// Trim edges that a candidate recorded.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Edges {
    /// Agreeing pixels that record one.
    pub recorded: usize,
    /// The farthest that one of them is from an edge, or farther than the nearest, pixels.
    pub max_px: f64,
    /// The bound at that pixel, pixels.
    pub bound_px: f64,
    /// The largest bound of any of them, pixels.
    pub greatest_bound_px: f64,
}

impl Edges {
    /// Adds another part of the picture.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.recorded += other.recorded;
        if self.max_px < other.max_px {
            (self.max_px, self.bound_px) = (other.max_px, other.bound_px);
        }
        self.greatest_bound_px = self.greatest_bound_px.max(other.greatest_bound_px);
    }
}

/// What a covered pixel uses of what it is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PixelUse {
    /// The greatest share, of the distance across the ray or of a value's interval: at most 1 where it agrees, and above where it
    /// differs, as [`PixelReport::excess`] has it. `None` where it has no verdict.
    pub share: Option<f32>,
    /// Why it differs.
    pub cause: Option<Cause>,
}

impl PixelUse {
    /// That of the pixel in another sample, where it is worse.
    fn worse(self, other: Self) -> Self {
        let rank = |own: &Self| (own.cause.is_some(), own.share.is_none(), own.share.unwrap_or(0.0));
        if rank(&self).partial_cmp(&rank(&other)) == Some(Ordering::Less) { other } else { self }
    }
}

/// How far a candidate agrees with a reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairReport {
    /// Name of the reference renderer.
    pub reference: String,
    /// Name of the candidate renderer.
    pub candidate: String,
    /// Pixels that either of the two covers.
    pub covered: usize,
    /// Covered pixels that agree.
    pub agree: usize,
    /// Differing pixels by cause.
    pub causes: BTreeMap<Cause, usize>,
    /// Pixels by class.
    pub coverage: Coverage,
    /// Covered pixels without a verdict, since something of them has no useful bound (a normal at a pole): they are counted
    /// here, and neither agree nor differ.
    pub unbounded: usize,
    /// The same by reason.
    pub unbounded_causes: BTreeMap<Unbounded, usize>,
    /// The share of the covered pixels that may be so.
    pub unbounded_share: f64,
    /// The share of the covered pixels for which the candidate may say that it has no answer: they are `causes`, and do not
    /// differ.
    pub unanswered_share: f64,
    /// The least bound with which a pixel has no verdict, pixels.
    pub limit_px: f64,
    /// Covered pixels where f32 leaves a decision open, so that several answers are right.
    pub ambiguous: usize,
    /// Pixels where the candidate says that it did not converge, whether or not they agree.
    pub unconverged: usize,
    /// Pixels at the same parameters, where the reference evaluates in f32, too.
    pub identical: Option<Identical>,
    /// The largest distance across the ray between what the two show in agreeing pixels, in pixels.
    pub max_px: f64,
    /// The bound at that pixel, in pixels.
    pub bound_px: f64,
    /// The largest bound of any agreeing pixel with all that belongs to it, rounding of S too, in pixels.
    pub greatest_bound_px: f64,
    /// The candidate's trim edges, where it was asked for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edges: Option<Edges>,
    /// The largest distance along the ray in agreeing pixels that show the same face, in model units.
    pub max_along: f64,
    /// The largest |position − middle| at the candidate's own (u, v), as a share of its interval's half-width.
    pub position_share: f64,
    /// The same for the normal.
    pub normal_share: f64,
    /// The same for the principal curvatures.
    pub curvature_share: f64,
    /// How many values of agreeing pixels use which share.
    pub shares: Histograms,
    /// What set the bounds, in words.
    pub bounds: String,
    /// The worst differing pixels, worst first.
    pub worst: Vec<PixelReport>,
    /// The answer.
    pub verdict: Verdict,
    /// Why there is no verdict, where no pixel differs.
    pub explanation: Option<String>,
    /// Of each pixel, row by row, what it uses; `None` where neither covers it. Of several samples the worst.
    #[serde(skip)]
    pub uses: Vec<Option<PixelUse>>,
}

impl PairReport {
    /// What a pair of renderers' reports on the samples of a picture, in the samples' order, come to: counts are added up,
    /// so that a pixel counts once for each sample, the greatest values are kept, and each of the worst pixels names its
    /// sample. It agrees where every sample does by itself that shows anything. `None` of no reports; a single one is returned
    /// as it is.
    ///
    /// The reports must be of the same two renderers and the same bounds.
    pub fn of_samples(reports: impl IntoIterator<Item = Self>) -> Option<Self> {
        let mut reports: Vec<Self> = reports.into_iter().collect();
        if reports.len() > 1 {
            for (sample, report) in reports.iter_mut().enumerate() {
                report.worst.iter_mut().for_each(|pixel| pixel.sample = Some(sample));
                report.explanation = report.explanation.take().map(|text| format!("sample {sample}: {text}"));
            }
        }
        let uses = reports.iter_mut().map(|report| std::mem::take(&mut report.uses)).reduce(|mut all, sample| {
            for (own, other) in all.iter_mut().zip(sample) {
                *own = own.zip(other).map_or(own.or(other), |(own, other)| Some(own.worse(other)));
            }
            all
        });
        let report = reports.into_iter().reduce(Self::with)?;
        Some(Self { uses: uses.unwrap_or_default(), ..report })
    }

    /// This report and one of other pixels of the same pair.
    pub(crate) fn with(mut self, other: Self) -> Self {
        // Where nothing is shown there is nothing to say beside what is said of the rest.
        if self.covered == 0 || other.covered > 0 && self.verdict < other.verdict {
            (self.verdict, self.explanation) = (other.verdict, other.explanation);
        }
        self.covered += other.covered;
        self.agree += other.agree;
        for (cause, count) in other.causes {
            *self.causes.entry(cause).or_default() += count;
        }
        self.coverage.full += other.coverage.full;
        self.coverage.partial += other.coverage.partial;
        self.coverage.none += other.coverage.none;
        self.unbounded += other.unbounded;
        for (reason, count) in other.unbounded_causes {
            *self.unbounded_causes.entry(reason).or_default() += count;
        }
        self.ambiguous += other.ambiguous;
        self.unconverged += other.unconverged;
        if let (Some(own), Some(others)) = (&mut self.identical, other.identical) {
            own.alike += others.alike;
            own.identical += others.identical;
        }
        if let (Some(own), Some(others)) = (&mut self.edges, other.edges) {
            own.merge(&others);
        }
        if other.max_px > self.max_px {
            (self.max_px, self.bound_px) = (other.max_px, other.bound_px);
        }
        self.greatest_bound_px = self.greatest_bound_px.max(other.greatest_bound_px);
        self.max_along = self.max_along.max(other.max_along);
        self.position_share = self.position_share.max(other.position_share);
        self.normal_share = self.normal_share.max(other.normal_share);
        self.curvature_share = self.curvature_share.max(other.curvature_share);
        self.shares.merge(&other.shares);
        self.worst.extend(other.worst);
        keep_worst(&mut self.worst);
        self.uses.extend(other.uses);
        self
    }

    /// What the verdict follows from.
    pub fn counts(&self) -> Counts {
        let of = |cause: Cause| self.causes.get(&cause).copied().unwrap_or(0);
        let undecided = of(Cause::Undecided);
        let unanswered = if self.unanswered_share > 0.0 { of(Cause::NewtonNotConverged) } else { 0 };
        let differing = self.causes.values().sum::<usize>() - undecided - unanswered;
        Counts { covered: self.covered, differing, undecided, unanswered, unbounded: self.unbounded }
    }

    /// Number of pixels that differ: those without a verdict are not counted.
    pub fn differing(&self) -> usize {
        self.counts().differing
    }

    /// Pixels without a verdict by reason, the most frequent first.
    pub fn reasons(&self) -> Vec<(Unbounded, usize)> {
        let mut reasons: Vec<_> = self.unbounded_causes.iter().map(|(reason, count)| (*reason, *count)).collect();
        reasons.sort_by_key(|(reason, count)| (std::cmp::Reverse(*count), *reason));
        reasons
    }

    /// The most frequent cause of difference.
    pub fn main_cause(&self) -> Option<Cause> {
        self.causes.iter().max_by_key(|(cause, n)| (**n, std::cmp::Reverse(**cause))).map(|(cause, _)| *cause)
    }
}

/// Sorts worst first (ties by position) and drops the rest, but for the worst two of each cause.
pub(crate) fn keep_worst(pixels: &mut Vec<PixelReport>) {
    let place = |pixel: &PixelReport| (pixel.y, pixel.x, pixel.sample);
    pixels.sort_by(|a, b| b.excess.total_cmp(&a.excess).then(place(a).cmp(&place(b))));
    let (mut place, mut of_cause) = (0, BTreeMap::<Cause, usize>::new());
    pixels.retain(|pixel| {
        let seen = of_cause.entry(pixel.cause).or_default();
        (place, *seen) = (place + 1, *seen + 1);
        place <= WORST || *seen <= WORST_OF_CAUSE
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_agrees_only_over_something_and_within_every_share() {
        let sound = Counts { covered: 1000, ..Counts::default() };
        let cases = [
            (sound, Verdict::Agree),
            (Counts { undecided: 1, unanswered: 1, unbounded: 10, ..sound }, Verdict::Agree),
            (Counts::default(), Verdict::NoVerdict),
            (Counts { undecided: 2, ..sound }, Verdict::NoVerdict),
            (Counts { unanswered: 2, ..sound }, Verdict::NoVerdict),
            (Counts { unbounded: 11, ..sound }, Verdict::NoVerdict),
            (Counts { differing: 1, unbounded: 999, ..sound }, Verdict::Differ),
        ];
        for (counts, expected) in cases {
            let (verdict, why) = counts.verdict(1e-3, 1e-2);
            assert_eq!(verdict, expected, "{counts:?}");
            assert_eq!(why.is_some(), verdict == Verdict::NoVerdict, "{counts:?}: {why:?}");
        }
        // Not even where all of them may have no verdict, nor where a share is no number.
        let none = Counts { unbounded: 1000, ..sound };
        assert_eq!(none.verdict(1e-3, 1.0).0, Verdict::NoVerdict);
        assert_eq!(Counts { unbounded: 1, ..sound }.verdict(1e-3, f64::NAN).0, Verdict::NoVerdict);
    }
}

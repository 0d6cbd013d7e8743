//! What a comparison found, for people and for machines.

use crate::{Cause, Histograms, Shares};
use serde::Serialize;
use std::collections::BTreeMap;

/// How many of the worst pixels a report keeps.
pub(crate) const WORST: usize = 32;

/// The answer for a pair of renderers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every pixel agrees, but for a share of undecided ones below the limit.
    Agree,
    /// Some pixel differs, too many are undecided, or there was nothing to compare.
    Differ,
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
    /// Why it differs; `None` where it agrees.
    pub cause: Option<Cause>,
    /// The deciding quantity and its bound in words; where it agrees, what was shown.
    pub detail: String,
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
    /// Covered pixels with a value that has no useful bound in f32 (a normal at a pole): counted, not judged.
    pub unbounded: usize,
    /// The share of the covered pixels that may be so.
    pub unbounded_share: f64,
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
    /// The largest bound of any covered pixel, in pixels.
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
    /// Why the pair differs where no single pixel does: too many are undecided or unbounded.
    pub explanation: Option<String>,
}

impl PairReport {
    /// Number of pixels that differ, undecided ones not counted.
    pub fn differing(&self) -> usize {
        self.causes.iter().filter(|(cause, _)| **cause != Cause::Undecided).map(|(_, n)| n).sum()
    }

    /// The most frequent cause of difference.
    pub fn main_cause(&self) -> Option<Cause> {
        self.causes.iter().max_by_key(|(cause, n)| (**n, std::cmp::Reverse(**cause))).map(|(cause, _)| *cause)
    }
}

//! What a comparison of three renderings found.

use super::verdict;
use crate::antialias::SampleReport;
use crate::approximate::Approximation;
use crate::masks::MaskReport;
use compare::{PairReport, Verdict};
use serde::Serialize;
use suite::bits::Bits;
use suite::stage::ShadedReport;

/// What the comparison found.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    /// Of `testdata/schema/compare-1.json`.
    pub schema_version: u32,
    pub model: &'a str,
    /// What of its file is not drawn as it stands there.
    pub notes: Vec<String>,
    pub technique: &'static str,
    pub size: [usize; 2],
    pub adapter: Option<String>,
    pub driver: Option<String>,
    pub triangles: usize,
    /// What is drawn in the model's place, where another one is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub approximation: Option<Approximation>,
    /// How the rasterizers trim faces.
    pub trim: &'static str,
    /// Where they do by masks.
    pub masks: Option<MaskReport>,
    /// Where in a pixel it was sampled; one sample, in the centre, unless anti-aliased.
    pub samples: &'a [SampleReport],
    /// Of all samples of a pixel together.
    pub pairs: &'a [PairReport],
    /// The pictures shaded in the GPU's fragment stage against the shading of its G-buffer.
    pub shaded: Option<ShadedReport>,
    /// The GPU's bits against the rasterizer's, where --path strict asks for the same ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strict: Option<Bits>,
    /// Why the GPU did not run.
    pub gpu_not_run: Option<String>,
    /// Pixels that the ray caster could not decide.
    pub undecided: usize,
}

impl Report<'_> {
    /// The answer in one plain line.
    pub fn line(&self) -> String {
        let agree = self.pairs.iter().all(|pair| pair.differing() == 0);
        if let Some(strict) = self.strict.as_ref().filter(|strict| strict.unlike > 0 && agree) {
            return format!("{} pixels of the GPU have other bits than the rasterizer's.", strict.unlike);
        }
        let shaded = self.shaded.as_ref().filter(|shaded| shaded.verdict == Verdict::Differ);
        let differ = shaded.map_or(0, |shaded| shaded.differ);
        verdict::line(self.pairs, &[], self.gpu_not_run.as_deref(), differ)
    }
}

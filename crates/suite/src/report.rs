//! What a run of the conformance suite found: the document that is written, read back and merged.
//!
//! `report.json` is the one source of the table, the JUnit file and the HTML page. Whether a run is complete is never
//! stored: it follows from what was planned and what is there, so that a run that was killed says so by itself.

use crate::bits::Bits;
use crate::corpus::{CaseKey, SceneInfo, Suite};
use crate::shard::Shard;
use crate::stage::Path as DrawnBy;
use crate::wrong::Vacuity;
use anyhow::{Context, Result, bail};
use compare::{Histogram, PairReport, Verdict};
use gbuffer::{GBuffer, Hit};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Marks a document of this kind.
pub const SCHEMA: &str = "isophote-conform";

/// Version of the document's layout, `testdata/schema/conform-2.json`.
pub const SCHEMA_VERSION: u32 = 2;

/// The largest report that is read, bytes: 1 GiB. That of the full suite, with its pictures, is far below.
pub const MAX_BYTES: u64 = 1 << 30;

/// How many differing pixels of a pair are kept with the values of their stages.
const WORST_KEPT: usize = 12;

/// A whole run, or several merged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: String,
    /// [`SCHEMA_VERSION`].
    pub schema_version: u32,
    /// Version of the program that measured.
    pub program: String,
    /// Which suite.
    pub suite: Suite,
    /// How the GPU draws.
    #[serde(default, skip_serializing_if = "DrawnBy::is_default")]
    pub path: DrawnBy,
    /// The part of the suite that is expected here: the whole, where shards were merged.
    pub shard: Shard,
    /// The runs that this comes from: one, or those merged.
    pub sources: Vec<Source>,
    /// [`Corpus::hash`](crate::corpus::Corpus::hash) of what was run: by it a report of other models or views is told.
    pub corpus: String,
    /// The scenes of the suite.
    pub scenes: Vec<SceneInfo>,
    /// Every case of the whole suite, in its order.
    pub planned: Vec<CaseKey>,
    /// Who was to be judged.
    pub subjects: Vec<Subject>,
    /// What was found, in the suite's order.
    pub cases: Vec<Case>,
    /// What a reader must know of the run besides.
    pub notes: Vec<String>,
}

/// One run of the program.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// The part of the suite that it ran.
    pub shard: Shard,
    /// Operating system and processor family.
    pub host: String,
    /// When it started, seconds since 1970 UTC.
    pub started_unix: u64,
    /// [`Subject::id`] of those it judged.
    pub subjects: Vec<String>,
}

/// A renderer that is judged: the CPU rasterizer, or the GPU program on an adapter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Subject {
    /// Unique in a report, and the same on every machine with the same adapter, driver and host.
    pub id: String,
    /// What a person calls it.
    pub name: String,
    /// `cpu`, or the kind of GPU.
    pub kind: String,
    /// Driver and its version; empty for the CPU.
    pub driver: String,
    /// The API that it is reached through; empty for the CPU.
    pub backend: String,
    /// What makes its programs of WGSL; empty for the CPU, and where nothing is known of it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub compiler: String,
    /// Operating system and processor family.
    pub host: String,
    /// Why it stopped, or never started.
    pub failure: Option<String>,
}

/// A picture of the suite and what everyone made of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Which.
    pub key: CaseKey,
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// The options of `isophote pixel MODEL X,Y` and `compare MODEL` that show it again.
    pub options: String,
    /// Triangles drawn.
    pub triangles: usize,
    /// Pixels that the ray caster could not decide.
    pub undecided: usize,
    /// The ray caster's picture as a `data:` URI, where pictures are kept.
    pub picture: Option<String>,
    /// Why nobody could draw it.
    pub error: Option<String>,
    /// One for each subject that was asked.
    pub outcomes: Vec<Outcome>,
}

/// What one subject made of a case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct Outcome {
    /// [`Subject::id`].
    pub subject: String,
    /// Drawing and judging, seconds.
    pub seconds: f64,
    /// Its comparisons with the other renderers.
    pub pairs: Vec<Pair>,
    /// What the judge makes of pictures made wrong of its own, where the suite tries that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrong: Option<Vacuity>,
    /// Pixels that are not, to the last bit, those of the first GPU subject; none for that one, or where it drew nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unlike: Option<usize>,
    /// Where --path strict asks for the CPU rasterizer's bits: how far it has them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bits: Option<Bits>,
    /// A hash of all bits of its G-buffer, where --path strict asks for them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hash: Option<String>,
    /// Its picture as a `data:` URI, where pictures are kept.
    pub picture: Option<String>,
    /// Why it could not be judged.
    pub error: Option<String>,
}

/// The share of a tolerance that was used: |error| over the allowed error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// The largest share of an agreeing pixel.
    pub max: f64,
    /// Pixels by share, in equal bins from 0 to 1; empty where they were not counted.
    pub histogram: Vec<usize>,
}

/// A comparison of two renderers on one case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// The renderer taken for right.
    pub reference: String,
    /// The renderer judged.
    pub candidate: String,
    /// Whether all agree.
    pub agree: bool,
    /// Why they do not, in words.
    pub reasons: Vec<String>,
    /// Pixels that either covers.
    pub covered: usize,
    /// Pixels that differ.
    pub differing: usize,
    /// Differing and undecided pixels by cause.
    pub causes: BTreeMap<String, usize>,
    /// Covered pixels without a verdict for want of a bound.
    pub unbounded: usize,
    /// The same by reason.
    pub unbounded_causes: BTreeMap<String, usize>,
    /// Pixels among `causes` for which the candidate says that it has no answer, as a few may: they do not differ.
    pub unanswered: usize,
    /// Pixels where f32 leaves a decision open.
    pub ambiguous: usize,
    /// Pixels in which the candidate's search for a root did not converge.
    pub unconverged: usize,
    /// Full, partial and no coverage, pixels.
    pub coverage: [usize; 3],
    /// The largest distance across the ray, pixels, and the bound there; none where it is infinite.
    pub across_px: [Option<f64>; 2],
    /// The largest bound of any agreeing pixel with all that belongs to it, pixels.
    pub greatest_bound_px: Option<f64>,
    /// Budget of the position, the normal and the curvatures.
    pub position: Budget,
    /// Of the normal.
    pub normal: Budget,
    /// Of the principal curvatures.
    pub curvature: Budget,
    /// The map of differences as a `data:` URI, where pictures are kept.
    pub difference: Option<String>,
    /// The worst differing pixels, worst first.
    pub worst: Vec<WorstPixel>,
}

/// A differing pixel with what each of the two renderers has there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorstPixel {
    /// Column.
    pub x: usize,
    /// Row.
    pub y: usize,
    /// Why it differs.
    pub cause: String,
    /// How many times over what was allowed; none where nothing is.
    pub excess: Option<f64>,
    /// The deciding quantity and its bound in words.
    pub detail: String,
    /// What the reference has there.
    pub reference: Option<Stages>,
    /// What the candidate has there.
    pub candidate: Option<Stages>,
}

/// The values of a hit as the stages made them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stages {
    /// Face.
    pub face: u32,
    /// Parameters.
    pub uv: [Option<f64>; 2],
    /// S, world coordinates.
    pub position: [Option<f64>; 3],
    /// Unit normal; none where there is none.
    pub normal: Option<[Option<f64>; 3]>,
    /// Principal curvatures; none where there are none.
    pub curvature: Option<[Option<f64>; 2]>,
    /// Distance along the ray.
    pub t: Option<f64>,
}

/// Of an answer, a scene or a run. The greater wins where several are put together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum State {
    /// All agree.
    Agree,
    /// Something differs.
    Differ,
    /// Something could not run, or is not there.
    NotRun,
}

/// A number that JSON can hold.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

impl Stages {
    fn of(hit: &Hit) -> Self {
        Self {
            face: hit.face.0,
            uv: hit.uv.to_array().map(finite),
            position: hit.position.to_array().map(finite),
            normal: hit.normal.unit().map(|n| n.to_array().map(finite)),
            curvature: hit.curvature.map(|k| [k.k1, k.k2].map(finite)),
            t: finite(hit.t),
        }
    }
}

impl Pair {
    /// What is kept of a comparison: the one place that knows [`PairReport`].
    pub fn new(found: &PairReport, reference: &GBuffer, candidate: &GBuffer) -> Self {
        let budget = |max: f64, histogram: &Histogram| Budget { max, histogram: histogram.0.to_vec() };
        let mut reasons: Vec<String> =
            found.causes.iter().map(|(cause, count)| format!("{count} pixels: {}", cause.label())).collect();
        reasons.extend(found.explanation.clone());
        let agree = found.verdict == Verdict::Agree;
        if agree {
            reasons.clear();
        }
        let worst = found.worst.iter().take(WORST_KEPT).map(|pixel| WorstPixel {
            x: pixel.x,
            y: pixel.y,
            cause: pixel.cause.label().to_owned(),
            excess: finite(pixel.excess),
            detail: pixel.detail.clone(),
            reference: reference.get(pixel.x, pixel.y).map(Stages::of),
            candidate: candidate.get(pixel.x, pixel.y).map(Stages::of),
        });
        Self {
            reference: found.reference.clone(),
            candidate: found.candidate.clone(),
            agree,
            reasons,
            covered: found.covered,
            differing: found.differing(),
            causes: found.causes.iter().map(|(cause, count)| (cause.label().to_owned(), *count)).collect(),
            unbounded: found.unbounded,
            unbounded_causes: found.reasons().into_iter().map(|(why, count)| (why.label().to_owned(), count)).collect(),
            unanswered: found.counts().unanswered,
            ambiguous: found.ambiguous,
            unconverged: found.unconverged,
            coverage: [found.coverage.full, found.coverage.partial, found.coverage.none],
            across_px: [finite(found.max_px), finite(found.bound_px)],
            greatest_bound_px: finite(found.greatest_bound_px),
            position: budget(found.position_share, &found.shares.position),
            normal: budget(found.normal_share, &found.shares.normal),
            curvature: budget(found.curvature_share, &found.shares.curvature),
            difference: None,
            worst: worst.collect(),
        }
    }

    /// The largest share of any budget.
    pub fn share(&self) -> f64 {
        self.position.max.max(self.normal.max).max(self.curvature.max)
    }
}

impl Outcome {
    /// Whether it agrees, to the bit where that is asked, and no picture made wrong of its own does.
    pub fn state(&self) -> State {
        let is_judged = self.wrong.as_ref().is_none_or(|wrong| wrong.missed.is_empty());
        let is_same = self.bits.as_ref().is_none_or(|bits| bits.unlike == 0);
        match (&self.error, is_judged && is_same && self.pairs.iter().all(|pair| pair.agree)) {
            (Some(_), _) => State::NotRun,
            (None, true) => State::Agree,
            (None, false) => State::Differ,
        }
    }
}

impl Report {
    /// The case of that key, where it was measured.
    pub fn case(&self, key: &CaseKey) -> Option<&Case> {
        self.cases.iter().find(|case| case.key == *key)
    }

    /// The planned cases that are expected here, in order.
    pub fn expected(&self) -> Vec<&CaseKey> {
        let place: BTreeMap<&str, usize> =
            self.scenes.iter().enumerate().map(|(place, scene)| (scene.name.as_str(), place)).collect();
        let held = |key: &&CaseKey| place.get(key.scene.as_str()).is_some_and(|&place| self.shard.holds(place));
        self.planned.iter().filter(held).collect()
    }

    /// The outcomes of one subject with their cases, in the suite's order.
    pub fn outcomes<'a>(&'a self, subject: &'a str) -> impl Iterator<Item = (&'a Case, &'a Outcome)> {
        let of = move |case: &'a Case| case.outcomes.iter().find(|o| o.subject == subject).map(|o| (case, o));
        self.cases.iter().filter_map(of)
    }

    /// The expected cases that a subject has no outcome of, in order.
    pub fn missing(&self, subject: &str) -> Vec<&CaseKey> {
        let there: BTreeSet<&CaseKey> = self.outcomes(subject).map(|(case, _)| &case.key).collect();
        self.expected().into_iter().filter(|key| !there.contains(key)).collect()
    }

    /// Whether a subject agrees on all that is expected.
    pub fn state_of(&self, subject: &Subject) -> State {
        if subject.failure.is_some() || !self.missing(&subject.id).is_empty() {
            return State::NotRun;
        }
        self.outcomes(&subject.id).map(|(_, outcome)| outcome.state()).max().unwrap_or(State::NotRun)
    }

    /// Whether everything agrees; notes are of what should not have been. The CPU rasterizer alone is no answer.
    pub fn state(&self) -> State {
        let alone = self.subjects.iter().all(|subject| subject.kind == "cpu");
        let broken = alone || self.cases.iter().any(|case| case.error.is_some()) || !self.notes.is_empty();
        let worst = self.subjects.iter().map(|subject| self.state_of(subject)).max().unwrap_or(State::NotRun);
        if broken { State::NotRun } else { worst }
    }

    /// Reads a report from a regular file of at most [`MAX_BYTES`]; `conform merge` says whether to believe it.
    ///
    /// # Errors
    /// Where it cannot be read, is cut off or damaged, or is another kind or version of document; the file is named.
    pub fn read(path: &Path) -> Result<Self> {
        #[derive(Deserialize)]
        struct Head {
            schema: Option<String>,
            schema_version: Option<u32>,
        }
        let file = || path.display().to_string();
        let bytes = files::read(path, MAX_BYTES).with_context(file)?;
        let head: Head = serde_json::from_slice(&bytes).map_err(|error| {
            let what = if error.is_eof() { "cut off" } else { "not JSON of a report" };
            anyhow::anyhow!("{}: {what}: {error}", file())
        })?;
        match (head.schema.as_deref(), head.schema_version) {
            (Some(SCHEMA), Some(SCHEMA_VERSION)) => {}
            (Some(SCHEMA), version) => bail!(
                "{}: schema_version {}, where this program reads {SCHEMA_VERSION}",
                file(),
                version.map_or("missing".to_owned(), |v| v.to_string())
            ),
            _ => bail!("{}: not a conformance report: schema is not {SCHEMA:?}", file()),
        }
        serde_json::from_slice(&bytes).with_context(|| format!("{}: damaged", file()))
    }

    /// Writes `report.json` whole or not at all: what was there before stays until the new one is complete.
    ///
    /// # Errors
    /// Where the folder cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let text = serde_json::to_vec(self)?;
        let path = folder.join("report.json");
        files::write_bytes(&path, &text).with_context(|| path.display().to_string())
    }
}

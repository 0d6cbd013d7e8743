//! The judge of the browser's page: what a visitor's GPU drew, judged by the functions that `isophote conform` calls.
//!
//! It has no disk, no GPU and no thread but its own, so it builds for `wasm32-wasip1` and runs in a worker of the page. A
//! request brings one scene's capsules and the answers to them; the [`verdict`] is the report so far, and what the page shows
//! of that scene.

mod answers;
mod request;
mod shown;

use answers::{Answers, measured};
use anyhow::{Context, Result};
use gpu::Grid;
use request::{DrawnBy, Request};
use serde::Serialize;
use shown::{Row, line, rows, word};
use std::sync::atomic::AtomicBool;
use suite::report::Report;
use suite::run::{Adapter, Plans, absent, by_capsule};
use suite::stage::Path;

/// What is made of a request.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Verdict {
    /// All that was found so far: what `isophote conform merge` reads.
    report: Report,
    /// `agree`, `differ`, or `partial` while something is missing.
    state: &'static str,
    /// The same as a sentence.
    line: String,
    /// To what the rasterizer snaps corners, and how far that moves them, where that was measured.
    grid: Option<String>,
    moves_px: Option<f64>,
    /// The cases of the scene at hand.
    rows: Vec<Row>,
}

/// Judges one scene, or begins a report where the request names none; JSON.
///
/// # Errors
/// Where the request is malformed, or names a scene that is not in its part of the suite.
pub fn verdict(request: &[u8]) -> Result<Vec<u8>> {
    let (request, files) = Request::read(request)?;
    let Request { suite, shard, report, scene, drawn_by, edges, moves_px, pictures, .. } = request;
    let grid = edges.map(|answer| measured(&answer, &files)).transpose()?.flatten();
    let moves_px = grid.map(Grid::moves_px).or(moves_px);
    let plans = Plans { suite, scenes: suite.scenes(), shard, path: Path::default() };
    let subject = match &drawn_by {
        DrawnBy::Host { host, platform } => by_capsule(host, platform),
        DrawnBy::Absent { why } => absent("WebGPU", why.clone()),
    };
    let mut report = report.unwrap_or_else(|| plans.report(vec![subject.clone()]));
    let first = report.cases.len();
    if let Some(name) = scene {
        let scene = plans.mine().find(|scene| scene.name == name);
        let scene =
            scene.with_context(|| format!("scene {name:?} is not in shard {shard} of suite {}", suite.name()))?;
        let mut adapters: Vec<Box<dyn Adapter>> = match drawn_by {
            DrawnBy::Host { host, .. } => {
                vec![Box::new(Answers { subject: subject.clone(), host, moves_px, pictures, files })]
            }
            DrawnBy::Absent { .. } => vec![],
        };
        plans.run_scene(scene, &mut adapters, &mut report, &AtomicBool::new(false), &mut |_| Ok(()))?;
    }
    let (state, line, rows) = (word(report.state()), line(&report, &subject), rows(&report, first, &subject));
    let grid = grid.map(|grid| grid.to_string());
    Ok(serde_json::to_vec(&Verdict { report, state, line, grid, moves_px, rows })?)
}

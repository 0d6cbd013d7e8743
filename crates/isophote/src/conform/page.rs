//! `conform page`: a suite's capsules, what plays them and what judges them in one HTML file that opens in any browser.
//!
//! The page is drawn by `hosts/browser/suite.mjs`. Files that several capsules share stand in it once; all are packed by gzip, which a
//! browser unpacks itself.

use crate::capsule::recorded;
use crate::{output, say, terminal};
use anyhow::{Context, Result, anyhow, ensure};
use base64::Engine;
use clap::Args;
use flate2::Compression;
use flate2::write::GzEncoder;
use gpu::capsule::{Contents, edges};
use serde::Serialize;
use std::collections::HashMap;
use std::io::Write;
use std::path::PathBuf;
use suite::corpus::Suite;
use suite::run::Plans;
use suite::shard::Shard;
use suite::stage::{Path as DrawnBy, Stage};

const PAGE: &str = include_str!("../../../../hosts/browser/suite.html");
const STYLES: [&str; 2] =
    [include_str!("../../assets/report.css"), include_str!("../../../../hosts/browser/suite.css")];
const PLAYER: &str = include_str!("../../../../hosts/player.mjs");
const VISITOR: &str = include_str!("../../../../hosts/browser/visitor.mjs");
const SCRIPT: &str = include_str!("../../../../hosts/browser/suite.mjs");
const WORKER: &str = include_str!("../../../../hosts/browser/worker.js");

/// How a module of WebAssembly begins.
const MODULE: &[u8] = b"\0asm";

/// The largest judge that is taken, bytes: ten times what ours is.
const MAX_JUDGE: u64 = 1 << 26;

/// Write a page that judges a visitor's own GPU, in one HTML file
///
/// The file opens from a disk or any server of files; it fetches nothing and sends nothing. It plays the suite by the browser's
/// WebGPU, judges each picture as `conform` does, and offers a report for `conform merge` (docs/hosts.md).
#[derive(Debug, Args)]
pub struct PageArgs {
    /// The page
    #[arg(value_name = "FILE.html")]
    page: PathBuf,
    /// The judge, as `cargo build --release -p judge --target wasm32-wasip1` leaves it
    #[arg(long, value_name = "FILE.wasm", default_value = "target/wasm32-wasip1/release/judge.wasm")]
    judge: PathBuf,
    /// How much of the corpus
    #[arg(long, value_enum, default_value = "smoke")]
    suite: Suite,
    /// Part K of N only
    #[arg(long, value_name = "K/N", default_value = "1/1")]
    shard: Shard,
    /// Part of the name of the adapter by which capsules are recorded [default: the best one]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

/// What the page's script reads.
#[derive(Serialize)]
struct Data {
    program: &'static str,
    suite: Suite,
    shard: Shard,
    scenes: Vec<SceneData>,
    /// The capsule that measures the rasterizer's grid.
    edges: Vec<(String, usize)>,
    /// Bytes of each file, in the order in which they are packed.
    files: Vec<usize>,
}

#[derive(Serialize)]
struct SceneData {
    name: &'static str,
    stresses: &'static str,
    cases: Vec<CaseData>,
}

/// A picture and its capsule.
#[derive(Serialize)]
struct CaseData {
    /// By which the judge knows it.
    options: String,
    /// As [`Packed::capsule`] gives them.
    files: Vec<(String, usize)>,
}

/// Files, each once.
#[derive(Default)]
struct Packed {
    bytes: Vec<u8>,
    lengths: Vec<usize>,
    places: HashMap<Vec<u8>, usize>,
}

impl Packed {
    /// The files of a capsule: a name, and the place among all.
    fn capsule(&mut self, capsule: Contents) -> Vec<(String, usize)> {
        capsule.into_files().into_iter().map(|(name, file)| (name, self.place(file))).collect()
    }

    /// The place of a file.
    fn place(&mut self, file: Vec<u8>) -> usize {
        *self.places.entry(file).or_insert_with_key(|file| {
            self.bytes.extend_from_slice(file);
            self.lengths.push(file.len());
            self.lengths.len() - 1
        })
    }
}

/// Runs the command.
///
/// # Errors
/// Where the judge is not there or is none, there is no adapter to record by, a scene cannot be drawn, or the page cannot be written.
pub fn run(args: &PageArgs) -> Result<()> {
    output::check(&args.page, "html")?;
    let PageArgs { suite, shard, .. } = *args;
    let judge = files::read(&args.judge, MAX_JUDGE)
        .map_err(anyhow::Error::from)
        .and_then(|bytes| bytes.starts_with(MODULE).then_some(bytes).context("no module of WebAssembly"))
        .with_context(|| format!("the judge, {}", args.judge.display()))?;
    let plans = Plans { suite, scenes: suite.scenes(), shard, path: DrawnBy::default() };
    let (mut packed, mut scenes) = (Packed::default(), vec![]);
    let bar = terminal::progress("conform page", plans.mine().count());
    for scene in plans.mine() {
        bar.set_message(scene.name);
        let model = scene.open().map_err(|error| anyhow!("{}: {error}", scene.name))?;
        let (viewport, mut cases) = (suite.viewport(), vec![]);
        for viewpoint in suite.viewpoints(scene) {
            let camera = viewpoint.camera(&model, viewport);
            for plan in suite.plans(scene) {
                let options = scene.options(&camera, viewport, plan);
                let contents = Stage::new(&model, camera, viewport, plan)
                    .and_then(|stage| recorded(&stage, args.adapter.as_deref(), gpu::Overrides::default()))
                    .with_context(|| scene.key(*viewpoint, plan).to_string())?
                    .0;
                cases.push(CaseData { options, files: packed.capsule(contents) });
            }
        }
        scenes.push(SceneData { name: scene.name, stresses: scene.stresses, cases });
        bar.inc(1);
    }
    let pictures: usize = scenes.iter().map(|scene| scene.cases.len()).sum();
    ensure!(pictures > 0, "shard {shard} of suite {} has no scenes", suite.name());
    let edges = packed.capsule(edges());
    let data = Data { program: env!("CARGO_PKG_VERSION"), suite, shard, scenes, edges, files: packed.lengths };
    let page = page(&data, &text(&packed.bytes)?, &text(&judge)?)?;
    output::write(&args.page, page.as_bytes())?;
    say!("a page of {pictures} pictures, {:.1} MB, is in {}", page.len() as f64 / 1e6, args.page.display())
}

/// The page: what it is put together of stands in it in full.
fn page(data: &Data, files: &str, judge: &str) -> Result<String> {
    // Inside a script element only `<` could end the data.
    let data = serde_json::to_string(data)?.replace('<', "\\u003c");
    let parts = [
        ("/*STYLE*/", &*STYLES.concat()),
        ("/*WORKER*/", WORKER),
        ("/*PLAYER*/", PLAYER),
        ("/*VISITOR*/", VISITOR),
        ("/*SCRIPT*/", SCRIPT),
        ("/*DATA*/", &data),
        ("/*FILES*/", files),
        ("/*JUDGE*/", judge),
    ];
    Ok(parts.iter().fold(PAGE.to_owned(), |page, (place, part)| page.replacen(place, part, 1)))
}

/// Packed bytes as text.
fn text(bytes: &[u8]) -> Result<String> {
    let mut encoder = GzEncoder::new(vec![], Compression::best());
    encoder.write_all(bytes)?;
    Ok(base64::engine::general_purpose::STANDARD.encode(encoder.finish()?))
}

//! `compare MODEL`: renders every sample of a picture by all three, and judges it.

use super::answer::{SCHEMA_VERSION, answer, exit_code};
use super::args::CompareArgs;
use super::next::Next;
use super::page::Page;
use super::pictures::Pictures;
use super::report::Report;
use super::table;
use crate::antialias::{Antialias, SampleReport};
use crate::masks::MaskReport;
use crate::terminal;
use crate::view::ModelArgs;
use anyhow::{Result, bail};
use compare::{PairReport, Verdict};
use formats::{Document, Note};
use gbuffer::{GBuffer, Meta, Shading};
use raycast::Caster;
use std::process::ExitCode;
use suite::bits::Bits;
use suite::stage::{Path, Plan, Rendered, ShadedReport, Stage};

/// What one sample shows, without its G-buffers: a picture of many samples holds those of one at a time.
struct Sample {
    pairs: Vec<PairReport>,
    shaded: Option<ShadedReport>,
    strict: Option<Bits>,
    pictures: Pictures,
    undecided: usize,
    /// The facts of the GPU's buffer, or why there is none.
    gpu: Result<Meta, String>,
}

/// Runs the command.
pub(super) fn run(args: &CompareArgs, asked: &ModelArgs) -> Result<ExitCode> {
    let Document { model, notes, .. } = asked.document()?;
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&model, viewport)?;
    let plan = Plan { edges: args.antialias == Antialias::Trims, ..args.drawing.plan() };
    let drawn = args.approximate.drawn(&model, &camera, viewport)?;
    let stage = match &drawn {
        None => Stage::new(&model, camera, viewport, plan)?,
        Some(_) if plan.edges => bail!("--antialias trims records where trim edges pass, and --approximate moves them"),
        Some(drawn) => Stage::new(&drawn.model, camera, viewport, plan)?.in_place_of(&model, &drawn.stand_in)?,
    };
    let samples = SampleReport::of(args.antialias.pattern(), &camera, viewport);
    let mut found = judged(args, &stage)?;
    // A GPU that fails at one sample has not drawn the picture.
    let count = found.iter().map(|sample| sample.pairs.len()).min().unwrap_or(0);
    let pair = |k: usize| PairReport::of_samples(found.iter().map(|sample| sample.pairs[k].clone()));
    let pairs: Vec<PairReport> = (0..count).filter_map(pair).collect();
    let gpu: Result<Vec<Meta>, String> = found.iter().map(|sample| sample.gpu.clone()).collect();
    let shaded = gpu.is_ok().then(|| ShadedReport::of_samples(found.iter().filter_map(|sample| sample.shaded.clone())));
    let strict = Bits::of_all(found.iter().filter_map(|sample| sample.strict.clone()));
    let meta = gpu.as_ref().ok().and_then(|metas| metas.first());
    let report = Report {
        schema_version: SCHEMA_VERSION,
        model: model.name(),
        notes: notes.iter().map(Note::to_string).collect(),
        technique: stage.plan.technique.name(),
        size: [viewport.width(), viewport.height()],
        adapter: meta.and_then(|m| m.adapter.clone()),
        driver: meta.and_then(|m| m.driver.clone()),
        triangles: stage.prepared.triangles(),
        approximation: drawn.as_ref().map(|drawn| drawn.facts),
        trim: stage.plan.trim.name(),
        masks: MaskReport::of(&stage),
        samples: &samples,
        pairs: &pairs,
        shaded: shaded.flatten(),
        strict,
        gpu_not_run: gpu.as_ref().err().filter(|_| !args.no_gpu).cloned(),
        undecided: found.iter().map(|sample| sample.undecided).sum(),
    };
    let rest = found.split_off(1);
    let mut pictures = found.remove(0).pictures;
    rest.into_iter().for_each(|sample| pictures.add_sample(sample.pictures));
    let differs = report.shaded.as_ref().is_some_and(|shaded| shaded.verdict == Verdict::Differ)
        || report.strict.as_ref().is_some_and(|strict| strict.unlike > 0);
    let code = match (&gpu, differs) {
        (Err(_), _) if !args.no_gpu => 2,
        (_, true) => 1,
        (_, false) => exit_code(&pairs),
    };
    let mut facts = vec![
        ("model hash", model.hash()),
        ("size", format!("{} x {} pixels", viewport.width(), viewport.height())),
        ("camera", serde_json::to_string(&camera)?),
        ("technique", report.technique.to_owned()),
        ("chord error", format!("{} px", stage.plan.chord_px)),
        ("triangles", report.triangles.to_string()),
        ("trims", report.trim.to_owned()),
        ("samples a pixel", samples.len().to_string()),
        ("adapter", report.adapter.clone().or(report.gpu_not_run.clone()).unwrap_or("left out by --no-gpu".to_owned())),
        ("driver", report.driver.clone().unwrap_or("—".to_owned())),
        ("undecided by the ray caster", report.undecided.to_string()),
        ("program", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    facts.extend(report.notes.iter().map(|note| ("note", note.clone())));
    let next = Next::new(&asked.model, &args.view, &args.drawing)?;
    let page = Page { model: model.name(), line: report.line(), code, facts, pairs: &pairs, viewport, next: &next };
    answer(args, &report, &pictures, &page, || table::print(&report, &next))?;
    Ok(ExitCode::from(code))
}

/// Renders and judges the samples, in the pattern's order; there is at least one. One renderer on the GPU draws all.
fn judged(args: &CompareArgs, stage: &Stage) -> Result<Vec<Sample>> {
    let caster = Caster::new(stage.truth()).with_edges(stage.plan.edges);
    let shading = args.shade.shading();
    let pattern = args.antialias.pattern();
    let device = match args.no_gpu {
        true => Err("--no-gpu leaves it out".to_owned()),
        false => gpu::Device::open(args.drawing.adapter.as_deref()).map_err(|error| error.to_string()),
    };
    let mut renderer = device
        .as_ref()
        .map_err(String::clone)
        .and_then(|device| stage.renderer(device, gpu::Overrides::default()).map_err(|error| error.to_string()));
    let count = pattern.positions().len();
    let bar = (count > 1).then(|| terminal::progress("samples", count));
    let mut found = vec![];
    for sample in stage.samples(pattern) {
        let gpu = match &mut renderer {
            Ok(renderer) => sample.drawn_by(renderer, Some(&shading)).map_err(|error| format!("{error:#}")),
            Err(why) => Err(why.clone()),
        };
        // One that is lost would be waited for again.
        if let Err(why) = &gpu {
            renderer = Err(why.clone());
        }
        let rendered = Rendered { raycast: sample.raycast(&caster), raster: sample.raster(), gpu };
        found.push(Sample::new(&sample, &caster, &rendered, &shading)?);
        bar.iter().for_each(|bar| bar.inc(1));
    }
    Ok(found)
}

impl Sample {
    fn new(stage: &Stage, caster: &Caster, rendered: &Rendered, shading: &Shading) -> Result<Self> {
        let Rendered { raycast, raster, gpu } = rendered;
        let gpu = gpu.as_ref();
        let buffers: Vec<&GBuffer> = [raycast, raster].into_iter().chain(gpu.ok().map(|gpu| &gpu.gbuffer)).collect();
        let mut pictures = Pictures::new(stage.model, &stage.camera, &buffers, shading)?;
        let mut shaded = None;
        if let Some((gbuffer, picture)) = gpu.ok().and_then(|gpu| Some((&gpu.gbuffer, gpu.shaded.as_ref()?))) {
            shaded = Some(stage.judge_shading(shading, gbuffer, picture)?);
            pictures.add("gpu-shaded-in-fragment", picture.clone());
        }
        let strict = gpu.ok().filter(|_| stage.plan.path == Path::Strict);
        Ok(Self {
            pairs: stage.compare(caster, rendered)?,
            shaded,
            strict: strict.map(|gpu| Bits::new(raster, &gpu.gbuffer)),
            pictures,
            undecided: raycast.undecided(),
            gpu: gpu.map(|gpu| gpu.gbuffer.meta().clone()).map_err(String::clone),
        })
    }
}

//! A run: each case rendered by ray caster and CPU rasterizer once, by each adapter, and compared in all pairs.

use crate::bits::Bits;
use crate::corpus::{Corpus, Scene, Suite, Viewpoint};
use crate::difference::Map;
use crate::embedded::data_uri;
use crate::progress::{progress, step};
use crate::report::{Case, Outcome, Pair, Report, SCHEMA, SCHEMA_VERSION, Source, Subject};
use crate::shard::Shard;
use crate::stage::{OnGpu, Path, Plan, Stage};
use crate::wrong::Vacuity;
use anyhow::{Context, Result};
use compare::PairReport;
use gbuffer::{GBuffer, ShadeKind, Shading};
use gpu::GpuError;
use gpu::capsule::Host;
use pipeline::Scheme;
use raycast::Caster;
use scene::Model;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Draws on an adapter. A trait, so that a test can lose one.
pub trait Adapter {
    /// What it says of itself.
    fn subject(&self) -> Subject;

    /// The G-buffer of a stage, with what was measured of the adapter.
    ///
    /// # Errors
    /// [`DrawError::Lost`] where nothing more can be drawn, else [`DrawError::Refused`].
    fn draw(&mut self, stage: &Stage) -> Result<OnGpu, DrawError>;
}

/// Why an adapter gave no G-buffer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DrawError {
    /// It is gone, and with it all that it has not drawn yet.
    Lost(String),
    /// It did not draw this one.
    Refused(String),
}

/// An adapter of this machine.
pub struct Gpu {
    device: gpu::Device,
}

impl Gpu {
    /// Opens the adapter whose name contains `name`, or the best one.
    ///
    /// # Errors
    /// As [`gpu::Device::open`].
    pub fn open(name: Option<&str>) -> Result<Self, GpuError> {
        Ok(Self { device: gpu::Device::open(name)? })
    }
}

impl Adapter for Gpu {
    fn subject(&self) -> Subject {
        let info = self.device.info();
        let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
        Subject {
            id: format!("{} | {driver} | {} | {}", info.name, info.backend, host()),
            name: info.name.clone(),
            kind: format!("{:?}", info.kind).to_lowercase(),
            driver,
            backend: info.backend.clone(),
            compiler: gpu::COMPILER.to_owned(),
            host: host(),
            failure: None,
        }
    }

    fn draw(&mut self, stage: &Stage) -> Result<OnGpu, DrawError> {
        let drawn = stage.gpu(&self.device, None, gpu::Overrides::default());
        drawn.map_err(|error| match error.downcast_ref::<GpuError>() {
            Some(GpuError::Lost { .. } | GpuError::Timeout { .. }) => DrawError::Lost(format!("{error:#}")),
            _ => DrawError::Refused(format!("{error:#}")),
        })
    }
}

/// What draws by a capsule, on a machine that is called `host`.
pub fn by_capsule(drawn_by: &Host, host: &str) -> Subject {
    let Host { adapter, driver, backend, compiler } = drawn_by.clone();
    Subject {
        id: format!("{adapter} | {driver} | {backend} | {host} | {compiler}"),
        name: adapter,
        kind: "other".to_owned(),
        driver,
        backend,
        compiler,
        host: host.to_owned(),
        failure: None,
    }
}

/// Operating system and processor family; the second alone where there is no such system, as in a browser.
pub fn host() -> String {
    let (system, family) = (std::env::consts::OS, std::env::consts::ARCH);
    if system.is_empty() { family.to_owned() } else { format!("{system}-{family}") }
}

/// What the CPU rasterizer is called, and how its identity begins.
pub const CPU: &str = "CPU rasterizer";

/// The CPU rasterizer.
fn cpu() -> Subject {
    Subject {
        id: format!("{CPU} | {}", host()),
        name: CPU.to_owned(),
        kind: "cpu".to_owned(),
        driver: String::new(),
        backend: String::new(),
        compiler: String::new(),
        host: host(),
        failure: None,
    }
}

/// An adapter that was asked for and is not there.
pub fn absent(wanted: &str, why: String) -> Subject {
    Subject {
        id: format!("{wanted} | {}", host()),
        name: wanted.to_owned(),
        kind: "absent".to_owned(),
        driver: String::new(),
        backend: String::new(),
        compiler: String::new(),
        host: host(),
        failure: Some(why),
    }
}

/// Pixels in which two G-buffers of one stage are not the same to the last bit; where one has a number that is none, so it is
/// not the same.
pub fn unlike(a: &GBuffer, b: &GBuffer) -> usize {
    a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

/// What to run: a suite, or a list of scenes treated as it treats its own.
pub struct Plans {
    /// The suite.
    pub suite: Suite,
    /// Its scenes, or those that a test takes.
    pub scenes: Vec<&'static Scene>,
    /// The part of them that is run.
    pub shard: Shard,
    /// How the GPU draws; by [`Path::Strict`] it must have the CPU rasterizer's bits.
    pub path: Path,
}

impl Plans {
    /// A report of this with nothing measured yet.
    pub fn report(&self, subjects: Vec<Subject>) -> Report {
        let subjects: Vec<Subject> = std::iter::once(cpu()).chain(subjects).collect();
        let started = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        let source = Source {
            shard: self.shard,
            host: host(),
            started_unix: started,
            subjects: subjects.iter().map(|subject| subject.id.clone()).collect(),
        };
        let corpus = self.corpus();
        Report {
            schema: SCHEMA.to_owned(),
            schema_version: SCHEMA_VERSION,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            suite: self.suite,
            path: self.path,
            shard: self.shard,
            sources: vec![source],
            corpus: corpus.hash,
            scenes: corpus.scenes,
            planned: corpus.cases.into_iter().map(|case| case.key).collect(),
            subjects,
            cases: vec![],
            notes: vec![],
        }
    }

    /// What a report of this, of any of its shards, must be of.
    pub fn corpus(&self) -> Corpus {
        Corpus::new(self.suite, &self.scenes, self.path)
    }

    /// The scenes of its shard.
    pub fn mine(&self) -> impl Iterator<Item = &'static Scene> {
        self.scenes.iter().enumerate().filter(|(place, _)| self.shard.holds(*place)).map(|(_, scene)| *scene)
    }

    /// What stands in the report for a scene whose model cannot be read.
    fn unread(&self, scene: &Scene, error: String) -> Case {
        Case {
            key: scene.unread(self.suite),
            size: [self.suite.side(); 2],
            options: scene.model.to_owned(),
            triangles: 0,
            undecided: 0,
            picture: None,
            error: Some(error),
            outcomes: vec![],
        }
    }

    /// Runs it, adding to `report` and handing it to `keep` after each viewpoint of a scene.
    ///
    /// An adapter that is lost is not asked again, and the report says so; the others go on. Where `stop` is set the
    /// run ends after the case at hand.
    ///
    /// # Errors
    /// Those of `keep`.
    pub fn run(
        &self,
        adapters: &mut [Box<dyn Adapter>],
        report: &mut Report,
        stop: &AtomicBool,
        keep: &mut dyn FnMut(&Report) -> Result<()>,
    ) -> Result<()> {
        let bar = progress("conform", report.expected().len());
        let mine: Vec<&'static Scene> = self.mine().collect();
        for (done, &scene) in mine.iter().enumerate() {
            step(format_args!("conform: scene {} of {}, {}", done + 1, mine.len(), scene.name));
            bar.set_message(scene.name);
            self.run_scene(scene, adapters, report, stop, &mut |report| {
                bar.set_position(report.cases.len() as u64);
                keep(report)
            })?;
            if stop.load(Ordering::Relaxed) {
                break;
            }
        }
        Ok(())
    }

    /// Runs one of its scenes, as [`Self::run`] does.
    ///
    /// # Errors
    /// Those of `keep`.
    pub fn run_scene(
        &self,
        scene: &'static Scene,
        adapters: &mut [Box<dyn Adapter>],
        report: &mut Report,
        stop: &AtomicBool,
        keep: &mut dyn FnMut(&Report) -> Result<()>,
    ) -> Result<()> {
        let model = match scene.open() {
            Ok(model) => model,
            Err(error) => {
                report.cases.push(self.unread(scene, error));
                return keep(report);
            }
        };
        let caster = Caster::new(&model);
        for &viewpoint in self.suite.viewpoints(scene) {
            let viewport = self.suite.viewport();
            let camera = viewpoint.camera(&model, viewport);
            let raycast = caster.render(&camera, viewport, &|_| {});
            for (number, plan) in self.suite.plans_by(scene, self.path).into_iter().enumerate() {
                let pictured = number == 0 && viewpoint == scene.viewpoints[0];
                // The judge looks at values, not at the program that they come of.
                let tries_wrong = self.suite == Suite::Full && plan.scheme == Scheme::Specialised;
                let case = Sitting { scene, model: &model, caster: &caster, raycast: &raycast, pictured, tries_wrong };
                case.judge(viewpoint, camera, plan, adapters, report);
                if stop.load(Ordering::Relaxed) {
                    return keep(report);
                }
            }
            keep(report)?;
        }
        Ok(())
    }
}

/// One case at work: what all renderers of it share.
struct Sitting<'a> {
    scene: &'static Scene,
    model: &'a Model,
    caster: &'a Caster<'a>,
    raycast: &'a GBuffer,
    /// Whether pictures are kept even where all agree.
    pictured: bool,
    /// Whether pictures made wrong of the CPU rasterizer's are judged, too.
    tries_wrong: bool,
}

impl Sitting<'_> {
    fn judge(
        &self,
        viewpoint: Viewpoint,
        camera: scene::Camera,
        plan: Plan,
        adapters: &mut [Box<dyn Adapter>],
        report: &mut Report,
    ) {
        let viewport = self.raycast.viewport();
        let mut case = Case {
            key: self.scene.key(viewpoint, plan),
            size: [viewport.width(), viewport.height()],
            options: self.scene.options(&camera, viewport, plan),
            triangles: 0,
            undecided: self.raycast.undecided(),
            picture: None,
            error: None,
            outcomes: vec![],
        };
        let plan = Plan { unbounded_share: self.scene.unbounded_share, ..plan };
        match Stage::new(self.model, camera, viewport, plan) {
            Err(error) => case.error = Some(format!("{error:#}")),
            Ok(stage) => {
                case.triangles = stage.prepared.triangles();
                let started = Instant::now();
                let raster = stage.raster();
                let mut outcome = self.outcome(&stage, &report.subjects[0].id, (&raster, None), None, started);
                if self.tries_wrong {
                    match Vacuity::of(&stage, self.caster, self.raycast, &raster) {
                        Ok(found) => outcome.wrong = Some(found),
                        Err(error) => outcome.error = Some(format!("{error:#}")),
                    }
                }
                let hash = |buffer: &GBuffer| (plan.path == Path::Strict).then(|| buffer.hash().to_string());
                outcome.hash = hash(&raster);
                case.outcomes.push(outcome);
                let leader = adapters.first().map(|adapter| adapter.subject().id);
                let mut first: Option<GBuffer> = None;
                for adapter in adapters {
                    let id = adapter.subject().id;
                    let subject = report.subjects.iter_mut().find(|s| s.id == id).expect("adapters are subjects");
                    if subject.failure.is_some() {
                        continue;
                    }
                    let started = Instant::now();
                    match adapter.draw(&stage) {
                        Ok(drawn) => {
                            let OnGpu { gbuffer: drawn, moves_px, .. } = drawn;
                            let outcome = self.outcome(&stage, &id, (&drawn, moves_px), Some(&raster), started);
                            let unlike = first.as_ref().map(|first| unlike(first, &drawn));
                            let bits = (plan.path == Path::Strict).then(|| Bits::new(&raster, &drawn));
                            case.outcomes.push(Outcome { unlike, bits, hash: hash(&drawn), ..outcome });
                            if leader.as_ref() == Some(&id) {
                                first = Some(drawn);
                            }
                        }
                        Err(DrawError::Refused(why)) => case.outcomes.push(Outcome {
                            subject: id,
                            seconds: started.elapsed().as_secs_f64(),
                            pairs: vec![],
                            wrong: None,
                            unlike: None,
                            bits: None,
                            hash: None,
                            picture: None,
                            error: Some(why),
                        }),
                        Err(DrawError::Lost(why)) => subject.failure = Some(format!("lost in {}: {why}", case.key)),
                    }
                }
                if case.outcomes.iter().any(|outcome| outcome.picture.is_some()) {
                    case.picture = self.shaded(&stage, self.raycast).ok();
                }
            }
        }
        report.cases.push(case);
    }

    /// Compares what a subject drew, and what was measured of it, with the ray caster and, for a GPU, with the CPU rasterizer.
    fn outcome(
        &self,
        stage: &Stage,
        subject: &str,
        (drawn, moves_px): (&GBuffer, Option<f64>),
        raster: Option<&GBuffer>,
        started: Instant,
    ) -> Outcome {
        let compared = || -> Result<Vec<(Pair, &GBuffer)>> {
            let against = stage.against_raycast_on(self.caster, self.raycast, drawn, moves_px)?;
            let mut pairs = vec![(self.pair(&against, self.raycast, drawn), self.raycast)];
            if let Some(raster) = raster {
                let against = stage.against_raster_on(raster, drawn, moves_px)?;
                pairs.push((self.pair(&against, raster, drawn), raster));
            }
            Ok(pairs)
        };
        let mut outcome = Outcome { subject: subject.to_owned(), ..Outcome::default() };
        match compared() {
            Err(error) => outcome.error = Some(format!("{error:#}")),
            Ok(pairs) => {
                let keeps = self.pictured || pairs.iter().any(|(pair, _)| !pair.agree);
                outcome.pairs = pairs
                    .into_iter()
                    .map(|(pair, reference)| {
                        let map = keeps
                            .then(|| data_uri(&Map::new(&stage.camera, reference, drawn).picture()).ok())
                            .flatten();
                        Pair { difference: map, ..pair }
                    })
                    .collect();
                outcome.picture = keeps.then(|| self.shaded(stage, drawn).ok()).flatten();
            }
        }
        outcome.seconds = started.elapsed().as_secs_f64();
        outcome
    }

    fn pair(&self, found: &PairReport, reference: &GBuffer, candidate: &GBuffer) -> Pair {
        Pair::new(found, reference, candidate)
    }

    /// The isophotes of a G-buffer.
    fn shaded(&self, stage: &Stage, buffer: &GBuffer) -> Result<String> {
        let shading = Shading::new(ShadeKind::Isophotes);
        data_uri(&buffer.shaded(&shading, self.model, &stage.camera).context("a picture")?)
    }
}

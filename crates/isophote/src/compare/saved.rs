//! `compare A.npz [B.npz]`: saved G-buffers, of our renderers or of foreign ones, against the ray caster and each other.
//!
//! The file says what it shows (model and its hash, camera, size) and how it was drawn (technique, trims). What it says of
//! itself can make its judge stricter, never milder: a technique and trims that allow more are the caller's to allow, the
//! reference is always cast here and now, and pixels marked undecided are judged like any.

use super::answer::{answer, exit_code};
use super::args::CompareArgs;
use super::pictures::Pictures;
use super::table;
use crate::antialias::Antialias;
use crate::say;
use crate::stage::{Plan, Rays, Stage};
use crate::terminal;
use crate::text::escaped;
use crate::view::ModelArgs;
use anyhow::{Context, Result, bail};
use compare::{Claims, Deviation, Judge, PairReport};
use gbuffer::{GBuffer, Meta, Trims};
use pipeline::PackedScene;
use pipeline::mask::{MaskOptions, MaskPlan, MaskQuality, Trimming};
use raycast::Caster;
use scene::{Camera, Model, Viewport};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What the ray caster calls itself in a G-buffer. A file of that name is judged like any, under [`SAVED_RAYCAST`].
const RAYCAST: &str = "raycast";

/// What a file is called that says it is the ray caster's: the reference is cast anew.
const SAVED_RAYCAST: &str = "raycast (saved)";

/// What the ray caster calls its technique.
const RAYS: &str = "rays";

/// The longest name of a renderer, characters.
const MAX_NAME: usize = 64;

/// A parameter may lie outside its domain by this share of the domain's larger end: half an ulp of f32, in which it may
/// have been written.
const DOMAIN_SLACK: f64 = 1.0 / (1u64 << 24) as f64;

/// One saved G-buffer.
pub struct SavedFile {
    /// Where it was read from.
    pub path: PathBuf,
    /// What it holds; its camera in the words of [`Camera`], so that two of one scene are equal.
    pub buffer: GBuffer,
    camera: Camera,
    /// Whether it says that one of our rasterizers drew it: their triangles can be made again.
    is_ours: bool,
}

/// One or two saved G-buffers of one scene.
pub struct Saved {
    /// What they show.
    pub model: Model,
    /// Who looks.
    pub camera: Camera,
    /// At how many pixels.
    pub viewport: Viewport,
    /// The files, in the order given.
    pub files: Vec<SavedFile>,
}

/// A comparison of saved files.
pub struct SavedComparison {
    /// The reference.
    pub cast: GBuffer,
    /// Each file against the reference, then the second against the first.
    pub pairs: Vec<PairReport>,
}

impl SavedFile {
    /// Reads a file and checks what it says of itself.
    ///
    /// # Errors
    /// Where it is no G-buffer, or its renderer or camera is not one; each message names the file.
    pub fn open(path: &Path) -> Result<Self> {
        let buffer = GBuffer::read_npz(path)?;
        let place = || path.display().to_string();
        let meta = buffer.meta();
        let name = &meta.renderer;
        if name.is_empty() || name.chars().count() > MAX_NAME || name.chars().any(char::is_control) {
            bail!("{}: meta's renderer {name:?} is not a name of 1 to {MAX_NAME} printable characters", place());
        }
        let camera = Camera::deserialize(&meta.camera).with_context(|| format!("{}: meta's camera", place()))?;
        let is_ours = matches!(name.as_str(), "raster" | "gpu");
        if let Trims::Masks { error_px } = meta.trims
            && !(error_px > 0.0 && error_px.is_finite())
        {
            bail!("{}: meta's trims: an error of masks of {error_px} px: it must be positive", place());
        }
        let renderer = if name == RAYCAST { SAVED_RAYCAST.to_owned() } else { name.clone() };
        let meta = Meta { camera: json!(camera), renderer, ..meta.clone() };
        Ok(Self { path: path.to_owned(), buffer: buffer.with_meta(meta), camera, is_ours })
    }

    fn place(&self) -> std::path::Display<'_> {
        self.path.display()
    }

    /// Every hit is on a face of the model and inside its domain.
    fn check_hits(&self, model: &Model) -> Result<()> {
        let width = self.buffer.viewport().width();
        for (pixel, hit) in self.buffer.pixels().enumerate().filter_map(|(i, hit)| Some((i, hit?))) {
            let (x, y, count) = (pixel % width, pixel / width, model.faces().len());
            let face = hit.face.0;
            if face as usize >= count {
                bail!("{}: face at pixel ({x}, {y}) is {face}; the model has {count}", self.place());
            }
            let domain = model.surface(hit.face).domain();
            for ((name, t), [start, end]) in [("u", hit.uv.x), ("v", hit.uv.y)].into_iter().zip(domain) {
                let slack = DOMAIN_SLACK * start.abs().max(end.abs());
                if t < start - slack || end + slack < t {
                    bail!(
                        "{}: {name} at pixel ({x}, {y}) is {t}, outside face {face}'s [{start}, {end}]",
                        self.place()
                    );
                }
            }
        }
        Ok(())
    }

    /// The plan with the trims that the file has.
    ///
    /// # Errors
    /// Where they are masks, and `masks_px` allows none or none as coarse.
    fn trimmed(&self, plan: Plan, masks_px: Option<f64>) -> Result<Plan> {
        let trim = match (self.buffer.meta().trims, masks_px) {
            (Trims::Exact, _) => Trimming::Exact,
            (Trims::Masks { error_px }, None) => bail!(
                "{}: its meta says that masks trim it, off by up to {error_px} px: --trim texture allows masks",
                self.place()
            ),
            (Trims::Masks { error_px }, Some(allowed)) if error_px > allowed => bail!(
                "{}: its masks may be off by {error_px} px, above the {allowed} px that are allowed: --mask-px allows more",
                self.place()
            ),
            (Trims::Masks { error_px: px }, Some(_)) => {
                Trimming::Texture(MaskOptions { quality: MaskQuality::Error { px }, ..MaskOptions::default() })
            }
        };
        if plan.vertex_normals {
            bail!(
                "--normals vertex is judged on triangles that are made here; a saved G-buffer is judged by the surface's own normals"
            );
        }
        Ok(Plan { trim, ..plan })
    }

    /// Whether its triangles are those that the plan makes.
    fn is_twin(&self, plan: Plan) -> bool {
        self.is_ours
            && self.buffer.meta().technique == plan.technique.name()
            && plan.technique.claims() == Claims::Chord
    }

    /// What this renderer is allowed against the surface itself; `twins` is the stage of our own rasterizers. By the plan's
    /// technique `exact` nobody is allowed a chord, whatever the file says.
    fn deviation(&self, saved: &Saved, plan: Plan, twins: Option<&Stage>) -> Result<Deviation> {
        let Saved { model, camera, viewport, .. } = saved;
        let meta = self.buffer.meta();
        let known = techniques::named(&meta.technique).map(|technique| technique.claims());
        let Some(claims) = known.or_else(|| (meta.technique == RAYS).then_some(Claims::OnRay)) else {
            let names: Vec<&str> = techniques::ALL.iter().map(|t| t.name()).chain([RAYS]).collect();
            bail!("{}: meta's technique {:?} is none of {}", self.place(), meta.technique, names.join(", "))
        };
        let twins = twins.filter(|_| self.is_twin(plan));
        let deviation = match (claims, plan.technique.claims(), twins) {
            (Claims::OnRay, ..) | (_, Claims::OnRay, _) => {
                Deviation { is_searched: known == Some(Claims::OnRay), ..Deviation::exact() }
            }
            (Claims::Chord, _, Some(stage)) => {
                Deviation::of_proxy(&stage.interpolation, stage.prepared.chord(), plan.chord_px)
            }
            (Claims::Chord, _, None) => Deviation::of_claimed_chord(model, camera, *viewport, plan.chord_px),
        };
        Ok(match meta.trims {
            Trims::Exact => deviation,
            Trims::Masks { error_px } => {
                Deviation { text: format!("{}; trim edges: masks within {error_px} px", deviation.text), ..deviation }
            }
        })
    }
}

/// The model that the file of this `meta` shows: `named`, or the built-in one that its `meta` names.
fn shown(path: &Path, meta: &Meta, named: Option<&str>) -> Result<Model> {
    let place = path.display();
    let model = match named {
        Some(name) => ModelArgs::named(name).open()?,
        None => models::builtin(&meta.model).with_context(|| {
            format!("{place}: its model {:?} is no built-in one; name its file by --model", meta.model)
        })?,
    };
    if model.hash() != meta.model_hash {
        let (name, hash, shown) = (model.name(), model.hash(), &meta.model_hash);
        bail!("{place}: it shows a model with hash {shown:?}; {name:?} has {hash:?}");
    }
    Ok(model)
}

impl Saved {
    /// Reads one or two files of one scene.
    ///
    /// # Errors
    /// Where a file is bad, does not show the model (`model`, or the built-in one that it names), or shows another model,
    /// size or view than the first.
    pub fn open(paths: &[PathBuf], model: Option<&str>) -> Result<Self> {
        // What a file says of itself comes first: its arrays may be a thousand times as long as the file.
        let facts = paths.iter().map(GBuffer::read_npz_meta).collect::<Result<Vec<(Meta, Viewport)>, _>>()?;
        let ((meta, viewport), path) =
            facts.first().zip(paths.first()).context("there is no saved G-buffer to compare")?;
        let (model, viewport) = (shown(path, meta, model)?, *viewport);
        for ((own, size), place) in facts.iter().zip(paths) {
            let differs = |what, own: String, firsts: String| {
                bail!("{}: its {what} {own} is not that of {}, {firsts}", place.display(), path.display())
            };
            if own.model_hash != meta.model_hash {
                return differs("model's hash", own.model_hash.clone(), meta.model_hash.clone());
            }
            if *size != viewport {
                let text = |v: Viewport| format!("{}x{}", v.width(), v.height());
                return differs("size", text(*size), text(viewport));
            }
        }
        let mut files = paths.iter().map(|path| SavedFile::open(path)).collect::<Result<Vec<SavedFile>>>()?;
        let first = &files[0];
        let camera = first.camera;
        for file in &files {
            if file.camera != camera {
                let [own, firsts] = [file, first].map(|file| file.buffer.meta().camera.to_string());
                bail!("{}: its camera {own} is not that of {}, {firsts}", file.place(), first.place());
            }
            file.check_hits(&model)?;
        }
        if let [a, b] = &mut files[..] {
            tell_apart(a, b)?;
        }
        Ok(Self { model, camera, viewport, files })
    }

    /// Judges each file against rays that are cast now, and the second against the first.
    ///
    /// Flat triangles are allowed the plan's chord error. Where both files are our own rasterizers', drawn by this
    /// very plan, they are compared as the twins that they are: of the same triangles. Trims are exact, or masks where
    /// `masks_px` allows them: as coarse as the file says, at most as coarse as that, pixels.
    ///
    /// # Errors
    /// Where a file's trims are not allowed, the chord error is not positive, or a technique is unknown.
    pub fn compare(&self, plan: Plan, masks_px: Option<f64>) -> Result<SavedComparison> {
        if plan.chord_px <= 0.0 || !plan.chord_px.is_finite() {
            bail!("a chord error of {} pixels: it must be positive", plan.chord_px);
        }
        let plans: Vec<Plan> = self.files.iter().map(|file| file.trimmed(plan, masks_px)).collect::<Result<_>>()?;
        let twins: Vec<Plan> =
            self.files.iter().zip(&plans).filter(|(file, _)| file.is_twin(plan)).map(|(_, plan)| *plan).collect();
        let stage = twins.first().map(|&plan| Stage::new(&self.model, self.camera, self.viewport, plan)).transpose()?;
        let deviations: Vec<Deviation> =
            self.files.iter().map(|file| file.deviation(self, plan, stage.as_ref())).collect::<Result<_>>()?;
        let caster = Caster::new(&self.model);
        let bar = terminal::progress(RAYCAST, self.viewport.height());
        let cast = caster.render(&self.camera, self.viewport, &|rows| bar.inc(rows as u64));
        let rays = Rays { caster: &caster, camera: self.camera, viewport: self.viewport };
        let scenes: Vec<PackedScene> = plans.iter().map(|plan| self.as_read(plan)).collect::<Result<_>>()?;
        let pair = |a: &GBuffer, b: &GBuffer, deviation: &Deviation, exact: bool, scene| -> Result<PairReport> {
            let judge = Judge::new(&self.model, &self.camera, self.viewport, scene);
            let judge = judge.with_unbounded_share(plan.unbounded_share);
            let what = format!("{} | {}", a.meta().renderer, b.meta().renderer);
            let bar = terminal::progress(&what, self.viewport.height());
            Ok(judge.pair(a, &rays, b, deviation, exact, &|rows| bar.inc(rows as u64))?)
        };
        let mut pairs = vec![];
        for ((file, deviation), scene) in self.files.iter().zip(&deviations).zip(&scenes) {
            pairs.push(pair(&cast, &file.buffer, deviation, true, scene)?);
        }
        if let ([a, b], [of_a, of_b]) = (&self.files[..], &deviations[..]) {
            pairs.push(match &stage {
                Some(stage) if twins.len() == 2 && twins[0] == twins[1] => {
                    stage.against_raster(&a.buffer, &b.buffer)?
                }
                _ => {
                    let error_px = |plan: &Plan| match plan.trim {
                        Trimming::Texture(MaskOptions { quality: MaskQuality::Error { px }, .. }) => px,
                        _ => 0.0,
                    };
                    let coarser = usize::from(error_px(&plans[1]) > error_px(&plans[0]));
                    pair(&a.buffer, &b.buffer, &of_a.either(of_b), false, &scenes[coarser])?
                }
            });
        }
        Ok(SavedComparison { cast, pairs })
    }
}

impl Saved {
    /// The model as a candidate's program reads it, its edges in the bands of the masks that it says it has. These are not
    /// drawn, so that a file's claim takes no memory.
    fn as_read(&self, plan: &Plan) -> Result<PackedScene> {
        let scene = PackedScene::new(&self.model, plan.scheme)?;
        if let Trimming::Texture(options) = plan.trim
            && let MaskQuality::Error { px } = options.quality
        {
            let options = MaskOptions { memory: u64::MAX, ..options };
            let masks = MaskPlan::new(&self.model, &self.camera, self.viewport, &options)?;
            return Ok(scene.in_bands_of(&masks, px));
        }
        Ok(scene)
    }
}

/// Gives two buffers of one renderer names by what they differ in: its adapter, technique, driver or version.
fn tell_apart(a: &mut SavedFile, b: &mut SavedFile) -> Result<()> {
    let [own, other] = [a.buffer.meta().clone(), b.buffer.meta().clone()];
    if own.renderer != other.renderer {
        return Ok(());
    }
    let facts = |meta: &Meta| {
        let text = |fact: &Option<String>| fact.clone().unwrap_or_default();
        [text(&meta.adapter), meta.technique.clone(), text(&meta.driver), meta.version.clone()]
    };
    let Some((mine, others)) = facts(&own).into_iter().zip(facts(&other)).find(|(x, y)| x != y) else {
        bail!("{} and {}: both come from the renderer {:?}, which is no check", a.place(), b.place(), own.renderer);
    };
    for (file, meta, fact) in [(a, own, mine), (b, other, others)] {
        let renderer = format!("{} ({})", meta.renderer, fact.escape_debug());
        file.buffer = file.buffer.clone().with_meta(Meta { renderer, ..meta });
    }
    Ok(())
}

#[derive(Serialize)]
struct Report<'a> {
    model: &'a str,
    model_hash: String,
    size: [usize; 2],
    files: Vec<FileReport<'a>>,
    /// Who looks, as the files say.
    camera: &'a Camera,
    /// What flat triangles were allowed, pixels.
    chord_px: f64,
    pairs: &'a [PairReport],
    /// Pixels that the ray caster could not decide.
    undecided: usize,
}

#[derive(Serialize)]
struct FileReport<'a> {
    file: String,
    renderer: &'a str,
    technique: &'a str,
    adapter: Option<&'a str>,
    driver: Option<&'a str>,
    version: &'a str,
    covered: usize,
}

/// Runs the command on saved files.
pub(super) fn run(args: &CompareArgs, files: &[&String]) -> Result<ExitCode> {
    if let Some(option) = args.view.given().or(args.drawing.adapter.as_ref().map(|_| "--adapter")) {
        bail!("{option} does not go with saved G-buffers, which bring their own camera, size and adapter");
    }
    if args.antialias != Antialias::None {
        bail!("--antialias does not go with saved G-buffers: each is one sample, by its camera's lens shift");
    }
    let paths: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
    let saved = Saved::open(&paths, args.of_model.as_deref())?;
    let plan = args.drawing.plan();
    let SavedComparison { cast, pairs } = saved.compare(plan, args.drawing.trim.masks_px())?;
    let buffers: Vec<&GBuffer> = std::iter::once(&cast).chain(saved.files.iter().map(|file| &file.buffer)).collect();
    let report = Report {
        model: saved.model.name(),
        model_hash: saved.model.hash(),
        size: [saved.viewport.width(), saved.viewport.height()],
        files: saved.files.iter().map(FileReport::new).collect(),
        camera: &saved.camera,
        chord_px: plan.chord_px,
        pairs: &pairs,
        undecided: cast.undecided(),
    };
    let pictures = Pictures::new(&saved.model, &saved.camera, &buffers, &args.shade.shading())?;
    answer(args, &report, &pictures, || print(&report))?;
    Ok(ExitCode::from(exit_code(&pairs)))
}

impl<'a> FileReport<'a> {
    fn new(file: &'a SavedFile) -> Self {
        let Meta { renderer, technique, adapter, driver, version, .. } = file.buffer.meta();
        Self {
            file: file.path.display().to_string(),
            renderer,
            technique,
            adapter: adapter.as_deref(),
            driver: driver.as_deref(),
            version,
            covered: file.buffer.covered(),
        }
    }
}

fn print(report: &Report) -> Result<()> {
    say!("{}, {}x{}", escaped(report.model), report.size[0], report.size[1])?;
    for FileReport { file, renderer, technique, adapter, version, covered, .. } in &report.files {
        let adapter = adapter.map_or(String::new(), |name| format!(" on {name:?}"));
        let [file, renderer, technique] = [file.as_str(), renderer, technique].map(escaped);
        say!("{file}: {renderer}{adapter}, technique {technique}, version {version:?}, {covered} pixels covered")?;
    }
    table::pairs(report.pairs)?;
    if report.undecided > 0 {
        say!("the ray caster left {} pixels undecided", report.undecided)?;
    }
    say!("{}", table::verdict(report.pairs, None, 0))
}

//! `compare A.npz [B.npz]`: saved G-buffers, of our renderers or of foreign ones, against the ray caster and each other.
//!
//! The file says what it shows (model and its hash, camera, size) and how it was drawn (technique, trims). What it says of
//! itself can make its judge stricter, never milder: a technique and trims that allow more are the caller's to allow, the
//! reference is always cast here and now, and pixels marked undecided are judged like any.

use super::answer::exit_code;
use super::verdict;
use crate::terminal;
use crate::view::ModelArgs;
use anyhow::{Context, Result, bail};
use compare::{Claims, Deviation, Diagnosis, Judge, PairReport, PixelVerdict, diagnose};
use gbuffer::{GBuffer, Meta, Trims};
use pipeline::PackedScene;
use pipeline::mask::{MaskOptions, MaskPlan, MaskQuality, Trimming};
use raycast::{Cast, Caster};
use scene::{Camera, Model, Viewport};
use serde::Deserialize;
use serde_json::json;
use std::path::{Path, PathBuf};
use suite::stage::{Plan, Rays, Stage};

/// What the ray caster calls itself in a G-buffer. A file of that name is judged like any, under [`SAVED_RAYCAST`].
const RAYCAST: &str = "raycast";

/// What a file is called that says it is the ray caster's: the reference is cast anew.
const SAVED_RAYCAST: &str = "raycast (saved)";

/// What the ray caster calls its technique.
const RAYS: &str = "rays";

/// Where no file is given.
const NOTHING: &str = "there is no saved G-buffer to compare";

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
    /// The renderer, where one drew both files: then the second is checked for regressions against the first.
    pub regression_of: Option<String>,
}

/// A comparison of saved files.
pub struct SavedComparison {
    /// The reference.
    pub cast: GBuffer,
    /// Each file against the reference, then the second against the first.
    pub pairs: Vec<PairReport>,
    /// Of each pair, the one fault that explains it, where one does.
    pub diagnoses: Vec<Option<Diagnosis>>,
}

/// One pixel of a saved file.
pub struct SavedPixel {
    /// What the ray through its centre says.
    pub cast: Cast,
    /// What is said of the file's.
    pub verdict: PixelVerdict,
    /// What the file is allowed there, in words.
    pub allowed: String,
}

impl SavedComparison {
    /// The answer in one plain line.
    pub fn line(&self) -> String {
        verdict::line(&self.pairs, &self.diagnoses, None, 0)
    }

    /// 0 where all pairs agree; 1 where some pixel differs, or too many have no verdict; 2 where no pair shows anything.
    pub fn exit_code(&self) -> u8 {
        exit_code(&self.pairs)
    }
}

impl SavedFile {
    /// Reads a file and checks what it says of itself.
    ///
    /// # Errors
    /// Where it is no G-buffer, or its renderer or camera is not one; each message names the file.
    pub fn open(path: &Path) -> Result<Self> {
        Self::of(path, GBuffer::read_npz(path)?)
    }

    /// Checks what a buffer says of itself; `path` is what messages call it.
    fn of(path: &Path, buffer: GBuffer) -> Result<Self> {
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
    fn deviation(&self, model: &Model, camera: &Camera, plan: Plan, twins: Option<&Stage>) -> Result<Deviation> {
        let viewport = self.buffer.viewport();
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
                let chord = stage.prepared.chord();
                Deviation::of_proxy(&stage.interpolation, chord, plan.chord_px).meeting(stage.prepared.seams())
            }
            (Claims::Chord, _, None) => Deviation::of_claimed_chord(model, camera, viewport, plan.chord_px),
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
    check_hash(path, meta, &model)?;
    Ok(model)
}

fn check_hash(path: &Path, meta: &Meta, model: &Model) -> Result<()> {
    if model.hash() != meta.model_hash {
        let (place, name, hash, shown) = (path.display(), model.name(), model.hash(), &meta.model_hash);
        bail!("{place}: it shows a model with hash {shown:?}; {name:?} has {hash:?}");
    }
    Ok(())
}

/// Whether all files show the first one's model at its size, by what they say of themselves.
fn check_facts(facts: &[(Meta, Viewport)], paths: &[PathBuf]) -> Result<()> {
    let Some(((meta, viewport), path)) = facts.first().zip(paths.first()) else { return Ok(()) };
    for ((own, size), place) in facts.iter().zip(paths) {
        let differs = |what, own: String, firsts: String| {
            bail!("{}: its {what} {own} is not that of {}, {firsts}", place.display(), path.display())
        };
        if own.model_hash != meta.model_hash {
            return differs("model's hash", own.model_hash.clone(), meta.model_hash.clone());
        }
        if size != viewport {
            let text = |v: &Viewport| format!("{}x{}", v.width(), v.height());
            return differs("size", text(size), text(viewport));
        }
    }
    Ok(())
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
        let ((meta, _), path) = facts.first().zip(paths.first()).context(NOTHING)?;
        let model = shown(path, meta, model)?;
        check_facts(&facts, paths)?;
        Self::of_files(model, paths.iter().map(|path| SavedFile::open(path)).collect::<Result<Vec<SavedFile>>>()?)
    }

    /// One or two buffers that are not in files, each with what messages call it.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn of_buffers(model: Model, buffers: Vec<(PathBuf, GBuffer)>) -> Result<Self> {
        let (paths, facts): (Vec<PathBuf>, Vec<(Meta, Viewport)>) =
            buffers.iter().map(|(path, buffer)| (path.clone(), (buffer.meta().clone(), buffer.viewport()))).unzip();
        for ((meta, _), path) in facts.iter().zip(&paths).take(1) {
            check_hash(path, meta, &model)?;
        }
        check_facts(&facts, &paths)?;
        let files = buffers.into_iter().map(|(path, buffer)| SavedFile::of(&path, buffer));
        Self::of_files(model, files.collect::<Result<Vec<SavedFile>>>()?)
    }

    /// Files of the model at one size, which may still differ in their cameras.
    fn of_files(model: Model, mut files: Vec<SavedFile>) -> Result<Self> {
        let first = files.first().context(NOTHING)?;
        let (camera, viewport) = (first.camera, first.buffer.viewport());
        for file in &files {
            if file.camera != camera {
                let [own, firsts] = [file, first].map(|file| file.buffer.meta().camera.to_string());
                bail!("{}: its camera {own} is not that of {}, {firsts}", file.place(), first.place());
            }
            file.check_hits(&model)?;
        }
        let renderers: Vec<String> = files.iter().map(|file| file.buffer.meta().renderer.clone()).collect();
        let regression_of = renderers.iter().skip(1).find(|name| **name == renderers[0]).cloned();
        if let [a, b] = &mut files[..] {
            tell_apart(a, b)?;
        }
        Ok(Self { model, camera, viewport, files, regression_of })
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
        let deviations: Vec<Deviation> = self
            .files
            .iter()
            .map(|file| file.deviation(&self.model, &self.camera, plan, stage.as_ref()))
            .collect::<Result<_>>()?;
        let caster = Caster::new(&self.model);
        let cast = self.cast(&caster, &self.camera);
        let rays = Rays { caster: &caster, camera: self.camera, viewport: self.viewport };
        let scenes: Vec<PackedScene> = plans.iter().map(|plan| self.as_read(plan)).collect::<Result<_>>()?;
        let share = plan.unbounded_share;
        let pair = |a: &GBuffer, b: &GBuffer, deviation: &Deviation, exact: bool, scene| {
            judged(&self.model, scene, &rays, (a, b), deviation, exact, share)
        };
        let (mut pairs, mut diagnoses) = (vec![], vec![]);
        for ((file, deviation), scene) in self.files.iter().zip(&deviations).zip(&scenes) {
            let report = pair(&cast, &file.buffer, deviation, true, scene)?;
            let again = |buffer: &GBuffer, camera: &Camera| {
                if *camera == self.camera {
                    return pair(&cast, buffer, deviation, true, scene);
                }
                let rays = Rays { caster: &caster, camera: *camera, viewport: self.viewport };
                let deviation = file.deviation(&self.model, camera, plan, None)?;
                judged(&self.model, scene, &rays, (&self.cast(&caster, camera), buffer), &deviation, true, share)
            };
            diagnoses.push(diagnose(&self.model, &self.camera, &file.buffer, &report, again)?);
            pairs.push(report);
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
        diagnoses.resize(pairs.len(), None);
        Ok(SavedComparison { cast, pairs, diagnoses })
    }

    /// What is said of pixel `at` of the first file against the one ray that is cast there, as [`Self::compare`] judges it.
    ///
    /// # Errors
    /// As of [`Self::compare`].
    pub fn pixel(&self, plan: Plan, masks_px: Option<f64>, at: [usize; 2]) -> Result<SavedPixel> {
        let file = self.files.first().context(NOTHING)?;
        let drawn = file.trimmed(plan, masks_px)?;
        let stage =
            file.is_twin(plan).then(|| Stage::new(&self.model, self.camera, self.viewport, drawn)).transpose()?;
        let deviation = file.deviation(&self.model, &self.camera, plan, stage.as_ref())?;
        let caster = Caster::new(&self.model);
        let rays = Rays { caster: &caster, camera: self.camera, viewport: self.viewport };
        let (cast, reference) = rays.alone(at, Meta::new(RAYCAST, RAYS, &self.model, &self.camera));
        let scene = self.as_read(&drawn)?;
        let judge = Judge::new(&self.model, &self.camera, self.viewport, &scene);
        let verdict = judge.pixel(&reference, &rays, &file.buffer, &deviation, true, at)?;
        Ok(SavedPixel { cast, verdict, allowed: deviation.text })
    }

    /// What rays see.
    fn cast(&self, caster: &Caster, camera: &Camera) -> GBuffer {
        let bar = terminal::progress(RAYCAST, self.viewport.height());
        caster.render(camera, self.viewport, &|rows| bar.inc(rows as u64))
    }

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

/// Judges the second of two pictures, against rays or against the first.
fn judged(
    model: &Model,
    scene: &PackedScene,
    rays: &Rays,
    (a, b): (&GBuffer, &GBuffer),
    deviation: &Deviation,
    exact: bool,
    unbounded_share: f64,
) -> Result<PairReport> {
    let judge = Judge::new(model, &rays.camera, rays.viewport, scene).with_unbounded_share(unbounded_share);
    let what = format!("{} | {}", a.meta().renderer, b.meta().renderer);
    let bar = terminal::progress(&what, rays.viewport.height());
    Ok(judge.pair(a, rays, b, deviation, exact, &|rows| bar.inc(rows as u64))?)
}

/// Gives two buffers of one renderer names by what they differ in: its adapter, technique, driver or version, else their files.
fn tell_apart(a: &mut SavedFile, b: &mut SavedFile) -> Result<()> {
    let [own, other] = [a.buffer.meta().clone(), b.buffer.meta().clone()];
    if own.renderer != other.renderer {
        return Ok(());
    }
    let facts = |meta: &Meta| {
        let text = |fact: &Option<String>| fact.clone().unwrap_or_default();
        [text(&meta.adapter), meta.technique.clone(), text(&meta.driver), meta.version.clone()]
    };
    let (mine, others) = match facts(&own).into_iter().zip(facts(&other)).find(|(x, y)| x != y) {
        Some(facts) => facts,
        None if a.path == b.path => {
            bail!("{} and {}: both come from the renderer {:?}, which is no check", a.place(), b.place(), own.renderer)
        }
        None => (a.place().to_string(), b.place().to_string()),
    };
    for (file, meta, fact) in [(a, own, mine), (b, other, others)] {
        let renderer = format!("{} ({})", meta.renderer, fact.escape_debug());
        file.buffer = file.buffer.clone().with_meta(Meta { renderer, ..meta });
    }
    Ok(())
}

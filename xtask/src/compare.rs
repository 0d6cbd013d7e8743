//! `compare`: render by all three, compare, and show a person the answer.

use crate::format::Format;
use crate::info::TRIM_NOTE;
use crate::stage::{Plan, Rendered, ShadedReport, Stage};
use crate::terminal;
use crate::view::{ModelArgs, ViewArgs};
use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use comfy_table::{Attribute, Cell, Color, Table, presets::UTF8_FULL_CONDENSED};
use compare::{PairReport, Verdict};
use gbuffer::{GBuffer, Picture, ShadeKind, Shading};
use pipeline::{DEFAULT_CHORD_PX, Scheme, Technique};
use raycast::Caster;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Pixels of the worst that the table lists for each pair.
const LISTED: usize = 8;

/// Render a model by the CPU rasterizer, the GPU and the ray caster, and compare the three
///
/// Exit code 0: all pairs agree; 1: some pixel differs; 2: something could not run (no adapter counts).
#[derive(Debug, Args)]
pub struct CompareArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    drawing: DrawingArgs,
    /// What the pictures show
    #[arg(long, value_enum, default_value = "isophotes")]
    shade: Shade,
    /// Write pictures, difference maps and report.json to this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// For people or for machines
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// How a model is drawn.
#[derive(Debug, Clone, Args)]
pub struct DrawingArgs {
    /// Where the surface is evaluated
    #[arg(long, value_enum, default_value = "fragment")]
    technique: TechniqueName,
    /// Programs of a few specialised degrees, or one for any
    #[arg(long, value_enum, default_value = "specialised")]
    scheme: SchemeName,
    /// Chord error of the tessellation, pixels
    #[arg(long, value_name = "PX", default_value_t = DEFAULT_CHORD_PX, allow_negative_numbers = true)]
    chord: f64,
    /// Part of the GPU adapter's name [default: a hardware one, else a software one]
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Where the surface is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TechniqueName {
    /// A coarse tessellation carries (u, v, face); each fragment evaluates the surface (Kanai 2007)
    Fragment,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SchemeName {
    /// Degrees 3, 5, 7 … 15; other faces are raised to the next
    Specialised,
    /// Each face its own degrees
    General,
}

/// A kind of shading, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Shade {
    /// A lit, slightly shiny body
    Phong,
    /// Bands of equal angle between normal and light
    Isophotes,
    /// Reflection lines
    Zebra,
    /// The normal's components as colours
    Normal,
    /// Squares over (u, v)
    Checker,
    /// A colour for each face
    Face,
    /// Gaussian curvature
    Gaussian,
    /// Mean curvature
    Mean,
}

impl Shade {
    /// The shading code of that name.
    pub fn shading(self) -> Shading {
        Shading::new(match self {
            Shade::Phong => ShadeKind::Phong,
            Shade::Isophotes => ShadeKind::Isophotes,
            Shade::Zebra => ShadeKind::Zebra,
            Shade::Normal => ShadeKind::Normal,
            Shade::Checker => ShadeKind::Checker,
            Shade::Face => ShadeKind::Face,
            Shade::Gaussian => ShadeKind::Gaussian,
            Shade::Mean => ShadeKind::Mean,
        })
    }
}

impl DrawingArgs {
    /// The same in the renderers' own words.
    pub fn plan(&self) -> Plan {
        let technique = match self.technique {
            TechniqueName::Fragment => Technique::Fragment,
        };
        let scheme = match self.scheme {
            SchemeName::Specialised => Scheme::Specialised,
            SchemeName::General => Scheme::General,
        };
        Plan { technique, scheme, chord_px: self.chord }
    }
}

#[derive(Serialize)]
struct Report<'a> {
    model: &'a str,
    technique: &'static str,
    size: [usize; 2],
    adapter: Option<&'a str>,
    driver: Option<&'a str>,
    triangles: usize,
    pairs: &'a [PairReport],
    /// The picture shaded in the GPU's fragment stage against the shading of its G-buffer.
    shaded: Option<ShadedReport>,
    /// Why the GPU did not run.
    gpu_not_run: Option<&'a str>,
    /// Pixels that the ray caster could not decide.
    undecided: usize,
    note: Option<&'static str>,
}

/// Runs the command.
///
/// # Errors
/// Where input is bad or a picture cannot be written.
pub fn run(args: &CompareArgs) -> Result<ExitCode> {
    let model = args.model.open()?;
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&model, viewport)?;
    let stage = Stage::new(&model, camera, viewport, args.drawing.plan())?;
    let caster = Caster::new(&model);
    let shading = args.shade.shading();
    let rendered = stage.render(&caster, args.drawing.adapter.as_deref(), Some(&shading));
    let pairs = stage.compare(&caster, &rendered)?;
    let shaded = match &rendered.gpu {
        Ok(gpu) => {
            let picture = gpu.shaded.as_ref().expect("a shading was asked for");
            Some(stage.judge_shading(&shading, &gpu.gbuffer, picture)?)
        }
        Err(_) => None,
    };
    let meta = rendered.gpu.as_ref().ok().map(|gpu| gpu.gbuffer.meta());
    let report = Report {
        model: model.name(),
        technique: stage.plan.technique.name(),
        size: [viewport.width(), viewport.height()],
        adapter: meta.and_then(|m| m.adapter.as_deref()),
        driver: meta.and_then(|m| m.driver.as_deref()),
        triangles: stage.proxy.triangles(),
        pairs: &pairs,
        shaded,
        gpu_not_run: rendered.gpu.as_ref().err().map(String::as_str),
        undecided: rendered.raycast.undecided(),
        note: model.is_trimmed().then_some(TRIM_NOTE),
    };
    let pictures = Pictures::new(&stage, &rendered, &shading)?;
    if let Some(folder) = &args.out {
        pictures.write(folder)?;
        let path = folder.join("report.json");
        std::fs::write(&path, serde_json::to_string_pretty(&report)?).with_context(|| path.display().to_string())?;
    }
    match args.format {
        Format::Json => println!("{}", serde_json::to_string(&report)?),
        Format::Table => {
            terminal::show(&Picture::beside(&pictures.views()));
            print(&report);
            if let Some(folder) = &args.out {
                println!("pictures and report.json are in {}", folder.display());
            }
        }
    }
    let agree = pairs.iter().all(|pair| pair.verdict == Verdict::Agree)
        && report.shaded.as_ref().is_none_or(|shaded| shaded.verdict == Verdict::Agree);
    Ok(match (&rendered.gpu, agree) {
        (Err(_), _) => ExitCode::from(2),
        (Ok(_), true) => ExitCode::SUCCESS,
        (Ok(_), false) => ExitCode::from(1),
    })
}

/// What a comparison shows: the renderers' pictures and the maps of their differences, by file name.
struct Pictures {
    named: Vec<(String, Picture)>,
    views: usize,
}

impl Pictures {
    fn new(stage: &Stage, rendered: &Rendered, shading: &Shading) -> Result<Self> {
        let buffers: Vec<&GBuffer> = [Some(&rendered.raycast), Some(&rendered.raster)]
            .into_iter()
            .chain([rendered.gpu.as_ref().ok().map(|gpu| &gpu.gbuffer)])
            .flatten()
            .collect();
        let mut named = vec![];
        for buffer in &buffers {
            named.push((buffer.meta().renderer.clone(), buffer.shaded(shading, stage.model, &stage.camera)?));
        }
        let views = named.len();
        if let Some(picture) = rendered.gpu.as_ref().ok().and_then(|gpu| gpu.shaded.clone()) {
            named.push(("gpu-shaded-in-fragment".to_owned(), picture));
        }
        for (i, a) in buffers.iter().enumerate() {
            for b in &buffers[i + 1..] {
                let name = format!("difference-{}-{}", a.meta().renderer, b.meta().renderer);
                named.push((name, difference(stage, a, b)));
            }
        }
        Ok(Self { named, views })
    }

    fn views(&self) -> Vec<&Picture> {
        self.named[..self.views].iter().map(|(_, picture)| picture).collect()
    }

    fn write(&self, folder: &Path) -> Result<()> {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        for (name, picture) in &self.named {
            picture.write_png(folder.join(format!("{name}.png")))?;
        }
        Ok(())
    }
}

/// How far apart two renderers' points are, across and along the ray, in pixels of the picture at that depth: false
/// colour from 10⁻⁶ to 1 pixel, logarithmic; magenta where only one of them sees anything.
pub fn difference(stage: &Stage, a: &GBuffer, b: &GBuffer) -> Picture {
    let viewport = stage.viewport;
    let value = |x: usize, y: usize| match (a.get(x, y), b.get(x, y)) {
        (None, None) => None,
        (Some(a), Some(b)) => {
            let depth = stage.camera.depth(a.position).max(stage.camera.near());
            let pixels =
                a.position.distance(b.position) * stage.camera.pixels_per_unit(viewport, depth.max(f64::MIN_POSITIVE));
            Some(pixels.max(1e-6).log10())
        }
        _ => Some(f64::NAN),
    };
    Picture::false_colour(viewport.width(), viewport.height(), value, [-6.0, 0.0])
}

fn print(report: &Report) {
    let adapter = match (report.adapter, report.gpu_not_run) {
        (Some(name), _) => format!("{name} ({})", report.driver.unwrap_or("driver unknown")),
        (None, Some(why)) => format!("NOT RUN: {why}"),
        (None, None) => "none".to_owned(),
    };
    println!(
        "{}, technique {}, {}x{}, {} triangles\ngpu: {adapter}",
        report.model, report.technique, report.size[0], report.size[1], report.triangles
    );
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "reference",
        "candidate",
        "covered",
        "agree",
        "differ",
        "full/partial/none",
        "across px (bound)",
        "along",
        "S / n / k of tolerance",
        "verdict",
    ]);
    for pair in report.pairs {
        let (text, colour) = match pair.verdict {
            Verdict::Agree => ("agree", Color::Green),
            Verdict::Differ => ("DIFFER", Color::Red),
        };
        let c = pair.coverage;
        table.add_row([
            Cell::new(&pair.reference),
            Cell::new(&pair.candidate),
            Cell::new(pair.covered),
            Cell::new(pair.agree),
            Cell::new(pair.differing()),
            Cell::new(format!("{}/{}/{}", c.full, c.partial, c.none)),
            Cell::new(format!("{:.5} (≤ {:.5})", pair.max_px, pair.bound_px)),
            Cell::new(format!("{:.2e}", pair.max_along)),
            Cell::new(format!("{:.2} / {:.2} / {:.2}", pair.position_share, pair.normal_share, pair.curvature_share)),
            Cell::new(text).fg(colour).add_attribute(Attribute::Bold),
        ]);
    }
    println!("{table}");
    for pair in report.pairs {
        println!("{} | {}: bound: {}", pair.reference, pair.candidate, pair.bounds);
        if pair.unbounded > 0 {
            println!("  {} pixels at poles, where f32 has no bound of the normal: counted, not judged", pair.unbounded);
        }
        for (cause, count) in &pair.causes {
            println!("  {count} pixels: {}", cause.label());
        }
        for pixel in pair.worst.iter().take(LISTED) {
            println!("    ({}, {}) {}: {}", pixel.x, pixel.y, pixel.cause.label(), pixel.detail);
        }
    }
    if let Some(shaded) = &report.shaded {
        let verdict = if shaded.verdict == Verdict::Agree { "agree" } else { "DIFFER" };
        let at = shaded.first.map_or(String::new(), |[x, y]| format!(", first at ({x}, {y})"));
        println!("shaded in the fragment stage: {} of {} pixels differ{at}: {verdict}", shaded.differ, shaded.covered);
    }
    if report.undecided > 0 {
        println!("the ray caster left {} pixels undecided", report.undecided);
    }
    if let Some(note) = report.note {
        println!("note: {note}");
    }
}

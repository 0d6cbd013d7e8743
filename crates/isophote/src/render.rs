//! `render`: one renderer, one picture or G-buffer.

use crate::antialias::Antialias;
use crate::approximate::ApproximateArgs;
use crate::compare::DrawingArgs;
use crate::curves;
use crate::lines::{ENDINGS, LineArgs, LineKind, Seen};
use crate::look::{LookArgs, Painter};
use crate::masks::MaskReport;
use crate::output;
use crate::overlay::Overlay;
use crate::say;
use crate::shadow::Ground;
use crate::terminal;
use crate::view::{ModelArgs, ViewArgs};
use crate::with::With;
use anyhow::{Result, bail};
use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use continuity::{Class, Settings, report};
use formats::Document;
use gbuffer::{GBuffer, Picture};
use raycast::Caster;
use scene::{Camera, Model, Viewport};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use suite::stage::{Plan, Stage};

/// Render a model to a picture, a G-buffer or the terminal
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  isophote render part.step --view iso --out part.png
  isophote render teapot --shade zebra --stripes 31 --out zebra.png
  isophote render part.step --section z=12.5 --out lines.svg")]
pub struct RenderArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    drawing: DrawingArgs,
    #[command(flatten)]
    approximate: ApproximateArgs,
    /// raster, gpu or raycast
    #[arg(long, help_heading = "Drawing", value_enum, default_value = "raster", hide_possible_values = true)]
    with: With,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    lines: LineArgs,
    /// Write a picture (.png, .jpg), numbers (.exr) or lines (.svg, .dxf)
    ///
    /// `-` is standard output, and a PNG picture; `-.svg` is it, too, and SVG, and so for each kind.
    ///
    /// EXR holds position, normal, curvatures, parameters and face of each pixel, in f32, whatever --shade says.
    ///
    /// Lines are curves on the surface itself, cut where they are hidden. SVG holds them as the picture shows them, in pixels, DXF in
    /// space, in model units. Folders on the way are made. What cannot be written is refused before anything is drawn.
    #[arg(long, help_heading = "Output", value_name = "X.png", allow_hyphen_values = true)]
    out: Option<PathBuf>,
    /// Smooth edges
    ///
    /// With 4, 8 or 16 a pixel is the mean of so many samples, in linear light; `trims` smooths trim edges alone, at one.
    #[arg(long, help_heading = "Output", value_enum, default_value = "none")]
    antialias: Antialias,
    /// Write the G-buffer to this NumPy file, or to standard output (`-`)
    ///
    /// With --antialias there is one a sample, X-0.npz, X-1.npz …, each with the lens shift of its sample in its camera, so
    /// that `compare` judges it by itself.
    #[arg(long, help_heading = "Output", value_name = "X.npz", allow_hyphen_values = true)]
    gbuffer: Option<PathBuf>,
    /// The shadow of the model on the ground below it [default: none]
    ///
    /// The ground is the plane z = least of the model. On a dark background it is hardly seen: --background white.
    #[arg(long, help_heading = "Shading", value_enum, hide_short_help = true)]
    shadow: Option<Shadow>,
    /// Draw over it: borders,parameters,trims,net,combs,sections,continuity
    ///
    /// `continuity` shows shared edges by their class: A is green, B blue, C orange, undecided purple, none red; free ones are grey. All
    /// others are the lines of --lines, bands and silhouettes among them, as far as they are seen.
    #[arg(
        long,
        help_heading = "Output",
        value_enum,
        value_delimiter = ',',
        value_name = "KIND,…",
        hide_possible_values = true
    )]
    overlay: Vec<Overlaid>,
}

/// The kinds of file that `--out` writes, by their endings.
const KINDS: [&str; 6] = ["png", "jpg", "jpeg", "exr", ENDINGS[0], ENDINGS[1]];

impl RenderArgs {
    /// Options that say nothing of the numbers of an EXR file are refused.
    fn check_numbers(&self) -> Result<()> {
        let of_pictures = self.look.given_of_pictures().or(self.overlay.first().map(|_| "--overlay"));
        match of_pictures.or((self.antialias != Antialias::None).then_some("--antialias")) {
            Some(option) => bail!("{option} goes with a picture, and .exr holds numbers"),
            None => Ok(()),
        }
    }
}

/// Where a shadow falls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Shadow {
    /// On the plane below the model
    Ground,
}

/// What is drawn over a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Overlaid {
    /// What `continuity` says of the edges
    Continuity,
    Lines(LineKind),
}

impl ValueEnum for Overlaid {
    fn value_variants<'a>() -> &'a [Self] {
        &[
            Self::Continuity,
            Self::Lines(LineKind::Borders),
            Self::Lines(LineKind::Parameters),
            Self::Lines(LineKind::Trims),
            Self::Lines(LineKind::Net),
            Self::Lines(LineKind::Combs),
            Self::Lines(LineKind::Sections),
            Self::Lines(LineKind::Silhouettes),
            Self::Lines(LineKind::Bands),
        ]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Self::Continuity => Some(PossibleValue::new("continuity").help("Shared edges by their class")),
            Self::Lines(kind) => kind.to_possible_value(),
        }
    }
}

impl Overlaid {
    fn of_lines(self) -> Option<LineKind> {
        match self {
            Self::Continuity => None,
            Self::Lines(kind) => Some(kind),
        }
    }
}

/// Runs the command.
///
/// # Errors
/// Where input is bad, there is no adapter, or a file cannot be written.
pub fn run(args: &RenderArgs) -> Result<()> {
    // Before a large file is read for nothing.
    args.look.check()?;
    let kind = args.out.as_deref().map(|path| output::kind(path, &KINDS)).transpose()?;
    let overlaid: Vec<LineKind> = args.overlay.iter().filter_map(|kind| kind.of_lines()).collect();
    args.lines.check(kind, &args.look, &overlaid)?;
    let lines = args.out.as_deref().zip(kind.filter(|kind| ENDINGS.contains(kind)));
    let numbers = args.out.as_deref().filter(|_| kind == Some("exr"));
    if lines.is_some() && (!args.overlay.is_empty() || args.antialias != Antialias::None) {
        bail!("--overlay and --antialias go with a picture, and --out is one of lines (--lines)");
    }
    if numbers.is_some() {
        args.check_numbers()?;
    }
    if args.shadow.is_some() && (lines.is_some() || numbers.is_some() || args.look.is_transparent()) {
        bail!("--shadow goes with a picture that has a background");
    }
    let is_jpeg = matches!(kind, Some("jpg" | "jpeg"));
    if is_jpeg && args.look.is_transparent() {
        bail!("--background transparent goes with PNG, and JPEG has no transparency");
    }
    if let Some(path) = &args.gbuffer {
        output::check(path, "npz")?;
        if output::is_standard(path) && args.out.as_deref().is_some_and(output::is_standard) {
            bail!("--out and --gbuffer both write to standard output");
        }
        if output::is_standard(path) && args.antialias.pattern().positions().len() > 1 {
            bail!("--gbuffer - is one G-buffer, and --antialias makes one a sample");
        }
    }
    let Document { model: original, unit, .. } = args.model.document()?;
    let opened = args.look.opened()?;
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&original, viewport)?;
    let drawn = args.approximate.drawn(&original, &camera, viewport)?;
    let model = drawn.as_ref().map_or(&original, |drawn| &drawn.model);
    if let Some(drawn) = &drawn {
        terminal::note(format_args!("{}", drawn.facts.line()));
    }
    let length = unit.as_ref().map_or("unit", |unit| &unit.name);
    let seen_by = Seen { model, camera: &camera, viewport, unit: length };
    if let Some((path, kind)) = lines {
        args.lines.write(path, kind, &args.look, &seen_by)?;
        if args.gbuffer.is_none() {
            return Ok(());
        }
    }
    let count = args.antialias.pattern().positions().len();
    let mut paths = args.gbuffer.as_ref().map(|path| files(path, count).into_iter());
    let painted = args.out.as_ref().filter(|_| lines.is_none() && numbers.is_none());
    let shows = painted.is_some() || (args.out.is_none() && args.gbuffer.is_none() && terminal::is_terminal());
    let bar = (count > 1).then(|| terminal::progress("samples", count));
    let by_class = shows && args.overlay.contains(&Overlaid::Continuity);
    let overlay = by_class.then(|| {
        let millimetres = unit.as_ref().map_or(1.0, |unit| unit.millimetres);
        let limits = Class::A.limits().in_units_of(millimetres);
        Overlay::of(&report(&original, Settings { millimetres, ..Settings::new(limits, &original) }))
    });
    let ground = args.shadow.filter(|_| shows).map(|Shadow::Ground| Ground::new(model, &camera));
    let (mut covered, mut open, mut pictures, mut painter) = (0, 0, vec![], None::<Painter>);
    let mut seen = vec![0u32; viewport.pixels()];
    each_sample(args, model, camera, viewport, |camera, buffer| {
        if let Some(path) = paths.as_mut().and_then(Iterator::next) {
            write_gbuffer(path.as_path(), &buffer)?;
        }
        if let Some(path) = numbers {
            let mut bytes = vec![];
            buffer.write_exr(&mut bytes)?;
            output::write(path, &bytes)?;
        }
        covered += buffer.covered();
        open += buffer.undecided();
        if shows {
            // A range that is found is that of the first sample.
            let painter = painter.get_or_insert_with(|| args.look.painter(&buffer, length, &opened));
            let mut picture = painter.painted(&buffer, model, camera)?;
            if let Some(ground) = &ground {
                picture = ground.shaded(&picture, &buffer, camera);
            }
            seen.iter_mut().zip(buffer.pixels()).for_each(|(seen, hit)| *seen += u32::from(hit.is_some()));
            let picture = if buffer.has_edges() { buffer.resolved(&picture, camera)? } else { picture };
            pictures.push(match &overlay {
                Some(overlay) => overlay.drawn(&picture, &buffer, camera)?,
                None => picture,
            });
        }
        bar.iter().for_each(|bar| bar.inc(1));
        Ok(())
    })?;
    drop(bar);
    if open > 0 {
        terminal::note(format_args!("warning: {open} pixels have no answer: their searches did not converge"));
    }
    if let Some(painter) = painter {
        let mut picture = Picture::average(&pictures)?;
        if !overlaid.is_empty() {
            let drawing = args.lines.drawing(&overlaid, &args.look, &seen_by)?;
            let drawn = curves::drawn_over(&picture, &drawing, &camera, viewport)?;
            // What leaves the model is there, too, where nothing is behind.
            let is_drawn = picture.rgb().iter().zip(drawn.rgb()).map(|(before, after)| before != after);
            seen.iter_mut().zip(is_drawn).filter(|(_, is_drawn)| *is_drawn).for_each(|(seen, _)| *seen = count as u32);
            picture = drawn;
        }
        match painted {
            Some(path) if is_jpeg => output::write(path, &painter.with_legend(&picture).jpeg()?)?,
            Some(path) => output::write(path, &painter.png(&picture, &seen, count)?)?,
            None => terminal::show(&painter.with_legend(&picture))?,
        }
    }
    if args.out.is_none() && args.gbuffer.is_none() {
        let samples = if count > 1 { format!(", {count} samples each,") } else { String::new() };
        say!(
            "{} of {} pixels{samples} covered (--out X.png or --gbuffer X.npz keeps them)",
            covered as f64 / count as f64,
            viewport.pixels()
        )?;
    }
    Ok(())
}

/// Gives the samples' cameras and G-buffers to `keep`, one after the other.
fn each_sample(
    args: &RenderArgs,
    model: &Model,
    camera: Camera,
    viewport: Viewport,
    mut keep: impl FnMut(&Camera, GBuffer) -> Result<()>,
) -> Result<()> {
    let pattern = args.antialias.pattern();
    let edges = args.antialias == Antialias::Trims;
    let stage = || {
        let stage = Stage::new(model, camera, viewport, Plan { edges, ..args.drawing.plan() })?;
        if let Some(note) = MaskReport::of(&stage).and_then(|masks| masks.note) {
            terminal::note(format_args!("note: {note}"));
        }
        anyhow::Ok(stage)
    };
    match args.with {
        With::Raster => stage()?.samples(pattern).try_for_each(|sample| keep(&sample.camera, sample.raster())),
        With::Gpu => {
            let device = gpu::Device::open(args.drawing.adapter.as_deref())?;
            let stage = stage()?;
            let mut renderer = stage.renderer(&device, gpu::Overrides::default())?;
            let mut draw = |sample: &Stage| anyhow::Ok(sample.drawn_by(&mut renderer, None)?.gbuffer);
            stage.samples(pattern).try_for_each(|sample| keep(&sample.camera, draw(&sample)?))
        }
        With::Raycast => {
            let caster = Caster::new(model).with_edges(edges);
            let cast = |camera: &Camera| {
                let bar = terminal::progress("raycast", viewport.height());
                caster.render(camera, viewport, &|rows| bar.inc(rows as u64))
            };
            pattern.cameras(&camera, viewport).iter().try_for_each(|camera| keep(camera, cast(camera)))
        }
    }
}

/// Writes a G-buffer to a file, or to standard output.
fn write_gbuffer(path: &Path, buffer: &GBuffer) -> Result<()> {
    match output::is_standard(path) {
        true => output::write(path, &buffer.npz_bytes()?),
        false => Ok(buffer.write_npz(path)?),
    }
}

/// A file a sample: the one that was named, or, of several samples, X-0.npz, X-1.npz and so on beside it.
fn files(path: &Path, count: usize) -> Vec<PathBuf> {
    if count == 1 {
        return vec![path.to_owned()];
    }
    let name = |part: Option<&OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    let (stem, extension) = (name(path.file_stem()), name(path.extension()));
    let dot = if extension.is_empty() { "" } else { "." };
    (0..count).map(|k| path.with_file_name(format!("{stem}-{k}{dot}{extension}"))).collect()
}

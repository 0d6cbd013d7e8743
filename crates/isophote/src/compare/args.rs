//! What is asked for: which pictures, and how they are drawn.

use crate::antialias::Antialias;
use crate::approximate::ApproximateArgs;
use crate::format::Format;
use crate::limits::LimitArgs;
use crate::masks::TrimArgs;
use crate::view::ViewArgs;
use crate::words::{self, Words};
use crate::{number, technique};
use clap::{Args, ValueEnum};
use compare::UNBOUNDED_SHARE;
use gbuffer::{ShadeKind, Shading};
use pipeline::Scheme;
use std::path::PathBuf;
use suite::stage::{Path, Plan};
use techniques::{DEFAULT_CHORD_PX, Technique};

/// Render a model three ways and compare, or judge saved G-buffers
///
/// The three are the CPU rasterizer, the GPU and the ray caster.
///
/// compare MODEL renders and compares. compare B.npz judges a saved G-buffer, of Isophote's or of a renderer of your
/// own (docs/gbuffer.md), against rays cast now; compare A.npz B.npz judges both, and B against A. Saved files bring their
/// camera and size; their model is the built-in one that they name, or --model. What they say of themselves allows them
/// nothing: --technique exact allows them no chord, and only --trim texture allows them masks.
///
/// compare A.step B.step measures two versions of a surface: at each pixel of A how far the nearest point of B is, in model units,
/// and by how much its tangent plane is turned (docs/versions.md).
///
/// With --antialias every sample of every pixel is rendered and judged, as strictly as a pixel's centre is; pixels count
/// once for each sample, and the pictures are the samples' mean.
///
/// Exit code 0: all pairs agree; 1: some pixel differs, too many have no verdict, or a version is beyond --within; 2: something
/// could not run (no adapter counts), or nobody shows anything.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  isophote compare part.step                    three renderers, one verdict
  isophote compare teapot --view top --out out  pictures and report.json, too
  isophote compare yours.npz                    judge a renderer of your own
  isophote compare old.step new.step            how far the new version is off
  isophote compare part.step --no-gpu           where there is no GPU to judge")]
pub struct CompareArgs {
    /// One or two models, by file or built-in name, or one or two saved G-buffers (.npz)
    ///
    /// `isophote info --list` names the built-in models.
    #[arg(value_name = "MODEL|FILE.npz", num_args = 1..=2, default_value = "teapot")]
    pub(super) subjects: Vec<String>,
    /// What saved G-buffers show, where that is no built-in model
    #[arg(long = "model", value_name = "MODEL")]
    pub(super) of_model: Option<String>,
    /// Refuse a file that is not drawn as it stands
    ///
    /// A face left out, a loop dropped and a wide gap closed are such.
    #[arg(long)]
    pub(super) strict: bool,
    /// How far the second of two models may be from the first, model units
    #[arg(long, value_name = "LENGTH", value_parser = number::not_negative, allow_hyphen_values = true)]
    pub(super) within: Option<f64>,
    #[command(flatten)]
    pub(super) view: ViewArgs,
    #[command(flatten)]
    pub(super) drawing: DrawingArgs,
    #[command(flatten)]
    pub(super) approximate: ApproximateArgs,
    /// What the pictures show
    #[arg(long, help_heading = "Output", value_enum, default_value = "isophotes")]
    pub(super) shade: Shade,
    /// Smooth the edges of faces, trims and colours
    ///
    /// Saved G-buffers have their sample in their camera's lens shift.
    #[arg(long, hide_short_help = true, value_enum, default_value = "none")]
    pub(super) antialias: Antialias,
    /// Leave the GPU out: rasterizer and rays alone decide the exit code
    #[arg(long, help_heading = "Drawing", conflicts_with = "adapter")]
    pub(super) no_gpu: bool,
    /// Write pictures, difference maps and report.json to this folder
    #[arg(long, help_heading = "Output", value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write one HTML page of pictures, maps and causes, or to standard output (`-`)
    ///
    /// It opens from disk and fetches nothing. The maps show what was judged: of each pixel the share that it uses of what it is
    /// allowed, and why it differs.
    #[arg(long, help_heading = "Output", value_name = "X.html")]
    pub(super) report: Option<PathBuf>,
    /// For people or for machines
    #[arg(long, help_heading = "Output", value_enum, default_value_t)]
    pub(super) format: Format,
}

/// How a model is drawn.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Drawing")]
pub struct DrawingArgs {
    /// Where the surface is evaluated
    #[arg(long, value_parser = technique::parser(), default_value = technique::default())]
    technique: &'static dyn Technique,
    /// Who finds the triangles on the GPU: its own rasterizer, or compute kernels with the CPU rasterizer's coverage to the bit
    #[arg(long, value_enum, default_value = "fragment", hide_short_help = true)]
    path: Path,
    /// Programs of a few specialised degrees, or one for any
    #[arg(long, hide_short_help = true, value_enum, default_value = "specialised")]
    scheme: SchemeName,
    #[command(flatten)]
    pub(crate) trim: TrimArgs,
    /// Chord error of the triangles, pixels
    ///
    /// Of a saved G-buffer, what its flat triangles are allowed.
    #[arg(long, hide_short_help = true, visible_alias = "error", value_name = "PX", default_value_t = DEFAULT_CHORD_PX, value_parser = number::error_px, allow_hyphen_values = true)]
    chord: f64,
    /// Where normals are evaluated: at each pixel, or at the corners of triangles and interpolated
    #[arg(long, hide_short_help = true, value_enum, default_value = "fragment")]
    normals: Normals,
    #[command(flatten)]
    limits: LimitArgs,
    /// The share of covered pixels that may have no verdict for want of a bound, as poles have none; from 0 to 1
    #[arg(long, hide_short_help = true, value_name = "SHARE", default_value_t = UNBOUNDED_SHARE, value_parser = number::share, allow_hyphen_values = true)]
    unbounded: f64,
    /// Part of the GPU adapter's name (`isophote adapters`)
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SchemeName {
    /// Degrees 3, 5, 7 … 15; other faces are raised to the next
    Specialised,
    /// Each face its own degrees
    General,
}

/// Where normals are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Normals {
    /// The surface's own at each pixel
    Fragment,
    /// Interpolated from the corners, with the flat triangle's point, as tessellators draw (Geiger, Concheiro)
    Vertex,
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
    /// Where the surface is evaluated.
    pub fn technique(&self) -> &'static dyn Technique {
        self.technique
    }

    /// The same with another technique.
    pub fn with_technique(self, technique: &'static dyn Technique) -> Self {
        Self { technique, ..self }
    }

    /// Those that are not what they are unless told, as they stand on a command line.
    ///
    /// # Errors
    /// None, as long as all have defaults.
    pub fn unusual(&self) -> Result<Vec<Words>, clap::Error> {
        #[derive(clap::Parser)]
        struct Alone {
            #[command(flatten)]
            drawing: DrawingArgs,
        }
        let usual = <Alone as clap::Parser>::try_parse_from(["isophote"])?.drawing.words();
        Ok(self.words().into_iter().filter(|words| !usual.contains(words)).collect())
    }

    /// As they stand on a command line.
    pub fn words(&self) -> Vec<Words> {
        let own = [
            words::option("--technique", self.technique.name()),
            words::named("--path", &self.path),
            words::named("--scheme", &self.scheme),
            words::numbers("--chord", &[self.chord]),
            words::named("--normals", &self.normals),
            words::numbers("--unbounded", &[self.unbounded]),
        ];
        let adapter = self.adapter.iter().map(|name| words::option("--adapter", name));
        own.into_iter().chain(self.trim.words()).chain(self.limits.words()).chain(adapter).collect()
    }

    /// The same in the renderers' own words.
    pub fn plan(&self) -> Plan {
        let scheme = match self.scheme {
            SchemeName::Specialised => Scheme::Specialised,
            SchemeName::General => Scheme::General,
        };
        Plan {
            technique: self.technique,
            path: self.path,
            scheme,
            chord_px: self.chord,
            trim: self.trim.trimming(),
            edges: false,
            vertex_normals: self.normals == Normals::Vertex,
            limits: self.limits.limits(),
            unbounded_share: self.unbounded,
        }
    }
}

//! Trimming from the command line: by curves or by masks, how fine masks are, and what is said of them.

use crate::number;
use crate::words::{self, Words};
use clap::{Args, ValueEnum};
use pipeline::mask::{MaskFill, MaskOptions, MaskQuality, Trimming};
use serde::Serialize;
use suite::stage::Stage;

/// How far a mask's edge may be off, pixels, unless told.
const DEFAULT_MASK_PX: f64 = 0.5;

/// How faces are trimmed.
#[derive(Debug, Clone, Args)]
pub struct TrimArgs {
    /// How the rasterizers trim faces, and saved G-buffers may [default: exact]
    #[arg(long, hide_short_help = true, value_enum)]
    trim: Option<TrimName>,
    /// With --trim texture: how far an edge may be off in the picture, from texels and chords together, pixels; of a saved
    /// G-buffer, the most that its masks may claim
    #[arg(long, hide_short_help = true, value_name = "PX", default_value_t = DEFAULT_MASK_PX, value_parser = number::error_px, allow_hyphen_values = true)]
    mask_px: f64,
    /// With --trim texture: the most memory of all masks together, MB of a million bytes; beyond it they are made coarser
    #[arg(long, hide_short_help = true, value_name = "MB", default_value_t = 256)]
    mask_memory: u32,
    /// With --trim texture: how the CPU draws masks
    #[arg(long, hide_short_help = true, value_enum, default_value = "even-odd")]
    mask_fill: FillName,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TrimName {
    /// Each fragment counts the curves that it passes (Schollmeyer & Fröhlich 2009)
    Exact,
    /// Each fragment looks into a mask drawn beforehand, on the GPU by triangle fans and parity (Guthe, Geiger)
    Texture,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FillName {
    /// All loops at once, by scan lines
    EvenOdd,
    /// Loop by loop, triangulated: outer ones filled with one, inner ones with zero (Wildcat)
    Earcut,
}

impl TrimArgs {
    /// How far off the masks of saved G-buffers may be, pixels; `None` where their trims must be exact.
    pub fn masks_px(&self) -> Option<f64> {
        (self.trim == Some(TrimName::Texture)).then_some(self.mask_px)
    }

    /// As they stand on a command line.
    pub fn words(&self) -> Vec<Words> {
        let own = [
            words::numbers("--mask-px", &[self.mask_px]),
            words::option("--mask-memory", self.mask_memory),
            words::named("--mask-fill", &self.mask_fill),
        ];
        self.trim.iter().map(|trim| words::named("--trim", trim)).chain(own).collect()
    }

    /// The same in the renderers' own words.
    pub fn trimming(&self) -> Trimming {
        match self.trim.unwrap_or(TrimName::Exact) {
            TrimName::Exact => Trimming::Exact,
            TrimName::Texture => Trimming::Texture(MaskOptions {
                quality: MaskQuality::Error { px: self.mask_px },
                memory: u64::from(self.mask_memory) * 1_000_000,
                fill: match self.mask_fill {
                    FillName::EvenOdd => MaskFill::EvenOdd,
                    FillName::Earcut => MaskFill::Earcut,
                },
            }),
        }
    }
}

/// What the masks of a stage are.
#[derive(Debug, Clone, Serialize)]
pub struct MaskReport {
    /// Trimmed faces.
    pub faces: usize,
    /// Columns and rows of the atlas, a byte each.
    pub atlas: [u32; 2],
    /// Chords of all curves.
    pub chords: u32,
    /// The greatest error of an edge, pixels.
    pub error_px: f64,
    /// What must be known of them: that they are coarser than was asked for.
    pub note: Option<String>,
}

impl MaskReport {
    /// Of a stage that trims by masks.
    pub fn of(stage: &Stage) -> Option<Self> {
        let plan = &stage.scene.masks()?.plan;
        let error_px = plan.error_px();
        let asked = match stage.plan.trim {
            Trimming::Texture(MaskOptions { quality: MaskQuality::Error { px }, .. }) => px,
            _ => f64::INFINITY,
        };
        // Sums of shares may come out an ulp above the whole.
        let note = (error_px > asked * (1.0 + 1e-12)).then(|| {
            format!(
                "masks are coarser than asked: edges may be off by {error_px:.2} px, not {asked} \
                 (--mask-memory bounds them all, 8191 texels a side each)"
            )
        });
        let faces = plan.tiles.iter().flatten().count();
        Some(Self { faces, atlas: plan.size, chords: plan.chords(), error_px, note })
    }

    /// In a line.
    pub fn line(&self) -> String {
        let [width, height] = self.atlas;
        format!(
            "masks of {} trimmed faces: atlas {width}x{height}, {} chords, edges within {:.3} px",
            self.faces, self.chords, self.error_px
        )
    }
}

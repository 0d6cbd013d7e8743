//! What is drawn and from where, from the command line.

use crate::number;
use crate::words::{self, Words};
use ::view::orbit::has_usual_near;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use formats::Document;
use glam::{DVec2, DVec3};
use scene::{Camera, Model, Projection, Viewport, escaped};

/// A model by name or file.
#[derive(Debug, Clone, Args)]
pub struct ModelArgs {
    /// A model file, or a built-in model's name (`isophote info --list`)
    #[arg(value_name = "MODEL", default_value = "teapot")]
    pub model: String,
    /// Refuse a file that is not drawn as it stands
    ///
    /// A face left out, a loop dropped and a wide gap closed are such.
    #[arg(long)]
    pub strict: bool,
}

/// Where the camera stands and what it fills.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Camera")]
pub struct ViewArgs {
    /// Frame the model from a side [default: the front right, above]
    ///
    /// The front is seen along +y, with z up; `iso` is seen along (−1, 1, −1).
    #[arg(long, value_enum, conflicts_with_all = ["azimuth", "elevation", "eye", "target", "up"])]
    pub view: Option<Side>,
    /// Frame the model from this angle about z: 0 the front, 90 the right side
    #[arg(long, value_name = "DEG", conflicts_with_all = ["eye", "target", "up"], value_parser = number::finite, allow_hyphen_values = true)]
    pub azimuth: Option<f64>,
    /// … and from this angle above the horizon, from −89 to 89
    ///
    /// Straight from above is `--view top`.
    #[arg(long, value_name = "DEG", conflicts_with_all = ["eye", "target", "up"], value_parser = number::elevation, allow_hyphen_values = true)]
    pub elevation: Option<f64>,
    /// Enlarge the middle of the picture so many times
    ///
    /// The field of view is narrowed, or the orthographic height divided; the eye stays.
    #[arg(long, value_name = "TIMES", conflicts_with = "fov", value_parser = number::positive, allow_hyphen_values = true)]
    pub zoom: Option<f64>,
    /// Where the camera stands
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], value_parser = number::finite, allow_hyphen_values = true)]
    pub eye: Option<Vec<f64>>,
    /// What it looks at [default: the centre of the model's box]
    #[arg(long, hide_short_help = true, num_args = 3, value_names = ["X", "Y", "Z"], value_parser = number::finite, allow_hyphen_values = true)]
    pub target: Option<Vec<f64>>,
    /// What points upward in the picture [default: z]
    #[arg(long, hide_short_help = true, num_args = 3, value_names = ["X", "Y", "Z"], value_parser = number::finite, allow_hyphen_values = true)]
    pub up: Option<Vec<f64>>,
    /// Field of view from bottom to top, degrees [default: 40]
    #[arg(long, value_name = "DEG", conflicts_with = "ortho", value_parser = number::field_of_view, allow_hyphen_values = true)]
    pub fov: Option<f64>,
    /// Orthographic view of this height, model units
    #[arg(long, value_name = "HEIGHT", value_parser = number::positive, allow_hyphen_values = true)]
    pub ortho: Option<f64>,
    /// Depth of the near plane, model units [default: 1/1024 of the distance to the target; 0 with --ortho]
    #[arg(long, hide_short_help = true, value_name = "DEPTH", value_parser = number::not_negative, allow_hyphen_values = true)]
    pub near: Option<f64>,
    /// The picture moved right and up in its own plane, in heights of the picture, as a photographer shifts a lens
    #[arg(long, hide_short_help = true, num_args = 2, value_names = ["RIGHT", "UP"], value_parser = number::finite, allow_hyphen_values = true)]
    pub lens_shift: Option<Vec<f64>>,
    /// Size of the picture, pixels [default: 512x512]
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
}

/// A side that a model is seen from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[expect(missing_docs, reason = "their names say it")]
pub enum Side {
    Front,
    Back,
    Top,
    Bottom,
    Left,
    Right,
    Iso,
}

impl Side {
    /// From the model to the eye.
    pub fn direction(self) -> DVec3 {
        match self {
            Self::Front => DVec3::NEG_Y,
            Self::Back => DVec3::Y,
            Self::Top => DVec3::Z,
            Self::Bottom => DVec3::NEG_Z,
            Self::Left => DVec3::NEG_X,
            Self::Right => DVec3::X,
            Self::Iso => DVec3::new(1.0, -1.0, 1.0),
        }
    }
}

/// From the model to an eye at these angles, radians: about z from the front, and above the horizon.
fn direction(azimuth: f64, elevation: f64) -> DVec3 {
    DVec3::new(azimuth.sin() * elevation.cos(), -azimuth.cos() * elevation.cos(), elevation.sin())
}

/// A projection that enlarges the picture's middle.
fn zoomed(projection: Projection, times: f64) -> Projection {
    match projection {
        // Exactly what was asked for where nothing is enlarged.
        _ if times == 1.0 => projection,
        Projection::Perspective { fov_deg } => {
            let tangent = (0.5 * fov_deg.to_radians()).tan() / times;
            Projection::Perspective { fov_deg: 2.0 * tangent.atan().to_degrees() }
        }
        Projection::Orthographic { height } => Projection::Orthographic { height: height / times },
    }
}

/// Notes that are printed before the rest is only counted; the JSON of `info` and `compare` lists all.
const PRINTED_NOTES: usize = 100;

impl ModelArgs {
    /// As they stand on a command line.
    pub fn words(&self) -> Vec<Words> {
        [vec![self.model.clone()]].into_iter().chain(words::flag("--strict", self.strict)).collect()
    }

    /// The model of that name or file, whatever is left out of it.
    pub fn named(model: &str) -> Self {
        Self { model: model.to_owned(), strict: false }
    }

    /// Opens the model, and prints on standard error what is to be known of how it was read.
    ///
    /// # Errors
    /// Where it is neither a built-in name nor a readable file; a file's error names the place and the value. With
    /// `strict`, where anything is lost or changed.
    pub fn open(&self) -> Result<Model> {
        Ok(self.document()?.model)
    }

    /// As [`Self::open`], with all that the file says.
    ///
    /// # Errors
    /// Those of [`Self::open`].
    pub fn document(&self) -> Result<Document> {
        let document = self.read()?;
        for note in document.notes.iter().take(PRINTED_NOTES) {
            eprintln!("note: {}: {note}", escaped(&self.model));
        }
        if PRINTED_NOTES < document.notes.len() {
            eprintln!("note: {}: and {} more", escaped(&self.model), document.notes.len() - PRINTED_NOTES);
        }
        if self.refuses(&document) {
            bail!(
                "{}: not drawn as it stands in the file, by the notes above, and --strict is given",
                escaped(&self.model)
            );
        }
        Ok(document)
    }

    /// Whether `strict` refuses a document: something is lost or changed.
    pub fn refuses(&self, document: &Document) -> bool {
        self.strict && document.notes.iter().any(|note| note.kind.is_loss())
    }

    /// As [`Self::document`], in silence, and whatever is left out of it.
    ///
    /// # Errors
    /// Where it is neither a built-in name nor a readable file.
    pub fn read(&self) -> Result<Document> {
        suite::named::document(&self.model)
    }
}

impl ViewArgs {
    /// Those that make exactly this camera, whatever the model.
    pub fn of(camera: &Camera, viewport: Viewport) -> Self {
        let vector = |v: DVec3| Some(v.to_array().to_vec());
        let (fov, ortho) = match camera.projection() {
            Projection::Perspective { fov_deg } => (Some(fov_deg), None),
            Projection::Orthographic { height } => (None, Some(height)),
        };
        let shift = camera.lens_shift();
        Self {
            view: None,
            azimuth: None,
            elevation: None,
            zoom: None,
            eye: vector(camera.eye()),
            target: vector(camera.target()),
            up: vector(camera.up()),
            fov,
            ortho,
            near: (!has_usual_near(camera)).then(|| camera.near()),
            lens_shift: (shift != DVec2::ZERO).then(|| shift.to_array().to_vec()),
            size: Some(format!("{}x{}", viewport.width(), viewport.height())),
        }
    }

    /// Those of several numbers.
    fn vectors(&self) -> [(&'static str, &Option<Vec<f64>>); 4] {
        [("--eye", &self.eye), ("--target", &self.target), ("--up", &self.up), ("--lens-shift", &self.lens_shift)]
    }

    /// Those of one number.
    fn numbers(&self) -> [(&'static str, Option<f64>); 6] {
        [
            ("--azimuth", self.azimuth),
            ("--elevation", self.elevation),
            ("--zoom", self.zoom),
            ("--fov", self.fov),
            ("--ortho", self.ortho),
            ("--near", self.near),
        ]
    }

    /// As they stand on a command line.
    pub fn words(&self) -> Vec<Words> {
        let side = self.view.iter().map(|side| words::named("--view", side));
        let vectors = self.vectors().into_iter().filter_map(|(name, v)| Some(words::numbers(name, v.as_ref()?)));
        let numbers = self.numbers().into_iter().filter_map(|(name, x)| Some(words::numbers(name, &[x?])));
        let size = self.size.iter().map(|size| words::option("--size", size));
        side.chain(vectors).chain(numbers).chain(size).collect()
    }

    /// The first of these options that was given.
    pub fn given(&self) -> Option<&'static str> {
        let vector = self.vectors().into_iter().find(|(_, v)| v.is_some()).map(|(name, _)| name);
        let number = self.numbers().into_iter().find(|(_, n)| n.is_some()).map(|(name, _)| name);
        vector.or(number).or(self.view.map(|_| "--view")).or(self.size.is_some().then_some("--size"))
    }

    /// The viewport.
    ///
    /// # Errors
    /// Where `--size` is not WxH or a side is not legal.
    pub fn viewport(&self) -> Result<Viewport> {
        let size = self.size.as_deref().unwrap_or("512x512");
        let (width, height) = size
            .split_once(['x', 'X'])
            .and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)))
            .with_context(|| format!("--size {size:?} is not WIDTHxHEIGHT, as in 512x512"))?;
        Ok(Viewport::new(width, height)?)
    }

    /// The camera that sees `model`.
    ///
    /// # Errors
    /// Where the values make no camera.
    pub fn camera(&self, model: &Model, viewport: Viewport) -> Result<Camera> {
        let vector = |v: &Option<Vec<f64>>| v.as_ref().map(|v| DVec3::new(v[0], v[1], v[2]));
        let framing = match (self.view, self.azimuth, self.elevation) {
            (Some(side), ..) => Camera::framing_from(model, viewport, side.direction())?,
            (None, None, None) => Camera::framing(model, viewport),
            (None, azimuth, elevation) => {
                let (azimuth, elevation) = (azimuth.unwrap_or(0.0), elevation.unwrap_or(0.0));
                Camera::framing_from(model, viewport, direction(azimuth.to_radians(), elevation.to_radians()))?
            }
        };
        let projection = match (self.fov, self.ortho) {
            (Some(fov_deg), _) => Projection::Perspective { fov_deg },
            (None, Some(height)) => Projection::Orthographic { height },
            (None, None) => framing.projection(),
        };
        let projection = zoomed(projection, self.zoom.unwrap_or(1.0));
        let eye = vector(&self.eye).unwrap_or(framing.eye());
        let target = vector(&self.target).unwrap_or_else(|| match self.eye {
            Some(_) => model.hull().center(),
            None => framing.target(),
        });
        let up = vector(&self.up).unwrap_or(match self.view {
            Some(Side::Top | Side::Bottom) => DVec3::Y,
            _ => DVec3::Z,
        });
        let shift = self.lens_shift.as_ref().map_or(DVec2::ZERO, |shift| DVec2::new(shift[0], shift[1]));
        let camera = Camera::look_at(eye, target, up, projection)?.with_lens_shift(shift)?;
        Ok(match self.near {
            Some(near) => camera.with_near(near)?,
            None => camera,
        })
    }
}

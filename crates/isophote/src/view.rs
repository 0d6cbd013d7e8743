//! What is drawn and from where, from the command line.

use crate::number;
use anyhow::{Context, Result, bail};
use clap::Args;
use formats::Document;
use glam::{DVec2, DVec3};
use scene::{Camera, Model, Projection, Viewport, escaped};
use std::path::Path;

/// A model by name or file.
#[derive(Debug, Clone, Args)]
pub struct ModelArgs {
    /// A model file or the name of a built-in model (see `isophote info --list`)
    #[arg(value_name = "MODEL", default_value = "teapot")]
    pub model: String,
    /// Refuse a file of which anything is not drawn as it stands there: a face left out, a loop dropped, a wide gap closed
    #[arg(long)]
    pub strict: bool,
}

/// Where the camera stands and what it fills.
#[derive(Debug, Clone, Args)]
pub struct ViewArgs {
    /// Where the camera stands; without it, the model is framed from the front right, above
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], value_parser = number::finite, allow_hyphen_values = true)]
    pub eye: Option<Vec<f64>>,
    /// What it looks at [default: the centre of the model's box]
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], value_parser = number::finite, allow_hyphen_values = true)]
    pub target: Option<Vec<f64>>,
    /// What points upward in the picture
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], value_parser = number::finite, allow_hyphen_values = true)]
    pub up: Option<Vec<f64>>,
    /// Full vertical field of view, degrees [default: 40]
    #[arg(long, value_name = "DEG", conflicts_with = "ortho", value_parser = number::field_of_view, allow_hyphen_values = true)]
    pub fov: Option<f64>,
    /// Orthographic view of this height, model units
    #[arg(long, value_name = "HEIGHT", value_parser = number::positive, allow_hyphen_values = true)]
    pub ortho: Option<f64>,
    /// Depth of the near plane, model units [default: 1/1024 of the distance to the target; 0 with --ortho]
    #[arg(long, value_name = "DEPTH", value_parser = number::not_negative, allow_hyphen_values = true)]
    pub near: Option<f64>,
    /// The picture moved right and up in its own plane, in heights of the picture, as a photographer shifts a lens
    #[arg(long, num_args = 2, value_names = ["RIGHT", "UP"], value_parser = number::finite, allow_hyphen_values = true)]
    pub lens_shift: Option<Vec<f64>>,
    /// Size of the picture in pixels [default: 512x512]
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
}

/// Notes that are printed before the rest is only counted; the JSON of `info` and `compare` lists all.
const PRINTED_NOTES: usize = 100;

impl ModelArgs {
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
        if let Some(model) = models::builtin(&self.model) {
            return Ok(Document::of_model(model));
        }
        let path = Path::new(&self.model);
        if !path.exists() && path.extension().is_none() && !self.model.contains(std::path::is_separator) {
            let names: Vec<&str> = models::all().map(|(name, _)| *name).collect();
            bail!("there is no built-in model {:?} (there are {}), and no such file", self.model, names.join(", "));
        }
        Ok(formats::open(path)?)
    }
}

impl ViewArgs {
    /// The first of these options that was given.
    pub fn given(&self) -> Option<&'static str> {
        let vectors =
            [("--eye", &self.eye), ("--target", &self.target), ("--up", &self.up), ("--lens-shift", &self.lens_shift)];
        let numbers = [("--fov", self.fov), ("--ortho", self.ortho), ("--near", self.near)];
        let vector = vectors.into_iter().find(|(_, v)| v.is_some()).map(|(name, _)| name);
        let number = numbers.into_iter().find(|(_, n)| n.is_some()).map(|(name, _)| name);
        vector.or(number).or(self.size.is_some().then_some("--size"))
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
        let framing = Camera::framing(model, viewport);
        let projection = match (self.fov, self.ortho) {
            (Some(fov_deg), _) => Projection::Perspective { fov_deg },
            (None, Some(height)) => Projection::Orthographic { height },
            (None, None) => framing.projection(),
        };
        let eye = vector(&self.eye).unwrap_or(framing.eye());
        let target = vector(&self.target).unwrap_or_else(|| match self.eye {
            Some(_) => model.hull().center(),
            None => framing.target(),
        });
        let up = vector(&self.up).unwrap_or(DVec3::Z);
        let shift = self.lens_shift.as_ref().map_or(DVec2::ZERO, |shift| DVec2::new(shift[0], shift[1]));
        let camera = Camera::look_at(eye, target, up, projection)?.with_lens_shift(shift)?;
        Ok(match self.near {
            Some(near) => camera.with_near(near)?,
            None => camera,
        })
    }
}

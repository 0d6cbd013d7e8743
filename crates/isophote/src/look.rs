//! What a picture shows, and how: shading, maps of numbers, highlight lines, and what is behind the model.
//!
//! `panel` has the same options as the controls of a window, `words` says which command line asks for them. What a surface mirrors is
//! an `environment` or a `pattern` (`mirror`); `lights` are those of a body for which no light is given.

mod by_view;
mod environment;
mod lights;
mod mirror;
mod panel;
mod pattern;
mod words;

pub use environment::Environment;
pub use pattern::Pattern;

use self::lights::lit;
use self::mirror::mirrored;
use self::pattern::Placed;
use crate::number;
use crate::versions::{Measured, Nearest};
use crate::view::ModelArgs;
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use gbuffer::{GBuffer, Lamps, Picture, Quantity, Scale, ShadeKind, Shading, background};
use glam::DVec3;
use lines::Family;
use scene::{Camera, Model};
use std::path::PathBuf;
use std::sync::Arc;

/// Stripes of a zebra, and lamps of highlight lines, unless told.
const DEFAULT_STRIPES: u32 = 17;

/// Colours that have a name here.
const COLOURS: [(&str, [u8; 3]); 4] = [("white", [255; 3]), ("black", [0; 3]), ("grey", [128; 3]), ("gray", [128; 3])];

/// What is shown, and how.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Shading")]
pub struct LookArgs {
    /// What the picture shows
    #[arg(long, value_enum, default_value = "isophotes")]
    shade: Look,
    /// Width of an isophote's band, degrees [default: 5]
    #[arg(long, value_name = "DEG", value_parser = number::positive, allow_hyphen_values = true)]
    bands: Option<f64>,
    /// Stripes of a zebra, or lamps of highlight lines [default: 17]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    stripes: Option<u32>,
    /// Turn stripes or lamps from upright in the picture, counterclockwise, degrees
    #[arg(long, hide_short_help = true, value_name = "DEG", value_parser = number::finite, allow_hyphen_values = true)]
    stripe_direction: Option<f64>,
    /// What a zebra mirrors [default: stripes]
    #[arg(long, hide_short_help = true, value_enum)]
    pattern: Option<Pattern>,
    /// What is around the model, for `reflection`: a panorama (.png, .jpg) [default: a studio]
    ///
    /// It holds all directions and is twice as wide as high: +y in the middle, +z on top.
    #[arg(long, hide_short_help = true, value_name = "FILE")]
    environment: Option<PathBuf>,
    /// Toward the light: right, up, to the viewer [default: -0.5 0.6 1, and for phong three lights]
    #[arg(long, hide_short_help = true, num_args = 3, value_names = ["X", "Y", "Z"], value_parser = number::finite, allow_hyphen_values = true)]
    light: Option<Vec<f64>>,
    /// The direction that a mould is pulled in, for `draft` [default: 0 0 1]
    #[arg(long, hide_short_help = true, num_args = 3, value_names = ["X", "Y", "Z"], value_parser = number::finite, allow_hyphen_values = true)]
    pull: Option<Vec<f64>>,
    /// The other version that `deviation` is measured to: a model file or built-in name
    #[arg(long, hide_short_help = true, value_name = "MODEL")]
    against: Option<String>,
    /// Range of a map of numbers: A:B, or `auto` [default: auto]
    ///
    /// `auto` reaches from the 5th to the 95th percentile of what is seen; where a sign has a meaning, as far below nought as
    /// above it.
    #[arg(long, value_name = "A:B", value_parser = range, allow_hyphen_values = true)]
    range: Option<Range>,
    /// Put a legend with numbers and their unit beside the picture
    #[arg(long)]
    legend: bool,
    /// What is behind the model: white, black, grey, #rrggbb or transparent
    #[arg(long, hide_short_help = true, value_name = "COLOUR", value_parser = behind)]
    background: Option<Behind>,
}

/// What a picture shows, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Look {
    /// A lit, slightly shiny body: in three lights, or in that of --light
    Phong,
    /// Bands of equal angle between normal and light
    Isophotes,
    /// Reflection lines
    Zebra,
    /// A mirror: a studio of light strips, or the panorama of --environment
    Reflection,
    /// Highlight lines: where normals meet lamps above the surface (Beier & Chen 1994)
    Highlight,
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
    /// The smaller radius of curvature
    MinRadius,
    /// The greater radius of curvature
    MaxRadius,
    /// The angle to the direction of --pull
    Draft,
    /// The distance to another version of the model (--against): above 0 on the normal's side
    Deviation,
}

/// A range that is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Range {
    Auto,
    Given([f64; 2]),
}

/// What is behind the model.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Behind {
    Colour([u8; 3]),
    Nothing,
}

fn range(text: &str) -> Result<Range, String> {
    if text == "auto" {
        return Ok(Range::Auto);
    }
    let ends = text.split_once(':').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    let ends = ends.filter(|[a, b]: &[f64; 2]| a.is_finite() && b.is_finite() && a < b);
    ends.map(Range::Given).ok_or("it is neither `auto` nor A:B with A below B, as in -0.1:0.1".to_owned())
}

fn behind(text: &str) -> Result<Behind, String> {
    let named = COLOURS.iter().find(|(name, _)| *name == text).map(|(_, colour)| *colour);
    let hex = || {
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
        let channel = |k: usize| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).ok();
        Some([channel(0)?, channel(1)?, channel(2)?])
    };
    match text {
        "transparent" => Ok(Behind::Nothing),
        _ => named.or_else(hex).map(Behind::Colour).ok_or_else(|| {
            let names: Vec<&str> = COLOURS.iter().map(|(name, _)| *name).collect();
            format!("it is none of {}, transparent, and no colour like #1a2b3c", names.join(", "))
        }),
    }
}

/// How pictures are painted.
#[derive(Clone)]
enum Kind {
    Shaded(Shading),
    Plotted(Quantity, Scale),
    Highlighted(Lamps),
    Deviating(Arc<Nearest>, Scale),
    /// In three lights.
    Lit,
    Mirroring(Arc<Environment>),
    Patterned(Shading, Pattern),
}

/// What is read before anything is drawn.
#[derive(Clone)]
pub struct Opened {
    /// The version that deviations are measured to, made ready.
    other: Option<Arc<Nearest>>,
    around: Arc<Environment>,
}

/// Paints G-buffers of one view.
#[derive(Clone)]
pub struct Painter {
    kind: Kind,
    behind: Option<Behind>,
    legend: bool,
    /// What the model's unit of length is called.
    length: String,
}

impl LookArgs {
    /// Options that say nothing of what is shown are refused, and so are values out of their domain.
    ///
    /// # Errors
    /// Which option, and what it goes with.
    pub fn check(&self) -> Result<()> {
        let is = |looks: &[Look]| self.goes(looks);
        let (striped, lit) = (self.is_striped(), self.is_lit());
        let mapped = self.is_mapped();
        for (given, goes, option, with) in [
            (self.bands.is_some(), is(&[Look::Isophotes]), "--bands", "isophotes"),
            (self.stripes.is_some(), striped, "--stripes", "zebra or highlight"),
            (self.stripe_direction.is_some(), striped, "--stripe-direction", "zebra or highlight"),
            (self.pattern.is_some(), is(&[Look::Zebra]), "--pattern", "zebra"),
            (self.environment.is_some(), is(&[Look::Reflection]), "--environment", "reflection"),
            (self.light.is_some(), lit, "--light", "phong, isophotes or highlight"),
            (self.pull.is_some(), is(&[Look::Draft]), "--pull", "draft"),
            (self.range.is_some(), mapped, "--range", "gaussian, mean, min-radius, max-radius, draft or deviation"),
            (self.against.is_some(), is(&[Look::Deviation]), "--against", "deviation"),
            (self.legend, mapped || is(&[Look::Isophotes]), "--legend", "isophotes or a map of numbers"),
        ] {
            if given && !goes {
                bail!("{option} goes with --shade {with}");
            }
        }
        if is(&[Look::Deviation]) && self.against.is_none() {
            bail!("--shade deviation goes with --against MODEL, the other version");
        }
        for (option, vector) in [("--light", &self.light), ("--pull", &self.pull)] {
            if vector.as_ref().is_some_and(|v| vector_of(v).try_normalize().is_none()) {
                bail!("{option}: the direction has no length");
            }
        }
        self.shading().map(|_| ())
    }

    /// The shading that a GPU has a program for; `None` where the picture is made of a G-buffer.
    pub fn shaded(&self) -> Option<Shading> {
        let is_in_three_lights = self.goes(&[Look::Phong]) && self.light.is_none();
        let is_made = self.goes(&[Look::Highlight, Look::Reflection]) || self.is_patterned() || is_in_three_lights;
        let is_plain = !self.is_mapped() && !is_made;
        let has_ground = matches!(self.background, Some(Behind::Colour(_)));
        self.shading().ok().filter(|_| is_plain && !has_ground)
    }

    /// Whether what is shown has bands, or lines, that can be drawn as curves.
    pub fn is_banded(&self) -> bool {
        self.goes(&[Look::Isophotes, Look::Zebra, Look::Highlight]) && !self.is_patterned()
    }

    /// Whether a zebra has another pattern than stripes.
    fn is_patterned(&self) -> bool {
        self.goes(&[Look::Zebra]) && !matches!(self.pattern, None | Some(Pattern::Stripes))
    }

    /// Whether a light can be given.
    pub fn is_lit(&self) -> bool {
        self.goes(&[Look::Phong, Look::Isophotes, Look::Highlight])
    }

    /// The same in another light; `light` is not nought.
    pub fn with_light(self, light: DVec3) -> Self {
        Self { light: Some(light.to_array().to_vec()), ..self }
    }

    /// The same options for something else to show; those that say nothing of it are gone.
    pub fn showing(self, shade: Look) -> Self {
        let look = Self { shade, ..self };
        let mapped = look.is_mapped();
        Self {
            bands: look.bands.filter(|_| look.goes(&[Look::Isophotes])),
            stripes: look.stripes.filter(|_| look.is_striped()),
            stripe_direction: look.stripe_direction.filter(|_| look.is_striped()),
            pattern: look.pattern.filter(|_| look.goes(&[Look::Zebra])),
            environment: look.environment.clone().filter(|_| look.goes(&[Look::Reflection])),
            light: look.light.clone().filter(|_| look.is_lit()),
            pull: look.pull.clone().filter(|_| look.goes(&[Look::Draft])),
            against: look.against.clone().filter(|_| look.goes(&[Look::Deviation])),
            // Of another quantity it would be a range of other numbers.
            range: None,
            legend: look.legend && (mapped || look.goes(&[Look::Isophotes])),
            ..look
        }
    }

    fn goes(&self, looks: &[Look]) -> bool {
        looks.contains(&self.shade)
    }

    fn is_striped(&self) -> bool {
        self.goes(&[Look::Zebra, Look::Highlight])
    }

    /// Whether another version is measured.
    pub fn is_measured(&self) -> bool {
        self.shade == Look::Deviation
    }

    /// Whether numbers are drawn.
    fn is_mapped(&self) -> bool {
        self.quantity().is_some() || self.is_measured()
    }

    /// Reads the other version and the panorama, as far as they are drawn.
    ///
    /// # Errors
    /// Where one cannot be opened.
    pub fn opened(&self) -> Result<Opened> {
        let name = self.against.as_deref().filter(|_| self.is_measured());
        let other = name.map(|name| anyhow::Ok(Arc::new(Nearest::new(ModelArgs::named(name).open()?)))).transpose()?;
        let around = self.environment.as_deref().map_or(Ok(Environment::Studio), Environment::open)?;
        Ok(Opened { other, around: Arc::new(around) })
    }

    /// How a view is painted of which `first` is seen; `length` names the model's unit, and `opened` is [`Self::opened`].
    pub fn painter(&self, first: &GBuffer, length: &str, opened: &Opened) -> Painter {
        let given = match self.range {
            Some(Range::Given(range)) => Some(range),
            Some(Range::Auto) | None => None,
        };
        let kind = match (self.quantity(), opened.other.as_ref().filter(|_| self.is_measured()), self.shade) {
            (Some(quantity), ..) => {
                Kind::Plotted(quantity, given.map_or_else(|| quantity.scale(first), |range| quantity.scaled(range)))
            }
            (None, Some(other), _) => {
                let found = || Measured::new(first, other, &|_| {}).deviations().into_iter().flatten();
                let scale = |range| Scale { range, is_signed: true };
                Kind::Deviating(other.clone(), given.map_or_else(|| Scale::of(found(), true), scale))
            }
            (None, None, Look::Phong) if self.light.is_none() => Kind::Lit,
            (None, None, Look::Reflection) => {
                // A window may show a reflection after the file's was left: then it is the studio's again.
                let around = self.environment.as_ref().map(|_| opened.around.clone());
                Kind::Mirroring(around.unwrap_or_else(|| Arc::new(Environment::Studio)))
            }
            (None, None, Look::Zebra) if self.is_patterned() => {
                let shading = self.shading().expect("`check` has looked at it");
                Kind::Patterned(shading, self.pattern.unwrap_or(Pattern::Stripes))
            }
            (None, None, Look::Highlight) => Kind::Highlighted(self.lamps()),
            (None, None, _) => Kind::Shaded(self.shading().expect("`check` has looked at it")),
        };
        Painter { kind, behind: self.background, legend: self.legend, length: length.to_owned() }
    }

    /// The lines at which what is shown has its borders, or that it is of; `None` of what has none.
    ///
    /// # Errors
    /// Where the light's direction is none.
    pub fn lines(&self, model: &Model, camera: &Camera) -> Result<Option<Family>> {
        Ok(match self.shade {
            Look::Isophotes => {
                let shading = self.shading()?;
                Some(Family::Isophotes { light: shading.light(camera), degrees: shading.band_borders() })
            }
            Look::Zebra if self.is_patterned() => None,
            Look::Zebra => {
                let shading = self.shading()?;
                Some(Family::Reflections { axis: shading.stripe_axis(camera), components: shading.stripe_borders() })
            }
            Look::Highlight => {
                let hung = self.lamps().hung(model, camera)?;
                Some(Family::Highlights { along: hung.along, lamps: hung.lamps })
            }
            _ => None,
        })
    }

    /// Whether nothing is behind the model.
    pub fn is_transparent(&self) -> bool {
        self.background == Some(Behind::Nothing)
    }

    /// What would not show in a drawing of lines.
    pub fn given_of_pictures(&self) -> Option<&'static str> {
        let given =
            [(self.range.is_some(), "--range"), (self.legend, "--legend"), (self.background.is_some(), "--background")];
        given.into_iter().find(|(is_given, _)| *is_given).map(|(_, option)| option)
    }

    fn lamps(&self) -> Lamps {
        Lamps {
            count: self.stripes.unwrap_or(DEFAULT_STRIPES),
            toward: self.light.as_deref().map_or(DVec3::new(0.0, 1.0, 1.0), vector_of),
            turn_rad: self.stripe_direction.unwrap_or(0.0).to_radians(),
        }
    }

    fn quantity(&self) -> Option<Quantity> {
        let pull = || self.pull.as_deref().map_or(DVec3::Z, vector_of).normalize_or_zero();
        match self.shade {
            Look::Gaussian => Some(Quantity::Gaussian),
            Look::Mean => Some(Quantity::Mean),
            Look::MinRadius => Some(Quantity::MinRadius),
            Look::MaxRadius => Some(Quantity::MaxRadius),
            Look::Draft => Some(Quantity::Draft { pull: pull() }),
            _ => None,
        }
    }

    /// The shading; of what is no shading, its default.
    fn shading(&self) -> Result<Shading> {
        let shading = Shading::new(match self.shade {
            Look::Phong => ShadeKind::Phong,
            Look::Zebra => ShadeKind::Zebra,
            Look::Normal => ShadeKind::Normal,
            Look::Checker => ShadeKind::Checker,
            Look::Face => ShadeKind::Face,
            _ => ShadeKind::Isophotes,
        });
        let shading = self.bands.map_or(Ok(shading), |bands| shading.with_band_deg(bands))?;
        let shading = self.light.as_deref().map_or(Ok(shading), |light| shading.with_light(vector_of(light)))?;
        let shading = self.stripes.map_or(Ok(shading), |stripes| shading.with_stripes(stripes))?;
        Ok(shading.with_stripes_turned(self.stripe_direction.unwrap_or(0.0).to_radians()))
    }
}

fn vector_of(v: &[f64]) -> DVec3 {
    DVec3::from_slice(v)
}

impl Painter {
    /// The picture of a buffer.
    ///
    /// # Errors
    /// Where it shows a face that the model does not have.
    pub fn painted(&self, buffer: &GBuffer, model: &Model, camera: &Camera) -> Result<Picture> {
        let picture = match &self.kind {
            Kind::Shaded(shading) => buffer.shaded(shading, model, camera)?,
            Kind::Plotted(quantity, scale) => buffer.plotted(*quantity, *scale),
            Kind::Deviating(other, scale) => {
                buffer.coloured(&Measured::new(buffer, other, &|_| {}).deviations(), *scale)
            }
            Kind::Highlighted(lamps) => buffer.highlighted(lamps, model, camera)?,
            Kind::Lit => lit(buffer, camera)?,
            Kind::Mirroring(around) => mirrored(buffer, camera, |toward| around.colour(toward))?,
            Kind::Patterned(shading, pattern) => {
                let across = shading.stripe_axis(camera);
                let axes = [across, across.cross(camera.forward()).normalize_or_zero()];
                let placed = Placed { pattern: *pattern, axes, count: shading.stripe_borders().len() as f64 + 1.0 };
                mirrored(buffer, camera, |toward| placed.colour(toward))?
            }
        };
        Ok(match self.behind {
            Some(Behind::Colour(colour)) => picture.recoloured(colour, |x, y| buffer.get(x, y).is_none()),
            Some(Behind::Nothing) | None => picture,
        })
    }

    /// The legend of a picture of that height, where one is asked for.
    pub fn legend(&self, height: usize) -> Option<Picture> {
        match &self.kind {
            _ if !self.legend => None,
            Kind::Shaded(shading) => shading.legend(height),
            Kind::Plotted(quantity, scale) => Some(scale.legend(&quantity.unit(&self.length), height)),
            Kind::Deviating(_, scale) => Some(scale.legend(&self.length, height)),
            Kind::Highlighted(_) | Kind::Lit | Kind::Mirroring(_) | Kind::Patterned(..) => None,
        }
    }

    /// The range of a map of numbers.
    pub fn range(&self) -> Option<[f64; 2]> {
        match &self.kind {
            Kind::Plotted(_, scale) | Kind::Deviating(_, scale) => Some(scale.range),
            _ => None,
        }
    }

    /// A picture with its legend to the right, where one is asked for.
    pub fn with_legend(&self, picture: &Picture) -> Picture {
        let legend = self.legend(picture.height());
        Picture::beside(&[picture].into_iter().chain(&legend).collect::<Vec<_>>())
    }

    /// The bytes of the PNG file of a picture with its legend. `seen` says in how many of its `samples` each pixel shows the
    /// model: with nothing behind it, it is as opaque as that.
    ///
    /// # Errors
    /// Where it is too large for the format.
    pub fn png(&self, picture: &Picture, seen: &[u32], samples: usize) -> Result<Vec<u8>> {
        let whole = self.with_legend(picture);
        if self.behind != Some(Behind::Nothing) {
            return Ok(whole.png(None)?);
        }
        let opaque = |i: usize| {
            let (x, y) = (i % whole.width(), i / whole.width());
            let is_model = x < picture.width() && y < picture.height();
            let share = |seen: u32| (255.0 * f64::from(seen) / samples as f64).round() as u8;
            if is_model { share(seen[y * picture.width() + x]) } else { 255 }
        };
        let alpha: Vec<u8> = (0..whole.width() * whole.height()).map(opaque).collect();
        Ok(whole.png(Some((&alpha, background())))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_colours_are_read_or_refused() {
        assert_eq!(range("auto"), Ok(Range::Auto));
        assert_eq!(range("-0.5:1e-3"), Ok(Range::Given([-0.5, 1e-3])));
        for text in ["1:1", "2:1", "nan:1", "0:inf", "1", ":", ""] {
            assert!(range(text).is_err(), "{text}");
        }
        assert_eq!(behind("#0a14ff"), Ok(Behind::Colour([10, 20, 255])));
        assert_eq!((behind("white"), behind("transparent")), (Ok(Behind::Colour([255; 3])), Ok(Behind::Nothing)));
        for text in ["#12345", "#1234567", "#gggggg", "puce", "", "#äöü"] {
            assert!(behind(text).is_err(), "{text}");
        }
    }
}

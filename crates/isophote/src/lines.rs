//! `render --out X.svg` and `X.dxf`: lines on the surfaces as curves, in the place of a picture.

use crate::look::LookArgs;
use crate::sight::Sight;
use crate::terminal;
use crate::{number, output};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use glam::DVec3;
use lines::{Drawing, Family, combs, draw, dxf, net, svg};
use scene::{Camera, Model, Viewport};
use std::path::Path;

/// Notes of lines that were not followed to their ends; the rest is counted.
const PRINTED_NOTES: usize = 10;

/// Which lines are drawn.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub struct LineArgs {
    /// bands,silhouettes,borders (the default),sections,net and more
    ///
    /// The kinds are bands, silhouettes, borders, sections, parameters, trims, net and combs.
    /// Bands are the borders of isophote bands or of zebra stripes, and the middles of highlight lines, as --shade says. Silhouettes
    /// are where the surface turns away, borders where faces end, trim loops too. Sections are drawn where --section is given.
    /// Parameters are lines of equal u and of equal v (--parameters). Trims are the loops of trimmed faces alone. The net is of
    /// control points. Combs show the curvature of sections, or of borders where there is no --section; the net and combs hide
    /// nothing and are not hidden.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "KIND,…", hide_possible_values = true)]
    lines: Vec<LineKind>,
    /// A plane that cuts, as z=1.5 or NX,NY,NZ:DISTANCE
    ///
    /// It may be given several times. The distance is from the origin along the normal. A picture shows it with --overlay sections or
    /// combs.
    #[arg(long, value_name = "PLANE", value_parser = plane, allow_hyphen_values = true)]
    section: Vec<Plane>,
    /// Lines of equal u, and as many of equal v, on each face [default: 9]
    #[arg(long, alias = "isoparams", hide_short_help = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    parameters: Option<u32>,
    /// Draw what is hidden, too: dashed
    ///
    /// In DXF it is on layers of its own.
    #[arg(long)]
    hidden: bool,
}

/// A kind of lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LineKind {
    /// What --shade is of: borders of isophote bands or stripes, middles of highlights
    Bands,
    /// Where the surface turns away
    Silhouettes,
    /// Where faces end, trim loops too
    Borders,
    /// Where the planes of --section cut
    Sections,
    /// Lines of equal u and of equal v
    #[value(alias = "isoparams")]
    Parameters,
    /// The loops of trimmed faces
    Trims,
    /// Rows and columns of control points
    Net,
    /// Curvature of sections, or of borders, as teeth
    Combs,
}

/// A model, and who looks.
#[derive(Clone, Copy)]
pub struct Seen<'a> {
    /// The model.
    pub model: &'a Model,
    /// Who looks.
    pub camera: &'a Camera,
    /// At how many pixels.
    pub viewport: Viewport,
    /// What the model's unit of length is called.
    pub unit: &'a str,
}

/// n · P = distance.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plane {
    /// Of unit length.
    normal: DVec3,
    /// Model units.
    distance: f64,
}

fn plane(text: &str) -> Result<Plane, String> {
    let axis = |text: &str| match text {
        "x" => Some(DVec3::X),
        "y" => Some(DVec3::Y),
        "z" => Some(DVec3::Z),
        _ => None,
    };
    let along_axis = || {
        let (name, value) = text.split_once('=')?;
        Some(Plane { normal: axis(name)?, distance: number::finite(value).ok()? })
    };
    let general = || {
        let (normal, distance) = text.split_once(':')?;
        let normal: Vec<f64> = normal.split(',').map(|x| number::finite(x).ok()).collect::<Option<_>>()?;
        let normal = (normal.len() == 3).then(|| DVec3::from_slice(&normal))?.try_normalize()?;
        Some(Plane { normal, distance: number::finite(distance).ok()? })
    };
    along_axis().or_else(general).ok_or("it is neither like z=1.5 nor like 0,0.6,0.8:1.5".to_owned())
}

/// The endings of files that hold lines.
pub const ENDINGS: [&str; 2] = ["svg", "dxf"];

impl LineArgs {
    /// Options that say nothing of a kind of file are refused.
    ///
    /// # Errors
    /// Which option, and what it goes with.
    pub fn check(&self, kind: Option<&str>, look: &LookArgs, overlaid: &[LineKind]) -> Result<()> {
        let Some(ending) = kind.filter(|kind| ENDINGS.contains(kind)) else {
            let given = [(!self.lines.is_empty(), "--lines"), (self.hidden, "--hidden")];
            if let Some((_, option)) = given.iter().find(|(is_given, _)| *is_given) {
                bail!("{option} goes with --out X.svg or --out X.dxf");
            }
            return self.check_planes(overlaid, "--overlay");
        };
        if let Some(option) = look.given_of_pictures() {
            bail!("{option} goes with a picture, and .{ending} holds lines");
        }
        self.check_planes(&self.kinds(look), "--lines")
    }

    /// Planes and numbers of lines go with what is made of them; `option` names the kinds.
    fn check_planes(&self, kinds: &[LineKind], option: &str) -> Result<()> {
        let draws = |kind| kinds.contains(&kind);
        if draws(LineKind::Sections) && self.section.is_empty() {
            bail!("{option} sections goes with --section PLANE");
        }
        if !self.section.is_empty() && !draws(LineKind::Sections) && !draws(LineKind::Combs) {
            bail!("--section goes with {option} sections, or with {option} combs");
        }
        if self.parameters.is_some() && !draws(LineKind::Parameters) {
            bail!("--parameters goes with {option} parameters");
        }
        Ok(())
    }

    /// The kinds of lines of a file.
    fn kinds(&self, look: &LookArgs) -> Vec<LineKind> {
        if !self.lines.is_empty() {
            return self.lines.clone();
        }
        let bands = look.is_banded().then_some(LineKind::Bands);
        let sections = (!self.section.is_empty()).then_some(LineKind::Sections);
        [LineKind::Silhouettes, LineKind::Borders].into_iter().chain(bands).chain(sections).collect()
    }

    /// What is drawn, from what is below to what is on top.
    fn families(&self, kinds: &[LineKind], look: &LookArgs, model: &Model, camera: &Camera) -> Result<Vec<Family>> {
        let draws = |kind| kinds.contains(&kind);
        let mut families = vec![];
        if draws(LineKind::Parameters) {
            let count = self.parameters.unwrap_or(9);
            let shares = || (1..=count).map(|k| f64::from(k) / f64::from(count + 1)).collect();
            families.extend([0, 1].map(|axis| Family::Parameters { axis, shares: shares() }));
        }
        if draws(LineKind::Bands) {
            match look.lines(model, camera)? {
                Some(family) => families.push(family),
                None => bail!("lines of bands go with --shade isophotes, zebra or highlight"),
            }
        }
        let section = |plane: &Plane| Family::Sections { normal: plane.normal, distances: vec![plane.distance] };
        families.extend(self.section.iter().map(section));
        families.extend(draws(LineKind::Borders).then_some(Family::Borders));
        families.extend(draws(LineKind::Trims).then_some(Family::Trims));
        families.extend(draws(LineKind::Silhouettes).then_some(Family::Silhouettes));
        Ok(families)
    }

    /// Writes the lines of a model, of a kind of [`ENDINGS`].
    ///
    /// # Errors
    /// Where the shading has no lines, or the file cannot be written.
    pub fn write(&self, path: &Path, kind: &str, look: &LookArgs, seen: &Seen) -> Result<()> {
        let Seen { model, camera, viewport, .. } = *seen;
        let drawing = self.drawing(&self.kinds(look), look, seen)?;
        if drawing.wires.is_empty() && !drawing.lines.iter().any(|line| line.is_seen || self.hidden) {
            terminal::note(format_args!("note: none of these lines is seen"));
        }
        let text = match kind {
            "dxf" => dxf(&drawing, self.hidden),
            _ => svg(&drawing, camera, viewport, model.name(), self.hidden),
        };
        output::write(path, text.as_bytes())
    }

    /// Lines of some kinds, each cut where something hides it. What is lost is told on standard error.
    ///
    /// # Errors
    /// Where the shading has no lines.
    pub fn drawing(&self, kinds: &[LineKind], look: &LookArgs, seen: &Seen) -> Result<Drawing> {
        let Seen { model, camera, viewport, unit } = *seen;
        let families = self.families(kinds, look, model, camera)?;
        let sight = Sight::new(model, *camera, viewport);
        let mut drawing = draw(model, camera, viewport, &families, &sight);
        if kinds.contains(&LineKind::Net) {
            drawing.wires.extend(net(model));
        }
        if kinds.contains(&LineKind::Combs) {
            let has_borders = kinds.contains(&LineKind::Borders) || kinds.contains(&LineKind::Trims);
            let on_borders = self.section.is_empty() || has_borders;
            let combs = combs(model, camera, viewport, &drawing, on_borders, &sight);
            match combs.curvature {
                None => terminal::note(format_args!("note: combs: no line that is seen is curved")),
                Some(usual) => {
                    let cut = match combs.cut {
                        0 => String::new(),
                        cut => format!("; {cut} teeth, of tighter rounds, are cut"),
                    };
                    let (pixels, usual) = (combs.pixels.round(), significant(usual));
                    terminal::note(format_args!(
                        "note: combs: {pixels} pixels are a curvature of {usual} / {unit}{cut}"
                    ));
                }
            }
            drawing.wires.extend(combs.wires());
        }
        for lost in drawing.unfinished.iter().take(PRINTED_NOTES) {
            let family = &drawing.families[lost.family];
            terminal::note(format_args!(
                "warning: {} at {}: face {} is not searched to the end, and {} pieces of it may miss lines",
                family.name(),
                family.level(lost.index),
                model.number_in_file(lost.face),
                lost.pieces,
            ));
        }
        if PRINTED_NOTES < drawing.unfinished.len() {
            let more = drawing.unfinished.len() - PRINTED_NOTES;
            terminal::note(format_args!("warning: and {more} more"));
        }
        Ok(drawing)
    }
}

/// Three digits.
fn significant(x: f64) -> String {
    let digits = (2 - x.abs().log10().floor() as i32).clamp(0, 12) as usize;
    format!("{x:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_read_or_refused() {
        assert_eq!(plane("z=-1e-3"), Ok(Plane { normal: DVec3::Z, distance: -1e-3 }));
        assert_eq!(plane("0,0,-4:2"), Ok(Plane { normal: DVec3::NEG_Z, distance: 2.0 }));
        for text in ["w=1", "x", "x=", "x=nan", "0,0,0:1", "1,2:3", "1,2,3", "1,2,3,4:5", ""] {
            assert!(plane(text).is_err(), "{text}");
        }
    }
}

//! `render --out X.svg` and `X.dxf`: lines on the surfaces as curves, in the place of a picture.

use crate::look::LookArgs;
use crate::sight::Sight;
use crate::terminal;
use crate::{number, output};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use glam::DVec3;
use lines::{Drawing, Family, draw, dxf, svg};
use scene::{Camera, Model, Viewport};
use std::path::Path;

/// Notes of lines that were not followed to their ends; the rest is counted.
const PRINTED_NOTES: usize = 10;

/// Which lines are drawn.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub struct LineArgs {
    /// bands,silhouettes,borders (the default),sections,parameters
    ///
    /// Bands are the borders of isophote bands or of zebra stripes, and the middles of highlight lines, as --shade says. Silhouettes
    /// are where the surface turns away, borders where faces end, trim loops too. Sections are drawn where --section is given.
    /// Parameters are lines of equal u and of equal v (--parameters).
    #[arg(long, value_enum, value_delimiter = ',', value_name = "KIND,…", hide_possible_values = true)]
    lines: Vec<LineKind>,
    /// A plane that cuts, as z=1.5 or NX,NY,NZ:DISTANCE
    ///
    /// It may be given several times. The distance is from the origin along the normal.
    #[arg(long, value_name = "PLANE", value_parser = plane, allow_hyphen_values = true)]
    section: Vec<Plane>,
    /// Lines of equal u, and as many of equal v, on each face [default: 9]
    #[arg(long, hide_short_help = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    parameters: Option<u32>,
    /// Draw what is hidden, too: dashed
    ///
    /// In DXF it is on layers of its own.
    #[arg(long)]
    hidden: bool,
}

/// A kind of lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum LineKind {
    /// What --shade is of: borders of isophote bands or stripes, middles of highlights
    Bands,
    /// Where the surface turns away
    Silhouettes,
    /// Where faces end, trim loops too
    Borders,
    /// Where the planes of --section cut
    Sections,
    /// Lines of equal u and of equal v
    Parameters,
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
    pub fn check(&self, kind: Option<&str>, look: &LookArgs) -> Result<()> {
        let Some(ending) = kind.filter(|kind| ENDINGS.contains(kind)) else {
            let given = [
                (!self.lines.is_empty(), "--lines"),
                (!self.section.is_empty(), "--section"),
                (self.parameters.is_some(), "--parameters"),
                (self.hidden, "--hidden"),
            ];
            return match given.iter().find(|(is_given, _)| *is_given) {
                Some((_, option)) => bail!("{option} goes with --out X.svg or --out X.dxf"),
                None => Ok(()),
            };
        };
        if let Some(option) = look.given_of_pictures() {
            bail!("{option} goes with a picture, and .{ending} holds lines");
        }
        if self.lines.contains(&LineKind::Sections) && self.section.is_empty() {
            bail!("--lines sections goes with --section PLANE");
        }
        if !self.section.is_empty() && !self.draws(LineKind::Sections) {
            bail!("--section goes with --lines sections");
        }
        if self.parameters.is_some() && !self.draws(LineKind::Parameters) {
            bail!("--parameters goes with --lines parameters");
        }
        Ok(())
    }

    fn draws(&self, kind: LineKind) -> bool {
        let by_default = match kind {
            LineKind::Bands | LineKind::Silhouettes | LineKind::Borders => true,
            LineKind::Sections => !self.section.is_empty(),
            LineKind::Parameters => false,
        };
        self.lines.contains(&kind) || self.lines.is_empty() && by_default
    }

    /// What is drawn, from what is below to what is on top.
    fn families(&self, look: &LookArgs, model: &Model, camera: &Camera) -> Result<Vec<Family>> {
        let mut families = vec![];
        if self.draws(LineKind::Parameters) {
            let count = self.parameters.unwrap_or(9);
            let shares = || (1..=count).map(|k| f64::from(k) / f64::from(count + 1)).collect();
            families.extend([0, 1].map(|axis| Family::Parameters { axis, shares: shares() }));
        }
        if self.draws(LineKind::Bands) {
            match look.lines(model, camera)? {
                Some(family) => families.push(family),
                None if self.lines.contains(&LineKind::Bands) => {
                    bail!("--lines bands goes with --shade isophotes, zebra or highlight")
                }
                None => {}
            }
        }
        let planes = self.section.iter().filter(|_| self.draws(LineKind::Sections));
        families.extend(planes.map(|plane| Family::Sections { normal: plane.normal, distances: vec![plane.distance] }));
        families.extend(self.draws(LineKind::Borders).then_some(Family::Borders));
        families.extend(self.draws(LineKind::Silhouettes).then_some(Family::Silhouettes));
        Ok(families)
    }

    /// Writes the lines of a model, of a kind of [`ENDINGS`].
    ///
    /// # Errors
    /// Where the shading has no lines, or the file cannot be written.
    pub fn write(
        &self,
        path: &Path,
        kind: &str,
        look: &LookArgs,
        model: &Model,
        camera: &Camera,
        viewport: Viewport,
    ) -> Result<()> {
        let drawing = self.drawing(look, model, camera, viewport)?;
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
        if !drawing.lines.iter().any(|line| line.is_seen || self.hidden) {
            terminal::note(format_args!("note: none of these lines is seen"));
        }
        let text = match kind {
            "dxf" => dxf(&drawing, self.hidden),
            _ => svg(&drawing, camera, viewport, model.name(), self.hidden),
        };
        output::write(path, text.as_bytes())
    }

    fn drawing(&self, look: &LookArgs, model: &Model, camera: &Camera, viewport: Viewport) -> Result<Drawing> {
        let families = self.families(look, model, camera)?;
        Ok(draw(model, camera, viewport, &families, &Sight::new(model, *camera, viewport)))
    }
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

//! What a picked pixel shows, in words.

use crate::words::number;
use compare::PixelVerdict;
use gbuffer::Hit;
use glam::DVec3;
use nurbs::Normal;
use std::sync::Arc;

/// Digits of a point's coordinates: what f32 has, and one more.
const DIGITS: usize = 8;

/// Smaller points are written with an exponent, model units.
const SMALL: f64 = 1e-3;

/// A pixel that was picked, and what is said of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Column and row.
    pub at: [usize; 2],
    /// What it shows, as the renderer of the window found it.
    pub hit: Option<Hit>,
    /// The name of its face, where the file has one.
    pub name: Option<Arc<str>>,
    /// What a ray says that is cast there.
    pub told: Told,
}

/// What a ray says of a pixel.
#[derive(Debug, Clone, PartialEq)]
pub enum Told {
    /// Nothing: the window itself shows rays.
    RayItself,
    /// It is being cast.
    Awaited,
    /// A verdict.
    Verdict(PixelVerdict),
    /// No verdict could be given, and why.
    Failed(String),
}

impl Reading {
    /// A line for each thing: what it is, and its numbers.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let [x, y] = self.at;
        let mut lines = vec![("pixel", format!("{x}, {y}"))];
        match &self.hit {
            None => lines.push(("face", "none is here".to_owned())),
            Some(hit) => {
                let name = self.name.as_ref().map_or(String::new(), |name| format!(" {name}"));
                lines.extend([
                    ("face", format!("{}{name}", hit.face.0)),
                    ("u", number(hit.uv.x)),
                    ("v", number(hit.uv.y)),
                    ("point", vector(hit.position)),
                    ("normal", normal(&hit.normal)),
                ]);
                let curvatures = hit.curvature.map(|k| [("k1", k.k1), ("k2", k.k2)]);
                lines.extend(curvatures.into_iter().flatten().map(|(name, k)| (name, format!("{k:.9}"))));
            }
        }
        lines.push(("verdict", self.verdict()));
        lines
    }

    fn verdict(&self) -> String {
        let PixelVerdict { cause, detail, unbounded, .. } = match &self.told {
            Told::RayItself => return "the ray itself".to_owned(),
            Told::Awaited => return "is being judged …".to_owned(),
            Told::Failed(why) => return format!("none: {why}"),
            Told::Verdict(verdict) => verdict,
        };
        match (cause, unbounded) {
            (Some(cause), _) => format!("differs, {}: {detail}", cause.label()),
            (None, Some(reason)) => format!("none, {}: {detail}", reason.label()),
            (None, None) => format!("agrees: {detail}"),
        }
    }
}

/// The components, side by side, to as many places as the greatest has eight digits with.
fn vector(v: DVec3) -> String {
    let size = v.abs().max_element();
    let text = |x: f64| match size {
        0.0 => "0".to_owned(),
        size if size < SMALL => format!("{x:.*e}", DIGITS - 1),
        size => format!("{x:.*}", (DIGITS as f64 - 1.0 - size.log10().floor()).max(0.0) as usize),
    };
    v.to_array().map(text).join(" ")
}

fn normal(normal: &Normal) -> String {
    match normal {
        Normal::Regular(n) => vector(*n),
        Normal::Limit(n) => format!("{} (a limit)", vector(*n)),
        Normal::Undefined => "undefined".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_have_eight_digits_whatever_the_unit() {
        let cases = [
            (DVec3::new(1.0, -0.25, 1.0 / 3.0), "1.0000000 -0.2500000 0.3333333"),
            (DVec3::new(1234.5, 0.0, -2.0), "1234.5000 0.0000 -2.0000"),
            (DVec3::new(0.0, 3e-9, 1e9), "0 0 1000000000"),
            (DVec3::new(1e-7, 0.0, -2e-9), "1.0000000e-7 0.0000000e0 -2.0000000e-9"),
            (DVec3::ZERO, "0 0 0"),
        ];
        for (v, text) in cases {
            assert_eq!(vector(v), text);
        }
    }
}

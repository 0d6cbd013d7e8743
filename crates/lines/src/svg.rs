//! Lines as a picture of curves: SVG, in pixels from the top left corner.
//!
//! Chords are proven one by one, and most are better than they need be. So places are left out where the way hardly changes.

use crate::family::Family;
use crate::line::Drawing;
use crate::wire::{Wire, WireKind};
use glam::{DVec2, DVec3};
use scene::{Camera, Viewport};
use std::fmt::Write;

/// Widths of strokes, pixels.
const FINE: f64 = 0.5;
const THIN: f64 = 0.8;
const THICK: f64 = 1.4;

/// How far a place that is left out may be from the way, pixels, and how many may be left out together.
const THINNED: f64 = 0.02;
const MOST_THINNED: usize = 64;

/// An SVG document of a drawing, as large as the picture: a group a family, a path a line, with its level and its faces. What is
/// hidden is dashed, where `hidden` asks for it. `title` is shown by viewers.
pub fn svg(drawing: &Drawing, camera: &Camera, viewport: Viewport, title: &str, hidden: bool) -> String {
    let (width, height) = (viewport.width(), viewport.height());
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        quoted(title)
    );
    for (number, family) in drawing.families.iter().enumerate() {
        let (colour, stroke) = ink(family);
        let name = family.name();
        let _ = writeln!(
            text,
            "<g class=\"{name}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{stroke}\" stroke-linejoin=\"round\">"
        );
        for line in drawing.lines.iter().filter(|line| line.family == number && (line.is_seen || hidden)) {
            let faces: Vec<String> = line.faces().iter().map(|face| face.0.to_string()).collect();
            let dashed =
                if line.is_seen { "" } else { " class=\"hidden\" stroke-dasharray=\"3 3\" stroke-opacity=\"0.6\"" };
            let (level, faces) = (family.level(line.index), faces.join(" "));
            for way in ways(line.places.iter().map(|place| place.position), camera, viewport) {
                let _ = writeln!(text, "<path data-level=\"{level}\" data-faces=\"{faces}\"{dashed} d=\"{way}\"/>");
            }
        }
        text.push_str("</g>\n");
    }
    for kind in WireKind::ALL {
        let wires: Vec<&Wire> = drawing.wires.iter().filter(|wire| wire.kind == kind).collect();
        if wires.is_empty() {
            continue;
        }
        let (name, colour) = (kind.name(), wire_colour(kind));
        let _ = writeln!(
            text,
            "<g class=\"{name}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{FINE}\" stroke-linejoin=\"round\">"
        );
        for way in wires.iter().flat_map(|wire| ways(wire.points.iter().copied(), camera, viewport)) {
            let _ = writeln!(text, "<path d=\"{way}\"/>");
        }
        text.push_str("</g>\n");
    }
    text.push_str("</svg>\n");
    text
}

/// The ways of a line in the picture: more than one where a part of it is beside the eye.
fn ways(points: impl Iterator<Item = DVec3>, camera: &Camera, viewport: Viewport) -> Vec<String> {
    let places: Vec<Option<DVec2>> = points.map(|point| camera.picture(viewport, point)).collect();
    let parts = places.split(Option::is_none).map(|part| thinned(&part.iter().flatten().copied().collect::<Vec<_>>()));
    parts.filter(|part| 1 < part.len()).map(|part| written(&part)).collect()
}

/// A way without places that are within [`THINNED`] of the straight way between those that are left.
fn thinned(way: &[DVec2]) -> Vec<DVec2> {
    let off = |a: DVec2, b: DVec2, p: DVec2| {
        let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(if share.is_nan() { a } else { a.lerp(b, share) })
    };
    let mut kept: Vec<DVec2> = vec![];
    let mut first = 0;
    while first < way.len() {
        kept.push(way[first]);
        let reaches = |last: &usize| way[first + 1..*last].iter().all(|p| off(way[first], way[*last], *p) <= THINNED);
        let next = (first + 1..way.len()).take(MOST_THINNED).take_while(reaches).last();
        first = next.unwrap_or(way.len());
    }
    kept
}

fn written(way: &[DVec2]) -> String {
    let mut text = String::new();
    for (k, p) in way.iter().enumerate() {
        let _ = write!(text, "{}{:.3} {:.3}", if k == 0 { 'M' } else { 'L' }, p.x, p.y);
    }
    text
}

/// The colour of a family, and how wide its strokes are.
fn ink(family: &Family) -> (&'static str, f64) {
    match family {
        Family::Isophotes { .. } => ("#1f6feb", THIN),
        Family::Reflections { .. } => ("#8250df", THIN),
        Family::Highlights { .. } => ("#bf8700", THIN),
        Family::Silhouettes => ("#000", THICK),
        Family::Sections { .. } => ("#cf222e", THICK),
        Family::Parameters { .. } => ("#9aa4ae", THIN),
        Family::Borders => ("#24292f", THIN),
        Family::Trims => ("#0a7d55", THIN),
    }
}

fn wire_colour(kind: WireKind) -> &'static str {
    match kind {
        WireKind::Net => "#bf3989",
        WireKind::Combs => "#bc4c00",
    }
}

/// A text in which nothing is taken for markup.
fn quoted(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_left_out_where_the_way_hardly_changes() {
        let straight: Vec<DVec2> = (0..60).map(|k| DVec2::new(f64::from(k), 3.0)).collect();
        assert_eq!(thinned(&straight), [DVec2::new(0.0, 3.0), DVec2::new(59.0, 3.0)]);
        let circle: Vec<DVec2> = (0..=5000).map(|k| 50.0 * DVec2::from_angle(f64::from(k) * 1e-3)).collect();
        let kept = thinned(&circle);
        assert_eq!((kept.first(), kept.last()), (circle.first(), circle.last()));
        assert!(kept.len() < circle.len() / 20, "{}", kept.len());
        let off = |pair: &[DVec2]| 50.0 - (0.5 * (pair[0] + pair[1])).length();
        assert!(kept.windows(2).map(off).all(|off| off <= THINNED), "a chord of the circle leaves it");
        // A corner stays.
        let corner = [DVec2::ZERO, DVec2::X, DVec2::ONE];
        assert_eq!(thinned(&corner), corner);
    }
}

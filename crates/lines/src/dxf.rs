//! Lines in space: DXF of release 12, which every CAD program reads, in model units.
//!
//! Each line is a POLYLINE of points in space, on a layer of its family and level; hidden ones are on layers of their own.

use crate::line::Drawing;
use glam::DVec3;
use std::fmt::Write;

/// A polyline of points in space, and that vertices follow.
const IN_SPACE: &str = "66\n1\n70\n8\n";

/// A DXF document of a drawing, with hidden lines where `hidden` asks for them.
pub fn dxf(drawing: &Drawing, hidden: bool) -> String {
    let mut text = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n".to_owned();
    for line in drawing.lines.iter().filter(|line| line.is_seen || hidden) {
        let family = &drawing.families[line.family];
        let level = number(family.level(line.index));
        let layer = format!("{}_{level}{}", family.name(), if line.is_seen { "" } else { "_hidden" });
        polyline(&mut text, &layer, line.places.iter().map(|place| place.position));
    }
    for wire in &drawing.wires {
        polyline(&mut text, wire.kind.name(), wire.points.iter().copied());
    }
    text.push_str("0\nENDSEC\n0\nEOF\n");
    text
}

/// Adds a line through points.
fn polyline(text: &mut String, layer: &str, points: impl Iterator<Item = DVec3>) {
    let _ = write!(text, "0\nPOLYLINE\n8\n{layer}\n{IN_SPACE}10\n0\n20\n0\n30\n0\n");
    for point in points {
        let [x, y, z] = point.to_array();
        let _ = write!(text, "0\nVERTEX\n8\n{layer}\n70\n32\n10\n{x:?}\n20\n{y:?}\n30\n{z:?}\n");
    }
    let _ = write!(text, "0\nSEQEND\n8\n{layer}\n");
}

/// A number in a layer's name, which may hold letters, digits, `-` and `_`.
fn number(level: f64) -> String {
    level.to_string().replace('.', "_")
}

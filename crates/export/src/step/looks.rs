//! Names, colours and layers of faces: labels of faces, a style for each colour, an assignment for each layer.

use super::text::{Text, real, references, string};
use formats::{Attributes, Colour};
use std::collections::BTreeMap;

/// The label of a face: its name, or that of what it is a part of.
pub(super) fn label(attributes: &Attributes) -> String {
    string(attributes.name.as_deref().unwrap_or(""))
}

/// Gives faces their colours: a style a colour, and an item a face, all shown together in the context of the shape.
pub(super) fn paint(text: &mut Text, faces: impl Iterator<Item = (u64, Colour)>, context: u64) {
    let mut styles: BTreeMap<Colour, u64> = BTreeMap::new();
    let mut items = vec![];
    for (face, colour) in faces {
        let style = *styles.entry(colour).or_insert_with(|| style(text, colour));
        items.push(text.add(&format!("STYLED_ITEM('',(#{style}),#{face})")));
    }
    if !items.is_empty() {
        text.add(&format!(
            "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',{},#{context})",
            references(&items)
        ));
    }
}

/// Puts faces on their layers.
pub(super) fn assign<'d>(text: &mut Text, faces: impl Iterator<Item = (u64, &'d Attributes)>) {
    let mut layers: BTreeMap<&str, Vec<u64>> = BTreeMap::new();
    for (face, attributes) in faces {
        attributes.layers.iter().for_each(|layer| layers.entry(layer).or_default().push(face));
    }
    for (layer, faces) in layers {
        text.add(&format!("PRESENTATION_LAYER_ASSIGNMENT({},'',{})", string(layer), references(&faces)));
    }
}

fn style(text: &mut Text, Colour(parts): Colour) -> u64 {
    let [red, green, blue] = parts.map(|part| real(f64::from(part) / 255.0));
    let colour = text.add(&format!("COLOUR_RGB('',{red},{green},{blue})"));
    let colour = text.add(&format!("FILL_AREA_STYLE_COLOUR('',#{colour})"));
    let fill = text.add(&format!("FILL_AREA_STYLE('',(#{colour}))"));
    let area = text.add(&format!("SURFACE_STYLE_FILL_AREA(#{fill})"));
    let side = text.add(&format!("SURFACE_SIDE_STYLE('',(#{area}))"));
    let usage = text.add(&format!("SURFACE_STYLE_USAGE(.BOTH.,#{side})"));
    text.add(&format!("PRESENTATION_STYLE_ASSIGNMENT((#{usage}))"))
}

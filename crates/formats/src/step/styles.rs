//! What a file says of how its items look: colours, and which of them are not shown (ISO 10303-46).
//!
//! A STYLED_ITEM names an item and its styles; the colour of a surface is several references down. An
//! OVER_RIDING_STYLED_ITEM takes the place of what was said of the same item. An INVISIBILITY hides items, styled ones, and
//! layers with all that is on them. Styles that hold only where an assembly shows a part (CONTEXT_DEPENDENT_…) are not read.

use super::p21::Instances;
use super::value::{Entity, Value};
use crate::document::Colour;
use std::collections::{BTreeMap, BTreeSet};

/// Keywords of what is read here.
pub(super) const STYLES: [&str; 4] =
    ["STYLED_ITEM", "OVER_RIDING_STYLED_ITEM", "INVISIBILITY", "PRESENTATION_LAYER_ASSIGNMENT"];

/// How deep a style may be made of others, lists counted.
const DEEPEST: usize = 16;

/// What stands between an item and the colour of its surface.
const SURFACE_STYLES: [&str; 9] = [
    "PRESENTATION_STYLE_ASSIGNMENT",
    "PRESENTATION_STYLE_BY_CONTEXT",
    "SURFACE_STYLE_USAGE",
    "SURFACE_SIDE_STYLE",
    "SURFACE_STYLE_FILL_AREA",
    "FILL_AREA_STYLE",
    "FILL_AREA_STYLE_COLOUR",
    "SURFACE_STYLE_RENDERING",
    "SURFACE_STYLE_RENDERING_WITH_PROPERTIES",
];

/// The colours that have a name instead of numbers.
const NAMED: [(&str, [u8; 3]); 8] = [
    ("red", [255, 0, 0]),
    ("green", [0, 255, 0]),
    ("blue", [0, 0, 255]),
    ("yellow", [255, 255, 0]),
    ("magenta", [255, 0, 255]),
    ("cyan", [0, 255, 255]),
    ("black", [0, 0, 0]),
    ("white", [255, 255, 255]),
];

/// What is said of items, by their numbers.
#[derive(Debug, Default)]
pub(super) struct Styles {
    colours: BTreeMap<u64, Colour>,
    /// Why an item is not shown.
    hidden: BTreeMap<u64, String>,
}

impl Styles {
    /// Those of a file; `of` lists the instances of each keyword of [`STYLES`].
    pub fn new(instances: &Instances, of: &BTreeMap<&'static str, Vec<u64>>) -> Self {
        let mut styles = Self::default();
        let mut search = Search { instances, found: BTreeMap::new() };
        for keyword in ["OVER_RIDING_STYLED_ITEM", "STYLED_ITEM"] {
            for number in &of[keyword] {
                let colour = instances.get(*number).and_then(|entity| {
                    let (own, item) = styled(&entity)?;
                    Some((item, own.iter().find_map(|style| search.colour(style, 0))?))
                });
                // What overrides comes first, and stays.
                if let Some((item, colour)) = colour {
                    styles.colours.entry(item).or_insert(colour);
                }
            }
        }
        // Each once: a few bytes may name a long layer again and again.
        let mut named = BTreeSet::new();
        for number in &of["INVISIBILITY"] {
            let items = instances.get(*number).and_then(|entity| entity.parameters().references(0).ok());
            named.extend(items.unwrap_or_default());
        }
        named.into_iter().for_each(|item| styles.hide(instances, item));
        styles
    }

    /// The colour that is said of an item itself.
    pub fn colour(&self, item: u64) -> Option<Colour> {
        self.colours.get(&item).copied()
    }

    /// Why an item itself is not shown.
    pub fn hidden_by(&self, item: u64) -> Option<&str> {
        self.hidden.get(&item).map(String::as_str)
    }

    fn hide(&mut self, instances: &Instances, number: u64) {
        let Some(entity) = instances.get(number) else { return };
        let own = entity.parameters();
        if entity.keyword() == "PRESENTATION_LAYER_ASSIGNMENT" {
            let name = own.name(0).map_or(String::new(), |name| format!(" \"{}\"", crate::error::shorten(&name)));
            for item in own.references(2).unwrap_or_default() {
                let item = instances.get(item).and_then(|entity| Some(styled(&entity)?.1)).unwrap_or(item);
                self.hidden.entry(item).or_insert_with(|| format!("its layer{name} is invisible"));
            }
        } else {
            let item = styled(&entity).map_or(number, |(_, item)| item);
            self.hidden.entry(item).or_insert_with(|| "it is invisible".to_owned());
        }
    }
}

/// The styles and the item of a styled item.
fn styled<'e>(entity: &'e Entity) -> Option<(&'e [Value<'e>], u64)> {
    let first = usize::from(entity.parts.len() == 1);
    let own = entity.part("STYLED_ITEM").or(entity.part("OVER_RIDING_STYLED_ITEM"))?;
    Some((own.list(first).ok()?, own.reference(first + 1).ok()?))
}

/// A search for the colour of surfaces, which looks at each instance once.
struct Search<'f, 'b> {
    instances: &'f Instances<'b>,
    found: BTreeMap<u64, Option<Colour>>,
}

impl Search<'_, '_> {
    fn colour(&mut self, value: &Value, depth: usize) -> Option<Colour> {
        let number = match value {
            Value::Reference(number) if depth < DEEPEST => *number,
            Value::List(list) if depth < DEEPEST => return list.iter().find_map(|value| self.colour(value, depth + 1)),
            _ => return None,
        };
        if let Some(found) = self.found.get(&number) {
            return *found;
        }
        // A style that is made of itself has no colour.
        self.found.insert(number, None);
        let entity = self.instances.get(number)?;
        let own = entity.parameters();
        let found = match entity.keyword() {
            "COLOUR_RGB" => {
                let part = |at: usize| own.number(at).ok();
                part(1).zip(part(2)).zip(part(3)).and_then(|((r, g), b)| Colour::of_parts([r, g, b]))
            }
            "DRAUGHTING_PRE_DEFINED_COLOUR" => {
                let name = own.name(0);
                NAMED.iter().find(|(known, _)| name.as_deref() == Some(*known)).map(|(_, parts)| Colour(*parts))
            }
            keyword if SURFACE_STYLES.contains(&keyword) => {
                own.values.iter().find_map(|value| self.colour(value, depth + 1))
            }
            _ => None,
        };
        self.found.insert(number, found);
        found
    }
}

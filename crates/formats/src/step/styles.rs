//! What a file says of how its items look: colours, and which of them are not shown (ISO 10303-46).
//!
//! A STYLED_ITEM names an item and its styles; the colour of a surface is several references down. An
//! OVER_RIDING_STYLED_ITEM takes the place of what was said of the same item, or of an item that stands in its own. What is
//! CONTEXT_DEPENDENT, or a style BY_CONTEXT, holds only where the walk came through each of the instances that it names. An
//! INVISIBILITY hides items, styled ones, and layers with all that is on them.

use super::fault::{Fault, fault};
use super::p21::{Instances, MISSING};
use super::said::Said;
use super::structure::REPRESENTATIONS;
use super::value::{Entity, Value};
use crate::document::Colour;
use std::collections::{BTreeMap, BTreeSet};

/// Keywords of what is read here.
pub(super) const STYLES: [&str; 5] = [
    "CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM",
    "OVER_RIDING_STYLED_ITEM",
    "STYLED_ITEM",
    "INVISIBILITY",
    "PRESENTATION_LAYER_ASSIGNMENT",
];

/// How deep a style may be made of others, lists counted.
const DEEPEST: usize = 16;

/// How far a colour's part may be outside 0 to 1: files print it with six digits or more.
const PRINTED: f64 = 1e-6;

/// Keywords of contexts that a walk comes through, beside representations.
const CONTEXTS: [&str; 6] = [
    "MAPPED_ITEM",
    "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION",
    "SHAPE_REPRESENTATION_RELATIONSHIP",
    "REPRESENTATION_RELATIONSHIP",
    "NEXT_ASSEMBLY_USAGE_OCCURRENCE",
    "PRODUCT_DEFINITION_SHAPE",
];

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

/// What is said of items.
#[derive(Debug, Default)]
pub(super) struct Styles {
    colours: Said<Colour>,
    /// Why an item is not shown.
    hidden: Said<String>,
    /// By an item: another one that stands in it, and the colour which that has there.
    over: BTreeMap<u64, (u64, Colour)>,
}

impl Styles {
    /// Those of a file; `of` lists the instances of each keyword of [`STYLES`]. Of what cannot be read
    /// `faults` tell, and `healed` of what is taken otherwise than it stands.
    pub fn new(
        instances: &Instances,
        of: &BTreeMap<&'static str, Vec<u64>>,
        faults: &mut Vec<Fault>,
        healed: &mut Vec<Fault>,
    ) -> Self {
        let mut styles = Self::default();
        let mut search = Search { instances, found: BTreeMap::new(), faults, healed };
        // What overrides comes first, and stays.
        for number in STYLES[..3].iter().flat_map(|keyword| &of[keyword]) {
            let Some(entity) = instances.get(*number) else {
                search.faults.push(fault(*number, MISSING));
                continue;
            };
            let Some(Styled { styles: own, item, over, contexts }) = styled(instances, &entity) else {
                search.faults.push(fault(*number, "it names no styles, or no item that has them"));
                continue;
            };
            for style in own {
                let Some(colour) = search.colour(style, 0) else { continue };
                let mut contexts = contexts.clone();
                contexts.extend(by_context(instances, style));
                styles.colours.add(item, contexts, colour);
                let over = over.and_then(|over| Some(styled(instances, &instances.get(over)?)?.item));
                if let Some(over) = over.filter(|over| *over != item) {
                    styles.over.entry(item).or_insert((over, colour));
                }
            }
        }
        // Each once: a few bytes may name a long layer again and again.
        let mut named = BTreeSet::new();
        for number in &of["INVISIBILITY"] {
            let items = match instances.get(*number) {
                Some(entity) => entity.parameters().references(0),
                None => Err(fault(*number, MISSING)),
            };
            match items {
                Ok(items) => named.extend(items),
                Err(fault) => faults.push(fault),
            }
        }
        named.into_iter().for_each(|item| styles.hide(instances, item));
        styles
    }

    /// The colour that is said of an item itself, where it stands within these instances.
    pub fn colour(&self, item: u64, inside: &[u64]) -> Option<Colour> {
        self.colours.get(item, inside).copied()
    }

    /// Another item, and the colour which it has wherever it stands in this one.
    pub fn over(&self, item: u64) -> Option<(u64, Colour)> {
        self.over.get(&item).copied()
    }

    /// Why an item itself is not shown, where it stands within these instances.
    pub fn hidden_by(&self, item: u64, inside: &[u64]) -> Option<&str> {
        self.hidden.get(item, inside).map(String::as_str)
    }

    fn hide(&mut self, instances: &Instances, number: u64) {
        let Some(entity) = instances.get(number) else { return };
        let own = entity.parameters();
        if entity.keyword() == "PRESENTATION_LAYER_ASSIGNMENT" {
            let name = own.name(0).map_or(String::new(), |name| format!(" \"{}\"", crate::error::shorten(&name)));
            for item in own.references(2).unwrap_or_default() {
                let (item, contexts) = meant(instances, item);
                self.hidden.add(item, contexts, format!("its layer{name} is invisible"));
            }
        } else {
            let (item, contexts) = meant(instances, number);
            self.hidden.add(item, contexts, "it is invisible".to_owned());
        }
    }
}

/// What an item stands for, and within which instances alone: a styled item for what it styles, any other for itself.
pub(super) fn meant(instances: &Instances, number: u64) -> (u64, Vec<u64>) {
    let entity = instances.get(number);
    let styled = entity.as_ref().and_then(|entity| styled(instances, entity));
    styled.map_or((number, vec![]), |styled| (styled.item, styled.contexts))
}

/// A styled item.
struct Styled<'e> {
    styles: &'e [Value<'e>],
    item: u64,
    /// The styled item that it overrides.
    over: Option<u64>,
    /// Where it holds: within all of these; anywhere where there are none.
    contexts: Vec<u64>,
}

fn styled<'e>(instances: &Instances, entity: &'e Entity) -> Option<Styled<'e>> {
    let is_simple = entity.parts.len() == 1;
    let (first, own) = match STYLES[..3].iter().find(|keyword| entity.keyword() == **keyword) {
        Some(keyword) if is_simple => (1, entity.part(keyword)?),
        _ => (0, entity.part("STYLED_ITEM")?),
    };
    let over = if is_simple { own.reference(3).ok() } else { entity.part(STYLES[1]).and_then(|p| p.reference(0).ok()) };
    let contexts = entity.part(STYLES[0]).and_then(|part| part.references(if is_simple { 4 } else { 0 }).ok());
    let mut contexts = contexts.unwrap_or_default();
    contexts.retain(|context| is_walked(instances, *context));
    Some(Styled { styles: own.list(first).ok()?, item: own.reference(first + 1).ok()?, over, contexts })
}

/// The context in which alone a style holds.
fn by_context(instances: &Instances, style: &Value) -> Option<u64> {
    let entity = instances.get(style.as_reference()?)?;
    let context = entity.part("PRESENTATION_STYLE_BY_CONTEXT")?.values.last()?.as_reference()?;
    is_walked(instances, context).then_some(context)
}

/// Whether a walk comes through such an instance; others say nothing of where a style holds.
fn is_walked(instances: &Instances, context: u64) -> bool {
    let keyword = instances.keyword(context);
    CONTEXTS.contains(&keyword) || REPRESENTATIONS.contains(&keyword)
}

/// A search for the colour of surfaces, which looks at each instance once.
struct Search<'f, 'b> {
    instances: &'f Instances<'b>,
    found: BTreeMap<u64, Option<Colour>>,
    faults: &'f mut Vec<Fault>,
    healed: &'f mut Vec<Fault>,
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
        let Some(entity) = self.instances.get(number) else {
            self.faults.push(fault(number, MISSING));
            return None;
        };
        let own = entity.parameters();
        let found = match entity.keyword() {
            "COLOUR_RGB" => {
                let part = |at: usize| own.number(at).ok();
                let parts = part(1).zip(part(2)).zip(part(3)).map(|((r, g), b)| [r, g, b]);
                let is_legal = |part: &f64| (-PRINTED..=1.0 + PRINTED).contains(part);
                match parts {
                    None => self.faults.push(fault(number, "it is no colour: three numbers")),
                    Some(parts) if !parts.iter().all(is_legal) => {
                        self.healed.push(fault(number, "its parts are not from 0 to 1: the nearest that are count"));
                    }
                    Some(_) => {}
                }
                parts.and_then(Colour::of_parts)
            }
            "DRAUGHTING_PRE_DEFINED_COLOUR" => {
                let name = own.name(0);
                let known = NAMED.iter().find(|(known, _)| name.as_deref() == Some(*known));
                if known.is_none() {
                    self.faults.push(fault(number, "it names no known colour"));
                }
                known.map(|(_, parts)| Colour(*parts))
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

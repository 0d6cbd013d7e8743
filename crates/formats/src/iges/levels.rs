//! Levels of a file as layers: a directory entry names one by number, or points to a property (406 form 1) that lists several. Of a
//! level with a function (406 form 3) the description is its name, of any other the number.

use super::entities::Entities;
use super::fault::{Fault, fault};
use crate::document::{Layers, MOST_LAYERS};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Forms of properties (406): a list of levels, and what a level is for.
const LIST: i16 = 1;
const FUNCTION: i16 = 3;

/// The levels of a file.
#[derive(Debug, Default)]
pub(super) struct Levels {
    names: BTreeMap<i32, Arc<str>>,
    /// What was asked for before, by what the directory entry says.
    layers: BTreeMap<i32, Layers>,
    /// Lists of levels that are not kept whole.
    pub faults: Vec<Fault>,
}

impl Levels {
    /// With the names that the file gives its levels.
    pub fn new(entities: &Entities) -> Self {
        let functions = entities.entries().iter().filter(|entry| entry.kind == 406 && entry.form == FUNCTION);
        let name = |number: u32| entities.get(number).ok()?.parameters().text(3);
        let names = functions.filter_map(|entry| Some((entry.level, name(entry.number)?))).collect();
        Self { names, ..Self::default() }
    }

    /// The layers that an entity itself is on.
    pub fn layers(&mut self, entities: &Entities, number: u32) -> Layers {
        let own = entities.entry(number).map_or(0, |entry| entry.level);
        if let Some(layers) = self.layers.get(&own) {
            return layers.clone();
        }
        let levels = match own {
            0 => vec![],
            1.. => vec![own],
            _ => self.listed(entities, own.unsigned_abs()),
        };
        let name = |level: &i32| self.names.get(level).cloned().unwrap_or_else(|| level.to_string().into());
        let layers: Layers = levels.iter().map(name).collect();
        self.layers.insert(own, layers.clone());
        layers
    }

    /// The levels that a property lists, each once.
    fn listed(&mut self, entities: &Entities, number: u32) -> Vec<i32> {
        let (mut levels, mut has_more): (Vec<i32>, bool) = (vec![], false);
        let read = list(entities, number);
        for level in read.as_deref().unwrap_or_default() {
            let is_new = !levels.contains(level);
            has_more |= is_new && levels.len() == MOST_LAYERS;
            if is_new && levels.len() < MOST_LAYERS {
                levels.push(*level);
            }
        }
        if has_more {
            self.faults.push(fault(number, format!("its levels beyond {MOST_LAYERS}")));
        }
        self.faults.extend(read.err());
        levels
    }
}

fn list(entities: &Entities, number: u32) -> Result<Vec<i32>, Fault> {
    let entity = entities.get(number)?;
    if (entity.entry.kind, entity.entry.form) != (406, LIST) {
        return Err(fault(number, "it is no list of levels (406, form 1)"));
    }
    let own = entity.parameters();
    // Whole numbers of parameters are below 1e9.
    (2..2 + own.count(1, 1)?).map(|at| Ok(own.whole(at)? as i32)).collect()
}

//! The layers that items are on (ISO 10303-46): each PRESENTATION_LAYER_ASSIGNMENT names a layer and what is on it.

use super::fault::{Fault, fault};
use super::p21::{Instances, MISSING};
use super::said::Said;
use super::styles::meant;
use crate::document::{Layers, MOST_LAYERS};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The keyword of what is read here.
pub(super) const LAYER: &str = "PRESENTATION_LAYER_ASSIGNMENT";

/// The layers of a file, from the `numbers` of all that name one. Of an item that is on too many, `faults` tell.
pub(super) fn layers(instances: &Instances, numbers: &[u64], faults: &mut Vec<Fault>) -> Said<Layers> {
    let mut names: BTreeMap<(u64, Vec<u64>), Vec<Arc<str>>> = BTreeMap::new();
    for number in numbers {
        let Some(entity) = instances.get(*number) else {
            faults.push(fault(*number, MISSING));
            continue;
        };
        let own = entity.parameters();
        let Some(name) = own.name(0) else { continue };
        let items = own.references(2).unwrap_or_else(|fault| {
            faults.push(fault);
            vec![]
        });
        for item in items {
            let there = names.entry(meant(instances, item)).or_default();
            match there.last() {
                Some(last) if Arc::ptr_eq(last, &name) => {}
                _ if there.len() <= MOST_LAYERS => there.push(name.clone()),
                _ => {}
            }
        }
    }
    let mut all = Said::default();
    for ((item, contexts), mut names) in names {
        if MOST_LAYERS < names.len() {
            names.truncate(MOST_LAYERS);
            faults.push(fault(item, format!("its layers beyond {MOST_LAYERS}")));
        }
        all.add(item, contexts, names.into());
    }
    all
}

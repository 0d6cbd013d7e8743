//! What is said of items: anywhere, or only where a walk comes through other instances.

use std::collections::BTreeMap;

/// The most that is kept of one item in one innermost context: what is beyond would have to be tried at every place.
const MOST: usize = 64;

/// What is said of items, by their numbers: anywhere, or only within other instances.
#[derive(Debug)]
pub(super) struct Said<T> {
    anywhere: BTreeMap<u64, T>,
    /// By the item and the last of the contexts.
    within: BTreeMap<(u64, u64), Vec<Within<T>>>,
}

/// What holds only within all of some instances.
#[derive(Debug)]
struct Within<T> {
    contexts: Vec<u64>,
    said: T,
}

impl<T> Default for Said<T> {
    fn default() -> Self {
        Self { anywhere: BTreeMap::new(), within: BTreeMap::new() }
    }
}

impl<T> Said<T> {
    /// What was said first stays.
    pub fn add(&mut self, item: u64, contexts: Vec<u64>, said: T) {
        match contexts.last() {
            None => _ = self.anywhere.entry(item).or_insert(said),
            Some(last) => {
                let there = self.within.entry((item, *last)).or_default();
                if there.len() < MOST {
                    there.push(Within { contexts, said });
                }
            }
        }
    }

    /// What holds for an item within these instances; that of more contexts before that of fewer.
    pub fn get(&self, item: u64, inside: &[u64]) -> Option<&T> {
        let mut best: Option<&Within<T>> = None;
        if !self.within.is_empty() {
            let there = inside.iter().filter_map(|last| self.within.get(&(item, *last))).flatten();
            for own in there.filter(|own| own.contexts.iter().all(|context| inside.contains(context))) {
                if best.is_none_or(|best| best.contexts.len() < own.contexts.len()) {
                    best = Some(own);
                }
            }
        }
        best.map(|own| &own.said).or_else(|| self.anywhere.get(&item))
    }
}

//! What stands at several places is made once.

use std::collections::BTreeMap;

/// Values by their keys, each kept until it was asked for as often as is known beforehand.
pub(crate) struct Once<K, V> {
    left: BTreeMap<K, usize>,
    made: BTreeMap<K, V>,
}

impl<K: Ord + Copy, V: Clone> Once<K, V> {
    /// With the keys that will be asked for, each as often as it will be.
    pub fn new(keys: impl Iterator<Item = K>) -> Self {
        let mut left = BTreeMap::new();
        keys.for_each(|key| *left.entry(key).or_default() += 1);
        Self { left, made: BTreeMap::new() }
    }

    /// The value of a key; `make` makes it, the first time.
    pub fn get(&mut self, key: K, make: impl FnOnce() -> V) -> V {
        let left = self.left.entry(key).or_insert(1);
        *left = left.saturating_sub(1);
        if *left == 0 {
            return self.made.remove(&key).unwrap_or_else(make);
        }
        self.made.entry(key).or_insert_with(make).clone()
    }
}

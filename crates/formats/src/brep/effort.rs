//! How much the offsets of a file may cost: a few bytes may ask for many, and each of them is evaluated at many places.

use std::cell::Cell;

/// At how many places all offsets of a file are evaluated at most: so many, some seconds' work, and so many more for each byte.
const PLACES: usize = 1 << 23;
const PLACES_A_BYTE: usize = 16;

/// What the search for a bound of one part counts as, in places.
pub(super) const BOUND: usize = 32;

/// That no more places are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the offsets of this file take more work than is spent on them")]
pub(crate) struct Spent;

/// How many places may still be evaluated.
#[derive(Debug)]
pub(crate) struct Effort(Cell<usize>);

impl Effort {
    /// That of a file of so many bytes.
    pub fn new(bytes: usize) -> Self {
        Self(Cell::new(PLACES + PLACES_A_BYTE * bytes))
    }

    /// Counts so many places.
    ///
    /// # Errors
    /// [`Spent`] where fewer are left; then none are.
    pub fn spend(&self, places: usize) -> Result<(), Spent> {
        let left = self.0.get().checked_sub(places);
        self.0.set(left.unwrap_or(0));
        left.map(|_| ()).ok_or(Spent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_spent_is_gone() {
        let effort = Effort::new(0);
        assert_eq!(effort.spend(PLACES - 1), Ok(()));
        assert_eq!(effort.spend(2), Err(Spent));
        assert_eq!(effort.spend(1), Err(Spent));
    }
}

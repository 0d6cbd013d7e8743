//! What a renderer says of its own commands among them, for whoever records them.

use std::fmt;

/// What a staging buffer is called that the marks of undecided pixels are copied to.
pub(crate) const UNDECIDED: &str = "reading the undecided pixels";

/// A remark; in a command buffer of its own, as a debug marker of this text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    /// What was last drawn had room for all, which is at most so many: the count was the last that was read.
    Room(u64),
    /// What was last drawn had too little room, and is drawn anew.
    NoRoom,
}

impl fmt::Display for Mark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Mark::Room(capacity) => write!(f, "room for {capacity}"),
            Mark::NoRoom => write!(f, "no room"),
        }
    }
}

impl Mark {
    /// The remark of this text, if it is one.
    pub(crate) fn of(text: &str) -> Option<Self> {
        match text.strip_prefix("room for ") {
            Some(capacity) => capacity.parse().ok().map(Mark::Room),
            None => (text == "no room").then_some(Mark::NoRoom),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_read_as_it_was_written() {
        for mark in [Mark::Room(1536), Mark::NoRoom] {
            assert_eq!(Mark::of(&mark.to_string()), Some(mark));
        }
        assert_eq!(Mark::of("room for much"), None);
    }
}

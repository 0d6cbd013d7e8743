//! Why an entity gives nothing: its directory number and the reason.

/// An entity that could not be read, and why.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    /// The sequence number of its directory entry.
    pub number: u32,
    /// The reason, as the end of a sentence.
    pub why: String,
}

pub(super) fn fault(number: u32, why: impl Into<String>) -> Fault {
    Fault { number, why: why.into() }
}

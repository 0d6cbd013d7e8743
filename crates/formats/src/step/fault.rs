//! Why an instance gives nothing: its number and the reason.

/// An instance that could not be read, and why.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    /// The number of the instance.
    pub number: u64,
    /// The reason, as the end of a sentence.
    pub why: String,
}

pub(super) fn fault(number: u64, why: impl Into<String>) -> Fault {
    Fault { number, why: why.into() }
}

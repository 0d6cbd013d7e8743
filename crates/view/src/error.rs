//! Why there is no window.

/// What can go wrong with a window.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ViewError {
    /// Nothing to open a window on, or what is there lacks something.
    #[error("there is no display to open a window on ({reason})")]
    NoDisplay {
        /// What the window system's client said.
        reason: String,
    },
    /// The display refuses a window or its pixels.
    #[error("the display refuses {what}: {reason}")]
    Refused {
        /// What was asked of it.
        what: &'static str,
        /// What it said.
        reason: String,
    },
}

//! The models that are built in: each opens by a name, and is the same numbers on every machine.
//!
//! [`builtin()`] makes one when it is asked for; nothing of it is kept. [`all`] lists the names, each with a line on what the
//! model is.
//!
//! # Examples
//! ```
//! let teapot = models::builtin("teapot").expect("it is built in");
//! assert_eq!(teapot.faces().len(), 32);
//! assert!(models::all().any(|(name, _)| *name == "teapot"));
//! ```

mod builtin;
mod construction;
mod hard;
mod published;
mod tea_set;
mod trimmed;

pub use builtin::{BUILTINS, builtin};
pub use hard::HARD;
pub use published::{PUBLISHED, QUILTS, SCENES, TeaScene};
pub use trimmed::TRIMMED;

/// Names of all built-in models, in the order in which they are listed, each with a line on what it is.
pub fn all() -> impl Iterator<Item = &'static (&'static str, &'static str)> {
    [BUILTINS, HARD, TRIMMED, PUBLISHED].into_iter().flatten()
}

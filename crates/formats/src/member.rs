//! The path of a member of a document, from which errors about its value are made.

use crate::error::{Cause, FormatError, shorten};
use crate::place::Place;
use nurbs::NurbsError;
use scene::SceneError;
use std::fmt::Display;

/// A member of a document.
#[derive(Debug, Clone)]
pub(crate) struct Member<'a> {
    file: &'a str,
    path: String,
}

impl<'a> Member<'a> {
    /// The document itself.
    pub fn document(file: &'a str) -> Self {
        Self { file, path: String::new() }
    }

    /// The member `key` of this object.
    pub fn key(&self, key: &str) -> Self {
        let dot = if self.path.is_empty() { "" } else { "." };
        Self { file: self.file, path: format!("{}{dot}{key}", self.path) }
    }

    /// The entry `index` of this list.
    pub fn index(&self, index: usize) -> Self {
        Self { file: self.file, path: format!("{}[{index}]", self.path) }
    }

    /// The same place with a remark on how its value was changed before it was checked.
    pub fn remark(&self, remark: &str) -> Self {
        Self { file: self.file, path: format!("{} ({remark})", self.path) }
    }

    /// Refuses a list that has not the number of entries that `reason` ask for.
    pub fn count(&self, found: usize, expected: usize, reason: &'static str) -> Result<(), FormatError> {
        if found == expected { Ok(()) } else { Err(self.error(Cause::Count { found, expected, reason })) }
    }

    /// The value here is not allowed.
    pub fn value(&self, value: impl Display, expected: &'static str) -> FormatError {
        self.error(Cause::Value { value: shorten(&value.to_string()), expected })
    }

    /// The numbers here do not make a spline.
    pub fn nurbs(&self, cause: NurbsError) -> FormatError {
        self.error(Cause::Nurbs(cause))
    }

    /// The surfaces and faces do not make a model; this is the document.
    pub fn scene(&self, cause: SceneError) -> FormatError {
        let member = match cause {
            SceneError::NoSuchSurface { face, .. } => self.key("faces").index(face).key("surface"),
            _ => self.key("faces"),
        };
        member.error(Cause::Scene(cause))
    }

    fn error(&self, cause: Cause) -> FormatError {
        FormatError::new(self.file, Place::Member(self.path.clone()), cause)
    }
}

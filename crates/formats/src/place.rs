//! Places in a document, for messages: the file and the path of a member.

use crate::FormatError;
use crate::error::shorten;
use nurbs::NurbsError;
use scene::escaped;
use std::fmt::Display;

/// A member of a document.
#[derive(Debug, Clone)]
pub(crate) struct Place<'a> {
    file: &'a str,
    path: String,
}

impl<'a> Place<'a> {
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
        if found == expected {
            return Ok(());
        }
        let (file, path) = (escaped(self.file), self.path.clone());
        Err(FormatError::Count { file, path, found, expected, reason })
    }

    /// The value here is not allowed.
    pub fn value(&self, value: impl Display, expected: &'static str) -> FormatError {
        let value = shorten(&value.to_string());
        FormatError::Value { file: escaped(self.file), path: self.path.clone(), value, expected }
    }

    /// The numbers here do not make a spline.
    pub fn nurbs(&self, cause: NurbsError) -> FormatError {
        FormatError::Nurbs { file: escaped(self.file), path: self.path.clone(), cause }
    }

    /// The surfaces and faces do not make a model; this is the document.
    pub fn scene(&self, cause: scene::SceneError) -> FormatError {
        let place = match cause {
            scene::SceneError::NoSuchSurface { face, .. } => self.key("faces").index(face).key("surface"),
            _ => self.key("faces"),
        };
        FormatError::Scene { file: escaped(place.file), path: place.path, cause }
    }
}

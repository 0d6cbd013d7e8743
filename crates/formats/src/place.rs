//! Places in a file: what errors and notes point at.

use std::fmt;

/// Where in a file something stands.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    File,
    /// A byte, counted from 0.
    Byte(usize),
    /// A line, counted from 1.
    Line(usize),
    /// A member of a document, by its path: `surfaces[3].knots_u`.
    Member(String),
    /// A member, and the place in the text at which reading it stopped.
    Text {
        /// Line, from 1.
        line: usize,
        /// Column in bytes, from 1.
        column: usize,
        /// The innermost member.
        member: String,
    },
    /// A numbered entity of a file that is made of them.
    Entity {
        /// Its number in the file.
        number: u64,
        /// The line on which it begins, from 1.
        line: usize,
        /// What kind of entity it is.
        keyword: String,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::File => write!(f, "the file"),
            Self::Byte(offset) => write!(f, "byte {offset}"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Member(path) => write!(f, "{path}"),
            Self::Text { line, column, member } => write!(f, "line {line}, column {column}, in {member}"),
            Self::Entity { number, line, keyword } => write!(f, "line {line}, #{number} {keyword}"),
        }
    }
}

//! What can go wrong between a picture and a capsule, and between a capsule and a picture.

use crate::GpuError;
use std::io;
use std::path::PathBuf;

/// Why a capsule was not recorded, not played, or its answer not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CapsuleError {
    /// The device refused.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A file cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: files::ReadError,
    },
    /// A file or folder cannot be written.
    #[error("{}: {source}", path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The document is not of its kind, or is damaged.
    #[error("{}: {reason}", path.display())]
    Document {
        /// Which.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The document is of another version.
    #[error("{}: schemaVersion {found}, where this program reads {expected}", path.display())]
    Version {
        /// Which.
        path: PathBuf,
        /// Its version.
        found: u64,
        /// Ours.
        expected: u32,
    },
    /// A file has another length than the document says.
    #[error("{name}: {found} bytes, not {expected}")]
    Length {
        /// Which.
        name: String,
        /// How long it is.
        found: u64,
        /// How long it should be.
        expected: u64,
    },
    /// A file's bytes are not those of the document.
    #[error("{name}: hash {found}, not {expected}")]
    Damaged {
        /// Which.
        name: String,
        /// The hash of what is there.
        found: String,
        /// What the document says.
        expected: String,
    },
    /// A name that is no plain file name, or that two files have.
    #[error("{name:?} is no name for a file of its own")]
    Name {
        /// It.
        name: String,
    },
    /// Something is named that the capsule does not have.
    #[error("{kind} {index} is asked for, of {count}")]
    NoSuch {
        /// Kind of object.
        kind: &'static str,
        /// Which.
        index: u64,
        /// How many there are.
        count: u64,
    },
    /// A file that is named and not listed.
    #[error("{name} is asked for, and is not among the files")]
    NoFile {
        /// Which.
        name: String,
    },
    /// More bytes than there are.
    #[error("bytes {offset} to {end} of a buffer of {size} are asked for")]
    Beyond {
        /// The first.
        offset: u64,
        /// The end.
        end: u128,
        /// How many there are.
        size: u64,
    },
    /// A capsule of a shape that no host draws.
    #[error("{what} is malformed: {reason}")]
    Malformed {
        /// What.
        what: &'static str,
        /// Why.
        reason: String,
    },
    /// The renderer asked for something that capsules do not hold.
    #[error("a capsule cannot hold {what}")]
    Unsupported {
        /// What.
        what: String,
    },
    /// The host's device had more to keep than the recorded one, and lost some of it.
    #[error("the host counted {needed} where the capsule has room for {capacity}, so its picture lacks some")]
    NoRoom {
        /// What was counted.
        needed: u64,
        /// Of which there is room.
        capacity: u64,
    },
    /// An answer to another capsule.
    #[error("the answer is to capsule {found}, not to {expected}")]
    OtherCapsule {
        /// The capsule that it is to.
        found: String,
        /// The one at hand.
        expected: String,
    },
}

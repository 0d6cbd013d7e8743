//! The one place where files are opened for reading and written whole.
//!
//! What is read is not trusted: only regular files up to a limit, since a pipe or a device may never end. What is written
//! replaces a file whole or not at all: a full disk, an error or a kill in the middle leaves the old file as it was.
//!
//! # Examples
//! ```
//! let path = std::env::temp_dir().join(format!("isophote-example-{}", std::process::id()));
//! files::write_bytes(&path, b"whole or not at all")?;
//! assert_eq!(files::read(&path, 100).expect("it is small"), b"whole or not at all");
//! assert!(files::read(&path, 5).is_err(), "larger than is allowed");
//! std::fs::remove_file(&path)?;
//! # Ok::<(), std::io::Error>(())
//! ```

use std::fmt;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Read};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Names that are tried for a temporary file: each is taken only by one that a killed process of the same number left.
const MAX_NAMES: u64 = 1000;

/// The file in a folder that is locked while something writes there.
const LOCK: &str = ".lock";

/// Why a file is not read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system refused.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The path is a directory, a pipe or a device.
    #[error("not a regular file")]
    NotAFile,
    /// The file is larger than the caller allows.
    #[error("{bytes} bytes are more than the {limit} allowed")]
    TooLarge {
        /// Its size, or what was read of a file that does not know its size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
}

/// Why a folder is not locked.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// The operating system refused.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Another process, or another part of this one, holds it.
    #[error("another run is writing to this folder")]
    Taken,
}

/// Opens a regular file of at most `limit` bytes. Of a file that grows afterwards the reader must not read more.
///
/// # Errors
/// Each of [`ReadError`].
pub fn open(path: &Path, limit: u64) -> Result<File, ReadError> {
    // Asked before opening: to open a pipe can wait for ever.
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(ReadError::NotAFile);
    }
    if metadata.len() > limit {
        return Err(ReadError::TooLarge { bytes: metadata.len(), limit });
    }
    Ok(File::open(path)?)
}

/// The bytes of a regular file, at most `limit` of them.
///
/// # Errors
/// Each of [`ReadError`].
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
    let file = open(path, limit)?;
    let mut bytes = Vec::with_capacity(file.metadata()?.len().min(limit) as usize);
    // The limit holds again here, for a file that grows meanwhile or does not know its size.
    file.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        return Err(ReadError::TooLarge { bytes: bytes.len() as u64, limit });
    }
    Ok(bytes)
}

/// Writes a file by `fill`: under a name of its own in the same folder, synced to the disk, then renamed.
///
/// What was there stays until the new file is complete; its permissions pass to the new one, and a link stays a link.
/// Only a kill leaves the temporary file, `.isophote-….part`, behind. A pipe or a device is written to as it is.
///
/// # Errors
/// Those of `fill`, and where the folder cannot be written, the file that is there may not be, or the disk is full.
pub fn write(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let there = fs::metadata(&target).ok();
    if there.as_ref().is_some_and(|metadata| !metadata.is_file()) {
        // Opening a directory for writing is an error, as it should be.
        return filled(OpenOptions::new().write(true).open(&target)?, fill).map(|_| ());
    }
    if there.as_ref().is_some_and(|metadata| metadata.permissions().readonly()) {
        return Err(read_only());
    }
    let (beside, file) = Beside::new(&target)?;
    if let Some(metadata) = there {
        file.set_permissions(metadata.permissions())?;
    }
    filled(file, fill)?.sync_all()?;
    beside.rename(&target)
}

/// Whether [`write()`] could begin: the folder is there and takes a new file, and a file that is there may be replaced.
/// Nothing is changed.
///
/// # Errors
/// As [`write()`], but for a full disk.
pub fn check(path: &Path) -> io::Result<()> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    match fs::metadata(&target) {
        Ok(there) if there.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory)),
        Ok(there) if there.permissions().readonly() => Err(read_only()),
        Ok(there) if !there.is_file() => Ok(()),
        _ => Beside::new(&target).map(|_| ()),
    }
}

fn read_only() -> io::Error {
    io::Error::new(io::ErrorKind::PermissionDenied, "the file that is there is read-only")
}

/// Writes a file of these bytes, as [`write()`] does.
///
/// # Errors
/// As [`write()`].
pub fn write_bytes(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write(path, |writer| io::Write::write_all(writer, bytes))
}

fn filled(file: File, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<File> {
    let mut writer = BufWriter::new(file);
    fill(&mut writer)?;
    writer.into_inner().map_err(io::IntoInnerError::into_error)
}

/// A temporary file's name, which is removed when this is dropped.
struct Beside(Option<PathBuf>);

impl Beside {
    /// An empty file in the folder of `target`, of a name that nothing else has.
    fn new(target: &Path) -> io::Result<(Self, File)> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let mut last = io::Error::from(io::ErrorKind::AlreadyExists);
        for _ in 0..MAX_NAMES {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let path = target.with_file_name(format!(".isophote-{}-{number}.part", std::process::id()));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok((Self(Some(path)), file)),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => last = error,
                Err(error) => return Err(error),
            }
        }
        Err(last)
    }

    fn rename(mut self, target: &Path) -> io::Result<()> {
        let path = self.0.as_ref().expect("taken only below");
        fs::rename(path, target)?;
        self.0 = None;
        Ok(())
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        if let Some(path) = &self.0 {
            // The error that led here is the one to report.
            let _ = fs::remove_file(path);
        }
    }
}

/// A folder to which nobody else writes, until this is dropped.
#[derive(Debug)]
pub struct Lock {
    /// Closing it unlocks it, at a kill, too. The file stays: to remove it would let two others each lock one.
    _file: File,
}

/// Locks a folder, which is made if need be, by a file `.lock` in it.
///
/// # Errors
/// [`LockError::Taken`] where another holds it.
pub fn lock(folder: &Path) -> Result<Lock, LockError> {
    fs::create_dir_all(folder)?;
    let file = OpenOptions::new().write(true).create(true).truncate(false).open(folder.join(LOCK))?;
    match file.try_lock() {
        Ok(()) => Ok(Lock { _file: file }),
        Err(TryLockError::WouldBlock) => Err(LockError::Taken),
        Err(TryLockError::Error(error)) => Err(error.into()),
    }
}

/// A 64-bit FNV-1a hash (Fowler, Noll & Vo) of what is added to it, 16 hexadecimal digits: it tells a damaged file, and is no
/// proof against a forged one.
#[derive(Debug, Clone, Copy)]
pub struct Hash(u64);

impl Hash {
    /// Of nothing.
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Adds bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

impl Default for Hash {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Write for Hash {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.add(text.as_bytes());
        Ok(())
    }
}

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

/// The [`Hash`](struct@Hash) of bytes.
pub fn hash(bytes: &[u8]) -> String {
    let mut hash = Hash::new();
    hash.add(bytes);
    hash.to_string()
}

/// An empty folder of its own among the system's temporary ones, removed with all that is in it when this is dropped.
#[derive(Debug)]
pub struct Scratch(PathBuf);

impl Scratch {
    /// Makes one.
    ///
    /// # Errors
    /// Where none can be made.
    pub fn new() -> io::Result<Self> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let mut last = io::Error::from(io::ErrorKind::AlreadyExists);
        for _ in 0..MAX_NAMES {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let path = std::env::temp_dir().join(format!("isophote-{}-{number}", std::process::id()));
            match fs::create_dir(&path) {
                Ok(()) => return Ok(Self(path)),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => last = error,
                Err(error) => return Err(error),
            }
        }
        Err(last)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // Whoever cleans temporary files finds what is left.
        let _ = fs::remove_dir_all(&self.0);
    }
}

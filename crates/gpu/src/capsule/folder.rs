//! Capsules and answers in folders: one document that names every other file, with its length and hash.
//!
//! Nothing that is read is trusted: the document must be of its kind and version, names must be plain, and a file must be as
//! long as stated and have the stated hash. The document is written last, so that a folder that was cut off has none.

use super::document::{ANSWER_FILE, ANSWER_SCHEMA, Answer, CAPSULE_FILE, Capsule, File, Host, SCHEMA};
use super::error::CapsuleError;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// The longest document that is read, bytes.
const MAX_DOCUMENT: u64 = 1 << 28;

/// Bytes of the files of a folder together, at most: four times what a full-screen picture of a large model takes.
const MAX_BYTES: u64 = 1 << 32;

/// What reads a file of at most so many bytes: from a disk, or from wherever else a host keeps it.
pub type Reader<'a> = &'a dyn Fn(&Path, u64) -> Result<Vec<u8>, files::ReadError>;

/// Files by name.
pub(super) type Files = BTreeMap<String, Vec<u8>>;

/// A capsule with all its files.
#[derive(Debug, Clone, PartialEq)]
pub struct Contents {
    capsule: Capsule,
    pub(super) files: Files,
    hash: String,
}

/// An answer with all its files.
#[derive(Debug, Clone, PartialEq)]
pub struct Played {
    answer: Answer,
    pub(super) files: Files,
}

impl Contents {
    /// A capsule and the files that it names; their list is made here.
    pub(super) fn new(capsule: Capsule, files: Files) -> Self {
        let capsule = Capsule { files: listed(&files), ..capsule };
        let hash = files::hash(&text(&capsule));
        Self { capsule, files, hash }
    }

    /// What is to be drawn.
    pub fn capsule(&self) -> &Capsule {
        &self.capsule
    }

    /// 64-bit FNV-1a of its document.
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// Writes it to a folder, which is made if need be.
    ///
    /// # Errors
    /// [`CapsuleError::Write`].
    pub fn write(&self, folder: &Path) -> Result<(), CapsuleError> {
        write(folder, &self.files, CAPSULE_FILE, &self.capsule)
    }

    /// The files of its folder by name, the document among them.
    pub fn into_files(self) -> BTreeMap<String, Vec<u8>> {
        let document = (CAPSULE_FILE.to_owned(), text(&self.capsule));
        self.files.into_iter().chain([document]).collect()
    }

    /// Reads it from a folder.
    ///
    /// # Errors
    /// [`CapsuleError::Read`], [`CapsuleError::Document`], [`CapsuleError::Version`], [`CapsuleError::Name`],
    /// [`CapsuleError::Length`], [`CapsuleError::Damaged`].
    pub fn read(folder: &Path) -> Result<Self, CapsuleError> {
        Self::read_by(folder, &files::read)
    }

    /// Reads it from what `read` takes for a folder.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_by(folder: &Path, read: Reader) -> Result<Self, CapsuleError> {
        let (capsule, text): (Capsule, _) = document(&folder.join(CAPSULE_FILE), SCHEMA, read)?;
        let files = contents(folder, &capsule.files, read)?;
        Ok(Self { capsule, files, hash: files::hash(&text) })
    }

    /// A file that it names.
    pub(super) fn file(&self, name: &str) -> Result<&[u8], CapsuleError> {
        self.files.get(name).map(Vec::as_slice).ok_or_else(|| CapsuleError::NoFile { name: name.to_owned() })
    }
}

impl Played {
    /// What `host` makes of a capsule.
    pub(super) fn new(of: &Contents, host: Host, files: Files) -> Self {
        let (schema, schema_version) = ANSWER_SCHEMA;
        let capsule = of.hash.clone();
        let answer = Answer { schema: schema.to_owned(), schema_version, capsule, host, files: listed(&files) };
        Self { answer, files }
    }

    /// Who answers what.
    pub fn answer(&self) -> &Answer {
        &self.answer
    }

    /// Writes it to a folder, which is made if need be.
    ///
    /// # Errors
    /// [`CapsuleError::Write`].
    pub fn write(&self, folder: &Path) -> Result<(), CapsuleError> {
        write(folder, &self.files, ANSWER_FILE, &self.answer)
    }

    /// The files of its folder by name, the document among them.
    pub fn into_files(self) -> BTreeMap<String, Vec<u8>> {
        let document = (ANSWER_FILE.to_owned(), text(&self.answer));
        self.files.into_iter().chain([document]).collect()
    }

    /// Reads it from a folder.
    ///
    /// # Errors
    /// As [`Contents::read`].
    pub fn read(folder: &Path) -> Result<Self, CapsuleError> {
        Self::read_by(folder, &files::read)
    }

    /// Reads it from what `read` takes for a folder.
    ///
    /// # Errors
    /// As [`Contents::read`].
    pub fn read_by(folder: &Path, read: Reader) -> Result<Self, CapsuleError> {
        let (answer, _): (Answer, _) = document(&folder.join(ANSWER_FILE), ANSWER_SCHEMA, read)?;
        let files = contents(folder, &answer.files, read)?;
        Ok(Self { answer, files })
    }

    /// A file that it names.
    pub(super) fn file(&self, name: &str) -> Result<&[u8], CapsuleError> {
        self.files.get(name).map(Vec::as_slice).ok_or_else(|| CapsuleError::NoFile { name: name.to_owned() })
    }
}

fn listed(files: &Files) -> Vec<File> {
    let file = |(name, bytes): (&String, &Vec<u8>)| File {
        name: name.clone(),
        bytes: bytes.len() as u64,
        hash: files::hash(bytes),
    };
    files.iter().map(file).collect()
}

/// A document as it stands in its file.
fn text(document: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec_pretty(document).expect("a document has text for keys")
}

fn write(folder: &Path, files: &Files, name: &str, document: &impl Serialize) -> Result<(), CapsuleError> {
    let failed = |path: &Path, source| CapsuleError::Write { path: path.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(|source| failed(folder, source))?;
    let put = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        files::write_bytes(&path, bytes).map_err(|source| failed(&path, source))
    };
    files.iter().try_for_each(|(name, bytes)| put(name, bytes))?;
    put(name, &text(document))
}

/// A document of that kind and version, and its text.
fn document<T: DeserializeOwned>(
    path: &Path,
    (schema, version): (&str, u32),
    read: Reader,
) -> Result<(T, Vec<u8>), CapsuleError> {
    let text = read(path, MAX_DOCUMENT).map_err(|source| CapsuleError::Read { path: path.to_owned(), source })?;
    let failed = |reason: String| CapsuleError::Document { path: path.to_owned(), reason };
    let value: Value = serde_json::from_slice(&text).map_err(|error| failed(error.to_string()))?;
    if value["schema"] != schema {
        return Err(failed(format!("schema is not {schema:?}")));
    }
    let found = value["schemaVersion"].as_u64().ok_or_else(|| failed("schemaVersion is no whole number".to_owned()))?;
    if found != u64::from(version) {
        return Err(CapsuleError::Version { path: path.to_owned(), found, expected: version });
    }
    Ok((T::deserialize(value).map_err(|error| failed(error.to_string()))?, text))
}

/// The files of a list, each as long and with the hash that it has there.
fn contents(folder: &Path, list: &[File], read: Reader) -> Result<Files, CapsuleError> {
    let mut left = MAX_BYTES;
    let mut files = Files::new();
    for File { name, bytes, hash } in list {
        let is_plain = Path::new(name).file_name().is_some_and(|own| own == name.as_str()) && !name.contains('\\');
        if !is_plain || files.contains_key(name) {
            return Err(CapsuleError::Name { name: name.clone() });
        }
        let path = folder.join(name);
        let found = read(&path, left).map_err(|source| CapsuleError::Read { path, source })?;
        left -= found.len() as u64;
        if found.len() as u64 != *bytes {
            return Err(CapsuleError::Length { name: name.clone(), found: found.len() as u64, expected: *bytes });
        }
        let own = files::hash(&found);
        if own != *hash {
            return Err(CapsuleError::Damaged { name: name.clone(), found: own, expected: hash.clone() });
        }
        files.insert(name.clone(), found);
    }
    Ok(files)
}

//! `meta`: the JSON object that says where a buffer comes from, and its text among the arrays.

use super::element::bytes;
use super::read::{Source, at_end};
use crate::npy::Header;
use crate::{GBuffer, GBufferError, Meta, Trims};
use scene::Viewport;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::io::{Read, Seek};

/// The longest `meta` read, characters.
const MAX_META: u64 = 1 << 20;

/// `meta` as it stands in the file; unknown keys are passed over.
#[derive(Serialize, Deserialize)]
pub(super) struct MetaText {
    renderer: String,
    technique: String,
    /// Left out where they are exact, as in files of before.
    #[serde(default, skip_serializing_if = "is_exact")]
    trims: Trims,
    model: String,
    model_hash: String,
    camera: Value,
    /// Width, height.
    size: [usize; 2],
    adapter: Option<String>,
    driver: Option<String>,
    /// Left out where nothing is known of it, as in files of before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    compiler: Option<String>,
    #[serde(default)]
    version: String,
}

fn is_exact(trims: &Trims) -> bool {
    *trims == Trims::Exact
}

impl MetaText {
    pub fn new(buffer: &GBuffer) -> Self {
        let Meta { renderer, technique, trims, model, model_hash, camera, adapter, driver, compiler, version } =
            buffer.meta().clone();
        let size = [buffer.viewport().width(), buffer.viewport().height()];
        Self { renderer, technique, trims, model, model_hash, camera, size, adapter, driver, compiler, version }
    }

    fn into_meta(self) -> Meta {
        let Self { renderer, technique, trims, model, model_hash, camera, size: _, adapter, driver, compiler, version } =
            self;
        Meta { renderer, technique, trims, model, model_hash, camera, adapter, driver, compiler, version }
    }
}

/// How text stands in an array.
#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    /// Four bytes a character.
    Utf32,
    /// UTF-8.
    Utf8,
}

/// Encoding and length, in units of it, of the text that a header announces: one string, or a row of bytes.
fn announced(header: &Header) -> Option<(Encoding, u64)> {
    match (header.descr.as_str(), &header.shape[..]) {
        ("|u1" | "|i1", &[count]) => Some((Encoding::Utf8, count)),
        (descr, []) => {
            let (kind, count) = descr.split_at_checked(2)?;
            let encoding = match kind {
                "<U" => Encoding::Utf32,
                "|S" => Encoding::Utf8,
                _ => return None,
            };
            Some((encoding, count.parse().ok()?))
        }
        _ => None,
    }
}

impl<R: Read + Seek> Source<'_, R> {
    /// Reads `meta` and checks its size against that of the arrays.
    pub fn meta(&mut self, viewport: Viewport) -> Result<Meta, GBufferError> {
        let (path, array) = (self.path, "meta");
        let (header, size, mut reader) = self.open(array)?;
        let Some((encoding, count)) = announced(&header) else {
            let (found, expected) = (header.descr, "<U… or |S… of one element, |u1 or |i1 of one dimension");
            return Err(GBufferError::Dtype { path: path.to_owned(), array, found, expected });
        };
        let damaged = |reason: String| GBufferError::Data { path: path.to_owned(), array, reason };
        if count > MAX_META {
            return Err(damaged(format!("{count} characters, above {MAX_META}")));
        }
        let needed = if encoding == Encoding::Utf32 { 4 * count } else { count };
        if size != needed {
            return Err(damaged(format!("{size} bytes where its type asks for {needed}")));
        }
        let mut text = vec![0; needed as usize];
        reader.read_exact(&mut text).map_err(|e| damaged(e.to_string()))?;
        at_end(&mut reader).map_err(damaged)?;
        let text = match encoding {
            Encoding::Utf32 => text.chunks_exact(4).map(|c| char::from_u32(u32::from_le_bytes(bytes(c)))).collect(),
            Encoding::Utf8 => String::from_utf8(text).ok(),
        };
        let malformed = |reason: String| GBufferError::Meta { path: path.to_owned(), reason };
        let text = text.ok_or_else(|| malformed("it is not Unicode text".to_owned()))?;
        let meta: MetaText = serde_json::from_str(text.trim_end_matches('\0')).map_err(|e| malformed(e.to_string()))?;
        let arrays = [viewport.width(), viewport.height()];
        if meta.size != arrays {
            return Err(GBufferError::MetaSize { path: path.to_owned(), meta: meta.size, arrays });
        }
        Ok(meta.into_meta())
    }
}

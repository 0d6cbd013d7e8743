//! From a host's answer to a G-buffer: the one way for every host, ours among them.

use super::document::{COUNT, Face, Picture, TARGETS, UNDECIDED};
use super::error::CapsuleError;
use super::folder::{Contents, Played};
use crate::hits::{self, Seen};
use gbuffer::{GBuffer, Meta};
use glam::DVec2;
use pipeline::PackedFrame;
use scene::{Camera, Viewport};
use serde::Deserialize;

/// Bytes of a texel of a target.
const TEXEL: usize = 16;

/// What a host saw of a capsule; adapter, driver and compiler in `meta` are the host's.
///
/// # Errors
/// [`CapsuleError::OtherCapsule`], [`CapsuleError::NoFile`], [`CapsuleError::Length`] where the answer is not to what was
/// asked, [`CapsuleError::NoRoom`] where the host lost some of the picture, [`CapsuleError::Malformed`] where the capsule has
/// no legal camera or size; [`CapsuleError::Gpu`] where a pixel is nonsense.
pub fn gbuffer(contents: &Contents, played: &Played) -> Result<GBuffer, CapsuleError> {
    let (capsule, answer) = (contents.capsule(), played.answer());
    if answer.capsule != contents.hash() {
        return Err(CapsuleError::OtherCapsule { found: answer.capsule.clone(), expected: contents.hash().to_owned() });
    }
    let asked = |name: &str| capsule.reads.iter().any(|read| read.name == name);
    if let Some(capacity) = capsule.room {
        let needed = u64::from(words(played, COUNT, 4)?[0]);
        if needed > capacity {
            return Err(CapsuleError::NoRoom { needed, capacity });
        }
    }
    let malformed = |reason: String| CapsuleError::Malformed { what: "the picture", reason };
    let picture = capsule.picture.as_ref().ok_or_else(|| malformed("there is none".to_owned()))?;
    let Picture { width, height, curvature, edges, meta, faces } = picture;
    let viewport = Viewport::new(*width, *height).map_err(|error| malformed(error.to_string()))?;
    let camera = Camera::deserialize(&meta.camera).map_err(|error| malformed(error.to_string()))?;
    let frames: Vec<PackedFrame> = faces.iter().map(frame).collect();
    let mut targets = vec![];
    for name in TARGETS {
        targets.push(words(played, name, TEXEL * viewport.pixels())?);
    }
    let seen = Seen { frames: &frames, curvature: *curvature, edges: *edges, camera: &camera, viewport };
    let host = answer.host.clone();
    let meta =
        Meta { adapter: Some(host.adapter), driver: Some(host.driver), compiler: Some(host.compiler), ..meta.clone() };
    let texels = TEXEL / 4 * viewport.width();
    let buffer = seen.gbuffer(meta, |y| {
        let row = std::array::from_fn(|k| &targets[k][texels * y..texels * (y + 1)]);
        hits::fragments(row, y, viewport, (frames.len(), *edges))
    })?;
    if !asked(UNDECIDED) {
        return Ok(buffer);
    }
    let marks = words(played, UNDECIDED, hits::marks(viewport))?;
    Ok(buffer.with_undecided(hits::undecided(&marks, viewport)))
}

/// The words of a file of so many bytes.
fn words(played: &Played, name: &str, expected: usize) -> Result<Vec<u32>, CapsuleError> {
    let name = format!("{name}.bin");
    let bytes = played.file(&name)?;
    if bytes.len() != expected {
        return Err(CapsuleError::Length { name, found: bytes.len() as u64, expected: expected as u64 });
    }
    Ok(bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().expect("four bytes"))).collect())
}

/// No band of edges is needed to widen a fragment.
fn frame(face: &Face) -> PackedFrame {
    PackedFrame { origin: face.origin.into(), scale: face.scale, breaks: face.breaks.clone(), edge_band: DVec2::ZERO }
}

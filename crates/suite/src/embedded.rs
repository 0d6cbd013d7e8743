//! Pictures for a report: small PNG files as `data:` URIs, so that one file holds everything.

use anyhow::Result;
use base64::Engine;
use gbuffer::Picture;
use image::{ExtendedColorType, ImageEncoder, codecs::png};

/// A picture as the value of an image's `src`.
///
/// # Errors
/// Where it cannot be encoded.
pub fn data_uri(picture: &Picture) -> Result<String> {
    let mut bytes = vec![];
    let encoder = png::PngEncoder::new_with_quality(&mut bytes, png::CompressionType::Best, png::FilterType::Adaptive);
    let (width, height) = (picture.width() as u32, picture.height() as u32);
    encoder.write_image(picture.rgb().as_flattened(), width, height, ExtendedColorType::Rgb8)?;
    Ok(format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes)))
}

//! A line for each picture: `SCENE RENDERER HASH`.

use crate::golden;
use files::Hash;
use gbuffer::GBuffer;
use std::fmt::Write;

/// The hash of all pixels. `Debug` prints each number so that it reads back to the same bits, and tells −0 from 0.
fn hash(buffer: &GBuffer) -> Hash {
    let mut hash = Hash::new();
    for pixel in buffer.pixels() {
        write!(hash, "{pixel:?}").expect("hashing does not fail");
    }
    let (width, height) = (buffer.viewport().width(), buffer.viewport().height());
    let undecided = (0..width * height).filter(|i| buffer.is_undecided(i % width, i / width));
    write!(hash, "{:?}", undecided.collect::<Vec<_>>()).expect("hashing does not fail");
    hash
}

/// The lines of this processor, a scene at a time: techniques `fragment` and `exact` by the rasterizer, and the ray caster.
pub fn lines() -> impl Iterator<Item = String> {
    golden::all().flat_map(|golden| {
        let model = golden.model();
        let raster = [&techniques::fragment::Fragment as &dyn techniques::Technique, &techniques::exact::Exact]
            .map(|technique| (technique.name(), golden.raster(&model, technique)));
        let pictures = raster.into_iter().chain([("raycast", golden.raycast(&model))]);
        pictures.map(move |(by, buffer)| format!("{} {by} {}", golden.name, hash(&buffer)))
    })
}

/// What is wrong with lines by blessed ones: those that differ, are missing or are not known.
pub fn differences<'a>(blessed: &'a str, found: &'a [String]) -> Vec<String> {
    let parts = |line: &'a str| line.rsplit_once(' ').unwrap_or((line, ""));
    let known: Vec<(&str, &str)> = blessed.lines().filter(|line| !line.trim().is_empty()).map(parts).collect();
    let found: Vec<(&str, &str)> = found.iter().map(|line| parts(line)).collect();
    let hash_in = |lines: &[(&'a str, &'a str)], picture: &str| {
        lines.iter().find(|(name, _)| *name == picture).map(|&(_, hash)| hash)
    };
    let missing = known.iter().filter(|(picture, _)| hash_in(&found, picture).is_none());
    let missing = missing.map(|(picture, _)| format!("{picture}: not drawn"));
    let wrong = found.iter().filter_map(|&(picture, hash)| match hash_in(&known, picture) {
        None => Some(format!("{picture}: {hash}, and none was blessed")),
        Some(blessed) if blessed != hash => Some(format!("{picture}: {hash}, blessed is {blessed}")),
        Some(_) => None,
    });
    missing.chain(wrong).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_hash_a_missing_picture_and_an_unknown_one_are_named() {
        let found = ["a raster 01".to_owned(), "b raster 02".to_owned(), "c raster 03".to_owned()];
        assert_eq!(differences("a raster 01\nb raster 02\nc raster 03\n", &found), [""; 0]);
        assert_eq!(
            differences("a raster 01\nb raster 22\nd raster 04\n", &found),
            ["d raster: not drawn", "b raster: 02, blessed is 22", "c raster: 03, and none was blessed"]
        );
        assert_eq!(differences("", &found).len(), 3, "nothing blessed is no agreement");
    }
}

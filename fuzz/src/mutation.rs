//! Files changed a little, by chance from a seed.

use std::io::{Cursor, Read, Write};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// Numbers that readers trip over.
const NUMBERS: [&str; 20] = [
    "0",
    "-0.0",
    "-1",
    "1",
    "2",
    "15",
    "16",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "1e999",
    "NaN",
    "4294967296",
    "18446744073709551616",
    "1e-163",
    "0.1",
    "1e39",
    "1000000000",
    "null",
];

/// A generator of 64-bit numbers (xorshift*), the same everywhere.
pub struct Random(u64);

impl Random {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// A number below `count`, which is above 0.
    pub fn below(&mut self, count: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % count
    }
}

/// One of the seeds, changed in one to eight places. Archives are changed as they are, or in an entry, behind its checksum.
pub fn mutated(seeds: &[Vec<u8>], zipped: bool, longest: usize, random: &mut Random) -> Vec<u8> {
    let mut bytes = seeds[random.below(seeds.len())].clone();
    let places = 1 + random.below(8);
    if zipped && random.below(8) > 0 {
        return repacked(&bytes, places, random).unwrap_or(bytes);
    }
    for _ in 0..places {
        change(&mut bytes, seeds, random);
    }
    bytes.truncate(longest);
    bytes
}

/// The archive with the content of some of its entries changed, one left out now and then.
fn repacked(archive: &[u8], places: usize, random: &mut Random) -> Option<Vec<u8>> {
    let mut zip = ZipArchive::new(Cursor::new(archive)).ok()?;
    let mut entries = vec![];
    for index in 0..zip.len() {
        let mut entry = zip.by_index(index).ok()?;
        let mut content = vec![];
        entry.read_to_end(&mut content).ok()?;
        entries.push((entry.name().ok()?.into_owned(), content));
    }
    for _ in 0..places {
        let which = random.below(entries.len());
        match random.below(16) {
            0 if entries.len() > 1 => drop(entries.remove(which)),
            // The header and the text of `meta` are a small part of all bytes, and the part that decides.
            1..8 => {
                let length = entries[which].1.len().min(128);
                let mut head: Vec<u8> = entries[which].1.drain(..length).collect();
                change(&mut head, &[], random);
                entries[which].1.splice(0..0, head);
            }
            _ => change(&mut entries[which].1, &[], random),
        }
    }
    let mut writer = ZipWriter::new(Cursor::new(vec![]));
    for (name, content) in entries {
        writer.start_file(name, SimpleFileOptions::default()).ok()?;
        writer.write_all(&content).ok()?;
    }
    Some(writer.finish().ok()?.into_inner())
}

fn change(bytes: &mut Vec<u8>, seeds: &[Vec<u8>], random: &mut Random) {
    if bytes.is_empty() {
        return bytes.push(random.below(256) as u8);
    }
    let place = random.below(bytes.len());
    let length = 1 + random.below((bytes.len() - place).min(64));
    match random.below(9) {
        0 => bytes[place] ^= 1 << random.below(8),
        1 => bytes[place] = random.below(256) as u8,
        2 => drop(bytes.drain(place..place + length)),
        3 => {
            let again = bytes[place..place + length].to_vec();
            bytes.splice(place..place, again);
        }
        4 if !seeds.is_empty() => {
            let other = &seeds[random.below(seeds.len())];
            let start = random.below(other.len());
            let end = (start + length).min(other.len());
            bytes.splice(place..place, other[start..end].iter().copied());
        }
        5 if random.below(8) == 0 => bytes.truncate(place),
        6 => word(bytes, place, random),
        _ => number(bytes, place, random),
    }
}

/// Puts another number in the place of the first that stands at `place` or behind it.
fn number(bytes: &mut Vec<u8>, place: usize, random: &mut Random) {
    let Some(start) = (place..bytes.len()).find(|&k| bytes[k].is_ascii_digit()) else { return };
    let inside = |byte: &u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
    let end = start + bytes[start..].iter().take_while(|byte| inside(byte)).count();
    bytes.splice(start..end, NUMBERS[random.below(NUMBERS.len())].bytes());
}

/// Numbers that readers of binary files trip over, as their 4 or 8 bytes.
const WORDS: [&[u8]; 12] = [
    &[0; 4],
    &1i32.to_le_bytes(),
    &(-1i32).to_le_bytes(),
    &i32::MAX.to_le_bytes(),
    &i32::MIN.to_le_bytes(),
    &[0; 8],
    &i64::MAX.to_le_bytes(),
    &0.5f64.to_le_bytes(),
    &(-1e300f64).to_le_bytes(),
    &1e-300f64.to_le_bytes(),
    &f64::INFINITY.to_le_bytes(),
    &f64::NAN.to_le_bytes(),
];

/// Puts another binary number over the bytes at `place`, as far as there are any.
fn word(bytes: &mut [u8], place: usize, random: &mut Random) {
    for (byte, new) in bytes[place..].iter_mut().zip(WORDS[random.below(WORDS.len())]) {
        *byte = *new;
    }
}

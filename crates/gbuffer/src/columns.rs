//! A G-buffer as arrays: their names, and what each holds of a pixel.
//!
//! Files are written from these ([`GBuffer::write_npz`], whose module says what the names mean), and so is what a program in
//! another language is given.

use crate::{GBuffer, Hit};
use glam::{DVec2, DVec3};

/// `status` where nothing is hit.
const NO_STATUS: u8 = 255;

/// What arrays are made of: what a pixel shows, and whether the renderer could decide it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pixel<'a> {
    /// What it shows.
    pub hit: Option<&'a Hit>,
    /// Whether its renderer left it open.
    pub is_undecided: bool,
}

/// What an array holds of each pixel.
#[derive(Debug, Clone, Copy)]
pub enum Column {
    /// A byte.
    Byte(fn(Pixel) -> u8),
    /// An integer.
    Integer(fn(Pixel) -> i32),
    /// Two integers.
    Integers(fn(Pixel) -> [i32; 2]),
    /// A number.
    Number(fn(Pixel) -> f64),
    /// Two numbers.
    Pair(fn(Pixel) -> [f64; 2]),
    /// Three numbers.
    Triple(fn(Pixel) -> [f64; 3]),
}

/// All arrays, in the order in which files hold them. Where nothing is seen a number is NaN.
const COLUMNS: [(&str, Column); 14] = [
    ("hit", Column::Byte(|pixel| u8::from(pixel.hit.is_some()))),
    // Numbers of faces fit where a file is written: `FaceTooLarge` is checked before.
    ("face", Column::Integer(|pixel| pixel.hit.map_or(-1, |hit| hit.face.0 as i32))),
    ("u", Column::Number(|pixel| pixel.hit.map_or(f64::NAN, |hit| hit.uv.x))),
    ("v", Column::Number(|pixel| pixel.hit.map_or(f64::NAN, |hit| hit.uv.y))),
    (
        "span",
        Column::Integers(|pixel| {
            pixel.hit.and_then(|hit| hit.local).map_or([-1; 2], |local| local.span.map(|k| k as i32))
        }),
    ),
    (
        "local",
        Column::Pair(|pixel| pixel.hit.and_then(|hit| hit.local).map_or(DVec2::NAN, |local| local.uv).to_array()),
    ),
    ("t", Column::Number(|pixel| pixel.hit.map_or(f64::NAN, |hit| hit.t))),
    ("pos", Column::Triple(|pixel| pixel.hit.map_or(DVec3::NAN, |hit| hit.position).to_array())),
    ("normal", Column::Triple(|pixel| pixel.hit.and_then(|hit| hit.normal.unit()).unwrap_or(DVec3::NAN).to_array())),
    ("status", Column::Byte(|pixel| pixel.hit.map_or(NO_STATUS, |hit| hit.normal.status() as u8))),
    ("k1", Column::Number(|pixel| pixel.hit.and_then(|hit| hit.curvature).map_or(f64::NAN, |k| k.k1))),
    ("k2", Column::Number(|pixel| pixel.hit.and_then(|hit| hit.curvature).map_or(f64::NAN, |k| k.k2))),
    ("edge", Column::Pair(|pixel| pixel.hit.and_then(|hit| hit.edge).unwrap_or(DVec2::NAN).to_array())),
    ("undecided", Column::Byte(|pixel| u8::from(pixel.is_undecided))),
];

/// Those that tell of a hit, whatever saw it: a list of hits has them as arrays, too.
pub fn columns_of_hits() -> impl Iterator<Item = (&'static str, Column)> {
    COLUMNS.into_iter().filter(|(name, _)| !["hit", "edge", "undecided"].contains(name))
}

impl GBuffer {
    /// The arrays of this buffer: `span` and `local` where it [has](GBuffer::has_local) them, `edge` where it was
    /// [asked for](GBuffer::has_edges).
    pub fn columns(&self) -> impl Iterator<Item = (&'static str, Column)> {
        COLUMNS.into_iter().filter(|(name, _)| match *name {
            "span" | "local" => self.has_local(),
            "edge" => self.has_edges(),
            _ => true,
        })
    }

    /// What a function of a column says of each pixel, in row-major order.
    pub fn values<'a, T: 'a>(&'a self, value: fn(Pixel) -> T) -> impl Iterator<Item = T> + 'a {
        let width = self.viewport().width();
        let pixels = self.pixels().enumerate();
        pixels.map(move |(i, hit)| value(Pixel { hit, is_undecided: self.is_undecided(i % width, i / width) }))
    }
}

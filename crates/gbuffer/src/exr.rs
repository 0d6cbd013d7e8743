//! G-buffers as OpenEXR files, for programs that compose pictures: numbers as they are, in f32, without a shading.
//!
//! Written are single-part files of scan lines without compression (OpenEXR file layout, version 2), which every reader takes. The
//! channels, in the order that the format asks for:
//!
//! | channel | value | where nothing is hit |
//! | --- | --- | --- |
//! | `A` | 1 where the pixel sees a point | 0 |
//! | `N.X`, `N.Y`, `N.Z` | unit normal, world; NaN where it has none | 0 |
//! | `P.X`, `P.Y`, `P.Z` | the point, world, model units | 0 |
//! | `face` | number of the face, a whole number | 0 |
//! | `k1`, `k2` | principal curvatures, 1 / model unit; NaN where there are none | 0 |
//! | `t` | distance along the pixel's unit ray, model units | 0 |
//! | `u`, `v` | parameters in the surface's own knot domain | 0 |
//!
//! The attribute `comments` holds what `.npz` files call `meta`. f64 is rounded to f32: `.npz` loses nothing.

use crate::{GBuffer, Hit};
use nurbs::Normal;
use std::io::{self, Write};

/// The first bytes of each file.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Version 2: scan lines, one part, names of up to 31 characters.
const VERSION: i32 = 2;

/// Codes of the types of channels.
const UINT: i32 = 0;
const FLOAT: i32 = 2;

/// A channel: its name, its type, and the bits of its value at a hit.
type Channel = (&'static str, i32, fn(&Hit) -> u32);

/// By name, as the format asks for.
const CHANNELS: [Channel; 13] = [
    ("A", FLOAT, |_| 1.0f32.to_bits()),
    ("N.X", FLOAT, |hit| bits(normal(hit, 0))),
    ("N.Y", FLOAT, |hit| bits(normal(hit, 1))),
    ("N.Z", FLOAT, |hit| bits(normal(hit, 2))),
    ("P.X", FLOAT, |hit| bits(hit.position.x)),
    ("P.Y", FLOAT, |hit| bits(hit.position.y)),
    ("P.Z", FLOAT, |hit| bits(hit.position.z)),
    ("face", UINT, |hit| hit.face.0),
    ("k1", FLOAT, |hit| bits(hit.curvature.map_or(f64::NAN, |k| k.k1))),
    ("k2", FLOAT, |hit| bits(hit.curvature.map_or(f64::NAN, |k| k.k2))),
    ("t", FLOAT, |hit| bits(hit.t)),
    ("u", FLOAT, |hit| bits(hit.uv.x)),
    ("v", FLOAT, |hit| bits(hit.uv.y)),
];

fn bits(x: f64) -> u32 {
    (x as f32).to_bits()
}

fn normal(hit: &Hit, axis: usize) -> f64 {
    match hit.normal {
        Normal::Regular(n) | Normal::Limit(n) => n[axis],
        Normal::Undefined => f64::NAN,
    }
}

impl GBuffer {
    /// Writes the buffer as an OpenEXR file. The bytes depend on the buffer alone.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_exr(&self, out: &mut impl Write) -> io::Result<()> {
        let (width, height) = (self.viewport().width(), self.viewport().height());
        let header = self.exr_header(width, height);
        let line = 8 + 4 * CHANNELS.len() * width;
        let first = header.len() + 8 * height;
        out.write_all(&header)?;
        for y in 0..height {
            out.write_all(&((first + y * line) as u64).to_le_bytes())?;
        }
        for y in 0..height {
            let mut bytes = Vec::with_capacity(line);
            bytes.extend((y as i32).to_le_bytes());
            bytes.extend(((line - 8) as i32).to_le_bytes());
            for (_, _, value) in CHANNELS {
                bytes.extend((0..width).flat_map(|x| self.get(x, y).map_or(0, value).to_le_bytes()));
            }
            out.write_all(&bytes)?;
        }
        Ok(())
    }

    fn exr_header(&self, width: usize, height: usize) -> Vec<u8> {
        let mut header = [&MAGIC[..], &VERSION.to_le_bytes()].concat();
        let mut attribute = |name: &str, kind: &str, value: &[u8]| {
            header.extend(name.bytes().chain([0]).chain(kind.bytes()).chain([0]));
            header.extend((value.len() as i32).to_le_bytes());
            header.extend(value);
        };
        let channel = |(name, kind, _): &Channel| {
            let numbers = [*kind, 0, 1, 1].map(i32::to_le_bytes).concat();
            name.bytes().chain([0]).chain(numbers).collect::<Vec<u8>>()
        };
        let window = [0, 0, width as i32 - 1, height as i32 - 1].map(i32::to_le_bytes).concat();
        attribute("channels", "chlist", &CHANNELS.iter().flat_map(channel).chain([0]).collect::<Vec<u8>>());
        attribute("comments", "string", self.meta_text().as_bytes());
        attribute("compression", "compression", &[0]);
        attribute("dataWindow", "box2i", &window);
        attribute("displayWindow", "box2i", &window);
        attribute("lineOrder", "lineOrder", &[0]);
        attribute("pixelAspectRatio", "float", &1.0f32.to_le_bytes());
        attribute("screenWindowCenter", "v2f", &[0; 8]);
        attribute("screenWindowWidth", "float", &1.0f32.to_le_bytes());
        header.push(0);
        header
    }
}

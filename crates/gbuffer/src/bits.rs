//! G-buffers to the bit: their hash, and where two of them part.

use crate::{GBuffer, Hit};
use files::Hash;
use nurbs::Normal;

/// Where two G-buffers of one picture do not have the same bits.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Unlike {
    /// How many pixels; all of them where the sizes are not the same.
    pub pixels: usize,
    /// Of each array in which some pixel is unlike, its name and how many are.
    pub arrays: Vec<(&'static str, usize)>,
    /// The first pixel, row by row from the top.
    pub first: Option<UnlikeNumber>,
}

/// A number of which two G-buffers have other bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnlikeNumber {
    /// Column and row.
    pub pixel: [usize; 2],
    /// The array, by the name of its values in a [`Hit`]; `hit` where one alone sees anything.
    pub array: &'static str,
    /// Which of the array's numbers of that pixel.
    pub component: usize,
    /// The bits of both, of f64 or of a whole number.
    pub bits: [u64; 2],
}

/// The numbers of a pixel as bits, by the names of their arrays; of one that sees nothing, only that.
fn numbers(hit: Option<&Hit>) -> Vec<(&'static str, usize, u64)> {
    let Some(hit) = hit else { return vec![("hit", 0, 0)] };
    let mut numbers = vec![("hit", 0, 1), ("face", 0, u64::from(hit.face.0))];
    let mut add = |array: &'static str, of: &[f64]| {
        numbers.extend(of.iter().enumerate().map(|(component, x)| (array, component, x.to_bits())));
    };
    add("uv", &hit.uv.to_array());
    if let Some(local) = hit.local {
        add("local_uv", &local.uv.to_array());
        add("local_span", &local.span.map(f64::from));
    }
    add("t", &[hit.t]);
    add("position", &hit.position.to_array());
    let (status, normal) = match hit.normal {
        Normal::Regular(normal) => (0.0, Some(normal)),
        Normal::Limit(normal) => (1.0, Some(normal)),
        Normal::Undefined => (2.0, None),
    };
    add("normal_status", &[status]);
    if let Some(normal) = normal {
        add("normal", &normal.to_array());
    }
    if let Some(curvature) = hit.curvature {
        add("curvature", &[curvature.k1, curvature.k2]);
    }
    if let Some(edge) = hit.edge {
        add("edge", &edge.to_array());
    }
    numbers
}

impl GBuffer {
    /// The hash of every bit that its pixels hold, of their number, and of which of them are undecided; not of where it comes from.
    pub fn hash(&self) -> Hash {
        let mut hash = Hash::new();
        let viewport = self.viewport();
        [viewport.width(), viewport.height()].iter().for_each(|side| hash.add(&side.to_le_bytes()));
        for (at, hit) in self.pixels().enumerate() {
            for (array, component, bits) in numbers(hit) {
                hash.add(array.as_bytes());
                hash.add(&[component as u8]);
                hash.add(&bits.to_le_bytes());
            }
            hash.add(&[u8::from(self.is_undecided(at % viewport.width(), at / viewport.width()))]);
        }
        hash
    }

    /// Where this buffer and another one do not have the same bits. 0 and −0 are not the same, and a NaN is one with its own bits.
    pub fn unlike(&self, other: &GBuffer) -> Unlike {
        let viewport = self.viewport();
        if viewport != other.viewport() {
            return Unlike { pixels: viewport.pixels().max(other.viewport().pixels()), ..Unlike::default() };
        }
        let mut unlike = Unlike::default();
        for (at, (a, b)) in self.pixels().zip(other.pixels()).enumerate() {
            let pixel = [at % viewport.width(), at / viewport.width()];
            let [a, b] = [numbers(a), numbers(b)];
            let is_other = self.is_undecided(pixel[0], pixel[1]) != other.is_undecided(pixel[0], pixel[1]);
            if a == b && !is_other {
                continue;
            }
            unlike.pixels += 1;
            let mut last = None;
            for (x, y) in a.iter().zip(&b).filter(|(x, y)| x != y) {
                unlike.first.get_or_insert(UnlikeNumber { pixel, array: x.0, component: x.1, bits: [x.2, y.2] });
                if last != Some(x.0) {
                    last = Some(x.0);
                    match unlike.arrays.iter_mut().find(|(array, _)| *array == x.0) {
                        Some((_, count)) => *count += 1,
                        None => unlike.arrays.push((x.0, 1)),
                    }
                }
            }
            if is_other || a.len() != b.len() {
                let bits = [a.len() as u64, b.len() as u64];
                unlike.first.get_or_insert(UnlikeNumber { pixel, array: "numbers", component: 0, bits });
            }
        }
        unlike
    }
}

impl std::fmt::Display for Unlike {
    /// In words, on one line.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} pixels have other bits", self.pixels)?;
        if !self.arrays.is_empty() {
            let arrays: Vec<String> = self.arrays.iter().map(|(array, count)| format!("{array} {count}")).collect();
            write!(f, " ({})", arrays.join(", "))?;
        }
        if let Some(UnlikeNumber { pixel: [x, y], array, component, bits: [a, b] }) = self.first {
            let [p, q] = [a, b].map(f64::from_bits);
            write!(f, "; first ({x}, {y}) {array}[{component}]: {a:016x} and {b:016x}, as f64 {p:e} and {q:e}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Meta;
    use glam::{DVec2, DVec3};
    use scene::{Camera, FaceId, Viewport};

    fn buffer(t: f64, second: bool) -> GBuffer {
        let model = models();
        let viewport = Viewport::new(2, 1).unwrap();
        let camera = Camera::framing(&model, viewport);
        let hit = Hit {
            face: FaceId(0),
            uv: DVec2::ZERO,
            local: None,
            t,
            position: DVec3::ONE,
            normal: Normal::Regular(DVec3::Z),
            curvature: None,
            edge: None,
        };
        GBuffer::from_rows(
            viewport,
            Meta::new("raster", "fragment", &model, &camera),
            [vec![Some(hit), second.then_some(hit)]],
        )
    }

    fn models() -> scene::Model {
        let points = [DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::ONE];
        let knots = || nurbs::KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        let surface = nurbs::Surface::new(knots(), knots(), points.to_vec(), None).unwrap();
        scene::Model::of_surfaces("flat", vec![surface]).unwrap()
    }

    #[test]
    fn one_bit_is_found_in_its_array_and_changes_the_hash() {
        let [a, b] = [1.0, 1.0f64.next_up()].map(|t| buffer(t, false));
        let unlike = a.unlike(&b);
        assert_eq!((unlike.pixels, &unlike.arrays[..]), (1, &[("t", 1)][..]));
        let first = unlike.first.unwrap();
        assert_eq!((first.pixel, first.bits), ([0, 0], [1.0f64.to_bits(), 1.0f64.to_bits() + 1]));
        assert_ne!(a.hash().to_string(), b.hash().to_string());
        assert_eq!(a.hash().to_string(), buffer(1.0, false).hash().to_string());
    }

    #[test]
    fn zeros_of_either_sign_and_a_pixel_that_sees_nothing_are_unlike() {
        assert_eq!(buffer(0.0, false).unlike(&buffer(-0.0, false)).pixels, 1);
        let unlike = buffer(1.0, false).unlike(&buffer(1.0, true));
        assert_eq!((unlike.pixels, unlike.first.unwrap().array), (1, "hit"));
        let nan = buffer(f64::NAN, true);
        assert_eq!(nan.unlike(&nan), Unlike::default());
    }
}

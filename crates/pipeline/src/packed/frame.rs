//! How a face's f32 numbers become the model's.

use glam::{DVec2, DVec3};

/// How a face's local coordinates and parameters become the model's.
#[derive(Debug, Clone, PartialEq)]
pub struct PackedFrame {
    /// World position of the local origin.
    pub origin: DVec3,
    /// Model units a local unit; a power of two.
    pub scale: f64,
    /// The ends of the knot spans that are not empty, in u and v, ascending: span k is from number k to k + 1.
    pub breaks: [Vec<f64>; 2],
    /// How near an edge of a trimmed face may pass a fragment that is told the wrong side of it, in u and v, local
    /// parameters; zeros where the face is whole.
    pub edge_band: DVec2,
}

impl PackedFrame {
    /// World position of a local one.
    pub fn world(&self, local: [f32; 3]) -> DVec3 {
        self.origin + DVec3::from_array(local.map(f64::from)) * self.scale
    }

    /// Local coordinates of a world position, narrowed.
    pub fn local(&self, world: DVec3) -> [f32; 3] {
        ((world - self.origin) / self.scale).to_array().map(|x| x as f32)
    }

    /// Parameters in the knot domain from those of a span; 1 gives the span's end exactly.
    ///
    /// # Panics
    /// Where the face has no such span.
    pub fn uv(&self, span: [u32; 2], local: [f32; 2]) -> DVec2 {
        let one = |k: usize| {
            let [start, end] = self.span(k, span[k]);
            let t = f64::from(local[k]);
            if t >= 1.0 { end } else { start + (end - start) * t }
        };
        DVec2::new(one(0), one(1))
    }

    /// How many Bézier pieces the face has.
    pub fn pieces(&self) -> usize {
        (self.breaks[0].len() - 1) * (self.breaks[1].len() - 1)
    }

    /// The ends of a span in direction `k` (0 for u, 1 for v), in the knot domain.
    ///
    /// # Panics
    /// Where the face has no such span.
    pub fn span(&self, k: usize, span: u32) -> [f64; 2] {
        [self.breaks[k][span as usize], self.breaks[k][span as usize + 1]]
    }
}

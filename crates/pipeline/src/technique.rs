//! Techniques: where the surface is evaluated, and what carries (u, v, face) to a pixel.

/// A technique; every one exists in `raster` and in `gpu`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Technique {
    /// A tessellation carries (u, v, face); each fragment evaluates the surface there (Kanai 2007).
    #[default]
    Fragment,
    /// Conservative hulls of Bézier pieces; each fragment solves for the point on its pixel's ray.
    Exact,
}

impl Technique {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Fragment, Self::Exact];

    /// Its name on the command line and in a G-buffer's facts.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fragment => "fragment",
            Self::Exact => "exact",
        }
    }
}

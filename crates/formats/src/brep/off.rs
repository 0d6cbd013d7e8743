//! How far what is drawn is from what a file says, and how that is known.

/// A distance from what the file says, model units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Off {
    /// The distance; 0 where nothing is off.
    pub most: f64,
    /// Whether that was measured at some places alone; else it is proven, but for rounding.
    pub is_measured: bool,
}

impl Off {
    pub fn proven(most: f64) -> Self {
        Self { most, is_measured: false }
    }

    pub fn measured(most: f64) -> Self {
        Self { most, is_measured: true }
    }

    /// The greater of both, proven where both are.
    pub fn max(self, other: Self) -> Self {
        Self { most: self.most.max(other.most), is_measured: self.is_measured || other.is_measured }
    }
}

/// The share of the usual aim that an interpolation is made with anew, where its distance is not proven.
const FINER: f64 = 1.0 / 256.0;

/// An interpolation with its distance as measured, and a bound on it where there is one.
pub(crate) struct Interpolated<T> {
    pub made: T,
    pub measured: f64,
    pub bound: Option<f64>,
}

/// An interpolation of which it is proven that it is within `most`, else one that was measured to be so; `make` makes one with a share
/// of the usual aim.
///
/// # Errors
/// That of the first interpolation.
pub(crate) fn nearest<T, E>(most: f64, mut make: impl FnMut(f64) -> Result<Interpolated<T>, E>) -> Result<(T, Off), E> {
    let first = make(1.0)?;
    let is_near = |bound: Option<f64>| bound.filter(|bound| *bound <= most);
    if let Some(bound) = is_near(first.bound) {
        return Ok((first.made, Off::proven(bound)));
    }
    if let Ok(finer) = make(FINER)
        && let Some(bound) = is_near(finer.bound)
    {
        return Ok((finer.made, Off::proven(bound)));
    }
    Ok((first.made, Off::measured(first.measured)))
}

//! What is made of an error that asks for too many triangles: a larger one that does not.

use crate::error::PrepareError;

/// Triangles up to which the chord error asked for decides; a camera on a face would ask for any number, and gets a coarser
/// tessellation beyond.
pub const REFINED_TRIANGLES: usize = 1 << 22;

/// From the least positive number to infinity it takes 2,098 doublings.
const MOST_DOUBLINGS: usize = 2100;

/// What `make` makes of `chord_px`, or of the least of its doubles that comes to at most `most` triangles, and which one that is. `make`
/// returns how many triangles it has made; so many as `least` are taken at any error.
///
/// # Errors
/// [`PrepareError::Chord`], and [`PrepareError::TooManyTriangles`] where even infinity asks for too many.
pub fn coarsened<T>(
    chord_px: f64,
    [least, most]: [f64; 2],
    mut make: impl FnMut(f64) -> (T, f64),
) -> Result<(T, f64), PrepareError> {
    if chord_px <= 0.0 || !chord_px.is_finite() {
        return Err(PrepareError::Chord { chord_px });
    }
    let most = most.max(least);
    let mut built_px = chord_px;
    for _ in 0..MOST_DOUBLINGS {
        let (made, triangles) = make(built_px);
        if triangles <= most {
            return Ok((made, built_px));
        }
        built_px *= 2.0;
    }
    Err(PrepareError::TooManyTriangles { chord_px })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_doubled_until_its_triangles_are_few_enough() {
        let made = |chord_px: f64, least: f64| coarsened(chord_px, [least, 4.2e6], |px| (px, 1e8 / px));
        assert_eq!(made(32.0, 0.0), Ok((32.0, 32.0)));
        assert_eq!(made(3.0, 0.0), Ok((24.0, 24.0)));
        // As many as there are at least are taken.
        assert_eq!(made(3.0, 1e8), Ok((3.0, 3.0)));
        assert_eq!(
            coarsened(1e-320, [0.0, 4.2e6], |_| ((), 1e9)),
            Err(PrepareError::TooManyTriangles { chord_px: 1e-320 })
        );
        for chord_px in [0.0, -1.0, f64::INFINITY] {
            assert_eq!(made(chord_px, 0.0), Err(PrepareError::Chord { chord_px }));
        }
    }
}

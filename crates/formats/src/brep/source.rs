//! A face as a reader hands it over, and what comes of it.

use super::frame::Motion;
use super::off::Off;
use super::path::Use;
use super::shape::Shape;
use nurbs::{Direction, NurbsError, Surface};
use scene::Face;

/// A face as a reader found it.
#[derive(Debug)]
pub(crate) struct Source {
    pub shape: Shape,
    /// Whether the face's normal is that of its surface, S_u × S_v.
    pub same_sense: bool,
    /// Its loops, with material on the left of each as seen from the face's normal; none for the whole surface.
    pub bounds: Vec<Bound>,
    /// The file's tolerance, model units.
    pub tolerance: f64,
    /// How far the shape, or a curve of an edge, is from what the file says: offsets of splines are none.
    pub off: Off,
}

/// A loop as a reader found it.
#[derive(Debug)]
pub(crate) struct Bound {
    /// Whether the file calls it the outer one.
    pub outer: bool,
    /// Its edges in order; none for a loop that is a single point.
    pub uses: Vec<Use>,
}

/// A face of a scene, with its surface.
#[derive(Debug, Clone)]
pub(crate) struct Made {
    pub surface: Surface,
    /// Its `surface` is 0.
    pub face: Face,
    pub found: Found,
}

impl Made {
    /// The surface and the face at a place; `reversed` says that what holds the face takes it the other way round.
    ///
    /// # Errors
    /// Where it is too far away, too large or too small there to be drawn.
    pub fn placed(self, motion: &Motion, reversed: bool) -> Result<(Surface, Face), NurbsError> {
        let Self { surface, mut face, .. } = self;
        face.reversed ^= reversed;
        if *motion == Motion::IDENTITY {
            return Ok((surface, face));
        }
        face.reversed ^= motion.mirrors();
        face.tolerance *= motion.factor();
        let [u, v] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
        let points = surface.points().iter().map(|p| motion.point(*p)).collect();
        let weights = surface.weights().map(<[f64]>::to_vec);
        Ok((Surface::new(u, v, points, weights)?, face))
    }
}

/// What was found by approximation.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Found {
    /// Edges whose trims are near them alone: not given in (u, v), or not on the surface, or as no spline in its parameters.
    pub followed: usize,
    /// How far any trim was measured to be from its path, model units.
    pub error: f64,
    /// How far any edge was measured to be from the surface, model units.
    pub gap: f64,
    /// How far the surface, or a curve of an edge, is from what the file says.
    pub off: Off,
    /// How far any vertex is from an edge that ends in it, where that is above the file's tolerance, model units.
    pub vertex: f64,
}

/// Why no face can be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum FaceError {
    #[error("{0}")]
    Nurbs(#[from] NurbsError),
    #[error("an edge has no curve")]
    NoCurve,
    #[error("its loops do not bound the surface, which is endless in {0}")]
    Endless(char),
    #[error("an edge is {gap:.3e} from the surface, above {most:.3e}")]
    OffSurface { gap: f64, most: f64 },
    #[error("an edge has a point without finite parameters on the surface")]
    NotFinite,
}

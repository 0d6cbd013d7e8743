//! Faces: a surface, its orientation, and the trim loops that came with it.

use glam::DVec2;
use nurbs::KnotVector;
use serde::{Deserialize, Serialize};

/// The index of a face in its [`Model`](crate::Model).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct FaceId(pub u32);

/// A face: a surface of the model, seen from one side, perhaps trimmed.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Index of the surface in the model.
    pub surface: usize,
    /// Whether the face's normal is −(S_u × S_v).
    pub reversed: bool,
    /// The modeller's tolerance, model units; 0 where none was given.
    pub tolerance: f64,
    /// Trim loops in the surface's parameters; none means the whole rectangle.
    ///
    /// They are kept as read, those that enclose nothing too; [`Region`](crate::Region) is what they mean.
    pub loops: Vec<Loop>,
}

impl Face {
    /// The whole of surface `surface`, normal along S_u × S_v.
    pub fn whole(surface: usize) -> Self {
        Self { surface, reversed: false, tolerance: 0.0, loops: vec![] }
    }
}

/// A closed chain of trim curves. With the face's own orientation removed, material lies on its left in (u, v).
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// Whether this is the face's outer boundary.
    pub outer: bool,
    /// The curves in loop order.
    pub trims: Vec<Trim>,
}

/// A NURBS curve in a surface's parameters, as part of a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Trim {
    /// Knots and degree.
    pub knots: KnotVector,
    /// Control points (u, v).
    pub points: Vec<DVec2>,
    /// Weights, or `None` for a polynomial curve.
    pub weights: Option<Vec<f64>>,
    /// Whether the loop runs the curve backwards.
    pub reversed: bool,
    /// Whether the surface is closed across this edge.
    pub seam: bool,
    /// Whether the edge is a single point in space.
    pub degenerate: bool,
    /// The edge shared with other faces, where the file names one.
    pub edge: Option<i64>,
    /// How far the modeller lets the edge's curves run apart, model units; 0 where none was given.
    pub edge_tolerance: f64,
    /// The radius of the ball in which the modeller lets edges end that meet where the loop enters this trim, model units.
    /// Two ends in one ball are up to twice that apart.
    pub vertex_tolerance: Option<f64>,
}

impl Trim {
    /// A trim run forwards, without flags, edge or tolerances of its own.
    pub fn new(knots: KnotVector, points: Vec<DVec2>, weights: Option<Vec<f64>>) -> Self {
        Self {
            knots,
            points,
            weights,
            reversed: false,
            seam: false,
            degenerate: false,
            edge: None,
            edge_tolerance: 0.0,
            vertex_tolerance: None,
        }
    }
}

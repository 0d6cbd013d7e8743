//! Faces as files describe them, and as the project draws them: what all readers of boundary representations feed.
//!
//! A reader hands over a [`source::Source`]: a surface with the file's own parameters ([`shape`]) and loops of edges, each a
//! curve in space ([`curve`]), in (u, v), or both. What comes of it is a `nurbs` surface and a `scene` face:
//!
//! 1. Each edge becomes a path in the surface's parameters ([`path`]): the file's own curve where it lies on the surface,
//!    else the edge in space, taken back to the surface ([`inverse`]).
//! 2. The paths of a loop are put in a row, by whole periods across seams, and with material on the left at poles ([`closed`]).
//! 3. The rectangle of parameters that the loops need becomes an exact rational spline ([`rectangle`], [`patch`], [`arc`]).
//! 4. Each path becomes a trim ([`fit`]): exactly where it is straight, or where plane or spline make it a spline, else
//!    within a distance that is measured.
//! 5. What a file says to stand at a distance from another curve or surface is made beforehand ([`parallel`], [`offset`]), with a proof of
//!    how near it is.
//! 6. Faces that stand at several places are made once ([`once`]), and put in their places ([`gathered`]).

pub(crate) mod across;
pub(crate) mod arc;
mod bound;
pub(crate) mod closed;
pub(crate) mod curve;
pub(crate) mod effort;
pub(crate) mod face;
pub(crate) mod fit;
pub(crate) mod frame;
pub(crate) mod gathered;
pub(crate) mod inverse;
mod net;
pub(crate) mod off;
pub(crate) mod offset;
pub(crate) mod once;
pub(crate) mod parallel;
pub(crate) mod patch;
pub(crate) mod path;
pub(crate) mod rectangle;
mod series;
pub(crate) mod shape;
pub(crate) mod source;
mod total;

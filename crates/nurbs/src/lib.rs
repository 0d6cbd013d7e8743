//! Non-uniform rational B-spline surfaces, and the plane curves that trim them, in f64.
//!
//! Everything above the renderers' f32 programs rests on this crate: a [`Surface`] is validated once and then
//! evaluated ([`Surface::point`], [`Surface::first_derivatives`], [`Surface::second_derivatives`]), interrogated
//! ([`SurfacePoint`]: normal with status, curvatures), cut into [`BezierPatch`]es and bounded ([`DerivativeBounds`]).
//! Names and algorithm numbers are those of Piegl & Tiller, *The NURBS Book*, 2nd edition.
//!
//! # Examples
//! ```
//! use glam::DVec3;
//! use nurbs::{KnotVector, Surface};
//!
//! // A square of side 2 in the plane z = 0.
//! let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0])?;
//! let points = vec![DVec3::ZERO, 2.0 * DVec3::Y, 2.0 * DVec3::X, DVec3::new(2.0, 2.0, 0.0)];
//! let surface = Surface::new(knots.clone(), knots, points, None)?;
//! assert_eq!(surface.point(0.5, 0.25), DVec3::new(1.0, 0.5, 0.0));
//! # Ok::<(), nurbs::NurbsError>(())
//! ```

mod approximation;
mod basis;
mod bezier;
mod bezier_curve;
mod blossom;
mod bounds;
mod cone;
mod curve;
mod degree;
mod derivatives;
mod differential;
mod error;
mod hull;
mod knots;
mod many;
mod monotone;
mod project;
mod quintic;
mod scale;
mod space_curve;
mod surface;
mod weights;

pub use approximation::{Bicubic, BicubicSurface};
pub use basis::basis_derivatives;
pub use bezier::BezierPatch;
pub use bezier_curve::{BezierCurve, Rectangle};
pub use blossom::restricted;
pub use bounds::DerivativeBounds;
pub use cone::Cone;
pub use curve::Curve;
pub use degree::Reduced;
pub use derivatives::{FirstDerivatives, SecondDerivatives};
pub use differential::{Curvature, Normal, NormalStatus, SurfacePoint};
pub use error::NurbsError;
pub use hull::Hull;
pub use knots::KnotVector;
pub use many::Evaluation;
pub use project::{Projection, Projector};
pub use quintic::{Halving, NODES, QUINTIC, Quintic, Quintics, Vector, between_nodes, quintics};
pub use scale::power_of_two;
pub use space_curve::SpaceCurve;
pub use surface::{Direction, Surface};

/// The highest degree, in either direction. Fixed arrays of the evaluators have this plus one entries.
pub const MAX_DEGREE: usize = 15;

/// Order of the highest degree: the largest number of basis functions that are not zero at a parameter.
pub const MAX_ORDER: usize = MAX_DEGREE + 1;

/// The longest knot vector that is accepted: enough for any real model, and it bounds what a file can make us allocate.
pub const MAX_KNOTS: usize = 1 << 20;

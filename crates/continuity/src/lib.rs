//! Edges that faces share, certified: gap, angle and difference of curvature along each, with a proof.
//!
//! [`report()`] judges a [`scene::Model`]. Its neighbours are those that the file names, or found by matching borders in space.
//! For each shared edge and each [`Criterion`] there is a bound that no place of the edge exceeds, and a place where nearly as
//! much was seen; so the [`Verdict`] is pass, fail at this place, or undecided. No sampling stands behind a bound: it comes from
//! polynomials with a proven remainder, rounding included (`taylor`), over stretches that are halved until they say enough.
//!
//! From the bottom: `taylor` (functions with a proof), `net` (surfaces and curves evaluated at them), `border` (a face's border as
//! pieces of one polynomial each), `tube` (which places correspond), `measure` (gap, angle, curvature), `certify` (branch and
//! bound). `docs/continuity.md` says what is proven and what is not.
//!
//! # Examples
//! ```
//! use continuity::{Class, Settings, report};
//!
//! let teapot = models::builtin("teapot").expect("it is built in");
//! let found = report(&teapot, Settings::new(Class::C.limits(), &teapot));
//! assert!(!found.edges.is_empty(), "its patches share borders");
//! ```

mod border;
mod borders;
mod certify;
mod curvature;
mod limits;
mod measure;
mod nearest;
mod neighbours;
mod net;
mod region;
mod report;
mod sliver;
mod surface;
mod taylor;
mod tube;

pub use border::{Border, Origin, Point};
pub use borders::{Given, borders};
pub use certify::{Certificate, Degenerate, Finding, Joint, Place};
pub use curvature::{DegenerateNormal, FaceCurvature, face_curvature};
pub use limits::{Class, Limits, Verdict};
pub use measure::Criterion;
pub use neighbours::{Group, Neighbours, Source, TJunction, neighbours};
pub use report::{
    Answer, At, DegeneratePlace, EdgeReport, FaceReport, Junction, Named, NonManifold, Report, Settings, report,
};
pub use surface::Patches;

//! How far two renderers agree: a verdict a pixel, a cause for every difference, worst first.
//!
//! A [`Judge`] knows the model and the camera. It takes a pixel's comparison apart (see [`Judge::pair`]):
//! *evaluation* at the candidate's own (u, v) within the interval that `pipeline::enclosure` proves for that point;
//! *geometry* across the ray in pixels within a stated [`Deviation`]; *visibility* and *coverage* by asking the
//! reference renderer what it sees nearby. There is no tuned epsilon and no mean.
//!
//! # Examples
//! ```
//! use compare::{Deviation, Judge, Sampler, Verdict};
//! use gbuffer::{GBuffer, Hit, Meta};
//! use pipeline::{PackedScene, Scheme};
//! use scene::{Camera, Viewport};
//!
//! /// A renderer that sees nothing anywhere.
//! struct Blind;
//!
//! impl Sampler for Blind {
//!     fn first(&self, _: f64, _: f64) -> Option<Hit> {
//!         None
//!     }
//! }
//!
//! let teapot = models::builtin("teapot").expect("it is built in");
//! let viewport = Viewport::new(4, 4)?;
//! let camera = Camera::framing(&teapot, viewport);
//! let scene = PackedScene::new(&teapot, Scheme::General)?;
//! let empty = |name: &str| {
//!     GBuffer::from_rows(viewport, Meta::new(name, "exact", &teapot, &camera), vec![vec![None; 4]; 4])
//! };
//! let judge = Judge::new(&teapot, &camera, viewport, &scene);
//! let report = judge.pair(&empty("a"), &Blind, &empty("b"), &Deviation::exact(), false, &|_| ())?;
//! assert_eq!(report.verdict, Verdict::NoVerdict, "where nothing was compared nothing agrees");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod attribution;
mod cause;
mod deviation;
mod diagnosis;
mod difference;
mod edge;
mod error;
mod evaluation;
mod judge;
mod pair;
mod report;
mod sampler;
mod seams;
mod setting;
mod shares;
mod stand_in;
mod tally;
mod trim;
mod trimming;
mod unbounded;
mod vertex_normals;

pub use attribution::NEARLY;
pub use cause::Cause;
pub use deviation::{
    ATTRIBUTE_ULPS, Claims, Deviation, EDGE_PX, EXACT_MULTIPLE, EXACT_PX, Interpolation, SNAP_PX, TRIANGLES_MULTIPLE,
    UNANSWERED_SHARE,
};
pub use diagnosis::{Diagnosis, Fault, Stored, diagnose};
pub use error::CompareError;
pub use judge::Judge;
pub use report::{Counts, Coverage, Edges, Identical, PairReport, PixelReport, PixelUse, PixelVerdict, Verdict};
pub use report::{UNBOUNDED_SHARE, UNDECIDED_SHARE};
pub use sampler::Sampler;
pub use seams::Seams;
pub use shares::{BINS, Histogram, Histograms, Shares};
pub use stand_in::StandIn;
pub use unbounded::Unbounded;
pub use vertex_normals::{Cells, VertexNormals};

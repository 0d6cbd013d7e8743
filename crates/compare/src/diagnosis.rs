//! One mistake that explains a whole picture, found by undoing it.
//!
//! A candidate that differs nearly everywhere seldom has a thousand faults: it is shifted, mirrored, or stored in too few
//! bits. Each such [`Fault`] is asked of a sample of pixels first. Those that pass are undone, and the whole picture is
//! judged again. A fault is named only where the pixels then agree; so a diagnosis is never a guess. Faults come one at a
//! time: of two at once none is named.

mod fault;
mod optics;
mod order;
mod storage;
mod vectors;
mod view;

pub use fault::{Fault, Stored};

use crate::PairReport;
use gbuffer::GBuffer;
use scene::{Camera, Model};
use serde::Serialize;
use std::fmt;
use view::View;

/// Fewer differing pixels than this share of the covered ones are no matter of the whole picture.
const WHOLE_SHARE: f64 = 0.25;

/// A fault explains a picture where at most this share of its differing pixels still differs without it: silhouettes move,
/// and a pixel beside one may show what no inverse brings back.
const LEFT_SHARE: f64 = 0.01;

/// A fault that was found, and what is left without it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// It.
    pub fault: Fault,
    /// Pixels that still differ once it is undone.
    pub left: usize,
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.left {
            0 => write!(f, "{}", self.fault),
            1 => write!(f, "{}; without that 1 pixel still differs", self.fault),
            left => write!(f, "{}; without that {left} pixels still differ", self.fault),
        }
    }
}

/// The one fault that explains why `candidate`, a picture of `model` by `camera`, differs from rays, as `report` says.
///
/// `judge` compares another picture with rays of the camera that it is given with. It is asked once for each fault that a
/// sample of 400 pixels does not rule out: mostly once, at most twelve times. `None` where the picture agrees, where less than
/// a quarter of it differs, and where no fault explains it.
///
/// # Errors
/// Those of `judge`.
pub fn diagnose<E>(
    model: &Model,
    camera: &Camera,
    candidate: &GBuffer,
    report: &PairReport,
    mut judge: impl FnMut(&GBuffer, &Camera) -> Result<PairReport, E>,
) -> Result<Option<Diagnosis>, E> {
    let differing = report.differing();
    if differing == 0 || (differing as f64) < WHOLE_SHARE * report.covered as f64 {
        return Ok(None);
    }
    let view = View { model, camera, buffer: candidate };
    let samples = view.samples();
    let hypotheses = order::hypotheses(&view, &samples)
        .chain(optics::hypotheses(&view, &samples))
        .chain(vectors::hypotheses(&view, &samples))
        .chain(storage::hypotheses(&view, &samples));
    for hypothesis in hypotheses {
        let undone = judge(&hypothesis.undone, &hypothesis.camera)?;
        let left = undone.differing();
        if undone.agree > 0 && left as f64 <= LEFT_SHARE * differing as f64 {
            return Ok(Some(Diagnosis { fault: hypothesis.fault, left }));
        }
    }
    Ok(None)
}

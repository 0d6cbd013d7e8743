//! What techniques are held equal by, and how one is made to meet it.

use anyhow::{Result, bail};
use compare::Claims;
use serde::{Serialize, Serializer};
use std::fmt;
use std::sync::Arc;
use techniques::{Prepared, Setting, Technique};

/// What all techniques have in common in a part of the study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// As many triangles as come to at most this many.
    Triangles(usize),
    /// As few triangles as are proven to be off by at most this many pixels.
    Error(f64),
    /// Nothing: neither can be asked of the technique.
    Own,
}

impl fmt::Display for Goal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Triangles(most) => write!(f, "≤ {most} triangles"),
            Self::Error(px) => write!(f, "≤ {px} px"),
            Self::Own => write!(f, "as it is"),
        }
    }
}

impl Goal {
    /// Whether it can be asked of a technique.
    pub fn suits(&self, technique: &dyn Technique) -> bool {
        (technique.claims() == Claims::OnRay) == (*self == Self::Own)
    }
}

impl Serialize for Goal {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Triangles(most) => serde_json::json!({ "triangles": most }),
            Self::Error(px) => serde_json::json!({ "error_px": px }),
            Self::Own => serde_json::json!({}),
        }
        .serialize(serializer)
    }
}

/// The coarsest chord error that a budget is tried with, pixels.
const COARSEST_PX: f64 = 256.0;

/// How often it is halved: to 1/64 pixel.
const HALVINGS: usize = 14;

/// Steps between the last two of these: to within a sixteenth of a halving.
const STEPS: usize = 4;

/// A technique that meets the goal, and the chord error that was asked of it, pixels.
///
/// # Errors
/// Where it cannot be prepared, or takes more triangles than the budget however coarse it is.
pub fn meet(technique: &dyn Technique, setting: &Setting, goal: Goal) -> Result<(Arc<dyn Prepared>, f64)> {
    let most = match goal {
        Goal::Error(px) => return Ok((technique.prepare(&Setting { chord_px: px, ..*setting })?, px)),
        Goal::Own => return Ok((technique.prepare(setting)?, setting.chord_px)),
        Goal::Triangles(most) => most,
    };
    let within = |chord_px: f64| -> Result<Option<(Arc<dyn Prepared>, f64)>> {
        let prepared = technique.prepare(&Setting { chord_px, ..*setting })?;
        // One that had to give way has met another bound than the one asked for.
        let gave_way = prepared.built_px().is_some_and(|built| built > chord_px);
        Ok((prepared.triangles() <= most && !gave_way).then_some((prepared, chord_px)))
    };
    let Some(mut best) = within(COARSEST_PX)? else {
        let least = technique.prepare(&Setting { chord_px: COARSEST_PX, ..*setting })?.triangles();
        bail!("the coarsest has {least} triangles");
    };
    let mut too_fine = best.1 / 2.0;
    for _ in 0..HALVINGS {
        match within(too_fine)? {
            None => break,
            Some(finer) => best = finer,
        }
        too_fine = best.1 / 2.0;
    }
    for _ in 0..STEPS {
        let middle = (too_fine * best.1).sqrt();
        match within(middle)? {
            None => too_fine = middle,
            Some(finer) => best = finer,
        }
    }
    Ok(best)
}

//! What can be wrong with a scene.

use crate::{MAX_PIXELS, MAX_SIDE};
use nurbs::NurbsError;
use std::fmt;

/// Why a model, camera or viewport could not be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The model has no face.
    #[error("the model has no faces")]
    NoFaces,
    /// A face names a surface that the model does not have.
    #[error("face {face} names surface {surface}, but there are only {count}")]
    NoSuchSurface {
        /// Index of the face.
        face: usize,
        /// The surface it names.
        surface: usize,
        /// Number of surfaces.
        count: usize,
    },
    /// A loop has no trims, or encloses nothing.
    #[error("face {face}, loop {boundary}: the loop is empty or encloses nothing")]
    EmptyLoop {
        /// Index of the face.
        face: usize,
        /// Index of the loop in the face.
        boundary: usize,
    },
    /// A trim is not a NURBS curve: counts, points or weights are wrong.
    #[error("face {face}, loop {boundary}, trim {trim}: {cause}")]
    TrimCurve {
        /// Index of the face.
        face: usize,
        /// Index of the loop in the face.
        boundary: usize,
        /// Index of the trim in the loop.
        trim: usize,
        /// What is wrong with it.
        cause: NurbsError,
    },
    /// A trim does not begin where the one before it ends (trim 0: where the last ends).
    #[error(
        "face {face}, loop {boundary}: {gap:.3e} model units between trim {trim} and the one before it, above {tolerance:.3e}"
    )]
    TrimGap {
        /// Index of the face.
        face: usize,
        /// Index of the loop in the face.
        boundary: usize,
        /// Index of the trim after the gap.
        trim: usize,
        /// Length of the gap along the surface, model units.
        gap: f64,
        /// The longest that is healed, model units.
        tolerance: f64,
    },
    /// A loop goes around its surface in a way that bounds no region: more than once, or in both directions.
    #[error("face {face}, loop {boundary}: the loop goes around the surface {u} times in u and {v} times in v")]
    LoopPeriod {
        /// Index of the face.
        face: usize,
        /// Index of the loop in the face.
        boundary: usize,
        /// Periods in u from start to end.
        u: i32,
        /// Periods in v.
        v: i32,
    },
    /// Flag and direction of a loop both contradict the place where it lies.
    #[error(
        "face {face}, loop {boundary}: it lies in {depth} other loops, and neither its direction nor `outer`: {outer} fit that"
    )]
    Nesting {
        /// Index of the face.
        face: usize,
        /// Index of the loop in the face.
        boundary: usize,
        /// How many loops it lies in.
        depth: usize,
        /// Its flag.
        outer: bool,
    },
    /// A loop reaches over so many periods of a closed surface that its copies are not made.
    #[error("face {face}, loop {boundary}: the loop reaches over {copies} copies of its closed surface, above {limit}")]
    LoopReach {
        /// Index of the face.
        face: usize,
        /// Index of the loop in the face.
        boundary: usize,
        /// Copies of the loop, a period apart, that reach into the domain.
        copies: f64,
        /// The most that are made.
        limit: usize,
    },
    /// A loop on a closed surface covers the same place twice.
    #[error("face {face}, loop {boundary}: a period on, the loop overlaps itself near (u, v) = {at:?}")]
    LoopOverlap {
        /// Index of the face.
        face: usize,
        /// Index of the loop in the face.
        boundary: usize,
        /// Where, in the surface's parameters.
        at: [f64; 2],
    },
    /// An odd number of loops goes around a surface that is closed in the other direction, too.
    #[error(
        "face {face}, loops {boundaries:?}: an odd number of rings around a surface closed both ways bounds nothing"
    )]
    OddRings {
        /// Index of the face.
        face: usize,
        /// Indices of the loops that go around.
        boundaries: Vec<usize>,
    },
    /// The loops enclose nothing of the surface's domain.
    #[error("face {face}: its loops leave no material inside the surface's domain")]
    NoMaterial {
        /// Index of the face.
        face: usize,
    },
    /// The loops touch in so many places that they are not searched for crossings.
    #[error("face {face}: its loops meet so often that to search them for crossings takes above {limit} steps")]
    TrimWork {
        /// Index of the face.
        face: usize,
        /// The most steps that are taken.
        limit: usize,
    },
    /// No face is left of a model.
    #[error("no face can be drawn: {}", listed(causes))]
    NoFaceLeft {
        /// Why each was left out; never empty.
        causes: Vec<SceneError>,
    },
    /// Two trims cross, of one loop or of two.
    #[error("face {face}: {first} crosses {second} near (u, v) = {at:?}")]
    TrimsCross {
        /// Index of the face.
        face: usize,
        /// The one curve.
        first: TrimPlace,
        /// The other.
        second: TrimPlace,
        /// Where, in the surface's parameters.
        at: [f64; 2],
    },
    /// A point of a profile is not on the surface.
    #[error(
        "profile {profile}, curve {curve}: the point at parameter {t} is {distance:.3e} model units from the surface, \
         above {tolerance:.3e}"
    )]
    ProfilePoint {
        /// Index of the profile.
        profile: usize,
        /// Index of the curve in the profile.
        curve: usize,
        /// The curve's parameter.
        t: f64,
        /// Distance of the nearest surface point found, model units.
        distance: f64,
        /// The distance asked for.
        tolerance: f64,
    },
    /// Width or height is zero or above [`MAX_SIDE`], or there are more than [`MAX_PIXELS`] pixels.
    #[error(
        "a viewport of {width}x{height} pixels: each side must be 1 to {MAX_SIDE}, and both at most {MAX_PIXELS} pixels"
    )]
    Viewport {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// A camera's vector or shift has a coordinate that is NaN or infinite.
    #[error("the camera's {name} is {value}, not a finite number")]
    CameraNotFinite {
        /// Which value.
        name: &'static str,
        /// The coordinate.
        value: f64,
    },
    /// Eye and target coincide.
    #[error("the camera's eye and target coincide at {at:?}")]
    EyeIsTarget {
        /// Where.
        at: [f64; 3],
    },
    /// The up vector is zero or parallel to the view.
    #[error("the camera's up vector {up:?} is zero or parallel to the view direction")]
    UpIsParallel {
        /// The up vector.
        up: [f64; 3],
    },
    /// The field of view is outside its range.
    #[error("a field of view of {degrees} degrees: it must be above 0 and below 180")]
    FieldOfView {
        /// The angle, degrees.
        degrees: f64,
    },
    /// The height of an orthographic view is not positive.
    #[error("an orthographic view of height {height}: it must be above 0")]
    OrthographicHeight {
        /// The height, model units.
        height: f64,
    },
    /// The near distance is not positive (perspective) or is negative (orthographic).
    #[error("a near distance of {near}: it must be above 0 (perspective) or not below 0 (orthographic)")]
    Near {
        /// The distance, model units.
        near: f64,
    },
}

/// Causes that a message lists before it only counts the rest.
const LISTED: usize = 100;

fn listed(causes: &[SceneError]) -> String {
    if let [cause] = causes {
        return cause.to_string();
    }
    let mut text = format!("{} are left out", causes.len());
    text.extend(causes.iter().take(LISTED).map(|cause| format!("\n  {cause}")));
    if let Some(more) = causes.len().checked_sub(LISTED + 1) {
        text += &format!("\n  and {} more", more + 1);
    }
    text
}

/// Which curve of a face is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrimPlace {
    /// Index of the loop; `None` for the natural boundary.
    pub boundary: Option<u32>,
    /// Index of the trim in the loop; `None` for a segment that closes a gap.
    pub trim: Option<u32>,
}

impl fmt::Display for TrimPlace {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match (self.boundary, self.trim) {
            (Some(boundary), Some(trim)) => write!(f, "trim {trim} of loop {boundary}"),
            (Some(boundary), None) => write!(f, "a closed gap of loop {boundary}"),
            (None, _) => write!(f, "the natural boundary"),
        }
    }
}

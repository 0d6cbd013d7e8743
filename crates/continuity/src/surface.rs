//! A surface's Bézier patches as nets, with what their extraction may have lost.

use crate::net::Net;
use crate::taylor::UNIT;
use glam::{DVec3, DVec4};
use nurbs::Surface;
use std::collections::HashMap;
use std::sync::Arc;

/// A Bézier patch of a surface, in its own parameters 0 … 1.
#[derive(Debug)]
pub struct Patch {
    /// Its points, about [`Self::origin`].
    pub net: Net,
    /// What they count from.
    pub origin: DVec3,
}

/// The patches of a surface, each made when it is first asked for.
pub struct Patches<'m> {
    /// The surface.
    pub surface: &'m Surface,
    known: HashMap<[usize; 2], Arc<Patch>>,
    /// How far a homogeneous coordinate of a patch may be from the surface's own.
    error: [f64; 4],
}

impl<'m> Patches<'m> {
    /// None yet.
    ///
    /// A coordinate is off by what blossoms lose, 2 p ulp of the greatest in each direction (`nurbs::BezierPatch`), here
    /// counted twice, and by two roundings of the surface's own points, each a difference times a weight.
    pub fn new(surface: &'m Surface) -> Self {
        let steps = 8.0 * surface.degree().iter().sum::<usize>() as f64;
        let greatest = |axis: usize| surface.homogeneous().iter().fold(0.0, |most: f64, c| most.max(c[axis].abs()));
        let roundings = |axis: usize| match (axis, surface.weights()) {
            (3, None) => 0.0,
            (3, _) => steps,
            _ => steps + 2.0,
        };
        let error = [0, 1, 2, 3].map(|axis| roundings(axis) * UNIT * greatest(axis));
        Self { surface, known: HashMap::new(), error }
    }

    /// The patch of a nonempty span.
    pub fn get(&mut self, span: [usize; 2]) -> Arc<Patch> {
        let (surface, error) = (self.surface, self.error);
        let make = || Arc::new(patch(surface, span, error));
        self.known.entry(span).or_insert_with(make).clone()
    }
}

/// The patch of a nonempty span, of points that are off by `error`.
fn patch(surface: &Surface, span: [usize; 2], error: [f64; 4]) -> Patch {
    let patch = surface.bezier_patch(span);
    let is_rational = surface.weights().is_some();
    let point = |c: &DVec4| if is_rational { c.to_array() } else { c.truncate().extend(1.0).to_array() };
    let net = Net::new(patch.degree, patch.control.iter().map(point).collect(), error);
    Patch { net, origin: patch.origin }
}

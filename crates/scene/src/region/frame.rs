//! What all steps need to know of a face: its domain, where its surface is closed, and how wide a gap may be.
//!
//! It is found from the face as the file gave it, its surface and the model's extent, before any loop is looked at.

use super::segment::Segment;
use crate::Face;
use glam::DVec2;
use nurbs::{Rectangle, Surface};

/// A gap up to this share of the model's extent is healed even where the face states a finer tolerance.
///
/// Modellers keep 1e-7 on parts of any size; files print 7 to 15 digits of numbers that grow with the distance from the
/// origin. 1e-7 is a thousandth of a pixel of a picture of 10,000 pixels a side.
pub(super) const GAP_FLOOR: f64 = 1e-7;

/// What is below this share of a face's size is small, however large the tolerance: no tolerance closes a wider surface,
/// and a gap that no vertex accounts for is closed up to it.
pub(super) const SMALL: f64 = 1e-3;

/// Trims within this share of the domain's length of a border of the domain lie on it.
///
/// Projected borders come out a few thousand ulp aside; 1e-10 of a domain is less than f32 parameters can hold.
const ON_BORDER: f64 = 1e-10;

/// What all steps need to know of the face: its number, surface and tolerances.
pub(super) struct Frame<'a> {
    pub face: usize,
    pub surface: &'a Surface,
    pub domain: Rectangle,
    /// The greatest gap that is healed without a word, model units.
    pub tolerance: f64,
    /// Whether a joint whose vertex has no tolerance may be wider than that.
    pub is_lenient: bool,
    /// [`ON_BORDER`] in parameters.
    pub on_border: DVec2,
    /// Whether the surface's two borders across u, and those across v, are one curve in space.
    pub closed: [bool; 2],
}

impl<'a> Frame<'a> {
    /// `extent` is the greatest distance of the model's control points from the origin.
    pub fn new(face: usize, source: &Face, surface: &'a Surface, extent: f64) -> Self {
        let [[u0, u1], [v0, v1]] = surface.domain();
        let domain = Rectangle { min: DVec2::new(u0, v0), max: DVec2::new(u1, v1) };
        let diagonal = surface.hull().diagonal();
        // A face far from the origin, or small in its model, keeps its features.
        let usual = (GAP_FLOOR * extent).min(SMALL * diagonal).max(GAP_FLOOR * diagonal);
        let tolerance = source.tolerance.max(usual);
        let is_lenient = 0.0 < source.tolerance;
        let on_border = ON_BORDER * domain.size();
        let mut frame = Self { face, surface, domain, tolerance, is_lenient, on_border, closed: [false; 2] };
        frame.closed = [0, 1].map(|axis| frame.is_closed_across(axis));
        frame
    }

    /// Whether the surface's two borders across `axis` (0 = u, 1 = v) are one curve in space: to the tolerance, and to
    /// a [`SMALL`] share of the way from the one to the other, however large that tolerance.
    fn is_closed_across(&self, axis: usize) -> bool {
        const SAMPLES: usize = 16;
        (0..=SAMPLES).all(|i| {
            let (mut low, mut high) = (self.domain.min, self.domain.max);
            let t = low[1 - axis] + (high[1 - axis] - low[1 - axis]) * i as f64 / SAMPLES as f64;
            (low[1 - axis], high[1 - axis]) = (t, t);
            let gap = self.surface.point(low.x, low.y).distance(self.surface.point(high.x, high.y));
            gap <= self.tolerance && gap <= SMALL * self.distance(low, high)
        })
    }

    /// Whether the surface has no border across `axis`: it is closed, or both its sides are points.
    pub fn is_unbounded(&self, axis: usize) -> bool {
        self.ends(axis) == [false; 2]
    }

    /// Whether the surface ends at its two sides across `axis`: it is not closed, and they are no points.
    pub fn ends(&self, axis: usize) -> [bool; 2] {
        let Rectangle { min, max } = self.domain;
        let most = self.tolerance.min(SMALL * self.surface.hull().diagonal());
        let is_point = |at: f64| {
            let (mut a, mut b) = (min, max);
            (a[axis], b[axis]) = (at, at);
            self.distance(a, b) <= most
        };
        [min, max].map(|side| !self.closed[axis] && !is_point(side[axis]))
    }

    /// The length in space of the straight segment from `a` to `b` in parameters, by chords.
    pub fn distance(&self, a: DVec2, b: DVec2) -> f64 {
        const CHORDS: usize = 8;
        let point = |i: usize| {
            let uv = self.wrapped(a + (b - a) * (i as f64 / CHORDS as f64));
            self.surface.point(uv.x, uv.y)
        };
        (0..CHORDS).map(|i| point(i).distance(point(i + 1))).sum()
    }

    /// The point moved by whole periods into the domain, in the directions in which the surface is closed.
    pub fn wrapped(&self, mut uv: DVec2) -> DVec2 {
        let Rectangle { min, max } = self.domain;
        for axis in [0, 1] {
            if self.closed[axis] && !(min[axis] <= uv[axis] && uv[axis] <= max[axis]) {
                uv[axis] = min[axis] + (uv[axis] - min[axis]).rem_euclid(max[axis] - min[axis]);
            }
        }
        uv
    }

    /// The natural boundary, counter-clockwise.
    pub fn boundary(&self) -> Vec<Segment> {
        let Rectangle { min, max } = self.domain;
        let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        (0..4).map(|i| Segment::line(corners[i], corners[(i + 1) % 4])).collect()
    }
}

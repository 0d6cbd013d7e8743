//! Placements in space: an origin and three axes, and the moves from one to another.

use glam::{DMat3, DVec3};

/// A right-handed frame with axes of length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    pub origin: DVec3,
    pub x: DVec3,
    pub y: DVec3,
    pub z: DVec3,
}

impl Frame {
    /// The frame at `origin` whose z is along `axis` and whose x is `reference` without its part along z.
    ///
    /// Where an axis is absent, ISO 10303-42 names the one to take (`build_axes`, `first_proj_axis`): z, and x or, where that
    /// is z, y. A `reference` that is not [`across`](Self::across) z counts as absent. `None` where `axis` has no direction.
    pub fn new(origin: DVec3, axis: Option<DVec3>, reference: Option<DVec3>) -> Option<Self> {
        let z = axis.unwrap_or(DVec3::Z).try_normalize()?;
        let across = |v: DVec3| across(z, v);
        let x = reference.and_then(across).or_else(|| across(DVec3::X)).or_else(|| across(DVec3::Y))?;
        let frame = Self { origin, x, y: z.cross(x), z };
        (origin.is_finite() && frame.y.is_finite()).then_some(frame)
    }

    /// The part of a direction across z, of length 1; `None` where it has no length, or is along z.
    pub fn across(&self, direction: DVec3) -> Option<DVec3> {
        across(self.z, direction)
    }

    /// The point in space of coordinates in this frame.
    pub fn point(&self, local: DVec3) -> DVec3 {
        self.origin + self.x * local.x + self.y * local.y + self.z * local.z
    }

    /// The frame whose x and y are where a move takes them; z is across both, also where the move mirrors.
    pub fn moved(&self, motion: &Motion) -> Self {
        let [x, y] = [self.x, self.y].map(|axis| motion.vector(axis) / motion.factor());
        Self { origin: motion.point(self.origin), x, y, z: x.cross(y) }
    }

    /// The coordinates in this frame of a point in space.
    pub fn local(&self, point: DVec3) -> DVec3 {
        let d = point - self.origin;
        DVec3::new(d.dot(self.x), d.dot(self.y), d.dot(self.z))
    }
}

fn across(z: DVec3, direction: DVec3) -> Option<DVec3> {
    let direction = direction.try_normalize()?;
    (direction - z * direction.dot(z)).try_normalize().filter(|_| direction.cross(z).length() > PARALLEL)
}

/// The sine of the angle below which two directions are one.
const PARALLEL: f64 = 1e-9;

/// A move of space that keeps shapes: a rotation or reflection times a scale, then a translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion {
    linear: DMat3,
    translation: DVec3,
}

impl Motion {
    pub const IDENTITY: Self = Self { linear: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// The move that takes `from` to `to`.
    pub fn between(from: &Frame, to: &Frame) -> Self {
        let [a, b] = [from, to].map(|f| DMat3::from_cols(f.x, f.y, f.z));
        let linear = b * a.transpose();
        Self { linear, translation: to.origin - linear * from.origin }
    }

    /// The move of points in space of a scale about the origin.
    pub fn scale(factor: f64) -> Self {
        Self { linear: DMat3::from_diagonal(DVec3::splat(factor)), translation: DVec3::ZERO }
    }

    /// The move with these images of the axes, and of the origin.
    pub fn new(axes: [DVec3; 3], origin: DVec3) -> Self {
        let [x, y, z] = axes;
        Self { linear: DMat3::from_cols(x, y, z), translation: origin }
    }

    /// This move after `first`.
    pub fn after(&self, first: &Self) -> Self {
        Self { linear: self.linear * first.linear, translation: self.linear * first.translation + self.translation }
    }

    pub fn inverse(&self) -> Self {
        let linear = self.linear.inverse();
        Self { linear, translation: -(linear * self.translation) }
    }

    pub fn point(&self, point: DVec3) -> DVec3 {
        self.linear * point + self.translation
    }

    /// A difference of points, moved.
    pub fn vector(&self, vector: DVec3) -> DVec3 {
        self.linear * vector
    }

    /// How many times as long lengths become.
    pub fn factor(&self) -> f64 {
        libm::cbrt(self.linear.determinant().abs())
    }

    /// Whether left and right are exchanged.
    pub fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}

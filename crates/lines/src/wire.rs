//! What is drawn beside a surface: lines in space that nothing hides.

use glam::DVec3;

/// A line in space.
#[derive(Debug, Clone, PartialEq)]
pub struct Wire {
    /// What it is of.
    pub kind: WireKind,
    /// In order, two at least, world.
    pub points: Vec<DVec3>,
}

/// What a line in space is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WireKind {
    /// A row or a column of control points.
    Net,
    /// A tooth of a curvature comb, or the way along their tips.
    Combs,
}

impl WireKind {
    /// All of them, from what is below to what is on top.
    pub const ALL: [Self; 2] = [Self::Net, Self::Combs];

    /// What it is called in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Net => "net",
            Self::Combs => "combs",
        }
    }
}

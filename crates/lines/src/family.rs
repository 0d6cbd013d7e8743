//! Which lines are wanted.

use glam::DVec3;

/// Lines of one kind, each with a level: the number that tells it from the others.
#[derive(Debug, Clone, PartialEq)]
pub enum Family {
    /// Where the acute angle between normal and light is one of some angles: the level, degrees, above 0 and below 90.
    Isophotes {
        /// Toward the light, world, of unit length.
        light: DVec3,
        /// The angles, degrees.
        degrees: Vec<f64>,
    },
    /// Where the mirrored view direction has one of some components along an axis: the level, above −1 and below 1.
    Reflections {
        /// World, of unit length.
        axis: DVec3,
        /// The components.
        components: Vec<f64>,
    },
    /// Where the normal's line meets a lamp (Beier & Chen 1994, doi:10.1016/0010-4485(94)90073-6); the level is the lamp's number.
    Highlights {
        /// Along the lamps, world, of unit length.
        along: DVec3,
        /// A point of each lamp.
        lamps: Vec<DVec3>,
    },
    /// Where the surface turns away from the eye; the level is 0.
    Silhouettes,
    /// Where a plane cuts; the level is its distance from the origin along its normal.
    Sections {
        /// Of unit length.
        normal: DVec3,
        /// Distances, model units.
        distances: Vec<f64>,
    },
    /// Where a parameter has one of some values: the level, as a share of the domain, above 0 and below 1.
    Parameters {
        /// u (0) or v (1).
        axis: usize,
        /// The shares.
        shares: Vec<f64>,
    },
    /// Where a face ends: its trim loops and the sides of its domain; the level is 0.
    Borders,
    /// The loops of faces that have less material than their whole surface; the level is 0.
    Trims,
}

impl Family {
    /// What it is called in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Isophotes { .. } => "isophotes",
            Self::Reflections { .. } => "reflections",
            Self::Highlights { .. } => "highlights",
            Self::Silhouettes => "silhouettes",
            Self::Sections { .. } => "sections",
            Self::Parameters { axis: 0, .. } => "u-lines",
            Self::Parameters { .. } => "v-lines",
            Self::Borders => "borders",
            Self::Trims => "trims",
        }
    }

    /// How many levels there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Isophotes { degrees, .. } => degrees.len(),
            Self::Reflections { components, .. } => components.len(),
            Self::Highlights { lamps, .. } => lamps.len(),
            Self::Sections { distances, .. } => distances.len(),
            Self::Parameters { shares, .. } => shares.len(),
            Self::Silhouettes | Self::Borders | Self::Trims => 1,
        }
    }

    /// Level number `index`.
    pub fn level(&self, index: usize) -> f64 {
        match self {
            Self::Isophotes { degrees, .. } => degrees[index],
            Self::Reflections { components, .. } => components[index],
            Self::Highlights { .. } => index as f64,
            Self::Sections { distances, .. } => distances[index],
            Self::Parameters { shares, .. } => shares[index],
            Self::Silhouettes | Self::Borders | Self::Trims => 0.0,
        }
    }
}

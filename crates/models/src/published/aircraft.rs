//! An airliner with the counts of Geiger's aircraft (2015, Sec. 3.3.2 and Fig. 20): 158 faces, 3,157 patches, 6,134 curves.
//!
//! Parts run into each other; where they meet nothing is cut, as his trims do. Ours are windows, hatches and vents instead. His
//! Sec. 4.2 speaks of 157 faces, and we keep to the figure. The nose is at x = 0, x points aft, y to the right, z up.

use super::panel::{
    Opening::{self, Hole, Window},
    opened, panels,
};
use crate::construction::{closed, even, sampled};
use glam::{DVec2, DVec3, dvec2};
use libm::{cos, sin};
use nurbs::Surface;
use scene::Loop;
use std::f64::consts::{FRAC_PI_2, TAU};

type Faces = Vec<(Surface, Vec<Loop>)>;

/// Knot spans of nearly all panels.
const SPANS: [usize; 2] = [4, 5];

pub(super) fn aircraft() -> Faces {
    let mut faces = fuselage();
    for side in [1.0, -1.0] {
        faces.extend(wing(side));
        faces.extend(lifting(&STABILIZER, side, 4, 2));
        faces.extend(lifting(&WINGLET, side, 1, 1));
        faces.extend(lifting(&PYLON, side, 1, 1));
        faces.extend(nacelle(side));
    }
    faces.extend(lifting(&FIN, 1.0, 4, 2));
    faces.extend(fairing());
    faces
}

/// Rows of a panel's openings along v.
fn row(count: usize, across: f64, opening: impl Fn(DVec2) -> Opening) -> Vec<Opening> {
    (0..count).map(|k| opening(dvec2(across, (k as f64 + 0.5) / count as f64))).collect()
}

fn hatch(half_u: f64, half_v: f64) -> Vec<Opening> {
    vec![Window { center: DVec2::splat(0.5), half: dvec2(half_u, half_v) }]
}

/// The greatest radius of the fuselage.
const RADIUS: f64 = 0.105;

/// Where it begins and ends to be a cylinder.
const CYLINDER: [f64; 2] = [0.22, 1.32];

/// Its length.
const LENGTH: f64 = 2.0;

/// Middle height, x and radius of the fuselage at a share of its length in parameters.
fn section(v: f64) -> [f64; 3] {
    let [nose, tail] = CYLINDER;
    if v < 0.2 {
        let turn = FRAC_PI_2 * v / 0.2;
        [-0.02 * (1.0 - sin(turn)), nose * (1.0 - cos(turn)), RADIUS * sin(turn)]
    } else if v < 0.65 {
        [0.0, nose + (tail - nose) * (v - 0.2) / 0.45, RADIUS]
    } else {
        let s = (v - 0.65) / 0.35;
        let radius = RADIUS * (1.0 - 0.86 * s * s * (1.5 - 0.5 * s));
        [0.8 * (RADIUS - radius), tail + (LENGTH - tail) * s, radius]
    }
}

/// Windows of the belts from nose to tail; the right one has a door's more.
const BELTS: [[usize; 6]; 2] = [[11, 20, 20, 20, 20, 17], [10, 20, 20, 20, 20, 17]];

/// 8 × 6 panels from the bottom round by the right side.
fn fuselage() -> Faces {
    let skin = closed([8 * SPANS[0], 6 * SPANS[1]], |u, v| {
        let [middle, x, radius] = section(v);
        DVec3::new(x, radius * sin(TAU * u), middle - radius * cos(TAU * u))
    });
    let panel = |(k, panel)| {
        let (sector, ring) = (k / 6, k % 6);
        let belt = |count: usize, across: f64| {
            row(count, across, |center| Window { center, half: dvec2(0.16, 0.28 / count as f64) })
        };
        let openings = match sector {
            2 => belt(BELTS[0][ring], 0.3),
            5 => belt(BELTS[1][ring], 0.7),
            // A drain below the nose.
            0 if ring == 0 => vec![Hole { center: DVec2::splat(0.7), half: DVec2::splat(0.04) }],
            _ => hatch(0.12, 0.04),
        };
        opened(panel, &openings)
    };
    panels(&skin, [&[SPANS[0]; 8], &[SPANS[1]; 6]]).into_iter().enumerate().map(panel).collect()
}

/// A wing of any kind: two sections and what lies between them.
struct Wing {
    /// Where its leading edge begins and ends.
    edge: [DVec3; 2],
    /// The chord at both ends.
    chord: [f64; 2],
    /// Greatest thickness, in chords.
    thickness: f64,
    /// The way in which it is thick.
    above: DVec3,
}

const ROOT: DVec3 = DVec3::new(0.62, 0.05, -0.05);
const TIP: DVec3 = DVec3::new(1.13, 0.95, 0.03);

const STABILIZER: Wing = Wing {
    edge: [DVec3::new(1.72, 0.01, 0.075), DVec3::new(1.93, 0.34, 0.105)],
    chord: [0.22, 0.08],
    thickness: 0.1,
    above: DVec3::Z,
};
const WINGLET: Wing = Wing {
    edge: [TIP, DVec3::new(1.23, 0.985, 0.15)],
    chord: [0.10, 0.03],
    thickness: 0.09,
    above: DVec3::new(0.0, -0.96, 0.28),
};
const PYLON: Wing = Wing {
    edge: [DVec3::new(0.66, 0.34, -0.10), DVec3::new(0.74, 0.34, -0.02)],
    chord: [0.26, 0.2],
    thickness: 0.08,
    above: DVec3::NEG_Y,
};
const FIN: Wing = Wing {
    edge: [DVec3::new(1.58, 0.0, 0.10), DVec3::new(1.93, 0.0, 0.44)],
    chord: [0.34, 0.12],
    thickness: 0.1,
    above: DVec3::NEG_Y,
};

/// Half the thickness of a symmetric four-digit NACA section in chords, for the greatest thickness of one, at x = c².
fn half_thickness(c: f64) -> f64 {
    let x = c * c;
    5.0 * (0.2969 * c - 0.126 * x - 0.3516 * x * x + 0.2843 * x * x * x - 0.1036 * x * x * x * x)
}

impl Wing {
    /// u from the trailing edge below and back over the upper side, v from the root to the tip; `side` −1 mirrors it, and u
    /// then runs the other way, so that S_u × S_v points outward.
    fn at(&self, u: f64, v: f64, side: f64) -> DVec3 {
        let turned = if side < 0.0 { u } else { 1.0 - u };
        let c = cos(TAU / 2.0 * turned);
        let chord = self.chord[0] + (self.chord[1] - self.chord[0]) * v;
        let thick = self.thickness * chord * half_thickness(c.abs()) * if c < 0.0 { -1.0 } else { 1.0 };
        let p = self.edge[0].lerp(self.edge[1], v) + DVec3::X * (chord * c * c) + self.above * thick;
        DVec3::new(p.x, side * p.y, p.z)
    }
}

/// A wing in two panels around and `along` panels, each with a few holes.
fn lifting(wing: &Wing, side: f64, along: usize, holes: usize) -> Faces {
    let [spans_u, spans_v] = SPANS;
    let skin = sampled(even(3, 2 * spans_u + 3), even(3, spans_v * along + 3), |u, v| wing.at(u, v, side));
    let hole = |center| Hole { center, half: dvec2(0.07, 0.12 / holes as f64) };
    let openings = row(holes, 0.5, hole);
    let panels = panels(&skin, [&[spans_u; 2], &vec![spans_v; along]]);
    panels.into_iter().map(|panel| opened(panel, &openings)).collect()
}

/// 4 × 6 panels around and along, with tank covers.
fn wing(side: f64) -> Faces {
    let wing = Wing { edge: [ROOT, TIP], chord: [0.52, 0.11], thickness: 0.12, above: DVec3::Z };
    let [spans_u, spans_v] = SPANS;
    let skin = sampled(even(3, 4 * spans_u + 3), even(3, 6 * spans_v + 3), |u, v| wing.at(u, v, side));
    let openings = row(3, 0.5, |center| Hole { center, half: dvec2(0.1, 0.07) });
    let panels = panels(&skin, [&[spans_u; 4], &[spans_v; 6]]);
    panels.into_iter().map(|panel| opened(panel, &openings)).collect()
}

/// 4 × 3 panels: the inside from the back to the lip, the outside to the nozzle.
fn nacelle(side: f64) -> Faces {
    let skin = closed([4 * SPANS[0], 3 * SPANS[1]], |u, v| {
        let turn = TAU * v;
        // A ring that is longer than thick, thinner towards the nozzle.
        let x = 0.62 + 0.14 * (1.0 + cos(turn));
        let radius = 0.068 - 0.011 * sin(turn) - 0.02 * (x - 0.62) / 0.28 + 0.014;
        DVec3::new(x, side * 0.34 + radius * sin(TAU * u), -0.155 - radius * cos(TAU * u))
    });
    let vent = |center| Window { center, half: dvec2(0.05, 0.1) };
    let openings = row(2, 0.5, vent);
    panels(&skin, [&[SPANS[0]; 4], &[SPANS[1]; 3]]).into_iter().map(|panel| opened(panel, &openings)).collect()
}

/// 3 × 2 panels below the wings' roots, of 9 × 13 spans together.
fn fairing() -> Faces {
    let (around, along): (&[usize], &[usize]) = (&[3; 3], &[7, 6]);
    let skin = sampled(even(3, 9 + 3), even(3, 13 + 3), |u, v| {
        let angle = 2.1 * (u - 0.5);
        let bulge = sin(TAU / 2.0 * v);
        let radius = RADIUS * (0.97 + 0.17 * bulge);
        DVec3::new(0.55 + 0.7 * v, 1.05 * radius * sin(angle), -radius * cos(angle))
    });
    let openings = row(2, 0.5, |center| Window { center, half: dvec2(0.12, 0.08) });
    panels(&skin, [around, along]).into_iter().map(|panel| opened(panel, &openings)).collect()
}

//! An engine, cut open, with the counts of Geiger's turbine (2015, Fig. 30): 221 faces, 87,383 bicubic patches.
//!
//! 200 blades in six wheels, the hub and half the casing round each, an inlet, a spinner, a nozzle and a cone. x points aft, and
//! the half that is cut away is on the side of −y.

use crate::construction::{closed, even, sampled};
use glam::DVec3;
use libm::{cos, sin};
use nurbs::Surface;
use std::f64::consts::{PI, TAU};

/// A wheel of blades.
struct Wheel {
    blades: usize,
    /// Where it begins.
    x: f64,
    /// How long it is.
    length: f64,
    /// Radius at the blades' feet.
    foot: f64,
    /// Radius at their tips.
    tip: f64,
}

const fn wheel(blades: usize, x: f64, length: f64, foot: f64, tip: f64) -> Wheel {
    Wheel { blades, x, length, foot, tip }
}

/// 22 + 30 + 34 + 36 + 38 + 40 = 200 blades.
const WHEELS: [Wheel; 6] = [
    wheel(22, 0.0, 0.26, 0.16, 0.62),
    wheel(30, 0.34, 0.16, 0.24, 0.46),
    wheel(34, 0.54, 0.15, 0.27, 0.44),
    wheel(36, 0.73, 0.14, 0.29, 0.42),
    wheel(38, 0.96, 0.15, 0.28, 0.43),
    wheel(40, 1.15, 0.17, 0.25, 0.46),
];

/// Knot spans of a blade, round its section and along it: 396.
const BLADE: [usize; 2] = [18, 22];

/// Knot spans of what is not a blade: 400.
const SHELL: [usize; 2] = [20, 20];

/// Knot spans of the rim before the fan: 183, so that 200 · 396 + 20 · 400 + 183 = 87,383.
const RIM: [usize; 2] = [61, 3];

pub(super) fn turbine() -> Vec<Surface> {
    let mut surfaces = vec![];
    for (k, wheel) in WHEELS.iter().enumerate() {
        surfaces.extend((0..wheel.blades).map(|blade| wheel.blade(blade, k)));
        let (start, end) = (wheel.x - 0.02, wheel.x + wheel.length + 0.02);
        let next = WHEELS.get(k + 1).map_or(end + 0.1, |next| next.x - 0.02);
        let feet = [wheel.foot, WHEELS.get(k + 1).map_or(0.2, |next| next.foot)];
        surfaces.push(turned(SHELL, |v| [start + (next - start) * v, feet[0] + (feet[1] - feet[0]) * v]));
        let tips = [wheel.tip, WHEELS.get(k + 1).map_or(0.4, |next| next.tip)].map(|tip| tip + 0.015);
        surfaces.push(half(|v| [start + (next - start) * v, tips[0] + (tips[1] - tips[0]) * v * v * (3.0 - 2.0 * v)]));
    }
    let fan = WHEELS[0].tip;
    // A lip round the inlet: half a ring from the fan's casing forward and back along the outside.
    surfaces.push(half(|v| {
        let turn = PI * v;
        [-0.02 - 0.16 * sin(turn), fan + 0.015 + 0.04 * (1.0 - cos(turn))]
    }));
    surfaces.push(half(|v| [-0.02 + 0.62 * v, fan + 0.095 - 0.05 * v * v]));
    // Nozzle, inside and outside, and the duct that leads past the wheels.
    surfaces.push(half(|v| [1.38 + 0.4 * v, 0.415 - 0.1 * v]));
    surfaces.push(half(|v| [1.34 + 0.44 * v, 0.47 - 0.14 * v]));
    surfaces.push(half(|v| [0.6 + 0.74 * v, 0.53 - 0.06 * v]));
    // Spinner and cone, both closed in a point, and a shaft inside.
    surfaces.push(turned(SHELL, |v| [-0.30 + 0.28 * v, 0.16 * sin(PI / 2.0 * v)]));
    surfaces.push(turned(SHELL, |v| [1.42 + 0.4 * (1.0 - cos(PI / 2.0 * v)), 0.2 * cos(PI / 2.0 * v)]));
    surfaces.push(turned(SHELL, |v| [-0.1 + 1.5 * v, 0.06]));
    surfaces.push(turned(RIM, |v| [-0.05 + 0.03 * v, 0.165 + 0.01 * sin(PI * v)]));
    surfaces
}

impl Wheel {
    /// A closed, twisted blade; u round its section from the trailing edge, v from foot to tip.
    fn blade(&self, blade: usize, wheel: usize) -> Surface {
        let place = TAU * blade as f64 / self.blades as f64;
        // Wheels of rotors and stators are set against each other.
        let way = if wheel.is_multiple_of(2) { 1.0 } else { -1.0 };
        sampled(even(3, BLADE[0] + 3), even(3, BLADE[1] + 3), |u, v| {
            let (along, across) = (cos(TAU * u), -sin(TAU * u));
            let chord = 0.5 * self.length * (1.0 - 0.15 * v);
            // Camber and thickness in chords, then the turn by which the section stands against the axis.
            let (x, y) = (chord * along, chord * (0.09 * across + 0.18 * (1.0 - along * along)));
            let twist = way * (0.45 + 0.5 * v);
            let (s, c) = (sin(twist), cos(twist));
            let radius = self.foot - 0.01 + (self.tip - self.foot + 0.01) * v;
            let (axial, around) = (c * x - s * y, s * x + c * y);
            let angle = place + around / radius;
            DVec3::new(self.x + self.length / 2.0 + axial, radius * cos(angle), radius * sin(angle))
        })
    }
}

/// A profile of x and radius, turned round the axis.
fn turned(spans: [usize; 2], profile: impl Fn(f64) -> [f64; 2]) -> Surface {
    closed(spans, |u, v| round(u, profile(v)))
}

/// The same round the half that is not cut away.
fn half(profile: impl Fn(f64) -> [f64; 2]) -> Surface {
    let [around, along] = SHELL;
    sampled(even(3, around + 3), even(3, along + 3), |u, v| round(0.5 * u - 0.25, profile(v)))
}

fn round(turn: f64, [x, radius]: [f64; 2]) -> DVec3 {
    DVec3::new(x, radius * cos(TAU * turn), radius * sin(TAU * turn))
}

//! Concheiro's sixteen scenes: copies of Newell's cup and pot, and of a laid table where the paper has an elephant.

use crate::construction::{clamped, surface};
use crate::tea_set::{teacup, teapot, teaspoon};
use glam::DVec3;
use libm::{cos, sin};
use nurbs::{Direction, Surface};
use std::f64::consts::TAU;

/// A scene of Concheiro et al. 2011, Table 1. The counts are in thousands of 1,024 triangles, as they stand there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TeaScene {
    /// The name that it opens by.
    pub name: &'static str,
    thing: Thing,
    copies: usize,
    /// Bézier surfaces, N_s.
    pub patches: usize,
    /// Triangles with all levels 4, and with levels up to 4.
    pub uniform_4: f64,
    /// The same, adaptive.
    pub adaptive_4: f64,
    /// Triangles with all levels 6.
    pub uniform_6: f64,
    /// The same, adaptive.
    pub adaptive_6: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Thing {
    Cup,
    Pot,
    Table,
}
use Thing::{Cup, Pot, Table};

const fn scene(name: &'static str, thing: Thing, copies: usize, patches: usize, counts: [f64; 4]) -> TeaScene {
    let [uniform_4, adaptive_4, uniform_6, adaptive_6] = counts;
    TeaScene { name, thing, copies, patches, uniform_4, adaptive_4, uniform_6, adaptive_6 }
}

/// Table 1, S1 to S16.
pub const SCENES: &[TeaScene] = &[
    scene("tea-s1", Cup, 1, 26, [48.80, 25.49, 819.05, 432.66]),
    scene("tea-s2", Pot, 1, 32, [60.06, 34.39, 1008.06, 554.98]),
    scene("tea-s3", Cup, 10, 260, [488.01, 254.86, 8190.51, 3815.56]),
    scene("tea-s4", Pot, 10, 320, [600.62, 343.95, 10080.63, 5206.89]),
    scene("tea-s5", Cup, 20, 520, [976.02, 509.72, 16381.02, 6935.26]),
    scene("tea-s6", Pot, 20, 640, [1201.25, 687.90, 20161.25, 9454.31]),
    scene("tea-s7", Cup, 30, 780, [1465.02, 764.59, 24571.52, 9259.56]),
    scene("tea-s8", Table, 1, 811, [1522.21, 1241.23, 25548.08, 14923.50]),
    scene("tea-s9", Pot, 30, 960, [1801.88, 1031.84, 30241.88, 12856.10]),
    scene("tea-s10", Cup, 40, 1040, [1952.03, 1019.45, 32762.03, 10801.40]),
    scene("tea-s11", Pot, 40, 1280, [2402.50, 1375.79, 40322.50, 15142.10]),
    scene("tea-s12", Cup, 50, 1300, [2440.04, 1274.31, 40952.54, 11495.80]),
    scene("tea-s13", Pot, 50, 1600, [3003.12, 1719.74, 50403.13, 16525.70]),
    scene("tea-s14", Cup, 100, 2600, [4880.08, 2548.62, 81905.08, 38865.80]),
    scene("tea-s15", Pot, 100, 3200, [6006.25, 3439.48, 100_806.25, 30826.25]),
    scene("tea-s16", Table, 10, 8110, [15222.09, 12421.30, 255_480.84, 55340.50]),
];

impl TeaScene {
    pub(super) fn surfaces(&self) -> Vec<Surface> {
        let thing = match self.thing {
            Cup => cup(),
            Pot => pot(),
            Table => table(),
        };
        // Rows of five at most where there are few, and a square of ten by ten.
        let columns = if self.copies > 50 { 10 } else { 5.min(self.copies) };
        let step = if self.thing == Table { 1.15 * SIDE } else { 1.1 * PLACE };
        let place = |k: usize| DVec3::new((k % columns) as f64, (k / columns) as f64, 0.0) * step;
        let turn = |k: usize| if self.thing == Table { 0.0 } else { 0.4 * TAU * k as f64 };
        (0..self.copies).flat_map(|k| moved(&thing, 1.0, turn(k), place(k))).collect()
    }
}

/// How much room a cup or a pot has, a side; a pot is 6.5 long and a cup 2 wide.
const PLACE: f64 = 1.0;

/// A pot, about one long.
fn pot() -> Vec<Surface> {
    moved(teapot().surfaces(), 1.0 / 6.6, 0.0, DVec3::ZERO)
}

/// A cup, made to stand, as large as a pot where it is alone.
fn cup() -> Vec<Surface> {
    teacup().surfaces().iter().map(|cup| mapped(cup, |p| DVec3::new(p.x, -p.z, p.y) * 0.45)).collect()
}

/// Things along each side of a table.
const ROW: usize = 6;

/// A table's side.
const SIDE: f64 = ROW as f64 * PLACE;

/// 12 pots, 9 cups and 12 spoons on a board of one patch: 12 · 32 + 9 · 26 + 12 · 16 + 1 = 811.
fn table() -> Vec<Surface> {
    let line = || clamped(3, &[]);
    let corner = |k: usize| DVec3::new((k / 4) as f64, (k % 4) as f64, 0.0) * (SIDE / 3.0);
    let board = surface(line(), line(), (0..16).map(corner).collect(), None);
    let [pot, cup] = [pot(), moved(&cup(), 0.6, 0.0, DVec3::ZERO)];
    let spoon = moved(teaspoon().surfaces(), 0.35, 0.0, DVec3::Z * 0.05);
    let mut surfaces = vec![board];
    for k in 0..12 + 9 + 12 {
        // A pot, a cup and a spoon in turn, until the cups are spent.
        let thing = if k < 27 { [&pot, &cup, &spoon][k % 3] } else { [&pot, &spoon][k % 2] };
        let place = DVec3::new((k % ROW) as f64 + 0.5, (k / ROW) as f64 + 0.5, 0.0) * PLACE;
        surfaces.extend(moved(thing, 1.0, TAU / 8.0 * (k / ROW) as f64, place));
    }
    surfaces
}

/// The same things, larger by `scale`, turned about the vertical by `angle_rad`, then moved.
fn moved(things: &[Surface], scale: f64, angle_rad: f64, by: DVec3) -> Vec<Surface> {
    let (c, s) = (cos(angle_rad), sin(angle_rad));
    let at = |p: DVec3| DVec3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z) * scale + by;
    things.iter().map(|thing| mapped(thing, at)).collect()
}

fn mapped(thing: &Surface, at: impl Fn(DVec3) -> DVec3) -> Surface {
    let [u, v] = [Direction::U, Direction::V].map(|direction| thing.knots(direction).clone());
    surface(u, v, thing.points().iter().map(|&p| at(p)).collect(), None)
}

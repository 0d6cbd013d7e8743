//! Measures rays a second on one thread: `cargo run --release -p raycast --example ray_rate [REPEATS]`.
//!
//! The surface is a bicubic rational one of 14 × 6 control points (33 patches), a wavy sheet with random weights. "Top-down" rays
//! come from above within a cone of 25°, "grazing" ones meet it at 1° to 12° from the plane of the sheet.

use glam::DVec3;
use nurbs::{KnotVector, Surface};
use raycast::Caster;
use scene::{Model, Ray};
use std::hint::black_box;
use std::time::Instant;

/// Rays of each kind.
const RAYS: usize = 20_000;

/// A small generator of numbers in [0, 1), the same on every machine (Steele & Vigna 2021, splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

fn clamped(degree: usize, count: usize) -> KnotVector {
    let spans = count - degree;
    let mut knots = vec![0.0; degree];
    knots.extend((0..=spans).map(|k| k as f64 / spans as f64));
    knots.extend(vec![1.0; degree]);
    KnotVector::new(degree, knots).expect("a clamped uniform knot vector is legal")
}

fn main() {
    let repeats: usize = std::env::args().nth(1).map_or(5, |n| n.parse().expect("REPEATS is a number"));
    let mut random = Random(1);
    let (nu, nv) = (14, 6);
    let mut points = vec![];
    let mut weights = vec![];
    for i in 0..nu {
        for j in 0..nv {
            let (x, y) = (i as f64 / (nu - 1) as f64 * 2.0 - 1.0, j as f64 / (nv - 1) as f64 * 2.0 - 1.0);
            let jitter =
                DVec3::new(random.between(-0.03, 0.03), random.between(-0.06, 0.06), random.between(-0.15, 0.15));
            points.push(DVec3::new(x, y, 0.3 * (4.0 * x).sin() * (2.0 * y).cos()) + jitter);
            weights.push(random.between(0.6, 1.7));
        }
    }
    let surface = Surface::new(clamped(3, nu), clamped(3, nv), points, Some(weights)).expect("legal");
    let model = Model::of_surfaces("rate", vec![surface]).expect("one surface");
    let built = Instant::now();
    let caster = Caster::new(&model);
    println!("{} pieces, built in {:.1?}", caster.piece_count(), built.elapsed());

    let mut rays = |low_deg: f64, high_deg: f64| -> Vec<Ray> {
        (0..RAYS)
            .map(|_| {
                let (elevation, around) =
                    (random.between(low_deg, high_deg).to_radians(), random.between(0.0, std::f64::consts::TAU));
                let direction =
                    -DVec3::new(elevation.cos() * around.cos(), elevation.cos() * around.sin(), elevation.sin());
                let target =
                    DVec3::new(random.between(-0.8, 0.8), random.between(-0.8, 0.8), random.between(-0.1, 0.1));
                Ray { origin: target - direction * 5.0, direction, near: 0.0 }
            })
            .collect()
    };
    let kinds = [("top-down", rays(65.0, 90.0)), ("grazing", rays(1.0, 12.0))];
    for _ in 0..repeats {
        for (name, rays) in &kinds {
            let start = Instant::now();
            let mut hits = 0;
            let mut undecided = 0;
            for ray in rays {
                let cast = black_box(caster.first(black_box(ray)));
                hits += usize::from(cast.hit.is_some());
                undecided += usize::from(cast.undecided.is_some());
            }
            let first = start.elapsed().as_secs_f64() / rays.len() as f64 * 1e6;
            let start = Instant::now();
            let (mut every, mut boxes) = (0, 0);
            for ray in rays {
                let all = black_box(caster.all(black_box(ray)));
                every += all.hits.len();
                boxes += all.boxes;
            }
            let all = start.elapsed().as_secs_f64() / rays.len() as f64 * 1e6;
            println!(
                "{name:9} first {first:6.2} us/ray ({hits} hits, {undecided} undecided), all {all:6.2} us/ray ({:.2} hits, {:.1} boxes a ray)",
                every as f64 / rays.len() as f64,
                boxes as f64 / rays.len() as f64
            );
        }
    }
}

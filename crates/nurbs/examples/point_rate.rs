//! Measures points a second on one thread: `cargo run --release -p nurbs --example point_rate [REPEATS [NAME]]`.
//!
//! Times are by the thread's own clock, so that others on the machine do not count. `NAME` is a part of the names of what is measured.
//!
//! S, S_u, S_v and the unit normal of a bicubic rational surface of 14 × 6 control points, at 65,536 points: one by one, as a
//! list, and as a grid.

use glam::{DVec2, DVec3};
use nurbs::{Evaluation, KnotVector, Surface};
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;

/// Points a side of the grid.
const SIDE: usize = 256;

/// Points that are asked for together: their answers stay in the processor's cache.
const TOGETHER: usize = 1024;

fn clamped(count: usize) -> KnotVector {
    let inner = (1..count - 3).map(|k| k as f64 / (count - 3) as f64);
    KnotVector::new(3, [0.0; 4].into_iter().chain(inner).chain([1.0; 4]).collect()).expect("clamped uniform")
}

/// What this thread has taken, ns; 0 under callgrind, which counts instructions instead and does not know this clock.
fn now() -> f64 {
    if std::env::var_os("COUNT").is_some() {
        return 0.0;
    }
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 * 1e9 + time.tv_nsec as f64
}

fn main() {
    let repeats: usize = std::env::args().nth(1).map_or(20, |n| n.parse().expect("REPEATS is a number"));
    let wanted = std::env::args().nth(2).unwrap_or_default();
    let wave = |k: usize| (k as f64 * 12.9898).sin();
    let points = (0..14 * 6).map(|k| DVec3::new((k / 6) as f64, (k % 6) as f64, wave(k)));
    let weights = (0..14 * 6).map(|k| 1.0 + 0.4 * wave(k + 7)).collect();
    let surface = Surface::new(clamped(14), clamped(6), points.collect(), Some(weights)).expect("legal");
    let steps: Vec<f64> = (0..SIDE).map(|i| (i as f64 + 0.5) / SIDE as f64).collect();
    let scan: Vec<DVec2> = steps.iter().flat_map(|&u| steps.iter().map(move |&v| DVec2::new(u, v))).collect();
    // An additive recurrence with the plastic number.
    let g = 1.324_717_957_244_746;
    let spread = |i: usize| DVec2::new((i as f64 / g).fract(), (i as f64 / (g * g)).fract());
    let spread: Vec<DVec2> = (0..SIDE * SIDE).map(spread).collect();
    let mut out: Vec<Evaluation> = Vec::with_capacity(SIDE * SIDE);
    let mut measure = |name: &str, work: &mut dyn FnMut(&mut Vec<Evaluation>)| {
        if !name.contains(&wanted) {
            return;
        }
        let mut times: Vec<f64> = (0..repeats)
            .map(|_| {
                let start = now();
                work(&mut out);
                (now() - start) / (SIDE * SIDE) as f64
            })
            .collect();
        times.sort_by(f64::total_cmp);
        println!("{name:44} {:6.1} ns a point (least {:.1})", times[repeats / 2], times[0]);
    };
    for (order, at) in [("scan order", &scan), ("spread", &spread)] {
        measure(&format!("one by one, normal by hand, {order}"), &mut |_| {
            for uv in at {
                let d = surface.first_derivatives(uv.x, uv.y);
                black_box((d.s, d.su.cross(d.sv).normalize()));
            }
        });
        measure(&format!("one by one, {order}"), &mut |out| {
            for at in at.chunks(TOGETHER) {
                out.clear();
                out.extend(at.iter().map(|uv| surface.evaluate(uv.x, uv.y)));
                black_box(&mut *out);
            }
        });
        measure(&format!("list, {order}"), &mut |out| {
            for at in at.chunks(TOGETHER) {
                out.clear();
                surface.evaluate_many(at, out);
                black_box(&mut *out);
            }
        });
    }
    measure("grid", &mut |out| {
        for u in steps.chunks(TOGETHER / SIDE) {
            out.clear();
            surface.evaluate_grid(u, &steps, out);
            black_box(&mut *out);
        }
    });
}

//! The enclosure holds whatever an adapter may do, and is no wider than it need be.

mod machine;

use glam::DVec3;
use machine::{DIRECTIONS, Direction, Machine, Random, Returned};
use nurbs::{KnotVector, Surface};
use pipeline::enclosure::{Enclosure, Enclosures, Interval, Parameter, Regularity, enclose};
use pipeline::{PackedScene, Scheme};
use rayon::prelude::*;
use scene::Model;

/// Surfaces, places on each, and evaluations at each place: 1,036,800 in all.
const SURFACES: u64 = 240;
const PLACES: usize = 18;
const EVALUATIONS: usize = 24;

/// A knot vector that stresses something.
fn knots(random: &mut Random, degree: usize) -> KnotVector {
    let kind = random.below(5);
    let spans = random.below(4) + 1;
    let mut interior = vec![];
    for _ in 1..spans {
        let knot = match kind {
            // Tiny spans, and others.
            1 if !interior.is_empty() && random.coin() => interior[0] + random.between(1e-7, 1e-5),
            _ => random.between(0.05, 0.95),
        };
        let multiplicity = if kind == 2 { random.below(degree) + 1 } else { 1 };
        interior.extend(std::iter::repeat_n(knot, multiplicity));
    }
    interior.sort_by(f64::total_cmp);
    let mut all;
    if kind == 3 {
        // Unclamped.
        let mut knot = 0.0;
        all = (0..2 * (degree + 1) + interior.len())
            .map(|_| {
                knot += random.between(0.1, 1.0);
                knot
            })
            .collect::<Vec<_>>();
    } else {
        all = vec![0.0; degree + 1];
        all.extend(interior);
        all.extend(vec![1.0; degree + 1]);
    }
    let (start, length) = if kind == 4 { (random.between(-1e3, 1e3), random.between(1e-2, 1e3)) } else { (0.0, 1.0) };
    for knot in &mut all {
        *knot = start + length * *knot;
    }
    KnotVector::new(degree, all).expect("a legal knot vector")
}

/// A surface of any degrees to 9: a sheet, bulging or noisy, with weights in a ratio of up to 1 : 1000.
fn surface(random: &mut Random) -> Surface {
    let degree = [random.below(9) + 1, random.below(9) + 1];
    let degree = if random.coin() { [3, 3] } else { degree };
    let [ku, kv] = degree.map(|p| knots(random, p));
    let [rows, columns] = [&ku, &kv].map(|k| k.control_count());
    let noise = [0.0, 0.05, 0.5][random.below(3)];
    let bulge = random.between(-2.0, 2.0);
    let collapsed = random.below(8) == 0;
    let mut points = vec![];
    for i in 0..rows {
        for j in 0..columns {
            let (x, y) = (i as f64 / (rows - 1) as f64 - 0.5, j as f64 / (columns - 1) as f64 - 0.5);
            let y = if collapsed && i == 0 { 0.0 } else { y };
            let mut jitter = || noise * random.between(-0.5, 0.5);
            points.push(DVec3::new(x + jitter(), y + jitter(), bulge * (x * x + y * y) + jitter()));
        }
    }
    let offset = if random.below(4) == 0 { DVec3::splat(1e4) } else { DVec3::ZERO };
    for point in &mut points {
        *point += offset;
    }
    let weights = random.coin().then(|| points.iter().map(|_| 10f64.powf(random.between(-3.0, 0.0))).collect());
    Surface::new(ku, kv, points, weights).expect("a legal surface")
}

fn packed(random: &mut Random) -> PackedScene {
    let mut model = Model::of_surfaces("random", vec![surface(random)]).expect("one face");
    if random.coin() {
        let mut faces = model.faces().to_vec();
        faces[0].reversed = true;
        model = Model::new("random", model.surfaces().to_vec(), faces).expect("one face");
    }
    let scheme = if random.coin() { Scheme::General } else { Scheme::Specialised };
    PackedScene::new(&model, scheme).expect("a usable size")
}

/// A place: anywhere, on a knot, beside one, or at an end.
fn place(random: &mut Random, scene: &PackedScene) -> [f32; 2] {
    let face = scene.faces[0];
    scene.knots(&face).map(|knots| {
        let t = match random.below(4) {
            0 => knots[random.below(knots.len())],
            1 => knots[random.below(knots.len())] + random.between(0.0, 1e-6) as f32,
            _ => random.unit() as f32,
        };
        t.clamp(0.0, 1.0)
    })
}

/// Shares of the half-widths that something returned uses; infinite where it is not allowed at all.
#[derive(Debug, Clone, Copy, Default)]
struct Used {
    position: f64,
    normal: f64,
    curvature: f64,
}

fn greatest<const N: usize>(intervals: Option<[Interval; N]>, found: [f32; N]) -> f64 {
    let shares =
        intervals.map(|intervals| std::array::from_fn::<f64, N, _>(|c| intervals[c].share(f64::from(found[c]))));
    shares.map_or(0.0, |shares| shares.into_iter().fold(0.0, f64::max))
}

fn used(enclosure: &Enclosure, returned: &Returned) -> Used {
    let position = greatest(enclosure.position, returned.position);
    let forbidden = if returned.regular { Regularity::Degenerate } else { Regularity::Regular };
    if enclosure.regularity == forbidden {
        return Used { position, normal: f64::INFINITY, curvature: 0.0 };
    }
    if !returned.regular {
        return Used { position, ..Used::default() };
    }
    Used {
        position,
        normal: greatest(enclosure.normal, returned.normal),
        curvature: greatest(enclosure.curvature, returned.curvature),
    }
}

fn only(enclosures: &Enclosures) -> Enclosure {
    assert_eq!(enclosures.iter().count(), 1, "exact parameters lie on one pair of spans");
    *enclosures.iter().next().expect("one")
}

/// What was found over many evaluations.
#[derive(Debug, Clone, Copy, Default)]
struct Found {
    evaluations: usize,
    normals: usize,
    curvatures: usize,
    outside: usize,
    most: Used,
}

impl Found {
    fn and(self, other: Self) -> Self {
        Self {
            evaluations: self.evaluations + other.evaluations,
            normals: self.normals + other.normals,
            curvatures: self.curvatures + other.curvatures,
            outside: self.outside + other.outside,
            most: Used {
                position: self.most.position.max(other.most.position),
                normal: self.most.normal.max(other.most.normal),
                curvature: self.most.curvature.max(other.most.curvature),
            },
        }
    }
}

/// Evaluates random surfaces on random machines; `allowed` is the share of the half-widths that counts as inside.
fn evaluate(surfaces: std::ops::Range<u64>, allowed: f64) -> Found {
    let one = |seed: u64| {
        let mut random = Random(seed);
        let scene = packed(&mut random);
        let mut found = Found::default();
        for _ in 0..PLACES {
            let uv = place(&mut random, &scene);
            let enclosure = only(&enclose(&scene, 0, uv.map(Parameter::exact), true));
            for k in 0..EVALUATIONS {
                let direction = DIRECTIONS[k % DIRECTIONS.len()];
                let mut machine = Machine { random: Random(random.next()), direction };
                let returned = machine.fragment(&scene, 0, uv);
                let share = used(&enclosure, &returned);
                let most = share.position.max(share.normal).max(share.curvature);
                if most > allowed && allowed == 1.0 {
                    eprintln!("seed {seed}, {uv:?}, {direction:?}: {share:?}\n{enclosure:?}\n{returned:?}");
                }
                found = found.and(Found {
                    evaluations: 1,
                    normals: usize::from(enclosure.normal.is_some()),
                    curvatures: usize::from(enclosure.curvature.is_some()),
                    outside: usize::from(most > allowed),
                    most: share,
                });
            }
        }
        found
    };
    surfaces.into_par_iter().map(one).reduce(Found::default, Found::and)
}

#[test]
fn a_million_evaluations_by_any_adapter_lie_inside() {
    let found = evaluate(0..SURFACES, 1.0);
    println!("{found:?}");
    assert!(found.evaluations >= 1_000_000, "{found:?}");
    assert!(found.normals >= found.evaluations / 2 && found.curvatures >= found.evaluations / 2, "{found:?}");
    assert_eq!(found.outside, 0, "{found:?}");
    // An enclosure that nothing comes near proves little.
    assert!(found.most.position > 0.5 && found.most.normal > 0.2 && found.most.curvature > 0.2, "{found:?}");
}

/// Half-widths and errors of the strict program at random places of regular bicubic faces, by quantity.
#[test]
fn figures() {
    for name in ["teapot", "surface", "rational", "sphere"] {
        let model = formats::builtin(name).expect("built in");
        let scene = PackedScene::new(&model, Scheme::Specialised).expect("packable");
        let mut random = Random(7);
        let mut pairs: [Vec<(f64, f64, f64)>; 3] = Default::default();
        let mut seconds = 0.0;
        let count = 20000;
        for _ in 0..count {
            let face = random.below(scene.faces.len()) as u32;
            let uv = [random.unit() as f32, random.unit() as f32];
            let fragment = pipeline::fragment::fragment(&scene, face, uv, true);
            let start = std::time::Instant::now();
            let e = only(&enclose(&scene, face, uv.map(Parameter::exact), true));
            seconds += start.elapsed().as_secs_f64();
            let (Some(s), Some(n), Some(k)) = (e.position, e.normal, e.curvature) else { continue };
            let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
            let mut push = |at: usize, intervals: &[Interval], found: &[f32]| {
                let errors: Vec<f64> = intervals.iter().zip(found).map(|(i, x)| f64::from(*x) - i.middle).collect();
                let halves: Vec<f64> = intervals.iter().map(|i| i.half_width).collect();
                let share = intervals.iter().zip(found).map(|(i, x)| i.share(f64::from(*x))).fold(0.0, f64::max);
                pairs[at].push((length(&halves), length(&errors), share));
            };
            push(0, &s, &fragment.position);
            push(1, &n, &fragment.normal);
            push(2, &k, &fragment.curvature);
        }
        println!("{name}: {:.2} µs", 1e6 * seconds / count as f64);
        for (what, pairs) in ["S", "n", "k"].iter().zip(&pairs) {
            let sorted = |f: fn(&(f64, f64, f64)) -> f64| {
                let mut all: Vec<f64> = pairs.iter().map(f).collect();
                all.sort_by(f64::total_cmp);
                all
            };
            let (halves, errors, shares) = (sorted(|p| p.0), sorted(|p| p.1), sorted(|p| p.2));
            let m = pairs.len() / 2;
            println!(
                "  {what}: half {:.3e} error {:.3e} ratio {:.1}; to largest {:.1}; largest share {:.3}; ({})",
                halves[m],
                errors[m],
                halves[m] / errors[m],
                halves[m] / errors[pairs.len() - 1],
                shares[pairs.len() - 1],
                pairs.len()
            );
        }
    }
}

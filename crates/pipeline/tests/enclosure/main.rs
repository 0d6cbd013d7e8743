//! The enclosure holds whatever an adapter may do, and is no wider than it need be.

mod machine;

use gbuffer::Hit;
use glam::DVec3;
use machine::{DIRECTIONS, Machine, Random, Returned};
use nurbs::{Direction, KnotVector, Normal, Surface};
use pipeline::enclosure::{Enclosure, Enclosures, Interval, Known, Regularity, enclose};
use pipeline::fragment::fragment;
use pipeline::{PackedScene, Parameters, Scheme};
use rayon::prelude::*;
use scene::{Model, Ray};

/// Surfaces, places on each, and evaluations at each place: 1,036,800 in all.
const SURFACES: u64 = 2400;
const PLACES: usize = 18;
const EVALUATIONS: usize = 24;

/// Any ray: its hits are of no interest.
const RAY: Ray = Ray { origin: DVec3::ZERO, direction: DVec3::Z, near: 0.0 };

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

fn model(random: &mut Random) -> Model {
    let mut model = Model::of_surfaces("random", vec![surface(random)]).expect("one face");
    if random.coin() {
        let mut faces = model.faces().to_vec();
        faces[0].reversed = true;
        model = Model::new("random", model.surfaces().to_vec(), faces).expect("one face");
    }
    model
}

fn packed(random: &mut Random, model: &Model) -> PackedScene {
    let scheme = if random.coin() { Scheme::General } else { Scheme::Specialised };
    PackedScene::new(model, scheme).expect("a usable size")
}

/// A place: on any spans, anywhere, at an end, or beside one.
fn place(random: &mut Random, scene: &PackedScene) -> Parameters {
    let face = scene.faces()[0];
    let span = [face.spans_u, face.spans_v].map(|spans| random.below(spans as usize) as u32);
    let uv = [0, 1].map(|_| {
        let end = random.below(2) as f32;
        match random.below(4) {
            0 => end,
            1 => (end + random.between(-1e-6, 1e-6) as f32).clamp(0.0, 1.0),
            _ => random.unit() as f32,
        }
    });
    Parameters { span, uv }
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
        let model = model(&mut random);
        let scene = packed(&mut random, &model);
        let mut found = Found::default();
        for _ in 0..PLACES {
            let at = place(&mut random, &scene);
            let enclosure = only(&enclose(&scene, 0, &Known::exact(at), true));
            for k in 0..EVALUATIONS {
                let direction = DIRECTIONS[k % DIRECTIONS.len()];
                let mut machine = Machine { random: Random(random.next()), direction };
                let returned = machine.fragment(&scene, 0, at);
                let share = used(&enclosure, &returned);
                let most = share.position.max(share.normal).max(share.curvature);
                if most > allowed && allowed == 1.0 {
                    eprintln!("seed {seed}, {at:?}, {direction:?}: {share:?}\n{enclosure:?}\n{returned:?}");
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

#[test]
fn an_enclosure_that_is_too_narrow_is_noticed() {
    for allowed in [0.5, 0.25] {
        let found = evaluate(0..60, allowed);
        assert!(found.outside > 0, "{found:?}");
    }
}

/// A renderer whose parameters are no f32 may have evaluated at either neighbour, and on either side of a knot.
#[test]
fn parameters_that_are_not_known_to_the_bit_allow_both_neighbours() {
    let mut ambiguous = 0;
    for seed in 0..300 {
        let mut random = Random(seed);
        let model = model(&mut random);
        let scene = packed(&mut random, &model);
        let Parameters { span, uv } = place(&mut random, &scene);
        let [u, v] = uv.map(|t| t.clamp(f32::EPSILON, 1.0 - f32::EPSILON));
        let frame = &scene.frames()[0];
        let between =
            |span: [u32; 2], uv: [f32; 2]| 0.5 * (frame.uv(span, uv) + frame.uv(span, uv.map(f32::next_down)));
        // In the middle of two f32, or where two spans meet.
        let at_knots = seed % 4 == 0 && (0..2).all(|k| span[k] > 0);
        let uv = if at_knots { frame.uv(span, [0.0; 2]) } else { between(span, [u, v]) };
        let hit = scene.hit(&fragment(&scene, 0, Parameters { span, uv: [u, v] }, true), &RAY);
        let known = frame.known(&Hit { uv, local: None, ..hit });
        let enclosures = enclose(&scene, 0, &known, true);
        ambiguous += usize::from(enclosures.iter().count() > 1);
        let places = if at_knots {
            let [k, l] = span;
            [(span, [0.0; 2]), ([k - 1, l], [1.0, 0.0]), ([k, l - 1], [0.0, 1.0]), ([k - 1, l - 1], [1.0; 2])]
        } else {
            let below = [u, v].map(f32::next_down);
            [[u, v], [below[0], v], [u, below[1]], below].map(|uv| (span, uv))
        };
        for (span, uv) in places {
            let mut machine = Machine { random: Random(seed), direction: DIRECTIONS[seed as usize % DIRECTIONS.len()] };
            let returned = machine.fragment(&scene, 0, Parameters { span, uv });
            let most = |e: &Enclosure| {
                let share = used(e, &returned);
                share.position.max(share.normal).max(share.curvature)
            };
            let least = enclosures.iter().map(most).fold(f64::INFINITY, f64::min);
            assert!(least <= 1.0, "seed {seed} at {uv:?}: {least} of {enclosures:?}, {returned:?}");
        }
    }
    assert!(ambiguous > 10, "{ambiguous}");
}

/// At the model's own knots and control points, in f64, all lies where narrowing may have put it.
#[test]
fn the_surface_in_f64_lies_within_the_packing_bound() {
    let (mut most, mut checked) = (Used::default(), 0);
    for seed in 0..1500 {
        let mut random = Random(seed);
        let model = model(&mut random);
        let scene = packed(&mut random, &model);
        let frame = &scene.frames()[0];
        let surface = &model.surfaces()[0];
        for _ in 0..8 {
            let at = place(&mut random, &scene);
            let e = only(&enclose(&scene, 0, &Known::exact(at), true));
            let (u, v) = frame.uv(at.span, at.uv).into();
            let Some(s) = e.position else { continue };
            checked += 1;
            let narrowed = |x: Interval| Interval { half_width: x.packing, ..x };
            let within = |intervals: &[Interval], found: &[f64], slack: f64| {
                let shares = intervals.iter().zip(found).map(|(i, x)| {
                    let error = ((x - i.middle).abs() - slack).max(0.0);
                    narrowed(*i).share(i.middle + error)
                });
                shares.fold(0.0, f64::max)
            };
            let [k, l] = [Direction::U, Direction::V]
                .map(|d| surface.knots(d).spans().nth(at.span[d as usize] as usize).expect("a span of the face"));
            let point = surface.inspect_on(k, l, u, v);
            let sign = if model.faces()[0].reversed { -1.0 } else { 1.0 };
            let local = (point.derivatives.s - frame.origin) / frame.scale;
            let lost = 4.0 * f64::EPSILON * frame.origin.abs().max_element() / frame.scale;
            most.position = most.position.max(within(&s, &local.to_array(), lost));
            if let (Some(n), Normal::Regular(found)) = (e.normal, point.normal) {
                most.normal = most.normal.max(within(&n, &(sign * found).to_array(), 1e-14));
            }
            if let (Some(k), Some(found)) = (e.curvature, point.curvature) {
                let [k1, k2] = if sign < 0.0 { [-found.k2, -found.k1] } else { [found.k1, found.k2] };
                let size = 1e-10 * frame.scale * k1.abs().max(k2.abs());
                most.curvature = most.curvature.max(within(&k, &[k1 * frame.scale, k2 * frame.scale], size));
            }
        }
    }
    println!("{checked} places, largest shares {most:?}");
    assert!(checked > 5000, "{checked}");
    assert!(most.position <= 1.0 && most.normal <= 1.0 && most.curvature <= 1.0, "{most:?}");
    assert!(most.position > 0.1 && most.normal > 0.1, "{most:?}");
}

/// Half-widths against the errors of the CPU's program, as lengths over the coordinates of a quantity, at random places
/// of regular bicubic faces.
#[test]
fn half_widths_are_of_the_size_of_the_errors_seen() {
    for name in ["teapot", "surface", "rational"] {
        let model = models::builtin(name).expect("built in");
        let scene = PackedScene::new(&model, Scheme::Specialised).expect("packable");
        let mut random = Random(7);
        // Half-widths and errors of S, the normal, the curvatures.
        let mut seen: [[Vec<f64>; 2]; 3] = Default::default();
        for _ in 0..20_000 {
            let face = random.below(scene.faces().len()) as u32;
            let searched = Parameters::searched([random.unit() as f32, random.unit() as f32]);
            let fragment = fragment(&scene, face, searched, true);
            let at = Parameters { span: fragment.span, uv: fragment.uv };
            let e = only(&enclose(&scene, face, &Known::exact(at), true));
            let (Some(s), Some(n), Some(k)) = (e.position, e.normal, e.curvature) else { continue };
            let quantities: [(&[Interval], &[f32]); 3] =
                [(&s, &fragment.position), (&n, &fragment.normal), (&k, &fragment.curvature)];
            for ((intervals, found), [halves, errors]) in quantities.into_iter().zip(&mut seen) {
                let length = |of: &dyn Fn(usize) -> f64| (0..found.len()).map(|c| of(c) * of(c)).sum::<f64>().sqrt();
                halves.push(length(&|c| intervals[c].half_width));
                errors.push(length(&|c| f64::from(found[c]) - intervals[c].middle));
            }
        }
        for (quantity, [mut halves, mut errors]) in ["S", "n", "k"].into_iter().zip(seen) {
            halves.sort_by(f64::total_cmp);
            errors.sort_by(f64::total_cmp);
            let at = |sorted: &[f64], share: f64| sorted[(share * (sorted.len() - 1) as f64) as usize];
            let half = at(&halves, 0.5);
            let [median, high, most] = [0.5, 0.99, 1.0].map(|share| half / at(&errors, share));
            println!(
                "{name} {quantity}: {half:.2e}, {median:.1} of the median error, {high:.1} of the 99th percentile, {most:.1} of the largest"
            );
            // Strictly to nearest, nothing uses more than a sixth: the median is what WGSL's freedoms cost.
            assert!(high <= 32.0, "{name} {quantity}: {high}");
        }
    }
}

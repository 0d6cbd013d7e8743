//! Small models, made from a seed.

use glam::DVec3;
use nurbs::{KnotVector, Surface};
use pipeline::{PackedScene, Parameters};
use scene::{Face, Model};

/// Splitmix64 (Steele, Lea & Flood 2014): enough to scatter numbers.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform from 0 up to 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
}

/// Knots over 0 to 1 with a few uneven interior knots, some of them multiple; ends clamped or not.
fn knots(random: &mut Random, degree: usize) -> KnotVector {
    let spans = 1 + random.below(4);
    let mut interior: Vec<f64> = vec![];
    for i in 1..spans {
        let t = (i as f64 + random.between(-0.3, 0.3)) / spans as f64;
        interior.extend(vec![t; 1 + random.below(degree)]);
    }
    let clamped = random.below(2) == 0;
    let mut beyond = |sign: f64, end: f64| -> Vec<f64> {
        let mut distance = 0.0;
        let mut step = || {
            distance += if clamped { 0.0 } else { random.between(0.05, 0.4) };
            end + sign * distance
        };
        (0..degree).map(|_| step()).collect()
    };
    let mut all = beyond(-1.0, 0.0);
    all.reverse();
    all.push(0.0);
    all.extend(interior);
    all.push(1.0);
    all.extend(beyond(1.0, 1.0));
    KnotVector::new(degree, all).expect("legal by construction")
}

/// A bumpy sheet over the unit square of the xy plane, of the given degrees.
pub fn sheet(random: &mut Random, degree: [usize; 2], rational: bool, bump: f64) -> Surface {
    let [ku, kv] = degree.map(|p| knots(random, p));
    let (n, m) = (ku.control_count(), kv.control_count());
    let mut points = vec![];
    let mut weights = vec![];
    for i in 0..n {
        for j in 0..m {
            let x = i as f64 / (n - 1) as f64 - 0.5;
            let y = j as f64 / (m - 1) as f64 - 0.5;
            points.push(DVec3::new(x, y, random.between(-bump, bump)));
            weights.push(random.between(0.4, 2.5));
        }
    }
    Surface::new(ku, kv, points, rational.then_some(weights)).expect("legal by construction")
}

/// Sheets of several degrees, rational and not, every third face reversed, side by side.
pub fn assorted(seed: u64) -> Model {
    let mut random = Random::new(seed);
    let degrees = [[3, 3], [1, 1], [2, 3], [1, 4], [5, 2], [5, 5], [7, 7], [4, 9], [15, 3], [15, 15]];
    let mut surfaces = vec![];
    for degree in degrees {
        for rational in [false, true] {
            surfaces.push(sheet(&mut random, degree, rational, 0.3));
        }
    }
    let faces = (0..surfaces.len()).map(|i| Face { reversed: i % 3 == 2, ..Face::whole(i) }).collect();
    Model::new(format!("assorted {seed}"), surfaces, faces).expect("has faces")
}

/// Places of a face: on any spans, inside and at their ends, and by parameters of the whole domain, at knots and beside them, too.
pub fn place(random: &mut Random, scene: &PackedScene, face: u32) -> Parameters {
    let record = &scene.faces()[face as usize];
    if random.below(2) == 0 {
        let span = [record.spans_u, record.spans_v].map(|spans| random.below(spans as usize) as u32);
        let uv = [0, 1].map(|_| if random.below(4) == 0 { random.below(2) as f32 } else { random.unit() as f32 });
        return Parameters { span, uv };
    }
    Parameters::searched(scene.starts(record).map(|starts| match random.below(4) {
        0 => starts[random.below(starts.len())],
        1 => starts[random.below(starts.len())].next_down().max(0.0),
        _ => random.unit() as f32,
    }))
}

//! The kernels that choose levels and place tiles, asked in numbers: whether a device comes to the same levels, tiles and draw calls as
//! their twin in Rust. A picture shows a level that is one too high nowhere, and a tile that is drawn twice neither.

use super::gpu::{Chosen, DrawCall, Generator, bunch_of};
use super::grids::Grids;
use super::levels::{Asked, settled};
use super::record::{BorderRecord, GridRecord, Measure, OUT};
use super::tiles::{SIDES, SIZES, tiles};
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};
use gpu::{Device, GpuError};
use nurbs::{KnotVector, Surface};
use pipeline::wgsl::Variant;
use pipeline::{PackedScene, Program, Scheme};
use scene::{Camera, Model, Projection, Viewport};
use std::ops::Range;

/// Faces that grids are of.
const FACES: u32 = 5;

/// Levels whose tiles are whole grids, and one that has four.
const HIGH: u32 = 5;

/// What is asked of random grids.
struct Question {
    grids: u32,
    /// Where the second program's grids start.
    second: u32,
    error_px: f32,
    most: u32,
    /// Second derivatives at most, local units.
    bend: f32,
}

/// From a few grids to so many that sums of blocks are added up in two turns; with errors that no level keeps to, and that each does.
const QUESTIONS: [Question; 6] = [
    Question { grids: 1, second: 0, error_px: 0.25, most: 11, bend: 1.0 },
    Question { grids: 150, second: 70, error_px: 0.25, most: HIGH, bend: 1.0 },
    Question { grids: 150, second: 149, error_px: 2.0, most: 1, bend: 40.0 },
    Question { grids: 333, second: 100, error_px: 0.5, most: HIGH, bend: 8.0 },
    Question { grids: 40, second: 20, error_px: 0.0625, most: 7, bend: 4.0 },
    Question { grids: 17_000, second: 9_001, error_px: 4.0, most: 2, bend: 1.0 },
];

/// The first grid or draw call of which the kernels of `source` make something else than Rust does, in words; `None` where all are the
/// same to the bit.
///
/// # Errors
/// [`GpuError::Shader`], [`GpuError::OutOfMemory`], [`GpuError::Timeout`], [`GpuError::Lost`].
pub fn wrong_levels(device: &Device, source: &dyn Fn(Variant) -> String) -> Result<Option<String>, GpuError> {
    let viewport = Viewport::new(96, 72).expect("a legal size");
    let (model, scene) = faces();
    for (number, question) in (0..).zip(&QUESTIONS) {
        let mut chance = Chance(1000 * number);
        let mut grids = question.grids(&mut chance);
        let mut generator = None;
        for camera in cameras() {
            let views = scene.views(&model, &camera, viewport);
            grids.asked = question.asked();
            let (expected, _) = settled(&grids.records, &grids.measures, &views, &grids.asked);
            let generator = match &mut generator {
                Some(generator) => generator,
                None => generator.insert(Generator::of(device, &scene, &grids, source)?),
            };
            let wrong = |what: &str| Ok(Some(format!("{what} of question {number}, {camera:?}")));
            // First with the room that there is, then with enough.
            loop {
                let chosen = generator.choose(device, &scene, &views)?;
                if let Some(k) = (0..expected.len()).find(|k| !is_same(&chosen.records[*k], &expected[*k])) {
                    return wrong(&format!("{:?}, not {:?}, is grid {k}", chosen.records[k], expected[k]));
                }
                if let Some(what) = wrong_tiles(&chosen, &expected, &grids.programs) {
                    return wrong(&what);
                }
                if !generator.has_grown(device)? {
                    break;
                }
            }
        }
    }
    Ok(None)
}

/// Whether a settled grid is as expected; one that is out of the picture keeps what an earlier one has left.
fn is_same(found: &GridRecord, expected: &GridRecord) -> bool {
    if expected.sides & OUT != 0 { found.sides == expected.sides } else { found == expected }
}

/// The first draw call that is not that of settled grids, or that has other tiles; what does not fit is left out.
fn wrong_tiles(chosen: &Chosen, records: &[GridRecord], programs: &[(Program, Range<usize>)]) -> Option<String> {
    let capacity = chosen.tiles.len();
    // One size after the other, those of all programs.
    let mut before = 0;
    for size in 0..SIZES {
        for (index, (_, grids)) in programs.iter().enumerate() {
            let of_grid = |k: usize| tiles(&records[k], [size / SIDES, size % SIDES]).map(move |at| (k, at));
            let expected: Vec<[u32; 2]> =
                grids.clone().flat_map(of_grid).map(|(k, at)| [k as u32, at[0] << 16 | at[1]]).collect();
            let [first, end] = [before, before + expected.len()].map(|end| end.min(capacity));
            before += expected.len();
            let number = index * SIZES as usize + size as usize;
            let DrawCall { instances, start, tiles, .. } = chosen.calls[number];
            if [start as usize, tiles as usize] != [first, end - first] || instances != tiles.div_ceil(bunch_of(size)) {
                let found = format!("{instances} instances, {tiles} tiles from {start}");
                return Some(format!("draw call {number} has {found}, not {first}..{end}"));
            }
            if chosen.tiles[first..end] != expected[..end - first] {
                return Some(format!("draw call {number} has other tiles"));
            }
        }
    }
    None
}

impl Question {
    fn asked(&self) -> Asked {
        Asked::new(f64::from(self.error_px), self.most)
    }

    /// Grids of boxes in and about the picture, which share borders by chance.
    fn grids(&self, chance: &mut Chance) -> Grids {
        let records = (0..self.grids).map(|_| GridRecord {
            face: chance.below(FACES),
            borders: [BorderRecord { level: 9, ..Zeroable::zeroed() }; 4],
            level: [3, 4],
            sides: chance.below(32),
            skirt: 7.0,
            ..Zeroable::zeroed()
        });
        let records = records.collect();
        let measures = (0..self.grids).map(|_| {
            let half = [0; 3].map(|_| 0.3 * chance.unit() * chance.unit());
            Measure {
                center: [0; 3].map(|_| 3.0 * chance.unit() - 1.5),
                diagonal: 2.0 * Vec3::from(half).length(),
                half,
                skirts: if chance.below(2) == 0 {
                    0
                } else {
                    (0..4).fold(0, |all, k| all | chance.below(12) << (8 * k))
                },
                bend: [0; 3].map(|_| self.bend * chance.unit().powi(4)),
                floor: Measure::packed_floor([0; 2].map(|_| chance.below(3).min(self.most) * chance.below(2))),
                groups: [0; 4].map(|_| chance.below(4 * self.grids)),
            }
        });
        let measures = measures.collect();
        let mut grids = Grids::default();
        let [first, second, end] = [0, self.second, self.grids].map(|end| end as usize);
        grids.programs = vec![(Program::Degree(1), first..second), (Program::General, second..end)];
        (grids.records, grids.measures, grids.asked) = (records, measures, self.asked());
        grids.chord = vec![vec![]; FACES as usize];
        grids
    }
}

/// Squares in other places and of other sizes: a frame each.
fn faces() -> (Model, PackedScene) {
    let square = |k: u32| {
        let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal");
        let size = 1.0 + f64::from(k) / 4.0;
        let corner = |u: f64, v: f64| DVec3::new(size * u, size * v, 0.3 * f64::from(k));
        let points = vec![corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 0.0), corner(1.0, 1.0)];
        Surface::new(knots(), knots(), points, None).expect("legal")
    };
    let model = Model::of_surfaces("squares", (0..FACES).map(square).collect()).expect("faces");
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
    (model, scene)
}

/// From afar, among the squares, and without perspective.
fn cameras() -> [Camera; 4] {
    let middle = DVec3::new(0.7, 0.7, 0.6);
    let seen = |eye: DVec3, projection| Camera::look_at(eye, middle, DVec3::Z, projection).expect("legal");
    let perspective = |fov_deg: f64| Projection::Perspective { fov_deg };
    [
        seen(DVec3::new(4.0, -3.0, 2.0), perspective(40.0)),
        seen(DVec3::new(0.2, 0.1, 0.5), perspective(75.0)),
        seen(DVec3::new(-6.0, 9.0, 1.0), perspective(8.0)),
        seen(DVec3::new(1.5, 0.5, 0.9), Projection::Orthographic { height: 1.3 }),
    ]
}

/// Numbers as if by chance: a count, by the golden ratio's digits.
struct Chance(u32);

impl Chance {
    fn below(&mut self, end: u32) -> u32 {
        self.0 += 1;
        let k = self.0.wrapping_mul(0x9e37_79b9);
        let k = (k ^ (k >> 15)).wrapping_mul(0x85eb_ca6b);
        ((u64::from(k ^ (k >> 13)) * u64::from(end)) >> 32) as u32
    }

    /// 0 … 1, in 24 bits.
    fn unit(&mut self) -> f32 {
        self.below(1 << 24) as f32 / (1 << 24) as f32
    }
}

//! Which side of the edges a point is on: the frozen answers against what the ray caster, the CPU's fragment program and
//! the GPU's say.

use super::frozen::{self, BAND, FrozenFace, FrozenPoint, FrozenSet};
use glam::DVec2;
use pipeline::trim::is_material;
use pipeline::{PackedScene, Program, Scheme};
use raycast::Classifier;
use rayon::prelude::*;
use scene::{FaceId, Model, Region};

/// How far f32 moves a parameter of 0 … 1.
const NARROWING: f64 = 1.0 / (1u64 << 25) as f64;

/// A face's points as fragments of a packed scene have them.
struct Fragments<'a> {
    scene: &'a PackedScene,
    face: &'a FrozenFace,
    region: &'a Region,
}

impl<'a> Fragments<'a> {
    fn new(model: &'a Model, scene: &'a PackedScene, face: &'a FrozenFace) -> Self {
        Self { scene, face, region: model.region(FaceId(face.face as u32)).expect("the face is trimmed") }
    }

    fn local(&self, point: &FrozenPoint) -> [f32; 2] {
        let domain = self.region.domain();
        ((point.uv - domain.min) / domain.size()).to_array().map(|t| t as f32)
    }

    /// Whether the point is farther from every edge than f32 can tell: beyond the band that packing states.
    fn is_clear(&self, point: &FrozenPoint) -> bool {
        let band = self.scene.frames()[self.face.face].edge_band + DVec2::splat(NARROWING);
        let in_shares = band * self.region.domain().size() / self.face.size;
        is_judged(self.region, point) && point.distance > in_shares.length()
    }

    /// Points clear of the edges where `answers`, in the order of the points, say otherwise; and how many are clear.
    fn wrong(&self, answers: impl Iterator<Item = bool>) -> (Vec<String>, usize) {
        let judged: Vec<_> = self.face.points.iter().zip(answers).filter(|(p, _)| self.is_clear(p)).collect();
        let words = |p: &FrozenPoint| format!("{} face {}: {p:?}", self.face.kind, self.face.face);
        (judged.iter().filter(|(p, answer)| *answer != p.inside).map(|(p, _)| words(p)).collect(), judged.len())
    }
}

/// Whether a point lies in the domain, beyond which no renderer asks, and outside the band of 1e-7.
fn is_judged(region: &Region, point: &FrozenPoint) -> bool {
    let domain = region.domain();
    domain.min.cmple(point.uv).all() && point.uv.cmple(domain.max).all() && point.distance >= BAND
}

/// Points outside the band of 1e-7 where the ray caster's classifier says otherwise, and how many are outside.
fn wrong_in_f64(region: &Region, face: &FrozenFace) -> (Vec<String>, usize) {
    let classifier = Classifier::new(region);
    let judged: Vec<_> = face.points.iter().filter(|p| is_judged(region, p)).collect();
    let wrong = judged.iter().filter(|p| classifier.inside(p.uv) != p.inside);
    (wrong.map(|p| format!("{} face {}: {p:?}", face.kind, face.face)).collect(), judged.len())
}

/// All of a set, by one of the two.
fn gathered(found: impl ParallelIterator<Item = (Vec<String>, usize)>) -> (Vec<String>, usize) {
    found.reduce(
        || (vec![], 0),
        |(mut a, n), (b, m)| {
            a.extend(b);
            (a, n + m)
        },
    )
}

fn f64_answers(model: &Model, set: &FrozenSet) -> (Vec<String>, usize) {
    let region = |face: &FrozenFace| model.region(FaceId(face.face as u32)).expect("the face is trimmed").clone();
    gathered(set.faces.par_iter().map(|face| wrong_in_f64(&region(face), face)))
}

fn f32_answers(model: &Model, set: &FrozenSet) -> (Vec<String>, usize) {
    let scene = PackedScene::new(model, Scheme::General).expect("it packs");
    gathered(set.faces.par_iter().map(|face| {
        let fragments = Fragments::new(model, &scene, face);
        let record = &scene.faces()[face.face];
        fragments.wrong(face.points.iter().map(|p| is_material(&scene, record, fragments.local(p))))
    }))
}

fn assert_none((wrong, judged): (Vec<String>, usize), total: usize, least_share: f64) {
    assert!(wrong.is_empty(), "{} of {judged} differ: {:#?}", wrong.len(), &wrong[..wrong.len().min(9)]);
    assert!(judged as f64 >= least_share * total as f64, "only {judged} of {total} points were judged");
}

/// How many points of a set are in the domains of their faces.
fn points(model: &Model, set: &FrozenSet) -> usize {
    let inside = |face: &FrozenFace| {
        let domain = model.region(FaceId(face.face as u32)).expect("the face is trimmed").domain();
        face.points.iter().filter(|p| domain.min.cmple(p.uv).all() && p.uv.cmple(domain.max).all()).count()
    };
    set.faces.iter().map(inside).sum()
}

#[test]
fn the_ray_caster_gives_the_frozen_answers() {
    for (model, set) in frozen::random().into_iter().chain(frozen::real().unwrap_or_default()) {
        assert_none(f64_answers(&model, &set), points(&model, &set), 0.95);
    }
}

#[test]
fn the_fragment_gives_the_frozen_answers_outside_its_band() {
    for (model, set) in frozen::random().into_iter().chain(frozen::real().unwrap_or_default()) {
        assert_none(f32_answers(&model, &set), points(&model, &set), 0.9);
    }
}

#[test]
fn the_gpu_gives_the_frozen_answers_outside_its_band() {
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    let (model, set) = frozen::random().swap_remove(0);
    let scene = PackedScene::new(&model, Scheme::General).expect("it packs");
    let all: Vec<Fragments> = set.faces.iter().map(|face| Fragments::new(&model, &scene, face)).collect();
    let queries: Vec<(u32, [f32; 2])> =
        all.iter().flat_map(|f| f.face.points.iter().map(|p| (f.face.face as u32, f.local(p)))).collect();
    let answers = gpu::probe_material(&device, &scene, Program::General, &queries).expect("the GPU answers");
    let mut rest = answers.as_slice();
    let (mut wrong, mut judged) = (vec![], 0);
    for fragments in &all {
        let (own, others) = rest.split_at(fragments.face.points.len());
        rest = others;
        let (found, clear) = fragments.wrong(own.iter().copied());
        wrong.extend(found);
        judged += clear;
    }
    assert_none((wrong, judged), queries.len(), 0.9);
}

#[test]
fn other_answers_are_told_from_the_frozen_ones() {
    let (model, mut set) = frozen::random().swap_remove(0);
    let clear = |face: &FrozenFace| {
        let scene = PackedScene::new(&model, Scheme::General).expect("it packs");
        let fragments = Fragments::new(&model, &scene, face);
        face.points.iter().position(|p| fragments.is_clear(p)).expect("one is clear")
    };
    let index = clear(&set.faces[0]);
    set.faces.truncate(1);
    set.faces[0].points[index].inside ^= true;
    assert_eq!((f64_answers(&model, &set).0.len(), f32_answers(&model, &set).0.len()), (1, 1));
}

//! The fragment program in WGSL against the one in Rust, number by number.

use crate::models::{Random, assorted, place};
use crate::software;
use gpu::probe;
use pipeline::fragment::{Fragment, fragment};
use pipeline::{PackedScene, Parameters, Scheme};

/// All numbers of a fragment as bits, with their names; 0 and −0 count as one.
pub fn bits(f: &Fragment) -> Vec<(&'static str, u32)> {
    let mut all = vec![("face", f.face), ("status", f.status as u32), ("span u", f.span[0]), ("span v", f.span[1])];
    let mut add = |name, values: &[f32]| all.extend(values.iter().map(|x| (name, (x + 0.0).to_bits())));
    add("uv", &f.uv);
    add("position", &f.position);
    add("normal", &f.normal);
    add("curvature", &f.curvature);
    add("speed", &f.speed);
    all
}

/// Names of the numbers that differ.
pub fn differences(a: &Fragment, b: &Fragment) -> Vec<&'static str> {
    bits(a).into_iter().zip(bits(b)).filter(|(a, b)| a.1 != b.1).map(|(a, _)| a.0).collect()
}

#[test]
fn the_program_in_wgsl_gives_the_bits_of_the_program_in_rust() {
    let device = software();
    let mut report = vec![];
    for seed in 1..=3 {
        let model = assorted(seed);
        for scheme in [Scheme::General, Scheme::Specialised] {
            let scene = PackedScene::new(&model, scheme).unwrap();
            let mut programs = scene.programs().to_vec();
            programs.sort();
            programs.dedup();
            for program in programs {
                let mut random = Random::new(seed);
                let faces: Vec<u32> =
                    (0..scene.faces().len() as u32).filter(|&f| scene.programs()[f as usize] == program).collect();
                let queries: Vec<(u32, Parameters)> = (0..4000)
                    .map(|_| {
                        let face = faces[random.below(faces.len())];
                        (face, place(&mut random, &scene, face))
                    })
                    .collect();
                let answers = probe(&device, &scene, program, &queries).unwrap();
                let mut counts = std::collections::BTreeMap::new();
                let mut example = None;
                for (answer, &(face, at)) in answers.iter().zip(&queries) {
                    let expected = fragment(&scene, face, at, true);
                    for name in differences(answer, &expected) {
                        *counts.entry(name).or_insert(0) += 1;
                        example.get_or_insert((*answer, expected, model.surfaces()[face as usize].degree()));
                    }
                }
                if let Some(example) = example {
                    report.push(format!("seed {seed} {program:?}: {counts:?} of 4000, first {example:#?}"));
                }
            }
        }
    }
    assert!(report.is_empty(), "{}", report.join("\n"));
}

#[test]
fn a_flipped_bit_is_a_difference() {
    let scene = PackedScene::new(&assorted(1), Scheme::General).unwrap();
    let sound = fragment(&scene, 0, Parameters { span: [0; 2], uv: [0.25, 0.75] }, true);
    let mut faulty = sound;
    faulty.normal[2] = f32::from_bits(sound.normal[2].to_bits() ^ 1);
    assert_eq!(differences(&sound, &sound), [""; 0]);
    assert_eq!(differences(&sound, &faulty), ["normal"]);
}

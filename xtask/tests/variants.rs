//! Programs in other words, against the judge.

use pipeline::wgsl::{self, Variant};
use pipeline::{Program, TrimMethod};
use xtask::mutants::mutant::is_legal;
use xtask::variants::bodies::shrunk;
use xtask::variants::variant::variant;
use xtask::variants::wording::{Fault, Opened, Wording};
use xtask::variants::{Kind, differs, reduced, with_stages};

/// The number of seeds of a program for which a picture differs.
fn differing(kind: Kind, host: &Opened, seeds: std::ops::Range<u64>, fault: Option<Fault>) -> usize {
    with_stages(kind, |stages| {
        let wrong = seeds.filter_map(|seed| {
            let found = differs(stages, host, Wording { seed, fault, is_lean: false })
                .unwrap_or_else(|error| panic!("{kind:?}, seed {seed}: {error:#}"));
            found.map(|(scene, why)| eprintln!("{kind:?}, seed {seed}, {scene}: {why}"))
        });
        Ok(wrong.count())
    })
    .expect("scenes that can be drawn")
}

#[test]
fn programs_in_other_words_agree() {
    assert_eq!(differing(Kind::Fragment, &Opened::Machine, 0..1, None), 0);
    assert_eq!(differing(Kind::Exact, &Opened::Machine, 4..5, None), 0);
}

#[test]
fn three_faults_of_compilers_are_found_in_other_words_too() {
    let faults = [(Fault::Reassociation, Kind::Fragment), (Fault::Clamp, Kind::Exact), (Fault::Bound, Kind::Fragment)];
    for (fault, kind) in faults {
        assert_eq!(differing(kind, &Opened::Machine, 7..8, Some(fault)), 1, "{fault:?}");
    }
}

#[test]
fn a_variant_is_another_text_of_the_same_seed_and_every_technique_has_some() {
    for technique in techniques::ALL {
        let of = Variant {
            parts: technique.parts(),
            program: Program::General,
            curvature: true,
            vertex_normals: false,
            trims: TrimMethod::CurvesWithEdges,
        };
        let program = wgsl::source(of);
        let a = variant(&program, 1, &[]);
        assert!(a != program, "{}", technique.name());
        if *technique == techniques::ALL[0] {
            assert!(a == variant(&program, 1, &[]) && a != variant(&program, 2, &[]));
        }
    }
}

#[test]
fn a_fault_is_reduced_to_a_face_and_eight_pixels_and_written_with_what_shows_it() {
    let folder = std::env::temp_dir().join(format!("isophote-reduced-{}", std::process::id()));
    let wording = Wording { seed: 7, fault: Some(Fault::Bound), is_lean: false };
    with_stages(Kind::Fragment, |stages| {
        let (_, judged) = stages.iter().find(|(name, _)| *name == "trim-nested-islands").expect("a scene");
        reduced::write(&folder, judged.stage(), wording, &Opened::Machine)
    })
    .expect("it differs, and can be written");
    let read = |file: &str| std::fs::read_to_string(folder.join(file)).expect("written");
    let model = isophote::view::ModelArgs::named(folder.join("model.json").to_str().expect("UTF-8")).open();
    let model = model.expect("it opens again");
    assert_eq!(model.faces().len(), 1);
    assert!(read("README.md").contains("--size 2x2"), "{}", read("README.md"));
    assert!(read("program-0.wgsl").contains("fn fragment_gbuffer"));
    // One of its four loops has nothing to do with it, and one span is enough, of three each way.
    assert_eq!((model.faces()[0].loops.len(), model.surfaces()[0].control_counts()), (3, [4, 4]));
    // Of the program little is left, and the loop whose end is wrong is in it.
    let [whole, small, other] = ["program-0.wgsl", "small-0.wgsl", "small-0-other.wgsl"].map(read);
    let [before, after] = [&whole, &small].map(|program| program.lines().count());
    assert!(after * 4 < before, "{after} lines of {before}: {small}");
    assert!(small.contains("j <= q") && other != small && is_legal(&small) && is_legal(&other), "{small}");
    assert!(read("README.md").contains("`small-N.wgsl` are what is left"), "{}", read("README.md"));
    std::fs::remove_dir_all(&folder).expect("it is there");
}

/// Two functions, of which one has nothing to do with a sum.
const PROGRAM: &str = "fn far(x: f32) -> f32 {\n let y = x * 2.0;\n return y + 1.0;\n}\n\
    fn near(x: f32) -> f32 {\n var sum = 0.0;\n for (var i = 0u; i < 4u; i += 1u) {\n  sum += x;\n }\n return sum;\n}\n\
    @fragment\nfn entry(@location(0) x: f32) -> @location(0) vec4<f32> {\n let a = far(x);\n var b = near(x);\n\
    if (a > 1.0) {\n  b = a;\n } else {\n  b = b + sqrt(b);\n }\n return vec4<f32>(a, b, 0.0, 1.0);\n}\n";

#[test]
fn of_a_program_what_has_nothing_to_do_with_it_goes_and_what_has_stays() {
    let small = shrunk(PROGRAM, &[], &mut |program| program.contains("sum += x") && program.contains("near(x)"));
    assert!(is_legal(&small), "{small}");
    assert!(!["far", "sqrt", "if", "else"].iter().any(|gone| small.contains(gone)), "{small}");
    assert!(["sum += x", "near(x)", "for ", "fn entry"].iter().all(|left| small.contains(left)), "{small}");
    // The checker itself: where nothing may change nothing does.
    assert_eq!(shrunk(PROGRAM, &[], &mut |_| false), PROGRAM);
}

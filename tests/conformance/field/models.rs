//! Models of the field: what is read, what is refused and by which name, what is left out and said so.

use super::field;
use formats::{Cause, Document, FormatError, read};
use glam::DVec3;
use scene::{FaceId, Model, Note, Region, SceneError};
use std::path::PathBuf;
use std::time::{Duration, Instant};

pub(super) fn hostile(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../testdata/hostile")).join(format!("{name}.json"))
}

fn opened(name: &str) -> Model {
    read(field(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Why a file is refused that has one face.
fn refusal(path: PathBuf) -> SceneError {
    match read(&path) {
        Ok(_) => panic!("{}: opened", path.display()),
        Err(FormatError { cause: Cause::Scene(SceneError::NoFaceLeft { mut causes }), .. }) if causes.len() == 1 => {
            causes.remove(0)
        }
        Err(error) => panic!("{error}"),
    }
}

fn region(model: &Model) -> &Region {
    model.region(FaceId(0)).expect("the face has loops")
}

/// The share of its domain that a face shows.
fn share(model: &Model) -> f64 {
    let size = region(model).domain().size();
    region(model).area() / (size.x * size.y)
}

#[test]
fn gaps_within_a_modellers_vertices_are_healed() {
    let hammer = opened("truth-hammer_face21");
    assert!((9e-5..1e-4).contains(&region(&hammer).largest_gap()), "{}", region(&hammer).largest_gap());
    assert_eq!(hammer.notes(), []);
    // Its vertices' tolerance is not in the file, so that what was closed is said.
    let bearing = opened("truth-bearing_face0");
    let widest = region(&bearing).largest_gap();
    assert!((9.3e-7..9.5e-7).contains(&widest), "{widest}");
    assert!(matches!(bearing.notes(), [Note::WideGap { face: 0, .. }, Note::WideGap { face: 0, .. }]));
    assert!(share(&bearing) > 0.999, "{}", share(&bearing));
}

#[test]
fn trims_that_overshoot_their_joint_within_the_tolerance_do_not_cross() {
    let bearing = opened("truth-bearing_face172");
    assert_eq!(bearing.notes(), []);
    assert!((0.7..0.9).contains(&share(&bearing)), "{}", share(&bearing));
}

#[test]
fn each_face_with_a_gap_is_named_and_the_good_ones_are_drawn() {
    let Err(FormatError { cause: Cause::Scene(SceneError::NoFaceLeft { causes }), .. }) = read(field("C6-loop-gaps"))
    else {
        panic!("opened")
    };
    for (index, cause) in causes.iter().enumerate() {
        assert!(matches!(cause, SceneError::TrimGap { face, boundary: 0, trim: 1, .. } if *face == index), "{cause}");
    }
    assert_eq!(causes.len(), 64);
    // Two of the faces made whole: they are drawn, and the others still have their numbers in the file.
    let text = std::fs::read_to_string(field("C6-loop-gaps")).expect("a file");
    let mut document: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    for face in [3, 40] {
        let end = document["faces"][face]["loops"][0]["trims"][0]["points"][1].clone();
        document["faces"][face]["loops"][0]["trims"][1]["points"][0] = end;
    }
    let model = formats::json::parse(&document.to_string(), "mended.json").expect("two faces are left");
    assert_eq!(model.faces().len(), 2);
    assert_eq!([0, 1].map(|id| model.number_in_file(FaceId(id))), [3, 40]);
    let left_out = |note: &Note| match note {
        Note::FaceLeftOut { face, .. } => *face,
        other => panic!("{other}"),
    };
    let expected: Vec<usize> = (0..64).filter(|face| ![3, 40].contains(face)).collect();
    assert_eq!(model.notes().iter().map(left_out).collect::<Vec<_>>(), expected);
    assert!(model.notes()[0].to_string().starts_with("left out: face 0, loop 0: 3.0"), "{}", model.notes()[0]);
}

#[test]
fn a_crossing_is_named_with_its_place() {
    let error = refusal(field("18-hole-crosses-outer"));
    let SceneError::TrimsCross { face: 0, first, second, at } = &error else { panic!("{error}") };
    assert_eq!([first.boundary, second.boundary], [Some(0), Some(1)]);
    // The circle of radius 1/2 about (3.6, 1.5) and the line u = 3.8.
    let half = (0.25f64 - 0.04).sqrt();
    assert!((at[0] - 3.8).abs() < 1e-5 && ((at[1] - 1.5).abs() - half).abs() < 1e-5, "{at:?}");
    let error = refusal(field("24-bow-tie-crossing"));
    let SceneError::TrimsCross { first, second, at, .. } = &error else { panic!("{error}") };
    assert_eq!([first.trim, second.trim], [Some(0), Some(2)]);
    assert!((at[0] - 2.0).abs() < 1e-9 && (at[1] - 1.5).abs() < 1e-9, "{at:?}");
}

#[test]
fn a_hole_in_either_corner_of_its_parent_is_cut() {
    for name in ["F3-min-corner-notch", "F3-min-corner-notch-works"] {
        let model = opened(name);
        assert!((region(&model).area() - 1.5).abs() < 1e-12 && model.notes().is_empty(), "{name}");
    }
}

#[test]
fn one_ring_of_a_torus_bounds_nothing() {
    let error = refusal(field("20-torus-one-ring"));
    assert_eq!(error, SceneError::OddRings { face: 0, boundaries: vec![0] });
}

#[test]
fn a_loop_that_encloses_nothing_is_dropped_and_named() {
    for name in ["21-null-area-loop", "21-point-loop"] {
        let model = opened(name);
        assert_eq!(model.notes(), [Note::LoopDropped { face: 0, boundary: 1 }], "{name}");
        assert!((region(&model).area() - 3.6 * 2.6).abs() < 1e-12, "{name}");
    }
}

#[test]
fn a_tolerance_above_the_face_does_not_close_it() {
    let model = opened("47-open-plane-huge-tolerance");
    assert!((region(&model).area() - 2.0).abs() < 1e-12 && region(&model).loops().len() == 1);
}

/// The document of the field with `change` made to it.
fn pieces(change: impl FnOnce(&mut serde_json::Value)) -> Result<Model, FormatError> {
    let text = std::fs::read_to_string(field("27-bezier-pieces-continuous")).expect("a file");
    let mut document: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    change(&mut document);
    formats::json::parse(&document.to_string(), "pieces.json")
}

#[test]
fn bezier_pieces_in_one_knot_vector_are_one_surface_where_they_meet() {
    let model = opened("27-bezier-pieces-continuous");
    assert_eq!((model.faces().len(), model.notes()), (1, &[][..]));
    // The knot stands in the vector p times, and the surface is what its pieces are.
    let surface = &model.surfaces()[0];
    assert_eq!(surface.knots(nurbs::Direction::U).multiplicity(0.4), 3);
    assert_eq!(surface.control_counts(), [7, 4]);
    let corner = DVec3::new(1.2857142857142858, 0.0, -0.370325872931093);
    assert!(
        surface.point(0.4, 0.0).distance(corner) < 1e-15
            && surface.point(1.0, 1.0).distance(DVec3::new(3.0, 2.0, 0.3579164688562014)) < 1e-15
    );
}

#[test]
fn a_torn_surface_becomes_several_faces_and_that_is_noted() {
    let lift = |document: &mut serde_json::Value| {
        for k in 16..32 {
            let z = document["surfaces"][0]["points"][k][2].as_f64().expect("a number");
            document["surfaces"][0]["points"][k][2] = (z + 0.5).into();
        }
    };
    let torn = pieces(lift).expect("two pieces");
    assert_eq!([0, 1].map(|id| torn.number_in_file(FaceId(id))), [0, 0]);
    let [low, high] = [0, 1].map(|id| torn.surface(FaceId(id)).domain()[0]);
    assert_eq!((low, high), ([0.0, 0.4], [0.4, 1.0]));
    assert!(torn.surfaces()[0].point(0.4, 0.0).distance(torn.surfaces()[1].point(0.4, 0.0)) > 0.499);
    let [Note::SurfaceCut { surface: 0, parameter: 'u', at, apart }] = torn.notes() else {
        panic!("{:?}", torn.notes())
    };
    assert!(*at == 0.4 && (apart - 0.5).abs() < 1e-12, "{apart}");
    // A trimmed face is cut with it: each part shows what of the loop is in its domain, and one has nothing to show.
    let line = |a: [f64; 2], b: [f64; 2]| serde_json::json!({"degree": 1, "knots": [0, 0, 1, 1], "points": [a, b]});
    let rectangle = |u0: f64, u1: f64| {
        let corners = [[u0, 0.25], [u1, 0.25], [u1, 0.75], [u0, 0.75]];
        let trims: Vec<_> = (0..4).map(|i| line(corners[i], corners[(i + 1) % 4])).collect();
        serde_json::json!([{"surface": 0, "loops": [{"outer": true, "trims": trims}]}])
    };
    for (range, areas) in [([0.2, 0.7], vec![0.1, 0.15]), ([0.5, 0.7], vec![0.1]), ([0.1, 0.3], vec![0.1])] {
        let model = pieces(|document| {
            lift(document);
            document["faces"] = rectangle(range[0], range[1]);
        });
        let model = model.expect("some material");
        let found: Vec<f64> =
            (0..model.faces().len()).map(|id| model.region(FaceId(id as u32)).expect("loops").area()).collect();
        assert_eq!(found.len(), areas.len(), "{range:?}");
        assert!(found.iter().zip(&areas).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert_eq!(model.notes().len(), 1, "{:?}", model.notes());
    }
}

#[test]
fn a_misspelt_key_is_refused_with_its_name_and_place() {
    let error = pieces(|document| document["surfaces"][0]["weigths"] = serde_json::json!(vec![1.0; 32]));
    let error = error.expect_err("a slip").to_string();
    assert!(error.contains("surfaces[0]: there is no key \"weigths\" here"), "{error}");
}

#[test]
fn hostile_loops_end_soon_with_the_number() {
    let start = Instant::now();
    assert_eq!(refusal(hostile("trim-outside")), SceneError::NoMaterial { face: 0 });
    let error = refusal(hostile("cyl-loop-1e5"));
    assert_eq!(error, SceneError::LoopReach { face: 0, boundary: 0, copies: 2e5, limit: 64 });
    let model = read(hostile("tol-hugeloop-1e9")).expect("the whole of its plane");
    assert!(region(&model).is_whole());
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
}

#[test]
fn names_and_numbers_are_fit_to_print() {
    let info = |name: &str| {
        let model = opened(name);
        isophote::info::text(&Document::of_model(model))
    };
    let named = info("43-name-with-controls");
    assert!(named.chars().all(|c| !c.is_control() || c == '\n') && !named.contains('\u{202e}'), "{named}");
    assert!(named.contains(r#"a\u{7}\u{1b}[2J"#), "{named}");
    let small = info("32-scale-1e-09");
    assert!(small.contains("box (-1.000000e-9, -1.000000e-9, -1.000000e-9) to (1.000000e-9"), "{small}");
    // Errors quote a file's words and its path.
    let error = formats::json::parse("{\"\u{1b}[31m\": 1}", "a\u{202e}b.json").expect_err("no model").to_string();
    assert!(error.chars().all(|c| !c.is_control()) && !error.contains('\u{202e}'), "{error}");
}

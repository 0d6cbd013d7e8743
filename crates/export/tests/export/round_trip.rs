//! STEP written and read again by the project's own reader: the same surfaces, trims and material.

use crate::{document, random, usual, write};
use formats::{Document, FORMATS};
use glam::DVec2;
use nurbs::{Curve, Direction, Surface};
use raycast::Classifier;
use scene::{FaceId, Model, Trim, closed};

/// Models of every kind: trims on one surface, a seam, a shared edge, poles, solids, an inch, weights, far spans.
const MODELS: &[&str] = &[
    "plate",
    "cap",
    "seam-pair",
    "teapot",
    "step/cylinder-seam.step",
    "step/cylinder-reversed.step",
    "step/cone-inch-degree.step",
    "step/sphere-seam.step",
    "step/torus.step",
    "step/oblique-cut.step",
    "step/solids/solid_1_7_n.step",
    "step/solids/solid_1_53_p.step",
    "cases/weights_2.json",
    "cases/huge_2.json",
    "cases/tiny_0.json",
    "cases/unclamped_2.json",
    "cases/solid_3.json",
];

pub fn read_again(document: &Document) -> Document {
    let (bytes, _) = write(document, "step", 1.0).unwrap_or_else(|error| panic!("{error}"));
    let step = FORMATS.iter().find(|format| format.name() == "STEP").expect("a reader");
    step.read(&bytes, "again.step").unwrap_or_else(|error| panic!("{error}"))
}

/// All numbers of a surface.
fn bits(surface: &Surface) -> Vec<u64> {
    let knots = [Direction::U, Direction::V].map(|direction| surface.knots(direction).knots());
    let points = surface.points().iter().flat_map(|p| p.to_array());
    let numbers = knots.concat().into_iter().chain(points).chain(surface.weights().unwrap_or_default().iter().copied());
    numbers.map(f64::to_bits).collect()
}

pub fn differing_surfaces(a: &Model, b: &Model) -> Vec<usize> {
    let surface = |model: &Model, face: usize| bits(model.surface(FaceId(face as u32)));
    (0..a.faces().len()).filter(|face| surface(a, *face) != surface(b, *face)).collect()
}

#[test]
fn surfaces_come_back_bit_for_bit() {
    for name in MODELS {
        let document = document(name);
        let again = read_again(&document);
        assert_eq!(again.model.faces().len(), document.model.faces().len(), "{name}");
        assert_eq!(differing_surfaces(&document.model, &again.model), Vec::<usize>::new(), "{name}");
        let reversed = |model: &Model| model.faces().iter().map(|face| face.reversed).collect::<Vec<_>>();
        assert_eq!(reversed(&again.model), reversed(&document.model), "{name}");
        if let Some(unit) = &document.unit {
            assert_eq!(again.unit.as_ref(), Some(unit), "{name}");
        }
    }
}

#[test]
fn layers_come_back() {
    for name in ["step/layers.step", "3dm/layers-8.3dm"] {
        let document = document(name);
        let again = read_again(&document);
        assert!(document.attributes.iter().any(|said| !said.layers.is_empty()), "{name}");
        let sorted = |document: &Document| {
            let all = document.attributes.iter().map(|said| said.layers.to_vec());
            all.map(|mut layers| (layers.sort(), layers).1).collect::<Vec<_>>()
        };
        assert_eq!(sorted(&again), sorted(&document), "{name}");
    }
}

#[test]
fn names_and_colours_come_back() {
    for name in ["step/attributes.step", "iges/looks.igs", "3dm/colours-8.3dm"] {
        let document = document(name);
        let again = read_again(&document);
        assert!(document.attributes.iter().any(|said| said.colour.is_some()), "{name}");
        assert_eq!(again.attributes.len(), document.attributes.len(), "{name}");
        for (again, said) in again.attributes.iter().zip(&document.attributes) {
            assert_eq!(again.colour, said.colour, "{name}");
            // What has no name is called by that of the whole.
            assert!(said.name.is_none() || again.name == said.name, "{name}: {said:?}, {again:?}");
        }
    }
}

#[test]
fn a_surface_with_one_bit_changed_is_not_the_same() {
    let model = models::builtin("teapot").expect("built in");
    let surface = &model.surfaces()[7];
    let point = surface.points()[5];
    let moved = surface.with_point([1, 1], point.with_x(f64::from_bits(point.x.to_bits() ^ 1))).expect("finite");
    assert_eq!(differing_surfaces(&model, &model.with_surface(7, moved)), [7]);
}

fn curve(trim: &Trim) -> Curve {
    Curve::new(trim.knots.clone(), &trim.points, trim.weights.as_deref()).expect("a curve")
}

/// How far the places of a trim are from another's, run the same way, in shares of the domain; whole periods do not count.
fn apart(surface: &Surface, a: &Trim, b: &Trim) -> f64 {
    let is_closed = closed(surface);
    let size = surface.domain().map(|[start, end]| end - start);
    let at = |trim: &Trim, share: f64| {
        let (start, end) = trim.knots.domain();
        let share = if trim.reversed { 1.0 - share } else { share };
        curve(trim).point(start + (end - start) * share)
    };
    let distance = |k: u32| {
        let share = f64::from(k) / 8.0;
        let mut difference = (at(a, share) - at(b, share)) / DVec2::from(size);
        for axis in [0, 1] {
            if is_closed[axis] {
                difference[axis] -= difference[axis].round();
            }
        }
        difference.abs().max_element()
    };
    (0..=8).map(distance).fold(0.0, f64::max)
}

/// Trims that STEP holds: all but those that are points in space.
fn trims(model: &Model, face: usize) -> Vec<&Trim> {
    model.faces()[face].loops.iter().flat_map(|l| &l.trims).filter(|trim| !trim.degenerate).collect()
}

#[test]
fn trims_come_back_where_they_were() {
    for name in MODELS {
        let document = document(name);
        let again = read_again(&document);
        for face in (0..document.model.faces().len()).filter(|face| !document.model.faces()[*face].loops.is_empty()) {
            let (old, new) = (trims(&document.model, face), trims(&again.model, face));
            assert_eq!(old.len(), new.len(), "{name}, face {face}");
            let surface = document.model.surface(FaceId(face as u32));
            for (k, (a, b)) in old.iter().zip(&new).enumerate() {
                let apart = apart(surface, a, b);
                assert!(apart <= 1e-12, "{name}, face {face}, trim {k}: {apart:e}");
            }
        }
    }
}

/// Edges that two faces share keep a common number.
#[test]
fn edges_stay_shared() {
    for name in ["cap", "seam-pair", "step/cylinder-seam.step", "step/solids/solid_1_7_n.step"] {
        let document = document(name);
        let faces = |model: &Model| {
            let mut faces: Vec<Vec<u32>> =
                model.shared_edges().iter().map(|edge| edge.faces.iter().map(|face| face.0).collect()).collect();
            faces.sort();
            faces
        };
        assert_eq!(faces(&read_again(&document).model), faces(&document.model), "{name}");
    }
}

#[test]
fn the_same_points_are_material() {
    let mut state = 11;
    for name in MODELS.iter().copied().chain(["window"]) {
        let document = document(name);
        let again = read_again(&document);
        for face in 0..document.model.faces().len() {
            let id = FaceId(face as u32);
            let inside = |model: &Model, uv: DVec2| {
                model.trimmed_region(id).is_none_or(|region| Classifier::new(region).inside(uv))
            };
            let [[u0, u1], [v0, v1]] = document.model.surface(id).domain();
            for _ in 0..20 {
                let [a, b] = [0; 2].map(|_| random(&mut state));
                let uv = DVec2::new(u0 + (u1 - u0) * a, v0 + (v1 - v0) * b);
                assert_eq!(inside(&document.model, uv), inside(&again.model, uv), "{name}, face {face}: {uv}");
            }
        }
    }
}

/// Of a face with several outer loops STEP makes several, which together are the same material.
#[test]
fn each_outer_loop_becomes_a_face() {
    let mut state = 12;
    for (name, faces) in [("islands", 2), ("text", 5)] {
        let document = document(name);
        let again = read_again(&document);
        assert_eq!(again.model.faces().len(), faces, "{name}");
        let classifiers: Vec<Classifier> = (0..faces)
            .map(|face| Classifier::new(again.model.region(FaceId(face as u32)).expect("loops bound it")))
            .collect();
        let whole = Classifier::new(document.model.region(FaceId(0)).expect("loops bound it"));
        for _ in 0..500 {
            let uv = DVec2::new(random(&mut state), random(&mut state));
            let count = classifiers.iter().filter(|classifier| classifier.inside(uv)).count();
            assert_eq!(count, usize::from(whole.inside(uv)), "{name}: {uv}");
        }
    }
}

/// Where the file's trims are curves in space that are no splines, a note says how near those are.
#[test]
fn what_step_cannot_say_is_noted() {
    let plate = document("plate");
    let (_, written) = write(&plate, "step", usual(&plate.model)).expect("written");
    assert!(written.notes.iter().any(|note| note.contains("no unit")), "{:?}", written.notes);
    assert!(written.notes.iter().any(|note| note.contains("no splines in space")), "{:?}", written.notes);
}

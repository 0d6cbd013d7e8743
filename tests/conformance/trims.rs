//! Point classification: the frozen answers of `testdata/trims` are whole, and a plain classifier gives the same.

mod agreement;
mod area;
mod cracks;
mod edges;
pub mod frozen;
mod plain;
mod sides;

use frozen::{BAND, FrozenFace, FrozenSet};
use glam::{DVec2, dvec2};
use plain::Outline;
use rayon::prelude::*;
use scene::{Loop, Model};
use std::collections::BTreeMap;

/// The winding number of a point, added up over its shifts by a period of u, where there is one.
fn shifted_winding(outline: &Outline, period: f64, uv: DVec2) -> i32 {
    let shifts: &[f64] = if period > 0.0 { &[-1.0, 0.0, 1.0] } else { &[0.0] };
    shifts.iter().map(|s| outline.winding(uv + dvec2(s * period, 0.0))).sum()
}

/// Points outside the band where a plain classifier says otherwise.
fn disagreements(loops: &[Loop], face: &FrozenFace) -> Vec<String> {
    let outline = Outline::new(loops, face.corner, face.size);
    let winding = |p: &frozen::FrozenPoint| shifted_winding(&outline, face.period, p.uv);
    let judged = face.points.iter().filter(|p| p.distance >= BAND);
    let wrong = judged.filter(|p| (winding(p) > 0) != p.inside);
    wrong.map(|p| format!("{} face {}: winding {} at {p:?}", face.kind, face.face, winding(p))).collect()
}

fn all_disagreements(model: &Model, set: &FrozenSet) -> Vec<String> {
    set.faces.par_iter().flat_map_iter(|face| disagreements(&model.faces()[face.face].loops, face)).collect()
}

#[test]
fn the_frozen_set_is_as_large_and_as_mixed_as_it_claims() {
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    let (mut points, mut inside, mut near, mut judged, mut differ) = (0, 0, 0, 0, 0);
    for (model, set) in frozen::random() {
        assert_eq!(model.faces().len(), set.faces.len());
        for (k, face) in set.faces.iter().enumerate() {
            assert_eq!((face.face, face.points.len()), (k, 1000));
            let covered = face.points.iter().filter(|p| p.inside).count();
            assert!((50..=950).contains(&covered), "{} face {k}: {covered} inside", set.model);
            *kinds.entry(face.kind.clone()).or_default() += 1;
            points += face.points.len();
            inside += covered;
            near += face.points.iter().filter(|p| p.distance < 1e-4).count();
            differ += face.points.iter().filter(|p| p.oracle_differs).count();
            judged += face.points.iter().filter(|p| p.distance >= BAND).count();
        }
    }
    assert!(points >= 300_000 && (points / 5..points * 4 / 5).contains(&inside), "{inside} of {points}");
    assert!(near > points / 5 && judged > points * 99 / 100, "{near} near, {judged} judged of {points}");
    // Were mathematics and OpenCASCADE often at odds, neither could be believed.
    assert!(differ <= points / 10_000, "OpenCASCADE differs at {differ}");
    let expected =
        ["bicubic", "cylinder-patch", "cylinder-split", "cylinder-window", "plane", "rational", "sphere-cap"];
    let names: Vec<&str> = kinds.keys().map(String::as_str).collect();
    assert_eq!(names, [expected.as_slice(), &["sphere-patch"]].concat());
    assert!(kinds.values().all(|&count| count >= 30), "{kinds:?}");
}

#[test]
fn loops_of_the_frozen_faces_close_and_run_the_right_way() {
    for (model, set) in frozen::random() {
        for (face, frozen) in model.faces().iter().zip(&set.faces) {
            assert_eq!(face.loops.iter().filter(|boundary| boundary.outer).count(), 1);
            for boundary in &face.loops {
                let (gap, double_area) = plain::closure(boundary, frozen.size);
                assert!(gap <= 1e-12, "{} face {}: gap of {gap}", set.model, frozen.face);
                assert!(double_area > 0.0 || !boundary.outer, "{} face {}", set.model, frozen.face);
            }
        }
    }
}

#[test]
fn a_plain_classifier_gives_the_frozen_answers() {
    let found: Vec<String> = frozen::random().iter().flat_map(|(model, set)| all_disagreements(model, set)).collect();
    assert!(found.is_empty(), "{} disagree: {:#?}", found.len(), &found[..found.len().min(9)]);
}

#[test]
fn a_plain_classifier_gives_the_frozen_answers_on_real_models() {
    let Some(real) = frozen::real() else { return };
    assert!(real.len() >= 11);
    let found: Vec<String> = real.iter().flat_map(|(model, set)| all_disagreements(model, set)).collect();
    assert!(found.is_empty(), "{} disagree: {:#?}", found.len(), &found[..found.len().min(9)]);
}

/// Winding numbers over a grid of points that lies on no edge; `period` as in [`FrozenFace`].
fn windings(loops: &[Loop], [[u0, u1], [v0, v1]]: [[f64; 2]; 2], period: f64) -> BTreeMap<i32, usize> {
    const SIDE: usize = 61;
    let (corner, size) = (dvec2(u0, v0), dvec2(u1 - u0, v1 - v0));
    let outline = Outline::new(loops, corner, size);
    let mut counts = BTreeMap::new();
    for k in 0..SIDE * SIDE {
        let share = dvec2((k / SIDE) as f64 + 0.503, (k % SIDE) as f64 + 0.497) / SIDE as f64;
        *counts.entry(shifted_winding(&outline, period, corner + share * size)).or_default() += 1;
    }
    counts
}

#[test]
fn built_in_trimmed_faces_cover_each_point_once_or_not_at_all() {
    for (name, _) in models::TRIMMED {
        let model = models::builtin(name).expect("it is built in");
        for face in model.faces() {
            let domain = model.surfaces()[face.surface].domain();
            let period = if *name == "window" { domain[0][1] - domain[0][0] } else { 0.0 };
            let counts = windings(&face.loops, domain, period);
            assert!(counts.keys().copied().eq([0, 1]), "{name}: {counts:?}");
        }
    }
    // A window moved over the porthole takes some points away twice.
    let model = models::builtin("window").expect("it is built in");
    let mut shifted = model.faces()[0].loops.clone();
    shifted[1].trims.iter_mut().flat_map(|trim| &mut trim.points).for_each(|p| p.x += 0.74);
    let counts = windings(&shifted, model.surfaces()[0].domain(), 1.0);
    assert!(counts.contains_key(&-1), "{counts:?}");
}

#[test]
fn a_loop_left_out_or_turned_about_and_a_wrong_answer_are_found() {
    let (model, set) = frozen::random().swap_remove(0);
    for face in &set.faces[..16] {
        let loops = &model.faces()[face.face].loops;
        for k in 1..loops.len() {
            let mut without = loops.clone();
            without.remove(k);
            assert!(!disagreements(&without, face).is_empty(), "face {} without loop {k}", face.face);
        }
        let mut turned = loops.clone();
        turned[0].trims.reverse();
        turned[0].trims.iter_mut().for_each(|trim| trim.reversed = !trim.reversed);
        assert!(!disagreements(&turned, face).is_empty());
        let mut wrong = face.clone();
        let point = wrong.points.iter_mut().find(|p| p.distance >= BAND).expect("one is judged");
        point.inside = !point.inside;
        assert_eq!(disagreements(loops, &wrong).len(), 1);
    }
}

#[test]
fn damaged_files_are_refused() {
    let whole = std::fs::read(frozen::folder().join("random-0.bin")).expect("readable");
    assert!(FrozenSet::decode(&whole).is_ok());
    let header = whole.iter().position(|&b| b == b'\n').expect("a header");
    let mut flipped = whole.clone();
    // Past 500 fine and 500 coarse points: an answer.
    flipped[header + 1 + 500 * 6 + 500 * 3] ^= 1;
    let text = String::from_utf8_lossy(&whole[..header]);
    let other = text.replace("isophote-trims", "isophote-others").into_bytes();
    for bytes in [&whole[..whole.len() - 1], &[whole.as_slice(), b"x"].concat(), &flipped, &other, b"", b"{}\n"] {
        assert!(FrozenSet::decode(bytes).is_err());
    }
}

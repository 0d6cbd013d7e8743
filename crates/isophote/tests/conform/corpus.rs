//! The corpus itself: scenes that show something, and shards that leave none out.

use isophote::conform::corpus::{SCENES, Suite, command_options};
use isophote::conform::shard::Shard;
use isophote::stage::Plan;
use raycast::Caster;
use scene::Viewport;
use std::collections::BTreeSet;

#[test]
fn every_scene_shows_its_model_from_every_viewpoint() {
    let viewport = Viewport::new(32, 32).expect("a legal size");
    let mut names = BTreeSet::new();
    for scene in SCENES {
        assert!(names.insert(scene.name), "{} is there twice", scene.name);
        let model = models::builtin(scene.model).unwrap_or_else(|| panic!("{} is not built in", scene.model));
        let caster = Caster::new(&model);
        for viewpoint in scene.viewpoints {
            let camera = viewpoint.camera(&model, viewport);
            let covered = caster.render(&camera, viewport, &|_| {}).covered();
            assert!(covered >= 24, "{} {}: {covered} of 1024 pixels", scene.name, viewpoint.name());
        }
    }
}

#[test]
fn degrees_1_to_9_are_there_in_both_directions() {
    let models = SCENES.iter().filter_map(|scene| models::builtin(scene.model));
    let degrees: Vec<[usize; 2]> =
        models.flat_map(|m| m.surfaces().iter().map(|s| s.degree()).collect::<Vec<_>>()).collect();
    for direction in 0..2 {
        assert!((1..=9).all(|p| degrees.iter().any(|degree| degree[direction] == p)), "{degrees:?}");
    }
}

#[test]
fn every_trimmed_model_is_a_scene_and_masks_are_asked_for_where_they_are_named() {
    for (name, _) in models::TRIMMED {
        assert!(SCENES.iter().any(|scene| scene.model == *name && !scene.masked), "{name}");
    }
    let viewport = Viewport::new(32, 32).expect("a legal size");
    for scene in SCENES {
        let model = models::builtin(scene.model).expect("built in");
        let camera = scene.viewpoints[0].camera(&model, viewport);
        let wanted = if scene.name.starts_with("masks-") { "texture" } else { "exact" };
        for suite in [Suite::Smoke, Suite::Standard, Suite::Full] {
            for plan in suite.plans(scene) {
                assert_eq!(plan.trim.name(), wanted, "{}", scene.name);
                assert!(command_options(&camera, viewport, plan).ends_with(&format!("--trim {wanted}")));
            }
        }
    }
}

#[test]
fn shards_take_every_scene_exactly_once() {
    for count in [1, 2, 3, 7] {
        for place in 0..40 {
            let takers = (1..=count).filter(|&index| Shard { index, count }.holds(place)).count();
            assert_eq!(takers, 1, "scene {place} of {count} shards");
        }
    }
    for text in ["0/3", "4/3", "1", "a/b", "1/0", "-1/2"] {
        let error = text.parse::<Shard>().expect_err(text);
        assert!(error.to_string().contains(text), "{error}");
    }
}

#[test]
fn each_suite_holds_the_one_below_it() {
    let names = |suite: Suite| suite.scenes().iter().map(|scene| scene.name).collect::<BTreeSet<_>>();
    assert!(names(Suite::Smoke).is_subset(&names(Suite::Standard)));
    assert!(names(Suite::Standard).is_subset(&names(Suite::Full)));
    assert_eq!(names(Suite::Full).len(), SCENES.len());
}

/// The options in a report must bring back the very camera: else another pixel would be explained.
#[test]
fn the_options_of_a_case_are_those_of_its_camera() {
    let viewport = Viewport::new(56, 56).expect("a legal size");
    let scene = SCENES.iter().find(|scene| scene.name == "offset-1e6").expect("in the corpus");
    let model = models::builtin(scene.model).expect("built in");
    for viewpoint in scene.viewpoints {
        let camera = viewpoint.camera(&model, viewport);
        let options = command_options(&camera, viewport, Plan::default());
        let words: Vec<&str> = options.split(' ').collect();
        let after = |name: &str| words.iter().position(|word| *word == name).map(|at| &words[at + 1..]);
        let eye: Vec<f64> = after("--eye").expect("an eye")[..3].iter().map(|x| x.parse().expect("a number")).collect();
        assert_eq!(eye, camera.eye().to_array());
        assert!(
            after("--fov").is_some() != after("--ortho").is_some() && options.contains("--size 56x56"),
            "{options}"
        );
    }
}

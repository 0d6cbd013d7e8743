//! Ray casting against OpenCASCADE: `testdata/oracle/rays`, frozen by `tests/oracle/freeze.py`.

use glam::DVec3;
use raycast::Caster;
use scene::{Camera, Model, Projection, Viewport};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// How far t may be from the oracle's, as a share of the model's size, plus some ulp of the coordinates: what
/// OpenCASCADE's own tolerance leaves (measured against a third program: 1e-11 mostly, 1.2e-9 far from the origin).
const DISTANCE: f64 = 1e-8;

/// A hit counts as grazing when the ray makes less than this cosine with the normal.
const GRAZING: f64 = 0.2;

struct Scene {
    name: String,
    model: PathBuf,
    camera: Camera,
    viewport: Viewport,
    answers: Value,
}

fn vector(value: &Value) -> DVec3 {
    let x: Vec<f64> = value.as_array().expect("three numbers").iter().map(|x| x.as_f64().expect("a number")).collect();
    DVec3::from_slice(&x)
}

fn scenes() -> Vec<Scene> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../testdata/oracle/rays");
    let mut files: Vec<PathBuf> =
        folder.read_dir().expect("frozen answers").map(|e| e.expect("an entry").path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "json"));
    files.sort();
    files.iter().map(|file| read(file)).collect()
}

fn read(file: &Path) -> Scene {
    let frozen: Value = serde_json::from_str(&std::fs::read_to_string(file).expect("readable")).expect("JSON");
    let c = &frozen["camera"];
    let projection = match (c["fov"].as_f64(), c["ortho"].as_f64()) {
        (Some(fov_deg), _) => Projection::Perspective { fov_deg },
        (None, Some(height)) => Projection::Orthographic { height },
        (None, None) => panic!("{} has no projection", file.display()),
    };
    let side = |i: usize| c["size"][i].as_u64().expect("a size") as usize;
    let camera =
        Camera::look_at(vector(&c["eye"]), vector(&c["target"]), vector(&c["up"]), projection).expect("a camera");
    // The oracle sees everything in front of the eye.
    let camera = camera.with_near(f64::MIN_POSITIVE).expect("positive");
    Scene {
        name: frozen["name"].as_str().expect("a name").to_owned(),
        model: file.parent().expect("a folder").join(frozen["model"].as_str().expect("a model")),
        camera,
        viewport: Viewport::new(side(0), side(1)).expect("a legal size"),
        answers: frozen["rays"].clone(),
    }
}

#[derive(Default)]
struct Score {
    rays: usize,
    grazing: usize,
    undecided: usize,
    wrong: Vec<String>,
}

fn score(scene: &Scene, caster: &Caster, model: &Model, total: &mut Score) {
    let array = |name: &str| scene.answers[name].as_array().expect("an array");
    let size = model.hull().diagonal();
    let reach = model.hull().max.abs().max(model.hull().min.abs()).max_element()
        + (scene.camera.eye() - model.hull().center()).length();
    let allowed = DISTANCE * size + 64.0 * f64::EPSILON * reach;
    let mut hits = 0;
    for (i, (hit, suspect)) in array("hit").iter().zip(array("suspect")).enumerate() {
        let expected = (hit.as_u64() == Some(1)).then(|| {
            hits += 1;
            hits - 1
        });
        if suspect.as_u64() == Some(1) {
            continue;
        }
        let (x, y) = (i % scene.viewport.width(), i / scene.viewport.width());
        let ray = scene.camera.ray(scene.viewport, x as f64 + 0.5, y as f64 + 0.5);
        let cast = caster.first(&ray);
        total.rays += 1;
        if cast.undecided.is_some() {
            total.undecided += 1;
            continue;
        }
        let place = format!("{} ({x}, {y})", scene.name);
        match (expected, cast.hit) {
            (None, None) => {}
            (None, Some(found)) => total.wrong.push(format!("{place}: invented a hit at t = {}", found.t)),
            (Some(_), None) => total.wrong.push(format!("{place}: missed a hit")),
            (Some(k), Some(found)) => {
                let t = array("t")[k].as_f64().expect("a number");
                total.grazing += usize::from(vector(&array("normal")[k]).dot(ray.direction).abs() < GRAZING);
                if (found.t - t).abs() > allowed {
                    total.wrong.push(format!("{place}: t = {} where the oracle has {t}", found.t));
                }
            }
        }
    }
}

#[test]
fn no_hit_is_missed_and_none_invented() {
    let mut total = Score::default();
    let mut by_model: BTreeMap<PathBuf, Vec<Scene>> = BTreeMap::new();
    for scene in scenes() {
        by_model.entry(scene.model.clone()).or_default().push(scene);
    }
    for (file, scenes) in &by_model {
        let model = formats::read(file).expect("a readable model");
        let caster = Caster::new(&model);
        scenes.iter().for_each(|scene| score(scene, &caster, &model, &mut total));
    }
    assert!(total.wrong.is_empty(), "{} of {} rays:\n{}", total.wrong.len(), total.rays, total.wrong.join("\n"));
    assert!(total.rays >= 20_000 && total.grazing * 4 >= total.rays, "{} rays, {} grazing", total.rays, total.grazing);
    assert!(total.undecided * 1000 <= total.rays, "{} of {} rays undecided", total.undecided, total.rays);
}

#[test]
fn a_missed_and_an_invented_hit_are_noticed() {
    let mut scene = scenes().into_iter().find(|scene| scene.name.starts_with("quadric")).expect("a quadric");
    let model = formats::read(&scene.model).expect("a readable model");
    let caster = Caster::new(&model);
    let (mut clean, mut noticed) = (Score::default(), Score::default());
    score(&scene, &caster, &model, &mut clean);
    let flags = scene.answers["hit"].as_array().expect("flags").clone();
    let last_hit = flags.iter().rposition(|hit| hit.as_u64() == Some(1)).expect("a hit");
    scene.answers["hit"][last_hit] = Value::from(0);
    scene.answers["t"][0] = Value::from(1e3);
    score(&scene, &caster, &model, &mut noticed);
    assert_eq!((clean.wrong.len(), noticed.wrong.len()), (0, 2), "{:?}", noticed.wrong);
}

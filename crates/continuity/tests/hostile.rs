//! Whatever a model is, the answer is a report: models of the test data, none of which was made for this.

use continuity::{Class, Settings, Verdict, report};

#[test]
fn every_built_in_model_and_every_hard_one_is_judged() {
    for (name, _) in models::BUILTINS.iter().chain(models::HARD).chain(models::TRIMMED) {
        let model = models::builtin(name).expect("built in");
        let found = report(&model, Settings::new(Class::A.limits(), &model));
        for edge in &found.edges {
            for answer in [&edge.gap, &edge.angle_deg, &edge.curvature] {
                assert!(0.0 <= answer.seen && answer.seen <= answer.bound, "{name}: {edge:?}");
            }
        }
        assert_eq!(found.faces.len(), model.faces().len(), "{name}");
    }
}

#[test]
fn the_models_that_broke_other_programs_are_judged() {
    let folders = ["../../testdata/field", "../../testdata/cases"];
    let mut count = 0;
    for folder in folders {
        for entry in std::fs::read_dir(folder).expect("test data") {
            let path = entry.expect("a file").path();
            let is_model = path.extension().is_some_and(|e| e == "json") && !path.to_string_lossy().contains("expect");
            let Some(model) = is_model.then(|| formats::read(&path).ok()).flatten() else { continue };
            let found = report(&model, Settings::new(Class::A.limits(), &model));
            assert!(found.edges.iter().all(|edge| edge.verdict <= Verdict::Fail), "{}", path.display());
            count += 1;
        }
    }
    assert!(30 < count, "{count} models");
}

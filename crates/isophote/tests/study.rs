//! A study holds what it must, of small models.

use isophote::cost::Patience;
use isophote::stage::{Plan, Stage};
use isophote::study::{Goal, Outcome, Report, page, study};
use pipeline::PackedScene;
use pipeline::wgsl::Part;
use scene::{Camera, Model, Viewport};
use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;
use std::sync::Arc;
use techniques::{PrepareError, Prepared, Setting, Technique};

/// A technique that never comes to anything.
struct Broken;

impl Technique for Broken {
    fn name(&self) -> &'static str {
        "broken"
    }

    fn about(&self) -> &'static str {
        "Refuses every scene"
    }

    fn parts(&self) -> &'static [Part] {
        &[]
    }

    fn claims(&self) -> compare::Claims {
        compare::Claims::Chord
    }

    fn prepare(&self, setting: &Setting) -> Result<Arc<dyn Prepared>, PrepareError> {
        Err(PrepareError::TooManyTriangles { chord_px: setting.chord_px })
    }

    fn uniform(&self, _: &Model, _: &PackedScene, _: usize) -> Result<Option<Arc<dyn Prepared>>, PrepareError> {
        Ok(None)
    }
}

const GOALS: [Goal; 4] = [Goal::Triangles(300), Goal::Triangles(5000), Goal::Error(2.0), Goal::Error(0.25)];

/// A study without a GPU of all techniques and the broken one, and its page.
fn small(model: &Model, goals: &[Goal]) -> (Report, String) {
    let viewport = Viewport::new(64, 48).unwrap();
    let camera = Camera::framing(model, viewport);
    let patience = Patience { frames: 3, seconds: 1e-3 };
    let stage = Stage::new(model, camera, viewport, Plan::default()).unwrap();
    let report = Report::new(model, camera, viewport, Err("no GPU was asked for".to_owned()), patience);
    let techniques: Vec<&'static dyn Technique> = techniques::ALL.iter().copied().chain([&Broken as _]).collect();
    let (report, worst) = study(&stage, &techniques, goals, None, patience, report).unwrap();
    let page = page(&report, &worst).unwrap();
    (report, page)
}

fn faults(document: &Value) -> Vec<String> {
    let schema = serde_json::from_str(include_str!("../../../testdata/schema/study-1.json")).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    validator.iter_errors(document).map(|error| error.to_string()).collect()
}

#[test]
fn errors_decrease_with_the_budget_and_keep_to_the_bound() {
    let (report, _) = small(&models::builtin("teapot").unwrap(), &GOALS);
    for technique in techniques::ALL.iter().filter(|technique| technique.claims() == compare::Claims::Chord) {
        let of = |goal: Goal| {
            let row = report.measured().find(|(row, _)| row.technique == technique.name() && row.goal == goal);
            row.unwrap_or_else(|| panic!("{technique:?} has no row of {goal}")).1
        };
        for [coarse, fine] in [[GOALS[0], GOALS[1]], [GOALS[2], GOALS[3]]] {
            let offset = |goal| of(goal).errors.offset_px.greatest;
            assert!(offset(fine) < 0.5 * offset(coarse), "{technique:?} {fine}: {} {}", offset(fine), offset(coarse));
            assert!(of(coarse).triangles < of(fine).triangles);
            assert!(of(fine).errors.normal_deg.percentile_99 < of(coarse).errors.normal_deg.percentile_99);
        }
        for goal in GOALS {
            match goal {
                Goal::Triangles(most) => {
                    // More than a third is used: a budget is met, not only kept.
                    let triangles = of(goal).triangles;
                    assert!(triangles <= most && most < 8 * triangles, "{technique:?} {goal}: {triangles}");
                }
                // A hundredth for snapping and interpolation.
                Goal::Error(px) => assert!(of(goal).errors.offset_px.greatest <= px + 0.01),
                Goal::Own => unreachable!("none of these"),
            }
        }
    }
    let exact = report.measured().find(|(row, _)| row.goal == Goal::Own).expect("one shows no flat triangles").1;
    assert!(exact.errors.offset_px.greatest <= 0.01 && exact.chord_px.is_none() && exact.vertex_normal_deg.is_none());
}

#[test]
fn a_technique_that_fails_is_shown_as_failed() {
    let (report, page) = small(&models::builtin("sphere").unwrap(), &GOALS);
    let broken: Vec<_> = report.rows.iter().filter(|row| row.technique == "broken").collect();
    assert_eq!(broken.iter().map(|row| row.goal).collect::<Vec<_>>(), GOALS);
    for row in &broken {
        assert!(matches!(&row.outcome, Outcome::Failed(why) if why.contains("asks for over")), "{row:?}");
    }
    assert_eq!(page.matches("failed: ").count(), GOALS.len());
    // And so is one that takes more triangles than a budget, however coarse it is.
    let (report, _) = small(&models::builtin("spray").unwrap(), &[Goal::Triangles(5)]);
    let failed = |name: &str| {
        let mut rows = report.rows.iter().filter(|row| row.technique == name);
        rows.any(|row| matches!(&row.outcome, Outcome::Failed(why) if why.starts_with("the coarsest has")))
    };
    assert!(failed("fragment") && failed("grid"));
}

#[test]
fn a_renderer_that_was_not_timed_says_why() {
    let (report, page) = small(&models::builtin("sphere").unwrap(), &GOALS);
    for (row, measured) in report.measured() {
        assert!(measured.cpu.is_some() && measured.gpu.is_none(), "{row:?}");
        assert_eq!(measured.not_timed, ["gpu: not run"]);
    }
    assert!(page.contains("gpu: not run: no GPU was asked for"));
}

#[test]
fn the_document_is_what_its_schema_says() {
    let (report, _) = small(&models::builtin("sphere").unwrap(), &GOALS);
    let document = serde_json::to_value(&report).unwrap();
    assert_eq!(faults(&document), Vec::<String>::new());
    // The schema refuses what it should: a row without an outcome, one with two, a negative time.
    let mut without = document.clone();
    without["rows"][0].as_object_mut().unwrap().remove("measured");
    let mut both = document.clone();
    both["rows"][0]["failed"] = "why".into();
    let mut negative = document.clone();
    negative["rows"][0]["measured"]["prepare_ms"] = (-1.0).into();
    for wrong in [without, both, negative] {
        assert!(!faults(&wrong).is_empty());
    }
}

#[test]
fn the_page_holds_everything_and_fetches_nothing() {
    let surfaces = models::builtin("sphere").unwrap().surfaces().to_vec();
    let (report, page) = small(&Model::of_surfaces("<b>ball</b>", surfaces).unwrap(), &GOALS);
    assert!(page.contains("&lt;b&gt;ball&lt;/b&gt;") && !page.contains("<b>"));
    for fetched in ["http:", "https:", "<script", "<link"] {
        let without_names = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!without_names.contains(fetched), "{fetched}");
    }
    // No GPU: its two plots have nothing to show.
    assert_eq!(page.matches("<svg").count(), 4);
    let drawn = report.measured().count();
    assert_eq!(page.matches("<figure>").count(), drawn);
    assert_eq!(page.matches("data:image/png;base64,").count(), 2 * drawn);
    assert!(report.caveats.iter().all(|caveat| page.contains(&caveat.replace('"', "&quot;"))));
}

#[test]
fn the_command_makes_the_folder_that_is_missing() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("study-{}", std::process::id()));
    let out = folder.join("deep/er");
    let output = Command::new(env!("CARGO_BIN_EXE_isophote"))
        .args(["study", "sphere", "--size", "32x32", "--triangles", "200", "--errors", "2"])
        .args(["--frames", "3", "--seconds", "0.001", "--format", "json", "--out"])
        .arg(&out)
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed: Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
    assert_eq!(faults(&printed), Vec::<String>::new());
    let written: Value = serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
    assert_eq!(written, printed);
    assert!(std::fs::read_to_string(out.join("study.html")).unwrap().ends_with("</html>\n"));
    std::fs::remove_dir_all(folder).unwrap();
}

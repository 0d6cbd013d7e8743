//! Two versions of a surface, by the program: what it says, writes and refuses.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn isophote(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_isophote")).args(arguments).output().expect("isophote starts")
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("versions").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// A file of the unit sphere, moved along z.
fn sphere(folder: &Path, name: &str, lift: f64) -> String {
    let path = folder.join(name).display().to_string();
    assert!(isophote(&["convert", "sphere", "--out", &path]).status.success());
    let mut model: Value = serde_json::from_slice(&std::fs::read(&path).expect("a file")).expect("JSON");
    for point in model["surfaces"][0]["points"].as_array_mut().expect("points") {
        let z = point[2].as_f64().expect("a number");
        point[2] = (z + lift).into();
    }
    std::fs::write(&path, model.to_string()).expect("a file");
    path
}

/// The same in a STEP file, in metres or in millimetres.
fn in_unit(folder: &Path, name: &str, prefix: &str) -> String {
    let path = folder.join(name).display().to_string();
    assert!(isophote(&["convert", "sphere", "--out", &path]).status.success());
    let text = std::fs::read_to_string(&path)
        .expect("a file")
        .replace("SI_UNIT(.MILLI.,.METRE.)", &format!("SI_UNIT({prefix},.METRE.)"));
    std::fs::write(&path, text).expect("a file");
    path
}

#[test]
fn a_moved_copy_is_told_in_model_units_with_its_worst_place() {
    let folder = folder("moved");
    let (old, new) = (sphere(&folder, "old.json", 0.0), sphere(&folder, "new.json", 0.25));
    let out = folder.join("out").display().to_string();
    let told = isophote(&["compare", &old, &new, "--view", "top", "--size", "64x64", "--out", &out]);
    let text = String::from_utf8(told.stdout).expect("UTF-8");
    assert_eq!(told.status.code(), Some(0), "{text}");
    let line = text.lines().last().expect("a line");
    assert!(line.contains("is within 0.2") && line.contains(" unit of "), "{line}");
    let wide = text.lines().find(|line| line.chars().count() > 80 && "│┌╞└".contains(&line[..3]));
    assert_eq!(wide, None);
    // From above the lift is seen whole at the top, and by its cosine elsewhere.
    let report: Value =
        serde_json::from_slice(&std::fs::read(folder.join("out/report.json")).expect("a report")).expect("JSON");
    let greatest = report["distance"]["greatest"].as_f64().expect("a number");
    assert!(greatest <= 0.25 + 1e-9 && greatest > 0.249, "{greatest}");
    for name in ["deviation.png", "angle.png"] {
        assert!(folder.join("out").join(name).exists(), "{name}");
    }
    // What it says to run next is a command that runs.
    let next = text.lines().find_map(|line| line.trim().strip_prefix("next: isophote ")).expect("a next command");
    let ran = isophote(&next.split(' ').collect::<Vec<_>>());
    assert!(ran.status.code().is_some_and(|code| code < 2), "{next}: {}", String::from_utf8_lossy(&ran.stderr));

    let allowed = isophote(&["compare", &old, &new, "--size", "64x64", "--within", "0.26"]);
    assert_eq!(allowed.status.code(), Some(0));
    let refused = isophote(&["compare", &old, &new, "--size", "64x64", "--within", "0.1"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stdout).contains("pixels are farther from"));
    let same = isophote(&["compare", &old, &old, "--size", "64x64", "--within", "1e-12"]);
    assert_eq!(same.status.code(), Some(0), "{}", String::from_utf8_lossy(&same.stdout));
}

#[test]
fn a_report_is_one_page_with_the_answer_both_pictures_and_the_worst_place() {
    let folder = folder("page");
    let (old, new) = (sphere(&folder, "old.json", 0.0), sphere(&folder, "new <2>.json", 0.25));
    let page = folder.join("deep/report.html");
    let compare = |out: &str, within: &str| {
        isophote(&["compare", &old, &new, "--view", "top", "--size", "64x64", "--within", within, "--report", out])
    };
    assert_eq!(compare(page.to_str().expect("UTF-8"), "0.1").status.code(), Some(1));
    let text = std::fs::read_to_string(&page).expect("a page");
    assert_eq!(text.matches("<img src=\"data:image/png;base64,").count(), 2);
    for words in
        ["Beyond.", "pixels are farther from", "face 0 at (u, v)", "isophote pixel", "new &lt;2&gt;.json", "0.25 unit"]
    {
        assert!(text.contains(words), "{words}");
    }
    assert!(!text.contains("http") && !text.contains("new <2>"), "nothing is fetched, and a name is no markup");
    let piped = compare("-", "1");
    let piped = String::from_utf8(piped.stdout).expect("UTF-8");
    assert!(piped.starts_with("<!doctype html>") && piped.trim_end().ends_with("</html>") && piped.contains("Within."));
}

#[test]
fn a_deviation_is_drawn_beside_other_shadings() {
    let folder = folder("drawn");
    let (old, new) = (sphere(&folder, "old.json", 0.0), sphere(&folder, "new.json", 0.25));
    let out = folder.join("deviation.png").display().to_string();
    let drawn =
        ["render", &old, "--shade", "deviation", "--against", &new, "--legend", "--size", "48x48", "--out", &out];
    let drawn = isophote(&drawn);
    assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
    assert!(folder.join("deviation.png").exists());
}

#[test]
fn what_cannot_be_measured_is_refused_by_name() {
    let folder = folder("refused");
    let (old, metre) = (sphere(&folder, "old.json", 0.0), in_unit(&folder, "metre.step", "$"));
    for (arguments, words) in [
        (&["compare", &in_unit(&folder, "millimetre.step", ".MILLI."), &metre][..], "has no unit"),
        (&["compare", &old, "no-such-model"], "no such file"),
        (&["compare", &old, &old, "--no-gpu"], "--no-gpu goes with renderers"),
        (&["compare", &old, &old, "--report", "x.png"], "x.png"),
        (&["compare", &old, "--within", "1"], "--within goes with two models"),
        (&["render", &old, "--shade", "deviation"], "--against MODEL"),
        (&["render", &old, "--against", &old], "--against goes with --shade deviation"),
        (&["render", &old, "--shade", "deviation", "--against", "no-such-model"], "no such file"),
        (&["view", &old, "--shade", "deviation", "--against", &old], "isophote compare"),
    ] {
        let output = isophote(arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
    let unseen =
        isophote(&["compare", &old, &old, "--eye", "9", "0", "0", "--target", "10", "0", "0", "--size", "16x16"]);
    assert_eq!(unseen.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&unseen.stdout).contains("No pixel shows"));
}

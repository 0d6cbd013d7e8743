//! The program itself: its version, its help, and what it teaches shells and manuals.

use std::path::Path;
use std::process::{Command, Output};

/// The users' commands.
const COMMANDS: [&str; 14] = [
    "compare",
    "conform",
    "continuity",
    "render",
    "view",
    "pixel",
    "eval",
    "info",
    "scene",
    "convert",
    "study",
    "adapters",
    "completions",
    "man",
];

/// What a terminal shows at once, lines and columns.
const SCREEN: [usize; 2] = [50, 100];

fn isophote(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_isophote")).args(arguments).output().expect("isophote starts")
}

fn told(arguments: &[&str]) -> String {
    let output = isophote(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[test]
fn the_program_says_what_it_is() {
    assert_eq!(told(&["--version"]), format!("isophote {}\n", env!("CARGO_PKG_VERSION")));
    let help = told(&["-h"]);
    assert!(COMMANDS.iter().all(|command| help.contains(&format!("\n  {command} "))), "{help}");
    assert_eq!(isophote(&[]).status.code(), Some(2));
}

#[test]
fn short_help_is_one_screen_and_the_long_one_says_more() {
    for command in COMMANDS {
        let (short, long) = (told(&[command, "-h"]), told(&[command, "--help"]));
        let wide = short.lines().find(|line| line.chars().count() > SCREEN[1]);
        assert!(short.lines().count() <= SCREEN[0] && wide.is_none(), "{command}: {wide:?}\n{short}");
        assert!(command == "adapters" || short.contains("isophote ") && long.len() > short.len(), "{command}: {short}");
    }
    // What is left out of the short help stands in the long one.
    assert!(!told(&["compare", "-h"]).contains("--mask-px") && told(&["compare", "--help"]).contains("--mask-px"));
}

#[test]
fn shells_and_manuals_learn_every_command() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = told(&["completions", shell]);
        assert!(COMMANDS.iter().all(|command| script.contains(command)), "{shell}");
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("man/man1");
    told(&["man", folder.to_str().expect("UTF-8")]);
    for command in COMMANDS {
        let page = std::fs::read_to_string(folder.join(format!("isophote-{command}.1"))).expect("a page");
        assert!(page.contains(&format!(".TH isophote-{command} 1")) && page.contains(".SH DESCRIPTION"), "{command}");
    }
    assert!(std::fs::read_to_string(folder.join("isophote.1")).expect("a page").contains("isophote\\-compare(1)"));
}

#[test]
fn a_misspelt_model_is_told_by_its_name() {
    let output = isophote(&["render", "teapto"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    assert!(message.contains("did you mean \"teapot\"?"), "{message}");
    let message = String::from_utf8_lossy(&isophote(&["render", "automobile"]).stderr).into_owned();
    assert!(message.contains("there are teapot, ") && !message.contains("did you mean"), "{message}");
}

#[test]
fn a_model_is_framed_from_each_side() {
    // Where the camera stands says which side is seen.
    let eye = |view: &[&str]| {
        let scene = told(&[&["scene", "teapot", "--size", "16x16"], view].concat());
        let scene: serde_json::Value = serde_json::from_str(&scene).expect("JSON");
        let camera = &scene["meta"]["camera"];
        [0, 1, 2]
            .map(|k| camera["eye"][k].as_f64().expect("a number") - camera["target"][k].as_f64().expect("a number"))
    };
    let sides = [
        ("front", 1, -1.0),
        ("back", 1, 1.0),
        ("left", 0, -1.0),
        ("right", 0, 1.0),
        ("top", 2, 1.0),
        ("bottom", 2, -1.0),
    ];
    for (side, axis, sign) in sides {
        let offset = eye(&["--view", side]);
        let length = offset.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((offset[axis] * sign - length).abs() <= 1e-9 * length, "{side}: {offset:?}");
    }
    let [turned, right] = [eye(&["--azimuth", "90"]), eye(&["--view", "right"])];
    assert!(turned.iter().zip(right).all(|(a, b)| (a - b).abs() < 1e-9), "{turned:?} {right:?}");
    let near = told(&["scene", "teapot", "--zoom", "2"]);
    assert!(near.contains("\"fov_deg\":20.6") || near.contains("20.6"), "twice as near: 2 atan(tan(20°) / 2) = 20.6°");
    for wrong in
        [&["--view", "top", "--eye", "0", "0", "1"][..], &["--elevation", "90"], &["--zoom", "0"], &["--view", "up"]]
    {
        assert_eq!(isophote(&[&["scene", "teapot"], wrong].concat()).status.code(), Some(2), "{wrong:?}");
    }
}

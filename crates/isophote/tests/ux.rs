//! Sessions of three kinds of user, run as they are written: `tests/ux/README.md` says how to read them.

use gbuffer::{GBuffer, Hit};
use nurbs::Normal;
use std::path::{Path, PathBuf};
use std::process::Command;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// One command of a session, and what must come of it.
struct Step<'s> {
    command: &'s str,
    code: i32,
    said: Vec<&'s str>,
    unsaid: Vec<&'s str>,
    made: Vec<&'s str>,
}

fn steps(text: &str) -> Vec<Step<'_>> {
    let mut steps: Vec<Step> = vec![];
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let (mark, rest) = line.split_at(line.len().min(2));
        if mark == "$ " {
            let code = lines.next().and_then(|code| code.parse().ok()).expect("an exit code below each command");
            steps.push(Step { command: rest, code, said: vec![], unsaid: vec![], made: vec![] });
            continue;
        }
        match (mark, steps.last_mut()) {
            ("# " | "", _) => {}
            ("> ", Some(step)) => step.said.push(rest),
            ("< ", Some(step)) => step.unsaid.push(rest),
            ("? ", Some(step)) => step.made.push(rest),
            _ => panic!("{line:?} is no line of a session"),
        }
    }
    steps
}

/// A folder with the two files that a session begins with.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("ux").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let frozen = Path::new(ROOT).join("testdata/foreign/teapot.npz");
    std::fs::copy(&frozen, folder.join("teapot.npz")).expect("a copy");
    let sound = GBuffer::read_npz(&frozen).expect("a G-buffer");
    let flipped =
        |hit: &Hit| Hit { normal: hit.normal.unit().map_or(Normal::Undefined, |n| Normal::Regular(-n)), ..*hit };
    let viewport = sound.viewport();
    let rows = (0..viewport.height()).map(|y| (0..viewport.width()).map(|x| sound.get(x, y).map(flipped)).collect());
    let wrong = GBuffer::from_rows(viewport, sound.meta().clone(), rows);
    wrong.write_npz(folder.join("flipped.npz")).expect("a file");
    folder
}

fn played(name: &str) {
    let text = std::fs::read_to_string(Path::new(ROOT).join(format!("tests/ux/{name}.txt"))).expect("a session");
    let folder = folder(name);
    let programs = Path::new(env!("CARGO_BIN_EXE_isophote")).parent().expect("a folder of programs");
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").expect("a path"));
    let steps = steps(&text);
    assert!(steps.len() >= 5, "{name}: {} commands", steps.len());
    for Step { command, code, said, unsaid, made } in steps {
        let output = Command::new("bash").args(["-c", command]).current_dir(&folder).env("PATH", &path).output();
        let output = output.expect("bash starts");
        let printed = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
        assert_eq!(output.status.code(), Some(code), "{name}: {command}\n{printed}");
        assert!(said.iter().all(|words| printed.contains(words)), "{name}: {command} lacks one of {said:?}\n{printed}");
        assert!(
            !unsaid.iter().any(|words| printed.contains(words)),
            "{name}: {command} says one of {unsaid:?}\n{printed}"
        );
        let missing = made.iter().find(|file| !folder.join(file).exists());
        assert!(missing.is_none(), "{name}: {command} makes no {missing:?}\n{printed}");
    }
}

#[test]
fn a_driver_engineer_learns_what_is_wrong_with_a_renderer() {
    played("driver-engineer");
}

#[test]
fn a_surface_designer_gets_pictures_with_numbers() {
    played("surface-designer");
}

#[test]
fn a_ci_engineer_gets_an_exit_code_that_can_be_trusted() {
    played("ci-engineer");
}

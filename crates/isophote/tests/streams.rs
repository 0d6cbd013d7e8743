//! What a command writes arrives, or its exit code says that it did not: full devices, closed pipes, bad folders.
#![cfg(unix)]

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_isophote"));
    command.args(arguments);
    command
}

fn full() -> Stdio {
    File::options().write(true).open("/dev/full").expect("a full device").into()
}

/// A pipe that nobody reads.
fn closed() -> Stdio {
    let (_, writer) = std::io::pipe().expect("a pipe");
    writer.into()
}

/// A file in an empty folder of that name.
fn place(folder: &str, name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("streams").join(folder);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder can be made");
    folder.join(name)
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

const PRINTING: [&[&str]; 12] = [
    &["--help"],
    &["--version"],
    &["info", "sphere"],
    &["info", "sphere", "--format", "json"],
    &["info", "--list"],
    &["eval", "sphere"],
    &["scene", "sphere"],
    &["adapters"],
    &["adapters", "--format", "json"],
    &["pixel", "sphere", "3,3", "--size", "8x8"],
    &["compare", "sphere", "--size", "16x16"],
    &["render", "sphere", "--size", "8x8"],
];

#[test]
fn a_full_device_on_standard_output_is_exit_code_2() {
    for arguments in PRINTING {
        let output = command(arguments).stdout(full()).output().expect("isophote starts");
        let said = words(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(!said.contains("panicked"), "{arguments:?}: {said}");
        assert!(arguments[0].starts_with('-') || said.contains("standard output"), "{arguments:?}: {said}");
    }
}

#[test]
fn a_closed_pipe_ends_a_command_quietly_but_not_as_a_success() {
    for arguments in PRINTING {
        let output = command(arguments).stdout(closed()).output().expect("isophote starts");
        assert_eq!((output.status.code(), words(&output).as_str()), (Some(2), ""), "{arguments:?}");
    }
}

#[test]
fn a_standard_error_that_takes_nothing_changes_no_exit_code() {
    for stream in [full(), closed()] {
        let status = command(&["info", "no-such-model"]).stderr(stream).status().expect("isophote starts");
        assert_eq!(status.code(), Some(2));
    }
}

#[test]
fn a_file_that_cannot_be_written_is_exit_code_2_and_named() {
    let model = ["sphere", "--size", "8x8"];
    for arguments in [["render", "--out"], ["render", "--gbuffer"], ["scene", "--out"]] {
        for path in ["/dev/full", "/no/such/folder/x"] {
            let output = command(&arguments).arg(path).args(model).output().expect("isophote starts");
            let said = words(&output);
            assert_eq!(output.status.code(), Some(2), "{arguments:?} {path}: {said}");
            assert!(said.contains(path) && !said.contains("panicked"), "{arguments:?} {path}: {said}");
        }
    }
}

#[test]
fn endless_queries_are_refused_before_they_are_read() {
    let pipe = place("queries", "pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
    for path in [pipe.to_str().expect("UTF-8"), "/dev/zero"] {
        let output = command(&["eval", "sphere", "--queries", path]).output().expect("isophote starts");
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        assert!(words(&output).contains("not a regular file") && words(&output).contains(path), "{}", words(&output));
    }
}

#[test]
fn a_report_that_cannot_be_written_is_exit_code_2_and_leaves_what_was_there() {
    let report = place("report", "report.json");
    fs::create_dir(&report).expect("a folder can be made");
    let folder = report.parent().expect("a folder").to_str().expect("UTF-8");
    let output = command(&["compare", "sphere", "--size", "8x8", "--out", folder]).output().expect("isophote starts");
    assert_eq!(output.status.code(), Some(2), "{}", words(&output));
    assert!(words(&output).contains("report.json"), "{}", words(&output));
    // Where the disk is full: the shell's limit on the size of a file stands in for it.
    let picture = place("limit", "x.png");
    fs::write(&picture, b"old").expect("a file can be written");
    let line =
        format!("ulimit -f 1; trap '' XFSZ; exec \"$0\" render sphere --size 128x128 --out '{}'", picture.display());
    let output =
        Command::new("bash").args(["-c", &line, env!("CARGO_BIN_EXE_isophote")]).output().expect("bash starts");
    assert_eq!(output.status.code(), Some(2), "{}", words(&output));
    assert_eq!(fs::read(&picture).expect("still there"), b"old");
    assert_eq!(fs::read_dir(picture.parent().expect("a folder")).expect("a folder").count(), 1, "nothing beside it");
}

/// A terminal that answers nothing: `script` gives one, and nobody types.
#[test]
fn a_terminal_that_does_not_answer_is_not_waited_for() {
    for (term, coloured) in [("xterm-256color", true), ("dumb", false), ("xterm-kitty", true)] {
        let line = format!("{} render sphere --size 16x16", env!("CARGO_BIN_EXE_isophote"));
        let output = Command::new("timeout")
            .args(["60", "script", "-qec", &line, "/dev/null"])
            .env("TERM", term)
            .env_remove("NO_COLOR")
            .stdin(Stdio::null())
            .output()
            .expect("timeout and script start");
        let shown = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(0), "{term}: {shown}");
        assert!(shown.contains("pixels") && shown.contains('▀') == coloured, "{term}: {shown}");
        // Nothing but colours: no question, no movement.
        let sequences = shown.split("\u{1b}").skip(1).filter(|rest| !rest.starts_with('['));
        assert_eq!(sequences.count(), 0, "{term}: {shown}");
    }
}

/// The bytes that a command writes to standard output.
fn piped(arguments: &[&str]) -> Vec<u8> {
    let output = command(arguments).output().expect("isophote starts");
    assert!(output.status.success(), "{arguments:?}: {}", words(&output));
    output.stdout
}

#[test]
fn every_kind_of_file_goes_to_standard_output_as_it_goes_to_a_file() {
    let drawn = ["render", "islands", "--size", "24x24"];
    for (ending, first) in [
        ("png", &b"\x89PNG"[..]),
        ("jpg", b"\xff\xd8"),
        ("exr", b"\x76\x2f\x31\x01"),
        ("svg", b"<svg"),
        ("dxf", b"0\nSECTION"),
    ] {
        let path = place("kinds", &format!("picture.{ending}"));
        piped(&[&drawn[..], &["--out", &path.display().to_string()]].concat());
        let file = fs::read(&path).expect("a file");
        assert!(file.trim_ascii_start().starts_with(first), "{ending}: {:?}", &file[..12]);
        assert_eq!(piped(&[&drawn[..], &["--out", &format!("-.{ending}")]].concat()), file, "{ending}");
    }
    assert!(piped(&[&drawn[..], &["--out", "-"]].concat()).starts_with(b"\x89PNG"));
    assert!(piped(&[&drawn[..], &["--gbuffer", "-"]].concat()).starts_with(b"PK"));
    for ending in ["json", "step", "obj", "stl", "glb"] {
        let path = place("models", &format!("model.{ending}"));
        piped(&["convert", "islands", "--out", &path.display().to_string()]);
        let file = fs::read(&path).expect("a file");
        assert_eq!(piped(&["convert", "islands", "--out", &format!("-.{ending}")]), file, "{ending}");
    }
}

#[test]
fn what_cannot_be_written_is_refused_before_anything_is_drawn() {
    // Each of these would take minutes to draw.
    let large = ["quilt-100000", "--size", "4000x4000"];
    let nowhere = |name: &str| format!("/dev/null/nowhere/{name}");
    for (command_line, name) in [
        (&["render", "--out"][..], nowhere("x.png")),
        (&["render", "--out"], nowhere("x.exr")),
        (&["render", "--out"], nowhere("x.svg")),
        (&["render", "--gbuffer"], nowhere("x.npz")),
        (&["render", "--out"], "picture.gif".to_owned()),
        (&["render", "--out"], "-.gif".to_owned()),
        (&["render", "--gbuffer"], "-.png".to_owned()),
        (&["render", "--gbuffer", "-", "--out"], "-".to_owned()),
        (&["render", "--antialias", "4", "--gbuffer"], "-".to_owned()),
        (&["render", "--antialias", "4", "--out"], "-.exr".to_owned()),
        (&["render", "--legend", "--out"], "-.exr".to_owned()),
        (&["render", "--background", "transparent", "--out"], "-.jpg".to_owned()),
        (&["scene", "--out"], nowhere("x.json")),
        (&["scene", "--out"], "-.png".to_owned()),
        (&["compare", "--out"], nowhere("out")),
        (&["compare", "--report"], nowhere("x.html")),
        (&["study", "--out"], nowhere("out")),
        (&["capsule", "--out"], nowhere("out")),
        (&["capsule", "--gbuffer"], nowhere("x.npz")),
    ] {
        let begun = std::time::Instant::now();
        let output = command(&command_line[..1]).args(large).args(&command_line[1..]).arg(&name).output();
        let output = output.expect("isophote starts");
        assert_eq!(output.status.code(), Some(2), "{command_line:?} {name}: {}", words(&output));
        assert!(begun.elapsed().as_secs() < 5, "{command_line:?} {name}: {:?}", begun.elapsed());
        assert!(output.stdout.is_empty(), "{command_line:?} {name}");
    }
    for name in [nowhere("x.step"), "-.png".to_owned(), "-".to_owned()] {
        let output = command(&["convert", "quilt-100000", "--out", &name]).output().expect("isophote starts");
        assert_eq!(output.status.code(), Some(2), "{name}: {}", words(&output));
    }
}

//! The program on a display of its own: Xvfb, with the mouse and the keys of xdotool.

use super::{drawn_again, folder};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Set where a display must be there, as in CI: then a test without one fails.
const NEEDED: &str = "ISOPHOTE_NEED_DISPLAY";

/// The longest wait for a window or a file: a loaded machine of two cores stays below it.
const PATIENCE: Duration = Duration::from_secs(120);

/// Whether there is what makes a display. Where there is none, says plainly which test does not run: straight to standard error,
/// since what a passing test prints is not shown.
fn is_there(test: &str) -> bool {
    let there = ["Xvfb", "xdotool"].iter().all(|name| {
        let found = Command::new("sh").args(["-c", &format!("command -v {name}")]).stdout(Stdio::null()).status();
        found.is_ok_and(|status| status.success())
    });
    if !there {
        assert!(std::env::var_os(NEEDED).is_none(), "{NEEDED} is set, and there is no Xvfb or no xdotool");
        let line = format!("NOT RUN: display::{test} (display test 1 of 1): no Xvfb or xdotool here; CI runs it\n");
        std::io::stderr().write_all(line.as_bytes()).expect("standard error takes a line");
    }
    there
}

/// What ends when it is dropped.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts a display; its name.
fn display() -> (Ended, String) {
    let server = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn();
    let mut server = Ended(server.expect("Xvfb starts"));
    let mut number = String::new();
    let said = server.0.stdout.take().expect("it is piped");
    BufReader::new(said).read_line(&mut number).expect("the display says its number");
    (server, format!(":{}", number.trim()))
}

fn isophote(arguments: &[&str], display: Option<&str>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_isophote"));
    command.args(arguments).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    display.into_iter().for_each(|display| {
        command.env("DISPLAY", display);
    });
    command
}

fn waited_for(path: &Path) -> PathBuf {
    let started = Instant::now();
    while !path.exists() {
        assert!(started.elapsed() < PATIENCE, "{} does not come", path.display());
        std::thread::sleep(Duration::from_millis(50));
    }
    path.to_owned()
}

#[test]
fn without_a_display_it_says_so_and_offers_render() {
    let none = |output: Output| {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.contains("no display") && said.contains("isophote render") && !said.contains("panicked"),
            "{said}"
        );
        assert!(!said.contains(".rs"), "{said}");
    };
    none(isophote(&["view", "teapot"], None).output().expect("isophote starts"));
    if cfg!(target_os = "linux") {
        none(isophote(&["view", "teapot"], Some(":64999")).output().expect("isophote starts"));
    }
}

#[test]
fn a_window_on_a_display_is_turned_read_and_saved() {
    if !is_there("a_window_on_a_display_is_turned_read_and_saved") {
        return;
    }
    let (_server, display) = display();
    let folder = folder("display");
    let out = folder.join("x.png");
    let out = out.to_str().expect("UTF-8");
    let mut program = Ended(
        isophote(&["view", "teapot", "--size", "240x300", "--out", out], Some(&display))
            .stdout(Stdio::piped())
            .spawn()
            .expect("isophote starts"),
    );
    let xdotool = |line: &str| {
        let output = Command::new("xdotool").args(line.split_whitespace()).env("DISPLAY", &display).output();
        let output = output.expect("xdotool starts");
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    };
    // Nothing else is on the display that could be in the way; keys go where the focus is, which nobody else hands out.
    xdotool("search --sync --onlyvisible --name isophote windowfocus --sync");
    xdotool("key s");
    waited_for(&folder.join("x.sh"));
    xdotool("mousemove --sync 100 150 mousedown 1");
    xdotool("mousemove --sync 120 150 mousemove --sync 150 140 mouseup 1 click 4");
    xdotool("key s");
    waited_for(&folder.join("x-1.sh"));
    let pictures = ["x.png", "x-1.png"].map(|name| std::fs::read(folder.join(name)).expect("a picture"));
    assert!(pictures[0] != pictures[1], "the mouse turns the model");
    assert!(pictures[1] == drawn_again(&folder, "x-1.png"));
    xdotool("key q");
    let started = Instant::now();
    let status = loop {
        match program.0.try_wait().expect("a child of ours") {
            Some(status) => break status,
            None => assert!(started.elapsed() < PATIENCE, "it does not close"),
        }
        std::thread::sleep(Duration::from_millis(50));
    };
    assert!(status.success(), "{status}");
}

//! What a person sees on standard error while waiting.

use crate::text::escaped_lines;
use indicatif::{MultiProgress, ProgressBar, ProgressFinish, ProgressStyle};
use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::sync::LazyLock;

/// The bars that are drawn now, one below the other: a long command's own above those of its steps.
static BARS: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);

/// A progress bar of `length` steps on standard error, gone when dropped; it draws nothing where that is not a terminal.
pub fn progress(what: &str, length: usize) -> ProgressBar {
    let style =
        ProgressStyle::with_template("{msg:24} {bar:40.cyan/blue} {pos}/{len} {eta}").expect("a valid template");
    let bar = ProgressBar::new(length as u64).with_style(style).with_finish(ProgressFinish::AndClear);
    BARS.add(bar).with_message(what.to_owned())
}

/// Tells on standard error how far a long command is, where no bar can be drawn: a line a step, as a job's log keeps it.
pub fn step(text: fmt::Arguments) {
    if !io::stderr().is_terminal() {
        note(text);
    }
}

/// Says something on standard error. Where that cannot be written there is nobody to tell.
pub fn note(text: fmt::Arguments) {
    let _ = writeln!(io::stderr(), "{}", escaped_lines(&text.to_string()));
}

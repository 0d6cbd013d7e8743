//! What a person sees while waiting, and pictures where the terminal can show them.

use gbuffer::Picture;
use indicatif::{MultiProgress, ProgressBar, ProgressFinish, ProgressStyle};
use std::io::IsTerminal;
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

/// Whether standard output is a terminal: only then are colours and pictures printed.
pub fn is_terminal() -> bool {
    std::io::stdout().is_terminal()
}

/// Prints a picture with the terminal's own graphics, or with half blocks.
pub fn show(picture: &Picture) {
    if !is_terminal() {
        return;
    }
    let (width, height) = (picture.width() as u32, picture.height() as u32);
    let bytes = picture.rgb().iter().flatten().copied().collect();
    let image = image::RgbImage::from_raw(width, height, bytes).expect("three bytes a pixel");
    let config = viuer::Config { absolute_offset: false, width: Some(72), ..Default::default() };
    // A terminal that cannot take the picture is no failure of the comparison: the PNG files hold it.
    if let Err(error) = viuer::print(&image.into(), &config) {
        eprintln!("the terminal shows no pictures: {error}");
    }
}

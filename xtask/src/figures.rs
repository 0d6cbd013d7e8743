//! `figures`: what the documents show, drawn by the commands that they name.
//!
//! Above a picture stands `<!-- figure: isophote … -->`, the command that writes it, or `<!-- figure: isophote … | FILE -->` where
//! the command writes it among others. Commands run in the root of the repository and write below `target/figures`; the file goes
//! where the picture's link says. `<!-- screenshot: … -->` says how a picture was taken that no command draws alone.

use anyhow::{Context, Result, bail, ensure};
use clap::{Args, Parser};
use isophote::commands::Cli;
use isophote::say;
use std::path::{Path, PathBuf};

/// The most that one figure takes, and all of them, bytes: who clones the repository has them all.
pub const MOST: [u64; 2] = [100_000, 1_000_000];

const FIGURE: &str = "<!-- figure: ";
const SCREENSHOT: &str = "<!-- screenshot: ";
const END: &str = " -->";

/// Draw each figure that the documents show, by the command that stands above it
#[derive(Debug, Args)]
pub struct FiguresArgs {
    /// Write none, and name those that are not as their commands draw them now
    #[arg(long)]
    check: bool,
}

/// A figure of a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// The words of the command, without the program's name.
    pub words: Vec<String>,
    /// What the command writes.
    pub written: PathBuf,
    /// Where the document shows it from.
    pub shown: PathBuf,
}

/// Where the repository is.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The documents that must show a figure.
///
/// # Errors
/// Where the folder cannot be read.
pub fn documents(root: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(root.join("docs"))?.collect::<Result<Vec<_>, _>>()?;
    let pages =
        entries.into_iter().map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "md"));
    let mut all: Vec<PathBuf> = pages.chain([root.join("README.md")]).collect();
    all.sort();
    Ok(all)
}

/// The figures of a document in `folder`, without its screenshots.
///
/// # Errors
/// Where a comment names no file, no picture stands below it, or the document shows none at all.
pub fn figures(text: &str, folder: &Path) -> Result<Vec<Figure>> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = vec![];
    let mut pictures = 0;
    for pair in lines.windows(2) {
        let Some(link) = pair[1].strip_prefix("![").and_then(|rest| rest.split_once("](")?.1.strip_suffix(')')) else {
            ensure!(!pair[0].starts_with(FIGURE), "no picture stands below {:?}", pair[0]);
            continue;
        };
        pictures += 1;
        if pair[0].starts_with(SCREENSHOT) {
            continue;
        }
        let comment = pair[0].strip_prefix(FIGURE).and_then(|rest| rest.strip_suffix(END));
        let comment = comment.with_context(|| format!("no command stands above {link}"))?;
        let (command, file) = comment.split_once(" | ").map_or((comment, None), |(a, b)| (a, Some(b)));
        let words: Vec<String> = command.split_whitespace().map(str::to_owned).collect();
        let after = |option: &str| words.iter().skip_while(|word| *word != option).nth(1).map(String::as_str);
        let written = file.or_else(|| after("--out")).or_else(|| after("--overlay"));
        let written = written.with_context(|| format!("{command:?} names no file"))?;
        ensure!(written.starts_with("target/figures/"), "{written}: figures are drawn below target/figures");
        ensure!(words.first().is_some_and(|word| word == "isophote"), "{command:?} is no command of isophote");
        found.push(Figure { words: words[1..].to_vec(), written: written.into(), shown: folder.join(link) });
    }
    ensure!(pictures > 0, "it shows no figure");
    Ok(found)
}

impl Figure {
    /// Draws it: the bytes of the file that its command writes. Commands run in the process, in the root of the repository.
    ///
    /// # Errors
    /// Where the command is none, fails, or writes no such file.
    pub fn drawn(&self) -> Result<Vec<u8>> {
        let line = self.words.join(" ");
        let cli = Cli::try_parse_from(std::iter::once("isophote").chain(self.words.iter().map(String::as_str)));
        let _ = std::fs::remove_file(&self.written);
        cli.with_context(|| line.clone())?.command.run().with_context(|| line.clone())?;
        std::fs::read(&self.written).with_context(|| format!("{line}: {}", self.written.display()))
    }
}

/// Runs the command.
///
/// # Errors
/// Where a figure cannot be drawn or is too large, or, with `--check`, where one is not what its command draws.
pub fn run(args: &FiguresArgs) -> Result<()> {
    std::env::set_current_dir(root())?;
    let mut stale = vec![];
    let (mut count, mut sum) = (0, 0);
    for path in documents(Path::new("."))? {
        let folder = path.parent().unwrap_or(Path::new("."));
        let all = figures(&std::fs::read_to_string(&path)?, folder).with_context(|| path.display().to_string())?;
        for figure in all {
            let bytes = figure.drawn()?;
            let [most, _] = MOST;
            ensure!(bytes.len() as u64 <= most, "{}: {} bytes, over {most}", figure.shown.display(), bytes.len());
            (count, sum) = (count + 1, sum + bytes.len() as u64);
            if std::fs::read(&figure.shown).is_ok_and(|there| there == bytes) {
                continue;
            }
            stale.push(figure.shown.display().to_string());
            if !args.check {
                isophote::output::folder(figure.shown.parent().unwrap_or(folder))?;
                isophote::output::write(&figure.shown, &bytes)?;
            }
        }
    }
    ensure!(sum <= MOST[1], "all figures take {sum} bytes, over {}", MOST[1]);
    if args.check && !stale.is_empty() {
        bail!("not as their commands draw them: {}", stale.join(", "));
    }
    say!("{count} figures, {sum} bytes, {} written anew", stale.len())
}

//! Figures of the documents are what the commands above them draw.

use std::path::Path;
use xtask::figures::{Figure, MOST, documents, figures, root};

/// All figures of all documents, by their shown names.
fn all() -> Vec<Figure> {
    let of = |path: std::path::PathBuf| {
        let text = std::fs::read_to_string(&path).expect("a document");
        figures(&text, path.parent().expect("a folder")).unwrap_or_else(|error| panic!("{}: {error:#}", path.display()))
    };
    documents(Path::new(".")).expect("documents").into_iter().flat_map(of).collect()
}

#[test]
fn every_page_shows_a_figure_and_each_is_what_its_command_draws() {
    std::env::set_current_dir(root()).expect("the root");
    let figures = all();
    assert!(figures.len() >= 20, "{}", figures.len());
    let mut sum = 0;
    for figure in figures {
        let shown = std::fs::read(&figure.shown).unwrap_or_else(|error| panic!("{}: {error}", figure.shown.display()));
        assert!(shown.len() as u64 <= MOST[0], "{}: {} bytes", figure.shown.display(), shown.len());
        sum += shown.len() as u64;
        let drawn = figure.drawn().expect("it is drawn");
        assert!(drawn == shown, "{}: `cargo xtask figures` draws it anew", figure.shown.display());
    }
    assert!(sum <= MOST[1], "{sum}");
}

#[test]
fn a_page_without_a_figure_and_a_figure_without_a_command_are_told() {
    let of = |text: &str| figures(text, Path::new("docs"));
    let sound = "<!-- figure: isophote render teapot --out target/figures/a.png -->\n![A pot](figures/a.png)\n";
    let figure = of(sound).expect("a figure").remove(0);
    assert_eq!(figure.words, ["render", "teapot", "--out", "target/figures/a.png"]);
    assert_eq!(figure.shown, Path::new("docs/figures/a.png"));
    for wrong in [
        "# A page\n\nwithout any\n",
        "Words.\n![A pot](figures/a.png)\n",
        "<!-- figure: isophote render teapot --out target/figures/a.png -->\nWords.\n",
        "<!-- figure: isophote render teapot -->\n![A pot](figures/a.png)\n",
        "<!-- figure: isophote render teapot --out a.png -->\n![A pot](figures/a.png)\n",
        "<!-- figure: rm -r --out target/figures/a.png -->\n![A pot](figures/a.png)\n",
    ] {
        assert!(of(wrong).is_err(), "{wrong}");
    }
    let broken = Figure { words: vec!["render".to_owned(), "teapto".to_owned()], ..figure };
    assert!(broken.drawn().is_err());
}

//! The project's own files of a format: they stand in `testdata`, and are what their writer makes.

use crate::common::root;
use formats::Document;

/// Opens `NAME.EXTENSION` of the folder of a format, which must be `text`; with `FORMAT_CORPUS=1` it is written anew first.
pub fn opened([folder, extension]: [&str; 2], name: &str, text: &str) -> Document {
    let path = root().join("testdata").join(folder).join(format!("{name}.{extension}"));
    let variable = format!("{}_CORPUS", folder.to_uppercase());
    if std::env::var_os(&variable).is_some() {
        std::fs::create_dir_all(path.parent().expect("a folder")).unwrap();
        std::fs::write(&path, text).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert_eq!(found, text, "{}: {variable}=1 writes it anew", path.display());
    formats::open(&path).unwrap_or_else(|error| panic!("{error}"))
}

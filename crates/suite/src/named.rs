//! A model by what stands for it on a command line and in the corpus: the name of a built-in one, or the path of a file.

use crate::text::nearest;
use anyhow::{Result, bail};
use formats::Document;
use std::path::Path;

/// The model of that name or file, in silence, whatever is left out of it.
///
/// # Errors
/// Where it is neither a built-in name nor a readable file; a file's error names the place and the value.
pub fn document(name: &str) -> Result<Document> {
    if let Some(model) = models::builtin(name) {
        return Ok(Document::of_model(model));
    }
    let path = Path::new(name);
    if !path.exists() && path.extension().is_none() && !name.contains(std::path::is_separator) {
        let names: Vec<&str> = models::all().map(|(name, _)| *name).collect();
        match nearest(name, &names) {
            Some(meant) => bail!("there is no built-in model {name:?}, and no such file; did you mean {meant:?}?"),
            None => bail!("there is no built-in model {name:?} (there are {}), and no such file", names.join(", ")),
        }
    }
    Ok(formats::open(path)?)
}

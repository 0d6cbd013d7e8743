//! Faces as files of triangles group them: those of one name together, among these those on the same layers, and
//! among these those of one colour.

use formats::{Colour, Document, Layers};
use std::collections::HashMap;

/// The faces of one name; `None` where the document gives them none.
pub(crate) struct Named<'d> {
    pub name: Option<&'d str>,
    pub layered: Vec<Layered<'d>>,
}

/// The faces of one name that are on the same layers.
pub(crate) struct Layered<'d> {
    pub layers: &'d Layers,
    /// By colour.
    pub parts: Vec<Part>,
}

/// Faces of one name, on the same layers, and of one colour.
pub(crate) struct Part {
    pub colour: Option<Colour>,
    /// Indices of the document's faces, ascending.
    pub faces: Vec<usize>,
}

/// All faces of a document, once each. Names stand in the order of their first faces, and so do the layers of each, and colours.
pub(crate) fn named(document: &Document) -> Vec<Named<'_>> {
    let mut all: Vec<Named> = vec![];
    let (mut names, mut layers, mut colours) = (HashMap::new(), HashMap::new(), HashMap::new());
    for (face, said) in document.attributes.iter().enumerate() {
        let name = *names.entry(said.name.as_deref()).or_insert_with(|| {
            all.push(Named { name: said.name.as_deref(), layered: vec![] });
            all.len() - 1
        });
        let layered = &mut all[name].layered;
        let on = *layers.entry((name, &said.layers)).or_insert_with(|| {
            layered.push(Layered { layers: &said.layers, parts: vec![] });
            layered.len() - 1
        });
        let parts = &mut layered[on].parts;
        let part = *colours.entry((name, on, said.colour)).or_insert_with(|| {
            parts.push(Part { colour: said.colour, faces: vec![] });
            parts.len() - 1
        });
        parts[part].faces.push(face);
    }
    all
}

/// The colours of a document's faces, each once, in order.
pub(crate) fn colours(document: &Document) -> Vec<Colour> {
    let mut colours: Vec<Colour> = document.attributes.iter().filter_map(|said| said.colour).collect();
    colours.sort();
    colours.dedup();
    colours
}

/// What is lost of a document's names, colours and layers in a file that has no place for them, in words; `None` where there are none.
pub(crate) fn lost(document: &Document, format: &str) -> Option<String> {
    let has = |what: &str, is_there: bool| is_there.then(|| what.to_owned());
    let names = has("names", document.attributes.iter().any(|said| said.name.is_some()));
    let colours = has("colours", !colours(document).is_empty());
    let layers = has("layers", document.attributes.iter().any(|said| !said.layers.is_empty()));
    let what: Vec<String> = names.into_iter().chain(colours).chain(layers).collect();
    let (last, others) = what.split_last()?;
    let what = if others.is_empty() { last.clone() } else { format!("{} and {last}", others.join(", ")) };
    Some(format!("{what} of faces are not written: {format} has no place for them"))
}

//! Wavefront OBJ: points and normals as text, an object a name, a group a face and a layer; f64 as it is.
//!
//! Colours stand in a material library beside the file (`.mtl`), as readers expect them: a vertex has faces of several colours.

use crate::error::ExportError;
use crate::mesh::{FaceMesh, Mesh, mesh};
use crate::parts::{Layered, Part, colours, named};
use crate::writer::{Asked, Beside, Ready, Writer, Written};
use formats::{Colour, Document};
use scene::escaped;
use std::io::{self, Write};

/// What faces without a colour are painted in a file that has colours; a material stays until the next one is named.
const UNCOLOURED: Colour = Colour([204; 3]);

/// The writer.
pub struct Obj;

impl Writer for Obj {
    fn name(&self) -> &'static str {
        "OBJ"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["obj"]
    }

    fn is_tessellated(&self) -> bool {
        true
    }

    fn prepare<'d>(&self, stem: &str, document: &'d Document, asked: Asked) -> Result<Ready<'d>, ExportError> {
        let mesh = mesh(&document.model, asked.error, asked.progress)?;
        let unit = document.unit.as_ref();
        let mut notes: Vec<String> = unit
            .map(|unit| format!("the unit, {}, is a comment: OBJ has no place for it", unit.name))
            .into_iter()
            .collect();
        let colours = colours(document);
        let library = (!colours.is_empty()).then(|| format!("{}.mtl", word(stem)));
        notes.extend(library.iter().map(|name| format!("colours stand in {name}, beside it")));
        let written = Written { faces: document.model.faces().len(), mesh: Some(mesh.facts.clone()), notes };
        let named = library.clone();
        let fill = Box::new(move |out: &mut dyn Write| fill(out, document, &mesh, named.as_deref()));
        let beside = library.map(|name| Beside { name, fill: Box::new(move |out| materials(out, &colours)) });
        Ok(Ready { written, fill, beside })
    }
}

/// A text as one word of the file.
fn word(text: &str) -> String {
    text.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).collect()
}

fn material(colour: Option<Colour>) -> String {
    colour.map_or_else(|| "uncoloured".to_owned(), |colour| colour.to_string().replace('#', "colour_"))
}

fn materials(out: &mut dyn Write, colours: &[Colour]) -> io::Result<()> {
    for colour in colours.iter().copied().map(Some).chain([None]) {
        let [red, green, blue] = colour.unwrap_or(UNCOLOURED).0.map(|part| f64::from(part) / 255.0);
        writeln!(out, "newmtl {}\nKd {red} {green} {blue}", material(colour))?;
    }
    Ok(())
}

fn fill(out: &mut dyn Write, document: &Document, mesh: &Mesh, library: Option<&str>) -> io::Result<()> {
    writeln!(out, "# {}", escaped(document.model.name()))?;
    if let Some(unit) = &document.unit {
        writeln!(out, "# unit: {}, {:?} mm", escaped(&unit.name), unit.millimetres)?;
    }
    if let Some(library) = library {
        writeln!(out, "mtllib {library}")?;
    }
    for p in &mesh.points {
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    let mut normals = 0;
    for named in named(document) {
        if let Some(name) = named.name {
            writeln!(out, "o {}", word(name))?;
        }
        for Layered { layers, parts } in &named.layered {
            let layers: String = layers.iter().map(|layer| format!(" layer_{}", word(layer))).collect();
            for Part { colour, faces } in parts {
                if library.is_some() {
                    writeln!(out, "usemtl {}", material(*colour))?;
                }
                for index in faces {
                    writeln!(out, "g face_{index}{layers}")?;
                    normals = triangles(out, &mesh.faces[*index], normals)?;
                }
            }
        }
    }
    Ok(())
}

/// The triangles of a face, whose normals follow so many; how many there are then.
fn triangles(out: &mut dyn Write, face: &FaceMesh, normals: u32) -> io::Result<u32> {
    for corner in &face.corners {
        let n = corner.normal;
        writeln!(out, "vn {:.6} {:.6} {:.6}", n.x, n.y, n.z)?;
    }
    for triangle in &face.triangles {
        let corner = |k: u32| format!("{}//{}", face.corners[k as usize].point + 1, normals + k + 1);
        let [a, b, c] = triangle.map(corner);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(normals + face.corners.len() as u32)
}

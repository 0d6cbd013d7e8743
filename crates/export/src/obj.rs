//! Wavefront OBJ: points and normals as text, a group a face; f64 as it is.

use crate::error::ExportError;
use crate::mesh::{Mesh, mesh};
use crate::writer::{Asked, Ready, Writer, Written};
use formats::Document;
use scene::escaped;
use std::io::{self, Write};

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

    fn prepare<'d>(&self, document: &'d Document, asked: Asked) -> Result<Ready<'d>, ExportError> {
        let mesh = mesh(&document.model, asked.error, asked.progress)?;
        let unit = document.unit.as_ref();
        let notes = unit.map(|unit| format!("the unit, {}, is a comment: OBJ has no place for it", unit.name));
        let facts = Some(mesh.facts.clone());
        let written = Written { faces: document.model.faces().len(), mesh: facts, notes: notes.into_iter().collect() };
        Ok(Ready { written, fill: Box::new(move |out| fill(out, document, &mesh)) })
    }
}

fn fill(out: &mut dyn Write, document: &Document, mesh: &Mesh) -> io::Result<()> {
    writeln!(out, "# {}", escaped(document.model.name()))?;
    if let Some(unit) = &document.unit {
        writeln!(out, "# unit: {}, {:?} mm", escaped(&unit.name), unit.millimetres)?;
    }
    for p in &mesh.points {
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    let mut normals = 0;
    for (index, face) in mesh.faces.iter().enumerate() {
        writeln!(out, "g face_{index}")?;
        for corner in &face.corners {
            let n = corner.normal;
            writeln!(out, "vn {:.6} {:.6} {:.6}", n.x, n.y, n.z)?;
        }
        for triangle in &face.triangles {
            let corner = |k: u32| format!("{}//{}", face.corners[k as usize].point + 1, normals + k + 1);
            let [a, b, c] = triangle.map(corner);
            writeln!(out, "f {a} {b} {c}")?;
        }
        normals += face.corners.len() as u32;
    }
    Ok(())
}

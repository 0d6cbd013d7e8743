//! Binary STL: a header of 80 bytes, and for each triangle its normal and its corners in f32, little-endian.
//!
//! Coordinates are the model's own, rounded: far from the origin that is more than the error, and a note says how much.

use crate::error::ExportError;
use crate::mesh::{Mesh, mesh};
use crate::parts::lost;
use crate::writer::{Asked, Ready, Writer, Written};
use formats::Document;
use std::io::{self, Write};

/// The writer.
pub struct Stl;

impl Writer for Stl {
    fn name(&self) -> &'static str {
        "STL"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["stl"]
    }

    fn is_tessellated(&self) -> bool {
        true
    }

    fn prepare<'d>(&self, _: &str, document: &'d Document, asked: Asked) -> Result<Ready<'d>, ExportError> {
        let mesh = mesh(&document.model, asked.error, asked.progress)?;
        let mut notes = vec![];
        if let Some(unit) = &document.unit {
            notes.push(format!("the unit, {}, is not written: STL has no place for it", unit.name));
        }
        notes.extend(lost(document, "STL"));
        let rounded = mesh.points.iter().map(|p| (p.as_vec3().as_dvec3() - *p).length()).fold(0.0, f64::max);
        let merged =
            mesh.faces.iter().flat_map(|face| face.triangles.iter().map(move |t| (face, t))).filter(|(face, t)| {
                let [a, b, c] = t.map(|corner| mesh.points[face.corners[corner as usize].point as usize].as_vec3());
                a == b || b == c || c == a
            });
        let merged = merged.count();
        notes.push(format!("coordinates are rounded to f32, by up to {rounded:.1e}"));
        if 0 < merged {
            notes.push(format!("{merged} triangles have two corners that f32 does not tell apart"));
        }
        let written = Written { faces: document.model.faces().len(), mesh: Some(mesh.facts.clone()), notes };
        Ok(Ready { written, fill: Box::new(move |out| fill(out, &mesh)), beside: None })
    }
}

fn fill(out: &mut dyn Write, mesh: &Mesh) -> io::Result<()> {
    // Not "solid", by which readers know the text form.
    let mut header = [b' '; 80];
    let text = b"binary STL by isophote";
    header[..text.len()].copy_from_slice(text);
    out.write_all(&header)?;
    out.write_all(&(mesh.facts.triangles as u32).to_le_bytes())?;
    for face in &mesh.faces {
        for triangle in &face.triangles {
            let [a, b, c] = triangle.map(|corner| mesh.points[face.corners[corner as usize].point as usize]);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for p in [normal, a, b, c] {
                p.as_vec3().to_array().iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
            }
            out.write_all(&[0, 0])?;
        }
    }
    Ok(())
}

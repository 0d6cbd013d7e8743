//! glTF 2.0, binary (.glb): a mesh with normals, in f32 about the middle of the model.
//!
//! The node moves it back and scales it to metres, as glTF asks for; so coordinates of 1e9 keep what they differ by. A viewer
//! that multiplies in f32 loses it again. z stays up where the model has it so: glTF's y-up is not applied.

use crate::error::ExportError;
use crate::mesh::{Mesh, mesh};
use crate::writer::{Asked, Ready, Writer, Written};
use formats::Document;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::io::{self, Write};

/// Millimetres in a metre.
const METRE: f64 = 1e3;

/// Constants of the format: element types and targets of buffers.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The writer.
pub struct Gltf;

impl Writer for Gltf {
    fn name(&self) -> &'static str {
        "glTF"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["glb"]
    }

    fn is_tessellated(&self) -> bool {
        true
    }

    fn prepare<'d>(&self, document: &'d Document, asked: Asked) -> Result<Ready<'d>, ExportError> {
        let mesh = mesh(&document.model, asked.error, asked.progress)?;
        let middle = document.model.hull().center();
        let lost = mesh.points.iter().map(|p| ((*p - middle).as_vec3().as_dvec3() - (*p - middle)).length());
        let mut notes = vec![format!(
            "coordinates about the model's middle are rounded to f32, by up to {:.1e}",
            lost.fold(0.0, f64::max)
        )];
        if document.unit.is_none() {
            notes.push("the model names no unit: it is taken for metres, which are glTF's".to_owned());
        }
        let written = Written { faces: document.model.faces().len(), mesh: Some(mesh.facts.clone()), notes };
        Ok(Ready { written, fill: Box::new(move |out| fill(out, document, &mesh, middle)) })
    }
}

fn fill(out: &mut dyn Write, document: &Document, mesh: &Mesh, middle: DVec3) -> io::Result<()> {
    let local = |point: u32| (mesh.points[point as usize] - middle).as_vec3();
    let corners = || mesh.faces.iter().flat_map(|face| &face.corners);
    let count = corners().count();
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    corners().for_each(|corner| (min, max) = (min.min(local(corner.point)), max.max(local(corner.point))));
    let vectors = 12 * count;
    let indices = 12 * mesh.facts.triangles;
    let scale = document.unit.as_ref().map_or(1.0, |unit| unit.millimetres / METRE);
    let view = |offset: usize, length: usize, target: u32| json!({"buffer": 0, "byteOffset": offset, "byteLength": length, "target": target});
    let mut head = json!({
        "asset": {"version": "2.0", "generator": format!("isophote {}", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": document.model.name(), "translation": (middle * scale).to_array(), "scale": [scale, scale, scale]}],
    });
    if 0 < mesh.facts.triangles {
        let parts = json!({
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "mode": 4}]}],
            "accessors": [
                {"bufferView": 0, "componentType": FLOAT, "count": count, "type": "VEC3", "min": min.to_array(), "max": max.to_array()},
                {"bufferView": 1, "componentType": FLOAT, "count": count, "type": "VEC3"},
                {"bufferView": 2, "componentType": UNSIGNED_INT, "count": 3 * mesh.facts.triangles, "type": "SCALAR"},
            ],
            "bufferViews": [
                view(0, vectors, ARRAY_BUFFER), view(vectors, vectors, ARRAY_BUFFER), view(2 * vectors, indices, ELEMENT_ARRAY_BUFFER),
            ],
            "buffers": [{"byteLength": 2 * vectors + indices}],
        });
        head["nodes"][0]["mesh"] = json!(0);
        if let (Value::Object(head), Value::Object(parts)) = (&mut head, parts) {
            head.extend(parts);
        }
    }
    let mut head = head.to_string();
    // A chunk ends at a multiple of four.
    head.extend(std::iter::repeat_n(' ', head.len().next_multiple_of(4) - head.len()));
    let body = 2 * vectors + indices;
    let mut words = |words: &[u32]| words.iter().try_for_each(|word| out.write_all(&word.to_le_bytes()));
    words(&[u32::from_le_bytes(*b"glTF"), 2, (12 + 8 + head.len() + 8 + body) as u32])?;
    words(&[head.len() as u32, u32::from_le_bytes(*b"JSON")])?;
    out.write_all(head.as_bytes())?;
    let mut words = |words: &[u32]| words.iter().try_for_each(|word| out.write_all(&word.to_le_bytes()));
    words(&[body as u32, u32::from_le_bytes(*b"BIN\0")])?;
    for corner in corners() {
        words(&local(corner.point).to_array().map(f32::to_bits))?;
    }
    for corner in corners() {
        // A unit vector of f32, as the format asks for.
        words(&corner.normal.as_vec3().normalize_or(Vec3::Z).to_array().map(f32::to_bits))?;
    }
    let mut first = 0;
    for face in &mesh.faces {
        for triangle in &face.triangles {
            words(&triangle.map(|corner| first + corner))?;
        }
        first += face.corners.len() as u32;
    }
    Ok(())
}

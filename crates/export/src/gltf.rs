//! glTF 2.0, binary (.glb): meshes with normals, in f32 about the middle of the model.
//!
//! The first node moves them back and scales them to metres, as glTF asks for; so coordinates of 1e9 keep what they differ by. A
//! viewer that multiplies in f32 loses it again. z stays up where the model has it so: glTF's y-up is not applied.
//!
//! Below it each name of faces has a node with a mesh, one for all that are on the same layers, which are its extras; and each
//! colour in it has a primitive with a material.

use crate::error::ExportError;
use crate::mesh::{Corner, FaceMesh, Mesh, mesh};
use crate::parts::{Layered, Part, colours, named};
use crate::writer::{Asked, Ready, Writer, Written};
use formats::{Colour, Document, Layers};
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

/// Bytes of a vector, and of a number of a corner.
const VECTOR: usize = 12;
const INDEX: usize = 4;

/// How rough materials are: neither a mirror nor chalk.
const ROUGHNESS: f64 = 0.5;

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

    fn prepare<'d>(&self, _: &str, document: &'d Document, asked: Asked) -> Result<Ready<'d>, ExportError> {
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
        let fill = Box::new(move |out: &mut dyn Write| fill(out, document, &Local { mesh: &mesh, middle }));
        Ok(Ready { written, fill, beside: None })
    }
}

/// A mesh about the middle of its model.
struct Local<'m> {
    mesh: &'m Mesh,
    middle: DVec3,
}

impl Local<'_> {
    fn point(&self, corner: &Corner) -> Vec3 {
        (self.mesh.points[corner.point as usize] - self.middle).as_vec3()
    }
}

/// A primitive: faces of one name and one colour that have triangles.
struct Primitive<'m> {
    colour: Option<Colour>,
    faces: Vec<&'m FaceMesh>,
}

impl Primitive<'_> {
    fn corners(&self) -> impl Iterator<Item = &Corner> {
        self.faces.iter().flat_map(|face| &face.corners)
    }
}

/// A node: what faces of one name on the same layers have.
struct Node<'d, 'm> {
    name: Option<&'d str>,
    layers: &'d Layers,
    primitives: Vec<Primitive<'m>>,
}

/// The nodes that have any triangles.
fn nodes<'d, 'm>(document: &'d Document, mesh: &'m Mesh) -> Vec<Node<'d, 'm>> {
    let primitive = |part: &Part| {
        let faces = part.faces.iter().map(|face| &mesh.faces[*face]);
        Primitive { colour: part.colour, faces: faces.filter(|face| !face.triangles.is_empty()).collect() }
    };
    let node = |name: Option<&'d str>, Layered { layers, parts }: Layered<'d>| {
        let primitives = parts.iter().map(primitive).filter(|own| !own.faces.is_empty()).collect();
        Node { name, layers, primitives }
    };
    let of_name = named(document).into_iter();
    let all = of_name.flat_map(|named| named.layered.into_iter().map(move |layered| node(named.name, layered)));
    all.filter(|node| !node.primitives.is_empty()).collect()
}

fn fill(out: &mut dyn Write, document: &Document, local: &Local) -> io::Result<()> {
    let nodes = nodes(document, local.mesh);
    let all = || nodes.iter().flat_map(|node| &node.primitives);
    let vectors = VECTOR * all().map(|own| own.corners().count()).sum::<usize>();
    let body = 2 * vectors + 3 * INDEX * local.mesh.facts.triangles;
    let mut head = head(document, local, &nodes, [vectors, body]).to_string();
    // A chunk ends at a multiple of four.
    head.extend(std::iter::repeat_n(' ', head.len().next_multiple_of(4) - head.len()));
    let mut words = |words: &[u32]| words.iter().try_for_each(|word| out.write_all(&word.to_le_bytes()));
    words(&[u32::from_le_bytes(*b"glTF"), 2, (12 + 8 + head.len() + 8 + body) as u32])?;
    words(&[head.len() as u32, u32::from_le_bytes(*b"JSON")])?;
    out.write_all(head.as_bytes())?;
    let mut words = |words: &[u32]| words.iter().try_for_each(|word| out.write_all(&word.to_le_bytes()));
    words(&[body as u32, u32::from_le_bytes(*b"BIN\0")])?;
    for corner in all().flat_map(Primitive::corners) {
        words(&local.point(corner).to_array().map(f32::to_bits))?;
    }
    for corner in all().flat_map(Primitive::corners) {
        // A unit vector of f32, as the format asks for.
        words(&corner.normal.as_vec3().normalize_or(Vec3::Z).to_array().map(f32::to_bits))?;
    }
    for primitive in all() {
        let mut first = 0;
        for face in &primitive.faces {
            for triangle in &face.triangles {
                words(&triangle.map(|corner| first + corner))?;
            }
            first += face.corners.len() as u32;
        }
    }
    Ok(())
}

/// The JSON part. `vectors` are the bytes of all positions, and so of all normals; `body` those of the binary part.
fn head(document: &Document, local: &Local, nodes: &[Node], [vectors, body]: [usize; 2]) -> Value {
    let scale = document.unit.as_ref().map_or(1.0, |unit| unit.millimetres / METRE);
    let translation = (local.middle * scale).to_array();
    let mut whole =
        vec![json!({"name": document.model.name(), "translation": translation, "scale": [scale, scale, scale]})];
    let mut head = json!({
        "asset": {"version": "2.0", "generator": format!("isophote {}", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
    });
    if !nodes.is_empty() {
        let colours = colours(document);
        let (mut meshes, mut accessors, mut at) = (vec![], vec![], [0; 2]);
        for Node { name, layers, primitives } in nodes {
            let primitives: Vec<Value> = primitives
                .iter()
                .map(|own| {
                    let [position, normal, indices] = [0, 1, 2].map(|k| accessors.len() + k);
                    accessors.extend(accessors_of(own, local, &mut at));
                    let attributes = json!({"POSITION": position, "NORMAL": normal});
                    let mut primitive = json!({"attributes": attributes, "indices": indices, "mode": 4});
                    if let Some(material) = own.colour.and_then(|colour| colours.binary_search(&colour).ok()) {
                        primitive["material"] = json!(material);
                    }
                    primitive
                })
                .collect();
            let mut node = json!({"mesh": meshes.len()});
            if let Some(name) = name {
                node["name"] = json!(name);
            }
            if !layers.is_empty() {
                node["extras"] = json!({"layers": layers.iter().map(|layer| &**layer).collect::<Vec<&str>>()});
            }
            whole.push(node);
            meshes.push(json!({"primitives": primitives}));
        }
        whole[0]["children"] = (1..whole.len()).collect();
        head["meshes"] = Value::from(meshes);
        head["accessors"] = Value::from(accessors);
        if !colours.is_empty() {
            head["materials"] = colours.into_iter().map(material).collect();
        }
        let corners = |at: usize| json!({"buffer": 0, "byteOffset": at, "byteLength": vectors, "byteStride": VECTOR, "target": ARRAY_BUFFER});
        let indices = json!({"buffer": 0, "byteOffset": 2 * vectors, "byteLength": body - 2 * vectors, "target": ELEMENT_ARRAY_BUFFER});
        head["bufferViews"] = json!([corners(0), corners(vectors), indices]);
        head["buffers"] = json!([{"byteLength": body}]);
    }
    head["nodes"] = Value::from(whole);
    head
}

/// Positions, normals and corners' numbers of a primitive; `at` counts the bytes of vectors, and of numbers, before it.
fn accessors_of(own: &Primitive, local: &Local, at: &mut [usize; 2]) -> [Value; 3] {
    let count = own.corners().count();
    let corners: usize = own.faces.iter().map(|face| 3 * face.triangles.len()).sum();
    let points = || own.corners().map(|corner| local.point(corner));
    let (min, max) = (points().fold(Vec3::INFINITY, Vec3::min), points().fold(Vec3::NEG_INFINITY, Vec3::max));
    let [vector, index] = *at;
    *at = [vector + VECTOR * count, index + INDEX * corners];
    let vectors = |view: u32| json!({"bufferView": view, "byteOffset": vector, "componentType": FLOAT, "count": count, "type": "VEC3"});
    let (mut positions, normals) = (vectors(0), vectors(1));
    positions["min"] = json!(min.to_array());
    positions["max"] = json!(max.to_array());
    let indices = json!({"bufferView": 2, "byteOffset": index, "componentType": UNSIGNED_INT, "count": corners, "type": "SCALAR"});
    [positions, normals, indices]
}

/// A material of a colour, which glTF wants in linear parts.
fn material(colour: Colour) -> Value {
    let [red, green, blue] = colour.0.map(linear);
    json!({
        "name": colour.to_string(),
        "pbrMetallicRoughness": {"baseColorFactor": [red, green, blue, 1.0], "metallicFactor": 0.0, "roughnessFactor": ROUGHNESS},
        "doubleSided": true,
    })
}

/// A part of a colour in sRGB as a share of light (IEC 61966-2-1).
fn linear(part: u8) -> f64 {
    let part = f64::from(part) / 255.0;
    if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
}

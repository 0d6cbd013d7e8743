//! STEP (ISO 10303-21, AP214): every face with its own surface and its trims as PCURVEs, bit for bit.
//!
//! [`edges`] finds what trims are one edge, [`space`] puts it in space, [`geometry`] spells surfaces and curves, [`looks`] names,
//! colours and layers, [`mod@product`] what stands around them. A closed model is a MANIFOLD_SOLID_BREP, any other a SHELL_BASED_SURFACE_MODEL.

mod edges;
mod geometry;
mod looks;
mod product;
mod space;
mod text;

use crate::error::ExportError;
use crate::writer::{Asked, Ready, Writer, Written};
use edges::{Bound, Edge, Topology};
use formats::Document;
use product::{FOOTER, Product, header, product};
use scene::{FaceId, Model};
use text::{Text, flag, references};

/// Without a tolerance of its own a model is written to this share of its size.
const USUAL_SHARE: f64 = 1e-7;

/// What runs farther apart than this share of the model's size is not one edge, whatever its number.
const GREATEST_SHARE: f64 = 1e-4;

/// The writer.
pub struct Step;

impl Writer for Step {
    fn name(&self) -> &'static str {
        "STEP"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["step", "stp"]
    }

    fn is_tessellated(&self) -> bool {
        false
    }

    fn prepare<'d>(&self, _: &str, document: &'d Document, asked: Asked) -> Result<Ready<'d>, ExportError> {
        let model = &document.model;
        let uncertainty = uncertainty(model);
        let topology = Topology::new(model, uncertainty)?;
        let mut text = Text::default();
        let product = product(&mut text, model.name(), document.unit.as_ref(), uncertainty);
        shape(&mut text, document, &topology, &product, asked);
        let mut notes = vec![];
        if document.unit.is_none() {
            notes.push("the model names no unit: millimetres are written, which STEP cannot leave out".to_owned());
        }
        let error = topology.edges.iter().map(|edge| edge.space.error).fold(0.0, f64::max);
        let approximated = topology.edges.iter().filter(|edge| 0.0 < edge.space.error).count();
        if 0 < approximated {
            notes.push(format!(
                "{approximated} of {} edges are no splines in space: there they are within {error:.1e}, as measured; \
                 their curves in (u, v) are exact",
                topology.edges.len()
            ));
        }
        let parts = topology.parts.len();
        if model.faces().len() < parts {
            let faces = model.faces().len();
            notes.push(format!(
                "{parts} faces are written for {faces}: one for each outer loop, since STEP has one to a face"
            ));
        }
        let written = Written { faces: model.faces().len(), mesh: None, notes };
        let (head, body) = (header(model.name()), text.finish());
        let fill = move |out: &mut dyn std::io::Write| {
            [&head, &body, FOOTER].iter().try_for_each(|t| out.write_all(t.as_bytes()))
        };
        Ok(Ready { written, fill: Box::new(fill), beside: None })
    }
}

/// What is stated for the whole file: the greatest of the faces' own tolerances; where there is none, what its edges run apart.
fn uncertainty(model: &Model) -> f64 {
    let own = model.faces().iter().map(|face| face.tolerance).fold(0.0, f64::max);
    if 0.0 < own {
        return own;
    }
    let size = model.hull().diagonal();
    let gaps = model.shared_edges().into_iter().map(|edge| edge.gap).filter(|gap| *gap <= GREATEST_SHARE * size);
    // Gaps are sampled, and the edge in space has an error of its own.
    gaps.fold(USUAL_SHARE * size, |most, gap| most.max(2.0 * gap))
}

fn shape(text: &mut Text, document: &Document, topology: &Topology, product: &Product, asked: Asked) {
    let Document { model, attributes, .. } = document;
    let surfaces: Vec<u64> =
        (0..model.faces().len()).map(|index| geometry::surface(text, model.surface(FaceId(index as u32)))).collect();
    let vertices: Vec<u64> = topology
        .vertices
        .iter()
        .map(|p| {
            let point = geometry::point(text, *p);
            text.add(&format!("VERTEX_POINT('',#{point})"))
        })
        .collect();
    let edges: Vec<u64> =
        topology.edges.iter().map(|edge| edge_curve(text, edge, &surfaces, &vertices, product.parameters)).collect();
    let mut faces = vec![];
    for part in &topology.parts {
        let is_reversed = model.faces()[part.face].reversed;
        let bounds: Vec<u64> =
            part.bounds.iter().map(|bound| face_bound(text, bound, topology, &edges, is_reversed)).collect();
        let (surface, sense) = (surfaces[part.face], flag(!is_reversed));
        let label = looks::label(&attributes[part.face]);
        faces.push(text.add(&format!("ADVANCED_FACE({label},{},#{surface},{sense})", references(&bounds))));
        (asked.progress)(part.face + 1);
    }
    let parts = topology.parts.iter().zip(&faces);
    let coloured = parts.filter_map(|(part, face)| Some((*face, attributes[part.face].colour?)));
    looks::paint(text, coloured, product.space);
    looks::assign(text, topology.parts.iter().zip(&faces).map(|(part, face)| (*face, &attributes[part.face])));
    let shells = topology.shells(model);
    let is_solid = shells.iter().all(|(_, is_closed)| *is_closed);
    let shells: Vec<u64> = shells
        .iter()
        .map(|(members, is_closed)| {
            let members: Vec<u64> = members.iter().map(|part| faces[*part]).collect();
            let kind = if *is_closed { "CLOSED" } else { "OPEN" };
            text.add(&format!("{kind}_SHELL('',{})", references(&members)))
        })
        .collect();
    let (kind, items) = if is_solid {
        let solids = shells.iter().map(|shell| text.add(&format!("MANIFOLD_SOLID_BREP('',#{shell})"))).collect();
        ("ADVANCED_BREP_SHAPE_REPRESENTATION", solids)
    } else {
        let all = text.add(&format!("SHELL_BASED_SURFACE_MODEL('',{})", references(&shells)));
        ("MANIFOLD_SURFACE_SHAPE_REPRESENTATION", vec![all])
    };
    let items = references(&items);
    let representation = text.add(&format!("{kind}('',{items},#{})", product.space));
    text.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{},#{representation})", product.shape));
}

fn edge_curve(text: &mut Text, edge: &Edge, surfaces: &[u64], vertices: &[u64], parameters: u64) -> u64 {
    let (start, end) = edge.space.curve.knots().domain();
    // The curve of the forward use comes first: readers of a seam go by that.
    let mut uses: Vec<_> = edge.uses.iter().collect();
    uses.sort_by_key(|own| !own.forward);
    let mut curves = vec![];
    for own in uses {
        let curve = geometry::trim_curve(text, &own.trim, [start, end], own.turned);
        let representation = text.add(&format!("DEFINITIONAL_REPRESENTATION('',(#{curve}),#{parameters})"));
        curves.push(text.add(&format!("PCURVE('',#{},#{representation})", surfaces[own.face])));
    }
    let space = geometry::curve(text, &edge.space.curve);
    let is_seam = matches!(&edge.uses[..], [a, b] if a.face == b.face);
    let kind = if is_seam { "SEAM_CURVE" } else { "SURFACE_CURVE" };
    let curve = text.add(&format!("{kind}('',#{space},{},.PCURVE_S1.)", references(&curves)));
    let [start, end] = edge.vertices.map(|vertex| vertices[vertex]);
    text.add(&format!("EDGE_CURVE('',#{start},#{end},#{curve},.T.)"))
}

/// A loop as its face's surface has it, turned where the face is: material is on its left as seen from the face's normal.
fn face_bound(text: &mut Text, bound: &Bound, topology: &Topology, edges: &[u64], is_reversed: bool) -> u64 {
    let run = match &bound.uses[..] {
        [] => {
            let point = geometry::point(text, bound.at);
            let vertex = text.add(&format!("VERTEX_POINT('',#{point})"));
            text.add(&format!("VERTEX_LOOP('',#{vertex})"))
        }
        uses => {
            let oriented = |(edge, own): &(usize, usize)| {
                let forward = flag(topology.edges[*edge].uses[*own].forward);
                text.add(&format!("ORIENTED_EDGE('',*,*,#{},{forward})", edges[*edge]))
            };
            let oriented: Vec<u64> = uses.iter().map(oriented).collect();
            text.add(&format!("EDGE_LOOP('',{})", references(&oriented)))
        }
    };
    let kind = if bound.outer { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
    text.add(&format!("{kind}('',#{run},{})", flag(!is_reversed)))
}

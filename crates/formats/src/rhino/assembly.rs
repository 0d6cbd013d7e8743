//! Objects as they are drawn: each visible one in its place, those of blocks wherever a reference places them.

use super::archive::{Cursor, Fault, Uuid};
use super::attributes::Look;
use super::body::{Body, Placement};
use super::brep;
use super::class::Class;
use super::extrusion::Extrusion;
use super::sheet::Sheet;
use super::tables::{Record, Tables};
use crate::document::{Attributes, Colour, Document, Layers, Note, NoteKind, name};
use crate::error::{Cause, FormatError, shorten};
use crate::format::file_name;
use crate::place::Place;
use glam::{DMat3, DVec3};
use nurbs::Surface;
use scene::{Face, FaceId, Model};
use std::collections::{HashMap, HashSet};

/// How deep blocks may stand in blocks.
const DEEPEST: usize = 16;

/// The most objects that are placed, and the most control points of theirs: beyond that, blocks are left out.
const MOST_PLACED: usize = 1 << 18;
const MOST_POINTS: usize = 1 << 22;

/// Everything in its place.
struct Assembly<'t, 'a> {
    tables: &'t Tables<'a>,
    records: HashMap<Uuid, usize>,
    /// What objects of blocks are drawn as, by their records.
    bodies: HashMap<usize, Body>,
    /// By their numbers.
    layers: HashMap<i32, Layers>,
    surfaces: Vec<Surface>,
    faces: Vec<(usize, Face)>,
    /// The record of each face, and what is said of it.
    origins: Vec<(usize, Attributes)>,
    notes: Vec<Note>,
    /// The next edge of the model.
    next_edge: i64,
    placed: usize,
    points: usize,
}

/// The document of an archive.
pub(super) fn document(mut tables: Tables, file: &str) -> Result<Document, FormatError> {
    let remarks = std::mem::take(&mut tables.remarks);
    let (unit, tables) = (tables.unit.take(), &tables);
    let by_id = |(k, record): (usize, &Record)| Some((record.attributes.id?, k));
    let mut assembly = Assembly {
        tables,
        records: tables.records.iter().enumerate().filter_map(by_id).collect(),
        bodies: HashMap::new(),
        layers: HashMap::new(),
        surfaces: vec![],
        faces: vec![],
        origins: vec![],
        notes: remarks.into_iter().map(|r| Note { kind: r.kind, place: Place::Byte(r.at), text: r.text }).collect(),
        next_edge: 0,
        placed: 0,
        points: 0,
    };
    let in_blocks: HashSet<Uuid> = tables.blocks.values().flat_map(|block| block.objects.iter().copied()).collect();
    for (k, record) in tables.records.iter().enumerate() {
        let attributes = &record.attributes;
        if !attributes.is_in_block && !attributes.id.is_some_and(|id| in_blocks.contains(&id)) {
            assembly.draw(k, &Placement::IDENTITY, None, 0);
        }
    }
    let Assembly { surfaces, faces, origins, mut notes, .. } = assembly;
    if faces.is_empty() {
        let first = notes
            .first()
            .map_or("it holds no object".into(), |note| format!("the first of {} notes: {note}", notes.len()));
        return Err(FormatError::new(file, Place::File, Cause::Kind(format!("nothing in it can be drawn; {first}"))));
    }
    let model = Model::of_sound_faces(file_name(file), surfaces, faces, vec![])
        .map_err(|cause| FormatError::new(file, Place::File, Cause::Scene(cause)))?;
    for note in model.notes() {
        let origin = note.face().and_then(|face| origins.get(face)).map(|(k, _)| &tables.records[*k]);
        let mut note = Note::of_model(origin.map_or(Place::File, |record| Place::Byte(record.at)), note);
        if let Some(record) = origin {
            note.text = format!("{}: {}", label(record), note.text);
        }
        notes.push(note);
    }
    let attributes = (0..model.faces().len()).map(|face| origins[model.number_in_file(FaceId(face as u32))].1.clone());
    Ok(Document { attributes: attributes.collect(), model, unit, notes })
}

/// How an object is called in notes: by its class, its name and its identifier.
fn label(record: &Record) -> String {
    let name = match &record.attributes.name {
        name if name.is_empty() => String::new(),
        name => format!(" \"{}\"", shorten(name)),
    };
    let id = record.attributes.id.map_or(String::new(), |id| format!(" {id}"));
    format!("{}{name}{id}", record.object.kind())
}

impl Assembly<'_, '_> {
    fn note(&mut self, kind: NoteKind, k: usize, at: usize, text: &str) {
        let text = format!("{}: {text}", label(&self.tables.records[k]));
        self.notes.push(Note { kind, place: Place::Byte(at), text });
    }

    fn leave_out(&mut self, k: usize, text: &str) {
        self.note(NoteKind::LeftOut, k, self.tables.records[k].at, text);
    }

    /// Draws the object of record `k`, where it is visible; `parent` is how the reference is drawn that places it.
    fn draw(&mut self, k: usize, placement: &Placement, parent: Option<Look>, depth: usize) {
        let record = &self.tables.records[k];
        if record.attributes.is_hidden {
            return self.leave_out(k, "it is hidden");
        }
        if let Some(layer) = self.tables.hiding_layer(&record.attributes) {
            return self.leave_out(k, &format!("its layer \"{}\" is hidden", shorten(&layer.name)));
        }
        if record.attributes.is_on_page {
            return self.leave_out(k, "it is on a page, not in space");
        }
        let look = self.tables.look(&record.attributes, parent);
        if record.object.class == Class::InstanceReference {
            return self.place(k, placement, look, depth);
        }
        let is_new = !self.bodies.contains_key(&k);
        let body = match self.bodies.get(&k) {
            Some(body) => Ok(body.clone()),
            None => body(record, self.tables.tolerance),
        };
        match body {
            Ok(mut body) => {
                if is_new {
                    for remark in std::mem::take(&mut body.remarks) {
                        self.note(remark.kind, k, remark.at, &remark.text);
                    }
                    if depth > 0 {
                        self.bodies.insert(k, body.clone());
                    }
                }
                self.add(k, body, placement, look.colour);
            }
            Err(fault) => {
                // Said once, however often the object is placed.
                if is_new {
                    self.note(NoteKind::LeftOut, k, fault.at, &fault.text);
                    self.bodies.insert(k, Body::default());
                }
            }
        }
    }

    /// Draws the objects of the block that a reference places.
    fn place(&mut self, k: usize, placement: &Placement, look: Look, depth: usize) {
        let record = &self.tables.records[k];
        let (block, own) = match reference(&mut record.object.data.clone()) {
            Ok(found) => found,
            Err(fault) => return self.note(NoteKind::LeftOut, k, fault.at, &fault.text),
        };
        let Some(block) = self.tables.blocks.get(&block) else {
            return self.leave_out(k, &format!("there is no block {block}"));
        };
        if block.is_linked {
            return self.leave_out(k, &format!("its block \"{}\" is in another file", shorten(&block.name)));
        }
        if depth == DEEPEST {
            return self.leave_out(k, &format!("blocks stand in blocks more than {DEEPEST} deep"));
        }
        let placement = placement.after(&own);
        for id in &block.objects {
            if self.placed >= MOST_PLACED || self.points >= MOST_POINTS {
                return self
                    .leave_out(k, &format!("over {MOST_PLACED} objects or {MOST_POINTS} control points are placed"));
            }
            self.placed += 1;
            match self.records.get(id) {
                Some(part) => self.draw(*part, &placement, Some(look), depth + 1),
                None => self.leave_out(k, &format!("its block \"{}\" has no object {id}", shorten(&block.name))),
            }
        }
    }

    fn add(&mut self, k: usize, body: Body, placement: &Placement, colour: Option<Colour>) {
        let body = match body.placed(placement) {
            Ok(body) => body,
            Err(cause) => return self.leave_out(k, &cause.to_string()),
        };
        self.points += body.size();
        let (first_surface, first_edge) = (self.surfaces.len(), self.next_edge);
        let own = &self.tables.records[k].attributes;
        let called = name(&own.name);
        let read = || self.tables.layer_path(own).and_then(|path| name(&path)).into_iter().collect();
        let layers = self.layers.entry(own.layer).or_insert_with(read).clone();
        for mut face in body.faces {
            let surface = body.kinds[face.surface];
            let attributes = Attributes { name: called.clone(), colour, layers: layers.clone(), surface };
            face.surface += first_surface;
            for trim in face.loops.iter_mut().flat_map(|boundary| &mut boundary.trims) {
                trim.edge = trim.edge.map(|edge| first_edge + edge);
                self.next_edge = self.next_edge.max(trim.edge.map_or(0, |edge| edge + 1));
            }
            self.faces.push((self.origins.len(), face));
            self.origins.push((k, attributes));
        }
        self.surfaces.extend(body.surfaces);
    }
}

/// What an object is drawn as.
fn body(record: &Record, tolerance: f64) -> Result<Body, Fault> {
    let object = &record.object;
    let body = match object.class {
        Class::Brep => brep::read(object, tolerance)?,
        Class::Extrusion => Extrusion::read(object)?.body(tolerance),
        Class::NurbsSurface | Class::PlaneSurface | Class::RevSurface | Class::SumSurface => {
            let surface = Sheet::read(object, tolerance)?.surface;
            let faces = vec![Face { tolerance, ..Face::whole(0) }];
            Body { surfaces: vec![surface], kinds: vec![object.surface_kind()], faces, remarks: vec![] }
        }
        _ => return Err(Fault { at: record.at, text: "this class is not drawn".into() }),
    };
    if body.faces.is_empty() && body.remarks.is_empty() {
        return Err(Fault { at: record.at, text: "it has no face".into() });
    }
    Ok(body)
}

/// The block that a reference names, and where it places it.
fn reference(data: &mut Cursor) -> Result<(Uuid, Placement), Fault> {
    data.packed_version(1)?;
    let block = data.uuid()?;
    let at = data.at();
    let mut rows = [[0.0; 4]; 4];
    for x in rows.as_flattened_mut() {
        *x = data.finite()?;
    }
    let column = |j: usize| DVec3::new(rows[0][j], rows[1][j], rows[2][j]);
    let matrix = DMat3::from_cols(column(0), column(1), column(2));
    let placement = Placement { matrix, offset: column(3) };
    if rows[3] != [0.0, 0.0, 0.0, 1.0] {
        return Err(Fault { at, text: "it is placed in perspective".into() });
    }
    if !matrix.determinant().is_finite() || matrix.determinant() == 0.0 {
        return Err(Fault { at, text: "it is placed flat: its matrix is singular".into() });
    }
    Ok((block, placement))
}

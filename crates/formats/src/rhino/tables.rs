//! The tables of an archive: settings, materials, layers, blocks, objects. What cannot be read of a table costs that entry.

use super::archive::{Cursor, Fault, Uuid, code};
use super::attributes::{Attributes, Look, colour_source, material_source};
use super::body::Remark;
use super::class::{Class, Object};
use super::material::Material;
use crate::document::{Colour, Unit};
use std::collections::HashMap;

/// Between the names of a layer's path.
const LAYER_SEPARATOR: &str = "::";

/// How many names of a layer's path are kept: a file may say that a layer is above itself.
const DEEPEST_LAYER: usize = 64;

/// What stands in the tables.
#[derive(Default)]
pub(super) struct Tables<'a> {
    pub unit: Option<Unit>,
    /// How far apart the modeller takes two points for one, in that unit; 0 where it is not said.
    pub tolerance: f64,
    materials: HashMap<i32, Colour>,
    pub layers: Vec<Layer>,
    pub blocks: HashMap<Uuid, Block>,
    pub records: Vec<Record<'a>>,
    /// What could not be read.
    pub remarks: Vec<Remark>,
}

/// A layer.
pub(super) struct Layer {
    index: i32,
    pub name: String,
    is_hidden: bool,
    colour: Colour,
    material: i32,
    id: Uuid,
    parent: Uuid,
}

/// A block: objects that are drawn where references place them.
pub(super) struct Block {
    pub name: String,
    pub objects: Vec<Uuid>,
    /// Whether the objects are in another file.
    pub is_linked: bool,
}

/// An entry of the table of objects.
pub(super) struct Record<'a> {
    /// The byte at which it begins.
    pub at: usize,
    pub object: Object<'a>,
    pub attributes: Attributes,
}

impl<'a> Tables<'a> {
    /// Reads all tables behind the head of an archive.
    pub fn read(mut archive: Cursor<'a>) -> Self {
        let mut tables = Self::default();
        while archive.left() > 0 {
            let part = match archive.open() {
                Ok(chunk) if chunk.code == code::END_OF_FILE => break,
                Ok(chunk) => chunk,
                Err(fault) => {
                    tables.remarks.push(Remark::left_out("the rest of the file", fault));
                    break;
                }
            };
            if part.is_cut {
                let text = "the file ends inside it".into();
                tables.remarks.push(Remark::left_out("a table", Fault { at: part.at, text }));
            }
            tables.table(part.code, part.content);
        }
        tables
    }

    fn table(&mut self, table: u32, mut content: Cursor<'a>) {
        let record = match table {
            code::SETTINGS_TABLE => code::UNITS_AND_TOLERANCES,
            code::MATERIAL_TABLE => code::MATERIAL_RECORD,
            code::LAYER_TABLE => code::LAYER_RECORD,
            code::INSTANCE_DEFINITION_TABLE => code::INSTANCE_DEFINITION_RECORD,
            code::OBJECT_TABLE => code::OBJECT_RECORD,
            _ => return,
        };
        let mut place = 0;
        while content.left() > 0 {
            let entry = match content.chunk() {
                Ok(chunk) if chunk.code == code::END_OF_TABLE => break,
                Ok(chunk) if chunk.code == record => chunk,
                Ok(_) => continue,
                Err(fault) => {
                    self.remarks.push(Remark::left_out("the rest of a table", fault));
                    break;
                }
            };
            let (what, read) = match record {
                code::UNITS_AND_TOLERANCES => ("the unit", self.units(entry.content)),
                code::MATERIAL_RECORD => {
                    let read = Material::read(entry.content, place);
                    place += 1;
                    ("a material", read.map(|own| _ = self.materials.insert(own.index, own.colour)))
                }
                code::LAYER_RECORD => ("a layer", layer(entry.content).map(|layer| self.layers.push(layer))),
                code::INSTANCE_DEFINITION_RECORD => {
                    ("a block", block(entry.content).map(|(id, block)| drop(self.blocks.insert(id, block))))
                }
                _ => ("an object", self.record(entry.at, entry.content)),
            };
            if let Err(fault) = read {
                self.remarks.push(Remark::left_out(what, fault));
            }
        }
    }

    fn units(&mut self, mut data: Cursor) -> Result<(), Fault> {
        let version = data.i32()?;
        let number = data.i32()?;
        let tolerance = data.f64()?;
        // Angle and relative tolerance; how lengths are shown.
        data.skip(2 * 8)?;
        let at = data.at();
        let known = UNITS.iter().find(|(n, ..)| *n == number);
        if known.is_none() && ![NO_UNIT, CUSTOM_UNIT].contains(&number) {
            self.remarks.push(Remark::healed(at, format!("there is no unit {number}: none is taken")));
        }
        self.unit = known.map(|(_, name, millimetres)| Unit { name: (*name).to_owned(), millimetres: *millimetres });
        if number == CUSTOM_UNIT && version >= 102 {
            data.skip(2 * 4)?;
            let millimetres = 1000.0 * data.finite()?;
            if millimetres > 0.0 {
                self.unit = Some(Unit { name: data.string()?.to_lowercase(), millimetres });
            } else {
                self.remarks.push(Remark::healed(at, format!("a unit of {millimetres} mm is none: none is taken")));
            }
        }
        if tolerance >= 0.0 && tolerance.is_finite() {
            self.tolerance = tolerance;
        } else {
            self.remarks.push(Remark::healed(at, format!("a tolerance of {tolerance} is none: none is taken")));
        }
        Ok(())
    }

    fn record(&mut self, at: usize, mut content: Cursor<'a>) -> Result<(), Fault> {
        let (mut object, mut attributes) = (None, None);
        while content.left() > 0 {
            match content.next_code() {
                Some(code::CLASS) if object.is_none() => object = Some(Object::read(&mut content)?),
                _ => {
                    let chunk = content.chunk()?;
                    if chunk.code == code::OBJECT_ATTRIBUTES {
                        attributes = Some(Attributes::read(chunk.content));
                    }
                }
            }
        }
        let Some(object) = object else { return Err(Fault { at, text: "its record holds no object".into() }) };
        let attributes = match attributes.unwrap_or_else(|| Ok(Attributes::default())) {
            Ok(attributes) => attributes,
            Err(fault) => {
                let text = format!("attributes: taken for those of a visible object, as {}", fault.text);
                self.remarks.push(Remark::healed(fault.at, text));
                Attributes::default()
            }
        };
        self.records.push(Record { at, object, attributes });
        Ok(())
    }

    /// The layer of an object.
    pub fn layer(&self, attributes: &Attributes) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.index == attributes.layer)
    }

    /// The path of an object's layer from the outermost one, as Rhino writes it; of one that is too deep, its end.
    pub fn layer_path(&self, attributes: &Attributes) -> Option<String> {
        let mut layer = self.layer(attributes)?;
        let mut path = layer.name.clone();
        for _ in 1..DEEPEST_LAYER {
            let is_parent = |other: &&Layer| !layer.parent.is_nil() && other.id == layer.parent;
            let Some(parent) = self.layers.iter().find(is_parent) else { break };
            layer = parent;
            path = format!("{}{LAYER_SEPARATOR}{path}", layer.name);
        }
        (!path.is_empty()).then_some(path)
    }

    /// How an object is drawn, `parent` being how the reference is that places it. No colour is that of no material.
    pub fn look(&self, attributes: &Attributes, parent: Option<Look>) -> Look {
        let layer = self.layer(attributes);
        // Outside of blocks there is no parent, and the layer says it.
        let material = match (attributes.material_source, parent) {
            (material_source::OBJECT, _) => Some(attributes.material),
            (material_source::PARENT, Some(parent)) => parent.material,
            _ => layer.map(|layer| layer.material),
        };
        let of_layer = || layer.map(|layer| layer.colour);
        let colour = match (attributes.colour_source, parent) {
            (colour_source::OBJECT, _) => attributes.colour,
            (colour_source::MATERIAL, _) => material.and_then(|index| self.materials.get(&index).copied()),
            (colour_source::PARENT, Some(parent)) => parent.colour.or_else(of_layer),
            (colour_source::LAYER | colour_source::PARENT, _) => of_layer(),
            _ => None,
        };
        Look { colour, material }
    }

    /// The layer that hides an object: its own, or one above that.
    pub fn hiding_layer(&self, attributes: &Attributes) -> Option<&Layer> {
        let mut layer = self.layer(attributes)?;
        // No layer is above itself; a file may say so.
        for _ in 0..self.layers.len() {
            if layer.is_hidden {
                return Some(layer);
            }
            layer = self.layers.iter().find(|other| other.id == layer.parent && !layer.parent.is_nil())?;
        }
        None
    }
}

fn layer(mut record: Cursor) -> Result<Layer, Fault> {
    let object = Object::read(&mut record)?;
    let mut data = object.data.clone();
    if object.class != Class::Layer {
        return data.fault(format!("{} stands where a layer should", object.kind()));
    }
    let minor = data.packed_version(1)?;
    let mode = data.i32()?;
    let index = data.i32()?;
    // An IGES level.
    data.skip(4)?;
    let material = data.i32()?;
    // An obsolete number.
    data.skip(4)?;
    let colour = data.colour()?;
    // An obsolete line style.
    data.skip(2 * 2 + 2 * 8)?;
    let mut layer =
        Layer { index, name: data.string()?, is_hidden: mode == 1, colour, material, id: Uuid::NIL, parent: Uuid::NIL };
    if minor >= 1 {
        layer.is_hidden |= data.u8()? == 0;
    }
    if minor >= 6 {
        // Line pattern, colour and weight on paper, whether it is locked.
        data.skip(4 + 4 + 8 + 1)?;
        (layer.id, layer.parent) = (data.uuid()?, data.uuid()?);
    }
    Ok(layer)
}

/// How a block is linked, as numbered in the file.
const LINKED: i32 = 3;

fn block(mut record: Cursor) -> Result<(Uuid, Block), Fault> {
    let object = Object::read(&mut record)?;
    let mut data = object.data.clone();
    if object.class != Class::InstanceDefinition {
        return data.fault(format!("{} stands where a block should", object.kind()));
    }
    if data.next_code() != Some(code::ANONYMOUS) {
        data.packed_version(1)?;
        let (id, objects, name) = (data.uuid()?, uuids(&mut data)?, data.string()?);
        // Description, address, and what it is called; a box.
        for _ in 0..3 {
            data.string()?;
        }
        data.skip(6 * 8)?;
        return Ok((id, Block { name, objects, is_linked: data.i32()? == LINKED }));
    }
    let mut data = data.content(code::ANONYMOUS)?;
    data.version(1)?;
    let mut common = data.content(code::MODEL_ATTRIBUTES)?;
    common.version(1)?;
    if common.u8()? != 0 {
        // A type.
        common.i32()?;
    }
    let id = if common.u8()? != 0 { common.uuid()? } else { Uuid::NIL };
    if common.u8()? != 0 {
        // A parent.
        common.uuid()?;
    }
    if common.u8()? != 0 {
        // An index.
        common.i32()?;
    }
    let name = if common.u8()? != 0 { common.string()? } else { String::new() };
    let is_linked = data.i32()? == LINKED;
    // The unit, in a chunk of its own.
    data.chunk()?;
    for _ in 0..3 {
        data.string()?;
    }
    data.skip(6 * 8)?;
    let objects = if data.u8()? != 0 { uuids(&mut data)? } else { vec![] };
    Ok((id, Block { name, objects, is_linked }))
}

fn uuids(cursor: &mut Cursor) -> Result<Vec<Uuid>, Fault> {
    (0..cursor.count(16)?).map(|_| cursor.uuid()).collect()
}

/// The number of no unit.
const NO_UNIT: i32 = 0;

/// The number of a unit that the file defines.
const CUSTOM_UNIT: i32 = 11;

/// Units by their number in the file (openNURBS, `ON::LengthUnitSystem`), and how many millimetres they are.
const UNITS: &[(i32, &str, f64)] = &[
    (1, "micrometre", 1e-3),
    (2, "millimetre", 1.0),
    (3, "centimetre", 10.0),
    (4, "metre", 1e3),
    (5, "kilometre", 1e6),
    (6, "microinch", 2.54e-5),
    (7, "mil", 0.0254),
    (8, "inch", 25.4),
    (9, "foot", 304.8),
    (10, "mile", 1_609_344.0),
    (12, "angstrom", 1e-7),
    (13, "nanometre", 1e-6),
    (14, "decimetre", 100.0),
    (15, "decametre", 1e4),
    (16, "hectometre", 1e5),
    (17, "megametre", 1e9),
    (18, "gigametre", 1e12),
    (19, "yard", 914.4),
    (20, "printer's point", 25.4 / 72.0),
    (21, "printer's pica", 25.4 / 6.0),
    (22, "nautical mile", 1_852_000.0),
    (23, "astronomical unit", 1.495_978_707e14),
    (24, "light year", 9.460_730_472_580_8e18),
    (25, "parsec", 3.085_677_581_491_37e19),
];

//! What a file shows, and where: faces and surfaces that are no part of others, solids and shells, and instances.

use super::entities::{Entity, Entry};
use super::fault::{Fault, fault};
use super::geometry::Geometry;
use super::sheet::SURFACES;
use super::value::Value;
use crate::brep::frame::Motion;
use crate::brep::gathered::TOO_MANY;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// How deep definitions may stand in each other.
const DEEPEST: usize = 64;

/// How many faces are shown at most, those that stand at several places counted at each, and how many entities are
/// entered: so many, and as many as the file has entities so many times.
const FACES: usize = 1 << 14;
const FACES_AN_ENTITY: usize = 4;

/// Types of faces that name a surface.
const FACED: [u16; 3] = [143, 144, 510];

/// Forms of associations (402) that are groups; others list other things.
const GROUPS: [i16; 4] = [1, 7, 14, 15];

/// Types of bodies that are not read: primitives and sweeps, trees and assemblies of solids.
const BODIES: [u16; 15] = [150, 152, 154, 156, 158, 160, 162, 164, 168, 180, 182, 184, 416, 420, 430];

/// A face, or a surface that stands by itself, at a place.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    pub number: u32,
    pub motion: Motion,
    /// Whether a shell takes it the other way round.
    pub reversed: bool,
    /// Which of the placed bodies it is in: faces share edges only within one.
    pub instance: usize,
    /// The solid or shell, else the group, else the definition that it is a part of.
    pub holder: Option<u32>,
}

/// What is shown of a file.
#[derive(Debug, Default)]
pub(super) struct Assembly {
    pub placed: Vec<Placed>,
    pub faults: Vec<Fault>,
    /// Entities that the file hides.
    pub hidden: Vec<u32>,
    /// Faces and surfaces that say they are parts of something, which nothing names.
    pub orphans: Vec<u32>,
    instances: usize,
}

struct Walk<'g, 'f, 'b> {
    geometry: &'g Geometry<'f, 'b>,
    assembly: Assembly,
    /// The definitions that are being entered.
    path: Vec<u32>,
    /// The group that each member is in.
    groups: BTreeMap<u32, u32>,
    /// The body that is being entered: a solid, else a shell.
    body: Option<u32>,
    entered: usize,
    most: usize,
    is_full: bool,
}

impl Assembly {
    pub fn new(geometry: &Geometry) -> Self {
        let entities = geometry.entities;
        let mut named = BTreeSet::new();
        let (mut groups, mut faults) = (BTreeMap::new(), vec![]);
        for entry in entities.entries() {
            match (parts(geometry, entry), entry.kind) {
                (Ok(parts), 402) => groups.extend(parts.into_iter().map(|part| (part, entry.number))),
                (Ok(parts), _) => named.extend(parts),
                // Of others that are shown their own reading tells.
                (Err(fault), 308 | 402) => faults.push(fault),
                (Err(_), _) => {}
            }
        }
        let most = FACES + FACES_AN_ENTITY * entities.entries().len();
        let mut walk = Walk {
            geometry,
            groups,
            assembly: Self { faults, ..Self::default() },
            path: vec![],
            body: None,
            entered: 0,
            most,
            is_full: false,
        };
        for entry in entities.entries() {
            if !is_shown(entry.kind) || named.contains(&entry.number) {
                continue;
            }
            let is_part = FACED.contains(&entry.kind) || SURFACES.contains(&entry.kind);
            if entry.is_dependent && is_part && !walk.groups.contains_key(&entry.number) && !entry.is_blanked {
                walk.assembly.orphans.push(entry.number);
            }
            walk.enter(entry.number, &Motion::IDENTITY, false, None);
        }
        walk.tell_of_circles(&named);
        walk.assembly
    }
}

/// Whether faces come of an entity of that type, or it is a body.
fn is_shown(kind: u16) -> bool {
    matches!(kind, 186 | 408 | 514) || FACED.contains(&kind) || SURFACES.contains(&kind) || BODIES.contains(&kind)
}

/// The faces, shells, surfaces, members and definitions that an entity is made of.
fn parts(geometry: &Geometry, entry: &Entry) -> Result<Vec<u32>, Fault> {
    let entity = match entry.kind {
        140 | 143 | 144 | 186 | 308 | 408 | 510 | 514 => geometry.get(entry.number)?,
        402 if GROUPS.contains(&entry.form) => geometry.get(entry.number)?,
        _ => return Ok(vec![]),
    };
    let own = entity.parameters();
    Ok(match entry.kind {
        140 => vec![own.pointer(5)?],
        143 => vec![own.pointer(2)?],
        144 | 408 | 510 => vec![own.pointer(1)?],
        186 => shells(&entity)?.into_iter().map(|(shell, _)| shell).collect(),
        308 => own.pointers(4, own.count(3, 1)?)?,
        402 => own.pointers(2, own.count(1, 1)?)?,
        _ => faces(&entity)?.into_iter().map(|(face, _)| face).collect(),
    })
}

/// The shells of a solid (186), each with whether it is taken as it stands.
fn shells(entity: &Entity) -> Result<Vec<(u32, bool)>, Fault> {
    let own = entity.parameters();
    let mut shells = vec![(own.pointer(1)?, own.flag(2)?)];
    for k in 0..own.count(3, 2)? {
        shells.push((own.pointer(4 + 2 * k)?, own.flag(5 + 2 * k)?));
    }
    Ok(shells)
}

/// The faces of a shell (514), each with whether it is taken as it stands.
fn faces(entity: &Entity) -> Result<Vec<(u32, bool)>, Fault> {
    let own = entity.parameters();
    (0..own.count(1, 2)?).map(|k| Ok((own.pointer(2 + 2 * k)?, own.flag(3 + 2 * k)?))).collect()
}

impl Walk<'_, '_, '_> {
    fn fail(&mut self, fault: Fault) {
        self.assembly.faults.push(fault);
    }

    /// Tells of what only parts of itself name: nothing leads to it, so that it would be left out in silence.
    fn tell_of_circles(&mut self, named: &BTreeSet<u32>) {
        let entities = self.geometry.entities;
        let mut reached: BTreeSet<u32> = BTreeSet::new();
        let numbers = entities.entries().iter().map(|entry| entry.number);
        let mut next: Vec<u32> = numbers.filter(|number| !named.contains(number)).collect();
        while let Some(number) = next.pop() {
            if reached.insert(number) {
                let parts = entities.entry(number).and_then(|entry| parts(self.geometry, entry).ok());
                next.extend(parts.unwrap_or_default());
            }
        }
        for entry in entities.entries().iter().filter(|entry| is_shown(entry.kind) && !reached.contains(&entry.number))
        {
            self.fail(fault(entry.number, "it is a part of itself, or of what is"));
        }
    }

    /// Enters an entity whose coordinates become the model's by `motion`; within `instance` where that is one.
    fn enter(&mut self, number: u32, motion: &Motion, reversed: bool, instance: Option<usize>) {
        self.entered += 1;
        if self.most < self.entered {
            if !self.is_full {
                self.is_full = true;
                self.fail(fault(number, TOO_MANY));
            }
            return;
        }
        let Some(entry) = self.geometry.entities.entry(number).copied() else {
            return self.fail(fault(number, "there is no directory entry of this number"));
        };
        if entry.is_blanked {
            return self.assembly.hidden.push(number);
        }
        let instance = instance.unwrap_or(self.assembly.instances);
        self.assembly.instances = self.assembly.instances.max(instance + 1);
        match entry.kind {
            186 | 514 => {
                let outer = self.body;
                self.body = outer.or(Some(number));
                if let Err(fault) = self.body(&entry, motion, reversed, instance) {
                    self.fail(fault);
                }
                self.body = outer;
            }
            408 => {
                if let Err(fault) = self.subfigure(&entry, motion) {
                    self.fail(fault);
                }
            }
            402 => {
                let parts = parts(self.geometry, &entry);
                match parts {
                    Ok(parts) => parts.into_iter().for_each(|part| self.enter(part, motion, reversed, None)),
                    Err(fault) => self.fail(fault),
                }
            }
            kind if FACED.contains(&kind) || SURFACES.contains(&kind) => {
                let group = self.groups.get(&number).copied();
                let holder = self.body.or(group).or(self.path.last().copied());
                self.assembly.placed.push(Placed { number, motion: *motion, reversed, instance, holder });
            }
            kind if BODIES.contains(&kind) => self.fail(fault(number, "bodies of this type are not read")),
            // Curves, points, texts and properties say nothing of faces.
            _ => {}
        }
    }

    /// A solid or a shell, with its own matrix.
    fn body(&mut self, entry: &Entry, motion: &Motion, reversed: bool, instance: usize) -> Result<(), Fault> {
        let entity = self.geometry.get(entry.number)?;
        let motion = motion.after(&self.geometry.motion(entry.matrix)?);
        let parts = if entry.kind == 186 { shells(&entity)? } else { faces(&entity)? };
        for (part, runs_with) in parts {
            let expected: &[u16] = if entry.kind == 186 { &[514] } else { &[510] };
            let kind = self.geometry.entities.entry(part).map(|entry| entry.kind);
            match kind.filter(|kind| !expected.contains(kind)) {
                Some(kind) => self.fail(fault(part, format!("it is of type {kind}, where {} is needed", expected[0]))),
                None => self.enter(part, &motion, reversed == runs_with, Some(instance)),
            }
        }
        Ok(())
    }

    /// An instance (408) of a definition (308): moved by the definition's matrix, scaled, moved by its own matrix, and then by what
    /// it says itself, which no matrix turns (IGES 5.3, 3.6.2).
    fn subfigure(&mut self, entry: &Entry, motion: &Motion) -> Result<(), Fault> {
        let entity = self.geometry.get(entry.number)?;
        let own = entity.parameters();
        let definition = own.pointer(1)?;
        let origin = DVec3::from_slice(&own.numbers(2, 3)?);
        let scale = match own.values.get(5) {
            Some(Value::Number(scale)) => *scale,
            Some(Value::Absent) | None => 1.0,
            Some(_) => 0.0,
        };
        if !(0.0 < scale && scale.is_finite()) {
            return Err(fault(entry.number, "its scale is no number above 0"));
        }
        if self.path.contains(&definition) {
            return Err(fault(definition, "it stands in itself"));
        }
        if DEEPEST <= self.path.len() {
            return Err(fault(definition, "definitions stand in each other too deep"));
        }
        let inner = self.geometry.get_of(definition, 308, "a definition")?;
        let own = inner.parameters();
        let members = own.pointers(4, own.count(3, 1)?)?;
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let moved = motion.after(&Motion::new(axes, origin));
        let turned = moved.after(&self.geometry.motion(entry.matrix)?);
        let scaled = turned.after(&Motion::new(axes.map(|axis| axis * scale), DVec3::ZERO));
        let motion = scaled.after(&self.geometry.motion(inner.entry.matrix)?);
        self.path.push(definition);
        for member in members {
            self.enter(member, &motion, false, None);
        }
        self.path.pop();
        Ok(())
    }
}

//! What a file shows, and where: its representations, placed in each other as the product structure says.
//!
//! A representation holds items in coordinates of its own. It stands in another one by a relationship with a
//! transformation, by a MAPPED_ITEM, or, without a transformation, as the same thing. Those that stand in no other are
//! the roots, and from each of them all is reached that is drawn.

use super::fault::{Fault, fault};
use super::geometry::Geometry;
use super::p21::Instances;
use super::units::Units;
use crate::brep::frame::{Frame, Motion};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};

/// How deep representations may stand in each other.
const DEEPEST: usize = 64;

/// How many faces are shown at most, those that stand at several places counted at each, and how many representations are
/// entered: so many, and one more for so many bytes of the file. Each level of an assembly may double what a few bytes show.
const FACES: usize = 1 << 14;
const BYTES_A_FACE: usize = 64;

/// Keywords of representations of shapes.
pub(super) const REPRESENTATIONS: [&str; 10] = [
    "SHAPE_REPRESENTATION",
    "ADVANCED_BREP_SHAPE_REPRESENTATION",
    "FACETED_BREP_SHAPE_REPRESENTATION",
    "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
    "GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION",
    "NON_MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
    "ELEMENTARY_BREP_SHAPE_REPRESENTATION",
    "TESSELLATED_SHAPE_REPRESENTATION",
    "SHAPE_REPRESENTATION_WITH_PARAMETERS",
    "REPRESENTATION",
];

/// Keywords of what places representations in each other.
pub(super) const RELATIONS: [&str; 5] = [
    "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION",
    "SHAPE_REPRESENTATION_RELATIONSHIP",
    "REPRESENTATION_RELATIONSHIP",
    "SHAPE_DEFINITION_REPRESENTATION",
    "REPRESENTATION_MAP",
];

/// A face, or a surface that stands by itself, at a place.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    pub number: u64,
    pub motion: Motion,
    /// Whether a shell takes it the other way round.
    pub reversed: bool,
    /// The representation's context, for its units.
    pub context: Option<u64>,
    /// Which of the placed representations it is in: faces share edges only within one.
    pub instance: usize,
}

/// What is shown of a file.
#[derive(Debug, Default)]
pub(super) struct Assembly {
    pub placed: Vec<Placed>,
    /// The unit of the coordinates of the whole: the first root's.
    pub context: Option<u64>,
    pub faults: Vec<Fault>,
    instances: usize,
}

/// How a representation stands in another.
#[derive(Debug, Clone)]
struct Child {
    representation: u64,
    motion: Motion,
}

struct Walk<'f, 'b> {
    instances: &'f Instances<'b>,
    children: BTreeMap<u64, Vec<Child>>,
    contexts: BTreeMap<Option<u64>, Units>,
    assembly: Assembly,
    /// The representations that are being entered.
    path: Vec<u64>,
    entered: usize,
    /// The most faces, and representations entered.
    most: usize,
    /// Whether it was said that there are more.
    is_full: bool,
}

impl Assembly {
    /// Follows the product structure; `of` lists the instances of each keyword of [`REPRESENTATIONS`] and [`RELATIONS`].
    pub fn new(instances: &Instances, of: &BTreeMap<&'static str, Vec<u64>>) -> Self {
        let mut faults = vec![];
        let (children, inner) = relations(instances, of, &mut faults);
        let assembly = Self { faults, ..Self::default() };
        let most = FACES + instances.bytes() / BYTES_A_FACE;
        let mut walk = Walk {
            instances,
            children,
            contexts: BTreeMap::new(),
            assembly,
            path: vec![],
            entered: 0,
            most,
            is_full: false,
        };
        let mut all: BTreeSet<u64> = REPRESENTATIONS.iter().flat_map(|keyword| of[keyword].iter().copied()).collect();
        all.retain(|number| !inner.contains(number));
        for root in all {
            walk.enter(root, &Motion::IDENTITY, None);
        }
        walk.assembly
    }
}

/// The representations that stand in each, and all that stand in any.
fn relations(
    instances: &Instances,
    of: &BTreeMap<&'static str, Vec<u64>>,
    faults: &mut Vec<Fault>,
) -> (BTreeMap<u64, Vec<Child>>, BTreeSet<u64>) {
    let (mut children, mut inner): (BTreeMap<u64, Vec<Child>>, BTreeSet<u64>) = Default::default();
    let mut add = |parent: u64, representation: u64, motion: Motion| {
        children.entry(parent).or_default().push(Child { representation, motion });
        inner.insert(representation);
    };
    let mapped = |map: &u64| instances.get(*map)?.parameters().reference(1).ok();
    let mapped: Vec<u64> = of["REPRESENTATION_MAP"].iter().filter_map(mapped).collect();
    // The product definition that a representation shows.
    let mut shown: BTreeMap<u64, u64> = BTreeMap::new();
    for number in &of["SHAPE_DEFINITION_REPRESENTATION"] {
        let pair = instances.get(*number).and_then(|entity| {
            let own = entity.parameters();
            let definition = instances.get(own.reference(0).ok()?)?;
            Some((own.reference(1).ok()?, definition.parameters().reference(2).ok()?))
        });
        shown.extend(pair);
    }
    let mut placed: BTreeSet<u64> = BTreeSet::new();
    for number in &of["CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"] {
        let Some(entity) = instances.get(*number) else { continue };
        let own = entity.parameters();
        let (Ok(relation), Ok(shape)) = (own.reference(0), own.reference(1)) else { continue };
        placed.insert(relation);
        match related(instances, relation) {
            Ok((mut child, mut parent, motion)) => {
                let mut motion = motion;
                // The usage says which of the two is the part, whatever their order.
                let usage = instances.get(shape).and_then(|shape| {
                    let usage = instances.get(shape.parameters().reference(2).ok()?)?;
                    let own = usage.parameters();
                    Some((own.reference(3).ok()?, own.reference(4).ok()?))
                });
                if let Some((whole, part)) = usage
                    && shown.get(&child) == Some(&whole)
                    && shown.get(&parent) == Some(&part)
                {
                    (child, parent, motion) = (parent, child, motion.inverse());
                }
                add(parent, child, motion);
            }
            Err(fault) => faults.push(fault),
        }
    }
    let relations = of["SHAPE_REPRESENTATION_RELATIONSHIP"].iter().chain(&of["REPRESENTATION_RELATIONSHIP"]);
    for number in relations.copied().collect::<BTreeSet<u64>>() {
        if placed.contains(&number) {
            continue;
        }
        match related(instances, number) {
            // The shape of a product, and the bodies of the same.
            Ok((first, second, motion)) => {
                let is_body = |number: u64| instances.keyword(number) != "SHAPE_REPRESENTATION";
                if is_body(first) && !is_body(second) {
                    add(second, first, motion);
                } else {
                    add(first, second, motion.inverse());
                }
            }
            Err(fault) => faults.push(fault),
        }
    }
    inner.extend(mapped);
    (children, inner)
}

/// The two representations of a relationship, and the move from the first one's coordinates to the second's.
fn related(instances: &Instances, number: u64) -> Result<(u64, u64, Motion), Fault> {
    let work = Cell::new(usize::MAX);
    let geometry = Geometry { instances, angle: 1.0, tolerance: 0.0, work: &work };
    let entity = geometry.get(number)?;
    let own = match entity.part("REPRESENTATION_RELATIONSHIP") {
        Some(part) => part,
        None => entity.parameters(),
    };
    let (first, second) = (own.reference(2)?, own.reference(3)?);
    let Some(part) = entity.part("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") else {
        return Ok((first, second, Motion::IDENTITY));
    };
    let transformation = geometry.get(part.reference(0)?)?;
    if transformation.keyword() != "ITEM_DEFINED_TRANSFORMATION" {
        return Ok((first, second, geometry.motion(transformation.number)?));
    }
    let own = transformation.parameters();
    let frame = |at: usize| -> Result<Frame, Fault> { geometry.placement(own.reference(at)?) };
    Ok((first, second, Motion::between(&frame(2)?, &frame(3)?)))
}

impl Walk<'_, '_> {
    fn fail(&mut self, number: u64, why: &str) {
        self.assembly.faults.push(fault(number, why));
    }

    fn units(&mut self, context: Option<u64>) -> &Units {
        self.contexts.entry(context).or_insert_with(|| Units::of_context(self.instances, context))
    }

    /// Enters a representation whose coordinates become the whole's by `motion`; `parent` is the context it stands in.
    fn enter(&mut self, number: u64, motion: &Motion, parent: Option<u64>) {
        self.entered += 1;
        if self.path.contains(&number) {
            return self.fail(number, "it stands in itself");
        }
        if DEEPEST <= self.path.len() || self.most < self.entered {
            if !self.is_full {
                self.is_full = true;
                self.fail(number, "too many representations stand in each other");
            }
            return;
        }
        let Some(entity) = self.instances.get(number) else {
            return self.fail(number, "it is not in the file, or its text makes no sense");
        };
        let own = match entity.part("REPRESENTATION") {
            Some(part) if entity.parts.len() > 1 => part,
            _ => entity.parameters(),
        };
        let (items, context) = (own.references(1).unwrap_or_default(), own.optional_reference(2));
        if self.assembly.context.is_none() {
            self.assembly.context = context;
        }
        // Lengths of a part in another unit than the whole's.
        let outer = parent.or(self.assembly.context);
        let millimetres = |units: &Units| units.length.as_ref().map(|unit| unit.millimetres);
        let (whole, part) = (millimetres(self.units(outer)), millimetres(self.units(context)));
        let ratio = whole.zip(part).map_or(1.0, |(whole, part)| part / whole);
        let scaled = if ratio == 1.0 { *motion } else { motion.after(&Motion::scale(ratio)) };
        self.path.push(number);
        let instance = self.assembly.instances;
        self.assembly.instances += 1;
        for item in items {
            self.item(item, &scaled, context, instance);
        }
        for Child { representation, motion: inner } in self.children.get(&number).cloned().unwrap_or_default() {
            self.enter(representation, &scaled.after(&inner), context);
        }
        self.path.pop();
    }

    fn item(&mut self, number: u64, motion: &Motion, context: Option<u64>, instance: usize) {
        let Some(entity) = self.instances.get(number) else {
            return self.fail(number, "it is not in the file, or its text makes no sense");
        };
        let own = entity.parameters();
        match entity.keyword() {
            "MANIFOLD_SOLID_BREP" | "FACETED_BREP" => {
                self.shells(own.reference(1).into_iter(), motion, context, instance)
            }
            "BREP_WITH_VOIDS" => {
                let shells = own.reference(1).into_iter().chain(own.references(2).unwrap_or_default());
                self.shells(shells, motion, context, instance);
            }
            "SHELL_BASED_SURFACE_MODEL" | "FACE_BASED_SURFACE_MODEL" => {
                self.shells(own.references(1).unwrap_or_default().into_iter(), motion, context, instance);
            }
            "CLOSED_SHELL" | "OPEN_SHELL" | "CONNECTED_FACE_SET" | "ORIENTED_CLOSED_SHELL" | "ORIENTED_OPEN_SHELL" => {
                self.shells(std::iter::once(number), motion, context, instance);
            }
            "GEOMETRIC_SET" => {
                for element in own.references(1).unwrap_or_default() {
                    let keyword = self.instances.keyword(element);
                    if keyword.is_empty()
                        || keyword.ends_with("_SURFACE")
                        || keyword.contains("SURFACE_")
                        || keyword == "PLANE"
                    {
                        self.place(element, motion, false, context, instance);
                    }
                }
            }
            "ADVANCED_FACE" | "FACE_SURFACE" => self.place(number, motion, false, context, instance),
            "MAPPED_ITEM" => self.mapped(number, motion, context),
            "AXIS2_PLACEMENT_3D" | "GEOMETRIC_CURVE_SET" | "CARTESIAN_POINT" => {}
            keyword if keyword.contains("TESSELLATED") => self.fail(number, "tessellated bodies are not read"),
            keyword if keyword.ends_with("_BREP") || keyword.ends_with("_SOLID") || keyword.ends_with("_MODEL") => {
                self.fail(number, "bodies of this kind are not read");
            }
            _ => {}
        }
    }

    fn mapped(&mut self, number: u64, motion: &Motion, context: Option<u64>) {
        let work = Cell::new(usize::MAX);
        let geometry = Geometry { instances: self.instances, angle: 1.0, tolerance: 0.0, work: &work };
        let target = || -> Result<(u64, Motion), Fault> {
            let item = geometry.get(number)?;
            let own = item.parameters();
            let map = geometry.get(own.reference(1)?)?;
            let own_map = map.parameters();
            let (from, to) = (geometry.motion(own_map.reference(0)?)?, geometry.motion(own.reference(2)?)?);
            Ok((own_map.reference(1)?, to.after(&from.inverse())))
        };
        match target() {
            Ok((representation, inner)) => self.enter(representation, &motion.after(&inner), context),
            Err(fault) => self.assembly.faults.push(fault),
        }
    }

    fn shells(&mut self, shells: impl Iterator<Item = u64>, motion: &Motion, context: Option<u64>, instance: usize) {
        for shell in shells {
            let (mut number, mut reversed) = (shell, false);
            let mut entity = self.instances.get(number);
            if let Some(oriented) = entity.as_ref().filter(|e| e.keyword().starts_with("ORIENTED_")) {
                let own = oriented.parameters();
                let (Ok(inner), Ok(same)) = (own.reference(2), own.flag(3)) else {
                    self.fail(shell, "it names no shell");
                    continue;
                };
                (number, reversed) = (inner, !same);
                entity = self.instances.get(number);
            }
            let faces = entity.as_ref().and_then(|e| e.parameters().references(1).ok());
            let Some(faces) = faces else {
                self.fail(number, "it names no faces");
                continue;
            };
            for face in faces {
                self.place(face, motion, reversed, context, instance);
            }
        }
    }

    fn place(&mut self, number: u64, motion: &Motion, reversed: bool, context: Option<u64>, instance: usize) {
        if self.assembly.placed.len() < self.most {
            self.assembly.placed.push(Placed { number, motion: *motion, reversed, context, instance });
        } else if !self.is_full {
            self.is_full = true;
            self.fail(number, TOO_MANY);
        }
    }
}

const TOO_MANY: &str = "it and all faces after it are more than are shown";

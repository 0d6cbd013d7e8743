//! How the representations of a file stand in each other, and which product each shows.
//!
//! A representation stands in another one by a relationship with a transformation, by a MAPPED_ITEM, or, without a
//! transformation, as the same thing.

use super::fault::{Fault, fault};
use super::geometry::Geometry;
use super::p21::{Instances, MISSING};
use super::value::Entity;
use crate::brep::effort::Effort;
use crate::brep::frame::{Frame, Motion};
use crate::brep::off::Off;
use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

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

/// How a representation stands in another.
#[derive(Debug, Clone)]
pub(super) struct Child {
    pub representation: u64,
    pub motion: Motion,
    /// What says so: the relationship, and in an assembly what depends on it, the use's shape and the use.
    pub uses: Vec<u64>,
}

/// The product structure of a file.
#[derive(Debug, Default)]
pub(super) struct Structure {
    /// The representations that stand in each.
    pub children: BTreeMap<u64, Vec<Child>>,
    /// All that stand in any.
    pub inner: BTreeSet<u64>,
    /// The product definition that a representation shows.
    shown: BTreeMap<u64, u64>,
}

impl Structure {
    /// Follows the relations of a file; `of` lists the instances of each keyword of [`RELATIONS`]. `faults` tell what is lost,
    /// `healed` what is taken otherwise than it stands.
    pub fn new(
        instances: &Instances,
        of: &BTreeMap<&'static str, Vec<u64>>,
        faults: &mut Vec<Fault>,
        healed: &mut Vec<Fault>,
    ) -> Self {
        relations(instances, of, faults, healed)
    }

    /// The name of the product that a representation shows.
    pub fn product(&self, instances: &Instances, representation: u64) -> Option<Arc<str>> {
        let definition = instances.get(*self.shown.get(&representation)?)?;
        let formation = instances.get(definition.parameters().reference(2).ok()?)?;
        let product = instances.get(formation.parameters().reference(2).ok()?)?;
        let own = product.parameters();
        own.name(1).or_else(|| own.name(0))
    }
}

fn relations(
    instances: &Instances,
    of: &BTreeMap<&'static str, Vec<u64>>,
    faults: &mut Vec<Fault>,
    healed: &mut Vec<Fault>,
) -> Structure {
    let (mut children, mut inner): (BTreeMap<u64, Vec<Child>>, BTreeSet<u64>) = Default::default();
    let mut add = |parent: u64, representation: u64, motion: Motion, uses: Vec<u64>| {
        children.entry(parent).or_default().push(Child { representation, motion, uses });
        inner.insert(representation);
    };
    let mapped = |map: &u64| instances.get(*map)?.parameters().reference(1).ok();
    let mapped: Vec<u64> = of["REPRESENTATION_MAP"].iter().filter_map(mapped).collect();
    let mut shown: BTreeMap<u64, u64> = BTreeMap::new();
    for number in &of["SHAPE_DEFINITION_REPRESENTATION"] {
        let pair = || -> Result<(u64, Option<u64>), Fault> {
            let entity = get(instances, *number)?;
            let own = entity.parameters();
            let definition = get(instances, own.reference(0)?)?;
            // What it is the shape of may be no product: a property, or a part of one.
            Ok((own.reference(1)?, definition.parameters().reference(2).ok()))
        };
        match pair() {
            Ok((representation, definition)) => shown.extend(definition.map(|definition| (representation, definition))),
            Err(fault) => faults.push(fault),
        }
    }
    let mut placed: BTreeSet<u64> = BTreeSet::new();
    for number in &of["CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"] {
        let pair = || -> Result<(u64, u64), Fault> {
            let entity = get(instances, *number)?;
            Ok((entity.parameters().reference(0)?, entity.parameters().reference(1)?))
        };
        let (relation, shape) = match pair() {
            Ok(pair) => pair,
            Err(fault) => {
                faults.push(fault);
                continue;
            }
        };
        placed.insert(relation);
        match related(instances, relation) {
            Ok((mut child, mut parent, motion)) => {
                let mut motion = motion;
                let usage = instances.get(shape).and_then(|shape| shape.parameters().reference(2).ok());
                // The usage says which of the two is the part, whatever their order.
                let ends = usage.and_then(|usage| {
                    let usage = instances.get(usage)?;
                    let own = usage.parameters();
                    Some((own.reference(3).ok()?, own.reference(4).ok()?))
                });
                if ends.is_none() {
                    healed.push(fault(
                        *number,
                        "it names no use that says which of the two is the part: the first is taken",
                    ));
                }
                if let Some((whole, part)) = ends
                    && shown.get(&child) == Some(&whole)
                    && shown.get(&parent) == Some(&part)
                {
                    (child, parent, motion) = (parent, child, motion.inverse());
                }
                add(parent, child, motion, [relation, *number, shape].into_iter().chain(usage).collect());
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
                    add(second, first, motion, vec![number]);
                } else {
                    add(first, second, motion.inverse(), vec![number]);
                }
            }
            Err(fault) => faults.push(fault),
        }
    }
    inner.extend(mapped);
    Structure { children, inner, shown }
}

fn get<'b>(instances: &Instances<'b>, number: u64) -> Result<Entity<'b>, Fault> {
    instances.get(number).ok_or_else(|| fault(number, MISSING))
}

/// The two representations of a relationship, and the move from the first one's coordinates to the second's.
fn related(instances: &Instances, number: u64) -> Result<(u64, u64, Motion), Fault> {
    let (work, off) = (Cell::new(usize::MAX), Cell::new(Off::default()));
    let (effort, turned) = (Effort::new(0), RefCell::default());
    let geometry =
        Geometry { instances, angle: 1.0, tolerance: 0.0, off: &off, work: &work, effort: &effort, turned: &turned };
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
    let frame = |at: usize| -> Result<Frame, Fault> { geometry.place(own.reference(at)?) };
    Ok((first, second, Motion::between(&frame(2)?, &frame(3)?)))
}

//! What a file shows, and where: its representations, placed in each other as the product structure says ([`Structure`]).
//!
//! A representation holds items in coordinates of its own. Those that stand in no other are the roots, and from each of
//! them all is reached that is drawn. Name, colour, layers and visibility are those of the innermost part that says them: a
//! face, its shell, its body, its product.

use super::fault::{Fault, fault};
use super::geometry::Geometry;
use super::layers::{LAYER, layers};
use super::p21::{Instances, MISSING};
use super::said::Said;
use super::structure::{Child, REPRESENTATIONS, Structure};
use super::styles::Styles;
use super::units::Units;
use super::value::Entity;
use crate::brep::effort::Effort;
use crate::brep::frame::Motion;
use crate::brep::gathered::TOO_MANY;
use crate::brep::off::Off;
use crate::document::{Attributes, Colour, Layers};
use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// How deep representations may stand in each other.
const DEEPEST: usize = 64;

/// How many faces are shown at most, those that stand at several places counted at each, and how many representations are
/// entered: so many, and one more for so many bytes of the file. Each level of an assembly may double what a few bytes show.
const FACES: usize = 1 << 14;
const BYTES_A_FACE: usize = 64;

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
    /// Its name, colour and layers.
    pub attributes: Attributes,
}

/// What is shown of a file.
#[derive(Debug, Default)]
pub(super) struct Assembly {
    pub placed: Vec<Placed>,
    /// The unit of the coordinates of the whole: the first root's.
    pub context: Option<u64>,
    /// How many faces no representation shows, and the first of them; they are placed where they stand.
    pub lost: Option<(usize, u64)>,
    pub faults: Vec<Fault>,
    /// What is drawn otherwise than it stands in the file.
    pub healed: Vec<Fault>,
    instances: usize,
    /// The representations that were entered.
    reached: BTreeSet<u64>,
    /// Faces that are invisible.
    hidden: BTreeSet<u64>,
}

/// What is said of the part of the file that is being walked.
#[derive(Debug, Clone, Default)]
struct Owner {
    attributes: Attributes,
    is_hidden: bool,
    /// Colours that parts of it have whatever is said of them, the outermost first.
    over: Vec<(u64, Colour)>,
}

struct Walk<'f, 'b> {
    instances: &'f Instances<'b>,
    structure: Structure,
    styles: Styles,
    layers: Said<Layers>,
    owner: Owner,
    /// The labels of items, and the products of representations, each read once: a file may place one in many places.
    labels: BTreeMap<u64, Option<Arc<str>>>,
    contexts: BTreeMap<Option<u64>, Units>,
    assembly: Assembly,
    /// The representations that are being entered.
    path: Vec<u64>,
    /// All instances that are being walked.
    inside: Vec<u64>,
    entered: usize,
    /// The most faces, and representations entered.
    most: usize,
    /// Whether it was said that there are more.
    is_full: bool,
}

impl Assembly {
    /// Follows the product structure; `of` lists the instances of each keyword of [`REPRESENTATIONS`], of
    /// [`RELATIONS`](super::structure::RELATIONS) and [`STYLES`](super::styles::STYLES), and of ADVANCED_FACE.
    pub fn new(instances: &Instances, of: &BTreeMap<&'static str, Vec<u64>>) -> Self {
        let (mut faults, mut healed) = (vec![], vec![]);
        let structure = Structure::new(instances, of, &mut faults, &mut healed);
        let layers = layers(instances, &of[LAYER], &mut faults);
        let styles = Styles::new(instances, of, &mut faults, &mut healed);
        let assembly = Self { faults, healed, ..Self::default() };
        let most = FACES + instances.bytes() / BYTES_A_FACE;
        let mut walk = Walk {
            instances,
            structure,
            styles,
            layers,
            owner: Owner::default(),
            labels: BTreeMap::new(),
            contexts: BTreeMap::new(),
            assembly,
            path: vec![],
            inside: vec![],
            entered: 0,
            most,
            is_full: false,
        };
        let all: BTreeSet<u64> = REPRESENTATIONS.iter().flat_map(|keyword| of[keyword].iter().copied()).collect();
        let (inner, roots): (Vec<u64>, Vec<u64>) =
            all.into_iter().partition(|number| walk.structure.inner.contains(number));
        for root in roots {
            walk.enter(root, &[], &Motion::IDENTITY, None);
        }
        // Representations that name only each other, or that a map names and no item.
        let mut alone: Vec<u64> = vec![];
        for number in inner {
            let before = walk.assembly.placed.len();
            if !(walk.assembly.reached.contains(&number) || walk.is_full) {
                walk.enter(number, &[], &Motion::IDENTITY, None);
            }
            if before < walk.assembly.placed.len() {
                alone.push(number);
            }
        }
        if let Some(first) = alone.first() {
            let why = format!(
                "{} representations, this one the first, stand in none that is shown: they are drawn where they stand",
                alone.len()
            );
            walk.assembly.healed.push(fault(*first, why));
        }
        let reached: BTreeSet<u64> = walk.assembly.placed.iter().map(|placed| placed.number).collect();
        let is_lost = |number: &u64| !reached.contains(number) && !walk.assembly.hidden.contains(number);
        let lost: Vec<u64> = of["ADVANCED_FACE"].iter().copied().filter(is_lost).collect();
        walk.assembly.lost = lost.first().map(|first| (lost.len(), *first));
        for number in lost {
            walk.place(number, &Motion::IDENTITY, false, walk.assembly.context, usize::MAX);
        }
        walk.assembly
    }
}

/// Whether an item is a surface, by any of its parts.
fn is_surface(entity: &Entity) -> bool {
    entity.parts.iter().any(|(keyword, _)| {
        *keyword == "PLANE"
            || keyword.ends_with("_SURFACE")
            || (keyword.contains("SURFACE_") && !keyword.ends_with("_CURVE") && !keyword.contains("_ON_SURFACE"))
    })
}

impl Walk<'_, '_> {
    fn fail(&mut self, number: u64, why: &str) {
        self.assembly.faults.push(fault(number, why));
    }

    /// What was read; where it could not be, that is told.
    fn heard<T>(&mut self, read: Result<T, Fault>) -> Option<T> {
        read.map_err(|fault| self.assembly.faults.push(fault)).ok()
    }

    /// Walks what an instance is made of: name, colour, layers and visibility are its own where a part says nothing else.
    fn within(&mut self, number: u64, name: Option<Arc<str>>, walk: impl FnOnce(&mut Self)) {
        let outer = self.owner.clone();
        self.inside.push(number);
        self.owner.attributes.name = name.or_else(|| outer.attributes.name.clone());
        let over = outer.over.iter().find(|(item, _)| *item == number).map(|(_, colour)| *colour);
        let colour = over.or_else(|| self.styles.colour(number, &self.inside));
        self.owner.attributes.colour = colour.or(outer.attributes.colour);
        self.owner.over.extend(self.styles.over(number));
        if let Some(layers) = self.layers.get(number, &self.inside) {
            self.owner.attributes.layers = layers.clone();
        }
        let hidden_by = self.styles.hidden_by(number, &self.inside).filter(|_| !outer.is_hidden).map(str::to_owned);
        self.owner.is_hidden |= hidden_by.is_some();
        let before = self.assembly.hidden.len();
        walk(self);
        self.inside.pop();
        // What draws nothing anyhow, a curve or a point, is no loss.
        if let Some(why) = hidden_by.filter(|_| before < self.assembly.hidden.len()) {
            self.fail(number, &why);
        }
        self.owner = outer;
    }

    /// The label of an item.
    fn label(&mut self, number: u64) -> Option<Arc<str>> {
        let read = || self.instances.get(number)?.parameters().name(0);
        self.labels.entry(number).or_insert_with(read).clone()
    }

    fn units(&mut self, context: Option<u64>) -> &Units {
        self.contexts.entry(context).or_insert_with(|| Units::of_context(self.instances, context))
    }

    /// Enters a representation by way of its `uses`, which say that it stands there. Its coordinates become the whole's by
    /// `motion`; `parent` is the context it stands in.
    fn enter(&mut self, number: u64, uses: &[u64], motion: &Motion, parent: Option<u64>) {
        if let [first, rest @ ..] = uses {
            return self.within(*first, None, |walk| walk.enter(number, rest, motion, parent));
        }
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
            return self.fail(number, MISSING);
        };
        let own = match entity.part("REPRESENTATION") {
            Some(part) if entity.parts.len() > 1 => part,
            _ => entity.parameters(),
        };
        self.assembly.reached.insert(number);
        let items = self.heard(own.references(1)).unwrap_or_default();
        let context = self.heard(own.optional_reference(2)).flatten();
        if context.is_none() && !items.is_empty() {
            self.assembly.healed.push(fault(number, "it names no context: no unit is taken"));
        }
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
        let read = || self.structure.product(self.instances, number);
        let product = self.labels.entry(number).or_insert_with(read).clone();
        self.within(number, product, |walk| {
            for item in items {
                let label = walk.label(item);
                walk.within(item, label, |walk| walk.item(item, &scaled, context, instance));
            }
            let children = walk.structure.children.get(&number).cloned().unwrap_or_default();
            for Child { representation, motion: inner, uses } in children {
                walk.enter(representation, &uses, &scaled.after(&inner), context);
            }
        });
        self.path.pop();
    }

    fn item(&mut self, number: u64, motion: &Motion, context: Option<u64>, instance: usize) {
        let Some(entity) = self.instances.get(number) else {
            return self.fail(number, MISSING);
        };
        let own = entity.parameters();
        match entity.keyword() {
            "MANIFOLD_SOLID_BREP" | "FACETED_BREP" => {
                let shell = self.heard(own.reference(1));
                self.shells(shell, motion, context, instance);
            }
            "BREP_WITH_VOIDS" => {
                let outer = self.heard(own.reference(1));
                let voids = self.heard(own.references(2)).unwrap_or_default();
                self.shells(outer.into_iter().chain(voids), motion, context, instance);
            }
            "SHELL_BASED_SURFACE_MODEL" | "FACE_BASED_SURFACE_MODEL" => {
                let shells = self.heard(own.references(1)).unwrap_or_default();
                self.shells(shells, motion, context, instance);
            }
            "CLOSED_SHELL" | "OPEN_SHELL" | "CONNECTED_FACE_SET" | "ORIENTED_CLOSED_SHELL" | "ORIENTED_OPEN_SHELL" => {
                self.shells(std::iter::once(number), motion, context, instance);
            }
            "GEOMETRIC_SET" => {
                for element in self.heard(own.references(1)).unwrap_or_default() {
                    match self.instances.get(element) {
                        Some(entity) if is_surface(&entity) => self.place(element, motion, false, context, instance),
                        Some(_) => {}
                        None => self.fail(element, MISSING),
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
        let (work, off) = (Cell::new(usize::MAX), Cell::new(Off::default()));
        let (effort, turned) = (Effort::new(0), RefCell::default());
        let geometry = Geometry {
            instances: self.instances,
            angle: 1.0,
            tolerance: 0.0,
            off: &off,
            work: &work,
            effort: &effort,
            turned: &turned,
        };
        let target = || -> Result<(u64, Motion), Fault> {
            let item = geometry.get(number)?;
            let own = item.parameters();
            let map = geometry.get(own.reference(1)?)?;
            let own_map = map.parameters();
            let (from, to) = (geometry.motion(own_map.reference(0)?)?, geometry.motion(own.reference(2)?)?);
            Ok((own_map.reference(1)?, to.after(&from.inverse())))
        };
        match target() {
            Ok((representation, inner)) => self.enter(representation, &[], &motion.after(&inner), context),
            Err(fault) => self.assembly.faults.push(fault),
        }
    }

    fn shells(
        &mut self,
        shells: impl IntoIterator<Item = u64>,
        motion: &Motion,
        context: Option<u64>,
        instance: usize,
    ) {
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
            let label = self.label(number);
            self.within(number, label, |walk| {
                for face in faces {
                    walk.place(face, motion, reversed, context, instance);
                }
            });
        }
    }

    fn place(&mut self, number: u64, motion: &Motion, reversed: bool, context: Option<u64>, instance: usize) {
        let label = self.label(number);
        self.within(number, label, |walk| {
            if walk.owner.is_hidden {
                walk.assembly.hidden.insert(number);
            } else if walk.assembly.placed.len() < walk.most {
                let attributes = walk.owner.attributes.clone();
                let placed = Placed { number, motion: *motion, reversed, context, instance, attributes };
                walk.assembly.placed.push(placed);
            } else if !walk.is_full {
                walk.is_full = true;
                walk.fail(number, TOO_MANY);
            }
        });
    }
}

//! Which faces of a surface may have material at a place: a box tree over their regions.
//!
//! A surface may be that of thousands of faces (a panel of tiles), of which a place has one. The boxes come from
//! [`crate::Classifier::hull`]; the answer goes to the caster, which asks the classifiers of those few.

use crate::tree_2d::{Node, grow};
use crate::trim::Classifier;
use glam::DVec2;
use nurbs::Rectangle;
use std::borrow::Cow;

/// The faces of one surface by where they have material.
pub(crate) struct Faces {
    /// In the order of the tree's leaves; in a leaf that is the whole tree, ascending.
    faces: Vec<u32>,
    nodes: Vec<Node>,
}

impl Faces {
    /// Takes the faces of a surface, ascending; `classifier` yields that of a face that is trimmed.
    pub fn new<'c>(faces: &[u32], classifier: impl Fn(u32) -> Option<&'c Classifier>) -> Self {
        let all = Rectangle { min: DVec2::NEG_INFINITY, max: DVec2::INFINITY };
        let mut boxes: Vec<(Rectangle, u32)> =
            faces.iter().map(|&face| (classifier(face).map_or(all, Classifier::hull), face)).collect();
        let mut nodes = vec![];
        let end = boxes.len();
        grow(&mut nodes, &mut boxes, [0, end]);
        Self { faces: boxes.into_iter().map(|(_, face)| face).collect(), nodes }
    }

    /// The faces whose boxes may meet the rectangle from `low` to `high`, ascending; a margin that is not a number leaves
    /// none out. Where the tree is one leaf, all faces: `rectangle` is not asked for, since to ask them takes no longer.
    pub fn near(&self, rectangle: impl FnOnce() -> [DVec2; 2]) -> Cow<'_, [u32]> {
        if self.nodes[0].halves.is_none() {
            return Cow::Borrowed(&self.faces);
        }
        let [low, high] = rectangle();
        let mut found = vec![];
        let mut stack = vec![0];
        while let Some(node) = stack.pop() {
            let node: &Node = &self.nodes[node];
            let apart = node.hull.max.cmplt(low).any() || high.cmplt(node.hull.min).any();
            match node.halves {
                _ if apart => {}
                Some(halves) => stack.extend(halves),
                None => found.extend(&self.faces[node.range[0]..node.range[1]]),
            }
        }
        found.sort_unstable();
        Cow::Owned(found)
    }
}

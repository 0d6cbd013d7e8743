//! A box tree over things in the (u, v) plane: segments of loops, regions of faces.

use nurbs::Rectangle;

/// Things in a leaf.
const LEAF: usize = 4;

/// A box with the things or the two nodes in it.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub hull: Rectangle,
    /// First and past-the-last thing.
    pub range: [usize; 2],
    /// The two halves; `None` in a leaf.
    pub halves: Option<[usize; 2]>,
}

/// Builds the node of `things[range]`, sorting them, and returns its index; parents come before their halves.
pub(crate) fn grow<T>(nodes: &mut Vec<Node>, things: &mut [(Rectangle, T)], range: [usize; 2]) -> usize {
    let part = &mut things[range[0]..range[1]];
    let hull = part.iter().map(|(hull, _)| *hull).fold(Rectangle::EMPTY, Rectangle::union);
    let index = nodes.len();
    nodes.push(Node { hull, range, halves: None });
    if part.len() > LEAF {
        let axis = usize::from(hull.size().x < hull.size().y);
        let middle = |hull: &Rectangle| hull.min[axis] + hull.max[axis];
        let half = part.len() / 2;
        part.select_nth_unstable_by(half, |a, b| middle(&a.0).total_cmp(&middle(&b.0)));
        let split = range[0] + half;
        let low = grow(nodes, things, [range[0], split]);
        let high = grow(nodes, things, [split, range[1]]);
        nodes[index].halves = Some([low, high]);
    }
    index
}

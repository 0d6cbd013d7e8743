//! A box tree over the pieces of a region at which the face ends.

use crate::packed::Numbers;

/// What stands in place of a leaf's piece in a node that has halves.
const NO_PIECE: f32 = -1.0;

/// A piece in the tree.
pub(crate) struct Leaf {
    /// Least u and v, greatest u and v, local parameters; f32 sees the piece inside.
    pub hull: [f32; 4],
    /// Index of the piece's first number.
    pub piece: usize,
}

impl Numbers {
    /// Appends a box tree to the points, each node before its halves and followed by all that is under it: its box, then
    /// (index behind all that is under it, index of its piece or −1, 0, 0). To the knots it appends where the tree begins
    /// and where it ends.
    pub(crate) fn push_tree(&mut self, mut leaves: Vec<Leaf>) {
        let first = self.points.len();
        if !leaves.is_empty() {
            self.push_node(&mut leaves);
        }
        self.knots.extend([first as f32, self.points.len() as f32]);
    }

    fn push_node(&mut self, leaves: &mut [Leaf]) {
        let node = self.points.len();
        let hull = leaves.iter().map(|leaf| leaf.hull).reduce(union).expect("a node has leaves");
        self.points.extend([hull, [0.0; 4]]);
        let piece = match leaves {
            [leaf] => leaf.piece as f32,
            _ => {
                let axis = usize::from(hull[2] - hull[0] < hull[3] - hull[1]);
                let half = leaves.len() / 2;
                let middle = |leaf: &Leaf| leaf.hull[axis] + leaf.hull[axis + 2];
                leaves.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
                let (low, high) = leaves.split_at_mut(half);
                self.push_node(low);
                self.push_node(high);
                NO_PIECE
            }
        };
        self.points[node + 1] = [self.points.len() as f32, piece, 0.0, 0.0];
    }
}

fn union(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}

//! What is known of a mesh: how large, how near, and how well its triangles meet.

use std::collections::HashMap;

/// What is known of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// Triangles.
    pub triangles: usize,
    /// No point of a triangle is farther from its face's surface, model units: proven, but for rounding.
    pub distance: f64,
    /// No point of a border is farther from its trim, model units: proven, but for rounding.
    pub border: f64,
    /// How far corners were moved to meet those of a neighbour, at most, model units: it is part of both distances.
    pub moved: f64,
    /// Edges of one triangle alone.
    pub open: usize,
    /// Edges of more than two triangles, and those that two run the same way.
    pub non_manifold: usize,
    /// Vertices less edges plus triangles: 2 for a ball, 0 for a ring.
    pub euler: i64,
    /// Faces without a triangle, by their numbers in the file: their trims' chords cross too often, or they are a point in space.
    pub left_out: Vec<usize>,
}

/// Edges of one triangle alone, edges that are not run once each way, and Euler's characteristic.
pub(super) fn count(triangles: impl Iterator<Item = [u32; 3]>) -> (usize, usize, i64) {
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
    let (mut count, mut greatest) = (0i64, 0u32);
    let mut used = vec![];
    for [a, b, c] in triangles {
        count += 1;
        greatest = greatest.max(a.max(b).max(c));
        used.resize(used.len().max(greatest as usize + 1), false);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            used[from as usize] = true;
            edges.entry([from.min(to), from.max(to)]).or_default()[usize::from(to < from)] += 1;
        }
    }
    let open = edges.values().filter(|uses| uses[0] + uses[1] == 1).count();
    let non_manifold = edges.values().filter(|uses| uses[0] + uses[1] != 1 && **uses != [1, 1]).count();
    let vertices = used.into_iter().filter(|used| *used).count() as i64;
    (open, non_manifold, vertices - edges.len() as i64 + count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_is_closed_and_less_a_triangle_is_not() {
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert_eq!(count(faces.into_iter()), (0, 0, 2));
        assert_eq!(count(faces.into_iter().skip(1)), (3, 0, 1));
        let turned = [[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert_eq!(count(turned.into_iter()), (0, 3, 2), "one is turned over: its edges are run twice the same way");
        assert_eq!(count(faces.into_iter().chain([[0, 1, 4]])).1, 1, "three at an edge");
    }
}

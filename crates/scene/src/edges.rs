//! Edges that trims share, and how far apart in space their curves run.

use crate::{FaceId, Model, Trim};
use glam::DVec3;
use nurbs::{Curve, Direction, Surface};
use std::collections::BTreeMap;

/// Places on a curve whose distance from the other is measured.
const SAMPLES: usize = 32;

/// Places on the other curve of which the nearest is looked at closely: even fast curves are slow between so many.
const STATIONS: usize = 128;

/// Thirds cut off the stretch about it, one after the other: what is left is 10⁻¹¹ of the curve.
const SECTIONS: u32 = 40;

/// An edge that at least two trims of a model share.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedEdge {
    /// The number that the file gives it.
    pub edge: i64,
    /// The faces of its trims, ascending; one face twice at a seam.
    pub faces: Vec<FaceId>,
    /// The greatest distance of a point of one trim's curve in space from that of the first, or the other way round,
    /// model units, as far as sampled. A gap or an overlap as wide is the model's own.
    pub gap: f64,
}

/// Borders of a surface closer together than this share of its box are one seam.
const CLOSED: f64 = 1e-6;

/// A trim as a curve in space.
struct Side<'m> {
    face: FaceId,
    surface: &'m Surface,
    curve: Curve,
    /// Whether the surface is closed in u and in v.
    closed: [bool; 2],
}

impl Side<'_> {
    /// The point at share `s`, 0 to 1, of the curve's parameters.
    fn point(&self, s: f64) -> DVec3 {
        let (start, end) = self.curve.knots().domain();
        let uv = self.curve.point(start + (end - start) * s);
        let inside = |axis: usize| {
            let direction = [Direction::U, Direction::V][axis];
            let (low, high) = self.surface.knots(direction).domain();
            let t = uv[axis];
            // Across the seam of a closed surface lies its other end; elsewhere a trim ends at the border.
            if self.closed[axis] && !(low..=high).contains(&t) {
                low + (t - low).rem_euclid(high - low)
            } else {
                t.clamp(low, high)
            }
        };
        self.surface.point(inside(0), inside(1))
    }

    /// The greatest distance of this curve's samples from `other`.
    fn gap(&self, other: &Self) -> f64 {
        let stations: Vec<DVec3> = (0..=STATIONS).map(|i| other.point(i as f64 / STATIONS as f64)).collect();
        let distance = |i: usize| {
            let p = self.point(i as f64 / SAMPLES as f64);
            let squared = |i: &usize| stations[*i].distance_squared(p);
            let nearest = (0..=STATIONS).min_by(|a, b| squared(a).total_cmp(&squared(b))).expect("stations");
            let [mut low, mut high] =
                [nearest.saturating_sub(1), (nearest + 1).min(STATIONS)].map(|i| i as f64 / STATIONS as f64);
            for _ in 0..SECTIONS {
                let third = (high - low) / 3.0;
                let [a, b] = [low + third, high - third];
                if other.point(a).distance_squared(p) < other.point(b).distance_squared(p) { high = b } else { low = a }
            }
            other.point(0.5 * (low + high)).distance(p).min(squared(&nearest).sqrt())
        };
        (0..=SAMPLES).map(distance).fold(0.0, f64::max)
    }
}

impl Model {
    /// The edges that trims share by the numbers that the file gives them, in the order of these.
    pub fn shared_edges(&self) -> Vec<SharedEdge> {
        let mut sides: BTreeMap<i64, Vec<Side>> = BTreeMap::new();
        for (index, face) in self.faces().iter().enumerate() {
            let id = FaceId(index as u32);
            let closed = closed(self.surface(id));
            for trim in face.loops.iter().flat_map(|boundary| &boundary.trims) {
                if let (Some(edge), Some(curve)) = (trim.edge, curve(trim)) {
                    sides.entry(edge).or_default().push(Side { face: id, surface: self.surface(id), curve, closed });
                }
            }
        }
        let shared = sides.into_iter().filter(|(_, sides)| sides.len() > 1);
        shared
            .map(|(edge, sides)| {
                // Against the first alone: a file may give one number to all its edges.
                let (first, others) = sides.split_first().expect("at least two sides");
                let gap = others.iter().map(|side| side.gap(first).max(first.gap(side))).fold(0.0, f64::max);
                SharedEdge { edge, faces: sides.iter().map(|side| side.face).collect(), gap }
            })
            .collect()
    }
}

/// Whether the two borders of a surface across u are one, and those across v: by three points of each, to 1e-6 of its box.
pub fn closed(surface: &Surface) -> [bool; 2] {
    let [[u0, u1], [v0, v1]] = surface.domain();
    let near = |[a, b, c, d]: [f64; 4]| {
        surface.point(a, b).distance(surface.point(c, d)) <= CLOSED * surface.hull().diagonal()
    };
    let shares = [0.0, 0.4, 1.0];
    let along = |low: f64, high: f64, s: f64| low + (high - low) * s;
    [
        shares.iter().all(|&s| near([u0, along(v0, v1, s), u1, along(v0, v1, s)])),
        shares.iter().all(|&s| near([along(u0, u1, s), v0, along(u0, u1, s), v1])),
    ]
}

/// The trim's curve, unless it is a point in space.
fn curve(trim: &Trim) -> Option<Curve> {
    let curve = || Curve::new(trim.knots.clone(), &trim.points, trim.weights.as_deref()).ok();
    (!trim.degenerate).then(curve).flatten()
}

#[cfg(test)]
mod tests {
    /// The quartic of one face and the cubic of the other are known to run up to a millionth apart.
    #[test]
    fn a_shared_edge_knows_how_far_apart_its_curves_run() {
        let model = models::builtin("seam-pair").expect("built in");
        let edges = model.shared_edges();
        assert_eq!(edges.len(), 1);
        assert_eq!(edges[0].faces.iter().map(|face| face.0).collect::<Vec<_>>(), [0, 1]);
        assert!((2e-7..1e-6).contains(&edges[0].gap), "{}", edges[0].gap);
    }

    /// The two sides of the window's seam are one line, and its loops across the seam share none.
    #[test]
    fn a_seam_is_an_edge_that_a_face_shares_with_itself() {
        let model = models::builtin("window").expect("built in");
        let edges = model.shared_edges();
        assert_eq!(edges[0].faces.len(), 2);
        assert!(edges[0].gap <= 1e-12 * model.hull().diagonal(), "{}", edges[0].gap);
    }
}

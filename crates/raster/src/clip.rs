//! Clipping: against the near and far planes of the clip volume, and against a guard band around the picture.
//!
//! Sutherland & Hodgman (1974), in clip coordinates, where position and attributes are linear. A cut is always
//! computed from the corner inside to the corner outside, so two triangles that share an edge cut it at the same
//! bits and no crack opens.

/// How far beyond the picture a corner may lie, in half pictures from its centre.
///
/// Hardware clips at the sides of the picture or at about ±32768 pixels. Nearer is better here: a cut is as exact as its
/// coordinates are small, and (1 + 4) × 8192 pixels leave fixed point far from overflow (see [`crate::setup`]).
pub const GUARD_BAND: f32 = 4.0;

/// A corner before the division by w, with what is interpolated over the triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClipVertex {
    /// Clip coordinates.
    pub clip: [f32; 4],
    /// Local parameters.
    pub uv: [f32; 2],
    /// Normal, for interpolated shading.
    pub normal: [f32; 3],
}

/// Signed distances to the six planes, not negative inside: near (z ≤ w, as depth is reversed), far, guard band.
fn distances([x, y, z, w]: [f32; 4]) -> [f32; 6] {
    let guard = GUARD_BAND * w;
    [w - z, z, guard + x, guard - x, guard + y, guard - y]
}

/// Whether a corner needs no clipping.
pub fn is_inside(clip: [f32; 4]) -> bool {
    distances(clip).into_iter().all(|d| d >= 0.0)
}

/// The part of a triangle inside all planes: a convex polygon of at most nine corners, or none.
pub fn clip(triangle: [ClipVertex; 3]) -> Vec<ClipVertex> {
    let mut polygon = triangle.to_vec();
    for plane in 0..6 {
        let mut inside = Vec::with_capacity(polygon.len() + 1);
        for (i, to) in polygon.iter().enumerate() {
            let from = &polygon[(i + polygon.len() - 1) % polygon.len()];
            let [d_from, d_to] = [from, to].map(|v| distances(v.clip)[plane]);
            if d_from >= 0.0 && d_to < 0.0 {
                inside.push(cut(from, to, d_from, d_to));
            } else if d_from < 0.0 && d_to >= 0.0 {
                inside.push(cut(to, from, d_to, d_from));
            }
            if d_to >= 0.0 {
                inside.push(*to);
            }
        }
        polygon = inside;
    }
    polygon
}

/// Where the edge from `inside` to `outside` meets the plane at these distances from them.
fn cut(inside: &ClipVertex, outside: &ClipVertex, d_inside: f32, d_outside: f32) -> ClipVertex {
    let t = d_inside / (d_inside - d_outside);
    fn mix<const N: usize>(a: [f32; N], b: [f32; N], t: f32) -> [f32; N] {
        std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)
    }
    ClipVertex {
        clip: mix(inside.clip, outside.clip, t),
        uv: mix(inside.uv, outside.uv, t),
        normal: mix(inside.normal, outside.normal, t),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertex(clip: [f32; 4], uv: [f32; 2]) -> ClipVertex {
        ClipVertex { clip, uv, normal: [0.0; 3] }
    }

    #[test]
    fn a_triangle_inside_stays_as_it_is() {
        let t = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|uv: [f32; 2]| vertex([uv[0], uv[1], 0.5, 1.0], uv));
        assert_eq!(clip(t), t);
        assert!(t.iter().all(|v| is_inside(v.clip)));
    }

    #[test]
    fn a_corner_behind_the_eye_is_cut_at_the_near_plane() {
        // z = near = 1 everywhere; w = depth: 3, 3 and −1. The near plane is at w = 1, half way along both edges.
        let t = [
            vertex([0.0, 0.0, 1.0, 3.0], [0.0, 0.0]),
            vertex([1.0, 0.0, 1.0, 3.0], [1.0, 0.0]),
            vertex([0.0, 2.0, 1.0, -1.0], [0.0, 1.0]),
        ];
        let polygon = clip(t);
        assert_eq!(polygon.len(), 4);
        let cuts: Vec<_> = polygon.iter().filter(|v| v.clip[3] == 1.0).map(|v| (v.clip[0], v.uv)).collect();
        assert_eq!(cuts, [(0.0, [0.0, 0.5]), (0.5, [0.5, 0.5])]);
    }

    #[test]
    fn a_triangle_behind_the_eye_is_gone() {
        let t = [0.0, 1.0, 2.0].map(|x| vertex([x, x * x, 1.0, -1.0 - x], [0.0, 0.0]));
        assert_eq!(clip(t), []);
    }

    #[test]
    fn a_shared_edge_is_cut_at_the_same_bits_from_both_sides() {
        let shared = [vertex([0.3, -0.7, 1.0, 5.3], [0.1, 0.2]), vertex([90.1, 77.7, 1.0, -0.7], [0.9, 0.7])];
        let a = vertex([-1.1, 2.3, 1.0, 2.9], [0.0, 1.0]);
        let b = vertex([3.3, -2.9, 1.0, 3.1], [1.0, 0.0]);
        let on_both: Vec<_> = clip([shared[0], shared[1], a])
            .into_iter()
            .filter(|v| clip([shared[1], shared[0], b]).contains(v))
            .collect();
        assert_eq!(on_both.len(), 2, "the inner end and the cut: {on_both:?}");
    }
}

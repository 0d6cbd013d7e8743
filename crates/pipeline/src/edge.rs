//! Where a trim edge passes by a pixel's centre, for anti-aliasing: in f32. Twin of `shaders/edge.wgsl`.
//!
//! Geometry-buffer anti-aliasing (Persson, *Geometry Buffer Anti-Aliasing*, 2011) has each fragment record where the edge
//! of its own face passes, in pixels; the finished picture is blended by that (`gbuffer`'s resolve). A fragment knows
//! S and its derivatives, and so what a step in (u, v) is in the picture. Through that linear map it sees the edges of its
//! face around the pixel's centre: a box tree leads to the pieces that come within reach, a bisection to the part
//! of each that does (it is monotone), and chords, shorter from round to round, to its nearest place. S is evaluated once
//! more there, so that the edge is recorded where the picture has it and not where the linear map does; and as the
//! derivatives there make a better map, all is done once more ([`MAPS`]).
//!
//! All of the boundary counts at which the face ends as it is seen ([`scene::Region::edges`]), level pieces and loops
//! smaller than a pixel as any others; of two edges the nearer. What the fragment does not see is an edge of its face on
//! the other side of a seam. None of this is in a program unless the scene was packed for it
//! ([`PackedScene::with_edges`]).
//!
//! # Accuracy
//! The place is on the edge to [`PackedFrame::edge_band`](crate::PackedFrame::edge_band) and the rounding of S and of its
//! picture. It is the nearest as far as the first map shows the nearest where the picture has it, and as far as the first chords tell
//! pieces apart that bend within a pixel: `compare` states and measures both. Nothing is found where the face is seen
//! edge-on ([`EDGE_ON`]).

pub(crate) mod pack;

use crate::fragment::{TangentPlane, tangent_plane};
use crate::layout::{FaceRecord, Parameters, View};
use crate::packed::PackedScene;
use crate::sight::NEAR_PX;
use crate::trim::{self, point};

/// How far from a pixel's centre an edge is looked for, pixels, in any direction.
///
/// A straight edge farther than √½ leaves all of the pixel to its face; what spills over from the neighbour across comes
/// from no farther than 1.
pub const REACH_PX: f32 = 1.0;

/// How far a linear map looks for edges, pixels, and how far off by the first an edge may be: what is nearer in the picture
/// may be farther by the map.
pub const MAP_REACH_PX: f32 = 2.0;

/// Linear maps: that at the fragment, and one more where the first shows the nearest place. The nearer of the two places
/// in the picture is recorded.
pub const MAPS: u32 = 2;

/// Below this sine of the angle between the pictures of S_u and S_v a step in the picture is none in (u, v).
pub const EDGE_ON: f32 = 1.0 / 65536.0;

/// Halvings to either end of the part of a piece that is within reach: then it is longer than that by 1/4096 of the piece.
pub const CLIP_HALVINGS: u32 = 12;

/// Chords of a round.
pub const CHORDS: u32 = 8;

/// Rounds at most: the last chord is 1/2048 of the part within reach.
pub const ROUNDS: u32 = 5;

/// No further round where the chord is shorter than this, pixels: an arc of radius r is within 2⁻¹³ / r of it.
pub const FINE_PX: f32 = 1.0 / 32.0;

/// Steps of a recorded offset to a pixel: [`packed`] gives each coordinate 15 bits.
pub const STEPS: f32 = 16383.0;

/// Where the middle of the steps is.
const MIDDLE: f32 = 16384.0;

/// Bits of a packed word that are not the edge's.
const STATUS_BITS: u32 = 2;

/// Bits of a coordinate.
const BITS: u32 = 15;

/// S about a fragment, as the picture shows it.
#[derive(Debug, Clone, Copy)]
struct Seen {
    /// From the pixel's centre, pixels: right and down.
    offset: [f32; 2],
    /// What u adds to it.
    along_u: [f32; 2],
    /// What v adds to it.
    along_v: [f32; 2],
}

/// The picture about a pixel's centre as a linear map of local parameters.
#[derive(Debug, Clone, Copy)]
struct Map {
    /// Parameters at the centre.
    center: [f32; 2],
    along_u: [f32; 2],
    along_v: [f32; 2],
    /// By how much u and v change at most within a pixel of the centre.
    extent: [f32; 2],
}

/// The nearest place found.
#[derive(Debug, Clone, Copy)]
struct Foot {
    uv: [f32; 2],
    /// Its distance squared, pixels.
    squared: f32,
}

/// The offset in pixels, right and down, from picture position `at` (a pixel's centre, pixels from the top left) to the
/// nearest edge of `face`, within [`REACH_PX`].
///
/// Where the centre is beyond the edge, by [`NEAR_PX`] at most, the offset is the opposite of that: a hit is always inside,
/// and it says in which direction the face ends.
///
/// `uv` are parameters of the whole domain, 0 … 1, of a point that is seen near there; the search begins at the place that they have at
/// `at` itself, by one step of Newton's method.
pub fn edge(scene: &PackedScene, view: &View, face: u32, uv: [f32; 2], at: [f32; 2]) -> Option<[f32; 2]> {
    let f = &scene.faces()[face as usize];
    if !scene.has_edges() || f.intervals == 0 {
        return None;
    }
    let (mut here, mut place) = (seen(scene, view, face, uv, at)?, uv);
    let first = map(&here, place)?;
    let mut by = first;
    let mut best = None;
    let mut squared = REACH_PX * REACH_PX;
    for _ in 0..MAPS {
        let Some(foot) = nearest(scene, f, &by) else { break };
        // What the first map has farther away is on another sheet of the surface.
        if first.squared(foot.uv) > MAP_REACH_PX * MAP_REACH_PX {
            break;
        }
        place = foot.uv;
        let Some(there) = seen(scene, view, face, place, at) else { break };
        here = there;
        let [x, y] = here.offset;
        if x * x + y * y <= squared {
            squared = x * x + y * y;
            best = Some(here.offset);
        }
        let Some(next) = map(&here, place) else { break };
        by = next;
    }
    // A face covers a centre that is a little beyond its border; the edge is recorded on the side where it ends.
    let is_beyond = squared <= NEAR_PX * NEAR_PX && !trim::is_material(scene, f, first.center);
    if is_beyond { best.map(|[x, y]: [f32; 2]| [-x, -y]) } else { best }
}

impl Map {
    /// The squared distance that the map gives a point from the pixel's centre.
    fn squared(&self, uv: [f32; 2]) -> f32 {
        let [u, v] = [uv[0] - self.center[0], uv[1] - self.center[1]];
        let [x, y] = [u * self.along_u[0] + v * self.along_v[0], u * self.along_u[1] + v * self.along_v[1]];
        x * x + y * y
    }
}

/// S at local parameters as the picture shows it about `at`; `None` behind the eye.
fn seen(scene: &PackedScene, view: &View, face: u32, uv: [f32; 2], at: [f32; 2]) -> Option<Seen> {
    let TangentPlane { s, su, sv, .. } = tangent_plane(scene, face, Parameters::searched(uv));
    let m = &view.clip_from_local;
    let direction = |x: [f32; 3], k: usize| m[0][k] * x[0] + m[1][k] * x[1] + m[2][k] * x[2];
    let w = direction(s, 3) + m[3][3];
    if w <= 0.0 {
        return None;
    }
    let (x, y) = ((direction(s, 0) + m[3][0]) / w, (direction(s, 1) + m[3][1]) / w);
    let half = [view.units[1], view.units[2]];
    let along = |derivative: [f32; 3]| {
        let slope = direction(derivative, 3);
        [(direction(derivative, 0) - x * slope) / w * half[0], -((direction(derivative, 1) - y * slope) / w * half[1])]
    };
    Some(Seen {
        offset: [half[0] * x + (half[0] - at[0]), half[1] - at[1] - half[1] * y],
        along_u: along(su),
        along_v: along(sv),
    })
}

/// The linear map about the pixel's centre by what is seen at `uv`; `None` where that is seen edge-on.
fn map(seen: &Seen, uv: [f32; 2]) -> Option<Map> {
    let Seen { offset: o, along_u: a, along_v: b } = *seen;
    let det = a[0] * b[1] - a[1] * b[0];
    let aa = a[0] * a[0] + a[1] * a[1];
    let bb = b[0] * b[0] + b[1] * b[1];
    if det * det <= (EDGE_ON * EDGE_ON) * aa * bb {
        return None;
    }
    Some(Map {
        center: [uv[0] - (b[1] * o[0] - b[0] * o[1]) / det, uv[1] - (a[0] * o[1] - a[1] * o[0]) / det],
        along_u: a,
        along_v: b,
        extent: [bb.sqrt() / det.abs(), aa.sqrt() / det.abs()],
    })
}

/// The nearest place of the face's edges as the linear map has them, within [`MAP_REACH_PX`].
fn nearest(scene: &PackedScene, f: &FaceRecord, map: &Map) -> Option<Foot> {
    let tree = (f.trims + 2 * (f.intervals + 1)) as usize;
    let (mut node, end) = (scene.knots()[tree] as usize, scene.knots()[tree + 1] as usize);
    let mut best = None;
    let mut squared = MAP_REACH_PX * MAP_REACH_PX;
    while node < end {
        let hull = scene.points()[node];
        let link = scene.points()[node + 1];
        let radius = squared.sqrt();
        let (u, v) = (radius * map.extent[0], radius * map.extent[1]);
        let [low_u, low_v] = [map.center[0] - u, map.center[1] - v];
        let [high_u, high_v] = [map.center[0] + u, map.center[1] + v];
        if high_u >= hull[0] && high_v >= hull[1] && low_u <= hull[2] && low_v <= hull[3] {
            if link[1] >= 0.0 {
                let piece = link[1] as usize;
                let foot = nearest_on_piece(scene.points(), piece, map, [low_u, low_v, high_u, high_v]);
                if foot.squared < squared {
                    squared = foot.squared;
                    best = Some(foot);
                }
            }
            node += 2;
        } else {
            node = link[0] as usize;
        }
    }
    best
}

/// The place of a piece that is nearest to the map's centre, of those in the box `reach` (least u and v, greatest u and v).
fn nearest_on_piece(points: &[[f32; 4]], piece: usize, map: &Map, reach: [f32; 4]) -> Foot {
    let [u, v, per_u, per_v] = points[piece];
    let degree = points[piece + 1][3] as usize;
    let control = &points[piece + 1..piece + 2 + degree];
    let low = [(reach[0] - u) * per_u, (reach[1] - v) * per_v];
    let high = [(reach[2] - u) * per_u, (reach[3] - v) * per_v];
    // v rises along a piece; u may fall.
    let falls = control[0][0] / control[0][2] > control[degree][0] / control[degree][2];
    let is_before = |t: f32| {
        let c = point(control, t);
        (if falls { c[0] > high[0] * c[2] } else { c[0] < low[0] * c[2] }) || c[1] < low[1] * c[2]
    };
    let is_after = |t: f32| {
        let c = point(control, t);
        (if falls { c[0] < low[0] * c[2] } else { c[0] > high[0] * c[2] }) || c[1] > high[1] * c[2]
    };
    let (mut start, mut beyond) = (0.0, 1.0);
    for _ in 0..CLIP_HALVINGS {
        let t = 0.5 * (start + beyond);
        if is_before(t) { start = t } else { beyond = t }
    }
    let (mut within, mut end) = (start, 1.0);
    for _ in 0..CLIP_HALVINGS {
        let t = 0.5 * (within + end);
        if is_after(t) { end = t } else { within = t }
    }
    // The piece's box, which is 0 … 1 along x and y, in the picture.
    let size = [extent(per_u), extent(per_v)];
    let along_x = map.along_u.map(|x| x * size[0]);
    let along_y = map.along_v.map(|y| y * size[1]);
    let (from_u, from_v) = (u - map.center[0], v - map.center[1]);
    let corner: [f32; 2] = std::array::from_fn(|k| from_u * map.along_u[k] + from_v * map.along_v[k]);
    let place = |t: f32| {
        let c = point(control, t);
        let (x, y) = (c[0] / c[2], c[1] / c[2]);
        [corner[0] + (x * along_x[0] + y * along_y[0]), corner[1] + (x * along_x[1] + y * along_y[1])]
    };
    let (least, greatest) = (start, end);
    let mut squared = f32::MAX;
    let mut t = start;
    for _ in 0..ROUNDS {
        let step = (end - start) / CHORDS as f32;
        let first = start;
        let mut from = place(first);
        squared = f32::MAX;
        let mut length_squared = 0.0;
        for i in 0..CHORDS {
            let to = place(first + step * (i as f32 + 1.0));
            let chord = nearest_on_chord(from, to);
            if chord.squared < squared {
                squared = chord.squared;
                length_squared = chord.length_squared;
                // Half of the chord before and of the one behind: the arc may be nearest beside its nearest chord.
                start = (first + step * (i as f32 - 0.5)).max(least);
                end = (first + step * (i as f32 + 1.5)).min(greatest);
                t = first + step * (i as f32 + chord.share);
            }
            from = to;
        }
        if length_squared <= FINE_PX * FINE_PX {
            break;
        }
    }
    let c = point(control, t);
    Foot { uv: [u + c[0] / c[2] * size[0], v + c[1] / c[2] * size[1]], squared }
}

/// The size of a piece's box from its reciprocal, which is 0 where there is none.
fn extent(per: f32) -> f32 {
    if per > 0.0 { 1.0 / per } else { 0.0 }
}

/// The place of a chord that is nearest to the origin.
struct OnChord {
    /// How far along the chord, 0 … 1.
    share: f32,
    squared: f32,
    length_squared: f32,
}

fn nearest_on_chord(from: [f32; 2], to: [f32; 2]) -> OnChord {
    let chord = [to[0] - from[0], to[1] - from[1]];
    let length_squared = chord[0] * chord[0] + chord[1] * chord[1];
    let along = -(from[0] * chord[0] + from[1] * chord[1]);
    let share = if length_squared > 0.0 { (along / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    let at = [from[0] + share * chord[0], from[1] + share * chord[1]];
    OnChord { share, squared: at[0] * at[0] + at[1] * at[1], length_squared }
}

/// An edge's offset as the upper 30 bits of a word, in steps of 1/16383 pixel from −1 to 1; zero where there is none.
pub fn packed(edge: Option<[f32; 2]>) -> u32 {
    let Some([x, y]) = edge else { return 0 };
    let steps = |t: f32| (MIDDLE + 0.5 + STEPS * t.clamp(-REACH_PX, REACH_PX)) as u32;
    steps(x) << STATUS_BITS | steps(y) << (STATUS_BITS + BITS)
}

/// What stands in the lower two bits of a word beside an edge, and the edge.
pub fn unpacked(word: u32) -> (u32, Option<[f32; 2]>) {
    let status = word & ((1 << STATUS_BITS) - 1);
    let steps = |shift: u32| ((word >> shift & ((1 << BITS) - 1)) as f32 - MIDDLE) / STEPS;
    let edge = (word >> STATUS_BITS != 0).then(|| [steps(STATUS_BITS), steps(STATUS_BITS + BITS)]);
    (status, edge)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_packed_edge_is_unpacked_to_half_a_step_and_none_to_none() {
        assert_eq!(unpacked(2 | packed(None)), (2, None));
        for i in 0..=1000 {
            let edge = [i as f32 / 500.0 - 1.0, (i * 7 % 1001) as f32 / 500.0 - 1.0];
            let (status, Some(back)) = unpacked(1 | packed(Some(edge))) else { panic!("{edge:?} is lost") };
            assert_eq!(status, 1);
            assert!((0..2).all(|k| (back[k] - edge[k]).abs() <= 0.51 / STEPS), "{edge:?} {back:?}");
        }
        assert_eq!(unpacked(packed(Some([0.0; 2]))), (0, Some([0.0; 2])));
    }
}

//! A corner of a patch's grid. Twin of `shaders/grid/corner.wgsl`.
//!
//! What lies on a border, or at a patch's corner, is evaluated where all patches do that share it, by the same numbers: so they
//! have it at the same place to the bit. A border has no more parts than the grid beside it has cells; corners between two
//! of them move to the one before. The cell becomes a triangle there, and no gap opens.

use super::record::{GridRecord, LOW_U, LOW_V};
use crate::triangles::{BEYOND, STEEPEST};
use pipeline::fragment::{TangentPlane, fragment, tangent_plane};
use pipeline::sight::dot;
use pipeline::{PackedScene, Parameters, Vertex, View};

/// A line of a grid: its parameter, and to which side of the patch it lies beyond it.
#[derive(Clone, Copy)]
struct Line {
    t: f32,
    side: f32,
}

impl Line {
    fn new(index: u32, level: u32, has_skirt: bool) -> Self {
        let cells = 1 << level;
        let i = index as i32 - i32::from(has_skirt);
        let side = if i < 0 {
            -1.0
        } else if i > cells {
            1.0
        } else {
            0.0
        };
        Self { t: i.clamp(0, cells) as f32 / cells as f32, side }
    }
}

/// The start of the part of a border that a parameter lies in.
fn snapped(t: f32, level: u32) -> f32 {
    let cells = (1u32 << level) as f32;
    (t * cells).floor() / cells
}

/// The corner in row `row`, which is along v, and column `column` of a grid, whose face is seen as `view` says.
pub fn corner(scene: &PackedScene, view: &View, grid: &GridRecord, row: u32, column: u32) -> Vertex {
    let lines = [
        Line::new(row, grid.level[0], grid.sides & LOW_U != 0),
        Line::new(column, grid.level[1], grid.sides & LOW_V != 0),
    ];
    let mut t = lines.map(|line| line.t);
    let on_border = t.map(|t| t == 0.0 || t == 1.0);
    let is_beyond = lines.iter().any(|line| line.side != 0.0);
    // Where all faces evaluate it that share it.
    let (mut frame, mut place) = (grid.face, None);
    if !is_beyond {
        let end = |k: usize| usize::from(t[k] == 1.0);
        match on_border {
            [true, true] => {
                let at = &grid.corners[2 * end(0) + end(1)];
                (frame, place) = (at.face, Some(Parameters { span: at.span, uv: at.uv }));
            }
            [false, false] => {}
            [on_u, _] => {
                let along = usize::from(on_u);
                let border = &grid.borders[if on_u { end(0) } else { 2 + end(1) }];
                t[along] = snapped(t[along], border.level);
                let at = [0, 1].map(|k| border.start[k] + t[along] * (border.end[k] - border.start[k]));
                (frame, place) = (border.face, Some(Parameters { span: border.span, uv: at }));
            }
        }
    }
    let uv = [0, 1].map(|k| grid.from[k] + grid.size[k] * t[k]);
    let own = Parameters { span: grid.span, uv };
    let TangentPlane { s, su, sv, .. } = tangent_plane(scene, grid.face, own);
    let beyond = lines.map(|line| line.side);
    let position = match place {
        _ if is_beyond => {
            let sight = std::array::from_fn(|i| view.eye[i] - s[i] * view.eye[3]);
            let [u, v] = [way(sight, sv, su, beyond[0]), way(sight, su, sv, beyond[1])];
            std::array::from_fn(|i| s[i] + grid.skirt * (u[i] + v[i]))
        }
        Some(place) => tangent_plane(scene, frame, place).s,
        None => s,
    };
    Vertex {
        position,
        uv: [0, 1].map(|k| uv[k] + BEYOND * beyond[k]),
        face: grid.face,
        span: grid.span,
        normal: fragment(scene, grid.face, own, false).normal,
        frame,
    }
}

/// The way from a border, as it is seen along `sight`, straight away from its tangent `along`; to the side to which `out` times
/// `side` leads. Zero from a collapsed border, and from one that is seen end-on.
///
/// In depth it goes as the surface goes on the way in, up to where that is seen under [`STEEPEST`].
fn way(sight: [f32; 3], along: [f32; 3], out: [f32; 3], side: f32) -> [f32; 3] {
    let (sight, along) = (unit(sight), unit(along));
    let across = unit(cross(sight, along));
    if side == 0.0 || across == [0.0; 3] {
        return [0.0; 3];
    }
    let towards = if side * dot(across, out) < 0.0 { -1.0 } else { 1.0 };
    let slant = dot(out, along);
    let straight = unit(std::array::from_fn(|i| side * (out[i] - along[i] * slant)));
    let depth = dot(straight, sight) / (towards * dot(straight, across)).max(STEEPEST);
    std::array::from_fn(|i| towards * across[i] - sight[i] * depth)
}

fn unit(a: [f32; 3]) -> [f32; 3] {
    let length = dot(a, a).sqrt();
    if length > 0.0 { a.map(|x| x / length) } else { [0.0; 3] }
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

//! A corner of a patch's grid. Twin of `shaders/grid/corner.wgsl`.
//!
//! What lies on a border, or at a patch's corner, is evaluated where all patches do that share it, by the same numbers: so they
//! have it at the same place to the bit. A border has no more parts than the grid beside it has cells; corners between two
//! of them move to the one before. The cell becomes a triangle there, and no gap opens.

use super::record::{GridRecord, LOW_U, LOW_V};
use pipeline::fragment::{TangentPlane, fragment, tangent_plane};
use pipeline::{PackedScene, Parameters, Vertex};

/// How many times its width a skirt may measure along a parameter that comes to the border at a slant.
pub const SLANT: f32 = 4.0;

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

/// The corner in row `row`, which is along v, and column `column` of a grid.
pub fn corner(scene: &PackedScene, grid: &GridRecord, row: u32, column: u32) -> Vertex {
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
    let spans = scene.spans(&scene.faces()[grid.face as usize], grid.span);
    let (su, sv) = (su.map(|x| x * spans[0].length), sv.map(|x| x * spans[1].length));
    let gains = reach(grid.skirt, su, sv);
    let beyond = [0, 1].map(|k| lines[k].side * gains[k]);
    let position = match place {
        _ if is_beyond => std::array::from_fn(|i| s[i] + su[i] * beyond[0] + sv[i] * beyond[1]),
        Some(place) => tangent_plane(scene, frame, place).s,
        None => s,
    };
    Vertex {
        position,
        uv: [0, 1].map(|k| uv[k] + beyond[k]),
        face: grid.face,
        span: grid.span,
        normal: fragment(scene, grid.face, own, false).normal,
        frame,
    }
}

/// What u and v gain on the way straight away from a border by the skirt's width.
fn reach(width: f32, su: [f32; 3], sv: [f32; 3]) -> [f32; 2] {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let n = [su[1] * sv[2] - su[2] * sv[1], su[2] * sv[0] - su[0] * sv[2], su[0] * sv[1] - su[1] * sv[0]];
    let area = dot(n, n).sqrt();
    let (speed_u, speed_v) = (dot(su, su).sqrt(), dot(sv, sv).sqrt());
    // The border, whose tangent is `along`, may be come to at a slant; from a collapsed one nothing goes on.
    let gain = |speed: f32, along: f32| {
        if area == 0.0 { 0.0 } else { (width * along / area).min(SLANT * width / speed) }
    };
    [gain(speed_u, speed_v), gain(speed_v, speed_u)]
}

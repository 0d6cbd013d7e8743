//! The fragment program: from interpolated (u, v) and a face to what the pixel shows. Twin of `shaders/fragment.wgsl`.

use crate::eval::{self, Basis, Derivatives};
use crate::layout::{FaceRecord, REVERSED};
use crate::{Lanes, PackedScene};
use nurbs::{MAX_ORDER, NormalStatus};

/// How many fragments the rasterizer evaluates together.
pub const WIDTH: usize = 8;

/// What a fragment writes, in the face's local coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fragment {
    /// The face.
    pub face: u32,
    /// Local parameters, clamped to 0 … 1.
    pub uv: [f32; 2],
    /// Knot spans in u and v.
    pub span: [u32; 2],
    /// S.
    pub position: [f32; 3],
    /// Unit normal of the face; zero where the status is undefined.
    pub normal: [f32; 3],
    /// [`NormalStatus::Regular`] or [`NormalStatus::Undefined`]: limits are left to f64.
    pub status: NormalStatus,
    /// Principal curvatures in local units, greater first; zero unless asked for and regular.
    pub curvature: [f32; 2],
    /// |S_u| and |S_v| in local units.
    pub speed: [f32; 2],
}

/// Runs the program for one fragment.
pub fn fragment(scene: &PackedScene, face: u32, uv: [f32; 2], curvature: bool) -> Fragment {
    let uv = clamp(uv);
    let span = spans(scene, face, uv);
    fragments::<1>(scene, face, span, [uv], curvature)[0]
}

/// Runs the program for up to [`WIDTH`] fragments of one face; those that share their spans go together.
///
/// The answers are the same, to the bit, as those of [`fragment`].
pub fn fragment_row(scene: &PackedScene, face: u32, uv: &[[f32; 2]], curvature: bool, out: &mut Vec<Fragment>) {
    let mut rest = uv;
    while let Some(&first) = rest.first() {
        let span = spans(scene, face, clamp(first));
        let run = rest.iter().take(WIDTH).take_while(|&&uv| spans(scene, face, clamp(uv)) == span).count();
        let (now, later) = rest.split_at(run);
        if run == 1 {
            out.extend(fragments::<1>(scene, face, span, [clamp(first)], curvature));
        } else {
            let padded = std::array::from_fn(|i| clamp(now[i.min(run - 1)]));
            out.extend(&fragments::<WIDTH>(scene, face, span, padded, curvature)[..run]);
        }
        rest = later;
    }
}

/// Interpolation may leave the domain by a rounding error; the surface ends there.
fn clamp(uv: [f32; 2]) -> [f32; 2] {
    uv.map(|t| t.clamp(0.0, 1.0))
}

fn spans(scene: &PackedScene, face: u32, uv: [f32; 2]) -> [usize; 2] {
    let f = &scene.faces[face as usize];
    let [ku, kv] = scene.knots(f);
    [
        eval::find_span(ku, f.degree_u as usize, f.count_u as usize, f.last_u as usize, uv[0]),
        eval::find_span(kv, f.degree_v as usize, f.count_v as usize, f.last_v as usize, uv[1]),
    ]
}

fn fragments<const N: usize>(
    scene: &PackedScene,
    face: u32,
    span: [usize; 2],
    uv: [[f32; 2]; N],
    curvature: bool,
) -> [Fragment; N] {
    let f = &scene.faces[face as usize];
    // A specialised program knows its degree; the compiler then unrolls every loop.
    match [f.degree_u, f.degree_v] {
        [3, 3] if curvature => evaluate::<4, N>(scene, f, face, [3, 3], span, uv, true),
        [3, 3] => evaluate::<4, N>(scene, f, face, [3, 3], span, uv, false),
        [5, 5] => evaluate::<6, N>(scene, f, face, [5, 5], span, uv, curvature),
        [p, q] => evaluate::<MAX_ORDER, N>(scene, f, face, [p as usize, q as usize], span, uv, curvature),
    }
}

#[inline(always)]
fn evaluate<const CAPACITY: usize, const N: usize>(
    scene: &PackedScene,
    f: &FaceRecord,
    face: u32,
    degree: [usize; 2],
    span: [usize; 2],
    uv: [[f32; 2]; N],
    second: bool,
) -> [Fragment; N] {
    let [ku, kv] = scene.knots(f);
    let u = Lanes(uv.map(|uv| uv[0]));
    let v = Lanes(uv.map(|uv| uv[1]));
    let nu: Basis<CAPACITY, N> = eval::basis(ku, degree[0], span[0], u, second);
    let nv: Basis<CAPACITY, N> = eval::basis(kv, degree[1], span[1], v, second);
    let d: Derivatives<N> = eval::surface(f, degree, &scene.points, span[0], span[1], &nu, &nv, second);
    let (n, n_squared, su_squared, sv_squared) = eval::normal_terms(&d);
    let length = n_squared.sqrt();
    let n = n.map(|x| x / length);
    let k = if second { eval::curvature(&d, n, su_squared) } else { [Lanes::ZERO; 2] };
    let speed = [su_squared.sqrt(), sv_squared.sqrt()];
    std::array::from_fn(|i| {
        let regular = eval::is_regular(n_squared.0[i], su_squared.0[i], sv_squared.0[i]);
        let mut normal = [0.0; 3];
        let mut curvature = [0.0; 2];
        if regular {
            normal = n.map(|x| x.0[i]);
            curvature = k.map(|x| x.0[i]);
            if f.flags & REVERSED != 0 {
                normal = normal.map(|x| -x);
                curvature = [-curvature[1], -curvature[0]];
            }
        }
        Fragment {
            face,
            uv: uv[i],
            span: span.map(|s| s as u32),
            position: d.s.map(|x| x.0[i]),
            normal,
            status: if regular { NormalStatus::Regular } else { NormalStatus::Undefined },
            curvature,
            speed: speed.map(|x| x.0[i]),
        }
    })
}

//! The fragment program: from interpolated (u, v) and a face to what the pixel shows. Twin of `shaders/fragment.wgsl`.

use crate::PackedScene;
use crate::eval::{self, Basis, Derivatives};
use crate::lanes::{Lanes, Vec3};
use crate::layout::{FaceRecord, REVERSED};
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
    /// From the pixel's centre to the face's nearest trim edge, pixels, right and down; not set by the program itself,
    /// which knows of no picture, but by [`crate::edge`].
    pub edge: Option<[f32; 2]>,
}

/// Runs the program for one fragment.
pub fn fragment(scene: &PackedScene, face: u32, uv: [f32; 2], curvature: bool) -> Fragment {
    let mut out = Vec::with_capacity(1);
    fragment_row(scene, face, &[uv], curvature, &mut out);
    out[0]
}

/// Runs the program for fragments of one face and appends them to `out`. Up to [`WIDTH`] that follow each other on the
/// same spans go together; the answers are the same, to the bit, however they fall into groups.
pub fn fragment_row(scene: &PackedScene, face: u32, uv: &[[f32; 2]], curvature: bool, out: &mut Vec<Fragment>) {
    let f = &scene.faces[face as usize];
    let [ku, kv] = scene.knots(f);
    let [degree, count, last] =
        [[f.degree_u, f.degree_v], [f.count_u, f.count_v], [f.last_u, f.last_v]].map(|pair| pair.map(|x| x as usize));
    out.reserve(uv.len());
    let mut rest = uv;
    while let Some(&first) = rest.first() {
        let first = clamp(first);
        let span = [
            eval::find_span(ku, degree[0], count[0], last[0], first[0]),
            eval::find_span(kv, degree[1], count[1], last[1], first[1]),
        ];
        let is_alike = |uv: [f32; 2]| {
            let [u, v] = clamp(uv);
            eval::is_on_span(ku, count[0], last[0], span[0], u) && eval::is_on_span(kv, count[1], last[1], span[1], v)
        };
        let run = 1 + rest[1..].iter().take(WIDTH - 1).take_while(|uv| is_alike(**uv)).count();
        let (now, later) = rest.split_at(run);
        if run == 1 {
            fragments::<1>(scene, face, span, [first], 1, curvature, out);
        } else {
            let padded = std::array::from_fn(|i| clamp(now[i.min(run - 1)]));
            fragments::<WIDTH>(scene, face, span, padded, run, curvature, out);
        }
        rest = later;
    }
}

/// Interpolation may leave the domain by a rounding error; the surface ends there.
fn clamp(uv: [f32; 2]) -> [f32; 2] {
    uv.map(|t| t.clamp(0.0, 1.0))
}

/// Appends the first `count` of `N` fragments.
fn fragments<const N: usize>(
    scene: &PackedScene,
    face: u32,
    span: [usize; 2],
    uv: [[f32; 2]; N],
    count: usize,
    curvature: bool,
    out: &mut Vec<Fragment>,
) {
    let f = &scene.faces[face as usize];
    // A specialised program knows its degree; the compiler then unrolls every loop.
    let result: Evaluated<N> = match [f.degree_u, f.degree_v] {
        [3, 3] if curvature => evaluate::<4, N>(scene, f, [3, 3], span, uv, true),
        [3, 3] => evaluate::<4, N>(scene, f, [3, 3], span, uv, false),
        [5, 5] if curvature => evaluate::<6, N>(scene, f, [5, 5], span, uv, true),
        [5, 5] => evaluate::<6, N>(scene, f, [5, 5], span, uv, false),
        [p, q] => evaluate::<MAX_ORDER, N>(scene, f, [p as usize, q as usize], span, uv, curvature),
    };
    out.extend((0..count).map(|i| result.fragment(f, face, uv[i], span, i)));
}

/// The program's values, `N` fragments side by side, before degenerate ones are sorted out.
struct Evaluated<const N: usize> {
    position: Vec3<N>,
    normal: Vec3<N>,
    n_squared: Lanes<N>,
    squared: [Lanes<N>; 2],
    curvature: [Lanes<N>; 2],
    speed: [Lanes<N>; 2],
}

#[inline(always)]
fn evaluate<const CAPACITY: usize, const N: usize>(
    scene: &PackedScene,
    f: &FaceRecord,
    degree: [usize; 2],
    span: [usize; 2],
    uv: [[f32; 2]; N],
    second: bool,
) -> Evaluated<N> {
    let [ku, kv] = scene.knots(f);
    let u = Lanes(uv.map(|uv| uv[0]));
    let v = Lanes(uv.map(|uv| uv[1]));
    let nu: Basis<CAPACITY, N> = eval::basis(ku, degree[0], span[0], u, second);
    let nv: Basis<CAPACITY, N> = eval::basis(kv, degree[1], span[1], v, second);
    let d: Derivatives<N> = eval::surface(f, degree, &scene.points, span[0], span[1], &nu, &nv, second);
    let (n, n_squared, su_squared, sv_squared) = eval::normal_terms(&d);
    let length = n_squared.sqrt();
    let n = n.map(|x| x / length);
    Evaluated {
        position: d.s,
        normal: n,
        n_squared,
        squared: [su_squared, sv_squared],
        curvature: if second { eval::curvature(&d, n, su_squared) } else { [Lanes::ZERO; 2] },
        speed: [su_squared.sqrt(), sv_squared.sqrt()],
    }
}

impl<const N: usize> Evaluated<N> {
    #[inline(always)]
    fn fragment(&self, f: &FaceRecord, face: u32, uv: [f32; 2], span: [usize; 2], i: usize) -> Fragment {
        let regular = eval::is_regular(self.n_squared.0[i], self.squared[0].0[i], self.squared[1].0[i]);
        let mut normal = [0.0; 3];
        let mut curvature = [0.0; 2];
        if regular {
            normal = self.normal.map(|x| x.0[i]);
            curvature = self.curvature.map(|x| x.0[i]);
            if f.flags & REVERSED != 0 {
                normal = normal.map(|x| -x);
                curvature = [-curvature[1], -curvature[0]];
            }
        }
        Fragment {
            face,
            uv,
            span: span.map(|s| s as u32),
            position: self.position.map(|x| x.0[i]),
            normal,
            status: if regular { NormalStatus::Regular } else { NormalStatus::Undefined },
            curvature,
            speed: self.speed.map(|x| x.0[i]),
            edge: None,
        }
    }
}

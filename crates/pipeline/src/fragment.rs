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

/// The tangent plane that a fragment evaluates, in the face's local coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TangentPlane {
    /// Local parameters, clamped to 0 … 1.
    pub uv: [f32; 2],
    /// S.
    pub s: [f32; 3],
    /// S_u.
    pub su: [f32; 3],
    /// S_v.
    pub sv: [f32; 3],
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
    row(scene, f, uv, curvature, out, |lane, uv, span| lane.fragment(f, face, uv, span));
}

/// The tangent planes of fragments of one face: the same numbers as in the program, appended to `out`.
pub fn tangent_planes(scene: &PackedScene, face: u32, uv: &[[f32; 2]], out: &mut Vec<TangentPlane>) {
    let f = &scene.faces[face as usize];
    row(scene, f, uv, false, out, |lane, uv, _| lane.tangent_plane(uv));
}

/// One tangent plane.
pub fn tangent_plane(scene: &PackedScene, face: u32, uv: [f32; 2]) -> TangentPlane {
    let f = &scene.faces[face as usize];
    let uv = clamp(uv);
    specialised::<1>(scene, f, spans(scene, f, uv), [uv], false).lane(0).tangent_plane(uv)
}

/// The knot spans of parameters inside the domain.
fn spans(scene: &PackedScene, f: &FaceRecord, [u, v]: [f32; 2]) -> [usize; 2] {
    let [ku, kv] = scene.knots(f);
    [
        eval::find_span(ku, f.degree_u as usize, f.count_u as usize, f.last_u as usize, u),
        eval::find_span(kv, f.degree_v as usize, f.count_v as usize, f.last_v as usize, v),
    ]
}

/// Evaluates a face at all `uv` and appends what `finish` makes of each.
fn row<T>(
    scene: &PackedScene,
    f: &FaceRecord,
    uv: &[[f32; 2]],
    curvature: bool,
    out: &mut Vec<T>,
    finish: impl Fn(Lane, [f32; 2], [usize; 2]) -> T,
) {
    let [ku, kv] = scene.knots(f);
    let [count, last] = [[f.count_u, f.count_v], [f.last_u, f.last_v]].map(|pair| pair.map(|x| x as usize));
    out.reserve(uv.len());
    let mut rest = uv;
    while let Some(&first) = rest.first() {
        let first = clamp(first);
        let span = spans(scene, f, first);
        let is_alike = |uv: [f32; 2]| {
            let [u, v] = clamp(uv);
            eval::is_on_span(ku, count[0], last[0], span[0], u) && eval::is_on_span(kv, count[1], last[1], span[1], v)
        };
        let run = 1 + rest[1..].iter().take(WIDTH - 1).take_while(|uv| is_alike(**uv)).count();
        let (now, later) = rest.split_at(run);
        if run == 1 {
            let all = specialised::<1>(scene, f, span, [first], curvature);
            out.push(finish(all.lane(0), first, span));
        } else {
            let padded = std::array::from_fn(|i| clamp(now[i.min(run - 1)]));
            let all = specialised::<WIDTH>(scene, f, span, padded, curvature);
            out.extend((0..run).map(|i| finish(all.lane(i), padded[i], span)));
        }
        rest = later;
    }
}

/// Interpolation may leave the domain by a rounding error; the surface ends there.
fn clamp(uv: [f32; 2]) -> [f32; 2] {
    uv.map(|t| t.clamp(0.0, 1.0))
}

/// A specialised program knows its degree; the compiler then unrolls every loop.
fn specialised<const N: usize>(
    scene: &PackedScene,
    f: &FaceRecord,
    span: [usize; 2],
    uv: [[f32; 2]; N],
    curvature: bool,
) -> Evaluated<N> {
    match [f.degree_u, f.degree_v] {
        [3, 3] if curvature => evaluate::<4, N>(scene, f, [3, 3], span, uv, true),
        [3, 3] => evaluate::<4, N>(scene, f, [3, 3], span, uv, false),
        [5, 5] if curvature => evaluate::<6, N>(scene, f, [5, 5], span, uv, true),
        [5, 5] => evaluate::<6, N>(scene, f, [5, 5], span, uv, false),
        [p, q] => evaluate::<MAX_ORDER, N>(scene, f, [p as usize, q as usize], span, uv, curvature),
    }
}

/// The program's values, `N` fragments side by side, before degenerate ones are sorted out.
struct Evaluated<const N: usize> {
    position: Vec3<N>,
    su: Vec3<N>,
    sv: Vec3<N>,
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
        su: d.su,
        sv: d.sv,
        normal: n,
        n_squared,
        squared: [su_squared, sv_squared],
        curvature: if second { eval::curvature(&d, n, su_squared) } else { [Lanes::ZERO; 2] },
        speed: [su_squared.sqrt(), sv_squared.sqrt()],
    }
}

/// The program's values at one fragment.
struct Lane {
    position: [f32; 3],
    su: [f32; 3],
    sv: [f32; 3],
    normal: [f32; 3],
    n_squared: f32,
    squared: [f32; 2],
    curvature: [f32; 2],
    speed: [f32; 2],
}

impl<const N: usize> Evaluated<N> {
    #[inline(always)]
    fn lane(&self, i: usize) -> Lane {
        Lane {
            position: self.position.map(|x| x.0[i]),
            su: self.su.map(|x| x.0[i]),
            sv: self.sv.map(|x| x.0[i]),
            normal: self.normal.map(|x| x.0[i]),
            n_squared: self.n_squared.0[i],
            squared: self.squared.map(|x| x.0[i]),
            curvature: self.curvature.map(|x| x.0[i]),
            speed: self.speed.map(|x| x.0[i]),
        }
    }
}

impl Lane {
    #[inline(always)]
    fn tangent_plane(&self, uv: [f32; 2]) -> TangentPlane {
        TangentPlane { uv, s: self.position, su: self.su, sv: self.sv }
    }

    #[inline(always)]
    fn fragment(&self, f: &FaceRecord, face: u32, uv: [f32; 2], span: [usize; 2]) -> Fragment {
        let regular = eval::is_regular(self.n_squared, self.squared[0], self.squared[1]);
        let mut normal = [0.0; 3];
        let mut curvature = [0.0; 2];
        if regular {
            (normal, curvature) = (self.normal, self.curvature);
            if f.flags & REVERSED != 0 {
                normal = normal.map(|x| -x);
                curvature = [-curvature[1], -curvature[0]];
            }
        }
        Fragment {
            face,
            uv,
            span: span.map(|s| s as u32),
            position: self.position,
            normal,
            status: if regular { NormalStatus::Regular } else { NormalStatus::Undefined },
            curvature,
            speed: self.speed,
            edge: None,
        }
    }
}

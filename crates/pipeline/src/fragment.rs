//! The fragment program: from interpolated (u, v) and a face to what the pixel shows. Twin of `shaders/fragment.wgsl`.

use crate::eval::{self, Basis, Derivatives, Span};
use crate::layout::{FaceRecord, Parameters, REVERSED, SEARCHED};
use crate::packed::PackedScene;
use crate::vector::Vec3;
use lanes::{Kernel, Lanes, Level, run};
use nurbs::{MAX_ORDER, NormalStatus};

/// How many fragments the rasterizer evaluates together.
pub const WIDTH: usize = 8;

/// What a fragment writes, in the face's local coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fragment {
    /// The face.
    pub face: u32,
    /// Parameters local to the span, clamped to 0 … 1.
    pub uv: [f32; 2],
    /// Spans in u and v, counted among those that are not empty.
    pub span: [u32; 2],
    /// S.
    pub position: [f32; 3],
    /// Unit normal of the face; zero where the status is undefined.
    pub normal: [f32; 3],
    /// [`NormalStatus::Regular`] or [`NormalStatus::Undefined`]: limits are left to f64.
    pub status: NormalStatus,
    /// Principal curvatures in local units, greater first; zero unless asked for and regular.
    pub curvature: [f32; 2],
    /// |S_u| and |S_v| in local units, by the span's parameters, times the span's gains.
    pub speed: [f32; 2],
    /// From the pixel's centre to the face's nearest trim edge, pixels, right and down; not set by the program itself,
    /// which knows of no picture, but by [`crate::edge`].
    pub edge: Option<[f32; 2]>,
}

/// The tangent plane that a fragment evaluates, in the face's local coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TangentPlane {
    /// Parameters of the whole domain, 0 … 1, inside it.
    pub uv: [f32; 2],
    /// Whether the fragment's parameters were beyond the domain: it is on a skirt.
    pub on_skirt: bool,
    /// S.
    pub s: [f32; 3],
    /// S_u, by the parameter of the whole domain.
    pub su: [f32; 3],
    /// S_v.
    pub sv: [f32; 3],
}

/// Runs the program for one fragment.
pub fn fragment(scene: &PackedScene, face: u32, at: Parameters, curvature: bool) -> Fragment {
    let mut out = Vec::with_capacity(1);
    fragment_row(scene, face, &[at], curvature, &mut out);
    out[0]
}

/// Runs the program for fragments of one face and appends them to `out`. Up to [`WIDTH`] that follow each other on the
/// same spans go together; the answers are the same, to the bit, however they fall into groups.
pub fn fragment_row(scene: &PackedScene, face: u32, at: &[Parameters], curvature: bool, out: &mut Vec<Fragment>) {
    row_at(Level::new(), scene, face, at, curvature, out);
}

fn row_at(level: Level, scene: &PackedScene, face: u32, at: &[Parameters], curvature: bool, out: &mut Vec<Fragment>) {
    let f = &scene.faces()[face as usize];
    row(level, scene, f, at, curvature, out, |lane, at, _| lane.fragment(f, face, at));
}

/// The tangent planes of fragments of one face: the same numbers as in the program, appended to `out`.
pub fn tangent_planes(scene: &PackedScene, face: u32, at: &[Parameters], out: &mut Vec<TangentPlane>) {
    let f = &scene.faces()[face as usize];
    let mut k = 0;
    row(Level::new(), scene, f, at, false, out, |lane, found, spans| {
        k += 1;
        lane.tangent_plane(found, is_on_skirt(f, at[k - 1]), spans)
    });
}

/// One tangent plane.
pub fn tangent_plane(scene: &PackedScene, face: u32, at: Parameters) -> TangentPlane {
    let f = &scene.faces()[face as usize];
    let found = found(scene, f, at);
    let spans = scene.spans(f, found.span);
    let evaluated = Specialised { scene, f, spans: &spans, uv: [found.uv], curvature: false }.run();
    evaluated.lane(0).tangent_plane(found, is_on_skirt(f, at), &spans)
}

/// Whether parameters are beyond the domain.
#[inline(always)]
pub fn is_on_skirt(f: &FaceRecord, Parameters { span, uv }: Parameters) -> bool {
    let last = [f.spans_u - 1, f.spans_v - 1];
    (0..2).any(|k| (uv[k] < 0.0 && span[k] == 0) || (uv[k] > 1.0 && span[k] == last[k]))
}

/// The spans and the parameters on them, inside 0 … 1: interpolation may leave a span by a rounding error.
#[inline(always)]
fn found(scene: &PackedScene, f: &FaceRecord, at: Parameters) -> Parameters {
    let uv = at.uv.map(|t| t.clamp(0.0, 1.0));
    if at.span[0] != SEARCHED {
        return Parameters { uv, ..at };
    }
    let starts = scene.starts(f);
    let span = [0, 1].map(|k| eval::find_span(starts[k], uv[k]) as u32);
    let spans = scene.spans(f, span);
    Parameters { span, uv: [0, 1].map(|k| spans[k].local(uv[k])) }
}

/// Evaluates a face at all places and appends what `finish` makes of each.
fn row<T>(
    level: Level,
    scene: &PackedScene,
    f: &FaceRecord,
    at: &[Parameters],
    curvature: bool,
    out: &mut Vec<T>,
    mut finish: impl FnMut(Lane, Parameters, &[Span; 2]) -> T,
) {
    out.reserve(at.len());
    let mut waiting = [Parameters { span: [0; 2], uv: [0.0; 2] }; WIDTH];
    let mut rest = at;
    while !rest.is_empty() {
        let mut count = 0;
        while count < rest.len().min(WIDTH) {
            let next = found(scene, f, rest[count]);
            if count > 0 && next.span != waiting[0].span {
                break;
            }
            waiting[count] = next;
            count += 1;
        }
        let spans = scene.spans(f, waiting[0].span);
        if count == 1 {
            let all = Specialised { scene, f, spans: &spans, uv: [waiting[0].uv], curvature }.run();
            out.push(finish(all.lane(0), waiting[0], &spans));
        } else {
            // The last stands in for those that are missing.
            let uv: [[f32; 2]; WIDTH] = std::array::from_fn(|i| waiting[i.min(count - 1)].uv);
            let all = run(level, Specialised { scene, f, spans: &spans, uv, curvature });
            out.extend((0..count).map(|i| finish(all.lane(i), waiting[i], &spans)));
        }
        rest = &rest[count..];
    }
}

/// The program at `N` places on one pair of spans. Of a degree that the compiler knows it unrolls every loop.
struct Specialised<'a, const N: usize> {
    scene: &'a PackedScene,
    f: &'a FaceRecord,
    spans: &'a [Span<'a>; 2],
    uv: [[f32; 2]; N],
    curvature: bool,
}

impl<const N: usize> Kernel for Specialised<'_, N> {
    type Output = Evaluated<N>;

    #[inline(always)]
    fn run(self) -> Evaluated<N> {
        let Self { scene, f, spans, uv, curvature } = self;
        match [f.degree_u, f.degree_v] {
            [3, 3] if curvature => evaluate::<4, N>(scene, f, [3, 3], spans, uv, true),
            [3, 3] => evaluate::<4, N>(scene, f, [3, 3], spans, uv, false),
            [5, 5] if curvature => evaluate::<6, N>(scene, f, [5, 5], spans, uv, true),
            [5, 5] => evaluate::<6, N>(scene, f, [5, 5], spans, uv, false),
            [p, q] => evaluate::<MAX_ORDER, N>(scene, f, [p as usize, q as usize], spans, uv, curvature),
        }
    }
}

/// The program's values, `N` fragments side by side, before degenerate ones are sorted out.
struct Evaluated<const N: usize> {
    position: Vec3<N>,
    su: Vec3<N>,
    sv: Vec3<N>,
    normal: Vec3<N>,
    n_squared: Lanes<f32, N>,
    squared: [Lanes<f32, N>; 2],
    curvature: [Lanes<f32, N>; 2],
    speed: [Lanes<f32, N>; 2],
}

#[inline(always)]
fn evaluate<const CAPACITY: usize, const N: usize>(
    scene: &PackedScene,
    f: &FaceRecord,
    degree: [usize; 2],
    spans: &[Span; 2],
    uv: [[f32; 2]; N],
    second: bool,
) -> Evaluated<N> {
    let u = Lanes(uv.map(|uv| uv[0]));
    let v = Lanes(uv.map(|uv| uv[1]));
    let [span_u, span_v] = spans;
    let nu: Basis<CAPACITY, N> = eval::basis(span_u.knots, degree[0], u, span_u.gain, second);
    let nv: Basis<CAPACITY, N> = eval::basis(span_v.knots, degree[1], v, span_v.gain, second);
    let d: Derivatives<N> = eval::surface(f, degree, scene.points(), [span_u.first, span_v.first], &nu, &nv, second);
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
        curvature: if second { eval::curvature(&d, n, su_squared) } else { [Lanes::<f32, N>::ZERO; 2] },
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
    fn tangent_plane(&self, at: Parameters, on_skirt: bool, spans: &[Span; 2]) -> TangentPlane {
        TangentPlane {
            uv: [0, 1].map(|k| spans[k].whole(at.uv[k])),
            on_skirt,
            s: self.position,
            su: self.su.map(|x| x * spans[0].per_whole),
            sv: self.sv.map(|x| x * spans[1].per_whole),
        }
    }

    #[inline(always)]
    fn fragment(&self, f: &FaceRecord, face: u32, at: Parameters) -> Fragment {
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
            uv: at.uv,
            span: at.span,
            position: self.position,
            normal,
            status: if regular { NormalStatus::Regular } else { NormalStatus::Undefined },
            curvature,
            speed: self.speed,
            edge: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scheme;
    use lanes::levels;

    /// As numbers that tell zeros of either sign and NaNs apart.
    fn bits(fragment: &Fragment) -> [u32; 17] {
        let Fragment { face, uv, span, position, normal, status, curvature, speed, edge } = *fragment;
        assert_eq!(edge, None);
        let reals = uv.into_iter().chain(position).chain(normal).chain(curvature).chain(speed).map(f32::to_bits);
        let all: Vec<u32> = reals.chain([face, span[0], span[1], status as u32, 0]).collect();
        all.try_into().expect("seventeen")
    }

    #[test]
    fn every_width_gives_the_bits_of_one_fragment() {
        let mut tried = 0;
        for name in ["rational", "teapot", "petal", "cone", "degree-5x5", "degree-2x8"] {
            let model = models::builtin(name).expect("built in");
            for scheme in [Scheme::General, Scheme::Specialised] {
                let scene = PackedScene::new(&model, scheme).expect("packs");
                for (id, face) in scene.faces().iter().enumerate().take(6) {
                    // Runs of one to twenty on a span; corners, and parameters beyond them.
                    let place = |i: usize| Parameters {
                        span: [(i / 20) as u32 % face.spans_u, (i / 19) as u32 % face.spans_v],
                        uv: [(i as f32 * 0.618034).fract() * 1.2 - 0.1, (i as f32 * 0.754878).fract() * 1.2 - 0.1],
                    };
                    let places: Vec<Parameters> = (0..97).map(place).collect();
                    for curvature in [false, true] {
                        let alone: Vec<_> =
                            places.iter().map(|&at| bits(&fragment(&scene, id as u32, at, curvature))).collect();
                        for level in levels() {
                            let mut together = vec![];
                            row_at(level, &scene, id as u32, &places, curvature, &mut together);
                            assert_eq!(together.iter().map(bits).collect::<Vec<_>>(), alone, "{name}, {level:?}");
                            tried += together.len();
                        }
                    }
                }
            }
        }
        assert!(tried > 10_000, "{tried}");
    }
}

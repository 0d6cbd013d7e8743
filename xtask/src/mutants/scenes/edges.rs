//! Models whose trim edges are recorded: in the whole picture of a model, where the surface turns away, where the centres of
//! pixels lie on edges, so near that an edge is thousands of pixels long, where spans are unlike, and behind the eye.

use super::joints;
use super::made::{builtin, cylinder, joined, orthographic, raised};
use crate::mutants::shown::{Shown, framed};
use glam::{DVec2, DVec3, dvec2};
use isophote::stage::Plan;
use nurbs::{KnotVector, Surface};
use pipeline::Scheme;
use scene::{Camera, Face, Loop, Model, Projection, Trim, Viewport};
use std::f64::consts::FRAC_PI_3;

/// What shows where trim edges pass by.
pub(super) fn edges() -> Vec<Shown> {
    let recorded = |shown: Shown| Shown { plan: Plan { edges: true, ..shown.plan }, ..shown };
    let of = |name, model: Model| recorded(framed(name, model, Scheme::General));
    let whole = |name, model: &str| of(name, builtin(model));
    let turning = |name, model: Model, eye: [f64; 3]| {
        let shown = of(name, model);
        let eye = shown.model.hull().center() + shown.model.hull().diagonal() * DVec3::from_array(eye);
        let projection = Projection::Perspective { fov_deg: 40.0 };
        let camera = Camera::look_at(eye, shown.model.hull().center(), DVec3::Z, projection).expect("legal");
        Shown { camera, ..shown }
    };
    let near = |name, model: &str, [u, v]: [f64; 2], height| {
        let shown = whole(name, model);
        let at = shown.model.surfaces()[0].first_derivatives(u, v);
        let normal = at.su.cross(at.sv).normalize();
        let projection = Projection::Orthographic { height };
        let camera = Camera::look_at(at.s + normal, at.s, DVec3::new(0.36, 0.48, 0.8), projection).expect("legal");
        Shown { camera, ..shown }
    };
    let looking = |name, model: Model, eye: DVec3, toward: DVec3, projection| {
        let camera = Camera::look_at(eye, eye + toward, DVec3::new(0.0, 0.6, 0.8), projection).expect("legal");
        Shown { camera, ..of(name, model) }
    };
    let bent = joints::joints().pop().expect("the last is bent");
    let through_centres = |name, shown| recorded(Shown { name, fills: false, ..shown });
    // On the porthole's ellipse about (0.78, 0.5), a sixth of the way round.
    let (sine, cosine) = FRAC_PI_3.sin_cos();
    let porthole = [0.78 + 0.05 * cosine, 0.5 + 0.11 * sine];
    vec![
        whole("edges of islands", "islands"),
        // No square: what belongs to one side of the picture is not right for the other.
        Shown {
            viewport: Viewport::new(48, 32).expect("a legal size"),
            ..orthographic(whole("edges of a word", "text"))
        },
        whole("edges by a seam", "window"),
        of("edges beside a whole face", joined(&builtin("cusp"), &cylinder())),
        turning("edges where the surface turns away", builtin("window"), [0.9, 0.1, 0.1]),
        turning("edges on waves of degrees 3 and 4", raised(builtin("islands")), [0.6, 0.2, 0.1]),
        through_centres("edges through centres", bent),
        through_centres("edges through centres, level and upright", joints::joints_along_parameters()),
        near("edges near by", "window", porthole, 0.02),
        near("an edge of thousands of pixels", "window", porthole, 0.001),
        looking(
            "edges across a short span",
            across_a_short_span(),
            DVec3::Z,
            DVec3::NEG_Z,
            Projection::Orthographic { height: 0.25 },
        ),
        looking(
            "an edge behind the eye",
            below_the_eye(),
            0.01 * DVec3::Z,
            DVec3::Y,
            Projection::Perspective { fov_deg: 90.0 },
        ),
    ]
}

/// A square over [−1/2, 1/2]² with a hole, whose border crosses a span that is short along u alone: derivatives by its
/// parameter are packed 16 times as large as by that of v.
fn across_a_short_span() -> Model {
    const SHORT: f64 = 1.0 / 64.0;
    let u = [0.0, 0.0, 0.0, 0.5 - SHORT, 0.5, 1.0, 1.0, 1.0];
    let v = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let mean = |knots: &[f64], i: usize| 0.5 * (knots[i + 1] + knots[i + 2]) - 0.5;
    let points = (0..15).map(|k| DVec3::new(mean(&u, k / 3), mean(&v, k % 3), 0.0)).collect();
    let hole = [[0.45, 0.47], [0.5, 0.56], [0.54, 0.52], [0.52, 0.45]].map(DVec2::from_array);
    bounded("short span", [u.to_vec(), v.to_vec()], [2, 2], points, &[&UNIT, &hole])
}

/// A sheet z = bend · y² for y > 0 that goes on level behind the eye. As a pixel a little below the horizon has it, which
/// takes the picture to be affine, the sheet's hind end is near; and so is where its picture would be, were it seen.
fn below_the_eye() -> Model {
    const BEND: f64 = 0.0102;
    let [behind, ahead, aside] = [0.6, 8.0, 4.0];
    let start = behind / (behind + ahead);
    let u = vec![0.0, 0.0, 0.0, start, 1.0, 1.0, 1.0];
    let v = vec![0.0, 0.0, 1.0, 1.0];
    let rows = [(-behind, 0.0), (-0.5 * behind, 0.0), (0.5 * ahead, 0.0), (ahead, BEND * ahead * ahead)];
    let points = rows.into_iter().flat_map(|(y, z)| [aside, -aside].map(|x| DVec3::new(x, y, z))).collect();
    bounded("sheet", [u, v], [2, 1], points, &[&UNIT])
}

/// The corners of all parameters, counterclockwise.
const UNIT: [DVec2; 4] = [DVec2::ZERO, dvec2(1.0, 0.0), DVec2::ONE, dvec2(0.0, 1.0)];

/// A face of one surface inside a polygon and outside others.
fn bounded(name: &str, knots: [Vec<f64>; 2], degrees: [usize; 2], points: Vec<DVec3>, polygons: &[&[DVec2]]) -> Model {
    let [ku, kv] = knots;
    let [u, v] = [(ku, degrees[0]), (kv, degrees[1])].map(|(knots, p)| KnotVector::new(p, knots).expect("legal"));
    let surface = Surface::new(u, v, points, None).expect("legal");
    let line =
        |ends: [DVec2; 2]| Trim::new(KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal"), ends.to_vec(), None);
    let polygon = |(index, corners): (usize, &&[DVec2])| {
        let next = corners.iter().cycle().skip(1);
        Loop { outer: index == 0, trims: corners.iter().zip(next).map(|(&a, &b)| line([a, b])).collect() }
    };
    let loops = polygons.iter().enumerate().map(polygon).collect();
    Model::new(name, vec![surface], vec![Face { loops, ..Face::whole(0) }]).expect("legal")
}

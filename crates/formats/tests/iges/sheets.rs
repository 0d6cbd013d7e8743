//! Small surfaces and trimmed surfaces whose area has a closed form.

use crate::closed::{Case, open, turned};
use crate::writer::{INDEPENDENT, Writer, list};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// All of them.
pub fn cases() -> Vec<Case> {
    vec![
        paraboloid(),
        parametric_curve(),
        lemon(),
        prism(),
        periodic(),
        holes(),
        bounded(),
        cubic(),
        ruled(),
        frustum(),
        offset(),
        offset_prism(),
        offset_curves(),
        offset_conics(),
        copious(),
        part_of_domain(),
    ]
}

fn z_axis(w: &mut Writer) -> usize {
    w.line([0.0; 3], [0.0, 0.0, 1.0])
}

/// A matrix that lifts the plane of x and y to that of x and z.
fn lifted(w: &mut Writer) -> usize {
    w.matrix([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0]])
}

/// A parabola (104) z = x² turned about z, and a lid that is a plane (108) within a circle.
fn paraboloid() -> Case {
    let h = 4.0f64;
    let mut w = Writer::new();
    let matrix = lifted(&mut w);
    let curve = w.numbers(104, 3, &[1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 4.0]);
    w.set_matrix(curve, matrix);
    let line = z_axis(&mut w);
    let surface = w.add(120, 0, &format!("{line},{curve},0.0,{TAU:?}"));
    w.set_status(surface, INDEPENDENT);
    let circle = w.circle(h, 2.0, [1.0, 1.0]);
    let lid = w.add(108, 1, &format!("0.0,0.0,1.0,{h:?},{circle},0.0,0.0,0.0,0.0"));
    w.set_status(lid, INDEPENDENT);
    open("paraboloid", &w, 2, PI / 6.0 * ((1.0 + 4.0 * h).powf(1.5) - 1.0) + PI * h)
}

/// What is between a parametric spline curve (112), y = x² from −1 to 1 in two pieces, and a line.
fn parametric_curve() -> Case {
    let mut w = Writer::new();
    let cubic = |a: f64, b: f64, c: f64| [a, b, c, 0.0];
    let pieces =
        [cubic(-1.0, 1.0, 0.0), cubic(1.0, -2.0, 1.0), [0.0; 4], cubic(0.0, 1.0, 0.0), cubic(0.0, 0.0, 1.0), [0.0; 4]];
    // The ends' derivatives follow.
    let curve = w.add(112, 0, &format!("3,1,2,2,0.0,1.0,2.0,{},{}", list(&pieces.concat()), list(&[0.0; 12])));
    let line = w.line([1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]);
    let border = w.composite(&[curve, line]);
    let plane = w.add(108, 1, &format!("0.0,0.0,2.0,0.0,{border},0.0,0.0,0.0,0.0"));
    w.set_status(plane, INDEPENDENT);
    open("parametric-curve", &w, 1, 4.0 / 3.0)
}

/// An arc turned about a chord of its circle: a lemon, closed at both poles.
fn lemon() -> Case {
    let mut w = Writer::new();
    let matrix = lifted(&mut w);
    // About (−1, 0) with radius 2, from below to above, on the right of the axis.
    let end = 3f64.sqrt();
    let arc = w.numbers(100, 0, &[0.0, -1.0, 0.0, 0.0, -end, 0.0, end]);
    w.set_matrix(arc, matrix);
    let line = z_axis(&mut w);
    let surface = w.add(120, 0, &format!("{line},{arc},0.0,{TAU:?}"));
    w.set_status(surface, INDEPENDENT);
    open("spindle-lemon", &w, 1, turned(-1.0, 2.0).0)
}

/// The corners of a closed uniform quadratic, and the length and the area of what it encloses: straight arcs of length 2, and
/// parabolas of control points (1, 0), (0, 0), (0, 1).
const CORNERS: [[f64; 2]; 8] =
    [[2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [-2.0, 2.0], [-2.0, 0.0], [-2.0, -2.0], [0.0, -2.0], [2.0, -2.0]];

fn closed_length() -> f64 {
    4.0 * 2.0 + 4.0 * (1.0 + (1.0 + 2f64.sqrt()).ln() / 2f64.sqrt())
}

/// An unclamped periodic spline (126) pulled along z: a tabulated cylinder that stands by itself.
fn prism() -> Case {
    let height = 3.0;
    let mut w = Writer::new();
    let knots: Vec<f64> = (0..13).map(|k| f64::from(k) - 2.0).collect();
    let points: Vec<f64> = (0..10).flat_map(|k| [CORNERS[k % 8][0], CORNERS[k % 8][1], 0.0]).collect();
    let curve = w.add(
        126,
        0,
        &format!("9,2,1,1,1,1,{},{},{},0.0,8.0,0.0,0.0,1.0", list(&knots), list(&[1.0; 10]), list(&points)),
    );
    let surface = w.add(122, 0, &format!("{curve},2.0,1.0,{height:?}"));
    w.set_status(surface, INDEPENDENT);
    open("periodic-prism", &w, 1, closed_length() * height)
}

/// The same wall as an unclamped periodic surface (128), with a hole across its seam.
fn periodic() -> Case {
    let height = 3.0;
    let mut w = Writer::new();
    let knots: Vec<f64> = (0..13).map(|k| f64::from(k) - 2.0).collect();
    let points: Vec<f64> = [0.0, height]
        .iter()
        .flat_map(|z| (0..10).flat_map(move |k| [CORNERS[k % 8][0], CORNERS[k % 8][1], *z]))
        .collect();
    let surface = w.add(
        128,
        0,
        &format!(
            "9,1,2,1,1,0,1,1,0,{},0.0,0.0,1.0,1.0,{},{},0.0,8.0,0.0,1.0",
            list(&knots),
            list(&[1.0; 20]),
            list(&points)
        ),
    );
    // Beside u = 8 the section is straight, 2 long from u = 7.5 to 8.5 by symmetry: a rectangle there is 2 Δu by 3 Δv.
    let corners = [[7.75, 0.25], [7.75, 0.75], [8.0, 0.75], [8.0, 0.25]].map(|[u, v]| [u, v, 0.0]);
    let sides: Vec<usize> = (0..4).map(|k| w.line(corners[k], corners[(k + 1) % 4])).collect();
    let boundary = w.composite(&sides);
    let hole = w.on_surface(surface, boundary, 0);
    w.trimmed(surface, 0, &[hole]);
    let x = 0.25;
    // The straight part is run at a speed that falls and rises: by the quadratic's own points.
    let place = |u: f64| quadratic(u);
    let width = place(8.0).0 - place(8.0 - x).0;
    open("periodic-hole", &w, 1, closed_length() * height - width.abs() * 0.5 * height)
}

/// y of the closed uniform quadratic in its last span, u from 7 to 8, where x is 2 at its end: length along it from u to 8.
fn quadratic(u: f64) -> (f64, f64) {
    // Control points 7, 8 and 9 of the ten: (2, −2), (2, 0), (2, 2).
    let t = u - 7.0;
    let basis = [0.5 * (1.0 - t) * (1.0 - t), 0.5 + t - t * t, 0.5 * t * t];
    let y = basis[0] * -2.0 + basis[2] * 2.0;
    (y, 2.0)
}

/// A bilinear square of side 10 in [0, 1]² with a corner cut off, a round hole (100 in (u, v)), and a square hole of a spline.
fn holes() -> Case {
    let mut w = Writer::new();
    let surface = square(&mut w);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 1.0]].map(|[u, v]| [u, v, 0.0]);
    let sides: Vec<usize> = (0..5).map(|k| w.line(corners[k], corners[(k + 1) % 5])).collect();
    let border = w.composite(&sides);
    let outer = w.on_surface(surface, border, 0);
    let circle = w.numbers(100, 0, &[0.0, 0.25, 0.25, 0.35, 0.25, 0.35, 0.25]);
    let round = w.on_surface(surface, circle, 0);
    let diamond = [[0.6, 0.5], [0.7, 0.4], [0.6, 0.3], [0.5, 0.4], [0.6, 0.5]].map(|[u, v]| [u, v, 0.0]);
    let spline = w.add(
        126,
        0,
        &format!(
            "4,1,1,1,1,0,0.0,0.0,1.0,2.0,3.0,4.0,4.0,{},{},0.0,4.0,0.0,0.0,1.0",
            list(&[1.0; 5]),
            list(&diamond.concat())
        ),
    );
    let square = w.on_surface(surface, spline, 0);
    w.trimmed(surface, outer, &[round, square]);
    open("holes", &w, 1, 100.0 * (1.0 - 0.125 - PI * 0.01 - 0.02))
}

/// The square from (0, 0) to (10, 10), (u, v) from 0 to 1.
fn square(w: &mut Writer) -> usize {
    let points = [[0.0, 0.0], [10.0, 0.0], [0.0, 10.0], [10.0, 10.0]].map(|[x, y]| [x, y, 0.0]);
    let ends = "0.0,0.0,1.0,1.0,0.0,0.0,1.0,1.0";
    w.add(128, 0, &format!("1,1,1,1,0,0,1,0,0,{ends},{},{},0.0,1.0,0.0,1.0", list(&[1.0; 4]), list(&points.concat())))
}

/// The square as a bounded surface (143) by a boundary (141) in space, of arcs and lines, one of them run backwards.
fn bounded() -> Case {
    let mut w = Writer::new();
    let surface = square(&mut w);
    // A stadium: two half circles of radius 2 about (3, 5) and (7, 5).
    let right = w.numbers(100, 0, &[0.0, 7.0, 5.0, 7.0, 3.0, 7.0, 7.0]);
    let left = w.numbers(100, 0, &[0.0, 3.0, 5.0, 3.0, 7.0, 3.0, 3.0]);
    let (top, bottom) = (w.line([3.0, 7.0, 0.0], [7.0, 7.0, 0.0]), w.line([3.0, 3.0, 0.0], [7.0, 3.0, 0.0]));
    let boundary = w.add(141, 0, &format!("0,0,{surface},4,{bottom},1,0,{right},1,0,{top},2,0,{left},1,0"));
    let face = w.add(143, 0, &format!("0,{surface},1,{boundary}"));
    w.set_status(face, INDEPENDENT);
    open("bounded", &w, 1, 16.0 + 4.0 * PI)
}

/// A parametric spline surface (114) of two pieces, x = s + s², y = t, z = 0, each in its own s.
fn cubic() -> Case {
    let mut w = Writer::new();
    let piece = |x0: f64, slope: f64| {
        let mut values = vec![0.0; 48];
        (values[0], values[1], values[2]) = (x0, slope, 1.0);
        values[16 + 4] = 1.0;
        values
    };
    // The standard asks for a row and a column more, of any numbers.
    let rows = [piece(0.0, 1.0), vec![9.0; 48], piece(2.0, 3.0), vec![9.0; 48], vec![9.0; 96]].concat();
    let surface = w.add(114, 0, &format!("3,1,2,1,0.0,1.0,2.0,0.0,1.0,{}", list(&rows)));
    w.set_status(surface, INDEPENDENT);
    open("parametric-spline", &w, 1, 6.0)
}

/// A ruled surface (118) between two lines, the second run backwards: a flat trapezoid.
fn ruled() -> Case {
    let mut w = Writer::new();
    let (a, b) = (w.line([0.0; 3], [4.0, 0.0, 0.0]), w.line([3.0, 2.0, 0.0], [1.0, 2.0, 0.0]));
    let surface = w.add(118, 1, &format!("{a},{b},1,1"));
    w.set_status(surface, INDEPENDENT);
    open("ruled-lines", &w, 1, 6.0)
}

/// A ruled surface between two circles: the wall of a frustum.
fn frustum() -> Case {
    let mut w = Writer::new();
    let (a, b) = (w.circle(0.0, 2.0, [0.5, 0.5]), w.circle(3.0, 1.0, [0.5, 0.5]));
    let surface = w.add(118, 0, &format!("{a},{b},0,1"));
    w.set_status(surface, INDEPENDENT);
    open("ruled-circles", &w, 1, PI * 3.0 * 1f64.hypot(3.0))
}

/// A sphere pushed inward by half (140): in the middle of its parameters, at (−2, 0, 0), the indicator points inward.
fn offset() -> Case {
    let mut w = Writer::new();
    let center = w.point([0.0; 3]);
    let sphere = w.add(196, 0, &format!("{center},2.0"));
    let surface = w.add(140, 0, &format!("1.0,0.0,0.0,0.5,{sphere}"));
    w.set_status(surface, INDEPENDENT);
    open("offset-sphere", &w, 1, 4.0 * PI * 1.5 * 1.5)
}

/// The wall of `periodic` without its hole, and a lid, half a unit outside of it: a surface (140) beside a spline, and a curve
/// (130) beside one. The length grows by 2 π d, the area by the length times d and π d² (Steiner).
fn offset_prism() -> Case {
    let (d, height) = (0.5, 3.0);
    let mut w = Writer::new();
    let knots: Vec<f64> = (0..13).map(|k| f64::from(k) - 2.0).collect();
    let at = |z: f64| (0..10).flat_map(move |k| [CORNERS[k % 8][0], CORNERS[k % 8][1], z]);
    let points: Vec<f64> = at(0.0).chain(at(height)).collect();
    let ends = "0.0,8.0,0.0,1.0";
    let wall =
        format!("9,1,2,1,1,0,1,1,0,{},0.0,0.0,1.0,1.0,{},{},{ends}", list(&knots), list(&[1.0; 20]), list(&points));
    let wall = w.add(128, 0, &wall);
    let wall = w.add(140, 0, &format!("-1.0,0.0,0.0,{d:?},{wall}"));
    w.set_status(wall, INDEPENDENT);
    let points: Vec<f64> = at(0.0).collect();
    let curve = format!("9,2,1,1,1,1,{},{},{},0.0,8.0,0.0,0.0,1.0", list(&knots), list(&[1.0; 10]), list(&points));
    let curve = w.add(126, 0, &curve);
    let beside = w.add(130, 0, &format!("{curve},1,0,0,0,{d:?},0.0,0.0,0.0,0.0,0.0,-1.0,0.0,8.0"));
    let lid = w.add(108, 1, &format!("0.0,0.0,1.0,0.0,{beside},0.0,0.0,0.0,0.0"));
    w.set_status(lid, INDEPENDENT);
    let section = 14.0 + 4.0 / 3.0;
    let lid = section + closed_length() * d + PI * d * d;
    open("offset-prism", &w, 2, (closed_length() + 2.0 * PI * d) * height + lid)
}

/// Planes within curves (130) beside arcs and lines: a disc, and a trapezoid of which two sides
/// are beside a line, one of them at a distance that changes from 1 to 3.
fn offset_curves() -> Case {
    let mut w = Writer::new();
    let arc = w.circle(0.0, 2.0, [0.0, 0.0]);
    // Inward is the tangent's left hand, +z × T.
    let inner = w.add(130, 0, &format!("{arc},1,0,0,0,0.5,0.0,0.0,0.0,0.0,0.0,1.0,0.0,{TAU:?}"));
    let disc = w.add(108, 1, &format!("0.0,0.0,1.0,0.0,{inner},0.0,0.0,0.0,0.0"));
    w.set_status(disc, INDEPENDENT);
    let base = w.line([0.0, 0.0, 1.0], [4.0, 0.0, 1.0]);
    let beside = w.add(130, 0, &format!("{base},2,0,0,2,1.0,0.0,3.0,1.0,0.0,0.0,1.0,0.0,1.0"));
    let sides = [[[0.0, 0.0], [0.0, 1.0]], [[4.0, 3.0], [4.0, 0.0]], [[4.0, 0.0], [0.0, 0.0]]];
    let [left, right, below] = sides.map(|side| {
        let [a, b] = side.map(|[x, y]| [x, y, 1.0]);
        w.line(a, b)
    });
    let border = w.composite(&[left, beside, right, below]);
    let plane = w.add(108, 1, &format!("0.0,0.0,1.0,1.0,{border},0.0,0.0,0.0,0.0"));
    w.set_status(plane, INDEPENDENT);
    open("offset-curves", &w, 2, PI * 1.5 * 1.5 + 8.0)
}

/// What is between a conic (104) and a curve (130) half a unit outside of it, for the parabola y = x² and the hyperbola x² − y² = 1; and a
/// surface (140) beside a parabola that is pulled (122). What is between is the length times d and θ d² / 2, θ being how far the
/// curve turns (Steiner).
fn offset_conics() -> Case {
    /// The plane between a curve, which is there in both directions, and one beside it; `ends` are the first points of both, and the last.
    fn between(w: &mut Writer, [there, back]: [usize; 2], side: f64, limit: f64, ends: [[[f64; 2]; 2]; 2]) {
        let beside = format!("{there},1,0,0,0,0.5,0.0,0.0,0.0,0.0,0.0,{side:?},{:?},{limit:?}", -limit);
        let beside = w.add(130, 0, &beside);
        let [[first, first_beside], [last, last_beside]] = ends.map(|pair| pair.map(|[x, y]| [x, y, 0.0]));
        let (home, out) = (w.line(last_beside, last), w.line(first, first_beside));
        let border = w.composite(&[beside, home, back, out]);
        let plane = w.add(108, 1, &format!("0.0,0.0,1.0,0.0,{border},0.0,0.0,0.0,0.0"));
        w.set_status(plane, INDEPENDENT);
    }
    let (d, height) = (0.5, 3.0);
    let mut w = Writer::new();
    let parabola = [[-1.0, 1.0], [1.0, -1.0]]
        .map(|[a, b]: [f64; 2]| w.numbers(104, 3, &[1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, a, a * a, b, b * b]));
    let x = 2f64.sqrt();
    let hyperbola = [-1.0, 1.0].map(|y| w.numbers(104, 2, &[1.0, 0.0, -1.0, 0.0, 0.0, -1.0, 0.0, x, y, x, -y]));
    // Outward at (1, 1) is (2, −1) / √5, and at (√2, 1) it is (−√2, 1) / √3.
    let [right, down] = [2.0, -1.0].map(|part| d * part / 5f64.sqrt());
    between(&mut w, parabola, -1.0, 1.0, [-1.0, 1.0].map(|s| [[s, 1.0], [s * (1.0 + right), 1.0 + down]]));
    let [left, up] = [-x, 1.0].map(|part| d * part / 3f64.sqrt());
    between(&mut w, hyperbola, 1.0, FRAC_PI_4, [-1.0, 1.0].map(|s| [[x, s], [x + left, s * (1.0 + up)]]));
    let wall = w.add(122, 0, &format!("{},-1.0,1.0,{height:?}", parabola[0]));
    let wall = w.add(140, 0, &format!("0.0,-1.0,0.0,{d:?},{wall}"));
    w.set_status(wall, INDEPENDENT);
    let (length, turned) = (5f64.sqrt() + 0.5 * 2f64.asinh(), 2.0 * 2f64.atan());
    // The hyperbola is (cosh t, sinh t), of speed √(cosh 2t), up to t = asinh 1; by Simpson's rule.
    let (end, steps) = (1f64.asinh(), 1000);
    let speed = |k: u32| (2.0 * end * f64::from(k) / f64::from(steps)).cosh().sqrt();
    let weight = |k: u32| if k == 0 || k == steps { 1.0 } else { f64::from(2 + k % 2 * 2) };
    let hyperbola = 2.0 * end / f64::from(3 * steps) * (0..=steps).map(|k| weight(k) * speed(k)).sum::<f64>();
    let bent = 2.0 * 2f64.sqrt().recip().atan();
    let planes = d * (length + 0.5 * d * turned) + d * (hyperbola + 0.5 * d * bent);
    open("offset-conics", &w, 3, planes + (length + d * turned) * height)
}

/// Polygons of copious data (106): on a plane in space, and in (u, v).
fn copious() -> Case {
    let mut w = Writer::new();
    let triangle = w.add(106, 63, "1,4,2.0,0.0,0.0,3.0,0.0,0.0,4.0,0.0,0.0");
    let plane = w.add(108, 1, &format!("0.0,0.0,1.0,2.0,{triangle},0.0,0.0,0.0,0.0"));
    w.set_status(plane, INDEPENDENT);
    let surface = square(&mut w);
    let polygon = w.add(106, 12, "2,4,0.1,0.1,0.0,0.5,0.1,0.0,0.1,0.5,0.0,0.1,0.1,0.0");
    let outer = w.on_surface(surface, polygon, 0);
    w.trimmed(surface, outer, &[]);
    open("copious", &w, 2, 6.0 + 8.0)
}

/// A surface over less than its knots, u from 0.25 to 0.5 and v from 0 to 0.5; another hides.
fn part_of_domain() -> Case {
    let mut w = Writer::new();
    let surface = square(&mut w);
    let points = [[0.0, 0.0], [10.0, 0.0], [0.0, 10.0], [10.0, 10.0]].map(|[x, y]| [x, y, 0.0]);
    let ends = "0.0,0.0,1.0,1.0,0.0,0.0,1.0,1.0";
    let text = format!("1,1,1,1,0,0,1,0,0,{ends},{},{},0.25,0.5,0.0,0.5", list(&[1.0; 4]), list(&points.concat()));
    w.set_parameters(surface, &text);
    w.set_status(surface, INDEPENDENT);
    open("part-of-domain", &w, 1, 12.5)
}

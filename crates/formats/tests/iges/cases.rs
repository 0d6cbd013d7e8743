//! Small models whose area, and volume where they are closed, have a closed form, as IGES files: the corpus of
//! `testdata/iges`.

use crate::writer::{DEFINITION, INDEPENDENT, Shell, Style, Used, Writer, counted, list};
use Used::{Backward, Forward, Vertex};
use std::f64::consts::{PI, TAU};

/// A file, and what it holds.
pub struct Case {
    pub name: &'static str,
    pub text: String,
    pub faces: usize,
    pub area: f64,
    /// `None` where the faces enclose nothing.
    pub volume: Option<f64>,
}

/// All of them.
pub fn cases() -> Vec<Case> {
    vec![
        cylinder("cylinder-seam", true, true, Style::default()),
        cylinder("cylinder-rings", false, true, Style::default()),
        cylinder("cylinder-reversed", false, false, Style::default()),
        cylinder("cylinder-terse", true, true, terse()),
        cone(),
        sphere(),
        ball_cut(),
        torus(),
        spindle(),
        oblique(),
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
        copious(),
        part_of_domain(),
        assembly(),
    ]
}

/// Other delimiters, Fortran's exponents, no blanks at the ends of lines, CRLF, and a model at half its size.
fn terse() -> Style {
    Style { delimiters: ['/', '#'], line_end: "\r\n", is_terse: true, unit: (10, "CM", 0.5) }
}

fn open(name: &'static str, w: &Writer, faces: usize, area: f64) -> Case {
    Case { name, text: w.file(), faces, area, volume: None }
}

fn solid(name: &'static str, w: &Writer, faces: usize, area: f64, volume: f64) -> Case {
    Case { name, text: w.file(), faces, area, volume: Some(volume) }
}

/// An axis at a height: its point and its direction.
fn axis(w: &mut Writer, z: f64, up: bool) -> String {
    let (origin, direction) = (w.point([0.0, 0.0, z]), w.direction([0.0, 0.0, if up { 1.0 } else { -1.0 }]));
    format!("{origin},{direction}")
}

fn cylinder(name: &'static str, seam: bool, outward: bool, style: Style) -> Case {
    let (r, h) = (2.0f64, 5.0);
    let mut w = Writer::new();
    w.style = style;
    let mut shell = Shell::new(&mut w);
    let (bottom, a) = shell.ring(&mut w, 0.0, r, 0.3);
    let (top, b) = shell.ring(&mut w, h, r, 0.3);
    let surface = if outward {
        let reference = w.direction([0.6, 0.8, 0.0]);
        let axis = axis(&mut w, 1.0, true);
        w.add(192, 1, &format!("{axis},{r:?},{reference}"))
    } else {
        // A circle pulled up has its normal outward, and pulled down inward.
        let circle = w.circle(h, r, [0.3, 0.3]);
        w.add(122, 0, &format!("{circle},{},{},-5.0", list(&[r * 0.3f64.cos()]), list(&[r * 0.3f64.sin()])))
    };
    let line = w.line([r * 0.3f64.cos(), r * 0.3f64.sin(), 0.0], [r * 0.3f64.cos(), r * 0.3f64.sin(), h]);
    let edge = shell.edge(line, [a, b]);
    // Loops run about the surface's own normal.
    match (seam, outward) {
        (true, _) => {
            shell.face(&mut w, surface, &[&[Forward(bottom), Forward(edge), Backward(top), Backward(edge)]], true)
        }
        (false, true) => shell.face(&mut w, surface, &[&[Forward(bottom)], &[Backward(top)]], true),
        (false, false) => shell.face(&mut w, surface, &[&[Backward(bottom)], &[Forward(top)]], false),
    }
    shell.disc(&mut w, 0.0, bottom, false);
    shell.disc(&mut w, h, top, true);
    shell.solid(&mut w);
    solid(name, &w, 3, 2.0 * PI * r * (r + h), PI * r * r * h)
}

/// A cone on its base in inches; its loop passes the apex, which a vertex names.
fn cone() -> Case {
    let (r, h) = (1.5f64, 4.0);
    let mut w = Writer::new();
    w.style.unit = (1, "INCH", 1.0);
    let mut shell = Shell::new(&mut w);
    let (base, foot) = shell.ring(&mut w, 0.0, r, 0.0);
    let apex = shell.vertex([0.0, 0.0, h]);
    let line = w.line([r, 0.0, 0.0], [0.0, 0.0, h]);
    let edge = shell.edge(line, [foot, apex]);
    let down = axis(&mut w, 0.0, false);
    let surface = w.add(194, 0, &format!("{down},{r:?},{:?}", (-(r / h).atan()).to_degrees().abs()));
    shell.face(&mut w, surface, &[&[Forward(base), Forward(edge), Vertex(apex), Backward(edge)]], true);
    shell.disc(&mut w, 0.0, base, false);
    shell.solid(&mut w);
    solid("cone-inch", &w, 2, PI * r * (r + r.hypot(h)), PI * r * r * h / 3.0)
}

/// A whole sphere, of which the loop names a pole alone.
fn sphere() -> Case {
    let r = 3.0f64;
    let mut w = Writer::new();
    let mut shell = Shell::new(&mut w);
    let pole = shell.vertex([1.0, 2.0, 6.0]);
    let center = w.point([1.0, 2.0, 3.0]);
    let surface = w.add(196, 0, &format!("{center},{r:?}"));
    shell.face(&mut w, surface, &[&[Vertex(pole)]], true);
    shell.solid(&mut w);
    solid("sphere-vertex", &w, 1, 4.0 * PI * r * r, 4.0 / 3.0 * PI * r.powi(3))
}

/// A ball without its cap: one ring, and a pole that nothing names.
fn ball_cut() -> Case {
    let (r, z) = (2.0f64, 1.0);
    let mut w = Writer::new();
    let mut shell = Shell::new(&mut w);
    let (edge, _) = shell.ring(&mut w, z, (r * r - z * z).sqrt(), 2.0);
    let center = w.point([0.0; 3]);
    let up = w.direction([0.0, 0.0, 1.0]);
    let across = w.direction([0.0, 1.0, 0.0]);
    let surface = w.add(196, 1, &format!("{center},{r:?},{up},{across}"));
    shell.face(&mut w, surface, &[&[Backward(edge)]], true);
    shell.disc(&mut w, z, edge, true);
    shell.solid(&mut w);
    let (cap, depth) = (r - z, r * r - z * z);
    let area = 4.0 * PI * r * r - 2.0 * PI * r * cap + PI * depth;
    solid("ball-cut", &w, 2, area, 4.0 / 3.0 * PI * r.powi(3) - PI * cap * cap * (3.0 * r - cap) / 3.0)
}

/// A torus of two seams; its second circle is turned up by a matrix.
fn torus() -> Case {
    let (major, minor) = (3.0, 1.0);
    let mut w = Writer::new();
    let mut shell = Shell::new(&mut w);
    let (around, vertex) = shell.ring(&mut w, 0.0, major + minor, 0.0);
    let matrix = w.matrix([[1.0, 0.0, 0.0, major], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0]]);
    let circle = w.circle(0.0, minor, [0.0, 0.0]);
    w.set_matrix(circle, matrix);
    let across = shell.edge(circle, [vertex, vertex]);
    let axis = axis(&mut w, 0.0, true);
    let surface = w.add(198, 0, &format!("{axis},{major:?},{minor:?}"));
    let uses = [Forward(around), Forward(across), Backward(around), Backward(across)];
    shell.face(&mut w, surface, &[&uses], true);
    shell.solid(&mut w);
    solid("torus", &w, 1, 4.0 * PI * PI * major * minor, 2.0 * PI * PI * major * minor * minor)
}

/// A sector and a triangle turned about an axis that is `centre` from the circle's middle: area and volume.
fn turned(centre: f64, radius: f64) -> (f64, f64) {
    let half = (-centre / radius).acos();
    let area = 4.0 * PI * radius * (centre * half + radius * half.sin());
    let sector = centre * half * radius * radius + 2.0 / 3.0 * radius.powi(3) * half.sin();
    (area, 2.0 * PI * (sector + centre * centre * radius * half.sin() / 3.0))
}

/// A torus that meets its axis: what is outside.
fn spindle() -> Case {
    let mut w = Writer::new();
    let mut shell = Shell::new(&mut w);
    let pole = shell.vertex([0.0, 0.0, 3f64.sqrt()]);
    let axis = axis(&mut w, 0.0, true);
    let surface = w.add(198, 0, &format!("{axis},1.0,2.0"));
    shell.face(&mut w, surface, &[&[Vertex(pole)]], true);
    shell.solid(&mut w);
    let (area, volume) = turned(1.0, 2.0);
    solid("spindle-apple", &w, 1, area, volume)
}

/// A cylinder cut by an oblique plane: an ellipse (104) in a plane of its own, in two parts.
fn oblique() -> Case {
    let (r, h, slope) = (2.0f64, 5.0, 0.5f64);
    let mut w = Writer::new();
    let mut shell = Shell::new(&mut w);
    let (bottom, _) = shell.ring(&mut w, 0.0, r, 0.3);
    let length = slope.hypot(1.0);
    let (c, s) = (1.0 / length, slope / length);
    let tilt = w.matrix([[c, 0.0, -s, 0.0], [0.0, 1.0, 0.0, 0.0], [s, 0.0, c, h]]);
    // x²/a² + y²/r² = 1 in that plane.
    let a = r * length;
    let at = |t: f64| [a * t.cos(), r * t.sin()];
    let part = |w: &mut Writer, from: f64, to: f64| {
        let coefficients = [1.0 / (a * a), 0.0, 1.0 / (r * r), 0.0, 0.0, -1.0, 0.0];
        let curve = w.numbers(104, 1, &[&coefficients[..], &at(from), &at(to)].concat());
        w.set_matrix(curve, tilt)
    };
    let (first, second) = (part(&mut w, 1.0, 4.0), part(&mut w, 4.0, 1.0));
    let place = |t: f64| [r * t.cos(), r * t.sin(), h + slope * r * t.cos()];
    let (p, q) = (shell.vertex(place(1.0)), shell.vertex(place(4.0)));
    let (first, second) = (shell.edge(first, [p, q]), shell.edge(second, [q, p]));
    let reference = w.direction([0.6, 0.8, 0.0]);
    let up = axis(&mut w, 0.0, true);
    let surface = w.add(192, 1, &format!("{up},{r:?},{reference}"));
    shell.face(&mut w, surface, &[&[Forward(bottom)], &[Backward(second), Backward(first)]], true);
    let (origin, normal) = (w.point([0.0, 0.0, h]), w.direction([-s, 0.0, c]));
    let plane = w.add(190, 0, &format!("{origin},{normal}"));
    shell.face(&mut w, plane, &[&[Forward(first), Forward(second)]], true);
    shell.disc(&mut w, 0.0, bottom, false);
    shell.solid(&mut w);
    solid("oblique-cut", &w, 3, 2.0 * PI * r * h + PI * r * r * (1.0 + length), PI * r * r * h)
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

/// A cylinder of radius and height 1 (a solid) twice in a definition, once at twice its size; that twice in the whole, once
/// mirrored. Nested definitions, in inches; a group names the two.
fn assembly() -> Case {
    let mut w = Writer::new();
    w.style.unit = (3, "IN", 1.0);
    let mut shell = Shell::new(&mut w);
    let (bottom, _) = shell.ring(&mut w, 0.0, 1.0, 0.0);
    let (top, _) = shell.ring(&mut w, 1.0, 1.0, 0.0);
    let up = axis(&mut w, 0.0, true);
    let surface = w.add(192, 0, &format!("{up},1.0"));
    shell.face(&mut w, surface, &[&[Forward(bottom)], &[Backward(top)]], true);
    shell.disc(&mut w, 0.0, bottom, false);
    shell.disc(&mut w, 1.0, top, true);
    let part = shell.solid(&mut w);
    let definition = |w: &mut Writer, depth: usize, members: &[usize]| {
        let number = w.add(308, 0, &format!("{depth},4Hpart,{}", counted(members)));
        w.set_status(number, DEFINITION)
    };
    let leaf = definition(&mut w, 0, &[part]);
    let turn = w.matrix([[0.0, 0.0, 1.0, 5.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]);
    let first = w.add(408, 0, &format!("{leaf},10.0,0.0,0.0,2.0"));
    w.set_matrix(first, turn);
    let second = w.add(408, 0, &format!("{leaf},0.0,-7.0,3.0,"));
    let group = definition(&mut w, 1, &[first, second]);
    let mirror = w.matrix([[-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 40.0]]);
    let places =
        [w.add(408, 0, &format!("{group},0.0,0.0,0.0,1.0")), w.add(408, 0, &format!("{group},0.0,0.0,0.0,1.0"))];
    w.set_matrix(places[1], mirror);
    places.iter().for_each(|place| {
        w.set_status(*place, INDEPENDENT);
    });
    w.add(402, 7, &counted(&places));
    solid("assembly", &w, 12, 2.0 * 4.0 * PI * (1.0 + 4.0), 2.0 * PI * (1.0 + 8.0))
}

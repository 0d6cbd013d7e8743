//! Small models whose area, and volume where they are closed, have a closed form, as IGES files: the corpus of
//! `testdata/iges`.

use crate::closed::{Case, solid, turned};
use crate::sheets;
use crate::writer::{DEFINITION, INDEPENDENT, Shell, Style, Used, Writer, counted, list};
use Used::{Backward, Forward, Vertex};
use std::f64::consts::PI;

/// All of them.
pub fn cases() -> Vec<Case> {
    let mut cases = vec![
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
        assembly(),
    ];
    cases.extend(sheets::cases());
    cases
}

/// Other delimiters, Fortran's exponents, no blanks at the ends of lines, CRLF, and a model at half its size.
fn terse() -> Style {
    Style { delimiters: ['/', '#'], line_end: "\r\n", is_terse: true, unit: (10, "CM", 0.5) }
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

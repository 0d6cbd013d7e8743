//! Small solids whose area and volume have a closed form, as STEP files: the corpus of `testdata/step`.

use crate::writer::{DOWN, Units, Writer, X, Z, list};
use std::f64::consts::PI;

/// A file, and what it holds.
pub struct Case {
    pub name: &'static str,
    pub text: String,
    pub faces: usize,
    pub area: f64,
    pub volume: f64,
}

const AP203: &str = "CONFIG_CONTROL_DESIGN";
const AP214: &str = "AUTOMOTIVE_DESIGN";
const AP242: &str = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF";

/// All of them.
pub fn cases() -> Vec<Case> {
    vec![
        cylinder("cylinder-seam", Side::Seam, AP203),
        cylinder("cylinder-rings", Side::Rings, AP214),
        cylinder("cylinder-reversed", Side::Reversed, AP214),
        cone("cone-apex", Units::MillimetreRadian),
        cone("cone-inch-degree", Units::InchDegree),
        sphere("sphere-vertex", false),
        sphere("sphere-seam", true),
        ball_cut(),
        torus(),
        spindle("spindle-apple", true),
        spindle("spindle-lemon", false),
        oblique(),
        revolution(),
        extrusion(),
        assembly(),
        tessellated(),
    ]
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Seam,
    Rings,
    Reversed,
}

fn finished(mut w: Writer, items: &[u64], units: Units) -> String {
    let context = w.context(units);
    let whole = w.representation(items, context);
    product(&mut w, whole);
    w.file()
}

/// A plane across z with a circle for its border, seen from `up` or from below.
fn disc(w: &mut Writer, height: f64, circle: u64, up: bool) -> u64 {
    let bound = w.bound("FACE_BOUND", &[(circle, up)]);
    let placement = w.placement([0.0, 0.0, height], if up { Z } else { DOWN }, X);
    let plane = w.add(format_args!("PLANE('',#{placement})"));
    w.face(&[bound], plane, true)
}

/// A circle about z as an edge from a vertex at `angle` to itself.
fn ring(w: &mut Writer, height: f64, radius: f64, angle: f64) -> (u64, u64) {
    let vertex = w.vertex([radius * angle.cos(), radius * angle.sin(), height]);
    let circle = w.circle([0.0, 0.0, height], radius);
    (w.edge([vertex, vertex], circle, true), vertex)
}

fn cylinder(name: &'static str, side: Side, schema: &'static str) -> Case {
    let (r, h) = (2.0, 5.0);
    let mut w = Writer::new(schema);
    let (bottom, a) = ring(&mut w, 0.0, r, 0.3);
    let (top, b) = ring(&mut w, h, r, 0.3);
    // A cylinder's own normal is always outward; that of a circle pulled downward is inward.
    let surface = match side {
        Side::Reversed => {
            let circle = w.circle([0.0; 3], r);
            let direction = w.direction(DOWN);
            let vector = w.add(format_args!("VECTOR('',#{direction},2.5)"));
            w.add(format_args!("SURFACE_OF_LINEAR_EXTRUSION('',#{circle},#{vector})"))
        }
        _ => {
            let placement = w.placement([0.0; 3], Z, X);
            w.add(format_args!("CYLINDRICAL_SURFACE('',#{placement},{r:?})"))
        }
    };
    let bounds = match side {
        Side::Seam => {
            let line = w.line([r * 0.3f64.cos(), r * 0.3f64.sin(), 0.0], Z);
            let seam = w.edge([a, b], line, true);
            vec![w.bound("FACE_BOUND", &[(bottom, true), (seam, true), (top, false), (seam, false)])]
        }
        _ => vec![w.bound("FACE_BOUND", &[(bottom, true)]), w.bound("FACE_BOUND", &[(top, false)])],
    };
    let wall = w.face(&bounds, surface, side != Side::Reversed);
    let faces = [wall, disc(&mut w, 0.0, bottom, false), disc(&mut w, h, top, true)];
    let solid = w.solid(&faces);
    let text = finished(w, &[solid], Units::MillimetreRadian);
    Case { name, text, faces: 3, area: 2.0 * PI * r * (r + h), volume: PI * r * r * h }
}

/// A cone on its base, with its apex above; the surface is placed at the base, where it has a radius.
fn cone(name: &'static str, units: Units) -> Case {
    let (r, h) = (1.5, 4.0f64);
    let mut w = Writer::new(AP203);
    let (base, _) = ring(&mut w, 0.0, r, -1.0);
    let placement = w.placement([0.0; 3], DOWN, X);
    let angle = (r / h).atan();
    let angle = if units == Units::InchDegree { angle.to_degrees() } else { angle };
    let surface = w.add(format_args!("CONICAL_SURFACE('',#{placement},{r:?},{angle:?})"));
    let apex = w.vertex([0.0, 0.0, h]);
    let bounds = [w.bound("FACE_OUTER_BOUND", &[(base, true)]), w.vertex_bound(apex)];
    let wall = w.face(&bounds, surface, true);
    let faces = [wall, disc(&mut w, 0.0, base, false)];
    let solid = w.solid(&faces);
    let text = finished(w, &[solid], units);
    Case { name, text, faces: 2, area: PI * r * (r + r.hypot(h)), volume: PI * r * r * h / 3.0 }
}

fn sphere(name: &'static str, seam: bool) -> Case {
    let r = 3.0;
    let mut w = Writer::new(AP214);
    let placement = w.placement([1.0, 2.0, 3.0], Z, X);
    let surface = w.add(format_args!("SPHERICAL_SURFACE('',#{placement},{r:?})"));
    let [south, north] = [0.0, 6.0].map(|z| w.vertex([1.0, 2.0, z]));
    let bound = if seam {
        // A meridian, up and down again.
        let meridian = w.placement([1.0, 2.0, 3.0], [0.0, -1.0, 0.0], X);
        let circle = w.add(format_args!("CIRCLE('',#{meridian},{r:?})"));
        let edge = w.edge([south, north], circle, true);
        w.bound("FACE_BOUND", &[(edge, true), (edge, false)])
    } else {
        w.vertex_bound(north)
    };
    let face = w.face(&[bound], surface, true);
    let solid = w.solid(&[face]);
    let text = finished(w, &[solid], Units::MillimetreRadian);
    Case { name, text, faces: 1, area: 4.0 * PI * r * r, volume: 4.0 / 3.0 * PI * r.powi(3) }
}

/// A ball without its cap: one ring, and a pole that nothing names.
fn ball_cut() -> Case {
    let (r, z) = (2.0f64, 1.0);
    let mut w = Writer::new(AP214);
    let placement = w.placement([0.0; 3], Z, X);
    let surface = w.add(format_args!("SPHERICAL_SURFACE('',#{placement},{r:?})"));
    let (edge, _) = ring(&mut w, z, (r * r - z * z).sqrt(), 2.0);
    let bound = w.bound("FACE_BOUND", &[(edge, false)]);
    let faces = [w.face(&[bound], surface, true), disc(&mut w, z, edge, true)];
    let solid = w.solid(&faces);
    let text = finished(w, &[solid], Units::MillimetreRadian);
    let (cap, depth) = (r - z, r * r - z * z);
    let area = 4.0 * PI * r * r - 2.0 * PI * r * cap + PI * depth;
    let volume = 4.0 / 3.0 * PI * r.powi(3) - PI * cap * cap * (3.0 * r - cap) / 3.0;
    Case { name: "ball-cut", text, faces: 2, area, volume }
}

fn torus() -> Case {
    let (major, minor) = (3.0, 1.0);
    let mut w = Writer::new(AP203);
    let placement = w.placement([0.0; 3], Z, X);
    let surface = w.add(format_args!("TOROIDAL_SURFACE('',#{placement},{major:?},{minor:?})"));
    let vertex = w.vertex([major + minor, 0.0, 0.0]);
    let around = w.circle([0.0; 3], major + minor);
    let across = w.placement([major, 0.0, 0.0], [0.0, -1.0, 0.0], X);
    let across = w.add(format_args!("CIRCLE('',#{across},{minor:?})"));
    let (a, b) = (w.edge([vertex, vertex], around, true), w.edge([vertex, vertex], across, true));
    let bound = w.bound("FACE_BOUND", &[(a, true), (b, true), (a, false), (b, false)]);
    let face = w.face(&[bound], surface, true);
    let solid = w.solid(&[face]);
    let text = finished(w, &[solid], Units::MillimetreRadian);
    let (area, volume) = (4.0 * PI * PI * major * minor, 2.0 * PI * PI * major * minor * minor);
    Case { name: "torus", text, faces: 1, area, volume }
}

/// A torus that meets its axis: what is outside, or inside.
fn spindle(name: &'static str, outside: bool) -> Case {
    let (major, minor) = (1.0f64, 2.0f64);
    let mut w = Writer::new(AP214);
    let placement = w.placement([0.0; 3], Z, X);
    let flag = crate::writer::flag(outside);
    let surface = w.add(format_args!("DEGENERATE_TOROIDAL_SURFACE('',#{placement},{major:?},{minor:?},{flag})"));
    let vertex = w.vertex([0.0, 0.0, (minor * minor - major * major).sqrt()]);
    let bound = w.vertex_bound(vertex);
    // The inner part's own normal is inward.
    let face = w.face(&[bound], surface, outside);
    let solid = w.solid(&[face]);
    let text = finished(w, &[solid], Units::MillimetreRadian);
    // A sector and a triangle turned about the axis, which is at distance `major` on this side or on that.
    let centre = if outside { major } else { -major };
    let half = (-centre / minor).acos();
    let area = 4.0 * PI * minor * (centre * half + minor * half.sin());
    let sector = centre * half * minor * minor + 2.0 / 3.0 * minor.powi(3) * half.sin();
    let volume = 2.0 * PI * (sector + centre * centre * minor * half.sin() / 3.0);
    Case { name, text, faces: 1, area, volume }
}

/// A cylinder cut by an oblique plane: an ellipse runs around the wall, across wherever its seam is.
fn oblique() -> Case {
    let (r, h, slope) = (2.0f64, 5.0, 0.5f64);
    let mut w = Writer::new(AP214);
    let (bottom, _) = ring(&mut w, 0.0, r, 0.3);
    let placement = w.placement([0.0; 3], Z, [0.6, 0.8, 0.0]);
    let surface = w.add(format_args!("CYLINDRICAL_SURFACE('',#{placement},{r:?})"));
    let length = slope.hypot(1.0);
    let (up, along) = ([-slope / length, 0.0, 1.0 / length], [1.0 / length, 0.0, slope / length]);
    let tilted = w.placement([0.0, 0.0, h], up, along);
    let ellipse = w.add(format_args!("ELLIPSE('',#{tilted},{:?},{r:?})", r * length));
    // Two edges, so that one begins and ends away from the ellipse's own start.
    let at = |t: f64| [r * t.cos(), r * t.sin(), h + slope * r * t.cos()];
    let (p, q) = (w.vertex(at(1.0)), w.vertex(at(4.0)));
    let (first, second) = (w.edge([p, q], ellipse, true), w.edge([p, q], ellipse, false));
    let bounds = [w.bound("FACE_BOUND", &[(bottom, true)]), w.bound("FACE_BOUND", &[(second, true), (first, false)])];
    let wall = w.face(&bounds, surface, true);
    let border = w.bound("FACE_OUTER_BOUND", &[(first, true), (second, false)]);
    let plane = w.add(format_args!("PLANE('',#{tilted})"));
    let lid = w.face(&[border], plane, true);
    let faces = [wall, lid, disc(&mut w, 0.0, bottom, false)];
    let solid = w.solid(&faces);
    let text = finished(w, &[solid], Units::MillimetreRadian);
    let area = 2.0 * PI * r * h + PI * r * r * (1.0 + length);
    Case { name: "oblique-cut", text, faces: 3, area, volume: PI * r * r * h }
}

/// A parabola z = x² turned about z, as a Bézier curve with no knots in the file: a paraboloid with a lid.
fn revolution() -> Case {
    let h = 4.0f64;
    let mut w = Writer::new(AP214);
    let controls: Vec<u64> = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 4.0]].map(|p| w.point(p)).to_vec();
    let profile = w.add(format_args!("BEZIER_CURVE('',2,{},.PARABOLIC_ARC.,.F.,.F.)", list(&controls)));
    let (origin, z) = (w.point([0.0; 3]), w.direction(Z));
    let axis = w.add(format_args!("AXIS1_PLACEMENT('',#{origin},#{z})"));
    let surface = w.add(format_args!("SURFACE_OF_REVOLUTION('',#{profile},#{axis})"));
    let (edge, _) = ring(&mut w, h, 2.0, 0.0);
    let bound = w.bound("FACE_OUTER_BOUND", &[(edge, false)]);
    // u turns toward +y, v runs outward and up: S_u × S_v is outward and down.
    let faces = [w.face(&[bound], surface, true), disc(&mut w, h, edge, true)];
    let solid = w.solid(&faces);
    let text = finished(w, &[solid], Units::MillimetreRadian);
    let area = PI / 6.0 * ((1.0 + 4.0 * h).powf(1.5) - 1.0) + PI * h;
    Case { name: "paraboloid", text, faces: 2, area, volume: PI * h * h / 2.0 }
}

/// A closed uniform quadratic curve, its knots unsaid, pulled along z: the first two points stand again at the end.
fn extrusion() -> Case {
    let height = 3.0;
    let corners =
        [[2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [-2.0, 2.0], [-2.0, 0.0], [-2.0, -2.0], [0.0, -2.0], [2.0, -2.0]];
    let mut w = Writer::new(AP214);
    let curve = |w: &mut Writer, z: f64| {
        let points: Vec<u64> = (0..10).map(|k| w.point([corners[k % 8][0], corners[k % 8][1], z])).collect();
        w.add(format_args!("UNIFORM_CURVE('',2,{},.UNSPECIFIED.,.T.,.F.)", list(&points)))
    };
    let (low, high) = (curve(&mut w, 0.0), curve(&mut w, height));
    let up = w.direction(Z);
    let vector = w.add(format_args!("VECTOR('',#{up},1.)"));
    let surface = w.add(format_args!("SURFACE_OF_LINEAR_EXTRUSION('',#{low},#{vector})"));
    // A quadratic passes the middle of its first side.
    let [a, b] = [0.0, height].map(|z| w.vertex([2.0, 1.0, z]));
    let (bottom, top) = (w.edge([a, a], low, true), w.edge([b, b], high, true));
    let bounds = [w.bound("FACE_BOUND", &[(bottom, true)]), w.bound("FACE_BOUND", &[(top, false)])];
    let wall = w.face(&bounds, surface, true);
    let faces = [wall, disc(&mut w, 0.0, bottom, false), disc(&mut w, height, top, true)];
    let solid = w.solid(&faces);
    let text = finished(w, &[solid], Units::MillimetreRadian);
    // The polygon of the sides' middles, and two thirds of each triangle that a corner adds. The four corners at right
    // angles cut triangles of sides 1 and 1; along a straight side the triangles are flat.
    let section = 14.0 + 4.0 * 2.0 / 3.0 * 0.5;
    // Straight arcs of length 2, and parabolas of control points (1, 0), (0, 0), (0, 1).
    let arc = 1.0 + (1.0 + 2f64.sqrt()).ln() / 2f64.sqrt();
    let length = 4.0 * 2.0 + 4.0 * arc;
    Case { name: "uniform-prism", text, faces: 3, area: length * height + 2.0 * section, volume: section * height }
}

/// A cylinder of radius 1 and height 1, for assemblies.
fn part(w: &mut Writer, context: u64) -> u64 {
    let (bottom, _) = ring(w, 0.0, 1.0, 0.0);
    let (top, _) = ring(w, 1.0, 1.0, 0.0);
    let placement = w.placement([0.0; 3], Z, X);
    let surface = w.add(format_args!("CYLINDRICAL_SURFACE('',#{placement},1.)"));
    let bounds = [w.bound("FACE_BOUND", &[(bottom, true)]), w.bound("FACE_BOUND", &[(top, false)])];
    let wall = w.face(&bounds, surface, true);
    let faces = [wall, disc(w, 0.0, bottom, false), disc(w, 1.0, top, true)];
    let solid = w.solid(&faces);
    w.representation(&[solid], context)
}

/// A product's shape; its representation, and its definition.
fn product(w: &mut Writer, representation: u64) -> u64 {
    let definition = w.add("PRODUCT_DEFINITION('',$,$,$)");
    let shape = w.add(format_args!("PRODUCT_DEFINITION_SHAPE('',$,#{definition})"));
    w.add(format_args!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})"));
    definition
}

/// A part twice in a group, in one of them with the order of the relationship swapped; the group twice in the whole, once as
/// a mapped item. The part is in inches.
fn assembly() -> Case {
    let mut w = Writer::new(AP214);
    let (context, inches) = (w.context(Units::MillimetreRadian), w.context(Units::InchDegree));
    let body = part(&mut w, inches);
    let home = w.placement([0.0; 3], Z, X);
    let leaf = w.add(format_args!("SHAPE_REPRESENTATION('',(#{home}),#{inches})"));
    w.add(format_args!("SHAPE_REPRESENTATION_RELATIONSHIP('','',#{leaf},#{body})"));
    let group = w.add(format_args!("SHAPE_REPRESENTATION('',(#{home}),#{context})"));
    let (leaf_product, group_product) = (product(&mut w, leaf), product(&mut w, group));
    for (k, origin) in [[10.0, 0.0, 0.0], [90.0, 5.0, 5.0]].into_iter().enumerate() {
        let to = w.placement(origin, [0.0, 1.0, 0.0], Z);
        let (first, second, items) = if k == 0 { (leaf, group, [home, to]) } else { (group, leaf, [to, home]) };
        let moved = w.add(format_args!("ITEM_DEFINED_TRANSFORMATION('','',#{},#{})", items[0], items[1]));
        let relation = w.add(format_args!(
            "(REPRESENTATION_RELATIONSHIP('','',#{first},#{second})\
             REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{moved})SHAPE_REPRESENTATION_RELATIONSHIP())"
        ));
        let usage = w.add(format_args!("NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#{group_product},#{leaf_product},$)"));
        let shape = w.add(format_args!("PRODUCT_DEFINITION_SHAPE('','',#{usage})"));
        w.add(format_args!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{shape})"));
    }
    let map = w.add(format_args!("REPRESENTATION_MAP(#{home},#{group})"));
    let places = [[0.0; 3], [0.0, 0.0, 500.0]].map(|origin| {
        let to = w.placement(origin, Z, [0.0, 1.0, 0.0]);
        w.add(format_args!("MAPPED_ITEM('',#{map},#{to})"))
    });
    let whole = w.add(format_args!("SHAPE_REPRESENTATION('',{},#{context})", list(&places)));
    product(&mut w, whole);
    let r = 25.4f64;
    let text = w.file();
    Case { name: "assembly", text, faces: 12, area: 4.0 * 4.0 * PI * r * r, volume: 4.0 * PI * r.powi(3) }
}

/// AP242: a body beside its tessellation, which is said to be left out.
fn tessellated() -> Case {
    let mut w = Writer::new(AP242);
    let context = w.context(Units::MillimetreRadian);
    let body = part(&mut w, context);
    product(&mut w, body);
    let solid = w.add("TESSELLATED_SOLID('',(),$)");
    w.add(format_args!("TESSELLATED_SHAPE_REPRESENTATION('',(#{solid}),#{context})"));
    Case { name: "ap242-tessellated", text: w.file(), faces: 3, area: 4.0 * PI, volume: PI }
}

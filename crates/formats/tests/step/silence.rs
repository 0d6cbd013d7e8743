//! What a file says wrong, or not at all, is told: nothing takes its place in silence.

use crate::cases::cases;
use crate::writer::{Units, Writer, X, Z, list};
use formats::{Document, FORMATS};

fn read(text: &str) -> Document {
    let step = FORMATS.iter().find(|format| format.name() == "STEP").expect("it is in the list");
    step.read(text.as_bytes(), "part.step").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// How many faces there are, and the notes of losses.
fn told(text: &str) -> (usize, Vec<String>) {
    let document = read(text);
    let losses = document.notes.iter().filter(|note| note.kind.is_loss()).map(ToString::to_string);
    (document.model.faces().len(), losses.collect())
}

fn assert_told(name: &str, (faces, losses): &(usize, Vec<String>), expected: usize, part: &str) {
    assert_eq!((*faces, losses.len()), (expected, 1), "{name}: {losses:?}");
    assert!(losses[0].starts_with("line ") && losses[0].contains(part), "{name}: {losses:?}");
}

/// A sphere that stands by itself, and is always drawn.
fn sphere(w: &mut Writer, x: f64) -> u64 {
    let placement = w.placement([x, 0.0, 0.0], Z, X);
    w.add(format_args!("SPHERICAL_SURFACE('',#{placement},1.)"))
}

fn set(w: &mut Writer, items: &[u64]) -> u64 {
    w.add(format_args!("GEOMETRIC_SET('',{})", list(items)))
}

fn shown(w: &mut Writer, items: &[u64], context: u64) -> u64 {
    let all = list(items);
    w.add(format_args!("GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',{all},#{context})"))
}

/// A sphere at 9, and one in a part that an item places by an operator of this scale.
fn scaled(scale: &str) -> (usize, Vec<String>) {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let context = w.context(Units::MillimetreRadian);
    let inner = sphere(&mut w, 0.0);
    let inner = set(&mut w, &[inner]);
    let part = shown(&mut w, &[inner], context);
    let origin = w.placement([0.0; 3], Z, X);
    let map = w.add(format_args!("REPRESENTATION_MAP(#{origin},#{part})"));
    let point = w.point([0.0; 3]);
    let to = w.add(format_args!("CARTESIAN_TRANSFORMATION_OPERATOR_3D('',$,$,#{point},{scale},$)"));
    let item = w.add(format_args!("MAPPED_ITEM('',#{map},#{to})"));
    let outer = sphere(&mut w, 9.0);
    let outer = set(&mut w, &[outer]);
    shown(&mut w, &[item, outer], context);
    told(&w.file())
}

#[test]
fn a_scale_that_is_no_number_is_not_one() {
    assert_eq!(scaled("$"), (2, vec![]), "an absent one is");
    assert_eq!(scaled("2."), (2, vec![]));
    for (scale, part) in [
        (".T.", "parameter 5 is not a number"),
        ("'2'", "is not a number"),
        ("#1", "is not a number"),
        ("-1.", "its scale is not above 0"),
        ("0.", "its scale is not above 0"),
    ] {
        let (faces, losses) = scaled(scale);
        // The part is drawn where it stands, since nothing places it: that is told, too.
        assert_eq!((faces, losses.len()), (2, 2), "{scale}: {losses:?}");
        assert!(
            losses.iter().any(|loss| loss.contains("3D: left out: ") && loss.contains(part)),
            "{scale}: {losses:?}"
        );
        assert!(losses.iter().any(|loss| loss.contains("stand in none that is shown")), "{scale}: {losses:?}");
    }
}

/// Two representations that relationships name both ways, and nothing else: no root leads to them.
#[test]
fn representations_that_name_only_each_other_are_drawn_and_told() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let context = w.context(Units::MillimetreRadian);
    let mut part = |x: f64| {
        let item = sphere(&mut w, x);
        let item = set(&mut w, &[item]);
        shown(&mut w, &[item], context)
    };
    let [a, b, _] = [part(0.0), part(3.0), part(6.0)];
    w.add(format_args!("SHAPE_REPRESENTATION_RELATIONSHIP('','',#{a},#{b})"));
    w.add(format_args!("SHAPE_REPRESENTATION_RELATIONSHIP('','',#{b},#{a})"));
    let (faces, losses) = told(&w.file());
    assert_eq!(faces, 3, "{losses:?}");
    let is_told = |part: &str| losses.iter().any(|loss| loss.contains(part));
    assert!(
        is_told("1 representations, this one the first, stand in none") && is_told("stands in itself"),
        "{losses:?}"
    );
}

/// A body or a representation that names its parts by no list shows nothing, and says so.
#[test]
fn parts_that_are_no_list_are_told() {
    for body in [
        "MANIFOLD_SOLID_BREP('',$)",
        "FACETED_BREP('','x')",
        "BREP_WITH_VOIDS('',$,())",
        "SHELL_BASED_SURFACE_MODEL('',$)",
        "GEOMETRIC_SET('',4.)",
        "GEOMETRIC_SET('',(#99999))",
    ] {
        let mut w = Writer::new("AUTOMOTIVE_DESIGN");
        let context = w.context(Units::MillimetreRadian);
        let own = sphere(&mut w, 0.0);
        let own = set(&mut w, &[own]);
        let wrong = w.add(body);
        shown(&mut w, &[own, wrong], context);
        assert_told(body, &told(&w.file()), 1, "left out: ");
    }
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let context = w.context(Units::MillimetreRadian);
    let own = sphere(&mut w, 0.0);
    let own = set(&mut w, &[own]);
    shown(&mut w, &[own], context);
    w.add(format_args!("SHAPE_REPRESENTATION('',$,#{context})"));
    assert_told("items", &told(&w.file()), 1, "SHAPE_REPRESENTATION: left out: parameter 2 is not a list");
}

/// The parts of a complex instance come in any order.
#[test]
fn a_complex_surface_in_a_set_is_drawn_whatever_part_comes_first() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let context = w.context(Units::MillimetreRadian);
    let points = [[0.0; 3], [0.0, 1.0, 0.0], X, [1.0, 1.0, 0.0]].map(|p| w.point(p));
    let [a, b, c, d] = points;
    let surface = w.add(format_args!(
        "(GEOMETRIC_REPRESENTATION_ITEM()REPRESENTATION_ITEM('')RATIONAL_B_SPLINE_SURFACE(((1.,2.),(2.,1.)))\
         B_SPLINE_SURFACE(1,1,((#{a},#{b}),(#{c},#{d})),.UNSPECIFIED.,.F.,.F.,.F.)BOUNDED_SURFACE()SURFACE()BEZIER_SURFACE())"
    ));
    let item = set(&mut w, &[surface]);
    shown(&mut w, &[item], context);
    assert_eq!(told(&w.file()), (1, vec![]));
}

/// A second direction along the axis, or of no length: a surface is drawn by the standard's own, a part is not placed by it.
#[test]
fn a_placement_without_a_second_direction_is_told() {
    for x in [Z, [0.0; 3], [0.0, 0.0, -4.0]] {
        let mut w = Writer::new("AUTOMOTIVE_DESIGN");
        let context = w.context(Units::MillimetreRadian);
        let placement = w.placement([0.0; 3], Z, x);
        let item = w.add(format_args!("SPHERICAL_SURFACE('',#{placement},1.)"));
        let item = set(&mut w, &[item]);
        let part = shown(&mut w, &[item], context);
        assert_told("surface", &told(&w.file()), 1, "AXIS2_PLACEMENT_3D: 1 placements, this one the first, have");
        let map = w.add(format_args!("REPRESENTATION_MAP(#{placement},#{part})"));
        let item = w.add(format_args!("MAPPED_ITEM('',#{map},#{placement})"));
        shown(&mut w, &[item], context);
        let (_, losses) = told(&w.file());
        let is_told = |part: &str| losses.iter().any(|loss| loss.contains(part));
        assert!(is_told("left out: its second direction has no length, or is that of its axis"), "{losses:?}");
    }
    // A parameter that is no instance is not an absent one.
    for placement in ["AXIS2_PLACEMENT_3D('',#1,4.,$)", "AXIS2_PLACEMENT_3D('',#1,$,'x')"] {
        let mut w = Writer::new("AUTOMOTIVE_DESIGN");
        w.point([0.0; 3]);
        let placement = w.add(placement);
        let context = w.context(Units::MillimetreRadian);
        let item = w.add(format_args!("SPHERICAL_SURFACE('',#{placement},1.)"));
        let good = sphere(&mut w, 4.0);
        let item = set(&mut w, &[item, good]);
        shown(&mut w, &[item], context);
        assert_told("parameter", &told(&w.file()), 1, "is not an instance");
    }
}

#[test]
fn a_torus_whose_radius_is_below_zero_is_none() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let context = w.context(Units::MillimetreRadian);
    let placement = w.placement([0.0; 3], Z, X);
    let item = w.add(format_args!("DEGENERATE_TOROIDAL_SURFACE('',#{placement},-1.,2.,.T.)"));
    let good = sphere(&mut w, 4.0);
    let item = set(&mut w, &[item, good]);
    shown(&mut w, &[item], context);
    assert_told("torus", &told(&w.file()), 1, "a radius is below 0");
}

/// A sphere in a context, and what is told of its units.
fn of_units(context: &str) -> (usize, Vec<String>, bool) {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    w.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
    w.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.GRAM.))");
    w.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))");
    w.add("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-7),$,'','')");
    w.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.METRE.))");
    let own = sphere(&mut w, 0.0);
    let own = set(&mut w, &[own]);
    let context = match context {
        "$" => "$".to_owned(),
        parts => format!("#{}", w.add(format_args!("({parts}REPRESENTATION_CONTEXT('',''))"))),
    };
    w.add(format_args!("GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#{own}),{context})"));
    let document = read(&w.file());
    let losses = document.notes.iter().filter(|note| note.kind.is_loss()).map(ToString::to_string);
    (document.model.faces().len(), losses.collect(), document.unit.is_some())
}

#[test]
fn units_that_are_missing_or_measure_something_else_are_told() {
    assert_eq!(of_units("GLOBAL_UNIT_ASSIGNED_CONTEXT((#1))"), (1, vec![], true));
    for (context, has_unit, part) in [
        ("$", false, "it names no context: no unit is taken"),
        ("", false, "it names no unit of length: none is taken"),
        ("GLOBAL_UNIT_ASSIGNED_CONTEXT(())", false, "it names no unit of length: none is taken"),
        ("GLOBAL_UNIT_ASSIGNED_CONTEXT($)", false, "is not a list: none is taken"),
        ("GLOBAL_UNIT_ASSIGNED_CONTEXT((#2))", false, "it is no unit of length that is known"),
        ("GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#3))", true, "names another unit of length"),
        ("GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#5))", true, "it is no unit of angles that is known"),
        ("GLOBAL_UNIT_ASSIGNED_CONTEXT((#1))GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#4))", true, "no uncertainty"),
        ("GLOBAL_UNIT_ASSIGNED_CONTEXT((#1))GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT('')", true, "none is taken"),
    ] {
        let (faces, losses, unit) = of_units(context);
        assert_eq!(unit, has_unit, "{context}");
        assert_told(context, &(faces, losses), 1, part);
    }
}

/// Colours and what hides: what cannot be read of them is told, and the face is drawn.
#[test]
fn styles_that_make_no_sense_are_told() {
    for (said, part) in [
        ("COLOUR_RGB('',1.5,0.,-1.)", "its parts are not from 0 to 1: the nearest that are count"),
        ("COLOUR_RGB('',$,0.,1.)", "left out: it is no colour: three numbers"),
        ("COLOUR_RGB('',NaN,0.,1.)", "left out: it is not in the file, or its text makes no sense"),
        ("DRAUGHTING_PRE_DEFINED_COLOUR('taupe')", "left out: it names no known colour"),
    ] {
        let mut w = Writer::new("AUTOMOTIVE_DESIGN");
        let context = w.context(Units::MillimetreRadian);
        let own = sphere(&mut w, 0.0);
        let item = set(&mut w, &[own]);
        shown(&mut w, &[item], context);
        let colour = w.add(said);
        let usage = w.add(format_args!("FILL_AREA_STYLE_COLOUR('',#{colour})"));
        w.add(format_args!("STYLED_ITEM('',(#{usage}),#{own})"));
        assert_told(said, &told(&w.file()), 1, part);
    }
    for said in
        ["STYLED_ITEM('',$,$)", "INVISIBILITY($)", "INVISIBILITY((NaN))", "PRESENTATION_LAYER_ASSIGNMENT('a','',$)"]
    {
        let mut w = Writer::new("AUTOMOTIVE_DESIGN");
        let context = w.context(Units::MillimetreRadian);
        let own = sphere(&mut w, 0.0);
        let item = set(&mut w, &[own]);
        shown(&mut w, &[item], context);
        w.add(said);
        assert_told(said, &told(&w.file()), 1, "left out: ");
    }
}

/// A part whose place in the whole cannot be read is told with the instance that should say it.
#[test]
fn relations_that_make_no_sense_are_told() {
    let text = cases().into_iter().find(|case| case.name == "assembly").expect("a case").text;
    let (faces, losses) = told(&text);
    assert_eq!(losses, Vec::<String>::new());
    for (keyword, part) in [
        ("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION", "is not an instance"),
        ("SHAPE_DEFINITION_REPRESENTATION", "is not an instance"),
        ("NEXT_ASSEMBLY_USAGE_OCCURRENCE", "it names no use that says which of the two is the part"),
    ] {
        let start = format!("={keyword}(");
        let line = text.lines().find(|line| line.contains(&start)).expect(keyword);
        let (number, _) = line.split_once('=').expect("a number");
        let changed = text.replacen(line, &format!("{number}={keyword}($,$,$,$,$,$);"), 1);
        let (still, losses) = told(&changed);
        assert!(still == faces || keyword != "NEXT_ASSEMBLY_USAGE_OCCURRENCE", "{keyword}: {still} {losses:?}");
        assert!(losses.iter().any(|loss| loss.starts_with("line ") && loss.contains(part)), "{keyword}: {losses:?}");
    }
}

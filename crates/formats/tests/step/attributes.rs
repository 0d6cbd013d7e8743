//! Names, colours and visibility, against what OpenCASCADE's own reader says (`tests/oracle/step_attributes.py`).

use crate::common::root;
use crate::writer::{DOWN, Units, Writer, X, Z, list};
use formats::{Colour, Document, FORMATS, NoteKind, SurfaceKind};
use glam::DVec3;
use serde_json::Value;

pub fn read(text: &str) -> Document {
    let step = FORMATS.iter().find(|format| format.name() == "STEP").expect("it is in the list");
    step.read(text.as_bytes(), "part.step").unwrap_or_else(|error| panic!("{error}"))
}

/// The centre, the colour and the name of each face, in an order of its own.
type Row = (String, Option<[u8; 3]>, Option<String>);

fn rows(document: &Document) -> Vec<Row> {
    assert_eq!(document.attributes.len(), document.model.faces().len());
    let faces = document.model.faces().iter().zip(&document.attributes);
    let row = |(face, said): (&scene::Face, &formats::Attributes)| {
        let centre = document.model.surfaces()[face.surface].hull().center();
        let name = said.name.as_ref().map(|name| name.to_string());
        (format!("{:.6?}", (centre + DVec3::ZERO).to_array()), said.colour.map(|colour| colour.0), name)
    };
    let mut rows: Vec<Row> = faces.map(row).collect();
    rows.sort();
    rows
}

#[test]
fn faces_have_the_names_and_colours_that_opencascade_reads() {
    let folder = root().join("testdata/step");
    let text = std::fs::read_to_string(folder.join("attributes.json")).unwrap();
    let answers: Vec<Value> = serde_json::from_str(&text).unwrap();
    let row = |answer: &Value| {
        let numbers = |key: &str| -> Option<[f64; 3]> { serde_json::from_value(answer[key].clone()).unwrap() };
        let colour = numbers("colour").map(|parts| parts.map(|part| part as u8));
        let name = answer["name"].as_str().filter(|name| !name.is_empty()).map(str::to_owned);
        (format!("{:.6?}", numbers("centre").unwrap()), colour, name)
    };
    let mut expected: Vec<Row> = answers.iter().map(row).collect();
    expected.sort();
    let document = formats::open(folder.join("attributes.step")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(rows(&document), expected);
    assert!(document.attributes.iter().all(|said| said.surface == SurfaceKind::Plane));
    // What is not shown is said, once for each body.
    let left_out: Vec<String> = document.notes.iter().map(ToString::to_string).collect();
    assert_eq!(left_out.len(), 2, "{left_out:?}");
    assert!(document.notes.iter().all(|note| note.kind == NoteKind::LeftOut));
    assert!(
        left_out.iter().any(|note| note.contains("MANIFOLD_SOLID_BREP: left out: it is invisible")),
        "{left_out:?}"
    );
    assert!(left_out.iter().any(|note| note.contains("its layer \"construction\" is invisible")), "{left_out:?}");
}

/// Two discs in a shell, one above the other; the numbers of the faces, the shell and its model.
pub fn discs(w: &mut Writer, names: [&str; 2]) -> ([u64; 2], u64, u64) {
    let disc = |w: &mut Writer, name: &str, height: f64, axis: [f64; 3]| {
        let vertex = w.vertex([1.0, 0.0, height]);
        let circle = w.circle([0.0, 0.0, height], 1.0);
        let edge = w.edge([vertex, vertex], circle, true);
        let bound = w.bound("FACE_OUTER_BOUND", &[(edge, axis == Z)]);
        let placement = w.placement([0.0, 0.0, height], axis, X);
        let plane = w.add(format_args!("PLANE('',#{placement})"));
        w.add(format_args!("ADVANCED_FACE('{name}',(#{bound}),#{plane},.T.)"))
    };
    let faces = [disc(w, names[0], 0.0, DOWN), disc(w, names[1], 1.0, Z)];
    let shell = w.add(format_args!("OPEN_SHELL('',{})", list(&faces)));
    let model = w.add(format_args!("SHELL_BASED_SURFACE_MODEL('',(#{shell}))"));
    (faces, shell, model)
}

/// A style of surfaces, of an instance that is a colour.
fn style(w: &mut Writer, colour: &str) -> u64 {
    let colour = w.add(colour);
    let style = w.add(format_args!("FILL_AREA_STYLE_COLOUR('',#{colour})"));
    let area = w.add(format_args!("FILL_AREA_STYLE('',(#{style}))"));
    let fill = w.add(format_args!("SURFACE_STYLE_FILL_AREA(#{area})"));
    let side = w.add(format_args!("SURFACE_SIDE_STYLE('',(#{fill}))"));
    let usage = w.add(format_args!("SURFACE_STYLE_USAGE(.BOTH.,#{side})"));
    w.add(format_args!("PRESENTATION_STYLE_ASSIGNMENT((#{usage}))"))
}

fn colour(w: &mut Writer, item: u64, keyword: &str, colour: &str) -> u64 {
    let style = style(w, colour);
    let over = if keyword == "STYLED_ITEM" { "" } else { ",$" };
    w.add(format_args!("{keyword}('',(#{style}),#{item}{over})"))
}

pub fn finished(w: &mut Writer, model: u64) -> String {
    let context = w.context(Units::MillimetreRadian);
    w.add(format_args!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{model}),#{context})"));
    w.file()
}

#[test]
fn a_shell_has_a_colour_and_what_overrides_counts_whatever_comes_first() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let ([low, _], shell, model) = discs(&mut w, [r"Stirnfl\X2\00E4\X0\che", "NONE"]);
    colour(&mut w, low, "OVER_RIDING_STYLED_ITEM", "COLOUR_RGB('',1.,0.,0.)");
    colour(&mut w, low, "STYLED_ITEM", "DRAUGHTING_PRE_DEFINED_COLOUR('blue')");
    colour(&mut w, shell, "STYLED_ITEM", "DRAUGHTING_PRE_DEFINED_COLOUR('yellow')");
    let document = read(&finished(&mut w, model));
    let said = |k: usize| (document.attributes[k].name.as_deref(), document.attributes[k].colour);
    assert_eq!(said(0), (Some("Stirnfläche"), Some(Colour([255, 0, 0]))));
    assert_eq!(said(1), (None, Some(Colour([255, 255, 0]))), "NONE is what some write for no name");
}

#[test]
fn a_face_on_an_invisible_layer_is_left_out_and_never_drawn_as_a_lost_one() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let ([low, _], _, model) = discs(&mut w, ["low", "high"]);
    let styled = colour(&mut w, low, "STYLED_ITEM", "DRAUGHTING_PRE_DEFINED_COLOUR('red')");
    let layer = w.add(format_args!("PRESENTATION_LAYER_ASSIGNMENT('aux','',(#{styled}))"));
    w.add(format_args!("INVISIBILITY((#{layer}))"));
    let document = read(&finished(&mut w, model));
    assert_eq!(document.model.faces().len(), 1);
    assert_eq!(document.attributes[0].name.as_deref(), Some("high"));
    let losses = document.notes.iter().filter(|note| note.kind.is_loss());
    let notes: Vec<String> = losses.map(ToString::to_string).collect();
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].contains(&format!("#{low} ADVANCED_FACE: left out: its layer \"aux\" is invisible")), "{notes:?}");
}

/// A representation of some items in several places, each a MAPPED_ITEM of another one that is shown; these, and the first one.
pub fn mapped(w: &mut Writer, model: u64, count: usize) -> (Vec<u64>, u64) {
    let context = w.context(Units::MillimetreRadian);
    let part = w.add(format_args!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{model}),#{context})"));
    let origin = w.placement([0.0; 3], Z, X);
    let map = w.add(format_args!("REPRESENTATION_MAP(#{origin},#{part})"));
    let item = |w: &mut Writer, k: usize| {
        let place = w.placement([5.0 * k as f64, 0.0, 0.0], Z, X);
        w.add(format_args!("MAPPED_ITEM('',#{map},#{place})"))
    };
    let items: Vec<u64> = (0..count).map(|k| item(w, k)).collect();
    w.add(format_args!("SHAPE_REPRESENTATION('',{},#{context})", list(&items)));
    (items, part)
}

/// The colours of two discs in each place, the lower one first, place by place along x.
fn colours(document: &Document) -> Vec<Option<[u8; 3]>> {
    let at = |face: &scene::Face| {
        let centre = document.model.surfaces()[face.surface].hull().center();
        [centre.x, centre.z].map(|x| x.round() as i64)
    };
    let faces = document.model.faces().iter().zip(&document.attributes);
    let mut all: Vec<_> = faces.map(|(face, said)| (at(face), said.colour.map(|colour| colour.0))).collect();
    all.sort();
    all.into_iter().map(|(_, colour)| colour).collect()
}

const RED: Option<[u8; 3]> = Some([255, 0, 0]);
const GREEN: Option<[u8; 3]> = Some([0, 255, 0]);
const BLUE: Option<[u8; 3]> = Some([0, 0, 255]);

fn named(colour: &str) -> String {
    format!("DRAUGHTING_PRE_DEFINED_COLOUR('{colour}')")
}

#[test]
fn a_face_has_its_own_colour_before_that_of_its_body_and_of_its_instance() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let ([low, _], _, model) = discs(&mut w, ["low", "high"]);
    let (items, _) = mapped(&mut w, model, 2);
    colour(&mut w, low, "STYLED_ITEM", &named("red"));
    colour(&mut w, items[1], "STYLED_ITEM", &named("blue"));
    assert_eq!(colours(&read(&w.file())), [RED, None, RED, BLUE]);
    colour(&mut w, model, "STYLED_ITEM", &named("green"));
    assert_eq!(colours(&read(&w.file())), [RED, GREEN, RED, GREEN]);
}

#[test]
fn what_an_instance_overrides_has_another_colour_there_and_nowhere_else() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let ([low, _], _, model) = discs(&mut w, ["low", "high"]);
    let (items, _) = mapped(&mut w, model, 3);
    let body = colour(&mut w, model, "STYLED_ITEM", &named("green"));
    let face = colour(&mut w, low, "STYLED_ITEM", &named("red"));
    let blue = style(&mut w, &named("blue"));
    w.add(format_args!("OVER_RIDING_STYLED_ITEM('',(#{blue}),#{},#{body})", items[1]));
    w.add(format_args!("CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM('',(#{blue}),#{low},#{face},(#{}))", items[2]));
    assert_eq!(colours(&read(&w.file())), [RED, GREEN, RED, BLUE, BLUE, GREEN]);
}

/// A style whose context is no place that the file shows, as the drawing it is a part of, holds anywhere.
#[test]
fn a_style_by_context_holds_in_that_context() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let ([low, high], _, model) = discs(&mut w, ["low", "high"]);
    let (items, part) = mapped(&mut w, model, 2);
    let drawing = w.add("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(),$)");
    let mut by_context = |item: u64, name: &str, context: u64| {
        let style = style(&mut w, &named(name));
        let style = w.add(format_args!("PRESENTATION_STYLE_BY_CONTEXT((#{style}),#{context})"));
        w.add(format_args!("STYLED_ITEM('',(#{style}),#{item})"));
    };
    by_context(low, "red", items[1]);
    by_context(high, "blue", part);
    by_context(low, "green", drawing);
    assert_eq!(colours(&read(&w.file())), [GREEN, BLUE, RED, BLUE]);
}

/// What is invisible in one place is left out there, and drawn in the other.
#[test]
fn an_instance_is_invisible_by_itself() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let ([low, _], _, model) = discs(&mut w, ["low", "high"]);
    let (items, _) = mapped(&mut w, model, 3);
    let red = style(&mut w, &named("red"));
    let item = w.add(format_args!("CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM('',(#{red}),#{low},$,(#{}))", items[0]));
    w.add(format_args!("INVISIBILITY((#{item},#{}))", items[2]));
    let document = read(&w.file());
    assert_eq!(colours(&document), [None; 3], "the upper disc in the first place, and both in the second");
    let losses: Vec<String> = document.notes.iter().filter(|n| n.kind.is_loss()).map(ToString::to_string).collect();
    assert!(losses.len() == 2 && losses.iter().all(|note| note.contains("it is invisible")), "{losses:?}");
}

/// In an assembly the relationship, what depends on it, and the use may have a colour.
#[test]
fn a_use_in_an_assembly_has_a_colour() {
    for way in 0..3 {
        let mut w = Writer::new("AUTOMOTIVE_DESIGN");
        let (_, _, model) = discs(&mut w, ["low", "high"]);
        let context = w.context(Units::MillimetreRadian);
        let part = w.add(format_args!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{model}),#{context})"));
        let whole = w.add(format_args!("SHAPE_REPRESENTATION('',(),#{context})"));
        let [from, to] = [0.0, 3.0].map(|x| w.placement([x, 0.0, 0.0], Z, X));
        let place = w.add(format_args!("ITEM_DEFINED_TRANSFORMATION('','',#{from},#{to})"));
        let relation = w.add(format_args!(
            "(REPRESENTATION_RELATIONSHIP('','',#{part},#{whole})REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{place})\
             SHAPE_REPRESENTATION_RELATIONSHIP())"
        ));
        let usage = w.add("NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',$,$,$)");
        let shape = w.add(format_args!("PRODUCT_DEFINITION_SHAPE('','',#{usage})"));
        let dependent = w.add(format_args!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{shape})"));
        colour(&mut w, [relation, dependent, usage][way], "STYLED_ITEM", &named("red"));
        assert_eq!(colours(&read(&w.file())), [RED, RED], "{way}");
    }
}

/// A style that is made of itself ends; one of a curve says nothing of a surface.
#[test]
fn styles_in_themselves_and_of_curves_colour_no_face() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let ([low, high], _, model) = discs(&mut w, ["low", "high"]);
    let own = w.add("COLOUR_RGB('',1.,0.,0.)");
    let curve = w.add(format_args!("CURVE_STYLE('',$,$,#{own})"));
    let style = w.add(format_args!("PRESENTATION_STYLE_ASSIGNMENT((#{curve}))"));
    w.add(format_args!("STYLED_ITEM('',(#{style}),#{low})"));
    let next = w.add("DIRECTION('',(1.,0.,0.))") + 1;
    w.add(format_args!("PRESENTATION_STYLE_ASSIGNMENT((#{next},#{next}))"));
    w.add(format_args!("STYLED_ITEM('',(#{next}),#{high})"));
    let document = read(&finished(&mut w, model));
    assert!(document.attributes.iter().all(|said| said.colour.is_none()));
}

/// 40,000 times the same layer of 40,000 faces, and a face with 100,000 words placed 2,000 times: what is looked up is looked up once.
#[test]
fn layers_and_labels_that_are_named_again_and_again_cost_no_time() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let ([low, _], _, model) = discs(&mut w, [&"word ".repeat(20_000), "high"]);
    let layer = w.add(format_args!("PRESENTATION_LAYER_ASSIGNMENT('far','',{})", list(&vec![1; 40_000])));
    w.add(format_args!("INVISIBILITY({})", list(&vec![layer; 40_000])));
    let context = w.context(Units::MillimetreRadian);
    let items = vec![model; 2_000];
    w.add(format_args!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',{},#{context})", list(&items)));
    let started = std::time::Instant::now();
    let document = read(&w.file());
    assert!(started.elapsed().as_secs_f64() < 20.0, "{:?}", started.elapsed());
    let [first, last] = [0, 2].map(|k| document.attributes[k].name.clone().expect("a name"));
    assert!(std::sync::Arc::ptr_eq(&first, &last), "one text for all places of #{low}");
}

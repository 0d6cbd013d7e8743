//! What may be left out of a file, and the two extensions, against the same surface written in full.

use crate::common::model_bits;
use formats::json;
use models::builtin;
use nurbs::{Direction, KnotVector};
use scene::Model;

fn parse(text: &str) -> Model {
    json::parse(text, "dir/part.json").unwrap_or_else(|e| panic!("{e}"))
}

/// A surface of degree 2 × 1 with 3 × 2 points as a document; `knots_u` and `more` are put in as they are.
fn document(knots_u: &str, more: &str) -> String {
    format!(
        r#"{{"format":"nurbs-neutral","version":1,{more}"surfaces":[{{"degree":[2,1],"nu":3,"nv":2,
        "knots_u":{knots_u},"knots_v":[0,0,1,1],
        "points":[[0,0,0],[0,1,0],[1,0,1],[1,1,1],[2,0,0],[2,1,0]]}}]}}"#
    )
}

#[test]
fn what_is_absent_or_null_has_its_default() {
    let model = parse(&document("[0,0,0,1,1,1]", ""));
    assert_eq!((model.name(), model.faces().len()), ("part.json", 1));
    assert_eq!(model.faces()[0], scene::Face::whole(0));
    assert!(model.surfaces()[0].weights().is_none());
    let null = parse(&document("[0,0,0,1,1,1]", r#""name":null,"faces":null,"#));
    assert_eq!(model, null);
}

#[test]
fn unknown_keys_are_refused_with_their_name_and_place() {
    let refused = |text: &str| formats::json::parse(text, "part.json").unwrap_err().to_string();
    let whole = document("[0,0,0,1,1,1]", "");
    let error = refused(&whole.replace("\"nu\":3", "\"nu\":3,\"weigths\":[1,1,1,1,1,1]"));
    assert!(error.contains("surfaces[0]: there is no key \"weigths\" here"), "{error}");
    let error = refused(&document("[0,0,0,1,1,1]", "\"comment\":\"x\","));
    assert!(error.contains("the document: there is no key \"comment\" here"), "{error}");
    let error = refused(&document("[0,0,0,1,1,1]", r#""faces":[{"surface":0,"tolerence":1}],"#));
    assert!(error.contains("faces[0]: there is no key \"tolerence\" here"), "{error}");
    let error = refused(&document("[0,0,0,1,1,1]", r#""faces":[{"surface":0,"loops":[{"\u001b[2J":1}]}],"#));
    assert!(error.contains(r#"faces[0].loops[0]: there is no key "\u{1b}[2J" here"#), "{error}");
}

/// `isophote scene` writes a model with a view; it opens as a model again.
#[test]
fn what_a_scene_adds_is_read_over_however_deep_it_is() {
    let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    let more = format!(r#""view":{{"a":[1,{{"b":null}}]}},"meta":{deep},"faces":[{{"surface":0,"pixel":0.1}}],"#);
    assert_eq!(parse(&document("[0,0,0,1,1,1]", &more)), parse(&document("[0,0,0,1,1,1]", "")));
}

#[test]
fn counts_may_be_written_as_floats() {
    let text = document("[0,0,0,1,1,1]", "").replace("\"nu\":3", "\"nu\":3.0").replace("[2,1],\"nu", "[2.0,1e0],\"nu");
    assert_eq!(parse(&text), parse(&document("[0,0,0,1,1,1]", "")));
}

#[test]
fn short_knot_vectors_gain_their_end_knots() {
    let full = parse(&document("[0,0,0,1,1,1]", ""));
    let whole_file = document("[0,0,1,1]", r#""knot_convention":"short","#).replace("[0,0,1,1],\n", "[0,1],\n");
    assert_eq!(parse(&whole_file), full);
    let one_surface =
        document("[0,0,1,1]", "").replace("\"knots_v\":[0,0,1,1]", "\"knots_v\":[0,1],\"knot_convention\":\"short\"");
    assert_eq!(parse(&one_surface), full);
    let surface_overrides = document("[0,0,0,1,1,1]", r#""knot_convention":"short","#)
        .replace("\"nu\":3", "\"nu\":3,\"knot_convention\":\"full\"");
    assert_eq!(parse(&surface_overrides), full);
}

#[test]
fn the_missing_end_knots_of_an_unclamped_vector_do_not_move_the_surface() {
    let full = parse(&document("[-1,0.5,1,2,3,7]", ""));
    let short = parse(&document("[0.5,1,2,3]", r#""knot_convention":"short","#).replace("[0,0,1,1],\n", "[0,1],\n"));
    let [a, b] = [&full, &short].map(|m| &m.surfaces()[0]);
    assert_eq!(a.domain(), b.domain());
    for k in 0..=8 {
        let u = 1.0 + f64::from(k) / 8.0;
        assert!(a.point(u, 0.3).distance(b.point(u, 0.3)) < 1e-15);
    }
}

#[test]
fn trims_follow_the_convention_of_the_file_or_their_own() {
    let face = |knots: &str, own: &str| {
        format!(
            r#""faces":[{{"surface":0,"loops":[{{"outer":true,"trims":[
            {{"degree":2,{own}"knots":{knots},"points":[[0,0],[1,0],[1,1],[0,1],[0,0]],"edge":7}}]}}]}}],"#
        )
    };
    let full = parse(&document("[0,0,0,1,1,1]", &face("[0,0,0,0.5,0.5,1,1,1]", "")));
    let own = parse(&document("[0,0,0,1,1,1]", &face("[0,0,0.5,0.5,1,1]", r#""knot_convention":"short","#)));
    assert_eq!(own, full);
    let trim = &full.faces()[0].loops[0].trims[0];
    assert_eq!((trim.edge, trim.reversed, trim.seam, trim.degenerate), (Some(7), false, false, false));
    let more = format!(r#""knot_convention":"short",{}"#, face("[0,0,0.5,0.5,1,1]", ""));
    assert_eq!(parse(&document("[0,0,1,1]", &more).replace("[0,0,1,1],\n", "[0,1],\n")), full);
}

#[test]
fn a_periodic_direction_is_unrolled_and_its_points_repeat() {
    // The built-in vase, written as one period.
    let vase = builtin("periodic").unwrap();
    let surface = &vase.surfaces()[0];
    let [nu, nv] = surface.control_counts();
    let period = &surface.knots(Direction::U).knots()[3..=nu];
    let points: Vec<[f64; 3]> = surface.points()[..(nu - 3) * nv].iter().map(|p| p.to_array()).collect();
    let text = format!(
        r#"{{"format":"nurbs-neutral","version":1,"surfaces":[{{"degree":[3,3],"nu":{},"nv":{nv},"periodic":[true,false],
        "knots_u":{period:?},"knots_v":{:?},"points":{points:?}}}]}}"#,
        nu - 3,
        surface.knots(Direction::V).knots()
    );
    assert!(model_bits(&parse(&text)) == model_bits(&vase));
    // The convention has no say in a period, only in the other direction.
    let short = text
        .replace("\"periodic\"", "\"knot_convention\":\"short\",\"periodic\"")
        .replace("[0.0, 0.0, 0.0, 0.0, ", "[0.0, 0.0, 0.0, ")
        .replace(", 1.0, 1.0, 1.0, 1.0]", ", 1.0, 1.0, 1.0]");
    assert_ne!(short, text);
    assert!(model_bits(&parse(&short)) == model_bits(&vase));
}

#[test]
fn weights_repeat_with_a_period_shorter_than_the_degree() {
    let text = r#"{"format":"nurbs-neutral","version":1,"surfaces":[{"degree":[1,3],"nu":2,"nv":2,
        "periodic":[false,true],"knots_u":[0,0,1,1],"knots_v":[0,1,3],
        "points":[[0,0,0],[0,1,0],[1,0,1],[1,1,1]],"weights":[1,2,3,4]}]}"#;
    let model = parse(text);
    let surface = &model.surfaces()[0];
    assert_eq!(surface.control_counts(), [2, 5]);
    assert_eq!(surface.weights().unwrap(), [1.0, 2.0, 1.0, 2.0, 1.0, 3.0, 4.0, 3.0, 4.0, 3.0]);
    assert_eq!(surface.knots(Direction::V), &KnotVector::periodic(3, &[0.0, 1.0, 3.0]).unwrap());
}

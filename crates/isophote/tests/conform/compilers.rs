//! Pixels in which two compilers differ are counted, and the table of compilers fits a terminal.

use crate::setting::{AGREEING, Wrong, gpu};
use isophote::conform::compilers::table;
use isophote::conform::report::Subject;
use isophote::conform::run::{Adapter, unlike};
use isophote::stage::{Plan, Stage};
use isophote::view::ModelArgs;
use scene::{Camera, Viewport};

#[test]
fn one_pixel_that_is_moved_is_unlike_and_nothing_else_is() {
    let model = ModelArgs::named("sphere").read().expect("a built-in model").model;
    let viewport = Viewport::new(24, 24).expect("a legal size");
    let stage = Stage::new(&model, Camera::framing(&model, viewport), viewport, Plan::default()).expect("it is drawn");
    let [right, again] = [gpu().draw(&stage), gpu().draw(&stage)].map(|drawn| drawn.expect("a picture").gbuffer);
    let wrong = Wrong(gpu()).draw(&stage).expect("a picture").gbuffer;
    assert_eq!([unlike(&right, &again), unlike(&right, &wrong)], [0, 1]);
}

#[test]
fn compilers_are_told_apart_only_where_there_are_two() {
    let mut report = AGREEING.clone();
    assert!(table(&report).is_none());
    let naga = report.subjects.iter().find(|subject| subject.kind != "cpu").expect("an adapter").clone();
    let id = format!("{} | tint", naga.id);
    for case in &mut report.cases {
        let mut outcome = case.outcomes.iter().find(|outcome| outcome.subject == naga.id).expect("it drew").clone();
        (outcome.subject, outcome.unlike) = (id.clone(), Some(7));
        case.outcomes.push(outcome);
    }
    report.subjects.push(Subject { id, compiler: "tint".to_owned(), ..naga });
    let text = table(&report).expect("two compilers").to_string();
    let last = text.lines().rev().nth(1).expect("a row");
    assert!(last.contains("tint") && last.contains(&(7 * report.cases.len()).to_string()), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

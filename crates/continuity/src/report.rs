//! A whole model judged: every shared edge worst first, and what else of its borders and faces an engineer asks for.

use crate::border::{Border, Origin};
use crate::borders::borders;
use crate::certify::{Certificate, Degenerate, Joint, Place};
use crate::curvature::{FaceCurvature, face_curvature};
use crate::limits::{Class, Limits, Verdict};
use crate::measure::Criterion;
use crate::neighbours::{Source, neighbours};
use crate::sliver::mean_widths;
use rayon::prelude::*;
use scene::{FaceId, Model};
use serde::Serialize;

/// The share of the model's diagonal that a reach is at most.
const GREATEST_REACH: f64 = 1e-3;

/// The reach, in limits of the gap.
const REACH: f64 = 10.0;

/// Chords of a piece in a picture: a quarter of a circle 1,000 pixels large is off by a seventh of one.
const PATH: usize = 32;

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Settings {
    /// The greatest deviations.
    pub limits: Limits,
    /// How many millimetres a unit of the model is: the classes are stated in them.
    pub millimetres: f64,
    /// How far apart borders may run, model units, that are taken for neighbours where the file names none.
    pub reach: f64,
    /// The curvature below which a surface counts as flat, 1 / model units: over the model's diagonal it bends by less than the
    /// limit of the gap.
    pub flat: f64,
}

impl Settings {
    /// Those for a model in millimetres: the reach is ten times the limit of the gap, and at most 1/1000 of the model's diagonal.
    pub fn new(limits: Limits, model: &Model) -> Self {
        let size = model.hull().diagonal();
        // A chord's height is κ d² / 8.
        Self {
            limits,
            millimetres: 1.0,
            reach: (REACH * limits.gap).min(GREATEST_REACH * size),
            flat: 8.0 * limits.gap / (size * size),
        }
    }
}

/// A border of a face, named.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Named {
    /// Its face, counted in the model.
    pub face: u32,
    /// The face's number in its file.
    pub number_in_file: usize,
    /// `loop 0, trim 3` or `side u0`.
    pub border: String,
    /// Length by chords, model units.
    pub length: f64,
    /// Points along it, for a picture.
    #[serde(skip)]
    pub path: Vec<[f64; 3]>,
}

/// A place, for machines.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct At {
    /// Share of the first border's length.
    pub share: f64,
    /// Point in space.
    pub position: [f64; 3],
    /// Parameters on both faces.
    pub uv: [[f64; 2]; 2],
}

/// The answer for one criterion of an edge.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// At least this, at the place.
    pub seen: f64,
    /// Nowhere more.
    pub bound: f64,
    /// Where it was seen.
    pub at: At,
    /// `None` where it is not judged.
    pub verdict: Option<Verdict>,
}

/// A place where an edge has no proven normal or direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DegeneratePlace {
    /// What has no bound there.
    pub criterion: Criterion,
    /// How much of the edge is left out, model units.
    pub length: f64,
    /// Where.
    pub at: At,
}

/// An edge that two faces share.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EdgeReport {
    /// The edge's number in the file; `None` where matching found it.
    pub edge: Option<i64>,
    /// The two borders.
    pub borders: [Named; 2],
    /// The worst answer.
    pub verdict: Verdict,
    /// The finest class whose limits of gap and angle the bounds keep.
    pub class: Option<Class>,
    /// Model units.
    pub gap: Answer,
    /// Degrees.
    pub angle_deg: Answer,
    /// Relative.
    pub curvature: Answer,
    /// 1 / model units.
    pub curvature_difference: Answer,
    /// Places that angle and curvature are not about.
    pub degenerate: Vec<DegeneratePlace>,
    /// Whether corresponding places are proven feet of perpendiculars everywhere.
    pub is_perpendicular: bool,
    /// Whether the file turns the two faces alike.
    pub is_turned_alike: bool,
}

/// An edge at which three or more borders meet.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NonManifold {
    /// The edge's number in the file.
    pub edge: Option<i64>,
    /// The borders; each after the first is judged against it.
    pub borders: Vec<Named>,
}

/// An end of a border within another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Junction {
    /// The border that goes on.
    pub through: Named,
    /// The one that ends.
    pub ending: Named,
    /// Where.
    pub position: [f64; 3],
}

/// What is said of a face by itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaceReport {
    /// The face, counted in the model.
    pub face: u32,
    /// Its number in its file.
    pub number_in_file: usize,
    /// The least radius of curvature is at least this, model units; nought where no bound was found.
    pub least_radius_bound: f64,
    /// A radius that is there; `None` of a flat face.
    pub least_radius_seen: Option<f64>,
    /// Where.
    pub at: Option<([f64; 3], [f64; 2])>,
    /// Parameters, position and kind of places without a proven normal: `limit`, `undefined`, or `near` where it only comes close.
    pub degenerate_normals: Vec<([f64; 2], [f64; 3], &'static str)>,
    /// Twice the area over the length of its borders, model units: measured, not bounded.
    pub mean_width: f64,
    /// Whether that is at most the reach.
    pub is_sliver: bool,
}

/// A whole model judged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The model's name.
    pub model: String,
    /// Its hash ([`Model::hash`]).
    pub hash: String,
    /// What was asked.
    pub settings: Settings,
    /// The worst answer of all edges.
    pub verdict: Verdict,
    /// The finest class that all edges reach.
    pub class: Option<Class>,
    /// Whether any neighbours were found by matching: the file does not name them.
    pub is_matched: bool,
    /// Shared edges, worst first.
    pub edges: Vec<EdgeReport>,
    /// Borders, and parts of borders, that meet no other.
    pub free: Vec<Named>,
    /// Edges of three borders and more.
    pub non_manifold: Vec<NonManifold>,
    /// Ends within other borders.
    pub t_junctions: Vec<Junction>,
    /// Borders that are points in space, or shorter than the reach.
    pub points: Vec<Named>,
    /// All faces.
    pub faces: Vec<FaceReport>,
    /// What of the file is not judged, as `info` says it.
    pub notes: Vec<String>,
}

/// Judges a model. Edges and faces are spread over the processor's threads; the answer does not depend on how many.
pub fn report(model: &Model, settings: Settings) -> Report {
    let given = borders(model);
    let widths = mean_widths(model, &given);
    let found = neighbours(given, settings.reach);
    let names = |borders: &[Border]| -> Vec<Named> { borders.iter().map(|border| named(model, border)).collect() };
    let mut joints = vec![];
    let mut non_manifold = vec![];
    for group in &found.groups {
        let edge = match group.source {
            Source::File(edge) => Some(edge),
            Source::Matched => None,
        };
        if 2 < group.borders.len() {
            non_manifold.push(NonManifold { edge, borders: names(&group.borders) });
        }
        let (first, others) = group.borders.split_first().expect("a group has borders");
        joints.extend(others.iter().map(|second| (edge, first, second)));
    }
    let judged = |(edge, first, second): &(Option<i64>, &Border, &Border)| {
        let joint = Joint { first: (*first).clone(), second: (*second).clone(), flat: settings.flat };
        edge_report(model, *edge, &joint, &joint.certify(&settings.limits), &settings)
    };
    let mut edges: Vec<EdgeReport> = joints.par_iter().map(judged).collect();
    let badness = |edge: &EdgeReport| badness(edge, &settings.limits);
    edges.sort_by(|a, b| b.verdict.cmp(&a.verdict).then(badness(b).total_cmp(&badness(a))));
    let ids = (0..model.faces().len() as u32).map(FaceId).collect::<Vec<_>>();
    let face = |id: &FaceId| {
        face_report(model, face_curvature(model, *id, settings.flat), widths[id.0 as usize], settings.reach)
    };
    let is_matched = found.groups.iter().any(|group| group.source == Source::Matched);
    Report {
        model: model.name().to_owned(),
        hash: model.hash(),
        settings,
        verdict: edges.iter().map(|edge| edge.verdict).max().unwrap_or(Verdict::Pass),
        class: worst_class(&edges),
        is_matched,
        free: names(&found.free),
        points: names(&found.points),
        t_junctions: found
            .junctions
            .iter()
            .map(|junction| Junction {
                through: named(model, &junction.through),
                ending: named(model, &junction.ending),
                position: junction.position.to_array(),
            })
            .collect(),
        faces: ids.par_iter().map(face).collect(),
        notes: model.notes().iter().map(|note| note.to_string()).collect(),
        edges,
        non_manifold,
    }
}

/// The finest class that all edges reach; `None` where one reaches none, or there is none.
fn worst_class(edges: &[EdgeReport]) -> Option<Class> {
    let classes: Option<Vec<Class>> = edges.iter().map(|edge| edge.class).collect();
    classes?.into_iter().max()
}

/// How far the worst judged bound is above its limit.
fn badness(edge: &EdgeReport, limits: &Limits) -> f64 {
    let curvature = limits.curvature.map_or(0.0, |limit| edge.curvature.bound / limit);
    (edge.gap.bound / limits.gap).max(edge.angle_deg.bound / limits.angle_deg).max(curvature)
}

fn edge_report(
    model: &Model,
    edge: Option<i64>,
    joint: &Joint,
    found: &Certificate,
    settings: &Settings,
) -> EdgeReport {
    let limits = &settings.limits;
    let keeps = |class: &Class| found.verdict(&class.limits().in_units_of(settings.millimetres)) == Verdict::Pass;
    let verdicts = found.verdicts(limits);
    let answer = |criterion: Criterion, unit: f64| {
        let finding = found.finding(criterion);
        let verdict = verdicts.iter().find(|(judged, _)| *judged == criterion).map(|(_, verdict)| *verdict);
        Answer { seen: finding.seen * unit, bound: finding.bound * unit, at: at(&finding.at), verdict }
    };
    let [first, second] = [&joint.first, &joint.second];
    let is_reversed = [first, second].map(|border| model.faces()[border.face.0 as usize].reversed);
    let degenerate =
        |place: &Degenerate| DegeneratePlace { criterion: place.criterion, length: place.length, at: at(&place.at) };
    EdgeReport {
        edge,
        borders: [named(model, first), named(model, second)],
        verdict: found.verdict(limits),
        class: Class::ALL.into_iter().find(keeps),
        gap: answer(Criterion::Gap, 1.0),
        angle_deg: answer(Criterion::Angle, 1f64.to_degrees()),
        curvature: answer(Criterion::Curvature, 1.0),
        curvature_difference: answer(Criterion::Difference, 1.0),
        degenerate: found.degenerate.iter().map(degenerate).collect(),
        is_perpendicular: found.is_perpendicular,
        is_turned_alike: (first.is_left != second.is_left) == (is_reversed[0] == is_reversed[1]),
    }
}

fn at(place: &Place) -> At {
    At { share: place.share, position: place.position.to_array(), uv: place.uv.map(|uv| uv.to_array()) }
}

fn named(model: &Model, border: &Border) -> Named {
    const SIDES: [&str; 4] = ["side u0", "side u1", "side v0", "side v1"];
    let name = match border.origin {
        Origin::Trim { boundary, trim } => format!("loop {boundary}, trim {trim}"),
        Origin::Side(side) => SIDES[side].to_owned(),
    };
    let number_in_file = model.number_in_file(border.face);
    let steps = PATH * border.count();
    let path = (0..=steps).map(|k| border.at(k as f64 / PATH as f64).position.to_array()).collect();
    Named { face: border.face.0, number_in_file, border: name, length: border.length(), path }
}

fn face_report(model: &Model, found: FaceCurvature, mean_width: f64, reach: f64) -> FaceReport {
    let status = |status: nurbs::NormalStatus| match status {
        nurbs::NormalStatus::Regular => "near",
        nurbs::NormalStatus::Limit => "limit",
        nurbs::NormalStatus::Undefined => "undefined",
    };
    let seen = found.seen.filter(|(curvature, ..)| 0.0 < *curvature);
    FaceReport {
        face: found.face.0,
        number_in_file: model.number_in_file(found.face),
        least_radius_bound: found.bound.map_or(0.0, |bound| if 0.0 < bound { 1.0 / bound } else { f64::INFINITY }),
        least_radius_seen: seen.map(|(curvature, ..)| 1.0 / curvature),
        at: seen.map(|(_, position, uv)| (position.to_array(), uv.to_array())),
        degenerate_normals: found
            .degenerate
            .iter()
            .map(|place| (place.uv.to_array(), place.position.to_array(), status(place.status)))
            .collect(),
        mean_width,
        is_sliver: mean_width <= reach,
    }
}

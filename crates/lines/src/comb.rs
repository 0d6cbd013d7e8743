//! Curvature combs: teeth along borders and sections, each as long as the line is curved there, away from the centre of curvature.
//!
//! The curvature is that of the line in space, from exact derivatives at the foot: of a border by those of its curve in (u, v),
//! of a section by Meusnier's theorem. A chord tells only where a foot is.

use crate::border::curves;
use crate::family::Family;
use crate::line::{BESIDE, Drawing};
use crate::place::{Eye, Place};
use crate::wire::{Wire, WireKind};
use glam::{DVec2, DVec3};
use nurbs::BezierCurve;
use rayon::prelude::*;
use scene::{Camera, FaceId, Model, Viewport};

/// From a foot to the next, pixels.
const STEP: f64 = 5.0;

/// Places at which the length of a border's curve in the picture is measured first, and then to a pixel; not more than the second.
const PLACES: usize = 32;
const MOST_PLACES: f64 = 4096.0;

/// The usual length of a tooth: this share of the picture's smaller side. It is that of the curvature that this share of
/// the teeth keep below, so that one small round does not flatten all other combs.
const HEIGHT: f64 = 0.08;
const USUAL: f64 = 0.75;

/// Teeth are cut at so many times the usual length.
const LONGEST: f64 = 2.0;

/// Tips are joined where curvature changes by no more than this, in usual curvatures, from a tooth to the next: not round corners.
const JUMP: f64 = 0.5;

/// Teeth of two faces at one edge count once: their feet are within this share of a step, and their curvatures of each other.
const SAME_PLACE: f64 = 0.6;
const SAME_CURVATURE: f64 = 0.02;

/// A straight line's curvature is rounding: a share of one over the model's size.
const STRAIGHT: f64 = 1e-6;

/// A tooth.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tooth {
    foot: DVec3,
    /// Toward the centre of curvature, 1 / model unit.
    curvature: DVec3,
}

/// Combs of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Combs {
    /// Teeth whose tips are joined.
    strands: Vec<Vec<Tooth>>,
    /// The curvature of a tooth of usual length, 1 / model unit; `None` where all lines are straight.
    pub curvature: Option<f64>,
    /// The usual length, model units.
    height: f64,
    /// The usual length in the model's middle, pixels.
    pub pixels: f64,
    /// Teeth that are cut.
    pub cut: usize,
}

/// The combs on the sections of a drawing, as far as they are seen, and with `on_borders` on those of the model's faces.
pub fn combs(
    model: &Model,
    camera: &Camera,
    viewport: Viewport,
    drawing: &Drawing,
    on_borders: bool,
    eye: &impl Eye,
) -> Combs {
    let picture = |p: DVec3| camera.picture(viewport, p);
    let mut strands = sections(model, drawing, &picture);
    if on_borders {
        let of_face = |face| on_face(model, FaceId(face as u32), &picture, eye);
        let found: Vec<Vec<Vec<Tooth>>> = (0..model.faces().len()).into_par_iter().map(of_face).collect();
        strands.extend(once(found.into_iter().flatten().collect(), &picture));
    }
    let hull = model.hull();
    let mut all: Vec<f64> = strands.iter().flatten().map(|tooth| tooth.curvature.length()).collect();
    all.retain(|curvature| STRAIGHT < curvature * hull.diagonal());
    all.sort_by(f64::total_cmp);
    let curvature = all.get(((all.len() as f64 * USUAL) as usize).min(all.len().saturating_sub(1))).copied();
    let pixels = HEIGHT * viewport.width().min(viewport.height()) as f64;
    let depth = camera.depth(hull.center());
    let height = pixels / camera.pixels_per_unit(viewport, if depth > 0.0 { depth } else { hull.diagonal() });
    let cut = curvature.map_or(0, |usual| all.iter().filter(|own| LONGEST * usual < **own).count());
    Combs { strands, curvature, height, pixels, cut }
}

impl Combs {
    /// The teeth, and the ways along their tips.
    pub fn wires(&self) -> Vec<Wire> {
        let Some(usual) = self.curvature else { return vec![] };
        let tip = |tooth: &Tooth| {
            let length = (tooth.curvature.length() / usual).min(LONGEST) * self.height;
            tooth.foot - length * tooth.curvature.normalize_or_zero()
        };
        let wire = |points| Wire { kind: WireKind::Combs, points };
        let is_joined = |a: &Tooth, b: &Tooth| a.curvature.distance(b.curvature) <= JUMP * usual;
        let of_strand = |strand: &Vec<Tooth>| {
            let parts = strand.chunk_by(is_joined).filter(|part| 1 < part.len());
            let tips = parts.map(|part| wire(part.iter().map(tip).collect())).collect::<Vec<_>>();
            let teeth = strand.iter().map(|tooth| wire(vec![tooth.foot, tip(tooth)]));
            tips.into_iter().chain(teeth.collect::<Vec<_>>())
        };
        self.strands.iter().flat_map(of_strand).collect()
    }
}

/// Feet at equal steps in the picture, made from places in order. Where there is no tooth, a strand ends.
struct Strands<'a> {
    picture: &'a dyn Fn(DVec3) -> Option<DVec2>,
    done: Vec<Vec<Tooth>>,
    strand: Vec<Tooth>,
    last: Option<DVec2>,
    /// Pixels since the last foot.
    since: f64,
}

impl<'a> Strands<'a> {
    fn new(picture: &'a dyn Fn(DVec3) -> Option<DVec2>) -> Self {
        Self { picture, done: vec![], strand: vec![], last: None, since: f64::INFINITY }
    }

    /// The next place along; `tooth` is asked for where a foot is due.
    fn go(&mut self, position: DVec3, tooth: impl FnOnce() -> Option<Tooth>) {
        let Some(place) = (self.picture)(position) else { return self.end() };
        self.since += self.last.map_or(f64::INFINITY, |last| last.distance(place));
        self.last = Some(place);
        if STEP <= self.since {
            self.since = 0.0;
            match tooth() {
                Some(tooth) => self.strand.push(tooth),
                None => self.cut(),
            }
        }
    }

    fn cut(&mut self) {
        let strand = std::mem::take(&mut self.strand);
        self.done.extend((!strand.is_empty()).then_some(strand));
    }

    fn end(&mut self) {
        self.cut();
        (self.last, self.since) = (None, f64::INFINITY);
    }
}

fn sections(model: &Model, drawing: &Drawing, picture: &dyn Fn(DVec3) -> Option<DVec2>) -> Vec<Vec<Tooth>> {
    let mut strands = Strands::new(picture);
    for line in drawing.lines.iter().filter(|line| line.is_seen) {
        let Family::Sections { normal, .. } = &drawing.families[line.family] else { continue };
        for pair in line.places.windows(2) {
            let length = [pair[0], pair[1]].map(|place| picture(place.position));
            let length = length[0].zip(length[1]).map_or(0.0, |(a, b)| a.distance(b));
            let steps = length.ceil().clamp(1.0, MOST_PLACES) as usize;
            for k in 0..=steps {
                let place = pair[0].toward(&pair[1], k as f64 / steps as f64, model);
                strands.go(place.position, || section_tooth(model, &place, *normal));
            }
        }
        strands.end();
    }
    strands.done
}

/// Meusnier: the curvature of a plane section is the surface's along it, over the cosine between the normals of both. `None` where
/// there is no normal, or the plane touches.
fn section_tooth(model: &Model, place: &Place, plane: DVec3) -> Option<Tooth> {
    let d = model.surface(place.face).second_derivatives(place.uv.x, place.uv.y);
    let n = d.su.cross(d.sv).try_normalize()?;
    let along = plane.cross(n).try_normalize()?;
    let across = plane.cross(along);
    // The direction in (u, v).
    let (e, f, g) = (d.su.length_squared(), d.su.dot(d.sv), d.sv.length_squared());
    let (a, b) = (along.dot(d.su), along.dot(d.sv));
    let [du, dv] = [g * a - f * b, e * b - f * a].map(|x| x / (e * g - f * f));
    let of_surface = (d.suu * du * du + 2.0 * d.suv * du * dv + d.svv * dv * dv).dot(n);
    let curvature = of_surface / across.dot(n) * across;
    curvature.is_finite().then_some(Tooth { foot: place.position, curvature })
}

/// The strands of the borders of a face, as far as they are seen.
fn on_face(model: &Model, face: FaceId, picture: &dyn Fn(DVec3) -> Option<DVec2>, eye: &impl Eye) -> Vec<Vec<Tooth>> {
    let mut strands = Strands::new(picture);
    let mut end = None;
    for curve in curves(model, face) {
        if end.is_some_and(|end: DVec2| end != curve.start()) {
            strands.end();
        }
        end = Some(curve.end());
        let surface = model.surface(face);
        let place = |t: f64| picture(surface.point(curve.point(t).x, curve.point(t).y));
        let places: Vec<Option<DVec2>> = (0..=PLACES).map(|k| place(k as f64 / PLACES as f64)).collect();
        let length = |pair: &[Option<DVec2>]| pair[0].zip(pair[1]).map_or(0.0, |(a, b)| a.distance(b));
        let length: f64 = places.windows(2).map(length).sum();
        let steps = length.ceil().clamp(1.0, MOST_PLACES) as usize;
        for k in 0..=steps {
            let t = k as f64 / steps as f64;
            let foot = Place::new(model, face, curve.point(t));
            let tooth = || border_tooth(model, &foot, &curve, t).filter(|_| eye.sees(&foot, BESIDE));
            strands.go(foot.position, tooth);
        }
    }
    strands.end();
    strands.done
}

/// `None` where the curve stands still in space.
fn border_tooth(model: &Model, foot: &Place, curve: &BezierCurve, t: f64) -> Option<Tooth> {
    let d = model.surface(foot.face).second_derivatives(foot.uv.x, foot.uv.y);
    let [first, second] = derivatives(curve, t);
    let speed = d.su * first.x + d.sv * first.y;
    let bend = d.suu * first.x * first.x + 2.0 * d.suv * first.x * first.y + d.svv * first.y * first.y;
    let bend = bend + d.su * second.x + d.sv * second.y;
    let along = speed.try_normalize()?;
    let curvature = (bend - bend.dot(along) * along) / speed.length_squared();
    curvature.is_finite().then_some(Tooth { foot: foot.position, curvature })
}

/// C' and C'' of a rational curve, by the quotient rule on its homogeneous control points (The NURBS Book, A4.2).
fn derivatives(curve: &BezierCurve, t: f64) -> [DVec2; 2] {
    let hodograph = |control: &[DVec3]| {
        let degree = control.len().saturating_sub(1) as f64;
        control.windows(2).map(|pair| degree * (pair[1] - pair[0])).collect::<Vec<_>>()
    };
    let at = |control: &[DVec3]| {
        let mut row = control.to_vec();
        while 1 < row.len() {
            row = row.windows(2).map(|pair| pair[0].lerp(pair[1], t)).collect();
        }
        row.first().copied().unwrap_or_default()
    };
    let control = curve.control();
    let once = hodograph(control);
    let [a, a1, a2] = [at(control), at(&once), at(&hodograph(&once))];
    let c = a.truncate() / a.z;
    let c1 = (a1.truncate() - a1.z * c) / a.z;
    [c1, (a2.truncate() - 2.0 * a1.z * c1 - a2.z * c) / a.z]
}

/// Strands without the teeth that an earlier strand has, too: those of the other face of an edge.
fn once(strands: Vec<Vec<Tooth>>, picture: &dyn Fn(DVec3) -> Option<DVec2>) -> Vec<Vec<Tooth>> {
    let reach = SAME_PLACE * STEP;
    let cell = |p: DVec2| (p / reach).floor().as_i64vec2().to_array();
    let is_same = |a: &Tooth, b: &Tooth| {
        let most = a.curvature.length().max(b.curvature.length());
        a.curvature.distance(b.curvature) <= SAME_CURVATURE * most
    };
    let mut held: std::collections::HashMap<[i64; 2], Vec<(DVec2, Tooth)>> = Default::default();
    let mut kept = vec![];
    for strand in strands {
        let places: Vec<Option<DVec2>> = strand.iter().map(|tooth| picture(tooth.foot)).collect();
        let is_new = |(tooth, place): (&Tooth, &Option<DVec2>)| {
            let Some(place) = place else { return false };
            let [x, y] = cell(*place);
            let near = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
            !near
                .filter_map(|cell| held.get(&cell))
                .flatten()
                .any(|(other, of_other)| other.distance(*place) <= reach && is_same(tooth, of_other))
        };
        let is_new: Vec<bool> = strand.iter().zip(&places).map(is_new).collect();
        let parts: Vec<(Tooth, bool)> = strand.iter().copied().zip(is_new).collect();
        kept.extend(
            parts
                .split(|(_, is_new)| !is_new)
                .filter(|part| !part.is_empty())
                .map(|part| part.iter().map(|(tooth, _)| *tooth).collect::<Vec<_>>()),
        );
        for (tooth, place) in strand.iter().zip(places) {
            if let Some(place) = place {
                held.entry(cell(place)).or_default().push((place, *tooth));
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs::{KnotVector, Surface};
    use scene::Projection;

    /// Nothing is cut away, and nothing hides anything but what is below z = 0.
    struct Above;

    impl Eye for Above {
        fn has_material(&self, _: FaceId, _: DVec2) -> bool {
            true
        }

        fn sees(&self, place: &Place, _: f64) -> bool {
            0.0 <= place.position.z
        }
    }

    /// A quarter of a cylinder of radius 2 about the y axis, 3 long, from +x over +z.
    fn quarter() -> Model {
        let arc = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).unwrap();
        let straight = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        let corners = [DVec3::new(2.0, 0.0, 0.0), DVec3::new(2.0, 0.0, 2.0), DVec3::new(0.0, 0.0, 2.0)];
        let points = corners.into_iter().flat_map(|p| [p, p + 3.0 * DVec3::Y]).collect();
        let weights = [1.0, 0.5f64.sqrt(), 1.0].into_iter().flat_map(|w| [w, w]).collect();
        let surface = Surface::new(arc, straight, points, Some(weights)).unwrap();
        Model::of_surfaces("quarter", vec![surface]).unwrap()
    }

    fn seen() -> (Camera, Viewport) {
        let projection = Projection::Orthographic { height: 6.0 };
        let camera = Camera::look_at(DVec3::new(9.0, -9.0, 9.0), DVec3::ZERO, DVec3::Z, projection).unwrap();
        (camera, Viewport::new(300, 300).unwrap())
    }

    fn teeth(families: &[Family], on_borders: bool) -> Vec<Tooth> {
        let (model, (camera, viewport)) = (quarter(), seen());
        let drawing = crate::line::draw(&model, &camera, viewport, families, &Above);
        combs(&model, &camera, viewport, &drawing, on_borders, &Above).strands.concat()
    }

    #[test]
    fn the_arcs_of_a_cylinder_have_one_over_its_radius_and_its_straight_sides_none() {
        let teeth = teeth(&[], true);
        assert!(50 < teeth.len(), "{}", teeth.len());
        for tooth in &teeth {
            let is_on_end = (tooth.foot.y - 1.5).abs() > 1.5 - 1e-9;
            // At a corner a tooth is of either.
            let is_corner = is_on_end && !(1e-9..2.0 - 1e-9).contains(&tooth.foot.x);
            let expected = if is_on_end { -0.25 * tooth.foot.with_y(0.0) } else { DVec3::ZERO };
            assert!(is_corner || tooth.curvature.distance(expected) < 1e-12, "{tooth:?}");
        }
    }

    /// A plane across the axis cuts an arc, and one that leans an ellipse: at the top its radius of curvature is a² / b, with the
    /// half-axis a = 2 √2 along the lean and b = 2.
    #[test]
    fn sections_have_the_curvature_of_circle_and_ellipse() {
        let circle = teeth(&[Family::Sections { normal: DVec3::Y, distances: vec![1.0] }], false);
        assert!(20 < circle.len());
        assert!(circle.iter().all(|tooth| (tooth.curvature.length() - 0.5).abs() < 1e-9), "{circle:?}");
        let lean = DVec3::new(1.0, 1.0, 0.0).normalize();
        let ellipse = teeth(&[Family::Sections { normal: lean, distances: vec![2.0] }], false);
        let top = ellipse.iter().max_by(|a, b| a.foot.z.total_cmp(&b.foot.z)).unwrap();
        // κ = a b / (a² sin² + b² cos²)^1.5 where x = 2 cos, z = 2 sin.
        let (cos, sin) = (top.foot.x / 2.0, top.foot.z / 2.0);
        let (a, b) = (8f64.sqrt(), 2.0);
        let expected = a * b / ((a * sin).powi(2) + (b * cos).powi(2)).powf(1.5);
        assert!((top.curvature.length() / expected - 1.0).abs() < 1e-6, "{top:?} {expected}");
    }

    #[test]
    fn what_is_not_seen_has_no_teeth_and_straight_lines_no_combs() {
        let (camera, viewport) = seen();
        let sheet = |z: f64| {
            let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
            let points = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::X + DVec3::Y];
            let points = points.into_iter().map(|p| p + z * DVec3::Z).collect();
            Model::of_surfaces("sheet", vec![Surface::new(knots(), knots(), points, None).unwrap()]).unwrap()
        };
        for (z, has_teeth) in [(0.5, true), (-0.5, false)] {
            let model = sheet(z);
            let drawing = crate::line::draw(&model, &camera, viewport, &[], &Above);
            let combs = combs(&model, &camera, viewport, &drawing, true, &Above);
            assert_eq!(!combs.strands.is_empty(), has_teeth, "{z}");
            assert_eq!((combs.curvature, combs.wires()), (None, vec![]));
        }
    }

    /// Two faces meet at an arc: it has one comb, of the steps that one face has by itself.
    #[test]
    fn an_edge_of_two_faces_has_one_comb() {
        let (camera, viewport) = seen();
        let one = quarter();
        let other = one.surfaces()[0].points().iter().map(|p| DVec3::new(p.x, -p.y, p.z)).collect();
        let surface = &one.surfaces()[0];
        let knots = |direction| surface.knots(direction).clone();
        let (u, v) = (knots(nurbs::Direction::U), knots(nurbs::Direction::V));
        let mirrored = Surface::new(u, v, other, surface.weights().map(<[f64]>::to_vec)).unwrap();
        let both = Model::of_surfaces("both", vec![surface.clone(), mirrored]).unwrap();
        let count = |model: &Model| {
            let drawing = crate::line::draw(model, &camera, viewport, &[], &Above);
            let strands = combs(model, &camera, viewport, &drawing, true, &Above).strands;
            strands.iter().flatten().filter(|tooth| tooth.foot.y == 0.0).count()
        };
        let (alone, shared) = (count(&one), count(&both));
        assert!(10 < alone && alone <= shared && shared <= alone + 4, "{alone} {shared}");
    }
}

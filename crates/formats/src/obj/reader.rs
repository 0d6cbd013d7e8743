//! Reads statement by statement: vertices and attributes are kept, elements are built at their `end`.

use super::element::{Basis, Element, Kind, Part};
use super::statements::Statement;
use crate::document::{Attributes, Document, Note, NoteKind, name};
use crate::error::{Cause, FormatError, shorten};
use crate::format::file_name;
use crate::place::Place;
use crate::spline::Spline;
use glam::{DVec3, DVec4};
use nurbs::Surface;
use scene::{Face, FaceId, Model};
use std::collections::BTreeMap;
use std::str::FromStr;
use std::sync::Arc;

/// How often each control point of the file's curves may be used in loops, on average.
const USES: usize = 16;

/// Statements that are not drawn, and why. Those of one kind are one note.
const NOT_DRAWN: &[(&str, &str)] = &[
    ("f", "polygons are not drawn"),
    ("fo", "polygons are not drawn"),
    ("l", "lines are not drawn"),
    ("p", "points are not drawn"),
    ("curv", "curves in space are not drawn"),
    ("scrv", "special curves are not drawn: they are for triangles"),
    ("sp", "special points are not drawn: they are for triangles"),
    ("con", "which borders meet is not used"),
    ("call", "no other file is read"),
    ("csh", "no command is run"),
    ("bsp", "a superseded statement"),
    ("bzp", "a superseded statement"),
    ("cdc", "a superseded statement"),
    ("cdp", "a superseded statement"),
    ("res", "a superseded statement"),
];

/// Statements that say nothing of shapes.
const READ_OVER: &[&str] = &[
    "vt",
    "vn",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "bmat",
    "step",
];

/// An element from its first statement to its `end`.
struct Open {
    line: usize,
    shape: Shape,
    element: Element,
    /// What it says of `cstype` and `deg`, or why it cannot be built.
    kind: Result<Kind, String>,
    /// The first thing that is wrong with it, and its line.
    fault: Option<(usize, String)>,
}

#[derive(Clone, Copy)]
enum Shape {
    Surface([[f64; 2]; 2]),
    Curve,
    /// In space; it is not drawn.
    SpaceCurve,
}

/// What has been read so far.
#[derive(Default)]
pub(super) struct Reader {
    /// (x, y, z) and the weight; `None` for one that makes no sense, so that numbers stay.
    vertices: Vec<Option<(DVec3, f64)>>,
    /// (u, v) and the weight, likewise.
    parameters: Vec<Option<DVec3>>,
    /// Of `cstype`: the basis, or why it is not converted; whether weights count.
    basis: Option<(Result<Basis, String>, bool)>,
    degrees: Vec<usize>,
    name: Option<Arc<str>>,
    open: Option<Open>,
    /// `None` for one that could not be built, so that numbers stay.
    curves: Vec<Option<Spline>>,
    curve_points: usize,
    used_points: usize,
    surfaces: Vec<Surface>,
    faces: Vec<(usize, Face)>,
    /// The line and the name of each surface of the file.
    origins: Vec<(usize, Option<Arc<str>>)>,
    skipped: BTreeMap<&'static str, (usize, usize, &'static str)>,
    notes: Vec<Note>,
}

fn parse<T: FromStr>(word: Option<&str>, what: &str) -> Result<T, String> {
    let word = word.ok_or_else(|| format!("{what} is missing"))?;
    word.parse().map_err(|_| format!("\"{}\" is not {what}", shorten(word)))
}

fn number(word: Option<&str>) -> Result<f64, String> {
    // Rust also reads "nan" and "inf", and 1e999 as infinity.
    let x: f64 = parse(word, "a number")?;
    if x.is_finite() { Ok(x) } else { Err(format!("{x} is not finite")) }
}

/// The index that a reference names among `count`; one below 0 counts from the last. Only what stands before a slash counts.
fn reference(word: &str, count: usize) -> Result<usize, String> {
    let own = word.split('/').next();
    let index: i64 = parse(own, "a reference")?;
    let from_end = usize::try_from(index.unsigned_abs()).ok().and_then(|back| count.checked_sub(back));
    let found = if index < 0 { from_end } else { usize::try_from(index).ok().and_then(|i| i.checked_sub(1)) };
    found.filter(|i| *i < count).ok_or_else(|| format!("there is no number {index} among {count} before it"))
}

/// A point with its weight.
fn vertex<'w>(words: &mut (impl Iterator<Item = &'w str> + Clone)) -> Result<(DVec3, f64), String> {
    let point = DVec3::new(number(words.next())?, number(words.next())?, number(words.next())?);
    // What follows is a weight, or a colour of three or four numbers.
    match words.clone().count() {
        0 | 3 | 4 => Ok((point, 1.0)),
        1 => Ok((point, number(words.next())?)),
        more => Err(format!("{} numbers are neither a point with its weight nor one with a colour", 3 + more)),
    }
}

/// A point of a parameter space with its weight: u alone, or u and v.
fn parameter<'w>(words: &mut impl Iterator<Item = &'w str>) -> Result<DVec3, String> {
    let u = number(words.next())?;
    let v = words.next().map_or(Ok(0.0), |word| number(Some(word)))?;
    let weight = words.next().map_or(Ok(1.0), |word| number(Some(word)))?;
    Ok(DVec3::new(u, v, weight))
}

impl Reader {
    pub fn statement(&mut self, statement: &Statement) {
        let mut words = statement.text.split_whitespace();
        let Some(keyword) = words.next() else { return };
        let line = statement.line;
        if let Err(text) = self.take(keyword, &mut words, line) {
            match &mut self.open {
                // Its element is not built; what else is wrong with that follows from this.
                Some(open) => {
                    open.fault.get_or_insert((line, format!("{}: {text}", shorten(keyword))));
                }
                None => self.leave_out(line, format!("{}: {text}", shorten(keyword))),
            }
        }
    }

    fn leave_out(&mut self, line: usize, text: String) {
        self.notes.push(Note { kind: NoteKind::LeftOut, place: Place::Line(line), text });
    }

    fn take<'w>(
        &mut self,
        keyword: &str,
        words: &mut (impl Iterator<Item = &'w str> + Clone),
        line: usize,
    ) -> Result<(), String> {
        if let Some((name, why)) = NOT_DRAWN.iter().find(|(name, _)| *name == keyword) {
            self.skipped.entry(name).or_insert((0, line, why)).0 += 1;
        }
        match keyword {
            "v" => {
                let read = vertex(words);
                self.vertices.push(read.as_ref().ok().copied());
                read?;
            }
            "vp" => {
                let read = parameter(words);
                self.parameters.push(read.as_ref().ok().copied());
                read?;
            }
            "g" | "o" => self.name = name(&words.collect::<Vec<_>>().join(" ")),
            "cstype" => {
                let first = words.next();
                let is_rational = first == Some("rat");
                let word = if is_rational { words.next() } else { first }.unwrap_or_default();
                let basis = match word {
                    "bezier" => Ok(Basis::Bezier),
                    "bspline" => Ok(Basis::BSpline),
                    other => Err(format!("cstype \"{}\" (line {line}) is not converted", shorten(other))),
                };
                self.basis = Some((basis, is_rational));
            }
            "deg" => {
                self.degrees.clear();
                for word in words.take(2) {
                    self.degrees.push(parse(Some(word), "a degree")?);
                }
            }
            "surf" => {
                self.begin(line, Shape::Surface([[0.0; 2]; 2]));
                self.origins.push((line, self.name.clone()));
                let range =
                    [[number(words.next())?, number(words.next())?], [number(words.next())?, number(words.next())?]];
                let points =
                    self.points(words, |reader, k| reader.vertices[k].map(|(point, weight)| point.extend(weight)))?;
                self.set(Shape::Surface(range), points);
            }
            "curv2" => {
                self.begin(line, Shape::Curve);
                let points =
                    self.points(words, |reader, k| reader.parameters[k].map(|p| DVec4::new(p.x, p.y, 0.0, p.z)))?;
                self.set(Shape::Curve, points);
            }
            "curv" => self.begin(line, Shape::SpaceCurve),
            "parm" => {
                let direction = match words.next() {
                    Some("u") => 0,
                    Some("v") => 1,
                    _ => return Err("neither u nor v".into()),
                };
                let open = self.open.as_mut().ok_or("no element is open")?;
                open.element.parameters[direction] = words.map(|word| number(Some(word))).collect::<Result<_, _>>()?;
            }
            "trim" | "hole" => {
                let mut parts = vec![];
                while let Some(word) = words.next() {
                    let range = [number(Some(word))?, number(words.next())?];
                    let curve = words.next().ok_or("a curve is missing")?;
                    parts.push(Part { range, curve: reference(curve, self.curves.len())? });
                }
                let points = |part: &Part| self.curves[part.curve].as_ref().map_or(0, |curve| curve.points().len());
                self.used_points += parts.iter().map(points).sum::<usize>();
                if parts.is_empty() {
                    return Err("it has no curve".into());
                }
                if self.used_points > USES * self.curve_points {
                    return Err(format!("loops repeat the file's curves more than {USES} times"));
                }
                let open = self.open.as_mut().ok_or("no element is open")?;
                open.element.loops.push((keyword == "trim", parts));
            }
            "end" => {
                let open = self.open.take().ok_or("no element is open")?;
                self.build(open);
            }
            _ if NOT_DRAWN.iter().any(|(name, _)| *name == keyword) || READ_OVER.contains(&keyword) => {}
            _ => return Err("an unknown statement".into()),
        }
        Ok(())
    }

    /// Homogeneous points of the numbers that follow; `point` gives one with its weight.
    fn points<'w>(
        &self,
        words: impl Iterator<Item = &'w str>,
        point: impl Fn(&Self, usize) -> Option<DVec4>,
    ) -> Result<Vec<DVec4>, String> {
        let of_curve = matches!(self.open, Some(Open { shape: Shape::Curve, .. }));
        let count = if of_curve { self.parameters.len() } else { self.vertices.len() };
        let is_rational = self.basis.as_ref().is_some_and(|(_, is_rational)| *is_rational);
        let mut points = vec![];
        for word in words {
            let k = reference(word, count)?;
            let p = point(self, k).ok_or_else(|| format!("its point {} makes no sense", k + 1))?;
            points.push(if is_rational { (p.truncate() * p.w).extend(p.w) } else { p.truncate().extend(1.0) });
        }
        Ok(points)
    }

    fn begin(&mut self, line: usize, shape: Shape) {
        self.unended();
        let kind = match &self.basis {
            None => Err("no cstype before it".into()),
            Some((Err(text), _)) => Err(text.clone()),
            Some((Ok(basis), _)) => Ok(Kind { basis: *basis, degrees: self.degrees.clone() }),
        };
        self.open = Some(Open { line, shape, element: Element::new(vec![]), kind, fault: None });
    }

    fn set(&mut self, shape: Shape, points: Vec<DVec4>) {
        if let Some(open) = &mut self.open {
            (open.shape, open.element.points) = (shape, points);
        }
    }

    /// An element that is still open has no `end`.
    fn unended(&mut self) {
        if let Some(mut open) = self.open.take() {
            open.fault.get_or_insert((open.line, "it has no end".into()));
            self.build(open);
        }
    }

    /// Builds an element, or notes why it cannot be built.
    fn build(&mut self, open: Open) {
        let Open { line, shape, element, kind, fault } = open;
        let what = match shape {
            Shape::SpaceCurve => return,
            Shape::Curve => format!("curv2 {}", self.curves.len() + 1),
            Shape::Surface(_) => self.surface_label(self.origins.len() - 1),
        };
        let kind = match fault {
            Some((line, text)) => Err((line, text)),
            None => kind.map_err(|text| (line, text)),
        };
        let built = kind.and_then(|kind| match shape {
            Shape::Surface(range) => {
                let surface = element.surface(&kind).map_err(|text| (line, text))?;
                let face = element.face(self.surfaces.len(), range, surface.domain(), &self.curves);
                self.faces.push((self.origins.len() - 1, face.map_err(|text| (line, text))?));
                self.surfaces.push(surface);
                Ok(())
            }
            _ => {
                let curve = element.curve(&kind).map_err(|text| (line, text))?;
                self.curve_points += curve.points().len();
                self.curves.push(Some(curve));
                Ok(())
            }
        });
        if let Err((line, text)) = built {
            if matches!(shape, Shape::Curve) {
                self.curves.push(None);
            }
            self.leave_out(line, format!("{what}: {text}"));
        }
    }

    fn surface_label(&self, number: usize) -> String {
        match self.origins.get(number) {
            Some((_, Some(name))) => format!("surf \"{}\"", shorten(name)),
            _ => "surf".into(),
        }
    }

    /// What has been read, as a document.
    pub fn finish(mut self, file: &str) -> Result<Document, FormatError> {
        self.unended();
        for (keyword, (count, line, why)) in std::mem::take(&mut self.skipped) {
            let text = match count {
                1 => format!("{keyword}: {why}"),
                _ => format!("{count} statements {keyword}, the first here: {why}"),
            };
            self.leave_out(line, text);
        }
        if self.faces.is_empty() {
            let first = self.notes.first();
            let count = self.notes.len();
            let first = first.map_or("it has no surf".into(), |note| format!("the first of {count} notes: {note}"));
            let text = format!("nothing in it can be drawn; {first}");
            return Err(FormatError::new(file, Place::File, Cause::Kind(text)));
        }
        let faces = std::mem::take(&mut self.faces);
        let model = Model::of_sound_faces(file_name(file), std::mem::take(&mut self.surfaces), faces, vec![])
            .map_err(|cause| FormatError::new(file, Place::File, Cause::Scene(cause)))?;
        for note in model.notes() {
            let number = note.face().filter(|number| *number < self.origins.len());
            let place = number.map_or(Place::File, |number| Place::Line(self.origins[number].0));
            let Note { kind, place, text } = Note::of_model(place, note);
            let label = number.map_or(String::new(), |number| format!("{}: ", self.surface_label(number)));
            self.notes.push(Note { kind, place, text: label + &text });
        }
        self.notes.sort_by_key(|note| if let Place::Line(line) = note.place { line } else { 0 });
        let attributes = (0..model.faces().len()).map(|index| {
            let (_, name) = &self.origins[model.number_in_file(FaceId(index as u32))];
            Attributes { name: name.clone(), ..Attributes::default() }
        });
        Ok(Document { attributes: attributes.collect(), model, unit: None, notes: self.notes })
    }
}

//! Bézier patches in text, `.bpt`: the form of Newell's tea set, and the form that gives degrees.
//!
//! Both begin with the number of patches on a line of its own; the next line tells them apart. Numbers are separated
//! by blanks or commas; blank lines are skipped; both kinds of line end are accepted.
//!
//! Indexed, bicubic: for each patch a line of 16 one-based vertex numbers, then the number of vertices, then for
//! each vertex a line of three coordinates.
//!
//! ```text
//! 1
//! 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16
//! 16
//! 1.4 0.0 2.4
//! …
//! ```
//!
//! With degrees: for each patch a line `p q` and then (p + 1)(q + 1) lines of three coordinates.
//!
//! ```text
//! 1
//! 3 3
//! 1.4 0.0 2.4
//! …
//! ```
//!
//! In both the first parameter's index varies slowest. A patch becomes a polynomial surface over the unit square and
//! a whole face; the model bears the file's name.

use crate::document::Document;
use crate::error::{Cause, FormatError, shorten};
use crate::format::{Format, file_name, text, text_head};
use crate::member::Member;
use crate::place::Place;
use glam::DVec3;
use nurbs::{KnotVector, MAX_DEGREE, Surface};
use scene::Model;

/// Vertex numbers of a patch of the indexed form.
const PATCH_INDICES: usize = 16;

/// The format.
pub struct Bpt;

impl Format for Bpt {
    fn name(&self) -> &'static str {
        ".bpt"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["bpt"]
    }

    fn start(&self) -> &'static str {
        "starts with a count"
    }

    fn sniff(&self, head: &[u8]) -> bool {
        let first = text_head(head).lines().map(str::trim).find(|line| !line.is_empty());
        first.is_some_and(|line| line.parse::<usize>().is_ok())
    }

    fn read(&self, bytes: &[u8], file: &str) -> Result<Document, FormatError> {
        Ok(Document::of_model(parse(text(bytes, file)?, file)?))
    }
}

/// Reads a model from the text of a `.bpt` file; `file` names it in messages and its last component names the model.
///
/// # Errors
/// [`Cause::Found`] and [`Cause::Truncated`] with the number of the line; [`Cause::Nurbs`] for coordinates too large.
pub fn parse(text: &str, file: &str) -> Result<Model, FormatError> {
    let mut lines = Lines::new(text, file);
    let patches = lines.count("the number of patches")?;
    let words = lines.peek("the first patch")?.split(separator).filter(|w| !w.is_empty()).count();
    let surfaces = if words == 2 { with_degrees(&mut lines, patches)? } else { indexed(&mut lines, patches)? };
    if let Some((line, text)) = lines.next {
        return Err(lines.line_error(line, text, "the end of the file"));
    }
    let document = Member::document(file);
    Model::of_surfaces(file_name(file), surfaces).map_err(|cause| document.scene(cause))
}

fn indexed(lines: &mut Lines, patches: usize) -> Result<Vec<Surface>, FormatError> {
    let mut indices = vec![];
    for _ in 0..patches {
        let (line, words) = lines.words::<PATCH_INDICES>("16 vertex numbers")?;
        let mut patch = [0u32; PATCH_INDICES];
        for (k, word) in patch.iter_mut().zip(words) {
            *k = word.parse().map_err(|_| lines.line_error(line, word, "a vertex number"))?;
        }
        indices.push((line, patch));
    }
    let vertices = lines.count("the number of vertices")?;
    let points = lines.points(vertices)?;
    let mut surfaces = vec![];
    for (line, patch) in indices {
        let mut grid = Vec::with_capacity(PATCH_INDICES);
        for k in patch {
            let point = (k as usize).checked_sub(1).and_then(|k| points.get(k));
            let expected = || format!("a vertex number from 1 to {vertices}");
            grid.push(*point.ok_or_else(|| lines.line_error(line, &k.to_string(), expected()))?);
        }
        surfaces.push(lines.surface(surfaces.len(), [3, 3], grid)?);
    }
    Ok(surfaces)
}

fn with_degrees(lines: &mut Lines, patches: usize) -> Result<Vec<Surface>, FormatError> {
    let mut surfaces = vec![];
    for _ in 0..patches {
        let (line, words) = lines.words::<2>("the two degrees of a patch")?;
        let mut degree = [0; 2];
        for (d, word) in degree.iter_mut().zip(words) {
            let legal = word.parse::<usize>().ok().filter(|d| (1..=MAX_DEGREE).contains(d));
            let expected = || format!("a degree from 1 to {MAX_DEGREE}");
            *d = legal.ok_or_else(|| lines.line_error(line, word, expected()))?;
        }
        let grid = lines.points((degree[0] + 1) * (degree[1] + 1))?;
        surfaces.push(lines.surface(surfaces.len(), degree, grid)?);
    }
    Ok(surfaces)
}

fn bezier_knots(degree: usize) -> KnotVector {
    let knots = [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat();
    KnotVector::new(degree, knots).expect("clamped, and the degree was checked")
}

fn separator(c: char) -> bool {
    c == ',' || c.is_whitespace()
}

/// The lines of a file that are not blank, one of them looked at in advance.
struct Lines<'a> {
    file: &'a str,
    rest: std::iter::Enumerate<std::str::Lines<'a>>,
    next: Option<(usize, &'a str)>,
    /// Number of lines not blank, `next` included, that are still to come.
    left: usize,
    last: usize,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str, file: &'a str) -> Self {
        let left = text.lines().filter(|l| !l.trim().is_empty()).count();
        let mut lines = Self { file, rest: text.lines().enumerate(), next: None, left, last: text.lines().count() };
        lines.advance();
        lines
    }

    fn advance(&mut self) {
        self.next = self.rest.by_ref().map(|(i, l)| (i + 1, l.trim())).find(|(_, l)| !l.is_empty());
    }

    fn line_error(&self, line: usize, found: &str, expected: impl Into<String>) -> FormatError {
        let cause = Cause::Found { found: shorten(found), expected: expected.into() };
        FormatError::new(self.file, Place::Line(line), cause)
    }

    fn truncated(&self, expected: impl Into<String>) -> FormatError {
        FormatError::new(self.file, Place::Line(self.last), Cause::Truncated(expected.into()))
    }

    fn peek(&self, expected: &str) -> Result<&'a str, FormatError> {
        Ok(self.next.ok_or_else(|| self.truncated(expected))?.1)
    }

    fn take(&mut self, expected: &str) -> Result<(usize, &'a str), FormatError> {
        let taken = self.next.ok_or_else(|| self.truncated(expected))?;
        self.left -= 1;
        self.advance();
        Ok(taken)
    }

    /// A line with a single number: how many lines, at least, must follow.
    fn count(&mut self, expected: &str) -> Result<usize, FormatError> {
        let (line, text) = self.take(expected)?;
        let legal = text.parse::<usize>().ok().filter(|&n| n > 0);
        let count = legal.ok_or_else(|| self.line_error(line, text, format!("{expected}, a whole number above 0")))?;
        if count > self.left {
            let expected = format!("{expected}, at most the {} lines that follow it,", self.left);
            return Err(self.line_error(line, text, expected));
        }
        Ok(count)
    }

    /// A line of N words, with its number.
    fn words<const N: usize>(&mut self, expected: &str) -> Result<(usize, [&'a str; N]), FormatError> {
        let (line, text) = self.take(expected)?;
        let mut words = [""; N];
        let mut found = 0;
        for word in text.split(separator).filter(|w| !w.is_empty()) {
            if let Some(slot) = words.get_mut(found) {
                *slot = word;
            }
            found += 1;
        }
        if found != N {
            return Err(self.line_error(line, text, expected));
        }
        Ok((line, words))
    }

    fn surface(&self, patch: usize, degree: [usize; 2], points: Vec<DVec3>) -> Result<Surface, FormatError> {
        let [knots_u, knots_v] = degree.map(bezier_knots);
        let place = Member::document(self.file).key("patches").index(patch);
        Surface::new(knots_u, knots_v, points, None).map_err(|cause| place.nurbs(cause))
    }

    fn points(&mut self, count: usize) -> Result<Vec<DVec3>, FormatError> {
        let mut points = Vec::with_capacity(count.min(self.left));
        for _ in 0..count {
            let (line, words) = self.words::<3>("three coordinates")?;
            let mut point = [0.0; 3];
            for (x, word) in point.iter_mut().zip(words) {
                // Rust also reads "nan" and "inf", and 1e999 as infinity.
                let legal = word.parse::<f64>().ok().filter(|x| x.is_finite());
                *x = legal.ok_or_else(|| self.line_error(line, word, "a finite coordinate"))?;
            }
            points.push(DVec3::from_array(point));
        }
        Ok(points)
    }
}

//! Edges of a model drawn over a picture of it, in colours by what `continuity` says of each.
//!
//! A line is drawn where the edge is seen: where no pixel around it, of the G-buffer that the picture was made of, shows one of
//! the edge's own faces, or nothing, at its depth, something is in front. Lines have a light border, so that they stand out from
//! stripes. The worst class is drawn last.

use crate::brush::{Brush, STEP};
use anyhow::Result;
use continuity::{Class, EdgeReport, Named, Report, Verdict};
use gbuffer::{GBuffer, Picture};
use glam::{DVec2, DVec3};
use scene::{Camera, Viewport};

/// Half the width of a line and of its border, pixels.
const LINE: f64 = 0.9;
const BORDER: f64 = 2.0;

/// How much of what is below its border covers.
const BORDER_STRENGTH: f64 = 0.75;

/// The most steps along one chord: those of a close-up are mostly outside.
const MOST_STEPS: f64 = 1e4;

/// How far behind the farthest of the faces around it an edge may lie and be seen, pixels at its depth. What a slope hides
/// within a pixel, the pixels beside it show.
const BEHIND: f64 = 1.0;

/// What is said of an edge, from the best to the worst: the order of drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mark {
    /// It has one face.
    Free,
    /// It keeps class A.
    A,
    /// It keeps class B.
    B,
    /// It keeps class C.
    C,
    /// Nothing coarser is proven, and nothing worse was seen.
    Undecided,
    /// It keeps no class.
    Fail,
}

impl Mark {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Free, Self::A, Self::B, Self::C, Self::Undecided, Self::Fail];

    /// That of an edge.
    pub fn of(edge: &EdgeReport) -> Self {
        match (edge.class, edge.verdict) {
            (Some(Class::A), _) => Self::A,
            (Some(Class::B), _) => Self::B,
            (Some(Class::C), _) => Self::C,
            (None, Verdict::Undecided) => Self::Undecided,
            (None, _) => Self::Fail,
        }
    }

    /// Its colour; distinct to eyes that see red and green alike, too, by how dark it is.
    pub fn colour(self) -> [u8; 3] {
        match self {
            Self::Free => [130, 130, 130],
            Self::A => [11, 122, 75],
            Self::B => [36, 86, 201],
            Self::C => [226, 138, 0],
            Self::Undecided => [142, 36, 170],
            Self::Fail => [208, 20, 30],
        }
    }

    /// Its name in a legend.
    pub fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::A => "class A",
            Self::B => "class B",
            Self::C => "class C",
            Self::Undecided => "undecided",
            Self::Fail => "no class",
        }
    }
}

/// A line to draw.
struct Line {
    mark: Mark,
    faces: Vec<u32>,
    path: Vec<[f64; 3]>,
}

/// The edges of a model, with what is said of each.
pub struct Overlay {
    lines: Vec<Line>,
}

impl Overlay {
    /// Those of a report.
    pub fn of(report: &Report) -> Self {
        let line = |mark: Mark, borders: &[Named]| Line {
            mark,
            faces: borders.iter().map(|border| border.face).collect(),
            path: borders[0].path.clone(),
        };
        let free = report.free.iter().map(|border| line(Mark::Free, std::slice::from_ref(border)));
        let shared = report.edges.iter().map(|edge| line(Mark::of(edge), &edge.borders));
        Self { lines: free.chain(shared).collect() }
    }

    /// How many edges have a mark.
    pub fn count(&self, mark: Mark) -> usize {
        self.lines.iter().filter(|line| line.mark == mark).count()
    }

    /// The picture with the edges that are seen in it; `buffer` is what it was made of, from `camera`.
    ///
    /// # Errors
    /// None where the picture is of the buffer's size.
    pub fn drawn(&self, picture: &Picture, buffer: &GBuffer, camera: &Camera) -> Result<Picture> {
        let sheet = Sheet { buffer, camera, viewport: buffer.viewport() };
        let mut brush = Brush::new(picture);
        for mark in Mark::ALL {
            let lines = || self.lines.iter().filter(|line| line.mark == mark);
            let seen: Vec<DVec2> = lines().flat_map(|line| sheet.seen(line)).collect();
            brush.draw(&seen, BORDER, [255, 255, 255], BORDER_STRENGTH);
            brush.draw(&seen, LINE, mark.colour(), 1.0);
        }
        brush.picture()
    }
}

/// What a line may be behind.
struct Sheet<'a> {
    buffer: &'a GBuffer,
    camera: &'a Camera,
    viewport: Viewport,
}

impl Sheet<'_> {
    /// The places of a line that are seen, close to each other.
    fn seen(&self, line: &Line) -> Vec<DVec2> {
        let size = DVec2::new(self.viewport.width() as f64, self.viewport.height() as f64);
        let mut seen = vec![];
        for pair in line.path.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(DVec3::from_array);
            let places = [from, to].map(|point| self.camera.project(self.viewport, point));
            let [Some((a, _)), Some((b, _))] = places else { continue };
            let (low, high) = (a.min(b), a.max(b));
            if high.min_element() < 0.0 || size.x < low.x || size.y < low.y || !(a.is_finite() && b.is_finite()) {
                continue;
            }
            let steps = (a.distance(b) / STEP).ceil().clamp(1.0, MOST_STEPS) as usize;
            for k in 0..=steps {
                let point = from.lerp(to, k as f64 / steps as f64);
                let place = self.camera.project(self.viewport, point).map(|(place, _)| place);
                seen.extend(place.filter(|place| self.is_seen(line, point, *place)));
            }
        }
        seen
    }

    /// Whether a point of an edge is seen at its place in the picture.
    fn is_seen(&self, line: &Line, point: DVec3, place: DVec2) -> bool {
        let [width, height] = [self.viewport.width() as i64, self.viewport.height() as i64];
        let (column, row) = (place.x.floor() as i64, place.y.floor() as i64);
        if !(0..width).contains(&column) || !(0..height).contains(&row) {
            return false;
        }
        let ray = self.camera.ray(self.viewport, place.x, place.y);
        let t = (point - ray.origin).dot(ray.direction);
        let pixel = self.camera.pixels_per_unit(self.viewport, self.camera.depth(point)).recip();
        let is_open = |x: i64, y: i64| match self.buffer.get(x as usize, y as usize) {
            None => (x, y) == (column, row),
            Some(hit) => {
                let is_own = line.faces.contains(&hit.face.0);
                (is_own || (x, y) == (column, row)) && t <= hit.t + BEHIND * pixel
            }
        };
        let (columns, rows) = (column - 1..=column + 1, row - 1..=row + 1);
        let around = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
        around.filter(|(x, y)| (0..width).contains(x) && (0..height).contains(y)).any(|(x, y)| is_open(x, y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use continuity::{Settings, report};
    use gbuffer::{ShadeKind, Shading};
    use nurbs::{KnotVector, Surface};
    use scene::{Model, Projection};
    use suite::stage::{Plan, Stage};

    fn sheet(corner: DVec3, u: DVec3, v: DVec3) -> Surface {
        let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("one span");
        Surface::new(knots(), knots(), vec![corner, corner + v, corner + u, corner + u + v], None).expect("a sheet")
    }

    /// How many pixels of a picture from above have the colour of a mark, of a roof with its ridge along y, and a sheet over it.
    fn pixels(mark: Mark, covered: f64) -> usize {
        let ridge = [
            sheet(DVec3::ZERO, DVec3::new(1.0, 0.0, -0.5), DVec3::Y),
            sheet(DVec3::ZERO, DVec3::new(-1.0, 0.0, -0.5), DVec3::Y),
        ];
        let above = sheet(DVec3::new(-0.9, -0.1, 1.0), 1.8 * DVec3::X, covered * DVec3::Y);
        let model = Model::of_surfaces("roof", ridge.into_iter().chain([above]).collect()).expect("surfaces");
        let found = report(&model, Settings::new(Class::A.limits(), &model));
        let viewport = Viewport::new(120, 120).expect("a size");
        // The ridge runs through pixel centres, which then have the line's own colour.
        let eye = DVec3::new(0.01, 0.5, 9.0);
        let camera =
            Camera::look_at(eye, eye - DVec3::Z, DVec3::Y, Projection::Orthographic { height: 2.4 }).expect("a camera");
        let stage = Stage::new(&model, camera, viewport, Plan::default()).expect("a stage");
        let buffer = stage.raster();
        let picture = buffer.shaded(&Shading::new(ShadeKind::Phong), &model, &camera).expect("a picture");
        let drawn = Overlay::of(&found).drawn(&picture, &buffer, &camera).expect("of its size");
        drawn.rgb().iter().filter(|rgb| **rgb == mark.colour()).count()
    }

    /// The ridge is 50 pixels long. A sheet hides half of it, or all.
    #[test]
    fn an_edge_is_drawn_where_it_is_seen_and_not_behind_a_face() {
        let [whole, half, none] = [0.05, 0.6, 1.2].map(|covered| pixels(Mark::Fail, covered));
        assert!((45..=60).contains(&whole), "{whole}");
        assert!((0.4..0.6).contains(&(half as f64 / whole as f64)), "{half} of {whole}");
        assert_eq!(none, 0);
        assert!(0 < pixels(Mark::Free, 1.2), "the sheet's own edges are in front");
    }
}

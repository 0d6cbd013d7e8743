//! The corners of a tessellation: a grid a span, with a skirt where loops bound the face.

use glam::DVec2;
use nurbs::{FirstDerivatives, Surface};
use pipeline::{PackedScene, Parameters, SEARCHED, Vertex};
use scene::{FaceId, Model, Region};
use std::ops::Range;

/// How many times that a skirt may measure along a parameter that comes to the border at a slant.
const SLANT: f64 = 4.0;

/// The corners of a part of a face: a grid of them.
pub(super) struct Grid {
    span: [u32; 2],
    /// Parameters of the corners, u outer; those of a skirt lie beyond the domain.
    corners: Vec<[f32; 2]>,
    /// How many corners a row in v has.
    pub(super) columns: usize,
}

/// What a bounded face goes on by.
pub(super) struct Skirt<'a> {
    pub(super) surface: &'a Surface,
    pub(super) region: &'a Region,
    /// Model units along the tangents.
    pub(super) width: f64,
}

/// The grids of a face's spans, with a skirt where loops bound it.
pub(super) fn grids_of_spans(
    breaks: &[Vec<f64>; 2],
    cells: &[Vec<Vec<usize>>; 2],
    spans: &[Range<usize>; 2],
    skirt: Option<&Skirt>,
) -> Vec<Grid> {
    let lines = |parts: &Vec<usize>| -> Vec<f32> {
        let of_part = |(k, &n): (usize, &usize)| {
            (0..n).map(move |i| ((k as f64 + i as f64 / n as f64) / parts.len() as f64) as f32).collect::<Vec<_>>()
        };
        parts.iter().enumerate().flat_map(of_part).chain([1.0]).collect()
    };
    let [rows, columns] = [0, 1].map(|k| cells[k][spans[k].clone()].iter().map(lines).collect::<Vec<_>>());
    let mut grids = Vec::with_capacity(rows.len() * columns.len());
    for (k, u) in spans[0].clone().zip(&rows) {
        for (l, v) in spans[1].clone().zip(&columns) {
            let span = [k as u32, l as u32];
            grids.push(match skirt {
                None => Grid::new(span, u, v),
                Some(skirt) => Grid::with_skirt(span, [u, v], breaks, skirt),
            });
        }
    }
    grids
}

impl Grid {
    pub(super) fn new(span: [u32; 2], u: &[f32], v: &[f32]) -> Self {
        let corners = u.iter().flat_map(|&s| v.iter().map(move |&t| [s, t])).collect();
        Self { span, corners, columns: v.len() }
    }

    /// A grid that goes on beyond the sides of the domain into whose cells the region comes, by at least the skirt's width
    /// along the tangents, but where the side is collapsed.
    fn with_skirt(span: [u32; 2], lines: [&[f32]; 2], breaks: &[Vec<f64>; 2], skirt: &Skirt) -> Self {
        let &Skirt { surface, region, width } = skirt;
        let hull = region.hull();
        let ends = [0, 1].map(|k| [breaks[k][span[k] as usize], breaks[k][span[k] as usize + 1]]);
        let at = |k: usize, t: f32| ends[k][0] + (ends[k][1] - ends[k][0]) * f64::from(t);
        // With the ends twice, once for the skirt: the parameter and whether, and to which side, to go beyond it.
        let places = |k: usize| -> Vec<(f32, f64)> {
            let lines = lines[k];
            let is_first = span[k] == 0;
            let is_last = span[k] as usize + 2 == breaks[k].len();
            let before = (is_first && hull.min[k] <= at(k, lines[1])).then_some((0.0, -1.0));
            let after = (is_last && hull.max[k] >= at(k, lines[lines.len() - 2])).then_some((1.0, 1.0));
            let inside = lines.iter().map(|&t| (t, 0.0));
            before.into_iter().chain(inside).chain(after).collect()
        };
        let (rows, columns) = (places(0), places(1));
        let corner = |(s, beyond_u): (f32, f64), (t, beyond_v): (f32, f64)| {
            let d = surface.first_derivatives(at(0, s), at(1, t));
            let area = d.su.cross(d.sv).length();
            // Straight away from the border, whose tangent is `along`, it is a part of the way.
            let gain = |speed: f64, along: f64, side: f64| {
                let gain = (width * along / area).min(SLANT * width / speed);
                if side != 0.0 && gain.is_finite() { side * gain } else { 0.0 }
            };
            let (speed_u, speed_v) = (d.su.length(), d.sv.length());
            let length = ends.map(|[start, end]| end - start);
            let beyond = [gain(speed_u, speed_v, beyond_u) / length[0], gain(speed_v, speed_u, beyond_v) / length[1]];
            [s + beyond[0] as f32, t + beyond[1] as f32]
        };
        let corners = rows.iter().flat_map(|&row| columns.iter().map(move |&column| corner(row, column))).collect();
        Self { span, columns: columns.len(), corners }
    }

    pub(super) fn rows(&self) -> usize {
        self.corners.len() / self.columns
    }
}

/// The vertices of one face.
pub(super) fn mesh(model: &Model, scene: &PackedScene, id: usize, grids: &[Grid]) -> Vec<Vertex> {
    let surface = model.surface(FaceId(id as u32));
    let mut vertices = Vec::with_capacity(grids.iter().map(|grid| grid.corners.len()).sum());
    let mut evaluated = vec![];
    for grid in grids {
        let places = grid.corners.iter().map(|&uv| Place::new(model, scene, id, Parameters { span: grid.span, uv }));
        let places: Vec<Place> = places.collect();
        evaluated.clear();
        surface.evaluate_many(&places.iter().map(|place| place.uv).collect::<Vec<_>>(), &mut evaluated);
        let known = places.iter().zip(&evaluated);
        vertices.extend(known.map(|(place, known)| place.vertex(model, scene, id, known.derivatives)));
    }
    vertices
}

/// A normal is taken from tangents that are longer, across the span, than this share of the face, and whose angle's sine is greater; else
/// from a closer look.
const CLEAR: f64 = 1e-9;

/// A vertex of a face.
pub(super) fn corner(model: &Model, scene: &PackedScene, id: usize, at: Parameters) -> Vertex {
    let place = Place::new(model, scene, id, at);
    let d = model.surface(FaceId(id as u32)).first_derivatives(place.uv.x, place.uv.y);
    place.vertex(model, scene, id, d)
}

/// Where a vertex stands on its surface.
struct Place {
    at: Parameters,
    /// The nearest parameters of the domain.
    uv: DVec2,
    /// The size of the span.
    length: DVec2,
}

impl Place {
    fn new(model: &Model, scene: &PackedScene, id: usize, at: Parameters) -> Self {
        let border = at.uv.map(|t| t.clamp(0.0, 1.0));
        if at.span[0] == SEARCHED {
            let [[u0, u1], [v0, v1]] = model.surface(FaceId(id as u32)).domain();
            let length = DVec2::new(u1 - u0, v1 - v0);
            return Self { at, uv: DVec2::new(u0, v0) + length * DVec2::from_array(border.map(f64::from)), length };
        }
        let frame = &scene.frames()[id];
        let [width, height] = [0, 1].map(|k| frame.span(k, at.span[k])).map(|[start, end]| end - start);
        Self { at, uv: frame.uv(at.span, border), length: DVec2::new(width, height) }
    }

    /// The vertex there, from the surface's point and tangents.
    fn vertex(&self, model: &Model, scene: &PackedScene, id: usize, d: FirstDerivatives) -> Vertex {
        let &Self { at, uv, length } = self;
        let frame = &scene.frames()[id];
        let cross = d.su.cross(d.sv);
        // On a side that is a point, rounding leaves a tangent of no direction.
        let way = (d.su.length() * length.x).min(d.sv.length() * length.y);
        let is_clear = way > CLEAR * frame.scale && cross.length() > CLEAR * d.su.length() * d.sv.length();
        let normal = match cross.try_normalize() {
            Some(n) if is_clear => n,
            _ => model.surface(FaceId(id as u32)).inspect(uv.x, uv.y).normal.unit().unwrap_or_default(),
        };
        let normal = if model.faces()[id].reversed { -normal } else { normal };
        let beyond = at.uv.map(|t| f64::from(t - t.clamp(0.0, 1.0)));
        let position = d.s + d.su * (beyond[0] * length.x) + d.sv * (beyond[1] * length.y);
        Vertex {
            position: frame.local(position),
            uv: at.uv,
            face: id as u32,
            span: at.span,
            normal: normal.to_array().map(|x| x as f32),
            frame: id as u32,
        }
    }
}

//! An edge on a face as a path in the surface's own parameters: given by the file, or found from the edge in space.

use super::curve::Curve;
use super::inverse::Inverter;
use super::shape::Shape;
use glam::{DVec2, DVec3};

/// Samples between two breaks of a curve: enough that none is half a period from the next.
const SAMPLES: usize = 8;

/// The most samples of one path.
const MOST_SAMPLES: usize = 1 << 14;

/// How far the same place of an edge may be in its two curves' parameters, of 1, where they run at different speeds.
const SPEEDS: f64 = 1.0 / 16.0;

/// Thirds cut off that stretch: what is left is 10⁻⁹ of the curve.
const THIRDS: u32 = 50;

/// How near to a pole the angle of a path is taken that ends there, as a share of the distance between two samples.
const BESIDE_POLE: f64 = 1e-4;

/// A part of a curve, from the lower to the greater parameter.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    pub curve: Curve,
    pub range: [f64; 2],
}

impl Piece {
    /// The point at `s` in 0 to 1 of the range.
    pub fn point(&self, s: f64) -> DVec3 {
        let [start, end] = self.range;
        self.curve.point(if s == 1.0 { end } else { start + (end - start) * s })
    }

    /// Where the curve is cut, from 0 to 1, ends included; ascending.
    pub fn breaks(&self) -> Vec<f64> {
        let [start, end] = self.range;
        let inner = self.curve.breaks(self.range).into_iter().map(|t| (t - start) / (end - start));
        let inner = inner.filter(|s| 0.0 < *s && *s < 1.0);
        let mut breaks: Vec<f64> = [0.0].into_iter().chain(inner).chain([1.0]).collect();
        breaks.dedup();
        breaks
    }
}

/// An edge as a loop uses it.
#[derive(Debug, Clone)]
pub(crate) struct Use {
    /// The edge in space.
    pub space: Option<Piece>,
    /// The edge in the surface's own parameters, as the file gives it.
    pub plane: Option<Piece>,
    /// Whether the loop runs the curves backwards.
    pub reversed: bool,
    /// The edge's number, by which faces share it.
    pub edge: Option<i64>,
    /// How far its vertices are from where the curve begins and ends, model units.
    pub vertices: [f64; 2],
}

/// A path in the surface's own parameters, sampled so that no closed direction is taken the wrong way round.
#[derive(Debug, Clone)]
pub(crate) struct Path<'u> {
    source: Source<'u>,
    /// Parameters from 0 to 1, ascending.
    pub samples: Vec<f64>,
    /// The surface's parameters there.
    pub uv: Vec<DVec2>,
    /// Which parameter is free where the path begins and where it ends: it meets a pole there.
    pub free: [Option<usize>; 2],
    /// How far the surface is from the edge in space where it was sampled, model units.
    pub gap: f64,
    /// What is added to all parameters: whole periods.
    pub offset: DVec2,
    /// The parameter that is constant along the path, and its value.
    pub iso: Option<(usize, f64)>,
    /// How far the samples are moved by that on the surface, model units.
    pub straightened: f64,
}

#[derive(Debug, Clone, Copy)]
enum Source<'u> {
    /// The file's own curve.
    Given(&'u Piece),
    /// The edge in space, taken back to the surface.
    Found(&'u Piece),
}

impl<'u> Path<'u> {
    /// The path of an edge that the file gives in (u, v).
    pub fn given(shape: &Shape, plane: &'u Piece, space: Option<&Piece>) -> Self {
        let samples = samples(plane);
        let uv: Vec<DVec2> = samples.iter().map(|s| plane.point(*s).truncate()).collect();
        let distance = |(s, uv): (&f64, &DVec2)| space.map_or(0.0, |space| shape.point(*uv).distance(space.point(*s)));
        let gap = samples.iter().zip(&uv).map(distance).fold(0.0, f64::max);
        let offset = shape.turns(uv[uv.len() / 2]);
        Self { source: Source::Given(plane), samples, uv, free: [None; 2], gap, offset, iso: None, straightened: 0.0 }
    }

    /// Measures how far the path is from the edge in space where the two begin and end together, to `tolerance`, and run at
    /// different speeds between, as files may have them: each sample from the nearest place of the edge, sought near the same
    /// parameter. A curve that ends before the edge's range does is no such.
    pub fn measure(&mut self, shape: &Shape, space: &Piece, tolerance: f64) {
        let Source::Given(Piece { curve, range: [start, end] }) = self.source else { return };
        if curve.domain().is_none_or(|[first, last]| *start < first || last < *end) {
            return;
        }
        let last = self.uv.len() - 1;
        let is_apart = |i: usize| tolerance < shape.point(self.uv[i]).distance(space.point(self.samples[i]));
        if is_apart(0) || is_apart(last) {
            return;
        }
        let distance = |(s, uv): (&f64, &DVec2)| {
            let point = shape.point(*uv);
            let [mut low, mut high] = [s - SPEEDS, s + SPEEDS].map(|s| s.clamp(0.0, 1.0));
            for _ in 0..THIRDS {
                let third = (high - low) / 3.0;
                let [a, b] = [low + third, high - third];
                let is_first = space.point(a).distance_squared(point) < space.point(b).distance_squared(point);
                if is_first { high = b } else { low = a }
            }
            space.point(0.5 * (low + high)).distance(point).min(space.point(*s).distance(point))
        };
        self.gap = self.samples.iter().zip(&self.uv).map(distance).fold(0.0, f64::max);
    }

    /// The path of an edge in space; `enough` is how near a search has to come to be taken at once, model units.
    pub fn found(shape: &Shape, inverter: &Inverter, space: &'u Piece, enough: f64) -> Self {
        let samples = samples(space);
        let last = samples.len() - 1;
        let mut free = [None; 2];
        let mut uv: Vec<DVec2> = Vec::with_capacity(samples.len());
        let mut gap: f64 = 0.0;
        for (i, s) in samples.iter().enumerate() {
            let point = space.point(*s);
            let mut inverse = inverter.parameters(point, uv.last().copied(), enough);
            gap = gap.max(shape.point(inverse.uv).distance(point));
            if let Some(axis) = inverse.free {
                // The limit along the path, from its inside.
                let toward = if i == 0 { samples[1] } else { samples[i - 1] };
                let beside = space.point(s + (toward - s) * BESIDE_POLE);
                let near = uv.last().copied().unwrap_or(inverse.uv);
                inverse.uv[axis] = inverter.parameters(beside, Some(near), enough).uv[axis];
                if i == 0 {
                    free[0] = Some(axis);
                }
                if i == last {
                    free[1] = Some(axis);
                }
            }
            uv.push(inverse.uv);
        }
        Self { source: Source::Found(space), samples, uv, free, gap, offset: DVec2::ZERO, iso: None, straightened: 0.0 }
    }

    /// Notes at which ends the path meets a pole; for a path that the file gives.
    pub fn find_poles(&mut self, shape: &Shape, inverter: &Inverter, enough: f64) {
        for (end, i) in [(0, 0), (1, self.uv.len() - 1)] {
            let uv = self.uv[i] + self.offset;
            self.free[end] = inverter.parameters(shape.point(uv), Some(uv), enough).free;
        }
    }

    /// Whether the path was found from the edge in space.
    pub fn is_found(&self) -> bool {
        matches!(self.source, Source::Found(_))
    }

    /// The file's own curve, where the path is that.
    pub fn given_curve(&self) -> Option<&'u Piece> {
        match self.source {
            Source::Given(piece) => Some(piece),
            Source::Found(_) => None,
        }
    }

    /// The curve's cuts.
    pub fn breaks(&self) -> Vec<f64> {
        let (Source::Given(piece) | Source::Found(piece)) = self.source;
        piece.breaks()
    }

    /// The surface's parameters at `s`.
    pub fn at(&self, inverter: &Inverter, s: f64, enough: f64) -> DVec2 {
        let last = self.samples.len() - 1;
        let k = self.samples.partition_point(|sample| *sample <= s).clamp(1, last);
        let (a, b) = (self.samples[k - 1], self.samples[k]);
        let uv = match self.source {
            Source::Given(piece) => piece.point(s).truncate(),
            Source::Found(_) if s == a => self.uv[k - 1],
            Source::Found(_) if s == b => self.uv[k],
            Source::Found(piece) => {
                let near = self.uv[k - 1].lerp(self.uv[k], (s - a) / (b - a));
                let inverse = inverter.parameters(piece.point(s), Some(near), enough);
                let mut uv = inverse.uv;
                if let Some(axis) = inverse.free {
                    uv[axis] = near[axis];
                }
                uv
            }
        };
        let mut uv = uv + self.offset;
        if let Some((axis, value)) = self.iso {
            uv[axis] = value + self.offset[axis];
        }
        uv
    }

    /// Where the path begins and where it ends, whole periods added.
    pub fn ends(&self) -> [DVec2; 2] {
        [self.uv[0], self.uv[self.uv.len() - 1]].map(|uv| self.straightened(uv) + self.offset)
    }

    /// All samples, whole periods added.
    pub fn places(&self) -> impl DoubleEndedIterator<Item = DVec2> + '_ {
        self.uv.iter().map(|uv| self.straightened(*uv) + self.offset)
    }

    fn straightened(&self, mut uv: DVec2) -> DVec2 {
        if let Some((axis, value)) = self.iso {
            uv[axis] = value;
        }
        uv
    }

    /// Finds out whether one parameter is constant along the path, to `tolerance` in space.
    pub fn straighten(&mut self, shape: &Shape, tolerance: f64) {
        let first = self.uv[0];
        for axis in [0, 1] {
            let moved = |uv: &DVec2, value: f64| {
                let mut straight = *uv;
                straight[axis] = value;
                if straight == *uv { 0.0 } else { shape.point(straight).distance(shape.point(*uv)) }
            };
            let moves = |pair: &[DVec2]| pair[1][1 - axis] - pair[0][1 - axis];
            let ahead = (self.uv[self.uv.len() - 1] - first)[1 - axis];
            let is_monotone = self.uv.windows(2).all(|pair| 0.0 <= moves(pair) * ahead);
            if is_monotone && self.uv.iter().all(|uv| moved(uv, first[axis]) <= tolerance) {
                // Near a pole all values are constant: the middle of the path decides.
                let value = self.uv[self.uv.len() / 2][axis];
                self.iso = Some((axis, value));
                self.straightened = self.uv.iter().map(|uv| moved(uv, value)).fold(0.0, f64::max);
                return;
            }
        }
    }
}

fn samples(piece: &Piece) -> Vec<f64> {
    let breaks = piece.breaks();
    let each = (MOST_SAMPLES / breaks.len()).clamp(1, SAMPLES);
    let between = |pair: &[f64]| {
        let (a, b) = (pair[0], pair[1]);
        (0..each).map(move |i| a + (b - a) * (i as f64 / each as f64))
    };
    breaks.windows(2).flat_map(between).chain([1.0]).collect()
}

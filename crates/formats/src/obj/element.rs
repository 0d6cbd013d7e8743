//! Free-form elements: what their statements ask for, as exact splines.

use crate::spline::{Spline, weights};
use glam::DVec4;
use nurbs::{KnotVector, NurbsError, Surface};
use scene::{Face, Loop};

/// The basis of a curve or a surface (`cstype`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Basis {
    Bezier,
    BSpline,
}

/// What `cstype` and `deg` say.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Kind {
    pub basis: Basis,
    pub degrees: Vec<usize>,
}

/// A part of a loop: the curve from one parameter to another, backwards where that is less.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub range: [f64; 2],
    /// Its number among the curves of the file, from 0.
    pub curve: usize,
}

/// A curve or surface whose statements are being read.
#[derive(Debug, Clone)]
pub(super) struct Element {
    /// Homogeneous points, in the order of the file.
    pub points: Vec<DVec4>,
    /// The parameters of `parm u` and `parm v`.
    pub parameters: [Vec<f64>; 2],
    /// Loops of `trim` (outer) and `hole`.
    pub loops: Vec<(bool, Vec<Part>)>,
}

impl Element {
    pub fn new(points: Vec<DVec4>) -> Self {
        Self { points, parameters: [vec![], vec![]], loops: vec![] }
    }

    fn knots(&self, kind: &Kind, direction: usize) -> Result<KnotVector, String> {
        let name = ['u', 'v'][direction];
        let degree = *kind.degrees.get(direction).ok_or_else(|| format!("deg gives no degree in {name}"))?;
        let given = &self.parameters[direction];
        if given.len() < 2 {
            return Err(format!("parm {name} has {} values", given.len()));
        }
        let knots = match kind.basis {
            Basis::BSpline => given.clone(),
            // Piece after piece, each with as many control points as its degree after those of the one before.
            Basis::Bezier => {
                let ends = [given[0], given[given.len() - 1]];
                let inner = given.iter().flat_map(|t| vec![*t; degree.min(nurbs::MAX_DEGREE)]);
                std::iter::once(ends[0]).chain(inner).chain([ends[1]]).collect()
            }
        };
        KnotVector::new(degree, knots).map_err(|cause| format!("parm {name}: {cause}"))
    }

    /// The curve.
    pub fn curve(&self, kind: &Kind) -> Result<Spline, String> {
        let knots = self.knots(kind, 0)?;
        count(self.points.len(), knots.control_count())?;
        Spline::new(knots.degree(), knots.knots().to_vec(), self.points.clone()).map_err(|cause| cause.to_string())
    }

    /// The surface; its points run fastest along u in the file.
    pub fn surface(&self, kind: &Kind) -> Result<Surface, String> {
        let [u, v] = [self.knots(kind, 0)?, self.knots(kind, 1)?];
        let [columns, rows] = [u.control_count(), v.control_count()];
        count(self.points.len(), columns.saturating_mul(rows))?;
        let grid: Vec<DVec4> =
            (0..columns).flat_map(|i| (0..rows).map(move |j| j * columns + i)).map(|k| self.points[k]).collect();
        let weights = weights(&grid);
        let points = grid.iter().map(|p| p.truncate() / p.w).collect();
        Surface::new(u, v, points, weights).map_err(|cause: NurbsError| cause.to_string())
    }

    /// The face on surface `index`, whose domain is given, over the range that `surf` states.
    ///
    /// Where it states less than the domain, or holes alone, its outer boundary is that rectangle.
    pub fn face(
        &self,
        index: usize,
        range: [[f64; 2]; 2],
        domain: [[f64; 2]; 2],
        curves: &[Option<Spline>],
    ) -> Result<Face, String> {
        let mut loops = vec![];
        for (outer, parts) in &self.loops {
            let mut trims = vec![];
            for part in parts {
                let curve = curves.get(part.curve).and_then(Option::as_ref);
                let curve = curve.ok_or_else(|| format!("there is no curve {}", part.curve + 1))?;
                let [a, b] = part.range;
                let range = [a.min(b), a.max(b)];
                let spline = curve.restricted(range).map_err(|_| {
                    let [first, last] = curve.domain();
                    format!("a loop runs from {a} to {b} on curve {}, which is from {first} to {last}", part.curve + 1)
                })?;
                let mut trim = spline.trim();
                trim.reversed = b < a;
                trims.push(trim);
            }
            loops.push(Loop { outer: *outer, trims });
        }
        let [[u0, u1], [v0, v1]] = range;
        let is_inside = (0..2).all(|axis| domain[axis][0] <= range[axis][0] && range[axis][1] <= domain[axis][1]);
        if u0 >= u1 || v0 >= v1 || !is_inside {
            return Err(format!("it is stated over {range:?}, and its knots are over {domain:?}"));
        }
        if !loops.iter().any(|boundary| boundary.outer) && (range != domain || !loops.is_empty()) {
            let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]].map(|[u, v]| DVec4::new(u, v, 0.0, 1.0));
            let side = |k: usize| Spline::bezier(vec![corners[k], corners[(k + 1) % 4]], [0.0, 1.0]);
            let trims: Result<Vec<_>, _> = (0..4).map(|k| side(k).map(|line| line.trim())).collect();
            loops.insert(0, Loop { outer: true, trims: trims.map_err(|cause| cause.to_string())? });
        }
        Ok(Face { loops, ..Face::whole(index) })
    }
}

fn count(found: usize, expected: usize) -> Result<(), String> {
    let text = || format!("it has {found} control points, and deg and parm ask for {expected}");
    if found == expected { Ok(()) } else { Err(text()) }
}

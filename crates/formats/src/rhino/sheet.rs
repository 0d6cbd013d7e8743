//! Surfaces of an archive as rational splines, and the way from their own parameters to the splines'.

use super::archive::{Cursor, Fault};
use super::class::{Class, Object};
use super::curve::{self, Curve, Plane, Turn, angles, arc, joined, pieces, points, unfit};
use crate::spline::weights;
use glam::{DVec3, DVec4};
use nurbs::{KnotVector, Surface};

/// The most control points of a sum of two curves, and the most for each of the curves' own: a file of few bytes stays small.
const MOST_POINTS: [usize; 2] = [1 << 14, 64];

/// A surface of the file.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    pub surface: Surface,
    /// For u and v, the spans over which the file's own parameter is an angle.
    pub turns: [Vec<Turn>; 2],
}

impl Sheet {
    /// A surface of homogeneous points, row-major in u. Faults are those of the data at `at`.
    pub fn new(knots: [KnotVector; 2], grid: &[DVec4], turns: [Vec<Turn>; 2], at: usize) -> Result<Self, Fault> {
        let [u, v] = knots;
        let surface = Surface::new(u, v, grid.iter().map(|p| p.truncate() / p.w).collect(), weights(grid));
        Ok(Self { surface: surface.map_err(unfit(at))?, turns })
    }

    /// The sheet that `point` makes of each pair of control points of two curves, u along the first.
    fn product(curves: [Curve; 2], point: impl Fn(DVec4, DVec4) -> DVec4, at: usize) -> Result<Self, Fault> {
        let [u, v] = &curves;
        let [rows, columns] = [u, v].map(|curve| curve.spline.points().len());
        if rows.saturating_mul(columns) > MOST_POINTS[0] + MOST_POINTS[1] * (rows + columns) {
            return Err(Fault { at, text: format!("it is the sum of curves of {rows} and {columns} control points") });
        }
        let row = |a: &DVec4| v.spline.points().iter().map(|b| point(*a, *b)).collect::<Vec<_>>();
        let grid: Vec<DVec4> = u.spline.points().iter().flat_map(row).collect();
        let knots = [u, v].map(|curve| curve.spline.knots().clone());
        Self::new(knots, &grid, curves.map(|curve| curve.turns), at)
    }

    /// The same surface with u for v.
    pub fn transposed(self, at: usize) -> Result<Self, Fault> {
        let [rows, columns] = self.surface.control_counts();
        let point = |k: usize| {
            let index = k % rows * columns + k / rows;
            let weight = self.surface.weights().map_or(1.0, |w| w[index]);
            (self.surface.points()[index] * weight).extend(weight)
        };
        let grid: Vec<DVec4> = (0..rows * columns).map(point).collect();
        let knots = [nurbs::Direction::V, nurbs::Direction::U].map(|d| self.surface.knots(d).clone());
        let [u, v] = self.turns;
        Self::new(knots, &grid, [v, u], at)
    }

    /// Between two curves with the same knots, the first at the start of `range`, the second at its end: u along them.
    pub fn ruled(curve: &Curve, ends: [impl Fn(DVec4) -> DVec4; 2], range: [f64; 2], at: usize) -> Result<Self, Fault> {
        let row = |p: &DVec4| ends.each_ref().map(|end| end(*p));
        let grid: Vec<DVec4> = curve.spline.points().iter().flat_map(row).collect();
        let v = KnotVector::new(1, range.map(|t| [t; 2]).concat()).map_err(unfit(at))?;
        Self::new([curve.spline.knots().clone(), v], &grid, [curve.turns.clone(), vec![]], at)
    }

    /// A rectangle of a plane: `point` gives its corners.
    pub fn flat(domain: [[f64; 2]; 2], point: impl Fn([usize; 2]) -> DVec3, at: usize) -> Result<Self, Fault> {
        let grid = [[0, 0], [0, 1], [1, 0], [1, 1]].map(|corner| point(corner).extend(1.0));
        let [u, v] = domain.map(|[a, b]| KnotVector::new(1, vec![a, a, b, b]).map_err(unfit(at)));
        Self::new([u?, v?], &grid, [vec![], vec![]], at)
    }

    /// Reads a surface that is made of numbers and curves; gaps in these are at most `tolerance` wide, model units.
    pub fn read(object: &Object, tolerance: f64) -> Result<Self, Fault> {
        let mut data = object.data.clone();
        let data = &mut data;
        match object.class {
            Class::NurbsSurface => spline(data),
            Class::PlaneSurface => plane(data),
            Class::RevSurface => revolved(data, tolerance),
            Class::SumSurface => sum(data, tolerance),
            _ => data.fault(format!("{} is not read as a surface", object.kind())),
        }
    }
}

fn spline(data: &mut Cursor) -> Result<Sheet, Fault> {
    data.packed_version(1)?;
    let at = data.at();
    let (dimension, is_rational) = (data.i32()?, data.i32()? != 0);
    let degrees = [curve::degree(data)?, curve::degree(data)?];
    let mut counts = [data.i32()?, data.i32()?];
    // Two reserved numbers, and a box.
    data.skip(2 * 4 + 6 * 8)?;
    let mut knots = vec![];
    for (degree, count) in degrees.into_iter().zip(&mut counts) {
        let vector = KnotVector::new(degree, curve::knots(data)?).map_err(unfit(at))?;
        if i32::try_from(vector.control_count()) != Ok(*count) {
            return Err(Fault {
                at,
                text: format!("{count} points in a direction with knots for {}", vector.control_count()),
            });
        }
        knots.push(vector);
    }
    let grid = points(data, dimension, is_rational)?;
    if let Some(point) = grid.iter().find(|p| p.w <= 0.0) {
        return Err(Fault { at, text: format!("a weight is {}, where it has to be above 0", point.w) });
    }
    Sheet::new(knots.try_into().expect("two directions"), &grid, [vec![], vec![]], at)
}

/// Parameters run over `domain`, and distances along the axes over the extents.
fn plane(data: &mut Cursor) -> Result<Sheet, Fault> {
    let minor = data.packed_version(1)?;
    let at = data.at();
    let plane = Plane::read(data)?;
    let domain = [data.interval()?, data.interval()?];
    let extents = if minor == 0 { domain } else { [data.interval()?, data.interval()?] };
    let corner = |[i, j]: [usize; 2]| plane.origin + plane.x * extents[0][i] + plane.y * extents[1][j];
    Sheet::flat(domain, corner, at)
}

/// Piegl & Tiller, A8.1: each control point of the profile runs on an arc of its own.
fn revolved(data: &mut Cursor, tolerance: f64) -> Result<Sheet, Fault> {
    data.packed_version(2)?;
    let at = data.at();
    let [origin, end] = [data.point()?, data.point()?];
    let Some(axis) = (end - origin).try_normalize() else { return data.fault("its axis has no direction") };
    let (angles, domain) = (angles(data)?, data.interval()?);
    data.skip(6 * 8)?;
    let is_transposed = data.i32()? != 0;
    if data.u8()? == 0 {
        return data.fault("it has no profile");
    }
    let profile = joined(pieces(&Object::read(data)?)?, tolerance, at)?;
    let (unit, knots, turns) = arc(angles, domain);
    let mut grid = vec![];
    for [x, y, w] in unit {
        for point in profile.spline.points() {
            let (place, weight) = (point.truncate() / point.w, point.w);
            let center = origin + axis * (place - origin).dot(axis);
            let arm = place - center;
            let turned = center * w + arm * x + axis.cross(arm) * y;
            grid.push((turned * weight).extend(w * weight));
        }
    }
    let u = KnotVector::new(2, knots).map_err(unfit(at))?;
    let sheet = Sheet::new([u, profile.spline.knots().clone()], &grid, [turns, profile.turns], at)?;
    if is_transposed { sheet.transposed(at) } else { Ok(sheet) }
}

/// A base point plus a point of each of two curves.
fn sum(data: &mut Cursor, tolerance: f64) -> Result<Sheet, Fault> {
    data.packed_version(1)?;
    let at = data.at();
    let base = data.point()?;
    data.skip(6 * 8)?;
    let u = joined(pieces(&Object::read(data)?)?, tolerance, at)?;
    let v = joined(pieces(&Object::read(data)?)?, tolerance, at)?;
    let point = |a: DVec4, b: DVec4| {
        let weight = a.w * b.w;
        (a.truncate() * b.w + b.truncate() * a.w + base * weight).extend(weight)
    };
    Sheet::product([u, v], point, at)
}

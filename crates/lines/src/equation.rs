//! Lines on a Bézier patch as zeros of a polynomial in its parameters.
//!
//! With S = A / w, the normal's direction is N = w A_u × A_v + w_v A × A_u + w_u A_v × A, a polynomial too (A_u × A_v where all
//! weights are one). Where a side of the patch is a point, N is nought along it and is divided by the distance from it. What is
//! asked of the normal, the light and the eye is then a polynomial after squaring at most:
//!
//! | lines | zeros of |
//! | --- | --- |
//! | isophotes at angle φ | (N · L)² − cos² φ N · N |
//! | silhouettes | N · B, with B = A − w e from the eye, or the view's direction |
//! | sections | n · A − d w |
//! | highlight lines of a lamp through P along b | (b × N) · (w P − A) |
//! | reflections of component c | the square of N² (B · a) − 2 (B · N) (N · a), less c² N⁴ B² |
//!
//! Coordinates are those of the patch's own box, so that nothing is large or small.

use crate::bernstein::{Bernstein, Vector, along, cross, dot, without_sides};
use crate::family::Family;
use glam::{DVec3, DVec4};
use nurbs::{BezierPatch, power_of_two};
use scene::{Camera, Projection};
use std::array::from_fn;

/// Roundings of a control point when it moves to the patch's box, as shares of the box.
const MOVED: f64 = 8.0 * f64::EPSILON;

/// A patch in coordinates in which its box is about as large as 1.
struct Local {
    a: Vector,
    w: Bernstein,
    is_polynomial: bool,
    center: DVec3,
    /// Model units.
    unit: f64,
    domain: [[f64; 2]; 2],
}

/// From the eye to the surface: toward each point, or everywhere the same way.
enum Sight {
    From(Vector),
    Along(DVec3),
}

impl Local {
    fn new(patch: &BezierPatch) -> Self {
        let hull = patch.hull();
        let (center, unit) = (hull.center(), power_of_two(hull.diagonal()));
        let heaviest = power_of_two(patch.control.iter().fold(0.0, |most: f64, c| most.max(c.w)));
        let offset = center - patch.origin;
        let moved = |c: &DVec4| ((c.truncate() - offset * c.w) / unit / heaviest).extend(c.w / heaviest);
        let control: Vec<DVec4> = patch.control.iter().map(moved).collect();
        let polynomial = |k: usize, error: f64| {
            Bernstein::new(patch.degree, control.iter().map(|c| c.to_array()[k]).collect(), error)
        };
        Self {
            a: from_fn(|k| polynomial(k, MOVED)),
            w: polynomial(3, 0.0),
            is_polynomial: patch.weight_ratio() == 1.0,
            center,
            unit,
            domain: patch.domain,
        }
    }

    fn place(&self, p_world: DVec3) -> DVec3 {
        (p_world - self.center) / self.unit
    }

    /// w P − A.
    fn toward(&self, p_world: DVec3) -> Vector {
        let p = self.place(p_world).to_array();
        from_fn(|k| Bernstein::constant(0.0).plus(p[k], &self.w).plus(-1.0, &self.a[k]))
    }

    fn normal(&self) -> Vector {
        let by = |axis: usize| from_fn::<Bernstein, 3, _>(|k| self.a[k].derivative(axis));
        let (au, av) = (by(0), by(1));
        if self.is_polynomial {
            return without_sides(cross(&au, &av));
        }
        let (wu, wv) = (self.w.derivative(0), self.w.derivative(1));
        let (both, first, second) = (cross(&au, &av), cross(&self.a, &au), cross(&av, &self.a));
        without_sides(from_fn(|k| {
            self.w.times(&both[k]).plus(1.0, &wv.times(&first[k])).plus(1.0, &wu.times(&second[k]))
        }))
    }

    fn reflections(&self, camera: &Camera, axis: DVec3, components: &[f64]) -> Vec<Equation> {
        let n = self.normal();
        let (square, across) = (dot(&n, &n), along(&n, axis.to_array()));
        match self.sight(camera) {
            Sight::Along(d) => {
                let turned = across.times(&along(&n, d.to_array()));
                numbered(components, |c| square.times(&Bernstein::constant(d.dot(axis) - c)).plus(-2.0, &turned))
            }
            Sight::From(b) => {
                let turned = across.times(&dot(&n, &b));
                let mirrored = square.times(&along(&b, axis.to_array())).plus(-2.0, &turned);
                let (left, right) = (mirrored.times(&mirrored), square.times(&square).times(&dot(&b, &b)));
                let sign = |c: f64| Bernstein::constant(0.0).plus(c.signum(), &mirrored);
                let equation = |(index, &c): (usize, &f64)| match c {
                    0.0 => Equation { index, zero: mirrored.clone(), positive: None },
                    _ => Equation { index, zero: left.plus(-c * c, &right), positive: Some(sign(c)) },
                };
                components.iter().enumerate().map(equation).collect()
            }
        }
    }

    fn sight(&self, camera: &Camera) -> Sight {
        match camera.projection() {
            Projection::Perspective { .. } => {
                Sight::From(self.toward(camera.eye()).map(|c| Bernstein::constant(0.0).plus(-1.0, &c)))
            }
            Projection::Orthographic { .. } => Sight::Along(camera.forward()),
        }
    }
}

/// A polynomial whose zeros are a line on a patch, where another one, if there is one, is positive.
#[derive(Debug, Clone)]
pub struct Equation {
    /// Which level of its family.
    pub index: usize,
    /// Nought on the line.
    pub zero: Bernstein,
    /// Of a polynomial that was squared, what tells its zeros from those of the opposite level.
    pub positive: Option<Bernstein>,
}

/// The equations of a family on a patch of a surface whose domain is `whole`.
pub fn equations(family: &Family, patch: &BezierPatch, whole: [[f64; 2]; 2], camera: &Camera) -> Vec<Equation> {
    let local = Local::new(patch);
    match family {
        Family::Isophotes { light, degrees } => {
            let n = local.normal();
            let toward = along(&n, light.to_array());
            let (square, all) = (toward.times(&toward), dot(&n, &n));
            let cosine = |degrees: f64| degrees.to_radians().cos();
            numbered(degrees, |degrees| square.plus(-cosine(degrees).powi(2), &all))
        }
        Family::Reflections { axis, components } => local.reflections(camera, *axis, components),
        Family::Silhouettes => {
            let n = local.normal();
            let turned = match local.sight(camera) {
                Sight::From(b) => dot(&n, &b),
                Sight::Along(d) => along(&n, d.to_array()),
            };
            numbered(&[0.0], |_| turned.clone())
        }
        Family::Sections { normal, distances } => {
            let height = along(&local.a, normal.to_array());
            let offset = |distance: f64| (distance - normal.dot(local.center)) / local.unit;
            numbered(distances, |distance| height.plus(-offset(distance), &local.w))
        }
        Family::Highlights { along: b, lamps } => {
            let across = cross(&b.to_array().map(Bernstein::constant), &local.normal());
            let zero = |lamp: &DVec3| dot(&across, &local.toward(*lamp));
            lamps.iter().enumerate().map(|(index, lamp)| Equation { index, zero: zero(lamp), positive: None }).collect()
        }
        Family::Parameters { axis, shares } => {
            let [start, end] = whole[*axis];
            let [low, high] = local.domain[*axis];
            let mut degree = [0, 0];
            degree[*axis] = 1;
            let error = 4.0 * f64::EPSILON * low.abs().max(high.abs()) / (high - low);
            numbered(shares, |share| {
                let value = start + (end - start) * share;
                Bernstein::new(degree, [low, high].map(|end| (end - value) / (high - low)).to_vec(), error)
            })
        }
        Family::Borders | Family::Trims => vec![],
    }
}

fn numbered(levels: &[f64], of: impl Fn(f64) -> Bernstein) -> Vec<Equation> {
    let equation = |(index, level): (usize, &f64)| Equation { index, zero: of(*level), positive: None };
    levels.iter().enumerate().map(equation).collect()
}

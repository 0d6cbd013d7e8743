//! Area and volume of a model: integrals over the trimmed domains, taken along their borders (Green), with Gauss' formula
//! between the knots.

use glam::DVec2;
use nurbs::{BezierCurve, Direction, Surface};
use scene::{FaceId, Model};

/// Gauss' nodes and weights of order 20 on −1 to 1, the positive half (Abramowitz & Stegun, Table 25.4).
const GAUSS: [(f64, f64); 10] = [
    (0.07652652113349732, 0.15275338713072584),
    (0.22778585114164507, 0.14917298647260374),
    (0.37370608871541955, 0.14209610931838204),
    (0.5108670019508271, 0.1316886384491766),
    (0.636053680726515, 0.11819453196151841),
    (0.7463319064601508, 0.10193011981724043),
    (0.8391169718222188, 0.08327674157670474),
    (0.912234428251326, 0.06267204833410905),
    (0.9639719272779138, 0.04060142980038694),
    (0.9931285991850949, 0.01761400713915211),
];

fn gauss(a: f64, b: f64, f: impl Fn(f64) -> DVec2) -> DVec2 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    GAUSS.iter().map(|(x, w)| (f(middle + half * x) + f(middle - half * x)) * *w).sum::<DVec2>() * half
}

/// Area, and volume between the surface and the origin, over all u from the start of the domain to `u`, per v.
fn across(surface: &Surface, u: f64, v: f64) -> DVec2 {
    let knots = surface.knots(Direction::U);
    let density = |u: f64| {
        let d = surface.first_derivatives(u, v);
        let normal = d.su.cross(d.sv);
        DVec2::new(normal.length(), d.s.dot(normal) / 3.0)
    };
    let spans = knots.spans().map(|k| (knots.knots()[k], knots.knots()[k + 1].min(u)));
    spans.filter(|(a, b)| a < b).map(|(a, b)| gauss(a, b, density)).sum()
}

/// The same over a border's left side, by Green: the integral of [`across`] dv along a piece that is monotone.
fn along(surface: &Surface, piece: &BezierCurve) -> DVec2 {
    // Cut where it passes a knot.
    let mut cuts = vec![0.0, 1.0];
    for direction in [Direction::U, Direction::V] {
        let axis = direction as usize;
        let knots = surface.knots(direction);
        for value in knots.spans().map(|k| knots.knots()[k]) {
            let at = |t: f64| piece.point(t)[axis] - value;
            if at(0.0) * at(1.0) < 0.0 {
                let (mut low, mut high) = (0.0, 1.0);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if at(0.0) * at(middle) < 0.0 { high = middle } else { low = middle }
                }
                cuts.push(low);
            }
        }
    }
    cuts.sort_by(f64::total_cmp);
    let density = |t: f64| {
        let [uv, by_t] = piece.first_derivative(t);
        across(surface, uv.x, uv.y) * by_t.y
    };
    cuts.windows(2).map(|pair| gauss(pair[0], pair[1], density)).sum()
}

/// The area of all faces, and the volume that they enclose.
pub fn area_and_volume(model: &Model) -> DVec2 {
    (0..model.faces().len()).map(|k| of_face(model, k)).sum()
}

/// The area of a face, and the volume between it and the origin.
pub fn of_face(model: &Model, k: usize) -> DVec2 {
    let (id, face) = (FaceId(k as u32), &model.faces()[k]);
    let surface = model.surface(id);
    let [[u0, u1], [v0, v1]] = surface.domain();
    let sum: DVec2 = match model.region(id) {
        Some(region) => region.pieces().iter().map(|piece| along(surface, &piece.curve)).sum(),
        None => [(u1, v0, v1), (u0, v1, v0)]
            .map(|(u, a, b)| along(surface, &BezierCurve::line(DVec2::new(u, a), DVec2::new(u, b))))
            .into_iter()
            .sum(),
    };
    DVec2::new(sum.x, if face.reversed { -sum.y } else { sum.y })
}

//! The project's own files: area and volume of each are those of their closed form.
//!
//! Both are integrals over the trimmed domain, taken along its border (Green), with Gauss' formula between the knots.

use crate::cases::{Case, cases};
use crate::common::root;
use formats::Document;
use glam::DVec2;
use nurbs::{BezierCurve, Direction, Surface};
use scene::{FaceId, Model};

/// Relative error of area and volume.
const ERROR: f64 = 1e-9;

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
    let mut total = DVec2::ZERO;
    for (k, face) in model.faces().iter().enumerate() {
        let id = FaceId(k as u32);
        let surface = model.surface(id);
        let [[u0, u1], [v0, v1]] = surface.domain();
        let sum: DVec2 = match model.region(id) {
            Some(region) => region.pieces().iter().map(|piece| along(surface, &piece.curve)).sum(),
            None => [(u1, v0, v1), (u0, v1, v0)]
                .map(|(u, a, b)| along(surface, &BezierCurve::line(DVec2::new(u, a), DVec2::new(u, b))))
                .into_iter()
                .sum(),
        };
        total += DVec2::new(sum.x, if face.reversed { -sum.y } else { sum.y });
    }
    total
}

fn opened(case: &Case) -> Document {
    let path = root().join("testdata/step").join(format!("{}.step", case.name));
    if std::env::var_os("STEP_CORPUS").is_some() {
        std::fs::create_dir_all(path.parent().expect("a folder")).unwrap();
        std::fs::write(&path, &case.text).unwrap();
    }
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert_eq!(text, case.text, "{}: STEP_CORPUS=1 writes it anew", path.display());
    formats::open(&path).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn areas_and_volumes_are_those_of_the_closed_form() {
    let mut wrong = vec![];
    for case in cases() {
        let document = opened(&case);
        let found = area_and_volume(&document.model);
        let expected = DVec2::new(case.area, case.volume);
        let error = ((found - expected) / expected).abs().max_element();
        eprintln!("{}: {} faces, off by {error:.1e}", case.name, document.model.faces().len());
        if document.model.faces().len() != case.faces || error > ERROR || error.is_nan() {
            let notes: Vec<String> = document.notes.iter().map(ToString::to_string).collect();
            wrong.push(format!("{}: {found} for {expected}; {}", case.name, notes.join("; ")));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// The check itself is tried: a face turned round, and a hole filled, change what it finds.
#[test]
fn a_face_turned_round_changes_the_volume() {
    let case = cases().into_iter().find(|case| case.name == "oblique-cut").unwrap();
    let model = opened(&case).model;
    for k in 0..model.faces().len() {
        let mut faces = model.faces().to_vec();
        faces[k].reversed = !faces[k].reversed;
        let wrong = Model::new("wrong", model.surfaces().to_vec(), faces).unwrap();
        let found = area_and_volume(&wrong);
        assert!((found.x / case.area - 1.0).abs() < ERROR, "{found}");
        // The bottom lies in a plane with the origin, and adds nothing.
        assert!(k == 2 || (found.y / case.volume - 1.0).abs() > 0.1, "face {k}: {found}");
    }
}

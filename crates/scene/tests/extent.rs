//! Boxes and framing: what a model shows, to 1 %, whatever its control points and trims do.

use glam::{DVec2, DVec3};
use models::builtin;
use nurbs::{Hull, KnotVector, Surface};
use scene::{Camera, FaceId, Model, Region, Viewport};
use std::path::PathBuf;

fn open(name: &str) -> Model {
    let file = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata")).join(name);
    formats::read(&file).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Whether the region's boundary winds about a point, by a fine polygon: good enough beside its edges.
fn is_material(region: &Region, at: DVec2) -> bool {
    let crossing = |piece: &scene::Piece| {
        let point = |i: usize| piece.curve.point(i as f64 / 24.0);
        let crossed = |i: &usize| {
            let (a, b) = (point(*i), point(i + 1));
            (a.y <= at.y) != (b.y <= at.y) && at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y)
        };
        (0..24).filter(crossed).count() as i32 * piece.winding()
    };
    region.pieces().iter().map(crossing).sum::<i32>() != 0
}

/// The box of many points that are seen: inside the true one, and little smaller.
fn sampled(model: &Model) -> Hull {
    let mut hull = Hull::of([]);
    for id in 0..model.faces().len() as u32 {
        let (surface, region) = (model.surface(FaceId(id)), model.trimmed_region(FaceId(id)));
        let mut add = |uv: DVec2| {
            let p = surface.point(uv.x, uv.y);
            hull = Hull { min: hull.min.min(p), max: hull.max.max(p) };
        };
        let side = if region.is_some() { 36 } else { 60 };
        for piece in region.into_iter().flat_map(|region| region.pieces()).filter(|piece| !piece.on_border) {
            (0..=side).for_each(|i| add(piece.curve.point(i as f64 / side as f64)));
        }
        let [[u0, u1], [v0, v1]] = surface.domain();
        for i in 0..=side {
            for j in 0..=side {
                let (s, t) = (i as f64 / side as f64, j as f64 / side as f64);
                let uv = DVec2::new(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t);
                if region.is_none_or(|region| is_material(region, uv)) {
                    add(uv);
                }
            }
        }
    }
    hull
}

/// Asserts that `hull` holds `inner` and exceeds `outer` by at most `share` of the model's size.
fn assert_tight(name: &str, hull: Hull, inner: Hull, share: f64) {
    let slack = 1e-9 * hull.diagonal();
    let off = share * inner.diagonal();
    assert!(
        (hull.min - slack).cmple(inner.min).all() && inner.max.cmple(hull.max + slack).all(),
        "{name}: {hull:?} without {inner:?}"
    );
    assert!(
        (inner.min - hull.min).max_element() <= off && (hull.max - inner.max).max_element() <= off,
        "{name}: {hull:?} around {inner:?}"
    );
}

#[test]
fn a_sphere_cut_by_tilted_planes_has_the_box_of_the_sphere() {
    let hull = open("field/23-sphere-tilted-cuts.json").hull();
    assert!(hull.max.cmple(DVec3::splat(2.02)).all() && hull.min.cmpge(DVec3::splat(-2.02)).all(), "{hull:?}");
}

#[test]
fn boxes_hold_what_is_seen_and_little_more() {
    for (name, _) in models::BUILTINS {
        let model = builtin(name).expect("built in");
        assert_tight(name, model.hull(), sampled(&model), 0.01);
    }
    for name in ["trim_3", "quadric_2", "periodic_1", "unclamped_2", "weights_2", "pole_3", "fold_0"] {
        let model = open(&format!("cases/{name}.json"));
        assert_tight(name, model.hull(), sampled(&model), 0.01);
    }
}

/// The part of the picture, in width and in height, that the model's seen points take, and the greatest distance from its
/// middle, in halves of the picture.
fn filled(model: &Model, viewport: Viewport) -> (DVec2, f64) {
    let camera = Camera::framing(model, viewport);
    let size = DVec2::new(viewport.width() as f64, viewport.height() as f64);
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for id in 0..model.faces().len() as u32 {
        let (surface, region) = (model.surface(FaceId(id)), model.trimmed_region(FaceId(id)));
        let [[u0, u1], [v0, v1]] = surface.domain();
        for (i, j) in (0..=36).flat_map(|i| (0..=36).map(move |j| (f64::from(i) / 36.0, f64::from(j) / 36.0))) {
            let uv = DVec2::new(u0 + (u1 - u0) * i, v0 + (v1 - v0) * j);
            if region.is_none_or(|region| is_material(region, uv)) {
                let at = camera.picture(viewport, surface.point(uv.x, uv.y)).expect("in front of the eye") / size;
                (low, high) = (low.min(at), high.max(at));
            }
        }
    }
    (high - low, 2.0 * (0.5 - low).max(high - 0.5).max_element())
}

#[test]
fn the_default_view_is_filled_and_holds_all() {
    for (width, height) in [(128, 96), (96, 128)] {
        let viewport = Viewport::new(width, height).expect("legal");
        for (name, model) in [
            ("sphere cut", open("field/23-sphere-tilted-cuts.json")),
            ("sphere", builtin("sphere").expect("built in")),
            ("teapot", builtin("teapot").expect("built in")),
            ("trim_3", open("cases/trim_3.json")),
        ] {
            let (share, farthest) = filled(&model, viewport);
            assert!((0.94..1.0).contains(&farthest), "{name}: {farthest}");
            assert!(0.94 < share.max_element(), "{name}: {share}");
        }
    }
}

#[test]
fn boxes_and_framing_are_the_same_at_every_scale_and_place() {
    let viewport = Viewport::new(128, 96).expect("legal");
    let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).expect("legal");
    let at = |scale: f64| {
        let wave = |i: usize, j: usize| DVec3::new(i as f64, j as f64, ((i * 3 + j) as f64).sin()) * scale;
        let points = (0..9).map(|k| wave(k / 3, k % 3)).collect();
        let surface = Surface::new(knots.clone(), knots.clone(), points, None).expect("legal");
        Model::of_surfaces("wave", vec![surface]).expect("a model")
    };
    let plain = at(1.0);
    for exponent in [-196, -130, -30, 30, 130, 196] {
        let scale = 2f64.powi(exponent);
        let scaled = at(scale);
        assert_eq!(scaled.hull().max, plain.hull().max * scale, "2^{exponent}");
        let [a, b] = [&plain, &scaled].map(|model| Camera::framing(model, viewport));
        assert_eq!(a.eye() * scale, b.eye(), "2^{exponent}");
        assert_eq!(a.forward(), b.forward(), "2^{exponent}");
    }
}

#[test]
fn a_point_and_a_speck_far_from_the_origin_are_framed() {
    let viewport = Viewport::new(128, 96).expect("legal");
    let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal");
    for (far, size) in [(0.0, 0.0), (1e9, 0.0), (1e9, 1e-9), (1e60, 0.0), (0.0, 1e-163)] {
        let points = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
        let points = points.map(|[x, y]| DVec3::new(far + x * size, y * size, far)).to_vec();
        let surface = Surface::new(knots.clone(), knots.clone(), points, None).expect("legal");
        let model = Model::of_surfaces("speck", vec![surface]).expect("a model");
        let camera = Camera::framing(&model, viewport);
        assert!(camera.eye().is_finite() && camera.eye() != model.hull().center(), "{far} and {size}");
    }
}

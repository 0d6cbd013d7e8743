//! The area of a trimmed face by counting pixels.

use glam::{DVec2, DVec3};
use isophote::stage::{Plan, Stage};
use nurbs::{KnotVector, Surface};
use raycast::Caster;
use scene::{Camera, Face, FaceId, Model, Projection, Viewport};

/// The share of the boundary's length times a pixel's side that the area may be off: at first order, and far less than
/// the half of it that a boundary along rows of pixels can cost.
const FIRST_ORDER: f64 = 0.1;

/// The error in units of √length · side^3/2: what is left where each pixel on the boundary is wrong by chance, five
/// times a pixel's standard deviation, which is at most 0.29 of it.
const BY_CHANCE: f64 = 1.5;

/// The loops of a built-in model's first face on a plane where (x, y) = (u, v).
fn flat(name: &str) -> Model {
    let model = models::builtin(name).expect("built in");
    let face = &model.faces()[0];
    let [[u0, u1], [v0, v1]] = model.surfaces()[face.surface].domain();
    let knots = |a: f64, b: f64| KnotVector::new(1, vec![a, a, b, b]).expect("legal");
    let points = [(u0, v0), (u0, v1), (u1, v0), (u1, v1)].map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let surface = Surface::new(knots(u0, u1), knots(v0, v1), points, None).expect("legal");
    Model::new(name, vec![surface], vec![Face { surface: 0, ..face.clone() }]).expect("as legal as before")
}

/// Looks straight down; not along rows of pixels, which a straight edge might follow.
fn camera(model: &Model) -> (Camera, f64) {
    let height = 1.1 * model.hull().diagonal();
    let center = model.hull().center() + DVec3::new(0.0123, 0.0071, 0.0);
    let up = DVec3::new(0.3, 1.0, 0.0).normalize();
    let projection = Projection::Orthographic { height };
    (Camera::look_at(center + DVec3::Z, center, up, projection).expect("legal"), height)
}

/// Exact area and length of the boundary.
fn measures(model: &Model) -> (f64, f64) {
    let region = model.region(FaceId(0)).expect("trimmed");
    let length = |piece: &scene::Piece| -> f64 {
        let at = |k: usize| -> DVec2 { piece.curve.point(k as f64 / 64.0) };
        (0..64).map(|k| at(k).distance(at(k + 1))).sum()
    };
    (region.area(), region.pieces().iter().map(length).sum())
}

#[test]
fn the_area_by_pixels_converges_to_the_exact_one() {
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    for name in ["islands", "text"] {
        let model = flat(name);
        let caster = Caster::new(&model);
        let ((camera, height), (area, length)) = (camera(&model), measures(&model));
        for side in [32, 64, 128, 256] {
            let viewport = Viewport::new(side, side).expect("a legal size");
            let stage = |technique| Stage::new(&model, camera, viewport, Plan { technique, ..Plan::default() });
            let fragment = stage(&techniques::fragment::Fragment).expect("a stage");
            let mut counted = vec![("raycast", fragment.raycast(&caster).covered())];
            counted.push(("raster, fragment", fragment.raster().covered()));
            counted.push(("raster, exact", stage(&techniques::exact::Exact).expect("a stage").raster().covered()));
            if side == 64 {
                let on_gpu = fragment.gpu(&device, None, gpu::Overrides::default()).expect("the GPU draws");
                counted.push(("gpu, fragment", on_gpu.gbuffer.covered()));
            }
            let pixel = height / side as f64;
            for (renderer, covered) in counted {
                let error = (covered as f64 * pixel * pixel - area).abs();
                assert!(
                    error <= FIRST_ORDER * length * pixel,
                    "{name}, {renderer}, {side} pixels: off by {error} of {area}"
                );
                let chance = BY_CHANCE * length.sqrt() * pixel.powf(1.5);
                assert!(error <= chance, "{name}, {renderer}, {side} pixels: off by {error}, not {chance}");
            }
        }
    }
}

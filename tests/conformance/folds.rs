//! Technique `exact` beside folds, where a ray meets one piece up to three times.

use glam::{DVec2, DVec3};
use isophote::stage::{Plan, Stage};
use pipeline::Sight;
use raycast::Caster;
use scene::{Camera, Model, Projection, Viewport};
use techniques::exact::newton::{Outcome, solve};
use techniques::exact::{Hulls, PieceRecord};

/// A model, a view, and a pixel of 512 × 512 at which a search that starts at both ends of the hull ends twice at roots
/// that a third one hides.
const HIDDEN: [(&str, bool, [usize; 2]); 5] = [
    ("torus", false, [508, 167]),
    ("quintic-quadratic", true, [502, 270]),
    ("quintic-quadratic", false, [318, 331]),
    ("septic", false, [389, 365]),
    ("septic", false, [386, 364]),
];

#[test]
fn a_root_beyond_the_fold_hides_those_that_the_first_searches_find() {
    let viewport = Viewport::new(512, 512).expect("a legal size");
    for (name, is_orthographic, [x, y]) in HIDDEN {
        let model = models::builtin(name).expect("built in");
        let camera = if is_orthographic {
            let eye = Camera::framing(&model, viewport).eye();
            let projection = Projection::Orthographic { height: 1.5 };
            Camera::look_at(eye, model.hull().center(), DVec3::Z, projection).expect("legal")
        } else {
            let projection = Projection::Perspective { fov_deg: 60.0 };
            let target = DVec3::new(0.0, 0.0, 0.2);
            Camera::look_at(DVec3::new(1.2, -0.4, 0.1), target, DVec3::Z, projection).expect("legal")
        };
        let plan = Plan { technique: &techniques::exact::Exact, ..Plan::default() };
        let stage = Stage::new(&model, camera, viewport, plan).expect("a stage");
        let at = [x as f64 + 0.5, y as f64 + 0.5];
        let sees = |piece: &PieceRecord| {
            let sight = Sight::new(&stage.views[piece.face as usize], at.map(|x| x as f32));
            match solve(&stage.scene, piece, &sight).outcome {
                Outcome::Hit { uv, depth } => Some((depth, [piece.span_u, piece.span_v], uv, piece.face as usize)),
                Outcome::Miss | Outcome::Unconverged => None,
            }
        };
        let found = pieces(&stage).iter().filter_map(sees);
        let (_, span, uv, face) = found.max_by(|a, b| a.0.total_cmp(&b.0)).expect("something is seen");
        let caster = Caster::new(&model);
        let first = caster.all(&camera.ray(viewport, at[0], at[1])).hits[0];
        let [[u0, u1], [v0, v1]] = model.surface(first.face).domain();
        let uv = stage.scene.frames()[face].uv(span, uv);
        let off = (uv - first.uv).abs() / DVec2::new(u1 - u0, v1 - v0);
        assert!(face == first.face.0 as usize && off.max_element() < 1e-3, "{name} ({x}, {y}): {uv}, not {}", first.uv);
    }
}

/// What technique `exact` draws on a stage.
fn pieces<'s>(stage: &'s Stage) -> &'s [PieceRecord] {
    let drawn: &dyn gpu::Drawable = &*stage.prepared;
    &drawn.of::<Hulls>("exact").expect("hulls").pieces
}

/// A case of `testdata/cases`.
fn case(name: &str) -> Model {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../testdata/cases");
    isophote::view::ModelArgs::named(&format!("{path}/{name}.json")).open().expect("a model")
}

/// How many pixels that technique `exact` shows differ from rays.
fn differing(model: &Model, camera: Camera, viewport: Viewport) -> usize {
    let plan = Plan { technique: &techniques::exact::Exact, ..Plan::default() };
    let stage = Stage::new(model, camera, viewport, plan).expect("a stage");
    let caster = Caster::new(model);
    let pair = stage.against_raycast(&caster, &stage.raycast(&caster), &stage.raster()).expect("comparable");
    println!("{:?} {:?}", pair.causes, pair.worst.first());
    pair.differing()
}

/// From 1/1000 of its size the surface reaches from the eye to where it is small, and in pixels the offset leads there: 493
/// pixels once showed what lies behind.
#[test]
fn a_search_that_starts_near_the_eye_is_not_led_away_from_it() {
    let model = case("trim_3");
    let viewport = Viewport::new(96, 72).expect("a legal size");
    let projection = Projection::Perspective { fov_deg: 72.83409599991467 };
    let eye = DVec3::new(2.2694716917022, 4.192841779356513, 1.6358780371390242);
    let target = DVec3::new(2.273941624602277, 4.192333570345486, 1.6364603386366778);
    let up = DVec3::new(0.4645647771349777, -0.012084040133327978, 0.30451191609102457);
    let camera = Camera::look_at(eye, target, up, projection).expect("legal");
    assert_eq!(differing(&model, camera, viewport), 0);
}

/// Both searches from the hull go to that end of a twisted piece that the root is not at, and stop a third of a pixel from
/// the ray.
#[test]
fn a_twisted_piece_that_is_nearly_met_is_searched_from_more_places() {
    let model = case("solid_3");
    let viewport = Viewport::new(256, 256).expect("a legal size");
    assert_eq!(differing(&model, Camera::framing(&model, viewport), viewport), 0);
}

/// The kernels and the program in Rust are twins: on an adapter that keeps strict order they evaluate the surface equally
/// often for each pixel, but for pixels where another rounding decides whether a step keeps its promise.
#[test]
fn the_kernels_search_as_the_program_in_rust_does() {
    let device = gpu::Device::open(Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`");
    let viewport = Viewport::new(40, 40).expect("a legal size");
    for name in ["torus", "surface", "islands"] {
        let model = models::builtin(name).expect("built in");
        let plan = Plan { technique: &techniques::exact::Exact, ..Plan::default() };
        let stage = Stage::new(&model, Camera::framing(&model, viewport), viewport, plan).expect("drawable");
        // A ray that passes by a hull costs nothing, so that it does not matter in which pixels a hull is looked for.
        let expected = |pixel: usize| -> u32 {
            let at = [(pixel % viewport.width()) as f32 + 0.5, (pixel / viewport.width()) as f32 + 0.5];
            let of_piece = |piece: &PieceRecord| {
                let sight = Sight::new(&stage.views[piece.face as usize], at);
                solve(&stage.scene, piece, &sight).evaluations
            };
            pieces(&stage).iter().map(of_piece).sum()
        };
        let mut renderer =
            gpu::Renderer::new(&device, &stage.scene, &*stage.prepared, Default::default()).expect("drawn");
        let found = renderer.evaluations(&stage.views, viewport).expect("counted");
        let searched = found.iter().filter(|&&count| count > 0).count();
        let off = found.iter().enumerate().filter(|&(pixel, &count)| count != expected(pixel)).count();
        assert!(searched > 200 && off <= 4 + searched / 256, "{name}: {off} of {searched} pixels");
    }
}

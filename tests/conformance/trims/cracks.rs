//! An edge that two faces share shows nothing of what lies behind: each pixel there is covered, by every renderer.

use gbuffer::GBuffer;
use glam::DVec3;
use isophote::stage::{Plan, Stage};
use nurbs::{Curve, Surface};
use raycast::Caster;
use scene::{Camera, FaceId, Model, Projection, Viewport};

/// Side of the pictures, pixels.
const SIDE: usize = 48;

/// Heights of the views, as shares of the model's size: in the smallest a pixel is 30 times what the edge's two curves
/// are apart.
const HEIGHTS: [f64; 3] = [0.15, 0.05, 0.012];

/// Places along the edge, as shares of its parameters.
const PLACES: [f64; 4] = [0.3, 0.41, 0.52, 0.68];

/// Views of the edge that faces 0 and 1 share, so near that only the two are in the picture.
fn views(model: &Model) -> Vec<Camera> {
    let edge = &model.shared_edges()[0];
    let trim = model.faces()[0].loops.iter().flat_map(|l| &l.trims).find(|trim| trim.edge == Some(edge.edge));
    let trim = trim.expect("it is shared");
    let curve = Curve::new(trim.knots.clone(), &trim.points, trim.weights.as_deref()).expect("legal");
    let (start, end) = curve.knots().domain();
    let surface = model.surface(FaceId(0));
    let mut views = vec![];
    for (i, place) in PLACES.into_iter().enumerate() {
        let uv = curve.point(start + (end - start) * place);
        let at = surface.point(uv.x, uv.y);
        let normal = surface.inspect(uv.x, uv.y).normal.unit().expect("regular");
        let slant = DVec3::new(0.3, -0.2, 0.1) * (i as f64 - 1.5);
        for height in HEIGHTS {
            let size = model.hull().diagonal();
            let eye = at + size * (normal + slant).normalize();
            let projection = Projection::Orthographic { height: height * size };
            views.push(Camera::look_at(eye, at, DVec3::Z, projection).expect("legal"));
        }
    }
    views
}

/// Pixels that show nothing, or what lies behind both faces.
fn uncovered(buffer: &GBuffer) -> usize {
    buffer.viewport().pixels() - buffer.covered()
}

/// What stays uncovered of all views, by name.
fn found(model: &Model, on_gpu: bool) -> Vec<(String, usize)> {
    let viewport = Viewport::new(SIDE, SIDE).expect("legal");
    let caster = Caster::new(model);
    let device = on_gpu.then(|| gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers`"));
    let mut all = vec![];
    for (view, camera) in views(model).into_iter().enumerate() {
        for &technique in techniques::ALL {
            let stage = Stage::new(model, camera, viewport, Plan { technique, ..Plan::default() }).expect("a stage");
            let name = |renderer: &str| format!("view {view}, {technique:?}, {renderer}");
            all.push((name("raster"), uncovered(&stage.raster())));
            if let Some(device) = device.as_ref().filter(|_| view % 5 == 0) {
                let gpu = stage.gpu(device, None, gpu::Overrides::default()).expect("it draws");
                all.push((name("gpu"), uncovered(&gpu.gbuffer)));
            }
        }
        let stage = Stage::new(model, camera, viewport, Plan::default()).expect("a stage");
        all.push((format!("view {view}, raycast"), uncovered(&stage.raycast(&caster))));
    }
    all
}

#[test]
fn an_edge_that_two_faces_share_shows_nothing_of_what_lies_behind() {
    let model = models::builtin("seam-pair").expect("built in");
    let cracked: Vec<_> = found(&model, true).into_iter().filter(|(_, count)| *count > 0).collect();
    assert!(cracked.is_empty(), "{cracked:?}");
}

/// The check sees what it looks for: a gap that is the model's own.
#[test]
fn a_gap_of_the_models_own_is_shown() {
    let model = models::builtin("seam-pair").expect("built in");
    let surface = model.surface(FaceId(1));
    let apart = 1e-3 * model.hull().diagonal() * DVec3::Y;
    let moved: Vec<DVec3> = surface.points().iter().map(|p| *p + apart).collect();
    let [u, v] = [nurbs::Direction::U, nurbs::Direction::V].map(|d| surface.knots(d).clone());
    let weights = surface.weights().map(<[f64]>::to_vec);
    let torn = model.with_surface(model.faces()[1].surface, Surface::new(u, v, moved, weights).expect("legal"));
    for renderer in ["raster", "raycast"] {
        let shown: usize = found(&torn, false).iter().filter(|(n, _)| n.ends_with(renderer)).map(|(_, c)| c).sum();
        assert!(shown > 100, "{renderer}: {shown}");
    }
}

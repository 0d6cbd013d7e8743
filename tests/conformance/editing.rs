//! Live edits: a control point moves, and nothing but what depends on it is made or uploaded anew.

use gbuffer::GBuffer;
use glam::DVec3;
use pipeline::{PackedScene, Scheme};
use scene::{Camera, FaceId, Model, Viewport};
use techniques::fragment::Tessellation;
use techniques::{Limits, Setting};

/// The model with a corner of its net's middle pulled up by a tenth of its size.
fn pulled(model: &Model) -> Model {
    let surface = &model.surfaces()[0];
    let columns = surface.control_counts()[1];
    let to = surface.points()[2 * columns + 2] + DVec3::Z * 0.1 * model.hull().diagonal();
    model.with_surface(0, surface.with_point([2, 2], to).expect("finite"))
}

fn setting<'a>(model: &'a Model, scene: &'a PackedScene, camera: &'a Camera, viewport: Viewport) -> Setting<'a> {
    Setting { model, scene, camera, viewport, chord_px: 0.25, limits: Limits::default(), vertex_normals: false }
}

/// What a renderer that was made with the pulled model shows, and what one shows that had to learn of it.
#[test]
fn an_edited_renderer_shows_what_a_new_one_shows() {
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    let viewport = Viewport::new(64, 48).expect("a legal size");
    let model = models::builtin("plate").expect("built in");
    let camera = Camera::framing(&model, viewport);
    let edited = pulled(&model);
    assert_eq!(model.region(FaceId(0)), edited.region(FaceId(0)), "trims are not touched");
    let [before, after] = [&model, &edited].map(|model| PackedScene::new(model, Scheme::Specialised).expect("small"));
    for &technique in techniques::ALL {
        let was = technique.prepare(&setting(&model, &before, &camera, viewport)).expect("few triangles");
        let is = was.edited(&setting(&edited, &after, &camera, viewport), FaceId(0)).expect("few triangles");
        let options = gpu::RendererOptions { curvature: true, ..Default::default() };
        let views = after.views(&edited, &camera, viewport);
        let meta = || gbuffer::Meta::new("gpu", technique.name(), &edited, &camera);
        let mut renderer = gpu::Renderer::new(&device, &before, &*was, options).expect("a renderer");
        let old = renderer.gbuffer(&before.views(&model, &camera, viewport), &camera, viewport, meta()).expect("drawn");
        let bytes = renderer.edit((&before, &*was), (&after, &*is)).expect("the same layout");
        let learned = renderer.gbuffer(&views, &camera, viewport, meta()).expect("drawn");
        let mut other = gpu::Renderer::new(&device, &after, &*is, options).expect("a renderer");
        let new = other.gbuffer(&views, &camera, viewport, meta()).expect("drawn");
        let hits = |buffer: &GBuffer| buffer.pixels().map(|hit| hit.copied()).collect::<Vec<_>>();
        assert_eq!(hits(&learned), hits(&new), "{technique:?}");
        assert_ne!(hits(&old), hits(&new), "{technique:?}: the edit shows");
        // The trims alone are more numbers than the control points and corners that moved.
        let all = 16 * after.points().len() + 108 * is.triangles();
        assert!(bytes > 0 && bytes < all as u64, "{technique:?}: {bytes} of {all}");
        assert_eq!(renderer.edit((&after, &*is), (&after, &*is)).expect("nothing"), 0);
    }
}

#[test]
fn an_edit_of_another_layout_is_refused() {
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    let viewport = Viewport::new(32, 32).expect("a legal size");
    let shots = ["plate", "teapot"].map(|name| {
        let model = models::builtin(name).expect("built in");
        let camera = Camera::framing(&model, viewport);
        let scene = PackedScene::new(&model, Scheme::Specialised).expect("small");
        let prepared = techniques::ALL[0].prepare(&setting(&model, &scene, &camera, viewport)).expect("few triangles");
        (scene, prepared)
    });
    let [(before, was), (after, is)] = &shots;
    let mut renderer = gpu::Renderer::new(&device, before, &**was, Default::default()).expect("a renderer");
    let refused = renderer.edit((before, &**was), (after, &**is));
    assert!(matches!(refused, Err(gpu::GpuError::OtherShape { .. })), "{refused:?}");
}

#[test]
fn triangles_follow_their_surface_and_know_how_far_they_are_off() {
    let viewport = Viewport::new(64, 48).expect("a legal size");
    let model = models::builtin("plate").expect("built in");
    let camera = Camera::framing(&model, viewport);
    let edited = pulled(&model);
    let [before, after] = [&model, &edited].map(|model| PackedScene::new(model, Scheme::Specialised).expect("small"));
    let was = Tessellation::new(&setting(&model, &before, &camera, viewport)).expect("few triangles");
    let followed = was.followed(&edited, &after, FaceId(0)).expect("no border is parted");
    assert_eq!(followed.mesh.indices, was.mesh.indices, "nothing is tessellated anew");
    assert!(followed.chord[0][0] > 0.0 && followed.chord != was.chord);
}

/// The teapot with a control point of its first patch moved.
fn teapot(point: [usize; 2]) -> (Model, Model) {
    let model = models::builtin("teapot").expect("built in");
    let start = &model.surfaces()[0];
    let columns = start.control_counts()[1];
    let rest = start.points()[point[0] * columns + point[1]];
    let moved = start.with_point(point, rest + glam::DVec3::Z * 0.3).expect("finite");
    let edited = model.with_surface(0, moved);
    (model, edited)
}

/// Corners that stand at one place before an edit do so after it, and a border that is moved away from its neighbour's is cut anew.
#[test]
fn faces_that_share_a_border_follow_together_until_it_is_parted() {
    let viewport = Viewport::new(64, 48).expect("a legal size");
    let (model, inside) = teapot([1, 1]);
    let camera = Camera::framing(&model, viewport);
    let packed = |model: &Model| PackedScene::new(model, Scheme::Specialised).expect("small");
    let (before, after) = (packed(&model), packed(&inside));
    let was = Tessellation::new(&setting(&model, &before, &camera, viewport)).expect("few triangles");
    let followed = was.followed(&inside, &after, FaceId(0)).expect("no border is parted");
    let places = |of: &Tessellation, face: bool| {
        let bits = |v: &pipeline::Vertex| (v.frame, v.position.map(f32::to_bits));
        let own = of.mesh.vertices.iter().filter(|v| (v.face == 0) == face);
        own.map(bits).collect::<std::collections::HashSet<_>>()
    };
    let common = |of: &Tessellation| places(of, true).intersection(&places(of, false)).count();
    assert!(common(&was) > 8, "{}", common(&was));
    assert_eq!(common(&followed), common(&was));
    assert_eq!(followed.mesh.indices, was.mesh.indices, "nothing is tessellated anew");
    let (_, border) = teapot([1, 0]);
    assert!(was.followed(&border, &packed(&border), FaceId(0)).is_none());
}

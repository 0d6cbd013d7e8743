//! Technique `zones`: a picture in many steps is that in one.

use gpu::{Device, Renderer, RendererOptions};
use pipeline::fragment::Fragment;
use pipeline::{PackedScene, Scheme};
use scene::{Camera, Viewport};
use techniques::grid::Grids;
use techniques::zones::{PAPER_ZONES, Zones};

#[test]
fn many_steps_show_what_one_shows_and_what_technique_grid_shows() {
    let device = Device::open(Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`");
    let viewport = Viewport::new(96, 72).expect("a legal size");
    for name in ["teapot", "islands"] {
        let model = models::builtin(name).expect("built in");
        let camera = Camera::framing(&model, viewport);
        let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
        let grids = Grids::new(&model, &scene, &camera, viewport, 0.25).expect("few triangles");
        let zones = Zones::new(grids.clone(), &scene);
        let views = scene.views(&model, &camera, viewport);
        let shown = |drawn: &dyn gpu::Drawable| -> Vec<Option<Fragment>> {
            let mut renderer = Renderer::new(&device, &scene, drawn, RendererOptions::default()).expect("it fits");
            renderer.fragments(&views, viewport).expect("drawn")
        };
        let by_grid = shown(&grids);
        assert!(by_grid.iter().flatten().count() > 1000);
        for most in [7, PAPER_ZONES, u32::MAX] {
            let zones = zones.clone().in_steps_of(most);
            let count: usize = zones.steps.iter().map(|step| step.zones.len()).sum();
            assert_eq!(count as u32, zones.firsts[zones.firsts.len() - 1]);
            assert!(most == u32::MAX || zones.steps.len() >= count / most as usize);
            assert!(shown(&zones) == by_grid, "{name}, {most} zones a step");
        }
    }
}

#[test]
fn no_grid_is_a_picture_of_nothing() {
    let device = Device::open(Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`");
    let viewport = Viewport::new(16, 16).expect("a legal size");
    let model = models::builtin("teapot").expect("built in");
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
    let views = scene.views(&model, &Camera::framing(&model, viewport), viewport);
    let mut renderer = Renderer::new(&device, &scene, &Zones::default(), RendererOptions::default()).expect("it fits");
    assert!(renderer.fragments(&views, viewport).expect("drawn").iter().all(Option::is_none));
}

//! Technique `zones`: a picture in many steps is that in one, and steps are within their limits.

mod common;

use common::software;
use gpu::{Renderer, RendererOptions};
use pipeline::fragment::Fragment;
use pipeline::{PackedScene, Scheme};
use scene::{Camera, Model, Viewport};
use techniques::grid::Grids;
use techniques::zones::Zones;
use techniques::{Limits, PAPER_ZONES, PrepareError, Setting};

fn viewport() -> Viewport {
    Viewport::new(96, 72).expect("a legal size")
}

fn grids(model: &Model, camera: &Camera, scene: &PackedScene) -> Grids {
    let limits = Limits::default();
    Grids::new(&Setting { model, scene, camera, viewport: viewport(), chord_px: 0.25, limits, vertex_normals: false })
        .expect("few triangles")
}

#[test]
fn many_steps_show_what_one_shows_and_what_technique_grid_shows() {
    let device = software();
    for name in ["teapot", "islands"] {
        let model = models::builtin(name).expect("built in");
        let camera = Camera::framing(&model, viewport());
        let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
        let grids = grids(&model, &camera, &scene);
        let views = scene.views(&model, &camera, viewport());
        let shown = |drawn: &dyn gpu::Drawable| -> Vec<Option<Fragment>> {
            let mut renderer = Renderer::new(&device, &scene, drawn, RendererOptions::default()).expect("it fits");
            renderer.fragments(&views, viewport()).expect("drawn")
        };
        let by_grid = shown(&grids);
        assert!(by_grid.iter().flatten().count() > 1000);
        for (most, batch) in [(7, None), (PAPER_ZONES, None), (u32::MAX, None), (PAPER_ZONES, Some(3))] {
            let limits = Limits { zones: most, batch, ..Limits::default() };
            let zones = Zones::new(grids.clone(), &scene, &limits).expect("within limits");
            let count: usize = zones.steps.iter().map(|step| step.zones.len()).sum();
            assert_eq!(count as u32, zones.firsts[zones.firsts.len() - 1]);
            assert!(most == u32::MAX || zones.steps.len() >= count / most as usize);
            assert!(zones.steps.iter().all(|step| step.zones.len() as u32 <= most));
            assert!(shown(&zones) == by_grid, "{name}, {most} zones a step");
        }
    }
}

#[test]
fn a_batch_holds_so_many_whole_patches_and_a_patch_that_is_too_fine_for_it_is_named() {
    let model = models::builtin("teapot").expect("built in");
    let camera = Camera::framing(&model, viewport());
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
    let grids = grids(&model, &camera, &scene);
    let zones = |zones: u32, batch: u32| {
        Zones::new(grids.clone(), &scene, &Limits { zones, batch: Some(batch), ..Limits::default() })
    };
    for batch in [1, 5, 32] {
        let zones = zones(u32::MAX, batch).expect("no limit");
        for step in &zones.steps {
            // Both ends are those of patches.
            let ends = [step.zones.start, step.zones.end].map(|end| zones.firsts.binary_search(&end));
            assert!(ends.iter().all(Result::is_ok), "{step:?}");
        }
        let drawn = zones.firsts.windows(2).filter(|pair| pair[0] < pair[1]).count();
        assert_eq!(zones.steps.len(), drawn.div_ceil(batch as usize), "the pot's patches are of one program");
    }
    let cells = |record: &techniques::grid::GridRecord| record.cells().map(|n| n.div_ceil(4)).iter().product::<u32>();
    let most = grids.picture.records.iter().map(cells).max().expect("patches");
    assert!(zones(most, 32).is_ok());
    let Err(PrepareError::TooManyZones { face, span, zones: found, most: asked }) = zones(most - 1, 32) else {
        panic!("a patch has {most} zones")
    };
    assert_eq!((found, asked), (most, most - 1));
    let is_named = |record: &&techniques::grid::GridRecord| record.face == face && record.span == span;
    assert!(grids.picture.records.iter().filter(is_named).any(|record| cells(record) == most));
}

#[test]
fn no_grid_is_a_picture_of_nothing() {
    let device = software();
    let viewport = Viewport::new(16, 16).expect("a legal size");
    let model = models::builtin("teapot").expect("built in");
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("it packs");
    let views = scene.views(&model, &Camera::framing(&model, viewport), viewport);
    let mut renderer = Renderer::new(&device, &scene, &Zones::default(), RendererOptions::default()).expect("it fits");
    assert!(renderer.fragments(&views, viewport).expect("drawn").iter().all(Option::is_none));
}

//! What corners are allowed that an adapter snaps: as much as its own grid moves them, as measured, and no more whatever it is called.

use compare::{Cause, PairReport, Verdict};
use gbuffer::GBuffer;
use glam::DVec3;
use gpu::{Grid, Rounding};
use isophote::stage::{Plan, Stage};
use nurbs::{KnotVector, Surface};
use pipeline::wgsl::{self, Variant};
use raycast::Caster;
use scene::{Camera, Face, Model, Projection, Viewport};

/// Pixels by which the planted adapter moves every corner to the right.
const MOVED_PX: f64 = 1.0 / 64.0;

/// A tilted square, of which two triangles are all, wider than the picture.
fn square() -> Model {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("sorted");
    let points = vec![
        DVec3::new(-2.0, -2.0, -0.3),
        DVec3::new(-2.0, 2.0, 0.1),
        DVec3::new(2.0, -2.0, 0.0),
        DVec3::new(2.0, 2.0, 0.4),
    ];
    let surface = Surface::new(knots(), knots(), points, None).expect("legal");
    Model::new("square".to_owned(), vec![surface], vec![Face::whole(0)]).expect("legal")
}

fn stage(model: &Model) -> Stage<'_> {
    let viewport = Viewport::new(64, 64).expect("a legal size");
    let projection = Projection::Orthographic { height: 2.0 };
    let camera = Camera::look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, projection).expect("legal");
    Stage::new(model, camera, viewport, Plan::default()).expect("a stage")
}

/// What an adapter shows that moves every corner.
fn moved(stage: &Stage, device: &gpu::Device) -> GBuffer {
    let from = "out.clip = m[0] * in.position.x + m[1] * in.position.y + m[2] * in.position.z + m[3];";
    let shift = format!("{from}\n out.clip.x += out.clip.w * {:?};", 2.0 * MOVED_PX / stage.viewport.width() as f64);
    let source = |variant: Variant| {
        let source = wgsl::source(variant);
        assert!(source.contains(from), "the source no longer says {from:?}");
        source.replace(from, &shift)
    };
    let overrides = gpu::Overrides { source: Some(&source), ..Default::default() };
    stage.gpu(device, None, overrides).expect("the GPU draws").gbuffer
}

fn both(stage: &Stage, caster: &Caster, picture: &GBuffer, grid: Option<Grid>) -> [PairReport; 2] {
    let moves_px = grid.map(Grid::moves_px);
    [
        stage.against_raycast_on(caster, &stage.raycast(caster), picture, moves_px).expect("comparable"),
        stage.against_raster_on(&stage.raster(), picture, moves_px).expect("comparable"),
    ]
}

#[test]
fn a_picture_that_is_moved_by_a_64th_of_a_pixel_differs_but_by_the_measured_grid_of_a_coarser_adapter() {
    let device = gpu::Device::open(Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`");
    let model = square();
    let (stage, caster) = (stage(&model), Caster::new(&model));
    let right = stage.gpu(&device, None, gpu::Overrides::default()).expect("the GPU draws");
    assert_eq!(right.moves_px, Some(1.0 / 512.0), "llvmpipe rounds to the nearest 256th");
    let moved = moved(&stage, &device);
    let measured = device.measured_grid().expect("it draws");
    for grid in [None, measured, Some(Grid { bits: 8, rounding: Rounding::OneWay })] {
        for pair in both(&stage, &caster, &moved, grid) {
            let share = pair.differing() as f64 / pair.covered as f64;
            assert!(share > 0.95, "{grid:?}: {share}, {} of {} px, {}", pair.max_px, pair.bound_px, pair.bounds);
            assert_eq!((pair.verdict, pair.main_cause()), (Verdict::Differ, Some(Cause::Interpolation)));
        }
        let pairs = both(&stage, &caster, &right.gbuffer, grid);
        assert!(pairs.iter().all(|pair| pair.verdict == Verdict::Agree), "{grid:?}");
    }
    let coarse = Some(Grid { bits: 4, rounding: Rounding::Nearest });
    let pairs = both(&stage, &caster, &moved, coarse);
    assert!(pairs.iter().all(|pair| pair.verdict == Verdict::Agree), "{:?}", pairs.map(|pair| pair.causes));
}

#[test]
fn what_a_picture_says_of_its_adapter_allows_it_nothing() {
    let device = gpu::Device::open(Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`");
    let model = square();
    let (stage, caster) = (stage(&model), Caster::new(&model));
    let moved = moved(&stage, &device);
    let mut meta = moved.meta().clone();
    meta.adapter = Some("SwiftShader, 4 bits of subpixel precision".to_owned());
    let row = |y: usize| (0..64).map(|x| moved.get(x, y).copied()).collect::<Vec<_>>();
    let named = GBuffer::from_rows(moved.viewport(), meta, (0..64).map(row));
    for pair in both(&stage, &caster, &named, None) {
        assert_eq!(pair.verdict, Verdict::Differ);
    }
}

//! Trimming by masks: what the CPU and the GPU draw, what a comparison grants them, and that it grants no more.

use crate::three_way::words;
use compare::{Cause, PairReport, Verdict};
use gbuffer::{GBuffer, Meta, Trims};
use glam::{DVec2, dvec2};
use gpu::{Device, MaskBlend, MaskPainter, Overrides};
use isophote::compare::Saved;
use isophote::stage::{OnGpu, Plan, Rendered, Stage};
use pipeline::mask::{MaskFill, MaskOptions, MaskPlan, MaskQuality, Masks, Tile, Trimming};
use pipeline::{PackedScene, Scheme, trim};
use raycast::Caster;
use scene::{Camera, FaceId, Model, Region, Viewport};
use std::path::PathBuf;
use std::sync::Arc;
use techniques::Technique;

/// Side of the pictures, pixels.
const SIDE: usize = 64;

/// How far from an edge, in texels, tiny-skia is wrong here; on edges longer than these 0.8 was seen, and a plan grants 1.
const SCAN_LINES: f64 = 0.5;

/// How far from an edge, in texels, fans may be wrong: corners snap to 1/256 of a texel, and chords take the rest.
const FANS: f64 = 0.1;

fn device() -> Device {
    Device::open(Some("llvmpipe")).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`")
}

fn model(name: &str) -> Model {
    models::builtin(name).expect("built in")
}

fn fixed(side: u32, chords: u32) -> MaskOptions {
    MaskOptions { quality: MaskQuality::Fixed { side, chords }, ..MaskOptions::default() }
}

fn planned(model: &Model, options: &MaskOptions) -> MaskPlan {
    let viewport = Viewport::new(SIDE, SIDE).expect("a legal size");
    MaskPlan::new(model, &Camera::framing(model, viewport), viewport, options).expect("they fit")
}

/// What the device draws.
fn fans(device: &Device, plan: &MaskPlan) -> Vec<u8> {
    let painter = MaskPainter::new(device, MaskBlend::Parity).expect("it compiles");
    painter.draw(device, plan).and_then(|atlas| atlas.texels(device)).unwrap_or_else(|error| panic!("{error}"))
}

/// Which texels of a tile have an edge within the margin of their centre, along u or along v.
fn near_edges(region: &Region, tile: &Tile, margin: f64) -> Vec<bool> {
    let [width, height] = tile.size.map(|side| side as usize);
    let mut near = vec![false; width * height];
    let (low, texels) = (region.hull().min, DVec2::from_array(tile.size.map(f64::from)) / region.hull().size());
    for piece in region.pieces() {
        let extent = (piece.curve.hull().size() * texels).max_element();
        // Far closer than the 1/20 texel by which the margin is widened: monotone pieces of much the same speed all along.
        let steps = (100.0 * extent).ceil() as usize + 1;
        for i in 0..=steps {
            let at = (piece.curve.point(i as f64 / steps as f64) - low) * texels;
            let range = |x: f64, side: usize| {
                let first = (x - margin - 0.55).ceil().max(0.0) as usize;
                first..(((x + margin - 0.45).floor() + 1.0).max(0.0) as usize).min(side)
            };
            for row in range(at.y, height) {
                range(at.x, width).for_each(|column| near[row * width + column] = true);
            }
        }
    }
    near
}

/// Texels that are wrong though no edge is near, by the exact test in f32 at their centres; and how many were judged.
fn wrong_texels(model: &Model, plan: &MaskPlan, texels: &[u8], margin: f64) -> (usize, usize) {
    let scene = PackedScene::new(model, Scheme::General).expect("small");
    let (mut wrong, mut judged) = (0, 0);
    for (index, tile) in plan.tiles.iter().enumerate() {
        let Some(tile) = tile else { continue };
        let region = model.region(FaceId(index as u32)).expect("trimmed");
        let near = near_edges(region, tile, margin);
        let [width, height] = tile.size.map(|side| side as usize);
        for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
            if near[row * width + column] {
                continue;
            }
            let share = (dvec2(column as f64, row as f64) + 0.5) / dvec2(width as f64, height as f64);
            let uv = (tile.hull[0] + share * (tile.hull[1] - tile.hull[0])).to_array().map(|t| t as f32);
            let expected = trim::is_material(&scene, &scene.faces()[index], uv);
            let at = (tile.corner[1] as usize + row) * plan.size[0] as usize + tile.corner[0] as usize + column;
            assert!(matches!(texels[at], 0 | 255));
            judged += 1;
            wrong += usize::from((texels[at] == 255) != expected);
        }
    }
    (wrong, judged)
}

#[test]
fn masks_by_scan_lines_by_ears_and_by_fans_are_right_but_along_edges() {
    let device = device();
    for (name, _) in models::TRIMMED {
        let model = model(name);
        for (side, chords) in [(127, 64), (300, 64)] {
            let plan = planned(&model, &fixed(side, chords));
            let fans = fans(&device, &plan);
            let drawn = [plan.fill(MaskFill::EvenOdd), plan.fill(MaskFill::Earcut), fans];
            let kinds = [("even-odd", SCAN_LINES), ("earcut", SCAN_LINES), ("fans", FANS)];
            for (texels, (how, margin)) in drawn.iter().zip(kinds) {
                let (wrong, judged) = wrong_texels(&model, &plan, texels, margin);
                assert!(judged > 1000 && wrong == 0, "{name}, {side} texels, {how}: {wrong} of {judged} are wrong");
            }
            // Along edges they differ, but not much.
            let [even_odd, earcut, fans] = &drawn;
            for other in [earcut, fans] {
                let differ = even_odd.iter().zip(other).filter(|(a, b)| a != b).count();
                assert!(differ <= even_odd.len() / 50, "{name}, {side} texels: {differ} differ");
            }
        }
    }
}

/// The share of a mask's texels that are material, times the area of its box.
fn area(region: &Region, plan: &MaskPlan, texels: &[u8]) -> f64 {
    let size = region.hull().size();
    let filled = texels.iter().filter(|texel| **texel > 0).count();
    size.x * size.y * filled as f64 / plan.bytes() as f64
}

#[test]
fn the_area_of_a_mask_converges_to_the_region_s_at_first_order() {
    let device = device();
    for name in ["plate", "islands", "cusp", "text"] {
        let model = model(name);
        let region = model.region(FaceId(0)).expect("trimmed");
        let length: f64 = region.pieces().iter().map(|piece| piece.curve.hull().size().element_sum()).sum();
        for side in [64, 128, 256, 512, 1024] {
            let plan = planned(&model, &fixed(side, 256));
            assert_eq!(plan.size, [side; 2], "an atlas of one mask");
            for texels in [plan.fill(MaskFill::EvenOdd), fans(&device, &plan)] {
                let error = (area(region, &plan, &texels) - region.area()).abs();
                // A mask as bad as it may be is off by a texel all along its edges; errors that cancel leave far less.
                let texel = (region.hull().size() / f64::from(side)).max_element();
                assert!(error <= 0.1 * length * texel, "{name}, {side} texels: {error} of {}", region.area());
            }
        }
    }
}

fn staged<'m>(model: &'m Model, technique: &'static dyn Technique, options: MaskOptions) -> Stage<'m> {
    let viewport = Viewport::new(SIDE, SIDE).expect("a legal size");
    let plan = Plan { technique, trim: Trimming::Texture(options), ..Plan::default() };
    Stage::new(model, Camera::framing(model, viewport), viewport, plan).expect("a stage")
}

fn compared(stage: &Stage, device: &Device, caster: &Caster) -> Vec<PairReport> {
    let gpu: Result<OnGpu, String> =
        stage.gpu(device, None, Overrides::default()).map_err(|error| format!("{error:#}"));
    assert!(gpu.is_ok(), "{:?}", gpu.err());
    let rendered = Rendered { raycast: stage.raycast(caster), raster: stage.raster(), gpu };
    stage.compare(caster, &rendered).expect("comparable")
}

#[test]
fn three_renderers_agree_on_faces_trimmed_by_masks() {
    let device = device();
    let mut failures = vec![];
    for name in ["plate", "islands", "text", "window", "seam-pair"] {
        let model = model(name);
        let caster = Caster::new(&model);
        for &technique in techniques::ALL {
            for fill in [MaskFill::EvenOdd, MaskFill::Earcut] {
                let stage = staged(&model, technique, MaskOptions { fill, ..MaskOptions::default() });
                failures.extend(words(name, technique.name(), &compared(&stage, &device, &caster)));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn masks_far_too_coarse_for_the_picture_are_judged_by_their_own_error() {
    let model = model("islands");
    let caster = Caster::new(&model);
    let stage = staged(&model, &techniques::fragment::Fragment, fixed(24, 2));
    let error = stage.scene.masks().expect("masked").plan.error_px();
    assert!(error > 2.0, "{error} px");
    let pairs = compared(&stage, &device(), &caster);
    assert!(
        pairs.iter().all(|pair| pair.verdict == Verdict::Agree),
        "{}",
        words("islands", "24 texels", &pairs).join("\n")
    );
    // Granted what finer masks are, they are found out.
    let (raycast, raster) = (stage.raycast(&caster), stage.raster());
    let strict = staged(&model, &techniques::fragment::Fragment, MaskOptions::default());
    let pair = strict.against_raycast(&caster, &raycast, &raster).expect("comparable");
    assert!(pair.verdict == Verdict::Differ && pair.causes[&Cause::Trim] > 0, "{:?}", pair.causes);
}

/// Makes a loop's curves a point, so that it bounds nothing.
fn without_ring(plan: &mut MaskPlan, face: usize, ring: usize) {
    let curves = plan.tiles[face].as_ref().expect("trimmed").rings[ring].curves.clone();
    for curve in &mut plan.curves[curves] {
        curve.origin = [0.0; 2];
        for c in &mut plan.control[curve.control as usize..][..=curve.degree as usize] {
            *c = [0.0, 0.0, 1.0, 0.0];
        }
    }
}

/// Starts each curve's triangles at its own first point.
fn with_wrong_origins(plan: &mut MaskPlan) {
    for curve in &mut plan.curves {
        let [x, y, w, _] = plan.control[curve.control as usize];
        curve.origin = [x / w, y / w];
    }
}

#[test]
fn a_loop_left_out_a_wrong_fan_and_a_union_for_parity_are_found_and_named() {
    let device = device();
    for name in ["plate", "islands"] {
        let model = model(name);
        let caster = Caster::new(&model);
        let healthy = staged(&model, &techniques::fragment::Fragment, MaskOptions::default());
        let raycast = healthy.raycast(&caster);
        let judged = |stage: &Stage, overrides: Overrides, what: &str| {
            let gpu = stage.gpu(&device, None, overrides).expect("it is drawn").gbuffer;
            let pair = healthy.against_raycast(&caster, &raycast, &gpu).expect("comparable");
            let trim = pair.causes.get(&Cause::Trim).copied().unwrap_or(0);
            assert!(trim > 0 && trim * 20 >= pair.differing() * 19, "{name}, {what}: {:?}", pair.causes);
        };
        judged(&healthy, Overrides { mask: MaskBlend::Union, ..Overrides::default() }, "union");
        let plan = &healthy.scene.masks().expect("masked").plan;
        let faulty = |plan: &MaskPlan| {
            let mut stage = staged(&model, &techniques::fragment::Fragment, MaskOptions::default());
            let masks = Masks::new(plan.clone(), MaskFill::EvenOdd);
            stage.scene = Arc::new(PackedScene::masked(&model, stage.plan.scheme, masks).expect("small"));
            stage
        };
        let [mut without, mut turned] = [plan.clone(), plan.clone()];
        without_ring(&mut without, 0, 1);
        with_wrong_origins(&mut turned);
        judged(&faulty(&without), Overrides::default(), "a loop left out");
        judged(&faulty(&turned), Overrides::default(), "wrong origins");
        // The CPU fills from no origin; it can only leave out a loop.
        let stage = faulty(&without);
        let pair = healthy.against_raycast(&caster, &raycast, &stage.raster()).expect("comparable");
        assert!(pair.causes[&Cause::Trim] > 0, "{name}: {:?}", pair.causes);
    }
}

#[test]
fn a_saved_file_says_how_coarse_its_masks_are_and_is_allowed_that_and_no_more_than_the_caller_says() {
    let model = model("islands");
    let file = |name: &str, buffer: &GBuffer| {
        let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("masks-{name}.npz"));
        buffer.write_npz(&path).expect("a file can be written");
        path
    };
    let judged = |paths: &[PathBuf], masks_px: Option<f64>| {
        Saved::open(paths, None).and_then(|saved| saved.compare(Plan::default(), masks_px)).map(|found| found.pairs)
    };
    let of_px = |px: f64| MaskOptions { quality: MaskQuality::Error { px }, ..MaskOptions::default() };
    let coarse = staged(&model, &techniques::exact::Exact, of_px(4.0)).raster();
    assert_eq!(coarse.meta().trims, Trims::Masks { error_px: 4.0 });
    let path = file("coarse", &coarse);
    assert_eq!(GBuffer::read_npz(&path).expect("readable").meta().trims, Trims::Masks { error_px: 4.0 });
    for (allowed, flag) in [(None, "--trim texture"), (Some(0.5), "--mask-px")] {
        let error = judged(std::slice::from_ref(&path), allowed).expect_err("not allowed");
        assert!(error.to_string().contains("4 px") && error.to_string().contains(flag), "{error:#}");
    }
    let pairs = judged(std::slice::from_ref(&path), Some(4.0)).expect("comparable");
    assert!(pairs[0].verdict == Verdict::Agree && pairs[0].coverage.partial > 0, "{pairs:?}");
    // Who understates his masks, or does not mention them, is found out.
    for trims in [Trims::Masks { error_px: 0.25 }, Trims::Exact] {
        let lying = coarse.clone().with_meta(Meta { trims, ..coarse.meta().clone() });
        let pairs = judged(&[file("lying", &lying)], Some(4.0)).expect("comparable");
        assert!(pairs[0].verdict == Verdict::Differ && pairs[0].causes[&Cause::Trim] > 0, "{trims:?}");
    }
    let fine = staged(&model, &techniques::fragment::Fragment, MaskOptions::default()).raster();
    let gpu = fine.clone().with_meta(Meta { renderer: "gpu".to_owned(), ..fine.meta().clone() });
    let pairs = judged(&[file("fine", &fine), file("gpu", &gpu)], Some(0.5)).expect("comparable");
    assert!(pairs.len() == 3 && pairs.iter().all(|pair| pair.verdict == Verdict::Agree), "{pairs:?}");
    let bad = fine.clone().with_meta(Meta { trims: Trims::Masks { error_px: -1.0 }, ..fine.meta().clone() });
    assert!(judged(&[file("bad", &bad)], Some(4.0)).expect_err("no error").to_string().contains("-1 px"));
}

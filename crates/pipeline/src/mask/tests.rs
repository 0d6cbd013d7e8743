//! Masks are as fine as their error asks for, and as coarse as their memory.

use super::*;
use glam::DVec3;
use scene::{Camera, FaceId, Model, Viewport};

fn planned(model: &Model, options: &MaskOptions) -> Result<MaskPlan, MaskError> {
    let viewport = Viewport::new(256, 256).expect("a legal size");
    // From farther away than fills the picture: so near, a mask would be larger than a texture may be.
    let (framing, center) = (Camera::framing(model, viewport), model.hull().center());
    let eye = center + 1.75 * (framing.eye() - center);
    let camera = Camera::look_at(eye, center, DVec3::Z, framing.projection()).expect("a legal camera");
    MaskPlan::new(model, &camera, viewport, options)
}

fn models() -> impl Iterator<Item = (&'static str, Model)> {
    models::TRIMMED.iter().map(|(name, _)| (*name, models::builtin(name).expect("built in")))
}

#[test]
fn masks_keep_to_the_error_that_was_asked_for_and_halve_their_texels_with_it() {
    for (name, model) in models() {
        let plan = |px| {
            let quality = MaskQuality::Error { px };
            planned(&model, &MaskOptions { quality, ..MaskOptions::default() }).expect("they fit")
        };
        let (fine, coarse) = (plan(0.5), plan(1.0));
        assert!(fine.error_px() <= 0.5 * (1.0 + 1e-12) && fine.coarser == 1.0, "{name}: {} px", fine.error_px());
        assert!(fine.error_px() > 0.3, "{name}: {} px is finer than need be", fine.error_px());
        for (fine, coarse) in fine.tiles.iter().flatten().zip(coarse.tiles.iter().flatten()) {
            for k in 0..2 {
                assert!((2 * coarse.size[k]).abs_diff(fine.size[k]) <= 1, "{name}: {coarse:?} | {fine:?}");
            }
        }
    }
}

#[test]
fn chords_are_as_near_their_curves_as_the_second_derivative_says() {
    const PER_CHORD: usize = 16;
    for (name, model) in models() {
        let regions = (0..model.faces().len()).filter_map(|face| model.region(FaceId(face as u32)));
        for piece in regions.flat_map(|region| region.pieces()) {
            for chords in [1, 3] {
                let bound = piece.curve.second_derivative_bounds() / (8.0 * (chords * chords) as f64);
                for i in 0..=chords * PER_CHORD {
                    let [from, to] = [i / PER_CHORD, i.div_ceil(PER_CHORD)].map(|k| k as f64 / chords as f64);
                    let t = i as f64 / (chords * PER_CHORD) as f64;
                    let share = if to > from { (t - from) / (to - from) } else { 0.0 };
                    let chord = piece.curve.point(from).lerp(piece.curve.point(to), share);
                    let off = (piece.curve.point(t) - chord).abs();
                    assert!(off.cmple(bound + 1e-12).all(), "{name}: {off} beyond {bound} at {t}");
                }
            }
        }
    }
}

#[test]
fn masks_that_do_not_fit_are_coarser_and_say_so_until_there_is_not_a_texel_for_each() {
    let model = models::builtin("pieces").expect("built in");
    let of = |memory| planned(&model, &MaskOptions { memory, ..MaskOptions::default() });
    let whole = of(256 << 20).expect("they fit");
    let half = of(whole.bytes() / 4).expect("coarser ones fit");
    assert!(half.bytes() <= whole.bytes() / 4 && half.bytes() > whole.bytes() / 8, "{} bytes", half.bytes());
    assert!((1.8..2.6).contains(&half.coarser), "{} times coarser", half.coarser);
    assert!(half.error_px() > 1.2 * whole.error_px(), "{} px", half.error_px());
    let least = of(16).expect("a texel each");
    assert!(least.tiles.iter().flatten().all(|tile| tile.size == [1, 1]));
    let error = of(15).expect_err("16 faces");
    assert_eq!(error, MaskError::Memory { faces: 16, memory: 15 });
    assert!(error.to_string().contains("16 trimmed faces do not fit into 15 bytes"), "{error}");
}

#[test]
fn senseless_qualities_are_refused() {
    let model = models::builtin("islands").expect("built in");
    let of = |quality| planned(&model, &MaskOptions { quality, ..MaskOptions::default() });
    for px in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(of(MaskQuality::Error { px }), Err(MaskError::Error { .. })), "{px}");
    }
    for (side, chords) in [(0, 1), (1, 0), (8192, 1), (1, 4097)] {
        assert_eq!(of(MaskQuality::Fixed { side, chords }), Err(MaskError::Fixed { side, chords }));
    }
    assert!(of(MaskQuality::Error { px: 1e-300 }).is_ok_and(|plan| plan.error_px() > 0.0));
}

#[test]
fn a_model_without_trims_needs_no_masks() {
    let model = models::builtin("teapot").expect("built in");
    let plan = planned(&model, &MaskOptions::default()).expect("nothing to fit");
    assert!(plan.tiles.iter().all(Option::is_none) && plan.bytes() <= 2 && plan.chords() == 0);
}

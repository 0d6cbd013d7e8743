//! Pictures that are right for another camera: shifted, or with another field of view.

use super::fault::Fault;
use super::view::{Hypothesis, Seen, View, mostly};
use gbuffer::Meta;
use glam::DVec2;
use scene::{Camera, Projection};

/// A pixel may lie this far beside its place, pixels, to be tried: chords and snapping.
const BESIDE_PX: f64 = 0.5;

/// How far a rounder number may move the picture's border, pixels. A fault is stated and tried as rounded.
const ROUNDED_PX: f64 = 0.1;

/// Parts of 1 that numbers are rounded to, the roundest first.
const ROUND_PARTS: [f64; 4] = [1.0, 2.0, 10.0, 100.0];

/// A tangent may be off by this share to be taken for that of the angle across the picture.
const ACROSS_SHARE: f64 = 1e-3;

/// The cameras for which a picture may be right.
pub(super) fn hypotheses(view: &View, samples: &[Seen]) -> Vec<Hypothesis> {
    [shifted(view, samples), enlarged(view, samples)].into_iter().flatten().collect()
}

/// Everything lies beside its place by one offset: the camera's lens is shifted.
fn shifted(view: &View, samples: &[Seen]) -> Option<Hypothesis> {
    let offsets: Vec<DVec2> = samples.iter().filter_map(|seen| Some(seen.center - seen.place?)).collect();
    let of = |component: fn(&DVec2) -> f64| median(offsets.iter().map(component).collect());
    let offset = DVec2::new(of(|d| d.x)?, of(|d| d.y)?);
    let px = offset.to_array().map(|x| rounded(x, |a, b| (a - b).abs()));
    let shift = DVec2::from_array(px);
    if shift == DVec2::ZERO
        || !mostly(samples, |seen| seen.place.is_some_and(|p| seen.center.distance(p + shift) <= BESIDE_PX))
    {
        return None;
    }
    let lens = DVec2::new(-shift.x, shift.y) / view.buffer.viewport().height() as f64;
    let camera = view.camera.with_lens_shift(view.camera.lens_shift() + lens).ok()?;
    Some(seen_by(view, Fault::Shifted { px }, camera))
}

/// Everything lies farther from the picture's middle, or nearer to it, by one factor.
fn enlarged(view: &View, samples: &[Seen]) -> Option<Hypothesis> {
    let viewport = view.buffer.viewport();
    let (width, height) = (viewport.width() as f64, viewport.height() as f64);
    let middle = view.camera.picture(viewport, view.camera.eye() + view.camera.forward())?;
    let far: Vec<(DVec2, DVec2)> = samples
        .iter()
        .filter_map(|seen| Some((seen.center - middle, seen.place? - middle)))
        .filter(|(center, _)| center.length() >= height / 8.0)
        .collect();
    let near_median = median(far.iter().map(|(c, p)| p.dot(*c) / c.length_squared()).collect())?;
    // Those that the median explains say it more closely.
    let explained = far.iter().filter(|(c, p)| p.distance(near_median * *c) <= BESIDE_PX);
    let (mut along, mut squared) = (0.0, 0.0);
    for (c, p) in explained {
        (along, squared) = (along + p.dot(*c), squared + c.length_squared());
    }
    let factor = along / squared;
    let reach = 0.5 * DVec2::new(width, height).length();
    let is_there = factor.is_finite() && (factor - 1.0).abs() * reach > ROUNDED_PX;
    if !is_there
        || !mostly(samples, |s| s.place.is_some_and(|p| p.distance(middle + factor * (s.center - middle)) <= BESIDE_PX))
    {
        return None;
    }
    let (projection, fault) = match view.camera.projection() {
        Projection::Perspective { fov_deg: asked_deg } => {
            let tangent = |deg: f64| (0.5 * deg.to_radians()).tan();
            let drawn = 2.0 * (factor * tangent(asked_deg)).atan().to_degrees();
            let drawn_deg = rounded(drawn, |a, b| reach * (tangent(a) / tangent(b) - 1.0).abs());
            let across = tangent(asked_deg) * height / width;
            let across = width != height && (tangent(drawn_deg) / across - 1.0).abs() <= ACROSS_SHARE;
            (Projection::Perspective { fov_deg: drawn_deg }, Fault::FieldOfView { drawn_deg, asked_deg, across })
        }
        Projection::Orthographic { height: asked } => {
            let drawn = rounded(factor * asked, |a, b| reach * (a / b - 1.0).abs());
            (Projection::Orthographic { height: drawn }, Fault::Height { drawn, asked })
        }
    };
    let camera = Camera::look_at(view.camera.eye(), view.camera.target(), view.camera.above(), projection)
        .and_then(|camera| camera.with_near(view.camera.near()))
        .and_then(|camera| camera.with_lens_shift(view.camera.lens_shift()))
        .ok()?;
    Some(seen_by(view, fault, camera))
}

/// The same hits, as another camera is said to see them.
fn seen_by(view: &View, fault: Fault, camera: Camera) -> Hypothesis {
    let meta = view.buffer.meta().clone();
    let text = Meta::new("", "", view.model, &camera).camera;
    Hypothesis { fault, undone: view.buffer.clone().with_meta(Meta { camera: text, ..meta }), camera }
}

/// The roundest number that is within [`ROUNDED_PX`], as `off_px` measures it; the number itself where none is.
fn rounded(x: f64, off_px: impl Fn(f64, f64) -> f64) -> f64 {
    // Divided by a whole number, so that 0.1 is written as that.
    let steps = ROUND_PARTS.map(|parts| (x * parts).round() / parts);
    steps.into_iter().find(|&round| off_px(round, x) <= ROUNDED_PX).unwrap_or(x)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

//! A trim edge at 20 times the size: by the masks that were made for the whole picture, exactly, and by samples.

use anyhow::Result;
use gbuffer::Picture;
use glam::{DVec2, DVec3};
use isophote::compare::Shade;
use isophote::stage::{Plan, Stage};
use pipeline::PackedScene;
use pipeline::mask::{MaskOptions, MaskPlan, Masks};
use scene::{Camera, FaceId, Model, Projection, SamplePattern, Viewport};

/// Side of the pictures of Fig. 17, pixels.
pub const SIDE: usize = 256;

/// How much larger the edge is shown.
const ZOOM: f64 = 20.0;

/// Side of the window on it, pixels of that size.
const WINDOW: usize = 160;

/// Each of these pixels is shown by as many along either side, so that steps and greys can be told.
const ENLARGED: usize = 3;

/// The hole of the plate that is shown, about in its middle.
const HOLE: usize = 45;

/// What the three pictures are.
pub(super) const SHOWS: &str = "a hole of the plate at 20 times the size: masks as fine as the whole picture asks for, exact, exact with 16 samples";

/// The pictures side by side.
///
/// # Errors
/// Where the masks do not fit, or the model has no such hole.
pub(super) fn pictures() -> Result<Picture> {
    let model = models::builtin("plate").expect("it is built in");
    let picture = Viewport::new(SIDE, SIDE)?;
    let whole = Camera::framing(&model, picture);
    let viewport = Viewport::new(WINDOW, WINDOW)?;
    let zoomed = zoomed(&whole, viewport, middle(&model))?;
    let exact = Stage::new(&model, zoomed, viewport, Plan::default())?;
    let options = MaskOptions::default();
    let masks = Masks::new(MaskPlan::new(&model, &whole, picture, &options)?, options.fill);
    let masked = PackedScene::masked(&model, exact.plan.scheme, masks)?;
    let masked = Stage { scene: masked.into(), ..Stage::new(&model, zoomed, viewport, Plan::default())? };
    let shaded = |stage: &Stage, pattern: SamplePattern| -> Result<Picture> {
        let shaded = |sample: Stage| sample.raster().shaded(&Shade::Phong.shading(), &model, &sample.camera);
        let samples: Vec<Picture> = stage.samples(pattern).map(shaded).collect::<Result<_, _>>()?;
        enlarged(&Picture::average(&samples)?)
    };
    let [one, several] = [SamplePattern::One, SamplePattern::Sixteen];
    let pictures = [shaded(&masked, one)?, shaded(&exact, one)?, shaded(&exact, several)?];
    Ok(Picture::beside(&pictures.iter().collect::<Vec<_>>()))
}

/// The middle of the hole.
fn middle(model: &Model) -> DVec3 {
    let region = model.trimmed_region(FaceId(0)).expect("the plate is trimmed");
    let ends = region.pieces().iter().filter(|piece| piece.loop_index == HOLE).map(|piece| piece.curve.start());
    let (sum, count) = ends.fold((DVec2::ZERO, 0.0), |(sum, count), end| (sum + end, count + 1.0));
    let uv = sum / count;
    model.surface(FaceId(0)).point(uv.x, uv.y)
}

/// The same eye and the same rays as of `whole`, through a window about `point` on whose pixels twenty times as many fit
/// along a side.
fn zoomed(whole: &Camera, viewport: Viewport, point: DVec3) -> Result<Camera> {
    let fov_deg = 2.0 * (whole.half_height() / ZOOM * WINDOW as f64 / SIDE as f64).atan().to_degrees();
    let camera = Camera::look_at(
        whole.eye(),
        whole.eye() + whole.forward(),
        whole.above(),
        Projection::Perspective { fov_deg },
    )?;
    let seen = camera.picture(viewport, point).expect("it is framed");
    let center = DVec2::new(viewport.width() as f64, viewport.height() as f64) / 2.0;
    let off = (seen - center) / viewport.height() as f64;
    Ok(camera.with_lens_shift(DVec2::new(off.x, -off.y))?)
}

/// Each pixel as a square of [`ENLARGED`] a side.
fn enlarged(picture: &Picture) -> Result<Picture> {
    let [width, height] = [picture.width(), picture.height()].map(|side| side * ENLARGED);
    let pixel = |k: usize| picture.pixel(k % width / ENLARGED, k / width / ENLARGED);
    Ok(Picture::new(width, height, (0..width * height).map(pixel).collect())?)
}

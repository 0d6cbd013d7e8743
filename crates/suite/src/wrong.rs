//! Pictures that are wrong in ways that a person would see, made of one that is right: what a judge must not let pass.

use crate::stage::Stage;
use anyhow::Result;
use compare::Verdict;
use gbuffer::{GBuffer, Hit};
use raycast::Caster;
use scene::{Camera, FaceId};
use serde::{Deserialize, Serialize};

/// How far pictures are shifted, pixels.
const SHIFTS: [(usize, &str); 3] =
    [(1, "shifted by 1 pixel"), (3, "shifted by 3 pixels"), (10, "shifted by 10 pixels")];

/// How far another camera stands beside, as a share of the model's diagonal.
const BESIDE: f64 = 0.05;

/// From how many pixels apart on a person would see that another place is shown.
const SEEN_PX: f64 = 0.75;

/// From what difference of two unit normals on a person would see that the shading is another: less than half a degree.
const SEEN_NORMAL: f64 = 1.0 / 128.0;

/// From what share of the model's diagonal on a point counts as another layer.
const SEEN_DEPTH: f64 = 1e-3;

/// A picture that is wrong in one way.
pub struct Wrong {
    /// In which.
    pub name: &'static str,
    /// The picture.
    pub buffer: GBuffer,
    /// Pixels in which a person would see it.
    pub pixels: usize,
}

/// What was made of pictures that are wrong.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vacuity {
    /// How many were made.
    pub made: usize,
    /// How many of them differ, as they should.
    pub caught: usize,
    /// The names of those that do not, and in how many pixels a person would see it.
    pub missed: Vec<String>,
    /// Pixels of all of them in which a person would see it.
    pub pixels: usize,
    /// Pixels of all of them that differ.
    pub differing: usize,
}

impl Vacuity {
    /// Judges what is made of `drawn`, a right picture of the stage.
    ///
    /// # Errors
    /// Where a picture cannot be drawn or compared.
    pub fn of(stage: &Stage, caster: &Caster, raycast: &GBuffer, drawn: &GBuffer) -> Result<Self> {
        let mut found = Self::default();
        for Wrong { name, buffer, pixels } in wrong(stage, drawn)? {
            let pair = stage.against_raycast(caster, raycast, &buffer)?;
            found.made += 1;
            found.pixels += pixels;
            found.differing += pair.differing();
            if pair.verdict == Verdict::Differ {
                found.caught += 1;
            } else {
                found.missed.push(format!("{name} ({pixels} pixels)"));
            }
        }
        Ok(found)
    }
}

/// Pictures that are wrong, each in at least one pixel that shows something else; `drawn` is a right one of the stage.
///
/// # Errors
/// Where the model cannot be drawn from beside.
pub fn wrong(stage: &Stage, drawn: &GBuffer) -> Result<Vec<Wrong>> {
    let at = |x: usize, y: usize| drawn.get(x, y).copied();
    let (width, faces) = (stage.viewport.width(), stage.model.faces().len() as u32);
    let size = stage.model.hull().diagonal();
    let mut made = vec![];
    for (shift, name) in SHIFTS {
        made.push((name, changed(stage, |x, y| at(x.checked_sub(shift)?, y))));
    }
    let rasterizer = stage.rasterizer(raster::Options { curvature: true, vertex_normals: false });
    let sampler = rasterizer.sampler();
    let layers = |x: usize, y: usize| sampler.layers(x as f64 + 0.5, y as f64 + 0.5);
    let far: Vec<Option<Hit>> = (0..stage.viewport.pixels()).map(|i| layers(i % width, i / width).pop()).collect();
    let deeper = |x: usize, y: usize| {
        let far = far.get(y * width + x).copied().flatten();
        far.filter(|far| at(x, y).is_some_and(|near| near.t + SEEN_DEPTH * size <= far.t))
    };
    // Beside a silhouette, where the two layers meet, either of them is right.
    let amid = |x: usize, y: usize| {
        (0..3)
            .all(|i| (0..3).all(|j| x + i > 0 && y + j > 0 && x + i <= width && deeper(x + i - 1, y + j - 1).is_some()))
    };
    made.push(("the farthest surface", changed(stage, |x, y| deeper(x, y).filter(|_| amid(x, y)).or(at(x, y)))));
    made.push(("every second pixel dropped", changed(stage, |x, y| at(x, y).filter(|_| (x + y) % 2 == 0))));
    let neighbour = |hit: Hit| Hit { face: FaceId((hit.face.0 + 1) % faces), ..hit };
    made.push(("a neighbour's face", changed(stage, |x, y| at(x, y).map(neighbour))));
    let normal = |x: usize, y: usize| at((x + 1).min(width - 1), y).map(|hit| (hit.normal, hit.curvature));
    let turned = |x: usize, y: usize, hit: Hit| {
        let (normal, curvature) = normal(x, y).unwrap_or((hit.normal, hit.curvature));
        Hit { normal, curvature, ..hit }
    };
    made.push(("normals of the next pixel", changed(stage, |x, y| at(x, y).map(|hit| turned(x, y, hit)))));
    let beside = Stage::new(stage.model, beside(stage)?, stage.viewport, stage.plan)?.raster();
    made.push(("another camera", changed(stage, |x, y| beside.get(x, y).copied())));
    let count = |buffer: &GBuffer| {
        drawn
            .pixels()
            .zip(buffer.pixels())
            .filter(|(a, b)| is_seen(stage, a.as_ref().copied(), b.as_ref().copied()))
            .count()
    };
    let seen = made.into_iter().map(|(name, buffer)| Wrong { name, pixels: count(&buffer), buffer });
    Ok(seen.filter(|wrong| wrong.pixels > 0).collect())
}

/// The stage's camera moved to the right.
fn beside(stage: &Stage) -> Result<Camera> {
    let Stage { camera, model, .. } = stage;
    let eye = camera.eye() + camera.right() * BESIDE * model.hull().diagonal();
    let moved = Camera::look_at(eye, eye + camera.forward(), camera.above(), camera.projection())?;
    Ok(moved.with_near(camera.near())?.with_lens_shift(camera.lens_shift())?)
}

/// A picture of what `pixel` makes of each place, with the distances that belong to it: they are not what is wrong.
fn changed(stage: &Stage, pixel: impl Fn(usize, usize) -> Option<Hit>) -> GBuffer {
    let placed = |x: usize, y: usize| {
        let ray = stage.camera.ray(stage.viewport, x as f64 + 0.5, y as f64 + 0.5);
        pixel(x, y).map(|hit| Hit { t: (hit.position - ray.origin).dot(ray.direction), ..hit })
    };
    let (width, height) = (stage.viewport.width(), stage.viewport.height());
    let rows = (0..height).map(|y| (0..width).map(|x| placed(x, y)).collect());
    GBuffer::from_rows(stage.viewport, stage.meta("raster"), rows)
}

/// Whether a person would see one in place of the other.
fn is_seen(stage: &Stage, right: Option<&Hit>, wrong: Option<&Hit>) -> bool {
    let (Some(a), Some(b)) = (right, wrong) else { return right.is_some() != wrong.is_some() };
    let picture = |hit: &Hit| stage.camera.picture(stage.viewport, hit.position);
    let moved = match (picture(a), picture(b)) {
        (Some(a), Some(b)) => a.distance(b) >= SEEN_PX,
        _ => true,
    };
    let turned = match (a.normal.unit(), b.normal.unit()) {
        (Some(a), Some(b)) => a.distance(b) >= SEEN_NORMAL,
        (a, b) => a.is_some() != b.is_some(),
    };
    let deeper = (a.t - b.t).abs() >= SEEN_DEPTH * stage.model.hull().diagonal();
    a.face != b.face || moved || turned || deeper
}

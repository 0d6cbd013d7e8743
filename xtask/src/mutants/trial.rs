//! The trial of a program on the scenes: drawn by the GPU, judged as any other rendering.

use super::capped::capped;
use super::shown::Shown;
use anyhow::{Result, bail};
use compare::{Claims, Verdict};
use gbuffer::{GBuffer, Hit};
use isophote::stage::{Path, Plan, Stage};
use pipeline::Parameters;
use pipeline::fragment::{Fragment, fragment};
use pipeline::wgsl::{self, Variant};
use raycast::Caster;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::cell::Cell;

/// How a mutant was caught.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Catch {
    /// On which scene.
    pub scene: String,
    /// The main cause that the comparison named, or what else gave it away.
    pub cause: String,
    /// The worst pixel in words.
    pub detail: String,
}

/// What a program did on one scene.
pub enum Shot {
    /// The scene's programs do not hold the change.
    Untouched,
    /// All that was drawn agrees.
    Agrees,
    /// Something differs.
    Caught(Catch),
}

/// A scene with the reference that it is judged by.
pub struct Trial<'s> {
    shown: &'s Shown,
    stage: Stage<'s>,
    caster: Caster<'s>,
    reference: GBuffer,
    /// How often technique `exact`, unchanged, evaluates the surface for each pixel on this device.
    evaluations: Vec<u32>,
    /// For how many pixels it has no answer then.
    undecided: usize,
    /// What the CPU rasterizer shows, where kernels promise the same faces and spans: where no trims decide, and triangles
    /// have spans of their own.
    rasterized: Option<GBuffer>,
}

impl<'s> Trial<'s> {
    /// Renders the reference.
    ///
    /// # Errors
    /// Where the scene cannot be drawn, or the device fails.
    pub fn new(device: &gpu::Device, shown: &'s Shown) -> Result<Self> {
        // Equal cells keep to no chord error, and none is asked for.
        let chord_px = if shown.cells.is_some() { ANY_CHORD_PX } else { shown.plan.chord_px };
        let mut stage = Stage::new(&shown.model, shown.camera, shown.viewport, Plan { chord_px, ..shown.plan })?;
        if let Some(cells) = shown.cells
            && let Some(uniform) = shown.plan.technique.uniform(&shown.model, &stage.scene, cells)?
        {
            stage.prepared = uniform;
        }
        let caster = Caster::new(&shown.model).with_edges(shown.plan.edges);
        let reference = if shown.vertex_normals {
            let options = raster::Options { curvature: false, vertex_normals: true };
            let buffer = stage.rasterizer(options).render(stage.meta("raster"), &|_| {});
            // The GPU's program computes none either, and must say so.
            let plain = |hit: Option<&Hit>| hit.map(|hit| Hit { curvature: None, ..*hit });
            let hits: Vec<Option<Hit>> = buffer.pixels().map(plain).collect();
            let rows = hits.chunks(shown.viewport.width()).map(<[_]>::to_vec);
            GBuffer::from_rows(shown.viewport, stage.meta("raster"), rows)
        } else {
            stage.raycast(&caster)
        };
        if shown.fills && reference.covered() < shown.viewport.pixels() {
            bail!("{}: the model does not fill the picture", shown.name);
        }
        let (evaluations, undecided) = match shown.plan.technique.claims() {
            Claims::Chord => (vec![], 0),
            Claims::OnRay => {
                let options = gpu::RendererOptions { curvature: true, ..Default::default() };
                let mut renderer = stage.renderer_of(device, options)?;
                let buffer = renderer.gbuffer(&stage.views, &stage.camera, shown.viewport, stage.meta("gpu"))?;
                (renderer.evaluations(&stage.views, shown.viewport)?, buffer.undecided())
            }
        };
        let are_kept = shown.cells.is_none() && !shown.model.is_trimmed();
        let rasterized = (shown.plan.path != Path::Fragment && are_kept).then(|| stage.raster());
        Ok(Self { shown, stage, caster, reference, evaluations, undecided, rasterized })
    }

    /// Draws with the programs that `source` makes, their loops capped, and judges them. A GPU that refuses or fails is a
    /// catch too; the device should not be used again then.
    ///
    /// # Errors
    /// Where the answer cannot be judged.
    pub fn run(&self, device: &gpu::Device, source: &dyn Fn(Variant) -> String) -> Result<Shot> {
        let touched = Cell::new(false);
        let watched = |variant: Variant| {
            let text = source(variant);
            touched.set(touched.get() || text != wgsl::source(variant));
            capped(&text)
        };
        let overrides = gpu::Overrides { source: Some(&watched), ..Default::default() };
        let caught = self.judged(device, overrides)?;
        Ok(match caught {
            Some(caught) => Shot::Caught(caught),
            None if touched.get() => Shot::Agrees,
            None => Shot::Untouched,
        })
    }

    /// The picture's G-buffer first, and only then, with a program of its own, what the fragment stage shades.
    fn judged(&self, device: &gpu::Device, overrides: gpu::Overrides) -> Result<Option<Catch>> {
        let Stage { views, camera, viewport, .. } = &self.stage;
        let shading = self.shown.shading();
        let uniform = shading.uniform(camera, self.shown.model.hull().diagonal());
        let vertex_normals = self.shown.vertex_normals;
        let options = gpu::RendererOptions { curvature: !vertex_normals, vertex_normals, overrides };
        let refused = |error: gpu::GpuError| Ok(Some(self.caught(REFUSED, error.to_string())));
        let mut renderer = match self.stage.renderer_of(device, options) {
            Ok(renderer) => renderer,
            Err(error) => return refused(error),
        };
        let gbuffer = if self.shown.vertex_normals {
            Cow::Borrowed(&self.reference)
        } else {
            let gbuffer = match renderer.gbuffer(views, camera, *viewport, self.stage.meta("gpu")) {
                Ok(gbuffer) => gbuffer,
                Err(error) => return refused(error),
            };
            let fragments = match renderer.fragments(views, *viewport) {
                Ok(fragments) => fragments,
                Err(error) => return refused(error),
            };
            if let Some(detail) = self.wrong_record(&fragments) {
                return Ok(Some(self.caught("record", detail)));
            }
            if let Some(detail) = self.wrong_face(&gbuffer) {
                return Ok(Some(self.caught("visibility", detail)));
            }
            let pair = self.stage.against_raycast(&self.caster, &self.reference, &gbuffer)?;
            // Of some scenes, so near a pole, no pixel has a verdict on where it is; values are judged all the same.
            if pair.verdict == Verdict::Differ {
                let cause = pair.main_cause().map_or("none", |cause| cause.label());
                let worst = pair.worst.first().map_or(String::new(), |p| format!("({}, {}): {}", p.x, p.y, p.detail));
                return Ok(Some(self.caught(cause, worst)));
            }
            // Beside a border either answer is right for each of two faces, but one of them must show.
            if self.shown.fills && gbuffer.covered() < self.shown.viewport.pixels() {
                let cracks = self.shown.viewport.pixels() - gbuffer.covered();
                return Ok(Some(self.caught("crack", format!("{cracks} pixels show nothing"))));
            }
            if self.shown.plan.technique.claims() == Claims::OnRay {
                let (is, expected) = (gbuffer.undecided(), self.undecided);
                if EFFORT_PIXELS < is.abs_diff(expected) {
                    return Ok(Some(self.caught("undecided", format!("{is} pixels are undecided, not {expected}"))));
                }
                let found = match renderer.evaluations(views, *viewport) {
                    Ok(found) => found,
                    Err(error) => return refused(error),
                };
                if let Some(detail) = self.wrong_effort(&found) {
                    return Ok(Some(self.caught("effort", detail)));
                }
            }
            Cow::Owned(gbuffer)
        };
        let picture = match renderer.shaded(views, &uniform, *viewport) {
            Ok(picture) => picture,
            Err(error) => return refused(error),
        };
        let judged = self.stage.judge_shading(&shading, &gbuffer, &picture)?;
        let detail = format!("{} of {} pixels, first {:?}", judged.differ, judged.covered, judged.first);
        Ok((judged.verdict != Verdict::Agree).then(|| self.caught("shading", detail)))
    }

    /// What no hit shows: parameters outside the domain, and spans, status and speeds unlike those of the program in Rust
    /// at the same parameters.
    fn wrong_record(&self, fragments: &[Option<Fragment>]) -> Option<String> {
        let scene = &self.stage.scene;
        let is_inside = |f: &Fragment| {
            let face = scene.faces()[f.face as usize];
            f.uv.iter().all(|t| (0.0..=1.0).contains(t)) && f.span[0] < face.spans_u && f.span[1] < face.spans_v
        };
        let drawn = || fragments.iter().flatten().filter(|f| is_inside(f));
        let place = |f: &Fragment| Parameters { span: f.span, uv: f.uv };
        let expected: Vec<Fragment> = drawn().map(|f| fragment(scene, f.face, place(f), false)).collect();
        let fastest = expected.iter().flat_map(|f| f.speed).fold(0.0, f32::max);
        let is_near = |a: f32, b: f32| (a - b).abs() <= SPEED_SHARE * fastest;
        let outside = fragments.iter().flatten().find(|f| !is_inside(f));
        let outside = outside.map(|f| format!("(u, v) = {:?} on spans {:?} is outside the domain", f.uv, f.span));
        outside.or_else(|| {
            let (f, e) = drawn().zip(&expected).find(|(f, e)| {
                let speeds = is_near(f.speed[0], e.speed[0]) && is_near(f.speed[1], e.speed[1]);
                f.span != e.span || f.status != e.status || !speeds
            })?;
            let words = |f: &Fragment| format!("span {:?}, {:?}, speeds {:?}", f.span, f.status, f.speed);
            Some(format!("at (u, v) = {:?}: {}, not {}", f.uv, words(f), words(e)))
        })
    }

    /// The first pixel that shows another face or span than on the CPU, or that one of both shows alone.
    fn wrong_face(&self, gbuffer: &GBuffer) -> Option<String> {
        let place = |hit: Option<&Hit>| hit.map(|hit| (hit.face, hit.local.map(|local| local.span)));
        let expected = self.rasterized.as_ref()?.pixels().map(place);
        let (pixel, (is, expected)) =
            gbuffer.pixels().map(place).zip(expected).enumerate().find(|(_, (is, expected))| is != expected)?;
        let (x, y) = (pixel % self.shown.viewport.width(), pixel / self.shown.viewport.width());
        Some(format!("({x}, {y}) shows {is:?}, not {expected:?}"))
    }

    /// Pixels for which the search takes another path than unchanged: it ends at the same place, or the
    /// comparison would have said so, but evaluates the surface another number of times.
    fn wrong_effort(&self, found: &[u32]) -> Option<String> {
        let is_off = |k: &usize| self.evaluations[*k] != found[*k];
        let off = (0..found.len()).filter(is_off).count();
        let searched = self.evaluations.iter().filter(|&&count| count > 0).count();
        let first = (0..found.len()).find(is_off).filter(|_| off > EFFORT_PIXELS + searched / EFFORT_SHARE)?;
        let (x, y) = (first % self.shown.viewport.width(), first / self.shown.viewport.width());
        let (is, expected) = (found[first], self.evaluations[first]);
        Some(format!("{off} of {searched} pixels searched otherwise, ({x}, {y}) in {is} evaluations, not {expected}"))
    }

    fn caught(&self, cause: &str, detail: String) -> Catch {
        Catch { scene: self.shown.name.to_owned(), cause: cause.to_owned(), detail }
    }
}

/// In one pixel of so many, and in [`EFFORT_PIXELS`] of any picture, the search may take another path because another program
/// is compiled to other roundings: where a step just keeps its promise, or a ray grazes a hull's edge.
const EFFORT_SHARE: usize = 256;

/// More than any triangle is off, pixels.
const ANY_CHORD_PX: f64 = 1e6;

/// See [`EFFORT_SHARE`].
const EFFORT_PIXELS: usize = 4;

/// A speed may be off by this share of the greatest in the picture: far more than f32's rounding, far less than any
/// mistake in computing it.
const SPEED_SHARE: f32 = 1.0 / 1024.0;

/// The cause where the GPU returns an error in place of a picture.
pub const REFUSED: &str = "refused";

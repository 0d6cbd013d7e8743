//! The judge of a model's renderings: who may be compared, and how.

use crate::difference::Difference;
use crate::pair::{Finding, Pair};
use crate::setting::Setting;
use crate::tally::Tally;
use crate::{CompareError, Deviation, PairReport, PixelVerdict, Sampler, Shares, UNBOUNDED_SHARE};
use gbuffer::GBuffer;
use pipeline::PackedScene;
use rayon::prelude::*;
use scene::{Camera, Model, Viewport};

/// Judges renderings of one model by one camera.
pub struct Judge<'m> {
    setting: Setting<'m>,
    /// Of the model that candidates draw in place of it.
    drawn: Option<Setting<'m>>,
    unbounded_share: f64,
}

impl<'m> Judge<'m> {
    /// A judge of `model` as `camera` sees it; `scene` is the model as the candidates' programs read it.
    pub fn new(model: &'m Model, camera: &'m Camera, viewport: Viewport, scene: &'m PackedScene) -> Self {
        let setting = Setting::new(model, camera, viewport, scene);
        Self { setting, drawn: None, unbounded_share: UNBOUNDED_SHARE }
    }

    /// The same judge of candidates that draw `model` in the place of its own, as `scene` has it. [`Deviation::of_stand_in`] says
    /// how far it is from that.
    pub fn of_drawn(self, model: &'m Model, scene: &'m PackedScene) -> Self {
        let drawn = Some(Setting::new(model, self.setting.camera, self.setting.viewport, scene));
        Self { drawn, ..self }
    }

    /// The same judge for a scene in which another share of the covered pixels may have no verdict for want of a bound.
    pub fn with_unbounded_share(self, unbounded_share: f64) -> Self {
        Self { unbounded_share, ..self }
    }

    /// Compares a candidate with a reference that `sampler` can ask at any position of the picture.
    ///
    /// For each pixel, in this order; the first that fails gives the cause:
    /// 1. *evaluation*: position, normal and curvatures lie in their [`Enclosure`](pipeline::enclosure::Enclosure) at
    ///    the candidate's own (u, v), where f32 leaves the span or the status of the normal open in one of them; and
    ///    the packed face that it encloses is, up to narrowing, the model's;
    ///    of a candidate that shows what its triangles carry ([`Deviation::vertex_normals`]), the position is within the chord of
    ///    S, and the normal in a cone that holds all normals of the cell; where another model was drawn in place of this one
    ///    ([`Self::of_drawn`]), all that is asked of that one, and of this one that the position is as near as it says;
    /// 2. *trim*: where the pixel's ray meets a face that loops bound, close to the candidate's (u, v), it is material, in
    ///    f64, or an edge passes within the band of f32's own classification
    ///    ([`PackedFrame::edge_band`](pipeline::PackedFrame::edge_band)) or [`Deviation::edge_px`] of the pixel's centre,
    ///    and what one step of Newton's method from (u, v) leaves of the way to that ray;
    /// 3. *geometry*: S(u, v) projects to within the bound (chord and interpolation of its Bézier piece, seen there) of what the reference shows there:
    ///    of the pixel's centre, for a ray caster;
    /// 4. *visibility*: nothing that the reference sees within the bound of the centre hides that point by more than
    ///    the bound, everywhere;
    /// 5. *coverage*: a pixel that only the reference covers has an edge within the bound: a position where the
    ///    reference sees nothing, or a border of the face. Where loops bound the face, the border must be within
    ///    [`Deviation::edge_px`], and a position where nothing is seen counts only beyond a fold;
    /// 6. *trim edges*, where the candidate was asked for them: there is one at the place that it records, none is nearer,
    ///    and none is within reach where it records none, to within what f32 and the linear map at its own (u, v) may be
    ///    off. A failure is `Trim`;
    /// 7. *distance*: the stated distance is that of S(u, v) along the pixel's ray, up to the rounding of S and of a
    ///    depth in f32. The tests before take that distance from S(u, v) itself.
    ///
    /// A pixel has no verdict, and counts as unbounded, where a value has no bound in f32, where f64 cannot hold (u, v), or
    /// where all that it is allowed (chord, interpolation, snapping, and rounding of S, seen there) comes to
    /// [`Deviation::limit_px`].
    ///
    /// A pixel that differs is `Undecided` where a ray caster as the reference says that it could not decide it, and else
    /// `NewtonNotConverged` where the candidate says that it did not converge, which [`Deviation::unanswered_share`] of the
    /// covered pixels may. For a candidate of technique `exact` a
    /// failure of 4 or 5 (a nearer surface is not shown) is a `MissedRoot`, for others `Depth` or `Coverage`; where that
    /// surface is a trimmed face's, it is `Trim`.
    ///
    /// `exact` says that the reference is a ray caster. `progress` is told of every row done.
    ///
    /// # Errors
    /// [`CompareError`] where the two cannot be compared.
    pub fn pair(
        &self,
        reference: &GBuffer,
        sampler: &dyn Sampler,
        candidate: &GBuffer,
        deviation: &Deviation,
        exact: bool,
        progress: &(dyn Fn(usize) + Sync),
    ) -> Result<PairReport, CompareError> {
        self.check(reference, candidate)?;
        let setting = &self.setting;
        let drawn = self.drawn.as_ref();
        let pair = Pair { setting, drawn, reference, candidate, sampler, deviation, exact };
        let rows: Vec<Tally> = (0..setting.viewport.height())
            .into_par_iter()
            .map(|y| {
                let mut tally = Tally::new(&pair, self.unbounded_share);
                (0..setting.viewport.width()).for_each(|x| tally.add(x, y, &pair));
                progress(1);
                tally
            })
            .collect();
        let total = rows.into_iter().reduce(Tally::merged).expect("a viewport has rows");
        Ok(total.finished())
    }

    /// What [`Judge::pair`] says of the pixel at column and row `at` of the same buffers.
    ///
    /// # Errors
    /// As of [`Judge::pair`].
    ///
    /// # Panics
    /// Outside the viewport.
    pub fn pixel(
        &self,
        reference: &GBuffer,
        sampler: &dyn Sampler,
        candidate: &GBuffer,
        deviation: &Deviation,
        exact: bool,
        at: [usize; 2],
    ) -> Result<PixelVerdict, CompareError> {
        self.check(reference, candidate)?;
        let setting = &self.setting;
        let drawn = self.drawn.as_ref();
        let pair = Pair { setting, drawn, reference, candidate, sampler, deviation, exact };
        let evaluated =
            || candidate.get(at[0], at[1]).and_then(|hit| pair.evaluated(Pair::center(at[0], at[1]), hit).ok());
        let shares = || evaluated().map_or(Shares::default(), |evaluated| evaluated.shares);
        let verdict = |cause, unbounded, detail, shares| PixelVerdict { cause, detail, unbounded, shares };
        Ok(match pair.pixel(at[0], at[1]) {
            Finding::Uncovered => verdict(None, None, "neither covers it".to_owned(), Shares::default()),
            Finding::Agrees(found) => {
                let across = format!("{:.6} px across the ray (bound {:.6})", found.across_px, found.bound_px);
                verdict(None, None, across, found.shares)
            }
            Finding::Unbounded(reason, detail) => verdict(None, Some(reason), detail, shares()),
            Finding::Differs(Difference { cause, detail, .. }) => verdict(Some(cause), None, detail, shares()),
        })
    }

    fn check(&self, reference: &GBuffer, candidate: &GBuffer) -> Result<(), CompareError> {
        let size = |v: Viewport| [v.width(), v.height()];
        let (r, c) = (reference.meta(), candidate.meta());
        if r.renderer == c.renderer {
            return Err(CompareError::SameRenderer { name: r.renderer.clone() });
        }
        if reference.viewport() != self.setting.viewport || candidate.viewport() != self.setting.viewport {
            return Err(CompareError::Size {
                reference: size(reference.viewport()),
                candidate: size(candidate.viewport()),
                expected: size(self.setting.viewport),
            });
        }
        let expected = gbuffer::Meta::new("", "", self.setting.model, self.setting.camera);
        for buffer in [reference, candidate] {
            let meta = buffer.meta();
            let other = |what| Err(CompareError::OtherScene { what, renderer: meta.renderer.clone() });
            let is_drawn = |drawn: &Setting| std::ptr::eq(buffer, candidate) && meta.model_hash == drawn.model.hash();
            if meta.model_hash != expected.model_hash && !self.drawn.as_ref().is_some_and(is_drawn) {
                return other("model");
            }
            if meta.camera != expected.camera {
                return other("camera");
            }
            let count = self.setting.model.faces().len();
            if let Some(hit) = buffer.pixels().flatten().find(|hit| hit.face.0 as usize >= count) {
                return Err(CompareError::NoSuchFace { renderer: meta.renderer.clone(), face: hit.face.0, count });
            }
        }
        Ok(())
    }
}

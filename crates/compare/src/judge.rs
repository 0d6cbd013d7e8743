//! The judge of a model's renderings: who may be compared, and how.

use crate::attribution::Attribution;
use crate::pair::{Finding, Pair};
use crate::tally::Tally;
use crate::trim::{self, Place};
use crate::{Cause, CompareError, Deviation, PairReport, PixelVerdict, Sampler, Shares, UNBOUNDED_SHARE, Unbounded};
use gbuffer::{GBuffer, Hit, LocalParameters};
use glam::{DVec2, DVec3};
use nurbs::{Direction, Surface};
use pipeline::sight::REACH_PX;
use pipeline::{PackedScene, View};
use rayon::prelude::*;
use scene::{Camera, FaceId, Model, Viewport};

/// How far along a surface it is followed from where a candidate shows it, pixels were it seen at a right angle.
const FOLLOWED_PX: f64 = 8.0;

/// Steps of that search at most: it converges quadratically, but close by a fold.
const FOLLOWING_STEPS: u32 = 24;

/// An offset from a picture position that counts as none, pixels.
const FOUND_PX: f64 = 1e-7;

/// Judges renderings of one model by one camera.
pub struct Judge<'m> {
    pub(crate) model: &'m Model,
    pub(crate) camera: &'m Camera,
    pub(crate) viewport: Viewport,
    /// Diagonal of the model's box.
    pub(crate) size: f64,
    pub(crate) scene: &'m PackedScene,
    pub(crate) views: Vec<View>,
    pub(crate) unbounded_share: f64,
    pub(crate) attribution: Attribution<'m>,
    /// Of each surface, the knot spans in u and v that are not empty.
    spans: Vec<[Vec<usize>; 2]>,
}

/// A difference: cause, how many times over, in words.
pub(crate) struct Difference {
    pub cause: Cause,
    pub excess: f64,
    pub detail: String,
}

impl Difference {
    pub fn new(cause: Cause, excess: f64, detail: String) -> Self {
        Self { cause, excess: if excess.is_nan() { f64::INFINITY } else { excess }, detail }
    }
}

impl<'m> Judge<'m> {
    /// A judge of `model` as `camera` sees it; `scene` is the model as the candidates' programs read it.
    pub fn new(model: &'m Model, camera: &'m Camera, viewport: Viewport, scene: &'m PackedScene) -> Self {
        let size = model.hull().diagonal();
        let attribution = Attribution::new(model);
        let views = scene.views(model, camera, viewport);
        let of_surface = |surface: &Surface| [Direction::U, Direction::V].map(|d| surface.knots(d).spans().collect());
        let spans = model.surfaces().iter().map(of_surface).collect();
        Self { model, camera, viewport, size, scene, views, unbounded_share: UNBOUNDED_SHARE, attribution, spans }
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
        let pair = Pair { judge: self, reference, candidate, sampler, deviation, exact };
        let rows: Vec<Tally> = (0..self.viewport.height())
            .into_par_iter()
            .map(|y| {
                let mut tally = Tally::new(&pair);
                (0..self.viewport.width()).for_each(|x| tally.add(x, y, &pair));
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
        let pair = Pair { judge: self, reference, candidate, sampler, deviation, exact };
        let evaluated = || candidate.get(at[0], at[1]).and_then(|hit| self.evaluation(hit).ok());
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
        if reference.viewport() != self.viewport || candidate.viewport() != self.viewport {
            return Err(CompareError::Size {
                reference: size(reference.viewport()),
                candidate: size(candidate.viewport()),
                expected: size(self.viewport),
            });
        }
        let expected = gbuffer::Meta::new("", "", self.model, self.camera);
        for buffer in [reference, candidate] {
            let meta = buffer.meta();
            let other = |what| Err(CompareError::OtherScene { what, renderer: meta.renderer.clone() });
            if meta.model_hash != expected.model_hash {
                return other("model");
            }
            if meta.camera != expected.camera {
                return other("camera");
            }
            let count = self.model.faces().len();
            if let Some(hit) = buffer.pixels().flatten().find(|hit| hit.face.0 as usize >= count) {
                return Err(CompareError::NoSuchFace { renderer: meta.renderer.clone(), face: hit.face.0, count });
            }
        }
        Ok(())
    }

    /// Whether an edge passes as near the pixel's centre as a renderer may mistake sides, where it shows a face: `edge_px`,
    /// and what one step of Newton's method leaves of the way to the pixel's ray.
    ///
    /// # Errors
    /// Where loops bound the face and it has no material there, nor so near.
    pub(crate) fn trimming(&self, hit: &Hit, center: DVec2, edge_px: f64) -> Result<bool, Difference> {
        let Some((place, uv)) = self.trim_place(hit, center) else { return Ok(false) };
        if place == Place::Material {
            return Ok(false);
        }
        let radius = edge_px + self.step_leaves_px(hit.face, hit.uv, center);
        if place == Place::Edge || self.edge_passes(hit.face, center, radius) {
            return Ok(true);
        }
        let detail = format!("face {} has no material at (u, v) = {uv}, nor within {radius:.4} px", hit.face.0);
        Err(Difference::new(Cause::Trim, f64::INFINITY, detail))
    }

    /// Whether an edge of a bounded face passes as near a position where it is seen as a renderer may mistake sides that
    /// started within `bound_px` of it.
    pub(crate) fn is_at_edge(&self, hit: &Hit, center: DVec2, edge_px: f64, bound_px: f64) -> bool {
        let Some((place, uv)) = self.trim_place(hit, center) else { return false };
        let starts = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y].map(|direction| {
            let d = self.model.surface(hit.face).first_derivatives(uv.x, uv.y);
            uv + self.parameters_of(d.s, [d.su, d.sv], bound_px * direction)
        });
        let leaves = |start: DVec2| self.step_leaves_px(hit.face, start, center);
        place == Place::Edge
            || self.edge_passes(hit.face, center, edge_px + starts.into_iter().map(leaves).fold(0.0, f64::max))
    }

    /// How far from position `at` the point is seen where the fragment program decides about a pixel there, when
    /// its parameters are `uv`: one step from them, or, where that is too long, at them.
    fn step_leaves_px(&self, face: FaceId, uv: DVec2, at: DVec2) -> f64 {
        let surface = self.model.surface(face);
        let [[u0, u1], [v0, v1]] = surface.domain();
        let inside = |uv: DVec2| uv.clamp(DVec2::new(u0, v0), DVec2::new(u1, v1));
        let uv = inside(uv);
        let d = surface.first_derivatives(uv.x, uv.y);
        let Some(seen) = self.picture(d.s) else { return f64::INFINITY };
        let step = self.parameters_of(d.s, [d.su, d.sv], at - seen);
        let pixels = self.camera.pixels_per_unit(self.viewport, self.camera.depth(d.s));
        let far = (d.su.length() * step.x.abs()).max(d.sv.length() * step.y.abs()) * pixels;
        let end = if far <= f64::from(REACH_PX) { inside(uv + step) } else { uv };
        self.picture(surface.point(end.x, end.y)).map_or(f64::INFINITY, |p| p.distance(at))
    }

    /// Whether the surface that a hit shows is seen at another position, too, whether it has material there or not.
    pub(crate) fn goes_on_at(&self, hit: &Hit, at: DVec2) -> bool {
        let [[u0, u1], [v0, v1]] = self.model.surface(hit.face).domain();
        let is_inside = |uv: DVec2| (u0..=u1).contains(&uv.x) && (v0..=v1).contains(&uv.y);
        self.seen_at(hit, at).is_some_and(is_inside)
    }

    /// Positive where u turns counterclockwise into v as the picture shows them.
    fn turn(&self, s: DVec3, derivatives: [DVec3; 2]) -> f64 {
        let [a, b] = derivatives.map(|along| self.camera.picture_derivative(self.viewport, s, along));
        b.perp_dot(a)
    }

    /// What parameters gain on a tangent plane by an offset in the picture, pixels.
    fn parameters_of(&self, s: DVec3, derivatives: [DVec3; 2], offset: DVec2) -> DVec2 {
        let [a, b] = derivatives.map(|along| self.camera.picture_derivative(self.viewport, s, along));
        DVec2::new(offset.perp_dot(b), a.perp_dot(offset)) / a.perp_dot(b)
    }

    /// Where the surface of a bounded face is seen at a position close to a hit, and which parameters that are; close by a
    /// fold, where the ray may pass the surface by, the hit's own.
    fn trim_place(&self, hit: &Hit, center: DVec2) -> Option<(Place, DVec2)> {
        let region = self.model.region(hit.face)?;
        let band = self.scene.frames()[hit.face.0 as usize].edge_band * region.domain().size();
        let uv = self.seen_at(hit, center).unwrap_or(hit.uv);
        Some((trim::place(region, uv, band), uv))
    }

    /// Whether an edge of a bounded face is seen within `radius` pixels of a position.
    fn edge_passes(&self, face: FaceId, center: DVec2, radius: f64) -> bool {
        let surface = self.model.surface(face);
        let distance = |uv: DVec2| {
            let seen = self.picture(surface.point(uv.x, uv.y));
            seen.map_or(f64::INFINITY, |p| p.distance(center))
        };
        self.model.region(face).is_some_and(|region| trim::edge_passes(region, distance, radius))
    }

    /// The parameters, close to a hit's own, at which its surface, gone on with along its tangents beyond the domain, is
    /// seen at position `at`: by Newton's method. `None` where it is not, as beyond a fold.
    pub(crate) fn seen_at(&self, hit: &Hit, at: DVec2) -> Option<DVec2> {
        let surface = self.model.surface(hit.face);
        let [[u0, u1], [v0, v1]] = surface.domain();
        let from = self.surface_point(hit);
        let farthest = FOLLOWED_PX / self.camera.pixels_per_unit(self.viewport, self.camera.depth(from));
        let mut uv = hit.uv;
        for _ in 0..FOLLOWING_STEPS {
            let border = uv.clamp(DVec2::new(u0, v0), DVec2::new(u1, v1));
            let d = surface.first_derivatives(border.x, border.y);
            let s = d.s + d.su * (uv.x - border.x) + d.sv * (uv.y - border.y);
            let offset = at - self.picture(s).filter(|_| s.distance(from) <= farthest)?;
            if offset.length() <= FOUND_PX {
                let way = (d.su * (uv.x - border.x)).abs() + (d.sv * (uv.y - border.y)).abs();
                // Beyond a fold the other side of the surface is seen.
                let own = surface.first_derivatives(hit.uv.x, hit.uv.y);
                let is_same_side = self.turn(d.s, [d.su, d.sv]) * self.turn(own.s, [own.su, own.sv]) > 0.0;
                return Some(uv).filter(|_| way.max_element() <= farthest && is_same_side);
            }
            uv += self.parameters_of(s, [d.su, d.sv], offset);
            if !uv.is_finite() {
                return None;
            }
        }
        None
    }

    /// The Bézier pieces, in the order of [`nurbs::Surface::bezier_patches`], that a hit's parameters belong to: the one
    /// that it states rightly, else, on a knot, those on its either side.
    pub(crate) fn pieces(&self, hit: &Hit) -> impl Iterator<Item = usize> {
        let spans = &self.spans[self.model.faces()[hit.face.0 as usize].surface];
        let (surface, stated) = (self.model.surface(hit.face), self.local(hit));
        let on = move |k: usize, direction: Direction| {
            let knots = surface.knots(direction);
            let (t, (start, end)) = (hit.uv[k], knots.domain());
            let (all, own) = (knots.knots(), knots.find_span(t));
            // What f64 may lose of the way to the knot domain.
            let slack = 4.0 * f64::EPSILON * (start.abs() + end.abs());
            let is_on = move |number: usize, span: usize| match stated {
                Some(local) => number == local.span[k] as usize,
                None => span == own || all[span] <= t + slack && t - slack <= all[span + 1],
            };
            spans[k].iter().enumerate().filter(move |(number, span)| is_on(*number, **span)).map(|(number, _)| number)
        };
        let columns = spans[1].len();
        on(0, Direction::U).flat_map(move |k| on(1, Direction::V).map(move |l| k * columns + l))
    }

    /// Whether f64 tells places at a hit's parameters apart as well as f32 does on a Bézier piece of its own.
    pub(crate) fn holds_parameters(&self, hit: &Hit) -> Result<(), (Unbounded, String)> {
        if self.local(hit).is_some() {
            return Ok(());
        }
        let surface = self.model.surface(hit.face);
        for (name, direction, t) in [("u", Direction::U, hit.uv.x), ("v", Direction::V, hit.uv.y)] {
            let knots = surface.knots(direction);
            let span = knots.find_span(t);
            let [start, end] = [knots.knots()[span], knots.knots()[span + 1]];
            let spacing = t.abs().next_up() - t.abs();
            if spacing > (end - start) / (1u64 << 24) as f64 {
                let detail = format!("{name} = {t} is a multiple of {spacing:.3e} on a span of {:.3e}", end - start);
                return Err((Unbounded::Parameters, detail));
            }
        }
        Ok(())
    }

    /// S in f64 at a hit's own parameters.
    pub(crate) fn surface_point(&self, hit: &Hit) -> DVec3 {
        let surface = self.model.surface(hit.face);
        match self.local(hit) {
            Some(LocalParameters { span, uv }) => surface.point_local(self.knot_spans(hit.face, span), uv),
            None => surface.point(hit.uv.x, hit.uv.y),
        }
    }

    /// A hit's local parameters, where they are believed.
    fn local(&self, hit: &Hit) -> Option<LocalParameters> {
        self.scene.frames()[hit.face.0 as usize].believed(hit)
    }

    /// The knot spans that have these numbers among those of a face that are not empty.
    pub(crate) fn knot_spans(&self, face: FaceId, span: [u32; 2]) -> [usize; 2] {
        let spans = &self.spans[self.model.faces()[face.0 as usize].surface];
        [0, 1].map(|k| spans[k][span[k] as usize])
    }

    /// Picture position of a point, which may lie before the near plane by what a triangle may be off the surface.
    pub(crate) fn picture(&self, position: DVec3) -> Option<DVec2> {
        self.camera.picture(self.viewport, position)
    }
}

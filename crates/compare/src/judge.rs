//! The comparison of two G-buffers, pixel by pixel.

use crate::attribution::Attribution;
use crate::deviation::Deviation;
use crate::report::{Coverage, PairReport, PixelReport, Verdict, WORST};
use crate::tolerance::{Tolerance, ToleranceModel};
use crate::{Cause, NEARLY};
use gbuffer::{GBuffer, Hit, PrincipalCurvatures};
use glam::{DVec2, DVec3};
use nurbs::{Direction, Normal, SurfacePoint};
use rayon::prelude::*;
use scene::{Camera, Model, Viewport};

/// The share of covered pixels that may stay undecided in an agreement.
pub const UNDECIDED_SHARE: f64 = 1e-3;

/// Directions in which a sampler is asked around a pixel.
const DIRECTIONS: usize = 16;

/// Rounding of the depths that a depth test compares, in units of 2⁻²⁴ of the distance and the model's size: half an
/// ulp each of z, of 1 / w, of their product and of the interpolation between corners, on either side.
const DEPTH_ULPS: f64 = 4.0;

/// Cells along the sides of the grid on which a sampler is asked where the rings show nothing alike.
const GRID: usize = 48;

/// A reference renderer that can be asked at any position of the picture, in pixels, not only at pixels' centres.
pub trait Sampler: Sync {
    /// What it sees there.
    fn first(&self, x: f64, y: f64) -> Option<Hit>;

    /// All that it draws there, hidden layers too; of a renderer that cannot tell, what it sees.
    fn layers(&self, x: f64, y: f64) -> Vec<Hit> {
        self.first(x, y).into_iter().collect()
    }
}

/// Why two buffers cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// Both come from the same renderer: that would be no check.
    #[error("both G-buffers come from the renderer {name:?}")]
    SameRenderer {
        /// Its name.
        name: String,
    },
    /// The sizes differ from each other or from the judge's.
    #[error("the G-buffers measure {reference:?} and {candidate:?} where {expected:?} is compared")]
    Size {
        /// Size of the reference.
        reference: [usize; 2],
        /// Size of the candidate.
        candidate: [usize; 2],
        /// Size of the judge's viewport.
        expected: [usize; 2],
    },
    /// A buffer shows another model or another view.
    #[error("the {what} of the G-buffer from {renderer:?} is not the one compared")]
    OtherScene {
        /// `model` or `camera`.
        what: &'static str,
        /// Whose buffer it is.
        renderer: String,
    },
    /// A hit names a face that the model does not have.
    #[error("the G-buffer from {renderer:?} names face {face}; the model has {count}")]
    NoSuchFace {
        /// Whose buffer it is.
        renderer: String,
        /// The face.
        face: u32,
        /// Faces of the model.
        count: usize,
    },
    /// Neither buffer covers a single pixel: there is nothing to agree on.
    #[error("neither {reference:?} nor {candidate:?} covers a pixel: nothing was compared")]
    Empty {
        /// Name of the reference.
        reference: String,
        /// Name of the candidate.
        candidate: String,
    },
}

/// Judges renderings of one model by one camera.
pub struct Judge<'m> {
    model: &'m Model,
    camera: &'m Camera,
    viewport: Viewport,
    /// Diagonal of the model's box.
    size: f64,
    tolerances: Vec<ToleranceModel<'m>>,
    attribution: Attribution<'m>,
}

/// Errors of a hit at its own (u, v), as shares of their tolerances.
#[derive(Debug, Clone, Copy, Default)]
struct Shares {
    position: f64,
    normal: f64,
    curvature: f64,
    unbounded: bool,
}

/// A difference: cause, how many times over, in words.
struct Difference {
    cause: Cause,
    excess: f64,
    detail: String,
}

impl Difference {
    fn new(cause: Cause, excess: f64, detail: String) -> Self {
        Self { cause, excess: if excess.is_nan() { f64::INFINITY } else { excess }, detail }
    }
}

/// What was found at a pixel that agrees.
#[derive(Debug, Clone, Copy, Default)]
struct Agreement {
    across_px: f64,
    bound_px: f64,
    along: f64,
    shares: Shares,
}

/// The view of one pair of buffers.
struct Pair<'a, 'm> {
    judge: &'a Judge<'m>,
    reference: &'a GBuffer,
    candidate: &'a GBuffer,
    sampler: &'a dyn Sampler,
    deviation: &'a Deviation,
    /// Whether the reference shows at every position the surface point on that very ray.
    exact: bool,
}

/// Running sums of a comparison.
struct Tally {
    report: PairReport,
}

impl<'m> Judge<'m> {
    /// A judge of `model` as `camera` sees it.
    pub fn new(model: &'m Model, camera: &'m Camera, viewport: Viewport) -> Self {
        let tolerances = model.surfaces().iter().map(ToleranceModel::new).collect();
        let size = model.hull().diagonal();
        Self { model, camera, viewport, size, tolerances, attribution: Attribution::new(model) }
    }

    /// Compares a candidate with a reference that `sampler` can ask at any position of the picture.
    ///
    /// For each pixel, in this order; the first that fails gives the cause:
    /// 1. *evaluation*: position, normal and curvatures at the candidate's own (u, v) lie within [`Tolerance`] of f64.
    ///    A parameter within rounding of a knot may be on either span;
    /// 2. *geometry*: S(u, v) projects to within the bound ([`Deviation::model_units`], seen there) of what the reference shows there:
    ///    of the pixel's centre, for a ray caster;
    /// 3. *visibility*: nothing that the reference sees within the bound of the centre hides that point by more than
    ///    the bound, everywhere;
    /// 4. *coverage*: a pixel that only the reference covers has an edge within the bound: a position where the
    ///    reference sees nothing, or a border of the face.
    ///
    /// `exact` says that the reference is a ray caster. `progress` is told of every row done.
    ///
    /// # Errors
    /// [`CompareError`] where the two cannot be compared or nothing is covered.
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
                let mut tally = Tally::new(reference, candidate, deviation);
                (0..self.viewport.width()).for_each(|x| tally.add(x, y, &pair));
                progress(1);
                tally
            })
            .collect();
        let total = rows.into_iter().reduce(Tally::merged).expect("a viewport has rows");
        Ok(total.finished())
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
        if reference.covered() == 0 && candidate.covered() == 0 {
            return Err(CompareError::Empty { reference: r.renderer.clone(), candidate: c.renderer.clone() });
        }
        Ok(())
    }

    /// Checks a hit against f64 at its own (u, v).
    fn evaluation(&self, hit: &Hit) -> Result<Shares, Difference> {
        if !hit.uv.is_finite() || !hit.position.is_finite() {
            let detail = format!("(u, v) = {}, S = {}", hit.uv, hit.position);
            return Err(Difference::new(self.attribution.of_position(hit, f64::INFINITY), f64::INFINITY, detail));
        }
        let surface = self.model.surface(hit.face);
        let face = &self.model.faces()[hit.face.0 as usize];
        let mut first = None;
        for span in self.spans(hit) {
            let point = oriented(surface.inspect_on(span[0], span[1], hit.uv.x, hit.uv.y), face.reversed);
            let model = &self.tolerances[face.surface];
            let tolerance = model.at(span, hit.uv.x, hit.uv.y, &point.derivatives, point.curvature.as_ref());
            match self.at_point(hit, &point, &tolerance) {
                Ok(shares) => return Ok(shares),
                Err(difference) => first = first.or(Some(difference)),
            }
        }
        Err(first.expect("a parameter has a span"))
    }

    /// The span of the parameters, then the ones across knots that are within rounding of them.
    fn spans(&self, hit: &Hit) -> Vec<[usize; 2]> {
        let surface = self.model.surface(hit.face);
        let model = &self.tolerances[self.model.faces()[hit.face.0 as usize].surface];
        let [us, vs] = [(Direction::U, hit.uv.x), (Direction::V, hit.uv.y)].map(|(direction, t)| {
            let (knots, slack) = (surface.knots(direction), model.knot_slack(direction));
            let own = knots.find_span(t);
            // Inside the slack every span between is possible: tiny ones that f32 cannot tell apart.
            let near = |&k: &usize| k != own && knots.knots()[k] <= t + slack && t - slack <= knots.knots()[k + 1];
            std::iter::once(own).chain(knots.spans().filter(near)).collect::<Vec<usize>>()
        });
        us.iter().flat_map(|&k| vs.iter().map(move |&l| [k, l])).collect()
    }

    fn at_point(&self, hit: &Hit, point: &SurfacePoint, tolerance: &Tolerance) -> Result<Shares, Difference> {
        let mut shares = Shares::default();
        let error = hit.position.distance(point.derivatives.s);
        shares.position = share(error, tolerance.position);
        if shares.position > 1.0 {
            let cause = self.attribution.of_position(hit, shares.position);
            let detail = format!("S is {error:.3e} off, tolerance {:.3e}", tolerance.position);
            return Err(Difference::new(cause, shares.position, detail));
        }
        let (Some(allowed), Normal::Regular(expected)) = (tolerance.normal, point.normal) else {
            shares.unbounded = true;
            return Ok(shares);
        };
        let Some(normal) = hit.normal.unit() else {
            let detail = format!("no normal where f64 finds one within {allowed:.3e}");
            return Err(Difference::new(Cause::DegenerateNormal, 1.0 / allowed, detail));
        };
        let error = normal.distance(expected);
        shares.normal = share(error, allowed);
        if shares.normal > 1.0 {
            let direction = normal.normalize_or_zero().distance(expected);
            let cause = if !normal.is_finite() {
                Cause::NotFinite
            } else if direction <= allowed * NEARLY && (normal.length() - 1.0).abs() > allowed {
                Cause::NormalLength
            } else if shares.normal <= NEARLY {
                Cause::Rounding
            } else {
                Cause::Derivative
            };
            let detail = format!("the normal is {error:.3e} off (length {}), tolerance {allowed:.3e}", normal.length());
            return Err(Difference::new(cause, shares.normal, detail));
        }
        if let (Some(allowed), Some(found), Some(expected)) = (tolerance.curvature, hit.curvature, point.curvature) {
            let error = (found.k1 - expected.k1).abs().max((found.k2 - expected.k2).abs());
            shares.curvature = share(error, allowed);
            if shares.curvature > 1.0 {
                let cause = if shares.curvature <= NEARLY { Cause::Rounding } else { Cause::Curvature };
                let detail = format!(
                    "k1, k2 = {:.6e}, {:.6e} where f64 has {:.6e}, {:.6e}; tolerance {allowed:.3e}",
                    found.k1, found.k2, expected.k1, expected.k2
                );
                return Err(Difference::new(cause, shares.curvature, detail));
            }
        }
        Ok(shares)
    }

    /// S in f64 at a hit's own parameters.
    fn surface_point(&self, hit: &Hit) -> DVec3 {
        self.model.surface(hit.face).point(hit.uv.x, hit.uv.y)
    }

    /// Picture position of a point, which may lie before the near plane by what a triangle may be off the surface.
    fn picture(&self, position: DVec3) -> Option<DVec2> {
        self.camera.picture(self.viewport, position)
    }
}

fn share(error: f64, tolerance: f64) -> f64 {
    if error == 0.0 {
        0.0
    } else if error.is_nan() {
        f64::INFINITY
    } else {
        error / tolerance
    }
}

/// The point as a reversed face shows it.
fn oriented(mut point: SurfacePoint, reversed: bool) -> SurfacePoint {
    if reversed {
        point.normal = match point.normal {
            Normal::Regular(n) => Normal::Regular(-n),
            Normal::Limit(n) => Normal::Limit(-n),
            Normal::Undefined => Normal::Undefined,
        };
        if let Some(k) = &mut point.curvature {
            let PrincipalCurvatures { k1, k2 } = PrincipalCurvatures { k1: k.k1, k2: k.k2 }.reversed();
            (k.k1, k.k2, k.mean) = (k1, k2, -k.mean);
        }
    }
    point
}

impl Pair<'_, '_> {
    fn pixel(&self, x: usize, y: usize) -> Result<Option<Agreement>, Difference> {
        let center = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let result = match (self.reference.get(x, y), self.candidate.get(x, y)) {
            (None, None) => Ok(None),
            (reference, Some(candidate)) => self.shown(center, reference, candidate).map(Some),
            (Some(reference), None) => self.missing(center, reference).map(|()| Some(Agreement::default())),
        };
        match result {
            Err(difference) if self.reference.is_undecided(x, y) => {
                Err(Difference { cause: Cause::Undecided, ..difference })
            }
            other => other,
        }
    }

    /// A pixel that the candidate covers.
    fn shown(&self, center: DVec2, reference: Option<&Hit>, candidate: &Hit) -> Result<Agreement, Difference> {
        let shares = self.judge.evaluation(candidate)?;
        let s = self.judge.surface_point(candidate);
        let face = candidate.face.0 as usize;
        let bound_px = self.bound_of(face, s);
        // Along the ray: the chord on either side, what rounding of S itself was, and that of the depths compared.
        let depth = DEPTH_ULPS / (1u64 << 24) as f64 * (candidate.t.abs() + self.judge.size);
        let slack = 2.0 * self.deviation.model_units(face) + 2.0 * candidate.position.distance(s) + depth;
        let in_front = self.judge.camera.depth(s) >= self.judge.camera.near() - slack;
        let picture = self.judge.picture(s).filter(|_| in_front);
        let same = reference.filter(|r| r.face == candidate.face && (r.t - candidate.t).abs() <= slack);
        let along = same.map_or(0.0, |r| (r.t - candidate.t).abs());
        // Geometry.
        let target = match same {
            Some(r) if !self.exact => self.judge.picture(self.judge.surface_point(r)),
            _ => Some(center),
        };
        let across_px = match (picture, target) {
            (Some(a), Some(b)) => a.distance(b),
            _ => f64::INFINITY,
        };
        let agreement = Agreement { across_px, bound_px, along, shares };
        if same.is_some() && across_px <= bound_px {
            return Ok(agreement);
        }
        if self.exact {
            if across_px > bound_px {
                return Err(self.misplaced(candidate, center, across_px, bound_px));
            }
        } else if !self.is_drawn_nearby(center, bound_px, reference, candidate, slack)
            && !self.is_beyond_an_edge(center, bound_px, reference, candidate, s)
        {
            let cause = match reference {
                None => Cause::Coverage,
                Some(r) if r.face == candidate.face => Cause::Interpolation,
                Some(r) if r.t < candidate.t => Cause::Depth,
                Some(_) => Cause::Coverage,
            };
            let detail = format!("nothing within {bound_px:.4} px in the reference is like it");
            return Err(Difference::new(cause, across_px / bound_px, detail));
        }
        // Visibility.
        let Some(occluder) = reference.filter(|r| r.t < candidate.t - slack) else { return Ok(agreement) };
        let behind = |hit: Option<Hit>| hit.is_none_or(|q| q.t >= candidate.t - slack);
        let own = picture.filter(|_| self.exact).is_some_and(|p| behind(self.sampler.first(p.x, p.y)));
        let bound = bound_px.max(self.bound_at(occluder));
        if own || self.near_border(occluder, center, bound) || self.around(center, bound, Some(occluder)).any(behind) {
            return Ok(agreement);
        }
        let detail =
            format!("shown at t = {:.6}, but face {} at t = {:.6} hides it", candidate.t, occluder.face.0, occluder.t);
        Err(Difference::new(Cause::Depth, (candidate.t - occluder.t) / slack, detail))
    }

    /// A pixel that only the reference covers.
    fn missing(&self, center: DVec2, reference: &Hit) -> Result<(), Difference> {
        let bound = self.bound_at(reference);
        // Two rasterizers may each leave a crack between faces, whose corners are placed in frames of their own.
        let is_edge = |q: Option<Hit>| q.is_none_or(|q| !self.exact && q.face != reference.face);
        if self.near_border(reference, center, bound) || self.around(center, bound, Some(reference)).any(is_edge) {
            return Ok(());
        }
        let detail = format!("face {} is not shown, and no edge is within {bound:.4} px", reference.face.0);
        Err(Difference::new(Cause::Coverage, f64::INFINITY, detail))
    }

    /// S at the candidate's (u, v) is not on the pixel's ray: are u and v exchanged, or was interpolation wrong?
    fn misplaced(&self, candidate: &Hit, center: DVec2, across_px: f64, bound_px: f64) -> Difference {
        let surface = self.judge.model.surface(candidate.face);
        let [[u0, u1], [v0, v1]] = surface.domain();
        let [s, t] = [(candidate.uv.x - u0) / (u1 - u0), (candidate.uv.y - v0) / (v1 - v0)];
        let exchanged = self.judge.picture(surface.point(u0 + (u1 - u0) * t, v0 + (v1 - v0) * s));
        let cause = match exchanged {
            Some(p) if p.distance(center) <= bound_px => Cause::Parameters,
            _ => Cause::Interpolation,
        };
        let detail = format!("S(u, v) projects {across_px:.4} px from the pixel's centre, bound {bound_px:.4} px");
        Difference::new(cause, across_px / bound_px, detail)
    }

    fn bound_at(&self, hit: &Hit) -> f64 {
        self.bound_of(hit.face.0 as usize, hit.position)
    }

    /// The allowance across the ray, in pixels, for a point of a face.
    fn bound_of(&self, face: usize, position: DVec3) -> f64 {
        let radius = self.deviation.model_units(face);
        self.judge.camera.pixels_within(self.judge.viewport, position, radius) + self.deviation.snap_px
    }

    /// Whether the reference draws the candidate's point somewhere within the bound: on the rings, or on a dense grid.
    ///
    /// A hidden layer will do: whether it may be seen is decided by itself.
    fn is_drawn_nearby(
        &self,
        center: DVec2,
        bound_px: f64,
        reference: Option<&Hit>,
        candidate: &Hit,
        slack: f64,
    ) -> bool {
        let draws = |places: &mut dyn Iterator<Item = DVec2>| {
            let layers: Vec<Hit> = places.flat_map(|p| self.sampler.layers(p.x, p.y)).collect();
            layers.iter().any(|q| self.is_like(q, candidate, bound_px, slack))
                || self.is_between(&layers, candidate, slack)
        };
        if draws(&mut self.places(center, bound_px, reference.or(Some(candidate)))) {
            return true;
        }
        let steps = (0..=GRID).map(|i| 2.0 * i as f64 / GRID as f64 - 1.0);
        let grid = steps.clone().flat_map(|x| steps.clone().map(move |y| DVec2::new(x, y)));
        draws(&mut grid.filter(|offset| offset.length() <= 1.0).map(|offset| center + bound_px * offset))
    }

    /// Whether an edge of the drawing passes within the bound, and the candidate's point `s` is as near to the pixel's
    /// ray as the chord allows: it was interpolated beyond its triangle.
    fn is_beyond_an_edge(
        &self,
        center: DVec2,
        bound_px: f64,
        reference: Option<&Hit>,
        candidate: &Hit,
        s: DVec3,
    ) -> bool {
        let face = candidate.face.0 as usize;
        let radius = self.deviation.edge_chord[face] + self.deviation.model_units(face);
        let chord_px = self.judge.camera.pixels_within(self.judge.viewport, s, radius) + self.deviation.snap_px;
        let identity = |hit: Option<Hit>| hit.map(|h| h.face);
        self.judge.picture(s).is_some_and(|p| p.distance(center) <= chord_px)
            && self
                .around(center, bound_px, reference.or(Some(candidate)))
                .any(|q| identity(q) != identity(reference.copied()))
    }

    /// Whether a sample shows the candidate's point: same face, same place in the picture and in depth.
    fn is_like(&self, q: &Hit, candidate: &Hit, bound_px: f64, slack: f64) -> bool {
        if q.face != candidate.face {
            return false;
        }
        let [a, b] = [q, candidate].map(|hit| self.judge.picture(self.judge.surface_point(hit)));
        let near = a.zip(b).is_some_and(|(a, b)| a.distance(b) <= bound_px);
        near && (q.t - candidate.t).abs() <= slack
    }

    /// Whether the candidate's point lies among those of its face that the samples show: at a grazing pixel all
    /// change fast from one position to the next.
    fn is_between(&self, samples: &[Hit], candidate: &Hit, slack: f64) -> bool {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let parameters = |hit: &Hit| hit.uv.extend(hit.t);
        for q in samples.iter().filter(|q| q.face == candidate.face) {
            low = low.min(parameters(q));
            high = high.max(parameters(q));
        }
        // Rounding of the interpolated parameters themselves.
        let [u, v] = self.judge.model.surface(candidate.face).domain().map(|[start, end]| end - start);
        let margin =
            DVec3::new(u * crate::ATTRIBUTE_ULPS / 2f64.powi(24), v * crate::ATTRIBUTE_ULPS / 2f64.powi(24), slack);
        let p = parameters(candidate);
        low.cmple(p + margin).all() && high.cmpge(p - margin).all()
    }

    /// What the reference sees around a position.
    fn around<'a>(
        &'a self,
        center: DVec2,
        radius: f64,
        hit: Option<&Hit>,
    ) -> impl Iterator<Item = Option<Hit>> + use<'a> {
        self.places(center, radius, hit).map(move |p| self.sampler.first(p.x, p.y))
    }

    /// Positions around a position: itself, some along the picture of the hit's normal, which points straight across
    /// a silhouette, and two rings.
    fn places(&self, center: DVec2, radius: f64, hit: Option<&Hit>) -> impl Iterator<Item = DVec2> + use<> {
        let camera = self.judge.camera;
        let across = hit
            .and_then(|hit| hit.normal.unit())
            .map_or(DVec2::ZERO, |n| DVec2::new(n.dot(camera.right()), -n.dot(camera.above())).normalize_or_zero());
        let ring = (0..DIRECTIONS).map(|i| DVec2::from_angle(std::f64::consts::TAU * i as f64 / DIRECTIONS as f64));
        let offsets = [DVec2::ZERO, across, -across, 0.75 * across, -0.75 * across, 0.5 * across, -0.5 * across];
        let offsets = offsets.into_iter().chain(ring.flat_map(|d| [d, 0.5 * d]));
        offsets.map(move |offset| center + radius * offset)
    }

    /// Whether a border of the hit's face passes within `radius` pixels of a position, or the near plane cuts it there.
    fn near_border(&self, hit: &Hit, center: DVec2, radius: f64) -> bool {
        let beyond_near = self.judge.camera.depth(hit.position) - self.judge.camera.near();
        if beyond_near <= self.deviation.model_units(hit.face.0 as usize) {
            return true;
        }
        let surface = self.judge.model.surface(hit.face);
        let [[u0, u1], [v0, v1]] = surface.domain();
        let DVec2 { x: u, y: v } = hit.uv;
        [(u0, v), (u1, v), (u, v0), (u, v1)].into_iter().any(|(s, t)| {
            // Slide along the border to where it is nearest in the picture.
            let mut place = DVec2::new(s, t);
            let along_u = s == u;
            for _ in 0..4 {
                let d = surface.first_derivatives(place.x, place.y);
                let tangent = if along_u { d.su } else { d.sv };
                let (Some(at), Some(next)) = (self.judge.picture(d.s), self.judge.picture(d.s + tangent * 1e-6)) else {
                    return false;
                };
                if at.distance(center) <= radius {
                    return true;
                }
                let direction = (next - at) / 1e-6;
                let step = (center - at).dot(direction) / direction.length_squared();
                if !step.is_finite() {
                    return false;
                }
                if along_u {
                    place.x = (place.x + step).clamp(u0, u1);
                } else {
                    place.y = (place.y + step).clamp(v0, v1);
                }
            }
            false
        })
    }

    /// Whether the reference's own picture changes within the bound of a pixel's centre.
    fn is_partial(&self, x: usize, y: usize, center: DVec2) -> bool {
        let (width, height) = (self.judge.viewport.width(), self.judge.viewport.height());
        let own = self.reference.get(x, y);
        let identity = |hit: Option<&Hit>| hit.map(|h| h.face);
        let neighbours = (y.saturating_sub(1)..(y + 2).min(height))
            .flat_map(|j| (x.saturating_sub(1)..(x + 2).min(width)).map(move |i| (i, j)));
        let mut shown: Vec<Option<&Hit>> = neighbours.map(|(i, j)| self.reference.get(i, j)).collect();
        shown.push(self.candidate.get(x, y));
        if shown.iter().all(|hit| identity(*hit) == identity(own)) {
            return false;
        }
        let bound = shown.iter().flatten().fold(self.deviation.snap_px, |b: f64, hit| b.max(self.bound_at(hit)));
        self.around(center, bound, own).any(|q| identity(q.as_ref()) != identity(own))
    }
}

impl Tally {
    fn new(reference: &GBuffer, candidate: &GBuffer, deviation: &Deviation) -> Self {
        let report = PairReport {
            reference: reference.meta().renderer.clone(),
            candidate: candidate.meta().renderer.clone(),
            covered: 0,
            agree: 0,
            causes: Default::default(),
            coverage: Coverage::default(),
            unbounded: 0,
            max_px: 0.0,
            bound_px: 0.0,
            greatest_bound_px: 0.0,
            max_along: 0.0,
            position_share: 0.0,
            normal_share: 0.0,
            curvature_share: 0.0,
            bounds: deviation.text.clone(),
            worst: vec![],
            verdict: Verdict::Differ,
        };
        Self { report }
    }

    fn add(&mut self, x: usize, y: usize, pair: &Pair) {
        let report = &mut self.report;
        let reference = pair.reference.get(x, y);
        let covered = reference.is_some() || pair.candidate.get(x, y).is_some();
        report.covered += usize::from(covered);
        let center = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let class = if pair.is_partial(x, y, center) {
            &mut report.coverage.partial
        } else if reference.is_some() {
            &mut report.coverage.full
        } else {
            &mut report.coverage.none
        };
        *class += 1;
        match pair.pixel(x, y) {
            Ok(None) => {}
            Ok(Some(found)) => {
                report.agree += 1;
                report.unbounded += usize::from(found.shares.unbounded);
                if found.across_px.is_finite() && found.across_px > report.max_px && found.across_px <= found.bound_px {
                    (report.max_px, report.bound_px) = (found.across_px, found.bound_px);
                }
                report.greatest_bound_px = report.greatest_bound_px.max(found.bound_px);
                report.max_along = report.max_along.max(found.along);
                report.position_share = report.position_share.max(found.shares.position);
                report.normal_share = report.normal_share.max(found.shares.normal);
                report.curvature_share = report.curvature_share.max(found.shares.curvature);
            }
            Err(Difference { cause, excess, detail }) => {
                *report.causes.entry(cause).or_default() += 1;
                report.worst.push(PixelReport { x, y, cause, excess, detail });
                if report.worst.len() > 4 * WORST {
                    keep_worst(&mut report.worst);
                }
            }
        }
    }

    fn merged(mut self, other: Self) -> Self {
        let (a, b) = (&mut self.report, other.report);
        a.covered += b.covered;
        a.agree += b.agree;
        a.unbounded += b.unbounded;
        a.coverage.full += b.coverage.full;
        a.coverage.partial += b.coverage.partial;
        a.coverage.none += b.coverage.none;
        for (cause, count) in b.causes {
            *a.causes.entry(cause).or_default() += count;
        }
        if b.max_px > a.max_px {
            (a.max_px, a.bound_px) = (b.max_px, b.bound_px);
        }
        a.greatest_bound_px = a.greatest_bound_px.max(b.greatest_bound_px);
        a.max_along = a.max_along.max(b.max_along);
        a.position_share = a.position_share.max(b.position_share);
        a.normal_share = a.normal_share.max(b.normal_share);
        a.curvature_share = a.curvature_share.max(b.curvature_share);
        a.worst.extend(b.worst);
        keep_worst(&mut a.worst);
        self
    }

    fn finished(mut self) -> PairReport {
        let report = &mut self.report;
        keep_worst(&mut report.worst);
        let undecided = report.causes.get(&Cause::Undecided).copied().unwrap_or(0);
        let few = undecided as f64 <= UNDECIDED_SHARE * report.covered as f64;
        if report.differing() == 0 && few {
            report.verdict = Verdict::Agree;
        }
        self.report
    }
}

/// Sorts worst first (ties by position) and drops the rest.
fn keep_worst(pixels: &mut Vec<PixelReport>) {
    pixels.sort_by(|a, b| b.excess.total_cmp(&a.excess).then((a.y, a.x).cmp(&(b.y, b.x))));
    pixels.truncate(WORST);
}

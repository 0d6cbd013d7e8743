//! The judge of a model's renderings: who may be compared, and evaluation at a hit's own (u, v).

use crate::attribution::Attribution;
use crate::pair::Pair;
use crate::tally::Tally;
use crate::tolerance::{Tolerance, ToleranceModel};
use crate::{Cause, CompareError, Deviation, NEARLY, PairReport, Sampler};
use gbuffer::{GBuffer, Hit, PrincipalCurvatures};
use glam::{DVec2, DVec3};
use nurbs::{Direction, Normal, SurfacePoint};
use rayon::prelude::*;
use scene::{Camera, Model, Viewport};

/// Judges renderings of one model by one camera.
pub struct Judge<'m> {
    pub(crate) model: &'m Model,
    pub(crate) camera: &'m Camera,
    pub(crate) viewport: Viewport,
    /// Diagonal of the model's box.
    pub(crate) size: f64,
    tolerances: Vec<ToleranceModel<'m>>,
    attribution: Attribution<'m>,
}

/// Errors of a hit at its own (u, v), as shares of their tolerances.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Shares {
    pub position: f64,
    pub normal: f64,
    pub curvature: f64,
    pub unbounded: bool,
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
    pub(crate) fn evaluation(&self, hit: &Hit) -> Result<Shares, Difference> {
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
    pub(crate) fn surface_point(&self, hit: &Hit) -> DVec3 {
        self.model.surface(hit.face).point(hit.uv.x, hit.uv.y)
    }

    /// Picture position of a point, which may lie before the near plane by what a triangle may be off the surface.
    pub(crate) fn picture(&self, position: DVec3) -> Option<DVec2> {
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

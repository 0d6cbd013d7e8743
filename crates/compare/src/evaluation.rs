//! The values of a hit against what the fragment program may return at the hit's own (u, v).

use crate::difference::Difference;
use crate::setting::Setting;
use crate::{Cause, NEARLY, Shares, Unbounded};
use gbuffer::{Hit, PrincipalCurvatures};
use glam::DVec2;
use nurbs::{Normal, SurfacePoint};
use pipeline::PackedFrame;
use pipeline::enclosure::{Enclosure, Interval, Regularity, enclose};

/// Roundings in f64 of a position on its way from local coordinates to the world and back, of the sizes involved.
const WIDENING: f64 = 4.0 * f64::EPSILON;

/// Rounding of f64's own evaluation against f32's, which is 2³⁰ times coarser, with room for another order of operations
/// and other knots.
const OWN_ROUNDING: f64 = 1.0 / 1024.0;

/// Values that are as they may be.
pub(crate) struct Evaluated {
    pub shares: Shares,
    /// How far from S the one returned may be, model units; infinite where it has no bound.
    pub radius: f64,
}

impl Setting<'_> {
    /// Checks a hit's values at its own (u, v).
    ///
    /// They must lie in the enclosure on some pair of spans that f32 allows; and S, normal and curvatures in f64 must lie
    /// no farther from its middle than packing narrows, for otherwise the packed face is another one.
    pub(crate) fn evaluation(&self, hit: &Hit) -> Result<Evaluated, Difference> {
        if !hit.uv.is_finite() || !hit.position.is_finite() {
            let detail = format!("(u, v) = {}, S = {}", hit.uv, hit.position);
            return Err(Difference::new(self.attribution.of_position(hit, f64::INFINITY), f64::INFINITY, detail));
        }
        let frame = &self.scene.frames()[hit.face.0 as usize];
        let known = frame.known(hit);
        let enclosures = enclose(self.scene, hit.face.0, &known, hit.curvature.is_some());
        // Where the parameters are not known to the bit, the half-width holds what they leave open.
        let kept = if known.is_exact() { OWN_ROUNDING } else { 1.0 };
        let local = Local::of(hit, frame);
        let mut first = None;
        for enclosure in enclosures.iter() {
            match self.inside(hit, &local, enclosure) {
                Ok(shares) => {
                    self.packed_rightly(hit, &local, &widened(enclosure, kept))?;
                    // Local parameters that are not believed: first (u, v) were judged, now these.
                    if hit.local.is_some() && frame.believed(hit).is_none() {
                        let detail = format!("(u, v) = {} is another place than {:?}", hit.uv, hit.local);
                        return Err(Difference::new(Cause::Span, f64::INFINITY, detail));
                    }
                    let shares = Shares { ambiguous: enclosures.is_ambiguous(), ..shares };
                    let radius = enclosure.position.map_or(f64::INFINITY, |s| radius(&s) * frame.scale);
                    return Ok(Evaluated { shares, radius });
                }
                Err(difference) => first = first.or(Some(difference)),
            }
        }
        Err(first.expect("a parameter has a span"))
    }

    /// Whether the values lie in one enclosure.
    fn inside(&self, hit: &Hit, local: &Local, enclosure: &Enclosure) -> Result<Shares, Difference> {
        let mut shares = Shares::default();
        match &enclosure.position {
            None => shares.unbounded = Some(Unbounded::Rounding),
            Some(intervals) => {
                let share = greatest(intervals, local.position, local.slack);
                if share > 1.0 {
                    let cause = self.attribution.of_position(hit, share);
                    return Err(Difference::new(cause, share, words("S", intervals, local.position)));
                }
                shares.position = Some(share);
            }
        }
        let Some(normal) = hit.normal.unit() else {
            if enclosure.regularity == Regularity::Regular {
                let detail = "no normal where the program finds one however it rounds".to_owned();
                return Err(Difference::new(Cause::DegenerateNormal, f64::INFINITY, detail));
            }
            // Where f32 may find one, one was not returned that could be judged.
            let open = (enclosure.regularity == Regularity::Either).then_some(Unbounded::Normal);
            return Ok(Shares { unbounded: shares.unbounded.or(open), ..shares });
        };
        if enclosure.regularity == Regularity::Degenerate {
            // A renderer in f64 may know the limit.
            if let Normal::Limit(_) = hit.normal {
                return Ok(Shares { unbounded: shares.unbounded.or(Some(Unbounded::Normal)), ..shares });
            }
            let detail = "a normal where the program finds none however it rounds".to_owned();
            return Err(Difference::new(Cause::DegenerateNormal, f64::INFINITY, detail));
        }
        let Some(intervals) = &enclosure.normal else {
            return Ok(Shares { unbounded: shares.unbounded.or(Some(Unbounded::Normal)), ..shares });
        };
        let share = greatest(intervals, normal.to_array(), 0.0);
        if share > 1.0 {
            let direction = greatest(intervals, normal.normalize_or_zero().to_array(), 0.0);
            let longest = intervals.iter().fold(0.0, |most: f64, x| most.max(x.half_width));
            let cause = if !normal.is_finite() {
                Cause::NotFinite
            } else if direction <= NEARLY && (normal.length() - 1.0).abs() > longest {
                Cause::NormalLength
            } else if share <= NEARLY {
                Cause::Rounding
            } else {
                Cause::Derivative
            };
            let detail = format!("{} (length {})", words("the normal", intervals, normal.to_array()), normal.length());
            return Err(Difference::new(cause, share, detail));
        }
        shares.normal = Some(share);
        let Some(k) = local.curvature else { return Ok(shares) };
        let Some(intervals) = &enclosure.curvature else {
            return Ok(Shares { unbounded: shares.unbounded.or(Some(Unbounded::Curvature)), ..shares });
        };
        let share = greatest(intervals, k, 0.0);
        if share > 1.0 {
            let cause = if share <= NEARLY { Cause::Rounding } else { Cause::Curvature };
            return Err(Difference::new(cause, share, words("k1, k2 (local)", intervals, k)));
        }
        shares.curvature = Some(share);
        Ok(shares)
    }

    /// Whether the packed face that the enclosure is of is the model's: f64 lies as near as narrowing allows.
    fn packed_rightly(&self, hit: &Hit, local: &Local, enclosure: &Enclosure) -> Result<(), Difference> {
        let frame = &self.scene.frames()[hit.face.0 as usize];
        let surface = self.model.surface(hit.face);
        let reversed = self.model.faces()[hit.face.0 as usize].reversed;
        let span = self.knot_spans(hit.face, enclosure.on.map(|on| on.span));
        let t = DVec2::from_array(enclosure.on.map(|on| on.t.middle()));
        let point = oriented(surface.inspect_local(span, t), reversed);
        self.is_packed(hit, frame, local.slack, enclosure, &point)
    }

    fn is_packed(
        &self,
        hit: &Hit,
        frame: &PackedFrame,
        slack: f64,
        enclosure: &Enclosure,
        point: &SurfacePoint,
    ) -> Result<(), Difference> {
        if let Some(intervals) = enclosure.position {
            let s = ((point.derivatives.s - frame.origin) / frame.scale).to_array();
            let share = greatest(&intervals, s, slack);
            if share > 1.0 {
                let detail = words("the packed face is off; S in f64", &intervals, s);
                return Err(Difference::new(self.attribution.of_position(hit, share), share, detail));
            }
        }
        if let (Some(intervals), Normal::Regular(n)) = (enclosure.normal, point.normal) {
            let share = greatest(&intervals, n.to_array(), 0.0);
            if share > 1.0 {
                let detail = words("the packed face is off; the normal in f64", &intervals, n.to_array());
                return Err(Difference::new(Cause::Derivative, share, detail));
            }
        }
        if let (Some(intervals), Some(k)) = (enclosure.curvature, &point.curvature) {
            let k = [k.k1 * frame.scale, k.k2 * frame.scale];
            let share = greatest(&intervals, k, 0.0);
            if share > 1.0 {
                let detail = words("the packed face is off; k1, k2 in f64 (local)", &intervals, k);
                return Err(Difference::new(Cause::Curvature, share, detail));
            }
        }
        Ok(())
    }
}

/// Half the diagonal of the box that intervals make.
pub(crate) fn radius(intervals: &[Interval; 3]) -> f64 {
    intervals.iter().map(|x| (x.half_width + x.packing).powi(2)).sum::<f64>().sqrt()
}

/// A hit in its face's local coordinates.
struct Local {
    position: [f64; 3],
    curvature: Option<[f64; 2]>,
    /// What f64 may have lost of a coordinate.
    slack: f64,
}

impl Local {
    fn of(hit: &Hit, frame: &PackedFrame) -> Self {
        let farthest = frame.origin.abs().max_element() + hit.position.abs().max_element();
        Self {
            position: ((hit.position - frame.origin) / frame.scale).to_array(),
            curvature: hit.curvature.map(|PrincipalCurvatures { k1, k2 }| [k1, k2].map(|k| k * frame.scale)),
            slack: WIDENING * farthest / frame.scale,
        }
    }
}

/// The intervals that hold the model's own values: wide by what packing narrows and a share of the half-widths.
fn widened(enclosure: &Enclosure, kept: f64) -> Enclosure {
    let one = |x: Interval| Interval { half_width: kept * x.half_width + x.packing, ..x };
    let Enclosure { position, normal, curvature, .. } = *enclosure;
    Enclosure {
        position: position.map(|x| x.map(one)),
        normal: normal.map(|x| x.map(one)),
        curvature: curvature.map(|x| x.map(one)),
        ..*enclosure
    }
}

/// The greatest share of the coordinates, each of which f64 may have moved by `slack`.
fn greatest<const N: usize>(intervals: &[Interval; N], found: [f64; N], slack: f64) -> f64 {
    intervals.iter().zip(found).fold(0.0, |most: f64, (interval, x)| {
        let error = x - interval.middle;
        most.max(interval.share(interval.middle + error.signum() * (error.abs() - slack).max(0.0)))
    })
}

/// The coordinate that is farthest outside, in words.
fn words<const N: usize>(what: &str, intervals: &[Interval; N], found: [f64; N]) -> String {
    let excess = |k: usize| intervals[k].share(found[k]);
    let k = (0..N).max_by(|&a, &b| excess(a).total_cmp(&excess(b))).expect("coordinates");
    let Interval { middle, half_width, .. } = intervals[k];
    format!(
        "{what}[{k}] = {:.9e}, {:.3e} off the middle of its interval {middle:.9e} ± {half_width:.3e}",
        found[k],
        (found[k] - middle).abs()
    )
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

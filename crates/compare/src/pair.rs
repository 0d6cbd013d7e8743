//! One pixel of two buffers: geometry, visibility and coverage.

use crate::difference::Difference;
use crate::edge::EdgeFound;
use crate::evaluation::Evaluated;
use crate::report::PixelUse;
use crate::seams::Nearby;
use crate::setting::Setting;
use crate::{ATTRIBUTE_ULPS, Cause, Deviation, Sampler, Shares, Unbounded};
use gbuffer::{GBuffer, Hit};
use glam::{DVec2, DVec3};
use pipeline::sight::NEAR_PX;
use scene::FaceId;
use std::f64::consts::SQRT_2;
use std::iter::once;

/// Directions in which a sampler is asked around a pixel.
const DIRECTIONS: usize = 16;

/// Rounding of the depths that a depth test compares, in units of 2⁻²⁴ of the distance and the model's size: half an
/// ulp each of z, of 1 / w, of their product and of the interpolation between corners, on either side.
const DEPTH_ULPS: f64 = 4.0;

/// Where depths are rounded by more than this share of the model's size, a person would see that other layers are shown; as
/// nobody can tell whether they may be, there is no verdict on a pixel that shows one.
const LAYERS_SHARE: f64 = 1e-3;

/// Cells along the sides of the grid on which a sampler is asked where the rings show nothing alike.
const GRID: usize = 48;

/// Steps of the search for the place of a border that is nearest in the picture: it only has to come within the radius that
/// is asked about, and its steps shrink quadratically along a border that is smooth.
const BORDER_STEPS: u32 = 4;

/// What was found at a pixel.
pub(crate) enum Finding {
    /// Nobody covers it.
    Uncovered,
    /// The two agree.
    Agrees(Agreement),
    /// It has no verdict; why, in words too.
    Unbounded(Unbounded, String),
    /// They differ.
    Differs(Difference),
}

impl Finding {
    /// What the pixel uses of what it is allowed; `None` where nobody covers it.
    pub fn used(&self) -> Option<PixelUse> {
        match self {
            Self::Uncovered => None,
            Self::Unbounded(..) => Some(PixelUse::default()),
            Self::Differs(Difference { cause, excess, .. }) => {
                Some(PixelUse { share: Some(*excess as f32), cause: Some(*cause) })
            }
            Self::Agrees(found) => {
                let Shares { position, normal, curvature, .. } = found.shares;
                let across = Some(found.across_px / found.bound_px).filter(|share| share.is_finite());
                let shares = [across, position, normal, curvature].into_iter().flatten();
                Some(PixelUse { share: Some(shares.fold(0.0, f64::max) as f32), cause: None })
            }
        }
    }
}

/// Why a pixel does not agree.
enum Failed {
    Unbounded(Unbounded, String),
    Differs(Difference),
}

impl From<Difference> for Failed {
    fn from(difference: Difference) -> Self {
        Self::Differs(difference)
    }
}

/// What a pixel is allowed, by what it comes of, pixels.
#[derive(Debug, Clone, Copy)]
struct Bound {
    chord: f64,
    attribute: f64,
    snap: f64,
    rounding: f64,
    /// A part of the chord.
    stand_in: f64,
    /// What counts across the ray: all of it but the rounding, by which the values are judged.
    across: f64,
    /// All of it.
    whole: f64,
}

/// What was found at a pixel that agrees.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Agreement {
    pub across_px: f64,
    /// What counts across the ray.
    pub bound_px: f64,
    /// The same with the rounding of S.
    pub whole_bound_px: f64,
    pub along: f64,
    pub shares: Shares,
    /// The candidate's trim edge, where it was judged.
    pub edge: Option<EdgeFound>,
}

/// The view of one pair of buffers.
pub(crate) struct Pair<'a, 'm> {
    pub setting: &'a Setting<'m>,
    /// What the candidate draws in the model's place.
    pub drawn: Option<&'a Setting<'m>>,
    pub reference: &'a GBuffer,
    pub candidate: &'a GBuffer,
    pub sampler: &'a dyn Sampler,
    pub deviation: &'a Deviation,
    /// Whether the reference shows at every position the surface point on that very ray.
    pub exact: bool,
}

impl Pair<'_, '_> {
    /// The position of a pixel's centre.
    pub fn center(x: usize, y: usize) -> DVec2 {
        DVec2::new(x as f64 + 0.5, y as f64 + 0.5)
    }

    pub fn pixel(&self, x: usize, y: usize) -> Finding {
        let center = Self::center(x, y);
        let found = match (self.reference.get(x, y), self.candidate.get(x, y)) {
            (None, None) => return Finding::Uncovered,
            (reference, Some(candidate)) => self.shown(center, reference, candidate),
            (Some(reference), None) => self.absent(center, reference),
        };
        let difference = match found {
            Ok(found) => return Finding::Agrees(found),
            Err(Failed::Unbounded(reason, detail)) => return Finding::Unbounded(reason, detail),
            Err(Failed::Differs(difference)) => difference,
        };
        // What a reference says of itself counts only where it is a ray caster, asked here and now.
        let cause = if self.exact && self.reference.is_undecided(x, y) {
            Cause::Undecided
        } else if self.candidate.is_undecided(x, y) || self.may_lack_answers() && self.reference.is_undecided(x, y) {
            Cause::NewtonNotConverged
        } else {
            difference.cause
        };
        Finding::Differs(Difference { cause, ..difference })
    }

    /// Whether both renderers are of this program, and say where their searches end without an answer.
    fn may_lack_answers(&self) -> bool {
        self.deviation.unanswered_share > 0.0
    }

    /// The cause where the candidate does not show the nearest surface, `hidden`: that of a trimmed face was taken for cut
    /// away; one that solves for the surface at each pixel missed a root, whether it then found a farther one or none;
    /// another cause, `otherwise`, for triangles.
    fn unseen(&self, hidden: &Hit, otherwise: Cause) -> Cause {
        if self.setting.model.region(hidden.face).is_some() {
            return Cause::Trim;
        }
        if self.deviation.is_searched { Cause::MissedRoot } else { otherwise }
    }

    /// The candidate's trim edge, where it was asked for one.
    fn edge(&self, center: DVec2, candidate: &Hit) -> Result<Option<EdgeFound>, Difference> {
        if self.candidate.has_edges() { self.setting.edge(candidate, center) } else { Ok(None) }
    }

    /// A hit's values at its own (u, v): those of the surface, or what triangles carry.
    pub fn evaluated(&self, center: DVec2, candidate: &Hit) -> Result<Evaluated, Difference> {
        let Some(drawn) = self.drawn else { return self.evaluated_on(self.setting, center, candidate) };
        let found = self.evaluated_on(drawn, center, candidate)?;
        let own = without_local(candidate);
        let carried = if self.deviation.vertex_normals.is_some() { self.edge_chord(&own) } else { 0.0 };
        match self.stand_in(&own) {
            0.0 => Ok(found),
            error => self.setting.stood_for(&own, found, error + carried),
        }
    }

    fn evaluated_on(&self, setting: &Setting, center: DVec2, candidate: &Hit) -> Result<Evaluated, Difference> {
        match &self.deviation.vertex_normals {
            None => setting.evaluation(candidate),
            Some(normals) => {
                let face = candidate.face.0 as usize;
                let own = if self.drawn.is_some() { without_local(candidate) } else { *candidate };
                let of = |piece| self.deviation.attribute_at(face, piece);
                let interpolated = self.setting.pieces(&own).map(of).fold(0.0, f64::max);
                let chord = self.edge_chord(&own) + interpolated;
                // Of the candidate's own corners: a reference that snaps, too, changes nothing of what they carry.
                setting.carried(candidate, center, normals, chord, self.deviation.corners_px)
            }
        }
    }

    /// How far what is drawn is from the model at a hit, model units.
    fn stand_in(&self, hit: &Hit) -> f64 {
        if self.deviation.stand_in.is_empty() {
            return 0.0;
        }
        let face = hit.face.0 as usize;
        self.setting.pieces(hit).map(|piece| self.deviation.stand_in_at(face, piece)).fold(0.0, f64::max)
    }

    /// [`Deviation::edge_px`], and what edges move in the picture where another model is drawn.
    fn edge_px(&self, hit: &Hit) -> f64 {
        if self.deviation.stand_in.is_empty() {
            return self.deviation.edge_px;
        }
        let s = self.setting.surface_point(hit);
        self.deviation.edge_px + self.setting.camera.pixels_within(self.setting.viewport, s, self.stand_in(hit))
    }

    /// A pixel that the candidate covers.
    ///
    /// How far away it is follows from its own (u, v), whatever distance it states: that is judged last.
    fn shown(&self, center: DVec2, reference: Option<&Hit>, candidate: &Hit) -> Result<Agreement, Failed> {
        let holds = |setting: &Setting, hit: &Hit| {
            setting.holds_parameters(hit).map_err(|(reason, detail)| Failed::Unbounded(reason, detail))
        };
        holds(self.drawn.unwrap_or(self.setting), candidate)?;
        let Evaluated { shares, radius } = self.evaluated(center, candidate)?;
        // Its spans are those of what it draws.
        let own = self.drawn.map(|_| without_local(candidate));
        if let Some(own) = &own {
            holds(self.setting, own)?;
        }
        let candidate = own.as_ref().unwrap_or(candidate);
        let s = self.setting.surface_point(candidate);
        let ray = self.setting.camera.ray(self.setting.viewport, center.x, center.y);
        let along_ray = |s: DVec3| (s - ray.origin).dot(ray.direction);
        let stated = candidate;
        let candidate = &Hit { t: along_ray(s), ..*stated };
        // A ray caster that was asked here and now is believed.
        let seen = |r: &Hit| if self.exact { r.t } else { along_ray(self.setting.surface_point(r)) };
        let reference = reference.map(|r| Hit { t: seen(r), ..*r });
        let reference = reference.as_ref();
        let bound = self.bound_of_shown(candidate, s, radius);
        self.check_bound(&bound)?;
        let bound_px = bound.across;
        let at_edge = self.setting.trimming(candidate, center, self.edge_px(candidate))?;
        let shares = Shares { ambiguous: at_edge || shares.ambiguous, ..shares };
        // Along the ray: the chord on either side, what rounding of S itself was, and that of the depths compared.
        let depth = DEPTH_ULPS / (1u64 << 24) as f64 * (candidate.t.abs() + self.setting.size);
        let rounded = candidate.position.distance(s);
        let slack = 2.0 * self.model_units(candidate) + 2.0 * rounded + depth;
        let in_front = self.setting.camera.depth(s) >= self.setting.camera.near() - slack;
        let picture = self.setting.picture(s).filter(|_| in_front);
        let is_apart = |r: &Hit| (r.t - candidate.t).abs() > slack - depth + 2.0 * self.model_units(r);
        if depth > LAYERS_SHARE * self.setting.size && reference.is_some_and(is_apart) {
            let detail = format!("depths are rounded by {depth:.3e}, and another layer is seen than is shown");
            return Err(Failed::Unbounded(Unbounded::Rounding, detail));
        }
        let same = reference.filter(|r| r.face == candidate.face && (r.t - candidate.t).abs() <= slack);
        let along = same.map_or(0.0, |r| (r.t - candidate.t).abs());
        // Geometry.
        let target = match same {
            Some(r) if !self.exact => self.setting.picture(self.setting.surface_point(r)),
            _ => Some(center),
        };
        let across_px = match (picture, target) {
            (Some(a), Some(b)) => a.distance(b),
            _ => f64::INFINITY,
        };
        let whole_bound_px = bound.whole;
        let agreement = Agreement { across_px, bound_px, whole_bound_px, along, shares, edge: None };
        // S as the candidate rounded it, and what a renderer loses that subtracts and adds up in f32.
        let with_distance = || {
            let (off, allowed) = ((stated.t - candidate.t).abs(), rounded + 2.0 * depth);
            if off <= allowed {
                return match shares.unbounded {
                    None => Ok(Agreement { edge: self.edge(center, stated)?, ..agreement }),
                    Some(reason) => Err(Failed::Unbounded(reason, reason.label().to_owned())),
                };
            }
            let (is, should) = (stated.t, candidate.t);
            let detail = format!("t = {is:.9e}, but S is {should:.9e} along the ray; {allowed:.3e} are allowed");
            Err(Difference::new(Cause::Distance, off / allowed, detail).into())
        };
        if same.is_some() && across_px <= bound_px {
            return with_distance();
        }
        if self.exact {
            if across_px > bound_px {
                return Err(self.misplaced(candidate, center, across_px, bound_px).into());
            }
        } else if !self.is_drawn_nearby(center, bound_px, reference, candidate, slack)
            && !self.is_beyond_an_edge(center, bound_px, reference, candidate, s, slack)
        {
            let cause = match reference {
                None => Cause::Coverage,
                Some(r) if r.face == candidate.face => Cause::Interpolation,
                Some(r) if r.t < candidate.t => self.unseen(r, Cause::Depth),
                Some(_) => Cause::Coverage,
            };
            let detail = format!("nothing within {bound_px:.4} px in the reference is like it");
            return Err(Difference::new(cause, across_px / bound_px, detail).into());
        }
        // The sampler may show more than the reference's buffer does: a hole in that is a difference, too.
        if reference.is_none() && !self.exact {
            self.missing(center, candidate)?;
        }
        // Visibility.
        let hides = |r: &&Hit| r.t < candidate.t - slack - 2.0 * self.model_units(r);
        let Some(occluder) = reference.filter(hides) else { return with_distance() };
        let behind = |hit: &Hit| hit.t >= candidate.t - slack;
        let own =
            picture.filter(|_| self.exact).is_some_and(|p| self.sampler.first(p.x, p.y).as_ref().is_none_or(behind));
        // Beyond the edge of its triangle a point may fall behind the next one of its face by as much as both are off; and where that is
        // seen edge-on by more, but the pixel's own ray meets its sheet where the other one is.
        let behind_own_face = || {
            let reach = slack + 2.0 * self.edge_chord(candidate);
            let is_its_sheet = |t: f64| (t - occluder.t).abs() <= reach;
            !self.exact
                && occluder.face == candidate.face
                && (candidate.t - occluder.t <= reach
                    || self.setting.sheet_at(candidate, center).is_some_and(is_its_sheet))
        };
        let bound = bound_px.max(self.bound_at(occluder).across);
        let hiding = || once(*occluder).chain(self.layers(center)).filter(|q| hides(&q));
        if own
            || behind_own_face()
            || self.borders(occluder, center, bound).ends
            || self.passes_by(occluder, center, bound, &|at, first| {
                first.is_none_or(|q| behind(q) || self.leans_into_view(candidate, occluder, at, q, slack))
            })
            || self.exact && self.each_ends_nearby(hiding(), center, bound_px, &|q| !behind(q))
        {
            return with_distance();
        }
        let detail =
            format!("shown at t = {:.6}, but face {} at t = {:.6} hides it", candidate.t, occluder.face.0, occluder.t);
        Err(Difference::new(self.unseen(occluder, Cause::Depth), (candidate.t - occluder.t) / slack, detail).into())
    }

    /// Whether what is seen at a position beside the pixel is the candidate's own sheet, which leans and so is nearer there than
    /// at the pixel: no farther than half way to what hides it, or it would be the sheet that hides, come round a fold.
    fn leans_into_view(&self, candidate: &Hit, occluder: &Hit, at: DVec2, seen: &Hit, slack: f64) -> bool {
        if seen.face != candidate.face {
            return false;
        }
        let Some(sheet) = self.setting.sheet_at(candidate, at) else { return false };
        (seen.t - sheet).abs() <= slack && sheet - slack > 0.5 * (candidate.t + occluder.t)
    }

    /// A pixel that only the reference covers.
    fn absent(&self, center: DVec2, reference: &Hit) -> Result<Agreement, Failed> {
        let bound = self.bound_at(reference);
        self.check_bound(&bound)?;
        self.missing(center, reference)?;
        Ok(Agreement { whole_bound_px: bound.whole, ..Agreement::default() })
    }

    /// No verdict where a pixel is allowed too much, by what most of it comes of.
    fn check_bound(&self, bound: &Bound) -> Result<(), Failed> {
        // The distance of a model in place of another is given, and no reason not to judge.
        let (whole, limit) = (bound.whole, self.deviation.limit_px + bound.stand_in);
        if whole < limit {
            return Ok(());
        }
        let Bound { chord, attribute, snap, rounding, .. } = *bound;
        let parts = [(chord, Unbounded::Chord), (attribute, Unbounded::Interpolation), (rounding, Unbounded::Rounding)];
        let (_, reason) = parts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("three parts");
        let detail = format!(
            "bound {whole:.4} px, where less than {limit:.4} px was asked for: triangles {chord:.4}, \
             interpolated (u, v) {attribute:.4}, snapping {snap:.4}, rounding of S {rounding:.4}"
        );
        Err(Failed::Unbounded(reason, detail))
    }

    /// Whether a pixel where one shows a hit, given as the reference, and the other nothing, is beside an edge.
    fn missing(&self, center: DVec2, reference: &Hit) -> Result<(), Difference> {
        let bound = self.bound_at(reference).across;
        // Two rasterizers may each leave a crack between faces that do not meet vertex on vertex.
        let Nearby { ends, beyond } = self.borders(reference, center, bound);
        let is_other = |face: FaceId| face != reference.face && !beyond.contains(&face);
        let is_edge = |first: Option<&Hit>| first.is_none_or(|q| !self.exact && is_other(q.face));
        let missing = || once(*reference).chain(self.layers(center));
        if ends
            || self.passes_by(reference, center, bound, &|_, first| is_edge(first))
            || self.exact && self.each_ends_nearby(missing(), center, 0.0, &|_| true)
        {
            return Ok(());
        }
        let detail = format!("face {} is not shown, and no edge is within {bound:.4} px", reference.face.0);
        Err(Difference::new(self.unseen(reference, Cause::Coverage), f64::INFINITY, detail))
    }

    /// S at the candidate's (u, v) is not on the pixel's ray: are u and v exchanged, or was interpolation wrong?
    fn misplaced(&self, candidate: &Hit, center: DVec2, across_px: f64, bound_px: f64) -> Difference {
        let surface = self.setting.model.surface(candidate.face);
        let [[u0, u1], [v0, v1]] = surface.domain();
        let [s, t] = [(candidate.uv.x - u0) / (u1 - u0), (candidate.uv.y - v0) / (v1 - v0)];
        let exchanged = self.setting.picture(surface.point(u0 + (u1 - u0) * t, v0 + (v1 - v0) * s));
        let cause = match exchanged {
            Some(p) if p.distance(center) <= bound_px => Cause::Parameters,
            _ => Cause::Interpolation,
        };
        let detail = format!("S(u, v) projects {across_px:.4} px from the pixel's centre, bound {bound_px:.4} px");
        Difference::new(cause, across_px / bound_px, detail)
    }

    /// The allowance at what the reference shows.
    fn bound_at(&self, hit: &Hit) -> Bound {
        self.bound_of(hit, self.setting.surface_point(hit), 0.0)
    }

    /// The allowance for what a candidate shows at its own parameters, S being there and known to `radius`. A bounded face's
    /// triangles go on beyond the domain's border as a skirt, and the face covers a little more than it is: what they show
    /// is the border's point, as far from there as the border bulges. That is the rule's doing, and not a loose bound.
    fn bound_of_shown(&self, candidate: &Hit, s: DVec3, radius: f64) -> Bound {
        let bound = self.bound_of(candidate, s, radius);
        let [[u0, u1], [v0, v1]] = self.setting.model.surface(candidate.face).domain();
        let DVec2 { x: u, y: v } = candidate.uv;
        let is_bounded = self.setting.model.region(candidate.face).is_some();
        if is_bounded && self.deviation.has_skirts && (u == u0 || u == u1 || v == v0 || v == v1) {
            Bound { across: 2.0 * bound.across + SQRT_2 * f64::from(NEAR_PX), ..bound }
        } else {
            bound
        }
    }

    /// The allowance across the ray for a point of a face that is at `position`, and known to `radius`.
    fn bound_of(&self, hit: &Hit, position: DVec3, radius: f64) -> Bound {
        let seen = |radius: f64| self.setting.camera.pixels_within(self.setting.viewport, position, radius);
        let face = hit.face.0 as usize;
        let greatest = |of: &dyn Fn(usize) -> f64| self.setting.pieces(hit).map(of).fold(0.0, f64::max);
        let snap = self.deviation.snap_px;
        let across = seen(self.model_units(hit)) + snap;
        Bound {
            chord: seen(greatest(&|piece| self.deviation.chord_at(face, piece))),
            attribute: seen(greatest(&|piece| self.deviation.attribute_at(face, piece))),
            snap,
            rounding: seen(radius),
            stand_in: seen(self.stand_in(hit)),
            across,
            whole: across + seen(radius),
        }
    }

    /// The allowance along the ray and across it without snapping, on the Bézier pieces that a hit may belong to, model units.
    fn model_units(&self, hit: &Hit) -> f64 {
        let face = hit.face.0 as usize;
        let of = |piece| self.deviation.chord_at(face, piece) + self.deviation.attribute_at(face, piece);
        self.setting.pieces(hit).map(of).fold(0.0, f64::max)
    }

    /// The chord at an edge of the triangles there, model units.
    fn edge_chord(&self, hit: &Hit) -> f64 {
        let face = hit.face.0 as usize;
        self.setting.pieces(hit).map(|piece| self.deviation.edge_chord_at(face, piece)).fold(0.0, f64::max)
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
            layers.iter().any(|q| self.is_like(q, candidate, 2.0 * bound_px / GRID as f64, slack))
                || self.is_between(&layers, candidate, slack)
        };
        if draws(&mut self.places(center, bound_px, reference.or(Some(candidate)))) {
            return true;
        }
        let steps = (0..=GRID).map(|i| 2.0 * i as f64 / GRID as f64 - 1.0);
        let grid = steps.clone().flat_map(|x| steps.clone().map(move |y| DVec2::new(x, y)));
        draws(&mut grid.filter(|offset| offset.length() <= 1.0).map(|offset| center + bound_px * offset))
    }

    /// Whether an edge of the drawing passes within the bound, of a face or of a fold, where depth leaps by more than
    /// `slack`, or a trim edge as near the candidate as the two may mistake sides; and the candidate's point `s` is as near to the pixel's ray as the chord allows: it was interpolated
    /// beyond its triangle.
    fn is_beyond_an_edge(
        &self,
        center: DVec2,
        bound_px: f64,
        reference: Option<&Hit>,
        candidate: &Hit,
        s: DVec3,
        slack: f64,
    ) -> bool {
        let radius = self.edge_chord(candidate) + self.model_units(candidate);
        let chord_px = self.setting.camera.pixels_within(self.setting.viewport, s, radius) + self.deviation.snap_px;
        let is_other = |q: Option<Hit>| match (q, reference) {
            (Some(q), Some(r)) => q.face != r.face || (q.t - r.t).abs() > slack,
            (q, r) => q.is_some() != r.is_some(),
        };
        self.setting.picture(s).is_some_and(|p| p.distance(center) <= chord_px)
            && (self.setting.is_at_edge(candidate, center, self.edge_px(candidate), bound_px)
                || self.around(center, bound_px, reference.or(Some(candidate))).any(is_other))
    }

    /// All that the reference draws at a position.
    fn layers(&self, at: DVec2) -> Vec<Hit> {
        self.sampler.layers(at.x, at.y)
    }

    /// Whether the face of each of these hits ends within the bound, of at least `bound_px`, as far as it is in the way: there may be
    /// no place nearby that is beyond all of them.
    fn each_ends_nearby(
        &self,
        mut hits: impl Iterator<Item = Hit>,
        center: DVec2,
        bound_px: f64,
        is_in_the_way: &dyn Fn(&Hit) -> bool,
    ) -> bool {
        hits.all(|hit| {
            let bound = bound_px.max(self.bound_at(&hit).across);
            // A neighbour with a border in common goes on where the face ends.
            let Nearby { ends, beyond } = self.borders(&hit, center, bound);
            let is_other = |q: &Hit| q.face != hit.face && !beyond.contains(&q.face);
            let is_past = |p, _: Option<&Hit>| self.layers(p).iter().all(|q| is_other(q) || !is_in_the_way(q));
            ends || self.passes_by(&hit, center, bound, &is_past)
        })
    }

    /// Whether, at a position within the bound, the reference sees past the point of `hit`: `is_past` holds of the position and of
    /// what is seen there.
    ///
    /// Where loops bound the face, and it is another one that is seen there, its surface must end before that position, in a
    /// fold or at the domain's border, which seen edge-on a chord may fall short of: a trim edge inside is no silhouette.
    fn passes_by(&self, hit: &Hit, center: DVec2, bound: f64, is_past: &dyn Fn(DVec2, Option<&Hit>) -> bool) -> bool {
        let is_bounded = self.setting.model.region(hit.face).is_some();
        self.places(center, bound, Some(hit)).any(|p| {
            let first = self.sampler.first(p.x, p.y);
            let is_other = || first.is_none_or(|q| q.face != hit.face);
            is_past(p, first.as_ref()) && !(is_bounded && is_other() && self.setting.goes_on_at(hit, p))
        })
    }

    /// Whether a sample shows the candidate's point: same face, same place in the picture, within `step_px`, and in depth. A sample is
    /// itself as far away as the two may be apart, so that it may be no farther off than samples are from each other.
    fn is_like(&self, q: &Hit, candidate: &Hit, step_px: f64, slack: f64) -> bool {
        if q.face != candidate.face {
            return false;
        }
        let [a, b] = [q, candidate].map(|hit| self.setting.picture(self.setting.surface_point(hit)));
        let near = a.zip(b).is_some_and(|(a, b)| a.distance(b) <= step_px);
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
        let [u, v] = self.setting.model.surface(candidate.face).domain().map(|[start, end]| end - start);
        let margin = DVec3::new(u * ATTRIBUTE_ULPS / 2f64.powi(24), v * ATTRIBUTE_ULPS / 2f64.powi(24), slack);
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
        let camera = self.setting.camera;
        let across = hit
            .and_then(|hit| hit.normal.unit())
            .map_or(DVec2::ZERO, |n| DVec2::new(n.dot(camera.right()), -n.dot(camera.above())).normalize_or_zero());
        let ring = (0..DIRECTIONS).map(|i| DVec2::from_angle(std::f64::consts::TAU * i as f64 / DIRECTIONS as f64));
        let offsets = [DVec2::ZERO, across, -across, 0.75 * across, -0.75 * across, 0.5 * across, -0.5 * across];
        let offsets = offsets.into_iter().chain(ring.flat_map(|d| [d, 0.5 * d]));
        offsets.map(move |offset| center + radius * offset)
    }

    /// What there is of the borders of a hit's face within `radius` pixels of a position; where loops bound the face, within
    /// [`Deviation::edge_px`]. Where the near plane cuts it there, it ends.
    fn borders(&self, hit: &Hit, center: DVec2, radius: f64) -> Nearby {
        let beyond_near = self.setting.camera.depth(self.setting.surface_point(hit)) - self.setting.camera.near();
        if beyond_near <= self.model_units(hit) {
            return Nearby::END;
        }
        if self.setting.model.region(hit.face).is_some() {
            let ends = self.setting.is_at_edge(hit, center, self.edge_px(hit), radius);
            return Nearby { ends, ..Nearby::default() };
        }
        let mut nearby = Nearby::default();
        for side in 0..4 {
            let Some((along, reach)) = self.border_place(hit, side, center, radius) else { continue };
            let spans = self.setting.spans_within(hit.face, side, [along - reach, along + reach]);
            let beyond = |span: usize| self.deviation.seams.beyond(hit.face, side, span);
            // Where borders of several faces end, not all of these need meet.
            match spans.map(|spans| spans.map(beyond).collect::<Vec<_>>()) {
                Some(faces) if faces.iter().all(|beyond| !beyond.is_empty() && *beyond == faces[0]) => {
                    nearby.beyond.extend(faces[0]);
                }
                _ => return Nearby::END,
            }
        }
        nearby
    }

    /// Where a side of an untrimmed face, u = 0, u = 1, v = 0 or v = 1, passes within `radius` pixels of a position: the parameter along
    /// it, and how far along it may be within as much.
    fn border_place(&self, hit: &Hit, side: usize, center: DVec2, radius: f64) -> Option<(f64, f64)> {
        let surface = self.setting.model.surface(hit.face);
        let domain = surface.domain();
        let (across, along) = (side / 2, 1 - side / 2);
        let mut place = hit.uv;
        place[across] = domain[across][side % 2];
        // Slide along the border to where it is nearest in the picture.
        for _ in 0..BORDER_STEPS {
            let d = surface.first_derivatives(place.x, place.y);
            let at = self.setting.picture(d.s)?;
            let tangent = if along == 0 { d.su } else { d.sv };
            let direction = self.setting.camera.picture_derivative(self.setting.viewport, d.s, tangent);
            if at.distance(center) <= radius {
                return Some((place[along], 2.0 * radius / direction.length()));
            }
            let step = (center - at).dot(direction) / direction.length_squared();
            if !step.is_finite() {
                return None;
            }
            place[along] = (place[along] + step).clamp(domain[along][0], domain[along][1]);
        }
        None
    }
}

/// A hit whose local parameters are those of another model's spans.
fn without_local(hit: &Hit) -> Hit {
    Hit { local: None, ..*hit }
}

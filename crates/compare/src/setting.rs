//! What pictures are judged by: the model, who looks, and the faces as programs read them; and what follows from these about a
//! hit's own place.

use crate::attribution::Attribution;
use crate::unbounded::Unbounded;
use gbuffer::{Hit, LocalParameters};
use glam::{DVec2, DVec3};
use nurbs::{Direction, Surface};
use pipeline::{PackedScene, View};
use scene::{Camera, FaceId, Model, Viewport};
use std::ops::Range;

/// How far along a surface it is followed from where a candidate shows it, pixels were it seen at a right angle.
const FOLLOWED_PX: f64 = 8.0;

/// Steps of that search at most: it converges quadratically, but close by a fold.
const FOLLOWING_STEPS: u32 = 24;

/// An offset from a picture position that counts as none, pixels.
const FOUND_PX: f64 = 1e-7;

/// A model, seen.
pub(crate) struct Setting<'m> {
    pub(crate) model: &'m Model,
    pub(crate) camera: &'m Camera,
    pub(crate) viewport: Viewport,
    /// Diagonal of the model's box.
    pub(crate) size: f64,
    pub(crate) scene: &'m PackedScene,
    pub(crate) views: Vec<View>,
    pub(crate) attribution: Attribution<'m>,
    /// Of each surface, the knot spans in u and v that are not empty.
    spans: Vec<[Vec<usize>; 2]>,
}

impl<'m> Setting<'m> {
    pub(crate) fn new(model: &'m Model, camera: &'m Camera, viewport: Viewport, scene: &'m PackedScene) -> Self {
        let size = model.hull().diagonal();
        let attribution = Attribution::new(model);
        let views = scene.views(model, camera, viewport);
        let of_surface = |surface: &Surface| [Direction::U, Direction::V].map(|d| surface.knots(d).spans().collect());
        let spans = model.surfaces().iter().map(of_surface).collect();
        Self { model, camera, viewport, size, scene, views, attribution, spans }
    }

    /// Whether the surface that a hit shows is seen at another position, too, whether it has material there or not.
    pub(crate) fn goes_on_at(&self, hit: &Hit, at: DVec2) -> bool {
        self.seen_inside(hit, at).is_some()
    }

    /// How far along the ray of another position the surface is that a hit shows, whether it has material there or not.
    pub(crate) fn sheet_at(&self, hit: &Hit, at: DVec2) -> Option<f64> {
        let uv = self.seen_inside(hit, at)?;
        let ray = self.camera.ray(self.viewport, at.x, at.y);
        Some((self.model.surface(hit.face).point(uv.x, uv.y) - ray.origin).dot(ray.direction))
    }

    /// [`Self::seen_at`], inside the domain.
    fn seen_inside(&self, hit: &Hit, at: DVec2) -> Option<DVec2> {
        let [[u0, u1], [v0, v1]] = self.model.surface(hit.face).domain();
        let is_inside = |uv: &DVec2| (u0..=u1).contains(&uv.x) && (v0..=v1).contains(&uv.y);
        self.seen_at(hit, at).filter(is_inside)
    }

    /// Positive where u turns counterclockwise into v as the picture shows them.
    fn turn(&self, s: DVec3, derivatives: [DVec3; 2]) -> f64 {
        let [a, b] = derivatives.map(|along| self.camera.picture_derivative(self.viewport, s, along));
        b.perp_dot(a)
    }

    /// What parameters gain on a tangent plane by an offset in the picture, pixels.
    pub(crate) fn parameters_of(&self, s: DVec3, derivatives: [DVec3; 2], offset: DVec2) -> DVec2 {
        let [a, b] = derivatives.map(|along| self.camera.picture_derivative(self.viewport, s, along));
        DVec2::new(offset.perp_dot(b), a.perp_dot(offset)) / a.perp_dot(b)
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

    /// The nonempty knot spans, by their numbers, that a range of parameters along a side of a face's domain has to do with; `None` where it
    /// reaches an end of the side.
    pub(crate) fn spans_within(&self, face: FaceId, side: usize, [low, high]: [f64; 2]) -> Option<Range<usize>> {
        let along = 1 - side / 2;
        let knots = self.model.surface(face).knots([Direction::U, Direction::V][along]);
        let spans = &self.spans[self.model.faces()[face.0 as usize].surface][along];
        let (start, end) = knots.domain();
        // A reach that is no number is beyond every end.
        if !(start < low && high < end) {
            return None;
        }
        let first = spans.partition_point(|span| knots.knots()[span + 1] < low);
        Some(first..spans.partition_point(|span| knots.knots()[*span] <= high))
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

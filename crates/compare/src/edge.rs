//! Whether a hit's trim edge is where the picture has it: in f64, by the region's monotone pieces and the camera itself.

use crate::difference::Difference;
use crate::evaluation::radius;
use crate::setting::Setting;
use crate::{Cause, trim};
use gbuffer::{EDGE_REACH_PX, Hit};
use glam::{DMat2, DVec2};
use nurbs::{BezierCurve, Surface};
use pipeline::edge::{EDGE_ON, STEPS};
use pipeline::enclosure::enclose;
use pipeline::sight::NEAR_PX;
use scene::{Camera, Region, Viewport};

/// How far from a pixel's centre edges are looked at, pixels of the linear map at the hit.
const LOOKED_PX: f64 = 2.0 * EDGE_REACH_PX;

/// Halvings to the ends of the part of a piece that is as near.
const HALVINGS: u32 = 40;

/// Places on such a part at which a distance is taken before the least are looked at closely.
const SAMPLES: usize = 48;

/// What choosing among the first eight chords of a piece may cost that bends within a pixel, pixels.
///
/// Of an arc of radius r the program's reach holds a length of 4 at most, and a monotone piece a quarter turn: the first
/// chords are as long as ½ or π r / 16 and off the arc by 1 / 32 r or π² r / 2048, of which the lesser is below 1/64 for
/// any r. As much again is for maps that shear.
const CHORDS_PX: f64 = 1.0 / 32.0;

/// Roundings of a picture position, in units of 2⁻²⁴ of what its sums add up: narrowing of the matrix, four products
/// and sums, a division, the viewport.
const PICTURE_ULPS: f64 = 8.0;

/// What was found of an edge that is as it may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeFound {
    /// How far it is from the nearest place of an edge, or farther than it, pixels.
    pub off_px: f64,
    /// How far it may be.
    pub bound_px: f64,
}

/// The picture about a hit: the true one, and the linear one by the derivatives at the hit's own (u, v).
struct About<'a> {
    surface: &'a Surface,
    camera: &'a Camera,
    viewport: Viewport,
    /// The pixel's centre.
    center: DVec2,
    uv: DVec2,
    /// Of S at the hit, from the centre.
    offset: DVec2,
    /// What u and v add to it.
    slopes: DMat2,
}

/// A part of a piece.
struct Part<'a> {
    curve: &'a BezierCurve,
    ends: [f64; 2],
}

impl Setting<'_> {
    /// Checks the edge of a hit of the pixel with its centre at `center`; `None` where the hit records none rightly, or is
    /// seen edge-on so that none can be asked for.
    ///
    /// # Errors
    /// Where there is no edge at the recorded place, a nearer one, or one where none is recorded.
    pub(crate) fn edge(&self, hit: &Hit, center: DVec2) -> Result<Option<EdgeFound>, Difference> {
        let wrong = |excess: f64, detail: String| Err(Difference::new(Cause::Trim, excess, detail));
        let Some(region) = self.model.trimmed_region(hit.face) else {
            return match hit.edge {
                None => Ok(None),
                Some(_) => wrong(f64::INFINITY, format!("an edge of face {}, which is whole", hit.face.0)),
            };
        };
        let Some(about) = self.about(hit, center) else { return Ok(None) };
        let parts = about.parts(region);
        if parts.is_empty() {
            return match hit.edge {
                None => Ok(None),
                Some(edge) => wrong(f64::INFINITY, format!("an edge at {edge} px, and none is near")),
            };
        }
        let band = self.edge_band_px(hit, region, &about);
        // By its linear map the program finds some place; in the picture that is farther off the centre by the map's error
        // there than by the map, and the nearest place was nearer by the map's error at that.
        let (nearest, _) = about.least(&parts, |uv| about.true_offset(uv).length() + about.bend(uv));
        let (by_map, shown) = about.least(&parts, |uv| about.linear_offset(uv).length());
        let bent = about.greatest_bend(&parts, by_map + band + CHORDS_PX).max(about.bend(shown));
        let bound = band + CHORDS_PX + bent;
        let Some(edge) = hit.edge else {
            return if EDGE_REACH_PX <= nearest + bound {
                Ok(None)
            } else {
                let missed = EDGE_REACH_PX - nearest;
                wrong(missed / bound, format!("no edge, and one passes within {nearest:.5} px; bound {bound:.5}"))
            };
        };
        let (aside, _) = about.least(&parts, |uv| about.true_offset(uv).distance(edge));
        // Where the centre is a little beyond the edge, that is recorded as far on the other side.
        let near = f64::from(NEAR_PX);
        let place = if edge.length() <= near + band { band + 2.0 * near } else { band };
        let farther = edge.length() - nearest.min(EDGE_REACH_PX);
        if aside > place || !aside.is_finite() {
            return wrong(aside / place, format!("no edge at {edge} px but {aside:.5} px aside; bound {place:.5}"));
        }
        if farther > bound {
            return wrong(
                farther / bound,
                format!("an edge at {edge} px, and one within {nearest:.5}; bound {bound:.5}"),
            );
        }
        Ok(Some(EdgeFound { off_px: aside.max(farther), bound_px: bound }))
    }

    /// The picture about a hit; `None` where it is behind the eye, or seen edge-on.
    fn about(&self, hit: &Hit, center: DVec2) -> Option<About<'_>> {
        let (camera, viewport, surface) = (self.camera, self.viewport, self.model.surface(hit.face));
        let d = surface.first_derivatives(hit.uv.x, hit.uv.y);
        let offset = camera.picture(viewport, d.s)? - center;
        let along = |derivative| camera.picture_derivative(viewport, d.s, derivative);
        let slopes = DMat2::from_cols(along(d.su), along(d.sv));
        let edge_on = 2.0 * f64::from(EDGE_ON) * slopes.x_axis.length() * slopes.y_axis.length();
        let seen = edge_on < slopes.determinant().abs();
        seen.then_some(About { surface, camera, viewport, center, uv: hit.uv, offset, slopes })
    }

    /// How far off an edge the fragment program may place it in the picture, pixels: what f32 leaves of the curves' places
    /// in (u, v), of S, of its picture, and what the recording rounds.
    fn edge_band_px(&self, hit: &Hit, region: &Region, about: &About) -> f64 {
        let frame = &self.scene.frames()[hit.face.0 as usize];
        let size = frame.edge_band * region.domain().size();
        let curves = size.x * about.slopes.x_axis.length() + size.y * about.slopes.y_axis.length();
        let enclosures = enclose(self.scene, hit.face.0, &frame.known(hit), false);
        let widths = enclosures.iter().filter_map(|e| e.position).map(|s| radius(&s) * frame.scale);
        let s = self.surface_point(hit);
        let rounded = self.camera.pixels_within(self.viewport, s, widths.fold(0.0, f64::max));
        let m = &self.views[hit.face.0 as usize].clip_from_local;
        let local = (s - frame.origin) / frame.scale;
        let terms = |row: usize| {
            let of = |k: usize, x: f64| (f64::from(m[k][row]) * x).abs();
            of(0, local.x) + of(1, local.y) + of(2, local.z) + of(3, 1.0)
        };
        let w = (0..3).map(|k| f64::from(m[k][3]) * local[k]).sum::<f64>() + f64::from(m[3][3]);
        let half = 0.5 * self.viewport.width().max(self.viewport.height()) as f64;
        let sums = 1.0 + (terms(0).max(terms(1)) + terms(3)) / w;
        let picture = PICTURE_ULPS / (1u64 << 24) as f64 * half * sums;
        let steps = std::f64::consts::FRAC_1_SQRT_2 / f64::from(STEPS);
        curves + rounded + picture + steps
    }
}

impl About<'_> {
    /// Where the picture has a point, from the centre.
    fn true_offset(&self, uv: DVec2) -> DVec2 {
        let s = self.surface.point(uv.x, uv.y);
        self.camera.picture(self.viewport, s).map_or(DVec2::INFINITY, |p| p - self.center)
    }

    /// Where the linear map has it.
    fn linear_offset(&self, uv: DVec2) -> DVec2 {
        self.offset + self.slopes * (uv - self.uv)
    }

    /// How far apart the two are.
    fn bend(&self, uv: DVec2) -> f64 {
        self.true_offset(uv).distance(self.linear_offset(uv))
    }

    /// The parts of the edges that are near the centre by the linear map.
    fn parts<'r>(&self, region: &'r Region) -> Vec<Part<'r>> {
        let per_pixel = self.slopes.inverse();
        let extent = LOOKED_PX * DVec2::new(per_pixel.row(0).length(), per_pixel.row(1).length());
        let center = self.uv - per_pixel * self.offset;
        let (low, high) = (center - extent, center + extent);
        let part = |curve: &'r BezierCurve| {
            let [start, end] = [curve.start(), curve.end()];
            let (least, greatest) = (start.min(end), start.max(end));
            (low.cmple(greatest).all() && least.cmple(high).all()).then(|| {
                // Along a monotone piece the box is entered once and left once.
                let beyond = |uv: DVec2, k: usize, ahead: bool| {
                    let rises = start[k] <= end[k];
                    if rises == ahead { high[k] < uv[k] } else { uv[k] < low[k] }
                };
                let passed = |t: f64, ahead: bool| {
                    let uv = curve.point(t);
                    beyond(uv, 0, ahead) || beyond(uv, 1, ahead)
                };
                let (mut first, mut within) = (0.0, 1.0);
                let (mut inside, mut last) = (0.0, 1.0);
                for _ in 0..HALVINGS {
                    let t = 0.5 * (first + within);
                    if passed(t, false) {
                        first = t
                    } else {
                        within = t
                    }
                    let t = 0.5 * (inside + last);
                    if passed(t, true) { last = t } else { inside = t }
                }
                Part { curve, ends: [first, last.max(first)] }
            })
        };
        region.edges().filter_map(|piece| part(&piece.curve)).collect()
    }

    /// The most by which the linear map is off an edge that it shows within `reach` pixels.
    fn greatest_bend(&self, parts: &[Part], reach: f64) -> f64 {
        let places = parts.iter().flat_map(|part| part.places().map(|t| part.curve.point(t)));
        let near = places.filter(|uv| self.linear_offset(*uv).length() <= reach);
        near.map(|uv| self.bend(uv)).fold(0.0, f64::max)
    }

    /// The least of a function of (u, v) on the parts, of which there are some, and where it is.
    fn least(&self, parts: &[Part], of: impl Fn(DVec2) -> f64) -> (f64, DVec2) {
        let all = parts.iter().map(|part| part.least(&of));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).expect("there is a part")
    }
}

impl Part<'_> {
    fn places(&self) -> impl Iterator<Item = f64> {
        let [start, end] = self.ends;
        (0..=SAMPLES).map(move |i| start + (end - start) * i as f64 / SAMPLES as f64)
    }

    /// The least of a function of (u, v) along the part, and where it is.
    fn least(&self, of: &impl Fn(DVec2) -> f64) -> (f64, DVec2) {
        let (value, t) = trim::least(|t| of(self.curve.point(t)), self.ends, SAMPLES);
        (value, self.curve.point(t))
    }
}

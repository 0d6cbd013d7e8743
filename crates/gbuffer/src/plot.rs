//! Numbers of a surface in colours: curvatures, radii and draft, with a scale that is said in numbers.
//!
//! Unlike a [`Shading`](crate::Shading) a plot has no light in it: one colour is one number, wherever it is seen.

use crate::legend::number;
use crate::shade::{UNKNOWN_COLOUR, diverging_colour};
use crate::{GBuffer, Hit, Picture, background, unorm8};
use colorous::VIRIDIS;
use glam::DVec3;

/// The shares of the values below the ends of a range that is found: single wild ones do not stretch it.
const PERCENTILES: [f64; 2] = [0.05, 0.95];

/// Values that differ by less than this share of their size are one, as a sphere's; a range then reaches a tenth of it further.
const ALIKE: f64 = 1e-5;

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quantity {
    /// The product of the principal curvatures.
    Gaussian,
    /// Their mean; its sign is that of the face's normal.
    Mean,
    /// The radius of the more strongly curved of the principal sections.
    MinRadius,
    /// The radius of the less strongly curved one.
    MaxRadius,
    /// Between the tangent plane and the direction in which a mould is pulled, degrees: 90 faces it, 0 is parallel to it, and
    /// below 0 the mould is held back.
    Draft {
        /// The direction, of unit length.
        pull: DVec3,
    },
}

impl Quantity {
    /// Its value at a hit; `None` where the hit has no curvature, or no normal. The radius of what is flat is infinite.
    pub fn value(self, hit: &Hit) -> Option<f64> {
        let curvatures = || hit.curvature.map(|k| [k.k1, k.k2]);
        let radius = |of: fn(f64, f64) -> f64| curvatures().map(|[a, b]| 1.0 / of(a.abs(), b.abs()));
        match self {
            Self::Gaussian => curvatures().map(|[a, b]| a * b),
            Self::Mean => curvatures().map(|[a, b]| 0.5 * (a + b)),
            Self::MinRadius => radius(f64::max),
            Self::MaxRadius => radius(f64::min),
            Self::Draft { pull } => hit.normal.unit().map(|n| n.dot(pull).clamp(-1.0, 1.0).asin().to_degrees()),
        }
    }

    /// Its unit, where `length` names the model's.
    pub fn unit(self, length: &str) -> String {
        match self {
            Self::Gaussian => format!("1/{length}²"),
            Self::Mean => format!("1/{length}"),
            Self::MinRadius | Self::MaxRadius => length.to_owned(),
            Self::Draft { .. } => "°".to_owned(),
        }
    }

    /// Whether its sign has a meaning, so that nought is white between two hues.
    fn is_signed(self) -> bool {
        !matches!(self, Self::MinRadius | Self::MaxRadius)
    }

    /// The range of what a picture shows: from its 5th percentile to its 95th, and as far below nought as above where the sign
    /// has a meaning. Of one value, or none, a range about it.
    pub fn range(self, buffer: &GBuffer) -> [f64; 2] {
        let mut values: Vec<f64> =
            buffer.pixels().flatten().filter_map(|hit| self.value(hit)).filter(|x| x.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let at =
            |share: f64| values.get(((values.len() as f64 - 1.0) * share).round() as usize).copied().unwrap_or(0.0);
        let [low, high] = PERCENTILES.map(at);
        let size = low.abs().max(high.abs());
        match (size, self.is_signed()) {
            (0.0, true) => [-1.0, 1.0],
            (0.0, false) => [0.0, 1.0],
            (size, true) => [-size, size],
            (size, false) if high - low <= ALIKE * size => [low - 0.1 * size, high + 0.1 * size],
            (_, false) => [low, high],
        }
    }

    /// The colour of a value in a range; beyond its ends that of the nearer one.
    fn colour(self, value: f64, [low, high]: [f64; 2]) -> [u8; 3] {
        if self.is_signed() && low < 0.0 && high > 0.0 {
            let x = if value < 0.0 { -(value / low) } else { value / high };
            return unorm8(diverging_colour(x.clamp(-1.0, 1.0) as f32));
        }
        VIRIDIS.eval_continuous(((value - low) / (high - low)).clamp(0.0, 1.0)).into_array()
    }

    /// The legend of a range, as high as a picture: numbers, with the unit above them.
    pub fn legend(self, range: [f64; 2], length: &str, height: usize) -> Picture {
        let [low, high] = range;
        let at = |t: f64| low + (high - low) * t;
        let ticks = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| (t, number(at(t))));
        Picture::numbered_legend(height, &self.unit(length), &ticks, |t| self.colour(at(t), range))
    }
}

impl GBuffer {
    /// A quantity in colours, from the low end of a range to its high one. Hits without it are grey.
    pub fn plotted(&self, quantity: Quantity, range: [f64; 2]) -> Picture {
        let colour = |hit: Option<&Hit>| match hit.map(|hit| quantity.value(hit)) {
            None => background(),
            Some(None) => unorm8(UNKNOWN_COLOUR),
            Some(Some(value)) => quantity.colour(value, range),
        };
        let (viewport, rgb) = (self.viewport(), self.pixels().map(colour).collect());
        Picture::new(viewport.width(), viewport.height(), rgb).expect("a viewport of colours")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Meta, PrincipalCurvatures};
    use glam::DVec2;
    use nurbs::{KnotVector, Normal, Surface};
    use scene::{Camera, FaceId, Model, Viewport};

    fn hit(curvature: Option<[f64; 2]>, normal: DVec3) -> Hit {
        Hit {
            face: FaceId(0),
            uv: DVec2::ZERO,
            local: None,
            t: 1.0,
            position: DVec3::ZERO,
            normal: Normal::Regular(normal),
            curvature: curvature.map(|[k1, k2]| PrincipalCurvatures { k1, k2 }),
            edge: None,
        }
    }

    /// A row of hits.
    fn buffer(hits: Vec<Option<Hit>>) -> GBuffer {
        let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        let points = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::X + DVec3::Y];
        let model = Model::of_surfaces("square", vec![Surface::new(knots(), knots(), points, None).unwrap()]).unwrap();
        let viewport = Viewport::new(hits.len(), 1).unwrap();
        let camera = Camera::framing(&model, viewport);
        GBuffer::from_rows(viewport, Meta::new("test", "by hand", &model, &camera), [hits])
    }

    #[test]
    fn radii_and_curvatures_are_those_of_a_torus() {
        // Of a tube of radius 1/2 about a circle of radius 2, where it faces outward: 1/2 and 5/2.
        let outside = hit(Some([-0.4, -2.0]), DVec3::X);
        let values =
            [Quantity::Gaussian, Quantity::Mean, Quantity::MinRadius, Quantity::MaxRadius].map(|q| q.value(&outside));
        assert_eq!(values, [Some(0.8), Some(-1.2), Some(0.5), Some(2.5)]);
        assert_eq!(Quantity::MaxRadius.value(&hit(Some([0.0, -2.0]), DVec3::X)), Some(f64::INFINITY));
        assert_eq!(Quantity::Mean.value(&hit(None, DVec3::X)), None);
        let units = [Quantity::Gaussian, Quantity::Mean, Quantity::MinRadius].map(|q| q.unit("mm"));
        assert_eq!(units, ["1/mm²", "1/mm", "mm"]);
    }

    #[test]
    fn draft_is_the_angle_between_tangent_plane_and_pull() {
        let draft = Quantity::Draft { pull: DVec3::Z };
        for degrees in [-90.0f64, -3.0, 0.0, 0.5, 45.0, 90.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let value = draft.value(&hit(None, DVec3::new(cosine, 0.0, sine))).unwrap();
            assert!((value - degrees).abs() < 1e-9, "{value} {degrees}");
        }
    }

    #[test]
    fn a_range_leaves_out_single_wild_values_and_is_even_about_nought() {
        let of = |values: &[f64]| buffer(values.iter().map(|&k| Some(hit(Some([k, k]), DVec3::Z))).collect());
        let mut values: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
        values[0] = 1e9;
        let [low, high] = Quantity::Mean.range(&of(&values));
        assert!(low == -high && (0.9..1.0).contains(&high), "{low} {high}");
        let [low, high] = Quantity::MinRadius.range(&of(&[2.0; 10]));
        assert!(low < 0.5 && 0.5 < high, "a sphere's one radius is inside: {low} {high}");
        assert_eq!(Quantity::Mean.range(&buffer(vec![None])), [-1.0, 1.0]);
    }

    #[test]
    fn nought_is_white_ends_hold_what_is_beyond_and_the_unknown_is_grey() {
        let hits =
            [Some(0.0), Some(5.0), Some(1.0), Some(-9.0), Some(-0.5)].map(|k| k.map(|k| hit(Some([k, k]), DVec3::Z)));
        let hits = hits.into_iter().chain([Some(hit(None, DVec3::Z)), None]).collect();
        let picture = buffer(hits).plotted(Quantity::Mean, [-0.5, 1.0]);
        let row: Vec<[u8; 3]> = (0..7).map(|x| picture.pixel(x, 0)).collect();
        assert_eq!(row[0], unorm8(diverging_colour(0.0)));
        assert_eq!((row[1], row[3]), (row[2], row[4]));
        assert_eq!(row[5..], [unorm8(UNKNOWN_COLOUR), background()]);
    }
}

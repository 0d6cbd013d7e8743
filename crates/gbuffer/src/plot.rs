//! Numbers of a surface in colours: curvatures, radii and draft, with a scale that is said in numbers.
//!
//! Unlike a [`Shading`](crate::Shading) a plot has no light in it: one colour is one number, wherever it is seen.

use crate::shade::UNKNOWN_COLOUR;
use crate::{GBuffer, Hit, Picture, Scale, background, unorm8};
use glam::DVec3;

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

    /// The scale of what a picture shows ([`Scale::of`]).
    pub fn scale(self, buffer: &GBuffer) -> Scale {
        Scale::of(buffer.pixels().flatten().filter_map(|hit| self.value(hit)), self.is_signed())
    }

    /// Its colours over a range that is given.
    pub fn scaled(self, range: [f64; 2]) -> Scale {
        Scale { range, is_signed: self.is_signed() }
    }
}

impl GBuffer {
    /// A quantity in colours. Hits without it are grey.
    pub fn plotted(&self, quantity: Quantity, scale: Scale) -> Picture {
        let values: Vec<Option<f64>> = self.pixels().map(|hit| quantity.value(hit?)).collect();
        self.coloured(&values, scale)
    }

    /// A number a pixel in colours, row by row. Hits without one are grey; what is beside the model shows the background.
    ///
    /// # Panics
    /// Where there are fewer numbers than pixels.
    pub fn coloured(&self, values: &[Option<f64>], scale: Scale) -> Picture {
        let colour = |(i, hit): (usize, Option<&Hit>)| match (hit, values[i]) {
            (None, _) => background(),
            (Some(_), None) => unorm8(UNKNOWN_COLOUR),
            (Some(_), Some(value)) => scale.colour(value),
        };
        let (viewport, rgb) = (self.viewport(), self.pixels().enumerate().map(colour).collect());
        Picture::new(viewport.width(), viewport.height(), rgb).expect("a viewport of colours")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::diverging_colour;
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
        let [low, high] = Quantity::Mean.scale(&of(&values)).range;
        assert!(low == -high && (0.9..1.0).contains(&high), "{low} {high}");
        let [low, high] = Quantity::MinRadius.scale(&of(&[2.0; 10])).range;
        assert!(low < 0.5 && 0.5 < high, "a sphere's one radius is inside: {low} {high}");
        assert_eq!(Quantity::Mean.scale(&buffer(vec![None])).range, [-1.0, 1.0]);
    }

    #[test]
    fn nought_is_white_ends_hold_what_is_beyond_and_the_unknown_is_grey() {
        let hits =
            [Some(0.0), Some(5.0), Some(1.0), Some(-9.0), Some(-0.5)].map(|k| k.map(|k| hit(Some([k, k]), DVec3::Z)));
        let hits = hits.into_iter().chain([Some(hit(None, DVec3::Z)), None]).collect();
        let picture = buffer(hits).plotted(Quantity::Mean, Quantity::Mean.scaled([-0.5, 1.0]));
        let row: Vec<[u8; 3]> = (0..7).map(|x| picture.pixel(x, 0)).collect();
        assert_eq!(row[0], unorm8(diverging_colour(0.0)));
        assert_eq!((row[1], row[3]), (row[2], row[4]));
        assert_eq!(row[5..], [unorm8(UNKNOWN_COLOUR), background()]);
    }
}

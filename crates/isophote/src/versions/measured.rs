//! How far the second version is from each pixel's point of the first, and how far its normal turns.

use super::nearest::{Foot, Nearest};
use gbuffer::{GBuffer, Hit, Picture, Scale};
use rayon::prelude::*;
use scene::FaceId;
use serde::Serialize;

/// What was measured at a pixel.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// The pixel.
    pub pixel: [usize; 2],
    /// What it shows of the first version.
    pub hit: Hit,
    /// The nearest point of the second.
    pub foot: Foot,
    /// The distance, model units: above 0 where the second version lies on the side that the first one's normal points to, below 0
    /// on the other. Where the first has no normal it is above 0.
    pub deviation: f64,
    /// Between the two tangent planes, degrees, 0 to 90; `None` where one of the points has no normal.
    pub angle_deg: Option<f64>,
}

/// All pixels of a picture, measured.
pub struct Measured {
    /// Row by row; `None` where the first version is not seen, or is seen but could not be measured.
    pub places: Vec<Option<Place>>,
}

/// A distribution, smallest first: how much half, nine of ten and 99 of 100 pixels come to at most, and the greatest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// The 50th percentile.
    pub half: f64,
    /// The 90th.
    pub percentile_90: f64,
    /// The 99th.
    pub percentile_99: f64,
    /// The greatest.
    pub greatest: f64,
}

impl Spread {
    /// Of values; `None` of none.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        let last = values.len().checked_sub(1)?;
        let at = |share: f64| values[(last as f64 * share).ceil() as usize];
        Some(Self { half: at(0.5), percentile_90: at(0.9), percentile_99: at(0.99), greatest: values[last] })
    }
}

impl Place {
    fn of(pixel: [usize; 2], hit: &Hit, second: &Nearest) -> Option<Self> {
        let foot = second.to(hit.position)?;
        let own = hit.normal.unit();
        let is_behind = own.is_some_and(|normal| (foot.position - hit.position).dot(normal) < 0.0);
        let deviation = if is_behind { -foot.distance } else { foot.distance };
        let turned = |n: glam::DVec3, m: glam::DVec3| n.cross(m).length().atan2(n.dot(m).abs()).to_degrees();
        let angle_deg = own.zip(foot.normal).map(|(n, m)| turned(n, m));
        Some(Self { pixel, hit: *hit, foot, deviation, angle_deg })
    }

    /// Its distance, whatever the side.
    pub fn distance(&self) -> f64 {
        self.deviation.abs()
    }

    /// Faces of both, as their files number them.
    pub fn faces(&self, first: &scene::Model, second: &scene::Model) -> [usize; 2] {
        let number = |model: &scene::Model, id: FaceId| model.number_in_file(id);
        [number(first, self.hit.face), number(second, self.foot.face)]
    }
}

impl Measured {
    /// Measures what a buffer shows of the first version; `progress` is told of each finished row.
    pub fn new(first: &GBuffer, second: &Nearest, progress: &(dyn Fn(usize) + Sync)) -> Self {
        let viewport = first.viewport();
        let row = |y: usize| {
            let place = |x: usize| first.get(x, y).and_then(|hit| Place::of([x, y], hit, second));
            let row: Vec<Option<Place>> = (0..viewport.width()).map(place).collect();
            progress(1);
            row
        };
        Self { places: (0..viewport.height()).into_par_iter().flat_map_iter(row).collect() }
    }

    /// What was measured.
    pub fn found(&self) -> impl Iterator<Item = &Place> {
        self.places.iter().flatten()
    }

    /// The deviation of each pixel, model units.
    pub fn deviations(&self) -> Vec<Option<f64>> {
        self.places.iter().map(|place| place.map(|place| place.deviation)).collect()
    }

    /// A picture of the deviations of what `first` shows, with its legend. The colours reach as far as the greatest.
    pub fn deviation_picture(&self, first: &GBuffer, length: &str) -> Picture {
        let ends = self.found().map(|place| place.distance()).fold(0.0, f64::max);
        with_legend(first, &self.deviations(), Scale::about([-ends, ends], true), length)
    }

    /// A picture of the angles, degrees, with its legend; alike.
    pub fn angle_picture(&self, first: &GBuffer) -> Picture {
        let angles: Vec<Option<f64>> =
            self.places.iter().map(|place| place.and_then(|place| place.angle_deg)).collect();
        let greatest = angles.iter().flatten().copied().fold(0.0, f64::max);
        with_legend(first, &angles, Scale::about([0.0, greatest], false), "°")
    }
}

fn with_legend(first: &GBuffer, values: &[Option<f64>], scale: Scale, unit: &str) -> Picture {
    let picture = first.coloured(values, scale);
    let legend = scale.legend(unit, picture.height());
    Picture::beside(&[&picture, &legend])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use nurbs::{KnotVector, Surface};
    use raycast::Caster;
    use scene::{Camera, Model, Projection, Viewport};

    /// A flat square of side 2, lifted, moved along x, and tilted about y by an angle.
    fn square(height: f64, along: f64, tilt_rad: f64) -> Model {
        let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("knots");
        let (sine, cosine) = tilt_rad.sin_cos();
        let corner = |x: f64, y: f64| DVec3::new(along + x * cosine, y, height + x * sine);
        let points = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(x, y)| corner(x, y)).to_vec();
        let surface = Surface::new(knots(), knots(), points, None).expect("a square");
        Model::of_surfaces("square", vec![surface]).expect("a model")
    }

    fn seen(model: &Model) -> GBuffer {
        let viewport = Viewport::new(40, 40).expect("a size");
        let projection = Projection::Orthographic { height: 2.5 };
        let camera = Camera::look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, projection).expect("a camera");
        Caster::new(model).render(&camera, viewport, &|_| {})
    }

    fn measured(first: &Model, second: Model) -> (GBuffer, Measured) {
        let buffer = seen(first);
        let measured = Measured::new(&buffer, &Nearest::new(second), &|_| {});
        assert_eq!(measured.found().count(), buffer.covered());
        assert!(buffer.covered() > 500);
        (buffer, measured)
    }

    #[test]
    fn parallel_planes_are_as_far_apart_as_they_were_put_and_on_the_side_of_the_normal() {
        for lift in [0.25, -0.25] {
            let (_, measured) = measured(&square(0.0, 0.0, 0.0), square(lift, 0.0, 0.0));
            for place in measured.found() {
                let side = place.hit.normal.unit().expect("a normal").z;
                assert!((place.deviation - side * lift).abs() < 1e-12, "{place:?}");
                assert!(place.angle_deg.is_some_and(|angle| angle < 1e-6) && place.foot.is_opposite);
            }
        }
    }

    #[test]
    fn a_tilted_plane_deviates_by_the_sine_of_its_angle() {
        let tilt = 2.0f64.to_radians();
        let (_, measured) = measured(&square(0.0, 0.0, 0.0), square(0.0, 0.0, tilt));
        for place in measured.found().filter(|place| place.foot.is_opposite) {
            assert!((place.distance() - (place.hit.position.x * tilt.sin()).abs()).abs() < 1e-12, "{place:?}");
            assert!((place.angle_deg.expect("normals") - 2.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_copy_moved_in_its_own_plane_deviates_only_where_it_is_no_more() {
        let (_, measured) = measured(&square(0.0, 0.0, 0.0), square(0.0, 0.5, 0.0));
        let mut beside = 0;
        for place in measured.found() {
            let exact = (-0.5 - place.hit.position.x).max(0.0);
            assert!((place.distance() - exact).abs() < 1e-12, "{place:?}");
            beside += usize::from(!place.foot.is_opposite);
            assert_eq!(place.foot.is_opposite, exact <= 1e-12);
        }
        assert!(beside > 100, "{beside}");
    }

    #[test]
    fn concentric_spheres_are_apart_by_the_difference_of_their_radii() {
        let sphere = models::builtin("sphere").expect("built in");
        let scaled = |factor: f64| {
            let scaled = |surface: &Surface| {
                let knots = |d| surface.knots(d).clone();
                let points = surface.points().iter().map(|p| factor * *p).collect();
                let weights = surface.weights().map(<[f64]>::to_vec);
                Surface::new(knots(nurbs::Direction::U), knots(nurbs::Direction::V), points, weights).expect("a sphere")
            };
            Model::of_surfaces("sphere", sphere.surfaces().iter().map(scaled).collect()).expect("a model")
        };
        for factor in [0.9, 1.1, 2.0] {
            let (_, measured) = measured(&sphere, scaled(factor));
            for place in measured.found() {
                assert!((place.distance() - (factor - 1.0).abs()).abs() < 1e-9, "{factor} {place:?}");
                assert!(place.angle_deg.is_none_or(|angle| angle < 1e-6), "{place:?}");
            }
            let sides = measured.found().filter(|place| (place.deviation > 0.0) == (factor > 1.0)).count();
            assert_eq!(sides, measured.found().count(), "outward is the normal's side");
        }
    }

    #[test]
    fn spreads_are_of_the_values_and_of_none_there_is_none() {
        let spread = Spread::of((1..=101).map(f64::from)).expect("values");
        assert_eq!(spread, Spread { half: 51.0, percentile_90: 91.0, percentile_99: 100.0, greatest: 101.0 });
        assert_eq!(Spread::of(std::iter::empty()), None);
    }
}

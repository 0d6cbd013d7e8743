//! What stands around a model and is mirrored in it: a studio that is built in, or a panorama from a file.
//!
//! A panorama holds all directions: columns are azimuths, with +y in the middle and +x to the right of it, as `--view front` looks; rows
//! are angles from +z, on top, to −z. Its colours are display values, shown as they are.

use anyhow::{Context, Result, bail};
use glam::{DVec2, DVec3, Vec3};
use image::{ImageReader, Limits, RgbImage};
use std::f64::consts::{PI, TAU};
use std::io::Cursor;
use std::path::Path;

/// The largest file of a panorama that is read, bytes, and the longest side of one, pixels.
const LARGEST_FILE: u64 = 256 << 20;
const LONGEST_SIDE: u32 = 16_384;

/// A panorama is twice as wide as high; so much wider or narrower it may be, for rounded sizes.
const SHAPE: f64 = 0.02;

/// Sky above the horizon and at the zenith; floor at the horizon and below.
const HORIZON: Vec3 = Vec3::new(0.80, 0.84, 0.88);
const ZENITH: Vec3 = Vec3::new(0.24, 0.34, 0.48);
const FLOOR_FAR: Vec3 = Vec3::new(0.36, 0.34, 0.32);
const FLOOR_NEAR: Vec3 = Vec3::new(0.10, 0.10, 0.11);
const LIGHT: Vec3 = Vec3::new(1.0, 1.0, 0.98);

/// Strips of light hang along x in the plane z = 1 over the model: how many, how far apart, half their width and half their length.
const STRIPS: i32 = 5;
const SPACING: f64 = 0.55;
const HALF_WIDTH: f64 = 0.13;
const HALF_LENGTH: f64 = 2.6;

/// How soft the sides of strips and the horizon are, in the plane of the strips and as a height.
const SOFT: f64 = 0.02;

/// What is around a model.
#[derive(Debug, Clone)]
pub enum Environment {
    /// Sky, floor and strips of light.
    Studio,
    /// All directions in a picture.
    Panorama(RgbImage),
}

impl Environment {
    /// That of a file, PNG or JPEG.
    ///
    /// # Errors
    /// Where it cannot be read, is no such picture, or is not twice as wide as high.
    pub fn open(path: &Path) -> Result<Self> {
        let place = || path.display().to_string();
        let bytes = files::read(path, LARGEST_FILE).with_context(place)?;
        let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().with_context(place)?;
        let mut limits = Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(LONGEST_SIDE), Some(LONGEST_SIDE));
        reader.limits(limits);
        let picture = reader.decode().with_context(|| format!("{}: no PNG or JPEG picture", place()))?.into_rgb8();
        let (width, height) = picture.dimensions();
        let shape = f64::from(width) / (2.0 * f64::from(height));
        if !((1.0 - SHAPE)..=(1.0 + SHAPE)).contains(&shape) {
            bail!("{}: a panorama of all directions is twice as wide as high, and this is {width}x{height}", place());
        }
        Ok(Self::Panorama(picture))
    }

    /// The colour in a direction of unit length, world: each part 0 to 1.
    pub fn colour(&self, toward: DVec3) -> [f32; 3] {
        match self {
            Self::Studio => studio(toward).to_array(),
            Self::Panorama(picture) => panorama(picture, toward).to_array(),
        }
    }
}

fn studio(toward: DVec3) -> Vec3 {
    let height = toward.z.clamp(-1.0, 1.0);
    let mix = |a: Vec3, b: Vec3, share: f64| a.lerp(b, share.clamp(0.0, 1.0) as f32);
    let floor = mix(FLOOR_FAR, FLOOR_NEAR, (-height).max(0.0).sqrt());
    let sky = mix(HORIZON, ZENITH, height.max(0.0).sqrt());
    let base = mix(floor, sky, 0.5 + 0.5 * height / SOFT);
    if height <= SOFT {
        return base;
    }
    let place = DVec2::new(toward.x, toward.y) / height;
    let last = 0.5 * f64::from(STRIPS - 1);
    let middle = SPACING * ((place.y / SPACING + last).round().clamp(0.0, 2.0 * last) - last);
    // How far within a strip, its own sides softened over what a glancing view stretches.
    let inside = |half: f64, off: f64| (0.5 + 0.5 * (half - off.abs()) / (SOFT / height)).clamp(0.0, 1.0);
    mix(base, LIGHT, inside(HALF_WIDTH, place.y - middle) * inside(HALF_LENGTH, place.x))
}

/// Between the four nearest pixels; the left side and the right one are neighbours.
fn panorama(picture: &RgbImage, toward: DVec3) -> Vec3 {
    let (width, height) = picture.dimensions();
    let x = (0.5 + toward.x.atan2(toward.y) / TAU) * f64::from(width) - 0.5;
    let y = (toward.z.clamp(-1.0, 1.0).acos() / PI * f64::from(height) - 0.5).clamp(0.0, f64::from(height - 1));
    let pixel = |column: f64, row: f64| {
        let column = column.rem_euclid(f64::from(width)) as u32;
        let row = row.clamp(0.0, f64::from(height - 1)) as u32;
        Vec3::from_array(picture.get_pixel(column.min(width - 1), row).0.map(f32::from)) / 255.0
    };
    let (left, top) = (x.floor(), y.floor());
    let (right, down) = ((x - left) as f32, (y - top) as f32);
    let row = |row: f64| pixel(left, row).lerp(pixel(left + 1.0, row), right);
    row(top).lerp(row(top + 1.0), down)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    /// Every direction to the middle of a pixel shows that pixel.
    #[test]
    fn a_panorama_has_plus_y_in_the_middle_and_plus_x_to_its_right() {
        let picture = RgbImage::from_fn(64, 32, |x, y| Rgb([x as u8 * 4, y as u8 * 8, 0]));
        let around = Environment::Panorama(picture.clone());
        for (x, y, pixel) in picture.enumerate_pixels() {
            let (azimuth, polar) = ((f64::from(x) + 0.5) / 64.0 * TAU - PI, (f64::from(y) + 0.5) / 32.0 * PI);
            let toward = DVec3::new(azimuth.sin() * polar.sin(), azimuth.cos() * polar.sin(), polar.cos());
            let found = around.colour(toward).map(|part| (part * 255.0).round() as u8);
            assert_eq!(found, pixel.0, "{x}, {y}");
        }
        let right = around.colour(DVec3::X)[0] * 255.0 / 4.0;
        assert!((right - 47.5).abs() < 0.1, "+x is three quarters of the way: {right}");
        // Where the sides meet, halfway between the first column and the last.
        assert!((around.colour(DVec3::NEG_Y)[0] * 255.0 - 126.0).abs() < 0.5);
    }

    #[test]
    fn the_studio_has_strips_of_light_in_its_sky_and_a_floor_that_is_darker() {
        let of = |x: f64, y: f64, z: f64| studio(DVec3::new(x, y, z).normalize());
        assert_eq!(of(0.0, 0.0, 1.0), LIGHT, "a strip hangs over the model");
        assert!(of(0.0, 0.5 * SPACING, 1.0).x < 0.5, "between two strips is sky");
        assert!(of(2.0 * HALF_LENGTH, 0.0, 1.0).z < 0.95, "strips end");
        assert!(of(1.0, 0.0, 0.1).x > of(1.0, 0.0, -0.1).x + 0.2, "the floor is darker than the sky");
        for k in 0..2000 {
            let (azimuth, z) = (f64::from(k) * 0.1, f64::from(k) / 1000.0 - 1.0);
            let flat = (1.0 - z * z).sqrt();
            let colour = of(flat * azimuth.sin(), flat * azimuth.cos(), z);
            assert!(colour.cmpge(Vec3::ZERO).all() && colour.cmple(Vec3::ONE).all(), "{colour}");
        }
    }

    #[test]
    fn what_is_no_panorama_is_refused_by_name() {
        let folder = std::env::temp_dir().join(format!("isophote_environment_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("square.png");
        RgbImage::new(8, 8).save(&path).unwrap();
        let said = format!("{:#}", Environment::open(&path).unwrap_err());
        assert!(said.contains("square.png") && said.contains("twice as wide as high"), "{said}");
        std::fs::write(&path, b"no picture").unwrap();
        assert!(format!("{:#}", Environment::open(&path).unwrap_err()).contains("no PNG or JPEG picture"));
        RgbImage::new(8, 4).save(&path).unwrap();
        assert!(Environment::open(&path).is_ok());
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(Environment::open(&path).is_err());
    }
}

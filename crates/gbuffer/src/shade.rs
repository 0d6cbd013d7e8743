//! The colour of a hit: one shading for all renderers, in f32.
//!
//! [`Shading`] says what is asked for; [`Shading::uniform`] makes a [`ShadeUniform`] of it for a camera and a model;
//! [`shade_pixel`] gives a colour from that and a [`ShadeInput`]. `shaders/shade.wgsl` is the twin of the functions
//! from [`shade_pixel`] down to the end of the file, with the same names, constants and order of operations, for the
//! GPU's fragment stage. Only + − × ÷ √ and exact operations are used, so that both can be compared to the bit on
//! adapters that neither fuse nor approximate: bands are found in tables of thresholds, not by arc cosines.
//!
//! Colours are display values from 0 to 1, stored as they are in 8 bits a channel by rounding to the nearest
//! ([`unorm8`]); no transfer function is applied on the way. [`pictures`] makes pictures of them.
//!
//! Kinds whose arguments are cut into bands ([`ShadeKind::Isophotes`], [`ShadeKind::Zebra`], [`ShadeKind::Checker`])
//! jump at the bands' edges: [`shade_tolerant`] gives the colours on both sides, so that an edge that lies a rounding
//! error elsewhere can be told from a wrong colour.

mod pictures;

use crate::{GBufferError, Hit};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec2, Vec3};
use nurbs::NormalStatus;
use scene::{Camera, Model, Ray};

/// The most isophote bands.
const MAX_BANDS: usize = 36;

/// Width of an isophote band unless one is given, degrees: 18 bands.
const DEFAULT_BAND_DEG: f64 = 5.0;

/// Toward the light: right, above, toward the viewer; over the left shoulder.
const DEFAULT_LIGHT: DVec3 = DVec3::new(-0.5, 0.6, 1.0);

/// Reflection lines over the whole sphere of directions, light and dark; odd, so that none ends straight ahead.
const STRIPES: u32 = 17;

/// The most that are drawn: on 4,096 pixels four are left for each.
const MOST_STRIPES: u32 = 1000;

/// Squares along each parameter.
const SQUARES: f32 = 10.0;

/// Curvatures are multiplied by this share of the model's size before they are compressed. A sphere then comes to
/// mean curvature ∓0.87 and Gaussian curvature 0.75, in the middle of either half of the map.
const CURVATURE_SHARE: f64 = 0.25;

/// What is shown of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ShadeKind {
    /// A lit, slightly shiny body (Phong 1975). Two-sided.
    Phong = KIND_PHONG,
    /// Lines of equal angle between normal and light, as the edges of bands. Two-sided: the angle is the acute one.
    ///
    /// Bands alternate between white and a hue that runs from amber (the surface faces the light) over red and purple
    /// to blue (it is parallel to the light).
    Isophotes = KIND_ISOPHOTES,
    /// Reflection lines: dark and light stripes in the mirrored view direction's component along the camera's right.
    /// Two-sided.
    Zebra = KIND_ZEBRA,
    /// The normal's components, −1 to 1 shown as 0 to 1. Not two-sided.
    Normal = KIND_NORMAL,
    /// Ten by ten squares over the surface's domain.
    Checker = KIND_CHECKER,
    /// A colour for each face.
    Face = KIND_FACE,
    /// Gaussian curvature: red where positive (dome), blue where negative (saddle), white at nought.
    ///
    /// The colour shows x / (1 + |x|), where x is the curvature times the square of a quarter of the model's size.
    Gaussian = KIND_GAUSSIAN,
    /// Mean curvature, coloured alike, times a quarter of the size; its sign is that of the face's normal.
    Mean = KIND_MEAN,
}

impl ShadeKind {
    /// All kinds.
    pub const ALL: [Self; 8] = [
        Self::Phong,
        Self::Isophotes,
        Self::Zebra,
        Self::Normal,
        Self::Checker,
        Self::Face,
        Self::Gaussian,
        Self::Mean,
    ];

    /// The name by which a user asks for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Phong => "phong",
            Self::Isophotes => "isophotes",
            Self::Zebra => "zebra",
            Self::Normal => "normal",
            Self::Checker => "checker",
            Self::Face => "face",
            Self::Gaussian => "gaussian",
            Self::Mean => "mean",
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Whether curvatures are needed for it.
    pub fn needs_curvature(self) -> bool {
        matches!(self, Self::Gaussian | Self::Mean)
    }
}

/// What to show, and how; the same for every camera and model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shading {
    kind: ShadeKind,
    /// 90 / `MAX_BANDS` to 90.
    band_deg: f64,
    /// Unit direction to the light in the camera's frame: right, above, toward the viewer.
    light: DVec3,
    /// Of the zebra, light and dark, over the whole sphere of directions.
    stripes: u32,
    /// How far the zebra is turned from upright in the picture, counterclockwise, radians.
    turn_rad: f64,
}

impl Shading {
    /// A kind with isophote bands of 5°, 17 upright stripes, and the light over the viewer's left shoulder.
    pub fn new(kind: ShadeKind) -> Self {
        Self { kind, band_deg: DEFAULT_BAND_DEG, light: DEFAULT_LIGHT.normalize(), stripes: STRIPES, turn_rad: 0.0 }
    }

    /// The same with isophote bands of another width, 2.5° to 90°; where it does not divide 90° the last is narrower.
    ///
    /// # Errors
    /// [`GBufferError::BandWidth`].
    pub fn with_band_deg(self, band_deg: f64) -> Result<Self, GBufferError> {
        if !(band_deg * MAX_BANDS as f64 >= 90.0 && band_deg <= 90.0) {
            return Err(GBufferError::BandWidth { degrees: band_deg });
        }
        Ok(Self { band_deg, ..self })
    }

    /// The same with the light in another direction of the camera's frame (right, above, toward the viewer), of any
    /// length.
    ///
    /// # Errors
    /// [`GBufferError::Light`] where it is zero or not finite.
    pub fn with_light(self, direction: DVec3) -> Result<Self, GBufferError> {
        let light = direction.try_normalize().ok_or(GBufferError::Light { direction: direction.to_array() })?;
        Ok(Self { light, ..self })
    }

    /// The same with another number of reflection lines, light and dark, 1 to 1000 over all directions.
    ///
    /// # Errors
    /// [`GBufferError::Stripes`].
    pub fn with_stripes(self, count: u32) -> Result<Self, GBufferError> {
        match (1..=MOST_STRIPES).contains(&count) {
            true => Ok(Self { stripes: count, ..self }),
            false => Err(GBufferError::Stripes { count }),
        }
    }

    /// The same with reflection lines turned from upright in the picture, counterclockwise, radians.
    pub fn with_stripes_turned(self, turn_rad: f64) -> Self {
        Self { turn_rad, ..self }
    }

    /// What is shown.
    pub fn kind(&self) -> ShadeKind {
        self.kind
    }

    /// Toward the light, world, of unit length.
    pub fn light(&self, camera: &Camera) -> DVec3 {
        camera.right() * self.light.x + camera.above() * self.light.y - camera.forward() * self.light.z
    }

    /// The angles to the light between which isophote bands lie, degrees: above 0 and below 90, ascending.
    pub fn band_borders(&self) -> Vec<f64> {
        let bands = (90.0 / self.band_deg).ceil();
        (1..bands as usize).map(|k| k as f64 * self.band_deg).collect()
    }

    /// The direction across which reflection lines are counted, world, of unit length.
    pub fn stripe_axis(&self, camera: &Camera) -> DVec3 {
        match self.turn_rad {
            // An upright zebra keeps its bits.
            0.0 => camera.right(),
            turn => libm::cos(turn) * camera.right() + libm::sin(turn) * camera.above(),
        }
    }

    /// The components of the mirrored view direction along [`Self::stripe_axis`] between which stripes lie, ascending.
    pub fn stripe_borders(&self) -> Vec<f64> {
        (1..self.stripes).map(|k| 2.0 * f64::from(k) / f64::from(self.stripes) - 1.0).collect()
    }

    /// The numbers that [`shade_pixel`] and its twin need, computed in f64 and rounded.
    ///
    /// `size` is the diagonal of the model's hull, model units; only curvatures depend on it.
    pub fn uniform(&self, camera: &Camera, size: f64) -> ShadeUniform {
        let borders = self.band_borders();
        let mut thresholds = [[-2.0; 4]; MAX_BANDS / 4];
        for (degrees, threshold) in borders.iter().zip(thresholds.as_flattened_mut()) {
            // libm's cosine, so that pictures do not depend on the platform's.
            *threshold = libm::cos(degrees.to_radians()) as f32;
        }
        ShadeUniform {
            light: self.light(camera).as_vec3().to_array(),
            kind: self.kind as u32,
            axis: self.stripe_axis(camera).as_vec3().to_array(),
            stripes: self.stripes as f32,
            squares: SQUARES,
            bands: (borders.len() + 1) as f32,
            curvature_scale: (size * CURVATURE_SHARE) as f32,
            padding: 0.0,
            thresholds,
        }
    }
}

/// The colour of pixels that see nothing.
pub fn background() -> [u8; 3] {
    unorm8(BACKGROUND.to_array())
}

/// A colour of 8 bits a channel: clamped to 0..1, rounded to the nearest; NaN gives 0.
pub fn unorm8(colour: impl Into<[f32; 3]>) -> [u8; 3] {
    colour.into().map(|x| (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
}

/// What a picture's shading depends on besides the hit: a uniform buffer, laid out as `ShadeUniform` in WGSL
/// (192 bytes). Directions are in world coordinates.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ShadeUniform {
    /// Unit direction to the light.
    pub light: [f32; 3],
    /// A [`ShadeKind`].
    pub kind: u32,
    /// Unit direction across which the reflection lines are counted.
    pub axis: [f32; 3],
    /// Number of reflection lines, light and dark, over all directions.
    pub stripes: f32,
    /// Number of squares along each parameter.
    pub squares: f32,
    /// Number of isophote bands from 0° to 90°.
    pub bands: f32,
    /// Takes the unit out of principal curvatures, model units.
    pub curvature_scale: f32,
    /// Not looked at.
    pub padding: f32,
    /// Cosines at which isophote bands end, decreasing; −2 where there is none.
    pub thresholds: [[f32; 4]; MAX_BANDS / 4],
}

/// What a colour depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadeInput {
    /// Unit normal, world; anything where `status` is undefined.
    pub normal: Vec3,
    /// Unit direction of the pixel's ray, from the eye to the point, world.
    pub view: Vec3,
    /// Parameters, 0 to 1 over the surface's domain.
    pub uv01: Vec2,
    /// Number of the face.
    pub face: u32,
    /// 1 where `k1` and `k2` hold, else 0.
    pub curved: u32,
    /// The greater principal curvature, 1 / model unit; looked at only where `curved` is 1.
    pub k1: f32,
    /// The lesser.
    pub k2: f32,
    /// A [`NormalStatus`].
    pub status: u32,
}

impl ShadeInput {
    /// The input for a hit on a pixel's ray, rounded from f64; `None` where the model has no such face.
    ///
    /// Curvatures that f32 cannot hold become its greatest number.
    pub fn new(hit: &Hit, model: &Model, ray: &Ray) -> Option<Self> {
        let face = model.faces().get(hit.face.0 as usize)?;
        let [[u0, u1], [v0, v1]] = model.surfaces()[face.surface].domain();
        let [k1, k2] = hit.curvature.map_or([0.0; 2], |k| [k.k1, k.k2]).map(|k| (k as f32).clamp(f32::MIN, f32::MAX));
        Some(Self {
            normal: hit.normal.unit().unwrap_or(DVec3::ZERO).as_vec3(),
            view: ray.direction.as_vec3(),
            uv01: Vec2::new(((hit.uv.x - u0) / (u1 - u0)) as f32, ((hit.uv.y - v0) / (v1 - v0)) as f32),
            face: hit.face.0,
            curved: u32::from(hit.curvature.is_some()),
            k1,
            k2,
            status: hit.normal.status() as u32,
        })
    }
}

/// The colours that are right when each banded argument may be off by `tolerance`: the one of [`shade_pixel`] first,
/// then that of every other band within reach, each once.
///
/// The argument is the cosine between normal and light for isophotes, the mirrored view direction's component for
/// the zebra, u and v over the domain for the checker. Other kinds have one colour; as they are continuous, the caller
/// must allow for what a difference in their input comes to.
pub fn shade_tolerant(uniforms: &ShadeUniform, s: &ShadeInput, tolerance: f32) -> Vec<[u8; 3]> {
    let mut colours = vec![unorm8(shade_pixel(uniforms, s))];
    let mut also = |colour: Vec3| {
        let colour = unorm8(colour);
        if !colours.contains(&colour) {
            colours.push(colour);
        }
    };
    if s.status != STATUS_UNDEFINED {
        match uniforms.kind {
            KIND_ISOPHOTES => {
                let cosine = isophote_cosine(uniforms, s);
                let last = uniforms.bands - 1.0;
                let first = isophote_band(uniforms, cosine + tolerance);
                let last = isophote_band(uniforms, cosine - tolerance).min(last);
                (first as u32..=last as u32).for_each(|band| also(isophote_colour(uniforms.bands, band as f32)));
            }
            KIND_ZEBRA => {
                let (x, reach) = (zebra_coordinate(uniforms, s), tolerance * 0.5 * uniforms.stripes);
                if (x - reach).floor() != (x + reach).floor() {
                    also(zebra_colour(0.0));
                    also(zebra_colour(1.0));
                }
            }
            KIND_CHECKER => {
                let near_edge =
                    |x: f32| checker_square(uniforms, x - tolerance) != checker_square(uniforms, x + tolerance);
                if near_edge(s.uv01.x) || near_edge(s.uv01.y) {
                    also(relief(s, checker_colour(0.0, 0.0)));
                    also(relief(s, checker_colour(0.0, 1.0)));
                }
            }
            _ => {}
        }
    }
    colours
}

/// The colour of a hit, each part 0 to 1 (twin: `shade`).
///
/// An undefined normal is magenta, an unknown curvature grey, whatever the kind is otherwise.
pub fn shade_pixel(uniforms: &ShadeUniform, s: &ShadeInput) -> [f32; 3] {
    shade(uniforms, s).to_array()
}

// From here on: the twin of shaders/shade.wgsl.

const KIND_PHONG: u32 = 0;
const KIND_ISOPHOTES: u32 = 1;
const KIND_ZEBRA: u32 = 2;
const KIND_NORMAL: u32 = 3;
const KIND_CHECKER: u32 = 4;
const KIND_FACE: u32 = 5;
const KIND_GAUSSIAN: u32 = 6;
const KIND_MEAN: u32 = 7;

const STATUS_UNDEFINED: u32 = NormalStatus::Undefined as u32;

/// Where nothing is hit.
const BACKGROUND: Vec3 = Vec3::new(0.082, 0.094, 0.118);
/// Where the normal is undefined.
const UNDEFINED_COLOUR: Vec3 = Vec3::new(1.0, 0.0, 1.0);
/// Where the curvature is unknown.
pub(crate) const UNKNOWN_COLOUR: Vec3 = Vec3::new(0.45, 0.45, 0.45);

const PHONG_BASE: Vec3 = Vec3::new(0.44, 0.56, 0.66);
const PHONG_AMBIENT: f32 = 0.025;
const PHONG_HEADLIGHT: f32 = 0.13;
const PHONG_DIFFUSE: f32 = 0.72;
const PHONG_SPECULAR: f32 = 0.3;
/// How fast the side turns dark toward the silhouette, where the seen side changes.
const PHONG_RIM: f32 = 4.0;

pub(crate) const LIGHT_TONE: Vec3 = Vec3::new(0.965, 0.961, 0.945);
pub(crate) const DARK_TONE: Vec3 = Vec3::new(0.141, 0.208, 0.345);

// Hues of isophotes from facing the light to grazing it.
const ANGLE_0: Vec3 = Vec3::new(0.957, 0.647, 0.165);
const ANGLE_1: Vec3 = Vec3::new(0.859, 0.243, 0.263);
const ANGLE_2: Vec3 = Vec3::new(0.494, 0.184, 0.557);
const ANGLE_3: Vec3 = Vec3::new(0.118, 0.29, 0.553);

const CHECKER_LIGHT: Vec3 = Vec3::new(0.957, 0.925, 0.851);
const CHECKER_DARK: Vec3 = Vec3::new(0.165, 0.404, 0.447);

// Signed values from the least through nought to the greatest.
const NEGATIVE_2: Vec3 = Vec3::new(0.078, 0.196, 0.478);
const NEGATIVE_1: Vec3 = Vec3::new(0.337, 0.592, 0.812);
const NOUGHT: Vec3 = Vec3::new(0.969, 0.965, 0.957);
const POSITIVE_1: Vec3 = Vec3::new(0.914, 0.51, 0.392);
const POSITIVE_2: Vec3 = Vec3::new(0.553, 0.067, 0.118);

/// Scaled curvatures beyond this have overflowed, or might.
const GREATEST_CURVATURE: f32 = 1e30;

/// Share of a lit colour that does not depend on the angle of view.
const RELIEF_FLOOR: f32 = 0.6;

fn dot3(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

fn lerp3(a: Vec3, b: Vec3, t: f32) -> Vec3 {
    a + (b - a) * t
}

fn clamp01(x: f32) -> f32 {
    x.clamp(0.0, 1.0)
}

/// 1 for odd whole numbers, 0 for even ones.
fn parity(n: f32) -> f32 {
    n - 2.0 * (n * 0.5).floor()
}

/// The view direction mirrored at the surface; the same for both normals.
fn reflected(s: &ShadeInput) -> Vec3 {
    s.view - s.normal * (2.0 * dot3(s.view, s.normal))
}

/// A colour made darker where the surface turns away from the eye.
fn relief(s: &ShadeInput, colour: Vec3) -> Vec3 {
    colour * (RELIEF_FLOOR + (1.0 - RELIEF_FLOOR) * dot3(s.normal, s.view).abs())
}

/// Two-sided: both dot products change sign with the normal. Linear light, encoded by a square root (a gamma of 2).
fn phong_colour(uniforms: &ShadeUniform, s: &ShadeInput) -> Vec3 {
    let light = Vec3::from_array(uniforms.light);
    let facing = -dot3(s.normal, s.view);
    let side = (PHONG_RIM * facing).clamp(-1.0, 1.0);
    let diffuse = (dot3(s.normal, light) * side).max(0.0);
    let gloss = dot3(reflected(s), light).max(0.0);
    let gloss2 = gloss * gloss;
    let gloss4 = gloss2 * gloss2;
    let gloss8 = gloss4 * gloss4;
    let gloss16 = gloss8 * gloss8;
    let gloss32 = gloss16 * gloss16;
    let matt = PHONG_AMBIENT + PHONG_HEADLIGHT * facing.abs() + PHONG_DIFFUSE * diffuse;
    let shine = PHONG_SPECULAR * gloss32;
    let linear = PHONG_BASE * matt + Vec3::new(shine, shine, shine);
    Vec3::new(clamp01(linear.x).sqrt(), clamp01(linear.y).sqrt(), clamp01(linear.z).sqrt())
}

/// How many of four cosines are above this one.
fn count_above(cosine: f32, [x, y, z, w]: [f32; 4]) -> f32 {
    let x = if cosine < x { 1.0 } else { 0.0 };
    let y = if cosine < y { 1.0 } else { 0.0 };
    let z = if cosine < z { 1.0 } else { 0.0 };
    let w = if cosine < w { 1.0 } else { 0.0 };
    x + y + z + w
}

/// The cosine that isophotes are lines of; the same for both normals.
fn isophote_cosine(uniforms: &ShadeUniform, s: &ShadeInput) -> f32 {
    dot3(s.normal, Vec3::from_array(uniforms.light)).abs()
}

/// The band of a cosine, from 0 where the surface faces the light.
fn isophote_band(uniforms: &ShadeUniform, cosine: f32) -> f32 {
    let mut band = count_above(cosine, uniforms.thresholds[0]);
    for thresholds in &uniforms.thresholds[1..] {
        band += count_above(cosine, *thresholds);
    }
    band
}

fn isophote_colour(bands: f32, band: f32) -> Vec3 {
    let t = (band + 0.5) / bands * 3.0;
    let mut hue = lerp3(ANGLE_0, ANGLE_1, clamp01(t));
    hue = lerp3(hue, ANGLE_2, clamp01(t - 1.0));
    hue = lerp3(hue, ANGLE_3, clamp01(t - 2.0));
    lerp3(LIGHT_TONE, hue, parity(band))
}

/// How far along the axis the mirrored view points, counted in stripes.
fn zebra_coordinate(uniforms: &ShadeUniform, s: &ShadeInput) -> f32 {
    (dot3(reflected(s), Vec3::from_array(uniforms.axis)) * 0.5 + 0.5) * uniforms.stripes
}

fn zebra_colour(band: f32) -> Vec3 {
    lerp3(LIGHT_TONE, DARK_TONE, parity(band))
}

fn normal_colour(s: &ShadeInput) -> Vec3 {
    s.normal * 0.5 + Vec3::new(0.5, 0.5, 0.5)
}

/// The square that a parameter from 0 to 1 falls into; the last has both its ends.
fn checker_square(uniforms: &ShadeUniform, x: f32) -> f32 {
    (x * uniforms.squares).floor().max(0.0).min(uniforms.squares - 1.0)
}

fn checker_colour(square_u: f32, square_v: f32) -> Vec3 {
    lerp3(CHECKER_LIGHT, CHECKER_DARK, parity(square_u + square_v))
}

/// Hues of successive faces differ by the golden ratio of the circle (Fibonacci hashing), so that neighbours differ.
fn face_colour(face: u32) -> Vec3 {
    let hash = face.wrapping_mul(2654435769).wrapping_add(1640531527);
    let hue = (hash >> 8) as f32 * (6.0 / 16777216.0);
    let r = clamp01((hue - 3.0).abs() - 1.0);
    let g = clamp01(2.0 - (hue - 2.0).abs());
    let b = clamp01(2.0 - (hue - 4.0).abs());
    let tint = 0.05 * parity((face & 1) as f32);
    Vec3::new(0.34 + tint, 0.36 + tint, 0.38 + tint) + Vec3::new(r * 0.56, g * 0.46, b * 0.52)
}

/// All of the line to −1 < x < 1, keeping sign and order.
fn compressed(value: f32) -> f32 {
    let x = value.clamp(-GREATEST_CURVATURE, GREATEST_CURVATURE);
    x / (1.0 + x.abs())
}

/// A colour for −1 to 1: blue, white at nought, red.
pub(crate) fn diverging_colour(x: f32) -> Vec3 {
    let t = x.abs() * 2.0;
    let first = if x > 0.0 { POSITIVE_1 } else { NEGATIVE_1 };
    let second = if x > 0.0 { POSITIVE_2 } else { NEGATIVE_2 };
    lerp3(lerp3(NOUGHT, first, clamp01(t)), second, clamp01(t - 1.0))
}

fn curvature_colour(s: &ShadeInput, value: f32) -> Vec3 {
    if s.curved == 0 {
        return relief(s, UNKNOWN_COLOUR);
    }
    relief(s, diverging_colour(compressed(value)))
}

fn shade(uniforms: &ShadeUniform, s: &ShadeInput) -> Vec3 {
    if s.status == STATUS_UNDEFINED {
        return UNDEFINED_COLOUR;
    }
    match uniforms.kind {
        KIND_PHONG => phong_colour(uniforms, s),
        KIND_ISOPHOTES => isophote_colour(uniforms.bands, isophote_band(uniforms, isophote_cosine(uniforms, s))),
        KIND_ZEBRA => zebra_colour(zebra_coordinate(uniforms, s).floor()),
        KIND_NORMAL => normal_colour(s),
        KIND_CHECKER => {
            let square_u = checker_square(uniforms, s.uv01.x);
            let square_v = checker_square(uniforms, s.uv01.y);
            relief(s, checker_colour(square_u, square_v))
        }
        KIND_FACE => relief(s, face_colour(s.face)),
        KIND_GAUSSIAN => curvature_colour(s, (s.k1 * uniforms.curvature_scale) * (s.k2 * uniforms.curvature_scale)),
        KIND_MEAN => curvature_colour(s, 0.5 * (s.k1 + s.k2) * uniforms.curvature_scale),
        _ => UNKNOWN_COLOUR,
    }
}

#[cfg(test)]
mod tests;

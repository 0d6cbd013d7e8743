//! How fine masks are, from an error in pixels, and how many chords their curves have.

use super::atlas::{GREATEST_SIDE, shelve};
use super::tile::{MaskCurve, Ring, Tile};
use glam::{DVec2, DVec3};
use nurbs::{BezierCurve, DerivativeBounds, Surface};
use rayon::prelude::*;
use scene::{Camera, FaceId, Model, Region, Viewport};

/// How far from an edge, in texels, a mask may be wrong: half of one because the nearest centre speaks for all of a
/// texel, and one for rasterizers (tiny-skia snaps corners to 1/64 of a texel and rounds the slopes of edges: 0.8 was seen).
const TEXELS_OFF: f64 = 1.5;

/// Parts of the error that may come from the texels along u, from those along v, and from chords: 3/8, 3/8 and 1/4.
const TEXEL_SHARE: f64 = 3.0 / 8.0;
const CHORD_SHARE: f64 = 1.0 / 4.0;

/// Chords of one curve at most.
const GREATEST_CHORDS: f64 = 4096.0;

/// Chords of all curves at most: three vertices of each are counted in 32 bits.
const GREATEST_CHORD_COUNT: u64 = 1 << 26;

/// What narrowing parameters, a tile's box and its scale may move a fragment by, in units of 2⁻²⁴ of the domain.
const ROUNDING_ULPS: f64 = 8.0;

/// The greatest side of a mask, texels: tiny-skia takes larger ones apart.
const GREATEST_TILE: u32 = 8191;

/// Halvings of the interval in which the least factor lies by which masks are made coarser.
const BISECTIONS: u32 = 20;

/// How fine masks are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaskQuality {
    /// Fine enough for this error of an edge in space, pixels.
    Error {
        /// Pixels, positive.
        px: f64,
    },
    /// As fine as said, whatever the error.
    Fixed {
        /// Texels of a mask along each of its sides.
        side: u32,
        /// Chords of each monotone curve.
        chords: u32,
    },
}

/// How the CPU draws a mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum MaskFill {
    /// All loops at once by scan lines, even-odd (tiny-skia).
    #[default]
    EvenOdd,
    /// Loop by loop, each cut into triangles by clipping its ears: outer ones are filled with one, inner ones with zero
    /// (Wildcat).
    Earcut,
}

/// What masks are made for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaskOptions {
    /// How fine they are.
    pub quality: MaskQuality,
    /// Bytes, and so texels, of all of them together. What is finer than that is made coarser.
    pub memory: u64,
    /// How the CPU draws them.
    pub fill: MaskFill,
}

impl Default for MaskOptions {
    fn default() -> Self {
        Self { quality: MaskQuality::Error { px: 0.5 }, memory: 256 << 20, fill: MaskFill::default() }
    }
}

/// Why there are no masks.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MaskError {
    /// The error asked for is no length.
    #[error("masks with an error of {px} pixels: it must be positive")]
    Error {
        /// What was asked for.
        px: f64,
    },
    /// No texel, no chord, or more texels than a mask may be wide.
    #[error(
        "masks of {side} texels a side and {chords} chords a curve: there must be 1 to {GREATEST_TILE} and 1 to 4096"
    )]
    Fixed {
        /// Texels asked for.
        side: u32,
        /// Chords asked for.
        chords: u32,
    },
    /// Not even masks of one texel fit.
    #[error("the masks of {faces} trimmed faces do not fit into {memory} bytes, at one texel each")]
    Memory {
        /// Trimmed faces.
        faces: usize,
        /// Bytes there are.
        memory: u64,
    },
    /// More chords than are counted in 32 bits.
    #[error("the trims need {count} chords, more than can be drawn ({GREATEST_CHORD_COUNT}); allow a greater error")]
    TooManyChords {
        /// Chords needed.
        count: u64,
    },
}

/// Where the masks of all trimmed faces of a model are, and the curves that bound them.
#[derive(Debug, Clone, PartialEq)]
pub struct MaskPlan {
    /// Texels of the atlas: columns, rows.
    pub size: [u32; 2],
    /// One a face; `None` where it is its whole surface.
    pub tiles: Vec<Option<Tile>>,
    /// All curves.
    pub curves: Vec<MaskCurve>,
    /// Their control points (w x, w y, w, 0), texels from the corner of their tile.
    pub control: Vec<[f32; 4]>,
    /// By how much masks are coarser than was asked for, along each side, for want of memory; 1 where they are not.
    pub coarser: f64,
}

/// What a trimmed face asks for.
struct Wanted<'m> {
    face: usize,
    region: &'m Region,
    /// Greatest |S_u| and |S_v|, model units.
    speed: DVec2,
    /// Model units a pixel.
    pixel: f64,
    /// Texels.
    size: DVec2,
    /// The curves of each loop, with their chords.
    rings: Vec<(usize, Vec<(BezierCurve, f64)>)>,
    /// Greatest distance between a curve and its chords, in u and v.
    chord: DVec2,
}

impl MaskPlan {
    /// The masks of a model as `camera` sees it.
    ///
    /// With the greatest |S_u|, |S_v| over the face ([`DerivativeBounds`]), an edge that is off by (δu, δv) is off by at
    /// most |S_u| δu + |S_v| δv in space. Texels are made so small, and by the bound of Filip, Magedson & Markot (1986)
    /// on a curve, |C''| / 8 n², its n chords so many, that all of it together keeps to the error.
    ///
    /// # Errors
    /// [`MaskError`].
    pub fn new(model: &Model, camera: &Camera, viewport: Viewport, options: &MaskOptions) -> Result<Self, MaskError> {
        match options.quality {
            MaskQuality::Error { px } if !(px > 0.0 && px.is_finite()) => return Err(MaskError::Error { px }),
            MaskQuality::Fixed { side, chords }
                if !(1..=GREATEST_TILE).contains(&side) || !(1..=GREATEST_CHORDS as u32).contains(&chords) =>
            {
                return Err(MaskError::Fixed { side, chords });
            }
            _ => {}
        }
        let trimmed: Vec<(usize, &Region)> = (0..model.faces().len())
            .filter_map(|face| Some((face, model.trimmed_region(FaceId(face as u32))?)))
            .collect();
        let wanted: Vec<Wanted> = trimmed
            .into_par_iter()
            .map(|(face, region)| {
                let surface = model.surface(FaceId(face as u32));
                Wanted::new(face, region, surface, camera.pixel_at(viewport, surface.hull()), options.quality)
            })
            .collect();
        let count: f64 = wanted.iter().flat_map(|w| &w.rings).flat_map(|(_, curves)| curves).map(|(_, n)| n).sum();
        if count > GREATEST_CHORD_COUNT as f64 {
            return Err(MaskError::TooManyChords { count: count as u64 });
        }
        Self::laid_out(model.faces().len(), &wanted, options.memory)
    }

    /// Bytes of the atlas.
    pub fn bytes(&self) -> u64 {
        self.size.iter().map(|&side| u64::from(side)).product()
    }

    /// Chords of all curves.
    pub fn chords(&self) -> u32 {
        self.curves.last().map_or(0, |curve| curve.first_chord + curve.chords)
    }

    /// The greatest error of any mask, pixels.
    pub fn error_px(&self) -> f64 {
        self.tiles.iter().flatten().fold(0.0, |most, tile| most.max(tile.error_px))
    }

    fn laid_out(faces: usize, wanted: &[Wanted], memory: u64) -> Result<Self, MaskError> {
        let sizes = |coarser: f64| -> Vec<[u32; 2]> { wanted.iter().map(|w| w.texels(coarser)).collect() };
        let fits = |coarser: f64| shelve(&sizes(coarser), memory);
        let (mut coarser, mut atlas) = (1.0, fits(1.0));
        if atlas.is_none() {
            // The largest mask is one texel at the most.
            let (mut low, mut high) = (1.0, f64::from(GREATEST_SIDE));
            for _ in 0..BISECTIONS {
                let middle = (low * high).sqrt();
                if fits(middle).is_some() { high = middle } else { low = middle }
            }
            (coarser, atlas) = (high, fits(high));
        }
        let atlas = atlas.ok_or(MaskError::Memory { faces: wanted.len(), memory })?;
        let mut plan = Self { size: atlas.size, tiles: vec![None; faces], curves: vec![], control: vec![], coarser };
        for ((wanted, corner), size) in wanted.iter().zip(atlas.corners).zip(sizes(coarser)) {
            plan.push(wanted, corner, size);
        }
        Ok(plan)
    }

    fn push(&mut self, wanted: &Wanted, corner: [u32; 2], size: [u32; 2]) {
        let (hull, domain) = (wanted.region.hull(), wanted.region.domain());
        let texels = DVec2::from_array(size.map(f64::from)) / hull.size();
        let mut rings = vec![];
        for (depth, curves) in &wanted.rings {
            let first = self.curves.len();
            let origin = (curves[0].0.start() - hull.min) * texels;
            for (curve, chords) in curves {
                self.curves.push(MaskCurve {
                    corner: corner.map(|x| x as f32),
                    origin: origin.to_array().map(|x| x as f32),
                    control: self.control.len() as u32,
                    degree: curve.degree() as u32,
                    first_chord: self.chords(),
                    chords: *chords as u32,
                });
                let narrowed = |c: &DVec3| {
                    let at = (c.truncate() - hull.min * c.z) * texels;
                    [at.x, at.y, c.z, 0.0].map(|x| x as f32)
                };
                self.control.extend(curve.control().iter().map(narrowed));
            }
            rings.push(Ring { depth: *depth, curves: first..self.curves.len() });
        }
        let rounding = DVec2::splat(ROUNDING_ULPS / (1u64 << 24) as f64);
        let off = TEXELS_OFF / texels + wanted.chord;
        let off = if off.is_finite() { off } else { DVec2::ZERO };
        self.tiles[wanted.face] = Some(Tile {
            corner,
            size,
            hull: [hull.min, hull.max].map(|p| (p - domain.min) / domain.size()),
            band: off / domain.size() + rounding,
            error_px: wanted.speed.dot(off) / wanted.pixel,
            rings,
        });
    }
}

impl<'m> Wanted<'m> {
    fn new(face: usize, region: &'m Region, surface: &Surface, pixel: f64, quality: MaskQuality) -> Self {
        let bounds = surface
            .bezier_patches()
            .iter()
            .map(|patch| patch.derivative_bounds())
            .fold(DerivativeBounds::default(), DerivativeBounds::max);
        let speed = DVec2::new(bounds.u, bounds.v);
        let (size, allowed) = match quality {
            MaskQuality::Error { px } => {
                let error = px * pixel;
                (region.hull().size() * speed * TEXELS_OFF / (TEXEL_SHARE * error), CHORD_SHARE * error)
            }
            MaskQuality::Fixed { side, .. } => (DVec2::splat(f64::from(side)), 0.0),
        };
        let mut rings = vec![];
        let mut chord = DVec2::ZERO;
        for (index, boundary) in region.loops().iter().enumerate() {
            let curves: Vec<(BezierCurve, f64)> = region
                .pieces()
                .iter()
                .filter(|piece| piece.loop_index == index)
                .map(|piece| {
                    // A straight segment is its own chord, however fast its weights make it run.
                    if piece.curve.degree() == 1 {
                        return (piece.curve.clone(), 1.0);
                    }
                    let bend = piece.curve.second_derivative_bounds() / 8.0;
                    let n = match quality {
                        // Half for u and half for v, which may be greatest on different curves.
                        MaskQuality::Error { .. } => (2.0 * (speed * bend).max_element() / allowed).sqrt().ceil(),
                        MaskQuality::Fixed { chords, .. } => f64::from(chords),
                    };
                    let n = n.clamp(1.0, GREATEST_CHORDS);
                    chord = chord.max(bend / (n * n));
                    (piece.curve.clone(), n)
                })
                .collect();
            if !curves.is_empty() {
                rings.push((boundary.depth, curves));
            }
        }
        Self { face, region, speed, pixel, size, rings, chord }
    }

    /// Texels of a mask so many times coarser; none where the region is empty.
    fn texels(&self, coarser: f64) -> [u32; 2] {
        let empty = !(self.region.hull().size().cmpgt(DVec2::ZERO)).all();
        let side = |n: f64| if empty { 0 } else { ((n / coarser).ceil() as u32).clamp(1, GREATEST_TILE) };
        [side(self.size.x), side(self.size.y)]
    }
}

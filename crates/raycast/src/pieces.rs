//! Preprocessing: surfaces moved to their own frame, cut into nearly flat Bézier pieces.
//!
//! Comes from `scene::Model`; goes to the box tree (boxes) and to the root finder (control points).

use glam::{DVec3, DVec4};
use nurbs::{BezierPatch, Direction, Surface};
use rayon::prelude::*;
use scene::Model;

/// Unit roundoff of f64, 2⁻⁵³.
pub(crate) const UNIT: f64 = 0.5 * f64::EPSILON;

/// A piece counts as nearly flat when its second differences are below this share of its first differences.
///
/// On the surface of `examples/rate.rs`, 0.25, 0.5 and 1 give 1680, 428 and 107 pieces and 8.9, 11.8 and 18.0 boxes a
/// grazing ray; 0.5 is as fast as 0.25 in a quarter of the memory, and 1 is slower.
const NEARLY_FLAT: f64 = 0.5;

/// Most halvings of a patch in one direction. A cusp never gets flat; it is left to the root finder.
const MAX_LEVELS: u32 = 3;

/// Most control points that all pieces together may hold (32 bytes each), unless the patches alone are more.
///
/// 80 MiB; with boxes and tree a bicubic piece takes 0.7 kB in all, of which this is 512 bytes.
const MAX_CONTROL: usize = 80 << 15;

/// A surface in its own frame: x_world = `origin` + `scale` x. In it all coordinates are at most 1 in size.
pub(crate) struct Body {
    /// The surface about its control box's centre, divided by `scale`, weights divided by a power of two.
    pub surface: Surface,
    /// World position of the frame's origin.
    pub origin: DVec3,
    /// Model units per unit of the frame, a power of two.
    pub scale: f64,
    /// Radius of a ball about the frame's origin that holds the control points.
    pub radius: f64,
    /// Index among the bodies.
    pub index: usize,
    /// The faces that use the surface, ascending.
    pub faces: Vec<u32>,
    /// The greatest [`Piece::growth`] of the surface's pieces.
    pub growth: f64,
}

/// A Bézier piece of a body.
pub(crate) struct Piece {
    /// Index of the body.
    pub body: u32,
    /// Index of the first control point.
    pub first: u32,
    /// Knot spans of the body's surface in which the piece lies.
    pub span: [u32; 2],
    /// The rectangle \[\[u0, u1\], \[v0, v1\]\] of the surface's knot domain.
    pub domain: [[f64; 2]; 2],
    /// Rounding errors of the control points, relative to their own weight times the body's radius.
    ///
    /// They are convex combinations of the surface's; sums of positive terms keep relative errors, so that the weight
    /// that counts is the point's own, not the greatest of those it was computed from.
    pub growth: f64,
    /// Greatest weight of the control points.
    pub weight: f64,
}

/// All surfaces of a model that faces use, in pieces.
pub(crate) struct Pieces {
    pub bodies: Vec<Body>,
    /// Index of the body of each surface of the model; of unused ones, no body's.
    pub body_of_surface: Vec<u32>,
    pub pieces: Vec<Piece>,
    /// (w x, w y, w z, w) about `body.surface.origin()` in the body's frame, row-major in u, piece by piece.
    pub control: Vec<[f64; 4]>,
}

impl Pieces {
    /// Cuts the surfaces of all faces. The same for every thread count.
    pub fn new(model: &Model) -> Self {
        let mut faces = vec![vec![]; model.surfaces().len()];
        for (id, face) in model.faces().iter().enumerate() {
            faces[face.surface].push(id as u32);
        }
        let mut count = 0;
        let body_of_surface = faces
            .iter()
            .map(|faces| {
                count += u32::from(!faces.is_empty());
                if faces.is_empty() { u32::MAX } else { count - 1 }
            })
            .collect();
        let used: Vec<(&Surface, Vec<u32>)> =
            model.surfaces().iter().zip(faces).filter(|(_, faces)| !faces.is_empty()).collect();
        let mut cut: Vec<(Body, Vec<BezierPatch>)> = used
            .into_par_iter()
            .enumerate()
            .map(|(index, (surface, faces))| {
                let body = Body::new(index, surface, faces);
                let patches = body.surface.bezier_patches();
                (body, patches)
            })
            .collect();
        let ratios: Vec<([f64; 2], usize)> = cut
            .par_iter()
            .flat_map_iter(|(_, patches)| patches.iter().map(|patch| (bending(patch), patch.control.len())))
            .collect();
        // Doubling the limit takes a level from every patch that had one, so MAX_LEVELS + 1 rounds always suffice
        // unless the ratios are far above it; by then every patch is at MAX_LEVELS and the loop goes on to lower it.
        let mut limit = NEARLY_FLAT;
        let mut most = MAX_LEVELS;
        let total = |limit: f64, most: u32| -> usize {
            ratios
                .iter()
                .map(|(ratio, count)| count << (levels(ratio[0], limit, most) + levels(ratio[1], limit, most)))
                .sum()
        };
        while most > 0 && total(limit, most) > MAX_CONTROL {
            limit *= 2.0;
            if limit > 1.0 {
                limit = NEARLY_FLAT;
                most -= 1;
            }
        }
        let parts: Vec<(Vec<Piece>, Vec<[f64; 4]>)> =
            cut.par_iter_mut().map(|(body, patches)| body.cut(std::mem::take(patches), limit, most)).collect();
        let bodies = cut.into_iter().map(|(body, _)| body).collect();
        let mut all = Self { bodies, body_of_surface, pieces: vec![], control: vec![] };
        all.pieces.reserve_exact(parts.iter().map(|(pieces, _)| pieces.len()).sum());
        all.control.reserve_exact(parts.iter().map(|(_, control)| control.len()).sum());
        for (pieces, control) in parts {
            let first = all.control.len() as u32;
            all.pieces.extend(pieces.into_iter().map(|piece| Piece { first: piece.first + first, ..piece }));
            all.control.extend(control);
        }
        all
    }

    /// The control points of a piece.
    #[inline(always)]
    pub fn control(&self, piece: &Piece) -> &[[f64; 4]] {
        let [p, q] = self.bodies[piece.body as usize].surface.degree();
        &self.control[piece.first as usize..][..(p + 1) * (q + 1)]
    }

    /// The box of a piece in world coordinates about `center`, not rounded outward.
    pub fn hull_about(&self, piece: &Piece, center: DVec3) -> [DVec3; 2] {
        let body = &self.bodies[piece.body as usize];
        let offset = body.origin - center;
        let local = body.surface.origin();
        self.control(piece).iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], &[x, y, z, w]| {
            let p = offset + (local + DVec3::new(x, y, z) / w) * body.scale;
            [min.min(p), max.max(p)]
        })
    }
}

/// The greatest power of two that is at most `x`, at least the smallest normal number.
fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & 0x7ff0_0000_0000_0000)
}

impl Body {
    fn new(index: usize, surface: &Surface, faces: Vec<u32>) -> Self {
        let hull = surface.hull();
        let origin = surface.origin();
        let half = (hull.max - origin).max(origin - hull.min).max_element();
        // A surface of a single point has no size.
        let scale = if half > 0.0 { 2.0 * power_of_two(half) } else { 1.0 };
        let points: Vec<DVec3> = surface.points().iter().map(|&p| (p - origin) / scale).collect();
        let radius = points.iter().fold(0.0, |r: f64, p| r.max(p.length()));
        let weights = surface.weights().map(|weights| {
            let greatest = power_of_two(weights.iter().fold(0.0, |m: f64, &w| m.max(w)));
            weights.iter().map(|w| w / greatest).collect()
        });
        let knots = |direction| surface.knots(direction).clone();
        let surface = Surface::new(knots(Direction::U), knots(Direction::V), points, weights)
            .expect("a legal surface stays legal when it is moved to its own centre and scaled by powers of two");
        Self { index, surface, origin, scale, radius, faces, growth: 0.0 }
    }

    /// Cuts the patches of this body's surface; `first` of each piece counts from 0.
    fn cut(&mut self, patches: Vec<BezierPatch>, limit: f64, most: u32) -> (Vec<Piece>, Vec<[f64; 4]>) {
        let [p, q] = self.surface.degree();
        let [knots_u, knots_v] = [Direction::U, Direction::V].map(|d| self.surface.knots(d));
        let (mut pieces, mut control) = (vec![], vec![]);
        let mut greatest_growth = 0.0f64;
        for patch in patches {
            let span = [knots_u.find_span(patch.domain[0][0]), knots_v.find_span(patch.domain[1][0])];
            let ratio = bending(&patch);
            let [levels_u, levels_v] = [0, 1].map(|k| levels(ratio[k], limit, most));
            // Extraction: 2 p ulp a direction. A cut: p lerps of at most 3 roundings each.
            let steps = 4 * (p + q) + 3 * (p * levels_u as usize + q * levels_v as usize);
            let growth = steps as f64 * UNIT;
            greatest_growth = greatest_growth.max(growth);
            for strip in halved(vec![patch], levels_u, |patch, at| patch.split_u(at), 0) {
                for part in halved(vec![strip], levels_v, |patch, at| patch.split_v(at), 1) {
                    let first = control.len() as u32;
                    let weight = part.control.iter().fold(0.0, |m: f64, c| m.max(c.w));
                    control.extend(part.control.iter().map(|c| c.to_array()));
                    let span = span.map(|k| k as u32);
                    pieces.push(Piece { body: self.index as u32, first, span, domain: part.domain, growth, weight });
                }
            }
        }
        self.growth = greatest_growth;
        (pieces, control)
    }
}

/// Halves every patch `levels` times; a patch whose middle parameter is not between its ends in f64 stays whole.
fn halved(
    mut patches: Vec<BezierPatch>,
    levels: u32,
    split: impl Fn(&BezierPatch, f64) -> [BezierPatch; 2],
    direction: usize,
) -> Vec<BezierPatch> {
    for _ in 0..levels {
        patches = patches
            .into_iter()
            .flat_map(|patch| {
                let [low, high] = patch.domain[direction];
                let middle = low + 0.5 * (high - low);
                if low < middle && middle < high { split(&patch, middle).to_vec() } else { vec![patch] }
            })
            .collect();
    }
    patches
}

/// Halvings that bring `ratio` (which halves each time) below `limit`.
fn levels(ratio: f64, limit: f64, most: u32) -> u32 {
    (0..most).find(|&k| ratio <= limit * f64::from(1u32 << k)).unwrap_or(most)
}

/// Per direction, what halving the patch halves: the greatest second difference of Euclidean control points over the
/// greatest first difference, or, where weights vary more, [`NEARLY_FLAT`] times the binary logarithm of their ratio.
fn bending(patch: &BezierPatch) -> [f64; 2] {
    let [p, q] = patch.degree;
    let at = |i: usize, j: usize| patch.control[i * (q + 1) + j];
    let along = |p: usize, lines: usize, at: &dyn Fn(usize, usize) -> DVec4| {
        let (mut first, mut second, mut ratio) = (0.0f64, 0.0f64, 1.0f64);
        for j in 0..lines {
            let (mut least, mut most) = (f64::INFINITY, 0.0f64);
            let line: Vec<DVec3> = (0..=p)
                .map(|i| {
                    let c = at(i, j);
                    (least, most) = (least.min(c.w), most.max(c.w));
                    c.truncate() / c.w
                })
                .collect();
            ratio = ratio.max(most / least);
            first = line.windows(2).fold(first, |m, w| m.max(w[0].distance(w[1])));
            second = line.windows(3).fold(second, |m, w| m.max((w[0] - 2.0 * w[1] + w[2]).length()));
        }
        let bend = if first > 0.0 { second * (p as f64 - 1.0) / first } else { 0.0 };
        // The exponent of the power of two below the ratio.
        let doublings = (power_of_two(ratio).to_bits() >> 52) as f64 - 1023.0;
        bend.max(NEARLY_FLAT * doublings)
    };
    [along(p, q + 1, &at), along(q, p + 1, &|j, i| at(i, j))]
}

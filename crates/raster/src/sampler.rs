//! Single samples at any position of the picture.

use crate::bins::Bins;
use crate::coverage::covers;
use crate::exact;
use crate::rect::Rect;
use crate::setup::Triangle;
use crate::{Rasterizer, cut, tile};
use gbuffer::Hit;
use pipeline::fragment::fragment;
use pipeline::newton::Outcome;
use pipeline::{Parameters, PieceRecord, Technique};

/// Side of a square of triangles that are looked through for one sample, pixels.
const SIDE: usize = 8;

/// Answers what the rasterizer would see if a sample stood at any position instead of at a pixel's centre.
///
/// Corners are moved by the sample's distance from its pixel's centre *before* they are snapped, and then the stages
/// of [`Rasterizer::render`] run: at a pixel's centre the answer is that of the picture, to the bit. Elsewhere
/// moving rounds positions once more, by at most half an ulp of a pixel position (2⁻¹⁴ pixel below 2048).
#[derive(Debug)]
pub struct PointSampler<'a> {
    raster: &'a Rasterizer<'a>,
    bins: Bins,
}

impl<'a> PointSampler<'a> {
    pub(crate) fn new(raster: &'a Rasterizer<'a>) -> Self {
        let Rasterizer { drawing, geometry } = raster;
        let bins = Bins::new(drawing.viewport, SIDE, geometry.triangles(), |i, add| {
            geometry.ids(drawing, i, |id| {
                let corners = geometry.corners(drawing, id);
                let side = |axis: usize| {
                    let values = corners.map(|c| c.position[axis]);
                    let [low, high] = [f32::min, f32::max].map(|pick| values.into_iter().reduce(pick));
                    // A pixel of margin holds what snapping, moving and narrowing to whole pixels can do.
                    [low.expect("three corners") as i32 - 1, high.expect("three corners") as i32 + 2]
                };
                let ([left, right], [top, bottom]) = (side(0), side(1));
                add(id, Rect { left, top, right, bottom });
            });
        });
        Self { raster, bins }
    }

    /// What is seen at (x, y), pixels from the top left corner; `None` also outside the picture.
    ///
    /// Its distance is taken along the ray through (x, y).
    pub fn sample(&self, x: f64, y: f64) -> Option<Hit> {
        // At equal depth the earlier triangle, as in the picture.
        let nearer = |a: Sample, b: Sample| if b.depth > a.depth { b } else { a };
        let seen = self.samples(x, y).into_iter().reduce(nearer)?;
        Some(self.hit(&seen, [x, y]))
    }

    /// All layers at (x, y), hidden ones too, nearest first.
    pub fn layers(&self, x: f64, y: f64) -> Vec<Hit> {
        let mut samples = self.samples(x, y);
        samples.sort_by(|a, b| b.depth.total_cmp(&a.depth));
        samples.iter().map(|sample| self.hit(sample, [x, y])).collect()
    }

    /// Every triangle that covers (x, y) in front of the far plane, in drawing order.
    fn samples(&self, x: f64, y: f64) -> Vec<Sample> {
        let Rasterizer { drawing, geometry } = self.raster;
        let inside = |t: f64, side: usize| t >= 0.0 && t < side as f64;
        if !inside(x, drawing.viewport.width()) || !inside(y, drawing.viewport.height()) {
            return vec![];
        }
        let [column, row] = [x, y].map(|t| t as usize);
        let shift = [x - (column as f64 + 0.5), y - (row as f64 + 0.5)].map(|d| d as f32);
        let pixel = [column, row].map(|t| t as i32);
        let triangles = self.bins.of_pixel(column, row).iter();
        let interpolated = |&id: &u32| {
            let triangle = Triangle::new(geometry.corners(drawing, id), shift)?;
            if !covers(&triangle, pixel[0], pixel[1]) {
                return None;
            }
            let weights = triangle.weights(pixel[0], pixel[1]);
            let depth = triangle.depth(weights);
            let attributes = geometry.attributes(drawing, id);
            let normal = drawing.options.interpolated_normals.then(|| triangle.interpolate(weights, attributes.normal));
            let place = Parameters { span: attributes.span, uv: triangle.interpolate(weights, attributes.uv) };
            let (face, at) = (attributes.face, [x as f32, y as f32]);
            let is_drawn = depth > 0.0 && cut::is_drawn(self.raster, face, place, at);
            is_drawn.then(|| Sample { face, place: cut::shown(self.raster, face, place, at), normal, depth })
        };
        let solved = |&id: &u32| {
            let (piece, triangle) = exact::far_side(self.raster, id, shift)?;
            if !covers(&triangle, pixel[0], pixel[1]) {
                return None;
            }
            match exact::look(self.raster, piece, [x as f32, y as f32]) {
                Outcome::Hit { uv, depth } if depth > 0.0 => {
                    let PieceRecord { face, span_u, span_v, .. } = drawing.proxy.pieces[piece];
                    Some(Sample { face, place: Parameters { span: [span_u, span_v], uv }, normal: None, depth })
                }
                _ => None,
            }
        };
        match drawing.proxy.technique() {
            Technique::Fragment => triangles.filter_map(interpolated).collect(),
            Technique::Exact => triangles.filter_map(solved).collect(),
        }
    }

    /// The fragment program at a sample.
    fn hit(&self, sample: &Sample, position: [f64; 2]) -> Hit {
        let drawing = &self.raster.drawing;
        let fragment = fragment(drawing.scene, sample.face, sample.place, drawing.options.curvature);
        tile::hit(self.raster, &fragment, position, sample.normal)
    }
}

/// What is drawn at a position.
struct Sample {
    face: u32,
    place: Parameters,
    /// The interpolated normal, where it is asked for.
    normal: Option<[f32; 3]>,
    depth: f32,
}

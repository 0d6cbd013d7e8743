//! Who is seen on the CPU: the nearest triangle carries (u, v).

use super::cut::{self, Waiting};
use super::outline::Outline;
use pipeline::{Mesh, Parameters};
use raster::Drawing;
use raster::bins::Bins;
use raster::coverage::{covers, for_each_covered};
use raster::depth::DepthTile;
use raster::geometry::{Attributes, Geometry};
use raster::rect::Rect;
use raster::setup::Triangle;
use raster::visibility::{Carried, Run, Samples, Seen, Visibility, of_pixel};
use std::borrow::Cow;

/// Triangles in the picture.
pub struct Triangles<'a> {
    drawing: Drawing<'a>,
    geometry: Geometry<'a>,
    bins: Bins,
}

impl<'a> Triangles<'a> {
    /// Runs the vertex stage, clips, and sorts triangles into tiles.
    pub fn new(mesh: Cow<'a, Mesh>, drawing: Drawing<'a>) -> Self {
        let geometry = Geometry::new(mesh, drawing.views, drawing.viewport);
        let bins = Bins::of_tiles(&geometry, drawing.viewport);
        Self { drawing, geometry, bins }
    }

    fn set_up(&self, id: u32) -> Triangle {
        Triangle::new(self.geometry.corners(id), [0.0; 2]).expect("what has no area is in no bin")
    }

    /// What a triangle carries to where it has these weights, and so this place.
    fn carried(&self, triangle: &Triangle, weights: [f32; 3], attributes: &Attributes, place: Parameters) -> Carried {
        if cut::is_on_skirt(&self.drawing, attributes.face, place) {
            return Carried::Nothing;
        }
        let normal = triangle.interpolate(weights, attributes.normal);
        Carried::Point { normal, depth: triangle.carried_depth(weights) }
    }
}

impl Visibility for Triangles<'_> {
    fn tile(&self, rect: Rect, resolve: &mut dyn FnMut(&Run)) -> Vec<(usize, usize)> {
        let Self { drawing, geometry, bins } = self;
        let triangles = bins.of_pixel(rect.left as usize, rect.top as usize);
        let mut tile = DepthTile::new(rect);
        let mut waiting = Waiting::default();
        for (owner, &id) in triangles.iter().enumerate() {
            let triangle = self.set_up(id);
            let nearest = triangle.nearest();
            let attributes = geometry.attributes(id);
            let is_bounded = cut::is_bounded(drawing, attributes.face);
            if !is_bounded {
                // Of equal depths the one drawn first stays.
                waiting.decide(drawing, &mut tile);
            }
            let reaches_skirt = cut::reaches_skirt(drawing, &attributes);
            for_each_covered(&triangle, rect, |x, y| {
                // No point of a triangle is nearer than its nearest corner: most hidden samples end here. What a skirt shows may be.
                if !reaches_skirt && !tile.passes(x, y, nearest) {
                    return;
                }
                let depth = triangle.depth(x, y);
                if !is_bounded {
                    tile.test(x, y, depth, owner as u32);
                } else if reaches_skirt || tile.passes(x, y, depth) {
                    let weights = triangle.weights(x, y);
                    let place = Parameters { span: attributes.span, uv: triangle.interpolate(weights, attributes.uv) };
                    waiting.add(drawing, &mut tile, attributes.face, place, ([x, y], depth, owner as u32));
                }
            });
        }
        waiting.decide(drawing, &mut tile);
        let (pixels, starts) = tile.by_owner(triangles.len());
        let mut run = Run::default();
        for (owner, &id) in triangles.iter().enumerate() {
            let seen = &pixels[starts[owner] as usize..starts[owner + 1] as usize];
            if seen.is_empty() {
                continue;
            }
            let attributes = geometry.attributes(id);
            if attributes.face != run.face {
                run.hand_over(resolve);
                run.face = attributes.face;
            }
            let triangle = self.set_up(id);
            for &pixel in seen {
                let (x, y) = rect.position(pixel);
                let weights = triangle.weights(x, y);
                let place = Parameters { span: attributes.span, uv: triangle.interpolate(weights, attributes.uv) };
                let shown = cut::shown(drawing, attributes.face, place, [x as f32 + 0.5, y as f32 + 0.5]);
                run.places.push(shown);
                if drawing.options.vertex_normals {
                    run.carried.push(self.carried(&triangle, weights, &attributes, place));
                }
            }
            run.pixels.extend_from_slice(seen);
        }
        run.hand_over(resolve);
        vec![]
    }

    fn samples(&self) -> Box<dyn Samples + '_> {
        let bins = Bins::of_samples(&self.geometry, self.drawing.viewport);
        let mut outlines = vec![Outline::default(); self.geometry.ids_end()];
        for i in 0..self.geometry.triangles() {
            self.geometry.ids(i, |id| outlines[id as usize] = Outline::new(&self.geometry, id));
        }
        Box::new(Positions { triangles: self, bins, outlines })
    }
}

/// The same triangles, asked at any position.
struct Positions<'a> {
    triangles: &'a Triangles<'a>,
    bins: Bins,
    /// By id: a square may hold thousands of triangles, and few of them are near a position.
    outlines: Vec<Outline>,
}

impl Samples for Positions<'_> {
    fn layers(&self, x: f64, y: f64) -> Vec<Seen> {
        let Triangles { drawing, geometry, .. } = self.triangles;
        let ([column, row], shift) = of_pixel(x, y);
        let interpolated = |&id: &u32| {
            let triangle = Triangle::new(geometry.corners(id), shift)?;
            let pixel = [column, row].map(|t| t as i32);
            if !covers(&triangle, pixel[0], pixel[1]) {
                return None;
            }
            let weights = triangle.weights(pixel[0], pixel[1]);
            let depth = triangle.depth(pixel[0], pixel[1]);
            let attributes = geometry.attributes(id);
            let place = Parameters { span: attributes.span, uv: triangle.interpolate(weights, attributes.uv) };
            let (face, at) = (attributes.face, [x as f32, y as f32]);
            cut::drawn(drawing, face, place, at, depth).map(|depth| {
                let shown = cut::shown(drawing, face, place, at);
                let carried = self.triangles.carried(&triangle, weights, &attributes, place);
                let carried = drawing.options.vertex_normals.then_some(carried);
                Seen { face, place: shown, carried, depth }
            })
        };
        let near = |id: &&u32| self.outlines[**id as usize].may_cover([x as f32, y as f32]);
        self.bins.of_pixel(column, row).iter().filter(near).filter_map(interpolated).collect()
    }
}

//! The pixels of a window, and egui's triangles painted on them.

use crate::textures::{Textures, texel};
use egui::epaint::{Mesh, Primitive, Vertex};
use egui::{ClippedPrimitive, Rect};
use gbuffer::Picture;

/// Places on which corners come to lie, for each pixel.
const STEPS: f32 = 256.0;

/// Half a pixel, in the same steps.
const HALF: i64 = 128;

/// Pixels, row-major from the top, each 0x00RRGGBB.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u32>,
}

impl Canvas {
    /// A black one.
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![0; width * height] }
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The pixels, row-major from the top, each 0x00RRGGBB.
    pub fn pixels(&self) -> &[u32] {
        &self.pixels
    }

    /// The same as a picture; `None` where it has no pixels.
    pub fn picture(&self) -> Option<Picture> {
        let rgb = self.pixels.iter().map(|pixel| [(pixel >> 16) as u8, (pixel >> 8) as u8, *pixel as u8]).collect();
        Picture::new(self.width, self.height, rgb).ok()
    }

    /// Paints what egui asks for, in its order.
    pub(crate) fn paint(&mut self, primitives: &[ClippedPrimitive], pixels_per_point: f32, textures: &Textures) {
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            // Callbacks are for programs that paint by themselves; ours do not.
            if let Primitive::Mesh(mesh) = primitive {
                self.mesh(mesh, *clip_rect, pixels_per_point, textures);
            }
        }
    }

    fn mesh(&mut self, mesh: &Mesh, clip: Rect, pixels_per_point: f32, textures: &Textures) {
        let Some(image) = textures.get(mesh.texture_id) else { return };
        let within = |x: f32, most: usize| ((x * pixels_per_point).round().max(0.0) as usize).min(most);
        let clip = [
            [within(clip.min.x, self.width), within(clip.max.x, self.width)],
            [within(clip.min.y, self.height), within(clip.max.y, self.height)],
        ];
        for corners in mesh.indices.chunks_exact(3) {
            let vertices = [0, 1, 2].map(|k| mesh.vertices.get(corners[k] as usize));
            if let [Some(a), Some(b), Some(c)] = vertices {
                triangle([a, b, c], clip, pixels_per_point, |[x, y], colour, uv| {
                    let shown = texel(image, uv).to_array();
                    let source = [0, 1, 2, 3].map(|k| colour[k] * f32::from(shown[k]) / 255.0);
                    blend(&mut self.pixels[y * self.width + x], source);
                });
            }
        }
    }
}

/// Lays a colour, red to blue multiplied by its opacity, 0 to 255, over a pixel.
fn blend(pixel: &mut u32, [r, g, b, a]: [f32; 4]) {
    let through = 1.0 - a / 255.0;
    let channel = |shift: u32, source: f32| {
        let below = (*pixel >> shift & 0xff) as f32;
        ((source + below * through).round().clamp(0.0, 255.0) as u32) << shift
    };
    *pixel = channel(16, r) | channel(8, g) | channel(0, b);
}

/// Gives each pixel of a triangle, its colour and its place on the texture. A pixel's centre on an edge is of the triangle to its
/// right, or below, so that no pixel of a mesh is painted twice.
fn triangle(
    vertices: [&Vertex; 3],
    [columns, rows]: [[usize; 2]; 2],
    pixels_per_point: f32,
    mut paint: impl FnMut([usize; 2], [f32; 4], [f32; 2]),
) {
    let place = |vertex: &Vertex| {
        let [x, y] = [vertex.pos.x, vertex.pos.y].map(|x| (x * pixels_per_point * STEPS).round() as i64);
        [x, y]
    };
    let mut corners = vertices.map(|vertex| (place(vertex), vertex));
    let area = cross(corners[0].0, corners[1].0, corners[2].0);
    if area == 0 {
        return;
    }
    if area < 0 {
        corners.swap(1, 2);
    }
    let area = area.unsigned_abs() as f32;
    let places = corners.map(|(place, _)| place);
    let reach = |axis: usize, [from, to]: [usize; 2]| {
        let along = places.map(|place| place[axis]);
        let (least, most) = (along.into_iter().min().unwrap_or(0), along.into_iter().max().unwrap_or(0));
        let pixel = |x: i64| x.div_euclid(2 * HALF).max(0) as usize;
        pixel(least).max(from)..(pixel(most) + 1).min(to)
    };
    // Edge k is across from corner k; along a top or a left one, a centre on it is inside.
    let edges = [[1, 2], [2, 0], [0, 1]].map(|[from, to]: [usize; 2]| {
        let (from, to) = (places[from], places[to]);
        let is_inside_on = to[1] < from[1] || (to[1] == from[1] && to[0] > from[0]);
        (from, to, i64::from(!is_inside_on))
    });
    for y in reach(1, rows) {
        for x in reach(0, columns) {
            let centre = [x, y].map(|x| x as i64 * 2 * HALF + HALF);
            let weights = edges.map(|(from, to, least)| (cross(from, to, centre), least));
            if weights.iter().any(|(weight, least)| weight < least) {
                continue;
            }
            let shares = weights.map(|(weight, _)| weight as f32 / area);
            let mean = |of: &dyn Fn(&Vertex) -> f32| (0..3).map(|k| shares[k] * of(corners[k].1)).sum::<f32>();
            let colour = [0, 1, 2, 3].map(|k| mean(&|vertex| f32::from(vertex.color.to_array()[k])));
            paint([x, y], colour, [mean(&|vertex| vertex.uv.x), mean(&|vertex| vertex.uv.y)]);
        }
    }
}

/// Twice the area of a triangle, positive where its corners go clockwise as seen, with rows counted downward.
fn cross(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Color32, Pos2};

    fn vertex(x: f32, y: f32) -> Vertex {
        Vertex { pos: Pos2::new(x, y), uv: Pos2::new(x / 8.0, y / 8.0), color: Color32::WHITE }
    }

    #[test]
    fn triangles_that_share_edges_paint_each_pixel_once() {
        // A fan about a centre of pixels and of edges, in both senses of turning.
        let (rim, hub) = ([[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]], vertex(3.5, 4.5));
        let mut painted = [[0; 8]; 8];
        for k in 0..4 {
            let [a, b] = [rim[k], rim[(k + 1) % 4]].map(|[x, y]| vertex(x, y));
            let corners = if k % 2 == 0 { [&a, &b, &hub] } else { [&b, &a, &hub] };
            triangle(corners, [[0, 8]; 2], 1.0, |[x, y], _, [u, v]| {
                painted[y][x] += 1;
                // Places on a texture are those of the pixels' centres.
                let expected = [x, y].map(|x| (x as f32 + 0.5) / 8.0);
                assert!((u - expected[0]).abs() < 1e-6 && (v - expected[1]).abs() < 1e-6);
            });
        }
        assert_eq!(painted, [[1; 8]; 8]);
    }

    #[test]
    fn what_is_clipped_stays_unpainted_and_half_opaque_colours_mix() {
        let corners = [vertex(-100.0, -100.0), vertex(300.0, -100.0), vertex(-100.0, 300.0)];
        let mut painted = vec![];
        triangle([&corners[0], &corners[1], &corners[2]], [[2, 4], [1, 2]], 1.0, |at, _, _| painted.push(at));
        assert_eq!(painted, [[2, 1], [3, 1]]);
        let mut pixel = 0x00_64_00_ff;
        blend(&mut pixel, [50.0, 50.0, 0.0, 127.5]);
        assert_eq!(pixel, 0x00_64_32_80);
        blend(&mut pixel, [1.0, 2.0, 3.0, 255.0]);
        assert_eq!(pixel, 0x00_01_02_03);
    }
}

//! Technique `exact` on the CPU: hulls cover pixels, each of these looks for the piece inside, and the nearest point stays.
//!
//! A hull is drawn by its far side alone: each pixel of it has one fragment then, and has it, too, where the near plane
//! or the eye is inside the hull.

use super::hulls::{CORNERS, Hulls};
use super::newton::{self, Outcome};
use super::record::PieceRecord;
use super::together;
use lanes::Level;
use pipeline::{Parameters, Sight};
use raster::Drawing;
use raster::bins::Bins;
use raster::coverage::{covers, for_each_covered};
use raster::depth::DepthTile;
use raster::geometry::Geometry;
use raster::rect::{Rect, TILE};
use raster::setup::Triangle;
use raster::visibility::{Run, Samples, Seen, Visibility, of_pixel};
use std::borrow::Cow;

/// Hulls in the picture.
pub struct Searches<'a> {
    drawing: Drawing<'a>,
    pieces: &'a [PieceRecord],
    geometry: Geometry<'a>,
    bins: Bins,
}

impl<'a> Searches<'a> {
    /// Runs the vertex stage on the corners of hulls, clips, and sorts them into tiles.
    pub fn new(hulls: &'a Hulls, drawing: Drawing<'a>) -> Self {
        let geometry = Geometry::new(Cow::Borrowed(&hulls.mesh), drawing.views, drawing.viewport);
        let bins = Bins::of_tiles(&geometry, drawing.viewport);
        Self { drawing, pieces: &hulls.pieces, geometry, bins }
    }

    /// The piece of a triangle of a hull's far side, and the triangle set up for samples `shift` pixels off the pixels'
    /// centres; `None` for the near side, and where snapping leaves no area.
    fn far_side(&self, id: u32, shift: [f32; 2]) -> Option<(usize, Triangle)> {
        let triangle = Triangle::new(self.geometry.corners(id), shift)?;
        // Triangles run counterclockwise seen from outside, so what is seen from inside runs clockwise.
        let piece = self.geometry.first_vertex(id) as usize / CORNERS;
        (!triangle.is_counterclockwise()).then_some((piece, triangle))
    }

    /// Looks for a piece at a position of the picture, pixels from the top left corner.
    fn look(&self, piece: usize, at: [f32; 2]) -> Outcome {
        let piece = &self.pieces[piece];
        newton::solve(self.drawing.scene, piece, &Sight::new(&self.drawing.views[piece.face as usize], at)).outcome
    }
}

impl Visibility for Searches<'_> {
    fn tile(&self, rect: Rect, resolve: &mut dyn FnMut(&Run)) -> Vec<(usize, usize)> {
        let mut tile = DepthTile::new(rect);
        let mut uv = vec![[0.0; 2]; TILE * TILE];
        let mut unconverged = vec![];
        let mut owners: Vec<usize> = vec![];
        let (mut covered, mut sights, mut outcomes) = (vec![], vec![], vec![]);
        let level = Level::new();
        for &id in self.bins.of_pixel(rect.left as usize, rect.top as usize) {
            let Some((piece, triangle)) = self.far_side(id, [0.0; 2]) else { continue };
            let owner = owners.len() as u32;
            owners.push(piece);
            covered.clear();
            sights.clear();
            outcomes.clear();
            let view = &self.drawing.views[self.pieces[piece].face as usize];
            for_each_covered(&triangle, rect, |x, y| {
                covered.push([x, y]);
                sights.push(Sight::new(view, [x as f32 + 0.5, y as f32 + 0.5]));
            });
            together::solve_many(level, self.drawing.scene, &self.pieces[piece], &sights, &mut outcomes);
            for (&[x, y], outcome) in covered.iter().zip(&outcomes) {
                match *outcome {
                    Outcome::Hit { uv: found, depth } => {
                        if tile.passes(x, y, depth) {
                            uv[tile.index(x, y)] = found;
                            tile.test(x, y, depth, owner);
                        }
                    }
                    Outcome::Miss => {}
                    Outcome::Unconverged => unconverged.push((x as usize, y as usize)),
                }
            }
        }
        let (pixels, starts) = tile.by_owner(owners.len());
        let mut run = Run::default();
        for (owner, &piece) in owners.iter().enumerate() {
            let PieceRecord { face, span_u, span_v, .. } = self.pieces[piece];
            let seen = &pixels[starts[owner] as usize..starts[owner + 1] as usize];
            if seen.is_empty() {
                continue;
            }
            if face != run.face {
                run.hand_over(resolve);
                run.face = face;
            }
            let place = |&pixel: &u16| Parameters { span: [span_u, span_v], uv: uv[usize::from(pixel)] };
            run.places.extend(seen.iter().map(place));
            run.pixels.extend_from_slice(seen);
        }
        run.hand_over(resolve);
        unconverged
    }

    fn samples(&self) -> Box<dyn Samples + '_> {
        Box::new(Positions { searches: self, bins: Bins::of_samples(&self.geometry, self.drawing.viewport) })
    }
}

/// The same hulls, asked at any position.
struct Positions<'a> {
    searches: &'a Searches<'a>,
    bins: Bins,
}

impl Samples for Positions<'_> {
    fn layers(&self, x: f64, y: f64) -> Vec<Seen> {
        let ([column, row], shift) = of_pixel(x, y);
        let solved = |&id: &u32| {
            let (piece, triangle) = self.searches.far_side(id, shift)?;
            if !covers(&triangle, column as i32, row as i32) {
                return None;
            }
            match self.searches.look(piece, [x as f32, y as f32]) {
                Outcome::Hit { uv, depth } if depth > 0.0 => {
                    let PieceRecord { face, span_u, span_v, .. } = self.searches.pieces[piece];
                    Some(Seen { face, place: Parameters { span: [span_u, span_v], uv }, carried: None, depth })
                }
                _ => None,
            }
        };
        self.bins.of_pixel(column, row).iter().filter_map(solved).collect()
    }
}

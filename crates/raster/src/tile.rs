//! One tile: who is seen, then what is seen.

use crate::Rasterizer;
use crate::coverage::for_each_covered;
use crate::cut::{self, Waiting, is_bounded};
use crate::depth::{DepthTile, TILE};
use crate::exact;
use crate::rect::Rect;
use crate::setup::Triangle;
use gbuffer::Hit;
use glam::DVec3;
use nurbs::Normal;
use pipeline::edge;
use pipeline::fragment::{Fragment, fragment_row};
use pipeline::newton::Outcome;
use pipeline::{Parameters, PieceRecord, Technique};

/// Fragments that wait for the fragment program, all of one face.
#[derive(Default)]
struct Run {
    face: u32,
    /// Pixels as row × [`TILE`] + column.
    pixels: Vec<u16>,
    places: Vec<Parameters>,
    /// Interpolated normals, where they are asked for.
    normals: Vec<[f32; 3]>,
    fragments: Vec<Fragment>,
}

/// What a tile shows.
pub struct Tile {
    /// Hits, row × [`TILE`] + column; empty where nothing is seen in it.
    pub hits: Vec<Option<Hit>>,
    /// Pixels (x, y) of the picture in which a search has not converged.
    pub unconverged: Vec<(usize, usize)>,
}

/// Draws a tile.
pub fn render(raster: &Rasterizer, triangles: &[u32], rect: Rect) -> Tile {
    match raster.drawing.proxy.technique() {
        Technique::Fragment => Tile { hits: interpolated(raster, triangles, rect), unconverged: vec![] },
        Technique::Exact => solved(raster, triangles, rect),
    }
}

/// Technique `exact`: every pixel of a hull's far side looks for the hull's piece, and the nearest point stays.
fn solved(raster: &Rasterizer, triangles: &[u32], rect: Rect) -> Tile {
    let drawing = &raster.drawing;
    let mut tile = DepthTile::new(rect);
    let mut uv = vec![[0.0; 2]; TILE * TILE];
    let mut unconverged = vec![];
    let mut owners: Vec<usize> = vec![];
    for &id in triangles {
        let Some((piece, triangle)) = exact::far_side(raster, id, [0.0; 2]) else { continue };
        let owner = owners.len() as u32;
        owners.push(piece);
        for_each_covered(&triangle, rect, |x, y| match exact::look(raster, piece, [x as f32 + 0.5, y as f32 + 0.5]) {
            Outcome::Hit { uv: found, depth } => {
                if tile.passes(x, y, depth) {
                    uv[tile.index(x, y)] = found;
                    tile.test(x, y, depth, owner);
                }
            }
            Outcome::Miss => {}
            Outcome::Unconverged => unconverged.push((x as usize, y as usize)),
        });
    }
    let (pixels, starts) = tile.by_owner(owners.len());
    let mut hits = vec![None; if pixels.is_empty() { 0 } else { TILE * TILE }];
    let mut run = Run::default();
    for (owner, &piece) in owners.iter().enumerate() {
        let PieceRecord { face, span_u, span_v, .. } = drawing.proxy.pieces[piece];
        let seen = &pixels[starts[owner] as usize..starts[owner + 1] as usize];
        if seen.is_empty() {
            continue;
        }
        if face != run.face {
            shade(raster, rect, &mut run, &mut hits);
            run.face = face;
        }
        let place = |&pixel: &u16| Parameters { span: [span_u, span_v], uv: uv[usize::from(pixel)] };
        run.places.extend(seen.iter().map(place));
        run.pixels.extend_from_slice(seen);
    }
    shade(raster, rect, &mut run, &mut hits);
    Tile { hits, unconverged }
}

/// Technique `fragment`: the nearest triangle carries (u, v).
fn interpolated(raster: &Rasterizer, triangles: &[u32], rect: Rect) -> Vec<Option<Hit>> {
    let Rasterizer { drawing, geometry } = raster;
    let mut tile = DepthTile::new(rect);
    let mut waiting = Waiting::default();
    for (owner, &id) in triangles.iter().enumerate() {
        let triangle = set_up(raster, id);
        let nearest = triangle.nearest();
        let attributes = geometry.attributes(drawing, id);
        let is_bounded = is_bounded(raster, attributes.face);
        if !is_bounded {
            // Of equal depths the one drawn first stays.
            waiting.decide(raster, &mut tile);
        }
        for_each_covered(&triangle, rect, |x, y| {
            // No point of a triangle is nearer than its nearest corner: most hidden samples end here.
            if !tile.passes(x, y, nearest) {
                return;
            }
            let weights = triangle.weights(x, y);
            let depth = triangle.depth(weights);
            if !is_bounded {
                tile.test(x, y, depth, owner as u32);
            } else if tile.passes(x, y, depth) {
                let place = Parameters { span: attributes.span, uv: triangle.interpolate(weights, attributes.uv) };
                waiting.add(raster, &mut tile, attributes.face, place, ([x, y], depth, owner as u32));
            }
        });
    }
    waiting.decide(raster, &mut tile);
    let (pixels, starts) = tile.by_owner(triangles.len());
    if pixels.is_empty() {
        return vec![];
    }
    let mut hits = vec![None; TILE * TILE];
    let mut run = Run::default();
    for (owner, &id) in triangles.iter().enumerate() {
        let seen = &pixels[starts[owner] as usize..starts[owner + 1] as usize];
        if seen.is_empty() {
            continue;
        }
        let attributes = geometry.attributes(drawing, id);
        if attributes.face != run.face {
            shade(raster, rect, &mut run, &mut hits);
            run.face = attributes.face;
        }
        let triangle = set_up(raster, id);
        for &pixel in seen {
            let (x, y) = position(rect, pixel);
            let weights = triangle.weights(x, y);
            let uv = triangle.interpolate(weights, attributes.uv);
            let place = Parameters { span: attributes.span, uv };
            run.places.push(cut::shown(raster, attributes.face, place, [x as f32 + 0.5, y as f32 + 0.5]));
            if drawing.options.interpolated_normals {
                run.normals.push(triangle.interpolate(weights, attributes.normal));
            }
        }
        run.pixels.extend_from_slice(seen);
    }
    shade(raster, rect, &mut run, &mut hits);
    hits
}

fn set_up(raster: &Rasterizer, id: u32) -> Triangle {
    Triangle::new(raster.geometry.corners(&raster.drawing, id), [0.0; 2]).expect("what has no area is in no bin")
}

fn position(rect: Rect, pixel: u16) -> (i32, i32) {
    (rect.left + i32::from(pixel) % TILE as i32, rect.top + i32::from(pixel) / TILE as i32)
}

/// Runs the fragment program on all that waits.
fn shade(raster: &Rasterizer, rect: Rect, run: &mut Run, hits: &mut [Option<Hit>]) {
    let drawing = &raster.drawing;
    fragment_row(drawing.scene, run.face, &run.places, drawing.options.curvature, &mut run.fragments);
    for (i, (&pixel, fragment)) in run.pixels.iter().zip(&run.fragments).enumerate() {
        let (x, y) = position(rect, pixel);
        let at = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        hits[usize::from(pixel)] = Some(hit(raster, fragment, at, run.normals.get(i).copied()));
    }
    run.pixels.clear();
    run.places.clear();
    run.normals.clear();
    run.fragments.clear();
}

/// What is seen at picture position `at`, with the interpolated normal in place of the fragment's where there is one.
pub fn hit(raster: &Rasterizer, fragment: &Fragment, at: [f64; 2], interpolated: Option<[f32; 3]>) -> Hit {
    let Rasterizer { drawing, .. } = raster;
    let edge = if drawing.scene.has_edges() {
        let view = &drawing.views[fragment.face as usize];
        let place = Parameters { span: fragment.span, uv: fragment.uv };
        let whole = drawing.scene.whole(fragment.face, place);
        let edge = edge::edge(drawing.scene, view, fragment.face, whole, at.map(|t| t as f32));
        // As a GPU records it.
        edge::unpacked(edge::packed(edge)).1
    } else {
        None
    };
    let fragment = &Fragment { edge, ..*fragment };
    let mut hit = drawing.scene.hit(fragment, &drawing.camera.ray(drawing.viewport, at[0], at[1]));
    if let Some([x, y, z]) = interpolated {
        let length = (x * x + y * y + z * z).sqrt();
        hit.normal = if length > 0.0 {
            Normal::Regular(DVec3::from_array([x / length, y / length, z / length].map(f64::from)))
        } else {
            Normal::Undefined
        };
    }
    hit
}

//! What is seen: the fragment program at the places that a technique has found.

use crate::drawing::Drawing;
use crate::rect::{Rect, TILE};
use crate::visibility::{Carried, Run, Seen, Visibility};
use gbuffer::Hit;
use glam::DVec3;
use nurbs::Normal;
use pipeline::fragment::{Fragment, fragment, fragment_row};
use pipeline::{Parameters, edge};
use scene::Ray;

/// Marks a pixel in which nothing is seen.
const NOTHING: u16 = u16::MAX;

/// What a tile shows, before it is widened. It is used for one tile after the other, and keeps its memory.
pub struct Tile {
    rect: Rect,
    /// Of each pixel, row × [`TILE`] + column, which of the fragments it shows, or [`NOTHING`].
    shown: Vec<u16>,
    /// The pixel of each fragment.
    pixels: Vec<u16>,
    fragments: Vec<Fragment>,
    /// What the triangles carry there, or none at all.
    carried: Vec<Carried>,
    /// Pixels (x, y) of the picture in which a search has not converged.
    pub undecided: Vec<(usize, usize)>,
}

impl Tile {
    /// Shows nothing.
    pub fn new() -> Self {
        let rect = Rect { left: 0, top: 0, right: 0, bottom: 0 };
        Self { rect, shown: vec![], pixels: vec![], fragments: vec![], carried: vec![], undecided: vec![] }
    }

    /// Draws a tile.
    pub fn draw(&mut self, drawing: &Drawing, visibility: &dyn Visibility, rect: Rect) {
        let Self { shown, pixels, fragments, carried, .. } = self;
        shown.clear();
        shown.resize(TILE * TILE, NOTHING);
        pixels.clear();
        fragments.clear();
        carried.clear();
        self.rect = rect;
        self.undecided = visibility.tile(rect, &mut |run: &Run| {
            for &pixel in &run.pixels {
                shown[usize::from(pixel)] = pixels.len() as u16;
                pixels.push(pixel);
            }
            carried.extend_from_slice(&run.carried);
            fragment_row(drawing.scene, run.face, &run.places, drawing.options.curvature, fragments);
        });
    }

    /// Which fragments row `y` of the picture shows, from the tile's left side on.
    pub fn row(&self, y: usize) -> impl Iterator<Item = Option<u16>> {
        let row = &self.shown[(y - self.rect.top as usize) * TILE..][..(self.rect.right - self.rect.left) as usize];
        row.iter().map(|&fragment| (fragment != NOTHING).then_some(fragment))
    }

    /// A fragment, widened.
    pub fn hit(&self, drawing: &Drawing, fragment: u16) -> Hit {
        let i = usize::from(fragment);
        let (x, y) = self.rect.position(self.pixels[i]);
        hit(drawing, &self.fragments[i], [f64::from(x) + 0.5, f64::from(y) + 0.5], self.carried.get(i))
    }
}

/// What is seen at a sample at picture position `at`.
pub fn sample(drawing: &Drawing, seen: &Seen, at: [f64; 2]) -> Hit {
    let fragment = fragment(drawing.scene, seen.face, seen.place, drawing.options.curvature);
    hit(drawing, &fragment, at, seen.carried.as_ref())
}

/// What is seen at picture position `at`, with what its triangle carries in place of the surface's own where there is that.
fn hit(drawing: &Drawing, fragment: &Fragment, at: [f64; 2], carried: Option<&Carried>) -> Hit {
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
    let ray = drawing.camera.ray(drawing.viewport, at[0], at[1]);
    let mut hit = drawing.scene.hit(fragment, &ray);
    if carried.is_some() {
        hit.curvature = None;
    }
    if let Some(Carried::Point { normal: [x, y, z], depth }) = carried {
        let length = (x * x + y * y + z * z).sqrt();
        hit.normal = if length > 0.0 {
            Normal::Regular(DVec3::from_array([x / length, y / length, z / length].map(f64::from)))
        } else {
            Normal::Undefined
        };
        if let Some(t) = distance(drawing, fragment.face, &ray, *depth) {
            (hit.t, hit.position) = (t, ray.at(t));
        }
    }
    hit
}

/// How far along a ray, model units, a point with this depth z / w is.
fn distance(drawing: &Drawing, face: u32, ray: &Ray, depth: f32) -> Option<f64> {
    let frame = &drawing.scene.frames()[face as usize];
    let m = drawing.views[face as usize].clip_from_local;
    // Where z − depth · w is 0.
    let plane = m.map(|column| f64::from(column[2]) - f64::from(depth) * f64::from(column[3]));
    let normal = DVec3::new(plane[0], plane[1], plane[2]);
    let origin = (ray.origin - frame.origin) / frame.scale;
    let t = -(normal.dot(origin) + plane[3]) / normal.dot(ray.direction) * frame.scale;
    Some(t).filter(|t| t.is_finite())
}

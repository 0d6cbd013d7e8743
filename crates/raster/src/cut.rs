//! Fragments of a face that loops bound, before the depth test: those whose face does not cover the pixel leave it to what
//! lies behind. They wait for each other, since the program runs fastest on many that follow each other on a face.

use crate::Rasterizer;
use crate::depth::{DepthTile, TILE};
use pipeline::fragment::{TangentPlane, tangent_plane, tangent_planes};
use pipeline::{BOUNDED, Sight};

/// How many may wait: enough to fill the program's lanes, and few enough that what they hide is soon known to be hidden.
const MOST: usize = 64;

/// Fragments that wait, in drawing order and all of one face.
#[derive(Default)]
pub struct Waiting {
    face: u32,
    samples: Vec<Sample>,
    uv: Vec<[f32; 2]>,
    planes: Vec<TangentPlane>,
    /// The parameters that pixels of bounded faces show, by their indices in the tile.
    shown: Vec<[f32; 2]>,
}

/// Where a fragment would stand.
struct Sample {
    at: [i32; 2],
    depth: f32,
    owner: u32,
}

impl Waiting {
    /// Adds a fragment of `face` at pixel `at`, whose depth and owner go to `tile` if the face covers its centre.
    pub fn add(
        &mut self,
        raster: &Rasterizer,
        tile: &mut DepthTile,
        face: u32,
        uv: [f32; 2],
        (at, depth, owner): ([i32; 2], f32, u32),
    ) {
        if face != self.face || self.samples.len() == MOST {
            self.decide(raster, tile);
            self.face = face;
        }
        self.samples.push(Sample { at, depth, owner });
        self.uv.push(uv);
    }

    /// Decides about all that wait.
    pub fn decide(&mut self, raster: &Rasterizer, tile: &mut DepthTile) {
        let drawing = &raster.drawing;
        if !self.samples.is_empty() {
            tangent_planes(drawing.scene, self.face, &self.uv, &mut self.planes);
            self.shown.resize(TILE * TILE, [0.0; 2]);
        }
        for ((&Sample { at: [x, y], depth, owner }, &uv), plane) in self.samples.iter().zip(&self.uv).zip(&self.planes)
        {
            if !tile.passes(x, y, depth) {
                continue;
            }
            let sight = Sight::new(&drawing.views[self.face as usize], [x as f32 + 0.5, y as f32 + 0.5]);
            if let Some(uv) = sight.shown(drawing.scene, self.face, uv, plane) {
                self.shown[tile.index(x, y)] = uv;
                tile.test(x, y, depth, owner);
            }
        }
        self.samples.clear();
        self.uv.clear();
        self.planes.clear();
    }

    /// The parameters that a pixel shows where a bounded face is seen in it.
    pub fn shown(&self, pixel: u16) -> [f32; 2] {
        self.shown[usize::from(pixel)]
    }
}

/// The parameters that a fragment of a face, interpolated at picture position `at`, shows if it is not cut away.
pub fn shown(raster: &Rasterizer, face: u32, uv: [f32; 2], at: [f32; 2]) -> Option<[f32; 2]> {
    if !is_bounded(raster, face) {
        return Some(uv);
    }
    let scene = raster.drawing.scene;
    Sight::new(&raster.drawing.views[face as usize], at).shown(scene, face, uv, &tangent_plane(scene, face, uv))
}

/// Whether some fragments of a face may be cut away.
pub fn is_bounded(raster: &Rasterizer, face: u32) -> bool {
    raster.drawing.scene.faces[face as usize].flags & BOUNDED != 0
}

//! Technique `grid`: where its corners are, and that grids meet vertex on vertex.

use pipeline::{PackedScene, Scheme};
use scene::{Camera, FaceId, Model, Viewport};
use techniques::grid::Grids;

fn grids(model: &Model, error_px: f64) -> (PackedScene, Grids) {
    let viewport = Viewport::new(256, 256).expect("a legal size");
    let camera = Camera::framing(model, viewport);
    let scene = PackedScene::new(model, Scheme::Specialised).expect("it packs");
    let grids = Grids::new(model, &scene, &camera, viewport, error_px).expect("few triangles");
    (scene, grids)
}

#[test]
fn every_corner_is_on_its_face_at_its_own_parameters() {
    for name in ["teapot", "torus", "sphere", "surface", "rational", "spray"] {
        let model = formats::builtin(name).expect("built in");
        let (scene, grids) = grids(&model, 0.25);
        for vertex in &grids.mesh.vertices {
            let surface = model.surface(FaceId(vertex.face));
            let uv = scene.frames()[vertex.face as usize].uv(vertex.span, vertex.uv);
            let expected = surface.point(uv.x, uv.y);
            let found = scene.frames()[vertex.frame as usize].world(vertex.position);
            let size = model.hull().diagonal();
            assert!(found.distance(expected) < 1e-5 * size, "{name}: {vertex:?} at {found}, not {expected}");
        }
    }
}

/// Flat triangles against the surface at 36 places of each.
#[test]
fn no_triangle_is_farther_from_its_face_than_the_chord_says() {
    for name in ["teapot", "torus", "sphere", "surface", "rational"] {
        let model = formats::builtin(name).expect("built in");
        for error_px in [0.25, 2.0] {
            let (scene, grids) = grids(&model, error_px);
            for corners in grids.mesh.indices.chunks_exact(3) {
                let corners = [0, 1, 2].map(|k| grids.mesh.vertices[corners[k] as usize]);
                let (face, span) = (corners[0].face, corners[0].span);
                let frame = &scene.frames()[face as usize];
                let positions = corners.map(|v| scene.frames()[v.frame as usize].world(v.position));
                let index = span[0] as usize * (frame.breaks[1].len() - 1) + span[1] as usize;
                let chord = grids.chord[face as usize][index];
                for (i, j) in (0..8).flat_map(|i| (0..8 - i).map(move |j| (i, j))) {
                    let weights = [f64::from(i) / 7.0, f64::from(j) / 7.0, f64::from(7 - i - j) / 7.0];
                    let flat: glam::DVec3 = (0..3).map(|k| positions[k] * weights[k]).sum();
                    let uv = [0, 1].map(|c| (0..3).map(|k| f64::from(corners[k].uv[c]) * weights[k]).sum::<f64>());
                    let [u, v] = [0, 1].map(|k| {
                        let [start, end] = frame.span(k, span[k]);
                        start + (end - start) * uv[k]
                    });
                    let off = flat.distance(model.surface(FaceId(face)).point(u, v));
                    assert!(off <= chord, "{name}, {error_px} px: {off} beyond {chord} at {corners:?}");
                }
            }
        }
    }
}

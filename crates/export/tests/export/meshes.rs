//! Triangles: as near as they say, closed where the model is, and of the volume that they enclose.

use crate::{document, random, root, usual, write};
use export::ExportError;
use export::mesh::{GREATEST_TRIANGLES, Mesh, mesh};
use glam::{DVec2, DVec3};
use nurbs::{KnotVector, Projector, Surface};
use scene::{Face, FaceId, Loop, Model, Trim};
use serde_json::Value;
use std::f64::consts::PI;

fn meshed(model: &Model, error: f64) -> Mesh {
    mesh(model, error, &|_| {}).unwrap_or_else(|error| panic!("{error}"))
}

/// Each triangle's corners in space, by face.
fn triangles(mesh: &Mesh) -> impl Iterator<Item = (usize, [DVec3; 3])> + '_ {
    mesh.faces.iter().enumerate().flat_map(|(index, face)| {
        let point = |corner: u32| mesh.points[face.corners[corner as usize].point as usize];
        face.triangles.iter().map(move |triangle| (index, triangle.map(point)))
    })
}

/// Area, and volume by the divergence theorem.
fn area_and_volume(mesh: &Mesh) -> DVec2 {
    triangles(mesh).map(|(_, [a, b, c])| DVec2::new(0.5 * (b - a).cross(c - a).length(), a.dot(b.cross(c)) / 6.0)).sum()
}

/// What a distance all over the surface makes of area and volume is at most this, and the frozen figures are as good.
fn check(name: &str, mesh: &Mesh, area: f64, volume: f64) {
    let facts = &mesh.facts;
    assert_eq!((facts.open, facts.non_manifold), (0, 0), "{name}: {facts:?}");
    assert!(facts.euler % 2 == 0, "{name}: {facts:?}");
    let found = area_and_volume(mesh);
    assert!((found.y - volume).abs() <= facts.border * area + 2e-5 * volume, "{name}: {found} for {volume}");
    assert!((found.x - area).abs() <= 0.01 * area, "{name}: {found} for {area}");
}

#[test]
fn solids_are_closed_and_have_the_volume_of_their_closed_form() {
    let cases = [
        ("cylinder-seam", 28.0 * PI, 20.0 * PI, 2),
        ("cylinder-rings", 28.0 * PI, 20.0 * PI, 2),
        ("cylinder-reversed", f64::NAN, f64::NAN, 2),
        ("cone-apex", f64::NAN, f64::NAN, 2),
        ("ball-cut", f64::NAN, f64::NAN, 2),
        ("sphere-vertex", f64::NAN, f64::NAN, 2),
        ("sphere-seam", f64::NAN, f64::NAN, 2),
        ("spindle-apple", f64::NAN, f64::NAN, 2),
        ("oblique-cut", f64::NAN, f64::NAN, 2),
        ("paraboloid", f64::NAN, f64::NAN, 2),
        ("uniform-prism", f64::NAN, f64::NAN, 2),
        ("torus", 12.0 * PI * PI, 6.0 * PI * PI, 0),
    ];
    for (name, area, volume, euler) in cases {
        let document = document(&format!("step/{name}.step"));
        let mesh = meshed(&document.model, usual(&document.model));
        assert_eq!(mesh.facts.euler, euler, "{name}");
        match volume.is_nan() {
            true => assert_eq!((mesh.facts.open, mesh.facts.non_manifold), (0, 0), "{name}: {:?}", mesh.facts),
            false => check(name, &mesh, area, volume),
        }
    }
}

#[test]
fn solids_of_opencascade_are_closed_and_have_its_volume() {
    let text = std::fs::read_to_string(root().join("testdata/step/solids/solids.json")).expect("a file");
    let rows: Vec<Value> = serde_json::from_str(&text).expect("a list");
    for row in rows {
        let number = |key: &str| row[key].as_f64().expect("a number");
        for end in ["p", "n"] {
            let name = format!("step/solids/{}_{end}.step", row["name"].as_str().expect("a name"));
            let document = document(&name);
            check(&name, &meshed(&document.model, usual(&document.model)), number("area"), number("volume"));
        }
    }
}

/// The areas that OpenCASCADE 7.9.3 finds of the STEP files that are written (`tests/oracle/check_step.py`).
const AREAS: [(&str, f64); 6] = [
    ("plate", 1.8730099376),
    ("cap", 5.0724259010),
    ("islands", 0.8988116564),
    ("seam-pair", 4.2155512844),
    ("text", 1.0679199769),
    ("teapot", 52.8862427456),
];

/// The difference of a mesh's area from another, as a share of it.
fn area_error(mesh: &Mesh, area: f64) -> f64 {
    (area_and_volume(mesh).x / area - 1.0).abs()
}

#[test]
fn trimmed_faces_have_the_area_that_opencascade_finds() {
    for (name, area) in AREAS {
        let document = document(name);
        let mesh = meshed(&document.model, 0.2 * usual(&document.model));
        assert!(area_error(&mesh, area) < 1e-3, "{name}: {:e}", area_error(&mesh, area));
        let mut holed = mesh.clone();
        let count = holed.faces[0].triangles.len();
        holed.faces[0].triangles.truncate(count - (count / 100).max(1));
        assert!(area_error(&mesh, area) < area_error(&holed, area), "{name}: a hundredth of a face is missed");
    }
}

/// A mesh without one of its triangles has another volume.
#[test]
fn a_missing_triangle_is_seen() {
    let document = document("step/solids/solid_1_22_p.step");
    let mut mesh = meshed(&document.model, usual(&document.model));
    let whole = area_and_volume(&mesh);
    mesh.faces[2].triangles.pop();
    assert!(0.01 * whole.y < (area_and_volume(&mesh) - whole).y.abs());
}

/// Random points of triangles, projected back by the search of `nurbs`: none is farther than what is said to be proven.
fn farthest(model: &Model, mesh: &Mesh, count: usize) -> f64 {
    let projectors: Vec<Projector> =
        (0..model.faces().len()).map(|face| Projector::new(model.surface(FaceId(face as u32)))).collect();
    let all: Vec<(usize, [DVec3; 3])> = triangles(mesh).collect();
    let mut state = 5;
    let mut farthest: f64 = 0.0;
    for _ in 0..count {
        let (face, [a, b, c]) = all[(random(&mut state) * all.len() as f64) as usize];
        let (s, t) = (random(&mut state), random(&mut state));
        let (s, t) = if 1.0 < s + t { (1.0 - s, 1.0 - t) } else { (s, t) };
        farthest = farthest.max(projectors[face].nearest(a + (b - a) * s + (c - a) * t, None, 0.0).distance);
    }
    farthest
}

#[test]
fn no_point_of_a_triangle_is_farther_than_is_proven() {
    let cases = [
        ("plate", 0.1),
        ("cap", 1.0),
        ("teapot", 0.1),
        ("step/solids/solid_1_7_n.step", 1.0),
        ("cases/weights_2.json", 1.0),
    ];
    for (name, share) in cases {
        let document = document(name);
        let asked = share * usual(&document.model);
        let mesh = meshed(&document.model, asked);
        let found = farthest(&document.model, &mesh, 100);
        assert!(found <= mesh.facts.distance, "{name}: {found:e} of {:?}", mesh.facts);
        assert!(mesh.facts.border <= asked, "{name}: {asked:e} of {:?}", mesh.facts);
    }
}

/// The same points, of a mesh that is moved by twice what is said to be proven.
#[test]
fn a_moved_mesh_is_too_far() {
    let document = document("teapot");
    let mut mesh = meshed(&document.model, usual(&document.model));
    let by = 2.0 * mesh.facts.distance;
    mesh.points.iter_mut().for_each(|p| p.z += by);
    assert!(mesh.facts.distance < farthest(&document.model, &mesh, 50));
}

/// Eight patches of the teapot have a side that is a point: no triangle there has two corners in one place.
#[test]
fn poles_have_no_triangles_without_area() {
    for name in ["teapot", "step/sphere-vertex.step", "step/cone-apex.step", "cases/pole_3.json"] {
        let document = document(name);
        let mesh = meshed(&document.model, usual(&document.model));
        let size = document.model.hull().diagonal();
        for (face, [a, b, c]) in triangles(&mesh) {
            let area = 0.5 * (b - a).cross(c - a).length();
            assert!(1e-14 * size * size < area, "{name}, face {face}: {a} {b} {c}");
        }
    }
}

/// Patches of the teapot name no edges: their borders are open, and nothing else is.
#[test]
fn borders_without_names_are_counted_open() {
    let teapot = meshed(&document("teapot").model, 0.05).facts;
    assert!(0 < teapot.open && teapot.non_manifold == 0, "{teapot:?}");
    let pair = meshed(&document("seam-pair").model, 0.01);
    let shared = pair
        .faces
        .iter()
        .map(|face| face.corners.iter().map(|corner| corner.point).collect::<std::collections::BTreeSet<u32>>());
    let shared: Vec<_> = shared.collect();
    assert!(4 < shared[0].intersection(&shared[1]).count(), "an edge with a name has its points once");
    assert!(pair.facts.moved < 1e-5, "{:?}", pair.facts);
}

/// Two squares side by side, with a gap in the first one's loop where it runs along the border of its domain, at the end of the
/// edge that they share: it is a point, and the neighbour's corner is the same.
#[test]
fn a_gap_on_the_border_of_the_domain_opens_no_edge() {
    let model = |gap: f64| {
        let line = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("knots");
        let square = |y: f64| {
            let points = [[0.0, y], [0.0, y + 1.0], [1.0, y], [1.0, y + 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
            Surface::new(line.clone(), line.clone(), points.to_vec(), None).expect("a surface")
        };
        let face = |surface: usize, edges: [i64; 4], gap: f64| {
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
            let trim = |k: usize| {
                let end = corners[(k + 1) % 4] - if k == 0 { DVec2::new(gap, 0.0) } else { DVec2::ZERO };
                Trim { edge: Some(edges[k]), ..Trim::new(line.clone(), vec![corners[k], end], None) }
            };
            let boundary = Loop { outer: true, trims: (0..4).map(trim).collect() };
            Face { tolerance: 1e-4, loops: vec![boundary], ..Face::whole(surface) }
        };
        let faces = vec![face(0, [0, 1, 2, 3], gap), face(1, [4, 5, 0, 6], 0.0)];
        Model::new("two", vec![square(0.0), square(-1.0)], faces).expect("a model")
    };
    let [whole, gapped] = [0.0, 1e-6].map(|gap| meshed(&model(gap), 0.1).facts);
    assert_eq!((gapped.open, gapped.euler), (whole.open, 1), "{gapped:?}");
    assert!(0 < whole.open && whole.non_manifold == 0, "{whole:?}");
}

/// Corners' normals are those of the faces: on the side that the triangles are seen from.
#[test]
fn normals_are_unit_and_look_out_of_the_solid() {
    for name in ["step/cylinder-reversed.step", "step/sphere-seam.step", "step/solids/solid_1_45_p.step"] {
        let document = document(name);
        let mesh = meshed(&document.model, usual(&document.model));
        for face in &mesh.faces {
            for triangle in &face.triangles {
                let corners = triangle.map(|corner| face.corners[corner as usize]);
                let [a, b, c] = corners.map(|corner| mesh.points[corner.point as usize]);
                let flat = (b - a).cross(c - a).normalize();
                for corner in corners {
                    assert!((corner.normal.length() - 1.0).abs() < 1e-12, "{name}");
                    assert!(0.5 < corner.normal.dot(flat), "{name}: {} at {flat}", corner.normal);
                }
            }
        }
        assert!(0.0 < area_and_volume(&mesh).y, "{name}");
    }
}

#[test]
fn too_many_triangles_are_an_error_before_they_are_made() {
    let document = document("teapot");
    match write(&document, "stl", 1e-12) {
        Err(ExportError::TooManyTriangles { needed, limit, error, .. }) => {
            assert!(limit == GREATEST_TRIANGLES && limit as f64 <= needed && error == 1e-12);
        }
        other => panic!("{:?}", other.map(|(_, written)| written)),
    }
    assert!(matches!(write(&document, "stl", 1e-300), Err(ExportError::TooManyTriangles { .. })));
}

/// Lengths of 1e-163 have no squares, and the sides of this face count as points: nothing is left of it, and that is said.
#[test]
fn a_face_without_triangles_is_named() {
    let document = document("hostile/tiny-1e-163.json");
    let facts = meshed(&document.model, usual(&document.model)).facts;
    assert_eq!((facts.triangles, &facts.left_out[..]), (0, &[0][..]));
}

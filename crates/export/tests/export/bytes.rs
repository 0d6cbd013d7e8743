//! The files themselves, read by a few lines that know each format's own description.

use crate::{document, root, usual, write};
use export::{Asked, ExportError, export};
use glam::{DVec3, Vec3};
use serde_json::Value;
use std::collections::HashMap;

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}

fn vector(bytes: &[u8], at: usize) -> Vec3 {
    Vec3::from_array([0, 4, 8].map(|k| f32::from_bits(word(bytes, at + k))))
}

#[test]
fn an_stl_has_fifty_bytes_a_triangle_and_the_volume_of_the_solid() {
    let document = document("step/torus.step");
    let (bytes, written) = write(&document, "stl", usual(&document.model)).expect("written");
    let count = word(&bytes, 80) as usize;
    assert_eq!((bytes.len(), Some(count)), (84 + 50 * count, written.mesh.map(|facts| facts.triangles)));
    assert!(!bytes.starts_with(b"solid"));
    let volume: f64 = (0..count)
        .map(|k| {
            let [normal, a, b, c] = [0, 1, 2, 3].map(|j| vector(&bytes, 84 + 50 * k + 12 * j).as_dvec3());
            assert!(0.99 < normal.dot((b - a).cross(c - a).normalize()));
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    let expected = 6.0 * std::f64::consts::PI.powi(2);
    assert!((volume / expected - 1.0).abs() < 5e-3, "{volume}");
    assert!(written.notes.iter().any(|note| note.contains("f32")));
}

#[test]
fn an_obj_says_all_digits_and_each_edge_twice() {
    let document = document("step/solids/solid_1_53_p.step");
    let (bytes, written) = write(&document, "obj", usual(&document.model)).expect("written");
    let text = String::from_utf8(bytes).expect("text");
    let words = |key: &str| -> Vec<Vec<String>> {
        let of_key = text.lines().filter_map(|line| line.strip_prefix(key)).filter(|rest| rest.starts_with(' '));
        of_key.map(|rest| rest.split_whitespace().map(str::to_owned).collect()).collect()
    };
    let (points, normals, faces) = (words("v"), words("vn"), words("f"));
    assert_eq!(Some(faces.len()), written.mesh.map(|facts| facts.triangles));
    let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
    for face in &faces {
        let corners: Vec<[usize; 2]> = face
            .iter()
            .map(|corner| {
                let (point, normal) = corner.split_once("//").expect("point//normal");
                [point, normal].map(|number| number.parse().expect("a number"))
            })
            .collect();
        assert!(corners.iter().all(|[p, n]| (1..=points.len()).contains(p) && (1..=normals.len()).contains(n)));
        for k in 0..3 {
            *edges.entry((corners[k][0], corners[(k + 1) % 3][0])).or_default() += 1;
        }
    }
    assert!(edges.iter().all(|((a, b), count)| *count == 1 && edges.get(&(*b, *a)) == Some(&1)));
}

/// Header, JSON and binary chunk as the glTF 2.0 specification lays them out (section 4, Binary glTF).
pub fn glb(bytes: &[u8]) -> (Value, &[u8]) {
    assert_eq!((&bytes[..4], word(bytes, 4), word(bytes, 8) as usize), (b"glTF".as_slice(), 2, bytes.len()));
    let length = word(bytes, 12) as usize;
    assert_eq!((length % 4, &bytes[16..20]), (0, b"JSON".as_slice()));
    let head = serde_json::from_slice(&bytes[20..20 + length]).expect("JSON");
    let body = &bytes[20 + length..];
    assert_eq!((word(body, 0) as usize, &body[4..8]), (body.len() - 8, b"BIN\0".as_slice()));
    (head, &body[8..])
}

#[test]
fn a_glb_keeps_small_differences_of_large_coordinates() {
    // Coordinates up to 1e9.
    for name in ["cases/huge_2.json", "step/cone-inch-degree.step"] {
        let document = document(name);
        let (bytes, written) = write(&document, "glb", usual(&document.model)).expect("written");
        let (head, body) = glb(&bytes);
        let accessor = |k: usize| &head["accessors"][k];
        let vec3 = |value: &Value| DVec3::from_array([0, 1, 2].map(|k| value[k].as_f64().expect("a number")));
        let (node, count) = (&head["nodes"][0], accessor(0)["count"].as_u64().expect("a count") as usize);
        let offset = |k: usize| head["bufferViews"][k]["byteOffset"].as_u64().expect("a number") as usize;
        let positions: Vec<Vec3> = (0..count).map(|k| vector(body, offset(0) + 12 * k)).collect();
        let (min, max) =
            positions.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
        assert_eq!([vec3(&accessor(0)["min"]), vec3(&accessor(0)["max"])], [min.as_dvec3(), max.as_dvec3()]);
        let normals = (0..count).map(|k| vector(body, offset(1) + 12 * k).length());
        assert!(normals.into_iter().all(|length| (length - 1.0).abs() < 1e-6));
        let corners = accessor(2)["count"].as_u64().expect("a count") as usize;
        assert_eq!(Some(corners), written.mesh.map(|facts| 3 * facts.triangles));
        assert!((0..corners).all(|k| (word(body, offset(2) + 4 * k) as usize) < count));
        // In metres the box is that of the model, in its unit.
        let scale = vec3(&node["scale"]).x;
        assert_eq!(scale, document.unit.as_ref().map_or(1.0, |unit| unit.millimetres / 1e3));
        let [low, high] = [min, max].map(|p| vec3(&node["translation"]) + scale * p.as_dvec3());
        let (hull, size) = (document.model.hull(), document.model.hull().diagonal());
        let slack = 2e-3 * size * scale;
        assert!((low - hull.min * scale).abs().max_element() <= slack, "{name}: {low} of {}", hull.min);
        assert!((high - hull.max * scale).abs().max_element() <= slack, "{name}: {high} of {}", hull.max);
    }
}

#[test]
fn an_unknown_extension_is_told_what_there_is() {
    let document = document("plate");
    let asked = |error: f64| Asked { error, progress: &|_| {} };
    for name in ["plate.fbx", "plate", "plate.STEPP"] {
        let error = export(name.as_ref(), &document, asked(1.0)).expect_err("no writer");
        assert!(matches!(error, ExportError::UnknownExtension { .. }));
        let text = error.to_string();
        assert!([".json", ".step", ".stp", ".obj", ".stl", ".glb"].iter().all(|known| text.contains(known)), "{text}");
    }
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(export("plate.obj".as_ref(), &document, asked(wrong)), Err(ExportError::Error(_))));
    }
    assert!(!root().join("crates/export/plate.obj").exists());
}

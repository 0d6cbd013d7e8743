//! Where instances of subfigures stand.

use crate::writer::{DEPENDENT, INDEPENDENT, Writer, list};
use formats::FORMATS;
use glam::DVec3;
use scene::FaceId;

/// A bilinear patch that no rotation or reflection maps to itself.
const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [3.0, 5.0, 1.0]];

/// A move in the order of IGES 5.3, 3.6.2: the definition's matrix, the scale, the instance's matrix, and last the translation. Both
/// are reflections, the instance's with a translation of its own, and instances stand in each other.
#[test]
fn an_instance_is_scaled_then_turned_then_moved() {
    let mut w = Writer::new();
    let ends = "0.0,0.0,1.0,1.0,0.0,0.0,1.0,1.0";
    let text = format!("1,1,1,1,0,0,1,0,0,{ends},{},{},0.0,1.0,0.0,1.0", list(&[1.0; 4]), list(&CORNERS.concat()));
    let surface = w.add(128, 0, &text);
    w.set_status(surface, DEPENDENT);
    let of_definition = w.matrix([[0.0, 0.0, 1.0, 1.0], [1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 2.0]]);
    let inner = w.add(308, 0, &format!("0,1Ha,1,{surface}"));
    w.set_matrix(inner, of_definition);
    let of_instance = w.matrix([[1.0, 0.0, 0.0, 5.0], [0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, -4.0]]);
    let instance = w.add(408, 0, &format!("{inner},1.0,2.0,3.0,2.0"));
    w.set_matrix(instance, of_instance);
    let outer = w.add(308, 0, &format!("1,1Hb,1,{instance}"));
    let whole = w.add(408, 0, &format!("{outer},0.0,0.0,10.0,0.5"));
    w.set_matrix(whole, of_definition);
    w.set_status(whole, INDEPENDENT);
    let iges = FORMATS.iter().find(|format| format.name() == "IGES").expect("it is in the list");
    let document = iges.read(w.file().as_bytes(), "part.igs").unwrap_or_else(|error| panic!("{error}"));
    let definition = |p: DVec3| DVec3::new(p.z + 1.0, p.x, 2.0 - p.y);
    let expected = |p: DVec3| {
        let p = 2.0 * definition(p);
        let p = DVec3::new(p.x + 5.0, p.z, p.y - 4.0) + DVec3::new(1.0, 2.0, 3.0);
        definition(0.5 * p) + DVec3::new(0.0, 0.0, 10.0)
    };
    let found = document.model.surface(FaceId(0));
    for [x, y, z] in CORNERS {
        let point = expected(DVec3::new(x, y, z));
        let nearest = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[u, v]| found.point(u, v).distance(point));
        assert!(nearest.into_iter().fold(f64::INFINITY, f64::min) < 1e-12, "{point}: {nearest:?}");
    }
}

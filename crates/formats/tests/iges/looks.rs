//! Names and colours, against what was given to OpenCASCADE's writer (`tests/oracle/iges_looks.py`).

use crate::common::root;
use formats::{Attributes, Colour, SurfaceKind};

#[test]
fn faces_have_the_names_and_colours_of_the_file() {
    let document = formats::open(root().join("testdata/iges/looks.igs")).unwrap_or_else(|error| panic!("{error}"));
    let faces = document.model.faces().iter().zip(&document.attributes);
    assert_eq!(faces.len(), 9);
    for (face, Attributes { name, colour, surface, layers }) in faces {
        let hull = document.model.surfaces()[face.surface].hull();
        let (expected, is_block) = match hull.center().x {
            0.0 => ([200, 30, 60], true),
            x if x < 3.0 => ([90, 120, 200], true),
            _ => ([255, 255, 0], false),
        };
        assert_eq!(*colour, Some(Colour(expected)), "{hull:?}");
        assert_eq!(name.as_deref(), Some(if is_block { "block" } else { "pin" }), "{hull:?}");
        assert!(layers.is_empty(), "level 0 is none");
        assert_eq!(*surface == SurfaceKind::Plane, is_block || hull.max.z - hull.min.z < 1e-9, "{hull:?}");
    }
}

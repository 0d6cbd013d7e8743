//! EXR files as another program's reader takes them: the `exr` crate.

use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read};
use gbuffer::{GBuffer, Hit, Meta, PrincipalCurvatures};
use glam::{DVec2, DVec3};
use nurbs::{KnotVector, Normal, Surface};
use scene::{Camera, FaceId, Model, Viewport};
use std::io::Cursor;

/// A row of three pixels: a hit with all, nothing, and a hit without curvature and normal.
fn buffer() -> GBuffer {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
    let points = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::X + DVec3::Y];
    let model = Model::of_surfaces("square", vec![Surface::new(knots(), knots(), points, None).unwrap()]).unwrap();
    let viewport = Viewport::new(3, 1).unwrap();
    let hit = Hit {
        face: FaceId(7),
        uv: DVec2::new(0.25, 0.75),
        local: None,
        t: 3.5,
        position: DVec3::new(1.0, -2.0, 1e-3),
        normal: Normal::Regular(DVec3::new(0.0, 0.6, -0.8)),
        curvature: Some(PrincipalCurvatures { k1: 0.5, k2: -4.0 }),
        edge: None,
    };
    let bare = Hit { normal: Normal::Undefined, curvature: None, ..hit };
    let meta = Meta::new("test", "by hand", &model, &Camera::framing(&model, viewport));
    GBuffer::from_rows(viewport, meta, [vec![Some(hit), None, Some(bare)]])
}

fn written() -> Vec<u8> {
    let mut bytes = vec![];
    buffer().write_exr(&mut bytes).expect("memory takes all");
    bytes
}

#[test]
fn a_foreign_reader_finds_every_channel_with_its_numbers() {
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let image = reader.from_buffered(Cursor::new(written())).expect("a file of the format");
    let layer = image.layer_data;
    assert_eq!((layer.size.0, layer.size.1), (3, 1));
    assert!(layer.attributes.comments.is_some_and(|text| text.to_string().contains("by hand")));
    let numbers = |name: &str| -> Vec<f64> {
        let channel = layer.channel_data.list.iter().find(|channel| channel.name.to_string() == name);
        match &channel.expect("a channel of that name").sample_data {
            FlatSamples::F32(values) => values.iter().map(|x| f64::from(*x)).collect(),
            FlatSamples::U32(values) => values.iter().map(|x| f64::from(*x)).collect(),
            FlatSamples::F16(_) => panic!("half floats"),
        }
    };
    let of = |x: f32| f64::from(x);
    for (name, first) in [
        ("A", 1.0),
        ("N.X", 0.0),
        ("N.Y", of(0.6)),
        ("N.Z", of(-0.8)),
        ("P.X", 1.0),
        ("P.Y", -2.0),
        ("P.Z", of(1e-3)),
        ("face", 7.0),
        ("k1", 0.5),
        ("k2", -4.0),
        ("t", 3.5),
        ("u", 0.25),
        ("v", 0.75),
    ] {
        let numbers = numbers(name);
        assert_eq!(numbers[..2], [first, 0.0], "{name}");
        let is_known = !["N.X", "N.Y", "N.Z", "k1", "k2"].contains(&name);
        assert!(if is_known { numbers[2] == first } else { numbers[2].is_nan() }, "{name}: {numbers:?}");
    }
    assert_eq!(layer.channel_data.list.len(), 13);
}

#[test]
fn a_file_cut_short_is_no_file() {
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let bytes = written();
    assert!(reader.from_buffered(Cursor::new(bytes[..bytes.len() - 1].to_vec())).is_err());
}

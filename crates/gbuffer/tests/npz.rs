//! G-buffer files: what is written is read back, what others wrote is read, and what is wrong is refused by name.

use gbuffer::{GBuffer, GBufferError, Hit, Meta, PrincipalCurvatures, Trims};
use glam::{DVec2, DVec3};
use nurbs::Normal;
use scene::{FaceId, Viewport};
use serde_json::json;
use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use std::path::PathBuf;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

const WIDTH: usize = 5;
const HEIGHT: usize = 3;

fn meta() -> Meta {
    Meta {
        renderer: "raycast".to_owned(),
        technique: "rays".to_owned(),
        trims: Trims::Masks { error_px: 0.1 },
        model: "Kännchen 🫖".to_owned(),
        model_hash: "0123456789abcdef".to_owned(),
        camera: json!({"eye": [0.1, -2.0e-17, 1.0e300], "fov_deg": 40.0}),
        adapter: Some("an \"adapter\"\n".to_owned()),
        driver: None,
        compiler: None,
        version: "0.1.0".to_owned(),
    }
}

/// Five by three pixels, two of three hit, with every kind of normal and awkward numbers.
fn sample() -> GBuffer {
    let viewport = Viewport::new(WIDTH, HEIGHT).unwrap();
    let pixel = |i: usize| {
        let x = i as f64;
        let normal = match i % 4 {
            0 => Normal::Regular(DVec3::new(0.6, -0.0, 0.8)),
            1 => Normal::Limit(DVec3::NEG_Z),
            2 => Normal::Undefined,
            _ => Normal::Regular(DVec3::X),
        };
        let hit = Hit {
            face: FaceId(if i == 3 { i32::MAX as u32 } else { i as u32 }),
            uv: DVec2::new(-0.0, x / 3.0),
            local: None,
            t: f64::MIN_POSITIVE / 2.0 + x,
            position: DVec3::new(x.sqrt(), -x / 7.0, f64::MAX),
            normal,
            curvature: i.is_multiple_of(4).then_some(PrincipalCurvatures { k1: x * 1e-310, k2: -x / 9.0 }),
            edge: (i % 4 == 1).then(|| DVec2::new(-x / 16.0, 1.0 / 3.0)),
        };
        (i % 3 != 2).then_some(hit)
    };
    let rows = (0..HEIGHT).map(|y| (0..WIDTH).map(|x| pixel(y * WIDTH + x)).collect());
    GBuffer::from_rows(viewport, meta(), rows).with_undecided([(4, 2), (2, 0), (2, 0)]).with_edges(true)
}

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn read(name: &str, bytes: &[u8]) -> Result<GBuffer, GBufferError> {
    let path = path(name);
    std::fs::write(&path, bytes).unwrap();
    let result = GBuffer::read_npz(&path);
    std::fs::remove_file(&path).unwrap();
    result
}

/// Members of an archive, by name, unpacked.
type Members = BTreeMap<String, Vec<u8>>;

fn unpack(bytes: &[u8]) -> Members {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut members = Members::new();
    for i in 0..archive.len() {
        let mut entry = archive.by_index(i).unwrap();
        let mut bytes = vec![];
        entry.read_to_end(&mut bytes).unwrap();
        members.insert(entry.name().unwrap().into_owned(), bytes);
    }
    members
}

fn pack(members: &Members) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(vec![]));
    for (name, bytes) in members {
        archive.start_file(name.as_str(), SimpleFileOptions::default()).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// An array with a header of its own wording.
fn array(descr: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.bytes());
    bytes.extend(data);
    bytes
}

/// Reads the sample after a change to one of its members.
fn changed(name: &str, member: &str, change: impl Fn(Vec<u8>) -> Option<Vec<u8>>) -> Result<GBuffer, GBufferError> {
    let mut members = unpack(&sample().npz_bytes().unwrap());
    let key = format!("{member}.npy");
    let bytes = members.remove(&key).expect("the sample has the member");
    members.extend(change(bytes).map(|bytes| (key, bytes)));
    read(name, &pack(&members))
}

/// Replaces an element's bytes, counted from the end of the array.
fn patched(mut bytes: Vec<u8>, from_end: usize, element: &[u8]) -> Option<Vec<u8>> {
    let start = bytes.len() - from_end;
    bytes[start..start + element.len()].copy_from_slice(element);
    Some(bytes)
}

/// Where pixel `i` of an array of `size` bytes a pixel lies, from the end.
fn from_end(i: usize, size: usize) -> usize {
    (WIDTH * HEIGHT - i) * size
}

#[test]
fn a_buffer_is_read_back_bit_for_bit() {
    let buffer = sample();
    let path = path("round_trip.npz");
    buffer.write_npz(&path).unwrap();
    let back = GBuffer::read_npz(&path).unwrap();
    assert_eq!(back, buffer);
    // Equality of floats takes −0 for 0; the bytes do not.
    assert_eq!(back.npz_bytes().unwrap(), buffer.npz_bytes().unwrap());
    assert_eq!(std::fs::read(&path).unwrap(), buffer.npz_bytes().unwrap());
    assert_eq!(back.meta(), &meta());
    assert!(back.is_undecided(2, 0) && back.undecided() == 2);
}

#[test]
fn an_empty_picture_and_a_single_pixel_are_read_back() {
    for (width, height) in [(1, 1), (5000, 1), (1, 3)] {
        let rows = vec![vec![None; width]; height];
        let buffer = GBuffer::from_rows(Viewport::new(width, height).unwrap(), meta(), rows);
        let back = read(&format!("empty_{width}.npz"), &buffer.npz_bytes().unwrap()).unwrap();
        assert_eq!(back, buffer);
    }
}

#[test]
fn a_change_of_one_bit_changes_the_file() {
    let buffer = sample();
    let nudged = GBuffer::from_rows(
        buffer.viewport(),
        meta(),
        (0..HEIGHT).map(|y| {
            (0..WIDTH).map(|x| buffer.get(x, y).map(|h| Hit { t: f64::from_bits(h.t.to_bits() + 1), ..*h })).collect()
        }),
    )
    .with_undecided([(4, 2), (2, 0)]);
    assert_ne!(nudged.npz_bytes().unwrap(), buffer.npz_bytes().unwrap());
}

#[test]
fn a_file_that_numpy_wrote_is_read() {
    // numpy 2.4.6, savez_compressed: hit bool, face <i8, v <f4, undecided <i4, meta bytes; the rest as we write it.
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/numpy.npz");
    let buffer = GBuffer::read_npz(file).unwrap();
    assert_eq!(buffer.viewport(), Viewport::new(4, 3).unwrap());
    assert_eq!((buffer.covered(), buffer.undecided()), (3, 1));
    assert!(buffer.is_undecided(1, 2));
    assert_eq!(
        buffer.get(2, 1),
        Some(&Hit {
            face: FaceId(7),
            uv: DVec2::new(0.1, 0.25),
            local: None,
            t: 1.5,
            position: DVec3::new(1.0, 2.0, 3.0),
            normal: Normal::Regular(DVec3::Z),
            curvature: Some(PrincipalCurvatures { k1: 0.75, k2: -0.5 }),
            edge: None,
        })
    );
    assert_eq!(buffer.get(3, 2).unwrap().normal, Normal::Limit(DVec3::new(0.6, 0.8, 0.0)));
    assert_eq!(buffer.get(0, 2).unwrap().normal, Normal::Undefined);
    assert_eq!(buffer.get(0, 2).unwrap().face, FaceId(i32::MAX as u32));
    assert_eq!(buffer.meta().model, "drei Flächen");
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let bytes = sample().npz_bytes().unwrap();
    for length in (0..bytes.len()).step_by(7) {
        assert!(read("cut.npz", &bytes[..length]).is_err(), "{length} of {} bytes", bytes.len());
    }
}

#[test]
fn a_flipped_byte_is_refused_or_does_not_matter() {
    let buffer = sample();
    let bytes = buffer.npz_bytes().unwrap();
    for i in 0..bytes.len() {
        for flip in [0x01, 0xff] {
            let mut bad = bytes.clone();
            bad[i] ^= flip;
            if let Ok(back) = read("flipped.npz", &bad) {
                assert_eq!(back.npz_bytes().unwrap(), bytes, "byte {i}");
            }
        }
    }
}

#[test]
fn a_missing_array_is_named() {
    // Without either of k1 and k2 there are no curvatures; one alone is a mistake.
    for member in ["face", "u", "v", "pos", "normal", "k1", "k2", "meta"] {
        let error = changed("missing.npz", member, |_| None).unwrap_err();
        assert!(matches!(error, GBufferError::MissingArray { array, .. } if array == member), "{error}");
        assert!(error.to_string().contains("missing.npz"), "{error}");
    }
}

#[test]
fn arrays_that_may_be_absent_are_filled_in() {
    let sample = sample();
    let without = |members: &[&str], camera: &serde_json::Value| {
        let buffer = sample.clone().with_meta(Meta { camera: camera.clone(), ..meta() });
        let mut all = unpack(&buffer.npz_bytes().unwrap());
        members.iter().for_each(|member| assert!(all.remove(&format!("{member}.npy")).is_some()));
        read("absent.npz", &pack(&all))
    };
    let hits = |buffer: &GBuffer| buffer.pixels().map(Option::<&Hit>::cloned).collect::<Vec<Option<Hit>>>();
    let camera = &meta().camera;
    assert_eq!(hits(&without(&["hit"], camera).unwrap()), hits(&sample));
    let decided = without(&["undecided"], camera).unwrap();
    assert_eq!((hits(&decided), decided.undecided()), (hits(&sample), 0));
    let flat = without(&["k1", "k2"], camera).unwrap();
    assert!(flat.pixels().flatten().all(|hit| hit.curvature.is_none()));
    // An undefined normal was written as NaN, and a limit one is taken for a regular one.
    let bare = without(&["status"], camera).unwrap();
    for (found, hit) in bare.pixels().flatten().zip(sample.pixels().flatten()) {
        assert_eq!(found.normal.unit(), hit.normal.unit());
    }
    // t is (pos − o) · d; the camera stands at z = 10 and looks down.
    let down = scene::Camera::look_at(
        DVec3::new(0.0, 0.0, 10.0),
        DVec3::ZERO,
        DVec3::Y,
        scene::Projection::Orthographic { height: 3.0 },
    );
    let at = |z: f64| Hit { position: DVec3::new(1.0, 2.0, z), ..*sample.get(0, 0).unwrap() };
    let rows = [vec![Some(at(4.0)), None, Some(at(-2.5))]];
    let buffer =
        GBuffer::from_rows(Viewport::new(3, 1).unwrap(), Meta { camera: json!(down.unwrap()), ..meta() }, rows);
    let mut all = unpack(&buffer.npz_bytes().unwrap());
    all.remove("t.npy");
    let read_back = read("without_t.npz", &pack(&all)).unwrap();
    assert_eq!([read_back.get(0, 0).unwrap().t, read_back.get(2, 0).unwrap().t], [6.0, 12.5]);
    // Without t the camera must be one.
    let error = without(&["t"], &json!({"eye": [0, 0, 0]})).unwrap_err();
    assert!(matches!(error, GBufferError::Meta { .. }) && error.to_string().contains("target"), "{error}");
}

#[test]
fn an_array_by_another_name_is_refused_not_passed_over() {
    for name in ["Status.npy", "undecided", "position.npy", "status.npy.npy"] {
        let mut members = unpack(&sample().npz_bytes().unwrap());
        let bytes = members.remove("status.npy").unwrap();
        members.insert(name.to_owned(), bytes);
        let error = read("stranger.npz", &pack(&members)).unwrap_err();
        assert!(matches!(&error, GBufferError::UnknownArray { entry, .. } if entry == name), "{error}");
    }
}

#[test]
fn without_hit_a_face_says_whether_anything_is_seen() {
    let face = |value: i32| {
        let mut members = unpack(&sample().npz_bytes().unwrap());
        members.remove("hit.npy");
        let changed = patched(members["face.npy"].clone(), from_end(6, 4), &value.to_le_bytes());
        members.extend(changed.map(|bytes| ("face.npy".to_owned(), bytes)));
        read("faces.npz", &pack(&members))
    };
    assert_eq!(face(-1).unwrap().covered() + 1, sample().covered());
    let error = face(-2).unwrap_err();
    assert!(matches!(error, GBufferError::Value { array: "face", x: 1, y: 1, .. }), "{error}");
}

#[test]
fn a_normal_that_is_nan_in_part_is_no_undefined_one() {
    let mut members = unpack(&sample().npz_bytes().unwrap());
    members.remove("status.npy");
    let changed = patched(members["normal.npy"].clone(), from_end(12, 24), &f64::NAN.to_le_bytes());
    members.extend(changed.map(|bytes| ("normal.npy".to_owned(), bytes)));
    let error = read("part.npz", &pack(&members)).unwrap_err();
    assert!(matches!(error, GBufferError::Value { array: "normal", x: 2, y: 2, .. }), "{error}");
}

#[test]
fn faces_of_every_integer_type_are_taken() {
    for (descr, size) in [("|i1", 1), ("|u1", 1), ("<i2", 2), ("<u2", 2), ("<i4", 4), ("<u4", 4), ("<i8", 8)] {
        let ones: Vec<u8> = (0..WIDTH * HEIGHT).flat_map(|_| 1u64.to_le_bytes()[..size].to_vec()).collect();
        let header = format!("'{descr}'");
        let buffer = changed("ints.npz", "face", |_| Some(array(&header, "False", "(3, 5)", &ones))).unwrap();
        assert!(buffer.pixels().flatten().all(|hit| hit.face == FaceId(1)), "{descr}");
    }
}

/// Bytes of any member may be anything behind a sound zip archive: it is read or refused, and never panics.
#[test]
fn members_changed_at_random_are_read_or_refused() {
    let whole = unpack(&sample().npz_bytes().unwrap());
    let names: Vec<String> = whole.keys().cloned().collect();
    // Marsaglia's xorshift, seeded.
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut random = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    let mut read_well = 0;
    for _ in 0..2000 {
        let mut members = whole.clone();
        for _ in 0..=random(4) {
            let bytes = members.get_mut(&names[random(names.len())]).unwrap();
            match random(8) {
                0 => bytes.truncate(random(bytes.len() + 1)),
                1 => bytes.extend(std::iter::repeat_n(random(256) as u8, random(64))),
                _ if bytes.is_empty() => {}
                // Half of the changes in the header.
                n => {
                    let end = if n % 2 == 0 { bytes.len().min(128) } else { bytes.len() };
                    bytes[random(end)] = random(256) as u8;
                }
            }
        }
        read_well += usize::from(read("random.npz", &pack(&members)).is_ok());
    }
    assert!(read_well > 20, "only {read_well} of 2000 got through the headers");
}

#[test]
fn wrong_types_orders_and_shapes_are_named() {
    let zeros = vec![0; 8 * 3 * WIDTH * HEIGHT];
    let t = |descr: &str, order: &str, shape: &str, size: usize| {
        let bytes = array(descr, order, shape, &zeros[..size * WIDTH * HEIGHT]);
        changed("types.npz", "t", |_| Some(bytes.clone())).unwrap_err()
    };
    for descr in ["'>f8'", "'<f2'", "'<i8'", "'<c16'", "'|O'"] {
        assert!(matches!(t(descr, "False", "(3, 5)", 8), GBufferError::Dtype { array: "t", .. }), "{descr}");
    }
    assert!(matches!(t("'<f8'", "True", "(3, 5)", 8), GBufferError::FortranOrder { array: "t", .. }));
    for shape in ["(5, 3)", "(15,)", "(3, 5, 1)", "()"] {
        let error = t("'<f8'", "False", shape, 8);
        assert!(matches!(error, GBufferError::Shape { array: "t", .. }), "{shape}: {error}");
    }
    assert!(matches!(t("[('a', '<f8')]", "False", "(3, 5)", 8), GBufferError::Header { array: "t", .. }));
    assert!(matches!(t("'<f8'", "False", "(3, 5)", 7), GBufferError::Data { array: "t", .. }));
    assert!(matches!(t("'<f4'", "False", "(3, 5)", 8), GBufferError::Data { array: "t", .. }));
    let error = changed("types.npz", "pos", |_| Some(array("'<f8'", "False", "(3, 5)", &zeros[..120]))).unwrap_err();
    assert!(matches!(error, GBufferError::Shape { array: "pos", .. }), "{error}");
}

#[test]
fn narrower_types_are_taken_without_loss() {
    let halves: Vec<u8> = (0..WIDTH * HEIGHT).flat_map(|i| (i as f32 / 2.0).to_le_bytes()).collect();
    let buffer = changed("narrow.npz", "t", |_| Some(array("'<f4'", "False", "(3, 5)", &halves))).unwrap();
    assert_eq!(buffer.get(1, 1).unwrap().t, 3.0);
}

#[test]
fn illegal_values_are_named_with_their_pixel() {
    // Pixel 6 is hit, (1, 1); 7 too, (2, 1), and 12, (2, 2); 4 has curvatures.
    let cases: &[(&str, usize, usize, &[u8], usize)] = &[
        ("hit", 6, 1, &[2], 6),
        ("face", 6, 4, &(-1i32).to_le_bytes(), 6),
        ("u", 6, 8, &f64::NAN.to_le_bytes(), 6),
        ("v", 7, 8, &f64::INFINITY.to_le_bytes(), 7),
        ("t", 12, 8, &f64::NEG_INFINITY.to_le_bytes(), 12),
        ("pos", 12, 24, &f64::NAN.to_le_bytes(), 12),
        ("status", 6, 1, &[3], 6),
        ("status", 7, 1, &[255], 7),
        ("normal", 12, 24, &f64::NAN.to_le_bytes(), 12),
        ("k1", 4, 8, &f64::INFINITY.to_le_bytes(), 4),
        ("k2", 4, 8, &f64::NAN.to_le_bytes(), 4),
        ("k2", 6, 8, &1f64.to_le_bytes(), 6),
        ("edge", 9, 16, &f64::NAN.to_le_bytes(), 9),
        ("edge", 9, 16, &f64::INFINITY.to_le_bytes(), 9),
        ("undecided", 0, 1, &[9], 0),
    ];
    for &(member, pixel, size, element, seen) in cases {
        let error = changed("values.npz", member, |b| patched(b, from_end(pixel, size), element)).unwrap_err();
        let at = (seen % WIDTH, seen / WIDTH);
        assert!(
            matches!(error, GBufferError::Value { array, x, y, .. } if array == member && (x, y) == at),
            "{member} at {pixel}: {error}"
        );
    }
}

#[test]
fn a_buffer_that_was_not_asked_for_edges_says_so_by_having_no_such_array() {
    let without = sample().with_edges(false);
    let back = read("without-edges.npz", &without.npz_bytes().unwrap()).unwrap();
    assert!(!back.has_edges() && back.pixels().flatten().all(|hit| hit.edge.is_none()));
    assert!(sample().has_edges() && sample().get(4, 1).unwrap().edge.is_some());
}

#[test]
fn values_where_nothing_is_hit_are_not_looked_at() {
    let buffer = changed("unseen.npz", "face", |b| patched(b, from_end(2, 4), &77i32.to_le_bytes())).unwrap();
    assert_eq!(buffer, sample());
}

#[test]
fn claimed_sizes_are_refused_before_memory_is_taken() {
    for (shape, height, width) in [("(16385, 5)", 16385, 5), ("(0, 5)", 0, 5), ("(3, 18446744073709551615)", 3, 0)] {
        let error = changed("claims.npz", "hit", |_| Some(array("'|u1'", "False", shape, &[]))).unwrap_err();
        assert!(matches!(error, GBufferError::Size { .. }), "{height}x{width}: {error}");
    }
    // A legal size that neither the data nor the file's own length can hold.
    let error = changed("claims.npz", "hit", |_| Some(array("'|u1'", "False", "(4000, 8000)", &[1]))).unwrap_err();
    assert!(matches!(error, GBufferError::Data { array: "hit", .. }), "{error}");
}

#[test]
fn malformed_meta_is_refused() {
    let text = |text: &str| {
        let bytes = array(&format!("'|S{}'", text.len()), "False", "()", text.as_bytes());
        changed("meta.npz", "meta", |_| Some(bytes.clone()))
    };
    let good = r#"{"renderer": "r", "technique": "t", "model": "m", "model_hash": "h", "camera": {}, "size": [5, 3],
        "adapter": null, "version": "1"}"#;
    assert!(text(good).is_ok());
    for descr in ["'|u1'", "'|i1'"] {
        let row = array(descr, "False", &format!("({},)", good.len()), good.as_bytes());
        assert!(changed("meta.npz", "meta", |_| Some(row.clone())).is_ok(), "a row of bytes, as C++ writers have it");
    }
    assert!(text(&good.replace(r#", "version": "1""#, r#", "engine": [1]"#)).is_ok(), "version may be absent");
    for bad in ["", "[]", "{}", &good.replace("\"r\"", "1"), &good.replace('}', ""), &"[".repeat(100_000)] {
        assert!(matches!(text(bad).unwrap_err(), GBufferError::Meta { .. }), "{bad:.40}");
    }
    let error = text(&good.replace("[5, 3]", "[3, 5]")).unwrap_err();
    assert!(matches!(error, GBufferError::MetaSize { meta: [3, 5], arrays: [5, 3], .. }), "{error}");
    let raw = |descr: &str, shape: &str, data: &[u8]| {
        let bytes = array(descr, "False", shape, data);
        changed("meta.npz", "meta", |_| Some(bytes.clone())).unwrap_err()
    };
    assert!(matches!(raw("'|S2'", "()", &[0xff, 0xfe]), GBufferError::Meta { .. }));
    assert!(matches!(raw("'<U1'", "()", &0xd800u32.to_le_bytes()), GBufferError::Meta { .. }));
    assert!(matches!(raw("'<U1'", "(1,)", &[0; 4]), GBufferError::Dtype { array: "meta", .. }));
    assert!(matches!(raw("'|u1'", "(2, 2)", &[0; 4]), GBufferError::Dtype { array: "meta", .. }));
    assert!(matches!(raw("'|u1'", "(5,)", &[0; 4]), GBufferError::Data { array: "meta", .. }));
    assert!(matches!(raw("'|O'", "()", &[0; 4]), GBufferError::Dtype { array: "meta", .. }));
    assert!(matches!(raw("'<U1000000000000'", "()", &[0; 4]), GBufferError::Data { array: "meta", .. }));
    assert!(matches!(raw("'é'", "()", &[0; 4]), GBufferError::Dtype { array: "meta", .. }));
}

#[test]
fn files_that_are_no_archives_are_refused() {
    assert!(matches!(GBuffer::read_npz(path("absent.npz")), Err(GBufferError::Io { .. })));
    let folder = GBuffer::read_npz(env!("CARGO_TARGET_TMPDIR")).unwrap_err();
    assert!(folder.to_string().contains("not a regular file"), "{folder}");
    assert!(matches!(read("text.npz", b"not a zip file"), Err(GBufferError::Archive { .. })));
    assert!(matches!(sample().write_npz(path("no/such/directory.npz")), Err(GBufferError::Io { .. })));
}

#[test]
fn a_face_beyond_the_files_integers_is_refused() {
    let hit = Hit { face: FaceId(1 << 31), ..*sample().get(0, 0).unwrap() };
    let buffer = GBuffer::from_rows(Viewport::new(1, 1).unwrap(), meta(), [vec![Some(hit)]]);
    assert!(matches!(buffer.npz_bytes(), Err(GBufferError::FaceTooLarge { face }) if face == 1 << 31));
}

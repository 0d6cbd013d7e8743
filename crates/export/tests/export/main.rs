//! What is written, read again: by the project's own readers, and byte by byte.

mod bytes;
mod looks;
mod meshes;
mod round_trip;

use export::{Asked, Beside, ExportError, Ready, WRITERS, Written};
use formats::Document;
use scene::Model;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A built-in model, or a file of `testdata`.
fn document(name: &str) -> Document {
    let path = root().join("testdata").join(name);
    match models::builtin(name) {
        Some(model) => Document::of_model(model),
        None => formats::open(&path).unwrap_or_else(|error| panic!("{error}")),
    }
}

fn write(document: &Document, extension: &str, error: f64) -> Result<(Vec<u8>, Written), ExportError> {
    let writer = WRITERS.iter().find(|writer| writer.extensions().contains(&extension)).expect("a writer");
    let Ready { written, fill, .. } = writer.prepare("part", document, Asked { error, progress: &|_| {} })?;
    let mut bytes = vec![];
    fill(&mut bytes)?;
    Ok((bytes, written))
}

/// The name and the bytes of the file that is written beside; `None` where there is none.
fn beside(document: &Document, extension: &str, error: f64) -> Option<(String, Vec<u8>)> {
    let writer = WRITERS.iter().find(|writer| writer.extensions().contains(&extension)).expect("a writer");
    let ready = writer.prepare("part", document, Asked { error, progress: &|_| {} }).expect("ready");
    ready.beside.map(|Beside { name, fill }| {
        let mut bytes = vec![];
        fill(&mut bytes).expect("written");
        (name, bytes)
    })
}

/// A thousandth of the model's size.
fn usual(model: &Model) -> f64 {
    1e-3 * model.hull().diagonal()
}

/// Numbers in [0, 1), the same on every machine (Steele & Vigna 2021, splitmix64).
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// A file of the real models, where these are at hand.
fn real(name: &str) -> Option<Document> {
    let models =
        std::env::var_os("ISOPHOTE_MODELS").map(PathBuf::from).unwrap_or_else(|| root().join("../shared/models"));
    let path = models.join(name);
    if !path.exists() {
        eprintln!("{name} is not at hand");
        return None;
    }
    Some(formats::open(&path).unwrap_or_else(|error| panic!("{error}")))
}

/// A solid of a modeller's, and an aircraft of 272 spline faces: the same surfaces again, and triangles without a gap.
#[test]
fn real_models_come_back_and_are_watertight() {
    for name in ["nist/NIST_MBE_PMI_1.stp", "nist/NIST_MBE_PMI_6.stp", "tigl/D150WithGuides_fusedAircraftMirrored.step"]
    {
        let Some(document) = real(name) else { continue };
        let again = round_trip::read_again(&document);
        assert_eq!(round_trip::differing_surfaces(&document.model, &again.model), Vec::<usize>::new(), "{name}");
        let (_, written) = write(&document, "stl", usual(&document.model)).expect("written");
        let facts = written.mesh.expect("triangles");
        assert_eq!((facts.open, facts.non_manifold, facts.euler % 2), (0, 0, 0), "{name}: {facts:?}");
    }
}

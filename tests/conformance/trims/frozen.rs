//! Reader of `testdata/trims`: points of trimmed faces, and whether they lie on the face. `tests/oracle/README.md`
//! describes the files and how the answers were found.

use glam::{DVec2, dvec2};
use scene::Model;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Points nearer to an edge than this are not judged: a share of the face's box.
pub const BAND: f64 = 1e-7;

/// Binary digits of a coordinate near an edge.
const FINE_BITS: u32 = 24;

/// Binary digits of a coordinate elsewhere; such a point is the middle of its cell.
const COARSE_BITS: u32 = 12;

/// A point and the frozen answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrozenPoint {
    /// The parameters, exactly those that were asked for.
    pub uv: DVec2,
    /// Whether the face has material there.
    pub inside: bool,
    /// Whether OpenCASCADE answered otherwise; `inside` is what mathematics says.
    pub oracle_differs: bool,
    /// A lower bound, at most a tenth too small, of the distance to the nearest edge, in shares of the face's box; what
    /// is below 2.6e-10 counts as 0.
    pub distance: f64,
}

/// The points of one face.
#[derive(Debug, Clone, PartialEq)]
pub struct FrozenFace {
    /// Index of the face in its model.
    pub face: usize,
    /// What the face was made to be, such as `cylinder-patch`; `real` in a real model.
    pub kind: String,
    /// Corner and size of the box that distances are measured in.
    pub corner: DVec2,
    /// See `corner`.
    pub size: DVec2,
    /// The period in u where loops may leave the domain: a point lies on the face where it does after a shift by
    /// −1, 0 or 1 periods. 0 where none do.
    pub period: f64,
    /// The points: the first half near edges, the others anywhere in the box.
    pub points: Vec<FrozenPoint>,
}

/// All faces of one file.
#[derive(Debug, Clone, PartialEq)]
pub struct FrozenSet {
    /// File name of the model.
    pub model: String,
    /// Faces that have loops, by index.
    pub faces: Vec<FrozenFace>,
}

impl FrozenSet {
    /// Decodes a file.
    ///
    /// # Errors
    /// Where it is not such a file, ends early or late, or its counts contradict its points.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        let end = bytes.iter().position(|&b| b == b'\n').ok_or("no header")?;
        let header: Value = serde_json::from_slice(&bytes[..end]).map_err(|error| error.to_string())?;
        if (header["format"].as_str(), header["version"].as_u64()) != (Some("isophote-trims"), Some(1)) {
            return Err(format!("format {} version {}", header["format"], header["version"]));
        }
        if (header["band"].as_f64(), header["bits"].as_u64()) != (Some(BAND), Some(u64::from(FINE_BITS))) {
            return Err(format!("band {} and {} bits", header["band"], header["bits"]));
        }
        let model = header["model"].as_str().ok_or("no model")?.to_owned();
        let mut body = Body(&bytes[end + 1..]);
        let entries = header["faces"].as_array().ok_or("no faces")?;
        let faces = entries.iter().map(|entry| body.face(entry)).collect::<Result<_, _>>()?;
        if body.0.is_empty() { Ok(Self { model, faces }) } else { Err(format!("{} bytes too many", body.0.len())) }
    }
}

/// What is left of the binary part.
struct Body<'a>(&'a [u8]);

impl<'a> Body<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or_else(|| format!("ends {count} bytes early"))?;
        self.0 = rest;
        Ok(taken)
    }

    fn face(&mut self, entry: &Value) -> Result<FrozenFace, String> {
        let whole = |key: &str| entry[key].as_u64().map(|x| x as usize).ok_or_else(|| format!("no {key} in {entry}"));
        let side = |axis: usize, k: usize| entry["box"][axis][k].as_f64().ok_or_else(|| format!("no box in {entry}"));
        let (corner, size) = (dvec2(side(0, 0)?, side(1, 0)?), dvec2(side(0, 1)?, side(1, 1)?));
        let count = whole("points")?;
        let near = count / 2;
        let fine = self.take(6 * near)?.chunks(6).map(|b| [three(&b[..3]), three(&b[3..])].map(f64::from));
        let cells = self.take(3 * (count - near))?.chunks(3).map(|b| {
            let cell = three(b);
            let middle = |k: u32| (f64::from(k) + 0.5) * f64::from(1 << (FINE_BITS - COARSE_BITS));
            [cell % (1 << COARSE_BITS), cell >> COARSE_BITS].map(middle)
        });
        let shares = fine.chain(cells).map(|k| DVec2::from_array(k) / f64::from(1 << FINE_BITS));
        let (inside, differs) = (self.take(count.div_ceil(8))?, self.take(count.div_ceil(8))?);
        let bit = |bits: &[u8], k: usize| bits[k / 8] >> (k % 8) & 1 == 1;
        let steps = self.take(count)?;
        let point = |(k, share): (usize, DVec2)| FrozenPoint {
            uv: corner + size * share,
            inside: bit(inside, k),
            oracle_differs: bit(differs, k),
            distance: if steps[k] == u8::MAX { 0.0 } else { (-f64::from(steps[k]) / 8.0).exp2() },
        };
        let points: Vec<FrozenPoint> = shares.enumerate().map(point).collect();
        let counted = points.iter().filter(|p| p.inside).count();
        if counted != whole("inside")? {
            return Err(format!("{counted} points are inside, not {}", entry["inside"]));
        }
        let kind = entry["kind"].as_str().unwrap_or("real").to_owned();
        let period = entry["period"].as_f64().unwrap_or_default();
        Ok(FrozenFace { face: whole("face")?, kind, corner, size, period, points })
    }
}

/// A number of three bytes, the lowest first.
fn three(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))
}

/// Folder of the frozen files.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../testdata/trims")
}

fn sets(prefix: &str) -> Vec<FrozenSet> {
    let mut files: Vec<PathBuf> =
        folder().read_dir().expect("frozen answers").map(|e| e.expect("an entry").path()).collect();
    files.retain(|file| {
        let name = file.file_name().expect("a name").to_string_lossy();
        name.starts_with(prefix) && name.ends_with(".bin")
    });
    files.sort();
    let decode = |file: &PathBuf| FrozenSet::decode(&std::fs::read(file).expect("readable"));
    files.iter().map(|file| decode(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))).collect()
}

/// The random faces: models and their points.
pub fn random() -> Vec<(Model, FrozenSet)> {
    let open = |set: &FrozenSet| formats::read(folder().join(&set.model)).expect("a model");
    sets("random-").into_iter().map(|set| (open(&set), set)).collect()
}

/// Folder of real models, which are not part of the repository: `ISOPHOTE_MODELS`, or `../shared/models` beside the
/// workspace, has them converted in `../oracle/neutral`. `None`, said on stderr, where that folder does not exist.
pub fn neutral() -> Option<PathBuf> {
    let named = std::env::var_os("ISOPHOTE_MODELS");
    let models =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(named.as_deref().unwrap_or("../shared/models".as_ref()));
    let folder = models.join("../oracle/neutral");
    if !folder.is_dir() {
        assert!(named.is_none(), "there is no folder {}", folder.display());
        eprintln!("no folder {}: no real model was tested", folder.display());
        return None;
    }
    Some(folder)
}

/// The faces of real models, where they are.
pub fn real() -> Option<Vec<(Model, FrozenSet)>> {
    let folder = neutral()?;
    let open = |set: &FrozenSet| formats::read(folder.join(&set.model)).expect("a model");
    Some(sets("real-").into_iter().map(|set| (open(&set), set)).collect())
}

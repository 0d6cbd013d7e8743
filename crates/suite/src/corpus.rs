//! The corpus: portable scenes, each named by what it stresses, and what a suite takes of them.

use crate::named;
use crate::stage::{Path, Plan};
use glam::DVec3;
use pipeline::Scheme;
use pipeline::mask::{MaskOptions, Trimming};
use scene::{Camera, Model, Projection, Viewport};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;
use techniques::Technique;

/// How much of the corpus is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Suite {
    /// The hardest scenes, one view each: under a minute on two cores with a software GPU
    Smoke,
    /// All scenes, techniques and schemes from several viewpoints: under 15 minutes there
    Standard,
    /// The standard suite from more viewpoints, in larger pictures, and the spray of 266 surfaces
    Full,
}

/// A scene: a model, where it is looked at from, and what it may leave unbounded.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// What it stresses, as a name.
    pub name: &'static str,
    /// What it stresses, as a sentence.
    pub stresses: &'static str,
    /// Name of a built-in model, or the path of a file, so that any pixel can be asked for again on the command line.
    pub model: &'static str,
    /// From where; the smoke suite takes the first.
    pub viewpoints: &'static [Viewpoint],
    /// The largest share of covered pixels that may have no verdict for want of a bound: more than 0 at poles, and where
    /// knots lie nearer to each other than f32 can tell.
    pub unbounded_share: f64,
    /// The techniques that draw it.
    pub techniques: &'static [&'static dyn Technique],
    /// Whether its faces are trimmed by masks, and not by curves.
    pub masked: bool,
    /// The least suite that runs it.
    pub least: Suite,
}

/// Where a camera stands, in terms of the model's box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Viewpoint {
    /// The whole model from the front right, above.
    Framed,
    /// Straight down.
    Above,
    /// Low and from the side: most of the picture is near a silhouette.
    Grazing,
    /// In the plane of the middle, less than half a degree above it.
    EdgeOn,
    /// From within the box, with walls at the near plane.
    Inside,
    /// As `Framed`, without perspective.
    Orthographic,
    /// From the front right, above, at two fifths of the distance.
    Close,
}

const ALL_ROUND: &[Viewpoint] =
    &[Viewpoint::Framed, Viewpoint::Grazing, Viewpoint::Orthographic, Viewpoint::Above, Viewpoint::Close];
const FROM_ABOVE: &[Viewpoint] =
    &[Viewpoint::Above, Viewpoint::Framed, Viewpoint::Grazing, Viewpoint::Orthographic, Viewpoint::Close];
const LOW: &[Viewpoint] =
    &[Viewpoint::Grazing, Viewpoint::EdgeOn, Viewpoint::Framed, Viewpoint::Orthographic, Viewpoint::Close];
const HOLLOW: &[Viewpoint] =
    &[Viewpoint::Framed, Viewpoint::Inside, Viewpoint::Grazing, Viewpoint::Orthographic, Viewpoint::Above];

/// A scene of which every pixel must have a bound.
const fn scene(
    name: &'static str,
    model: &'static str,
    viewpoints: &'static [Viewpoint],
    least: Suite,
    stresses: &'static str,
) -> Scene {
    Scene { name, stresses, model, viewpoints, unbounded_share: 0.0, techniques: techniques::ALL, masked: false, least }
}

/// The same, trimmed by masks.
const fn masked(scene: Scene) -> Scene {
    Scene { masked: true, ..scene }
}

/// A scene of which a share of the covered pixels may have no bound.
const fn allowing(unbounded_share: f64, scene: Scene) -> Scene {
    Scene { unbounded_share, ..scene }
}

use Suite::{Full, Smoke, Standard};

/// Every scene, in the order in which they run; a shard takes every N-th.
pub const SCENES: &[Scene] = &[
    allowing(0.01, scene("pole", "sphere", FROM_ABOVE, Smoke, "a rational sphere: a pole at each end")),
    allowing(0.01, scene("collapsed-sides", "lens", ALL_ROUND, Smoke, "two sides collapsed to points")),
    allowing(0.01, scene("collapsed-side", "petal", ALL_ROUND, Standard, "one side collapsed to a point")),
    allowing(0.01, scene("apex", "cone", ALL_ROUND, Standard, "a cone: no limit of the normal at its tip")),
    scene("repeated-knots", "surface", ALL_ROUND, Smoke, "double and triple interior knots"),
    scene("crease", "crease", ALL_ROUND, Smoke, "knots of full multiplicity: the normal jumps across a ridge"),
    scene("folds-degree-1x4", "bilinear-quartic", ALL_ROUND, Standard, "a pleated fan, sharp at every knot"),
    scene("degree-1x9", "degree-1x9", ALL_ROUND, Smoke, "the lowest degree with the highest"),
    scene("degree-2x8", "degree-2x8", ALL_ROUND, Standard, "degree 2 x 8"),
    scene("degree-3x7", "degree-3x7", ALL_ROUND, Standard, "degree 3 x 7"),
    scene("degree-4x6", "degree-4x6", ALL_ROUND, Standard, "degree 4 x 6"),
    scene("degree-5x5", "degree-5x5", ALL_ROUND, Standard, "degree 5 x 5"),
    scene("degree-6x4", "degree-6x4", ALL_ROUND, Standard, "degree 6 x 4"),
    scene("degree-7x3", "degree-7x3", ALL_ROUND, Standard, "degree 7 x 3"),
    scene("degree-8x2", "degree-8x2", ALL_ROUND, Smoke, "degree 8 x 2"),
    scene("degree-9x1", "degree-9x1", ALL_ROUND, Standard, "the highest degree with the lowest"),
    scene("degree-7x7", "septic", ALL_ROUND, Standard, "degree 7 x 7, a ripple"),
    scene("degree-5x2", "quintic-quadratic", ALL_ROUND, Standard, "degree 5 x 2, a saddle"),
    scene("weights-1-to-1000", "weights-1000", ALL_ROUND, Smoke, "neighbouring rows of weights 1 and 1000"),
    scene("weights-1-to-629", "weights-629", ALL_ROUND, Standard, "degree 4 x 4, weights over a ratio of 629"),
    scene("weights", "rational", ALL_ROUND, Standard, "weights from 0.5 to 2 over multiple knots"),
    scene("offset-1e6", "far", ALL_ROUND, Smoke, "a unit surface a million units from the origin"),
    scene("coordinates-1e9", "huge", ALL_ROUND, Standard, "coordinates up to a thousand million"),
    scene("tiny-spans", "tiny-spans", ALL_ROUND, Smoke, "knot spans down to 1e-8 of the domain"),
    scene("near-tangent", "surface", LOW, Smoke, "views nearly along the surface"),
    allowing(
        0.01,
        scene("near-tangent-dish", "dish", LOW, Standard, "a bowl seen from its edge; a pole in its middle"),
    ),
    scene("silhouette", "fold", ALL_ROUND, Smoke, "a sheet that folds over and cuts itself"),
    scene("seam-clamped", "tube", HOLLOW, Standard, "a closed tube, clamped ends meet in a seam"),
    scene("seam-periodic", "periodic", HOLLOW, Smoke, "a closed vase with periodic knots"),
    scene("seams-both-ways", "torus", HOLLOW, Smoke, "a rational torus: closed both ways, conics both ways"),
    scene("conic-hyperbola", "hyperboloid", HOLLOW, Standard, "a hyperbola of weights above 1, turned"),
    scene("knots-unclamped", "unclamped", ALL_ROUND, Smoke, "knots not repeated at the ends"),
    scene("knots-unclamped-rational", "unclamped-rational", ALL_ROUND, Standard, "the same, rational, degree 4 x 3"),
    allowing(0.01, scene("patches-teapot", "teapot", ALL_ROUND, Smoke, "32 patches whose borders must not gape")),
    scene("patches-teacup", "teacup", HOLLOW, Standard, "26 patches, y up"),
    allowing(
        0.01,
        scene("patches-teaspoon", "teaspoon", ALL_ROUND, Standard, "thin: front and back are near each other"),
    ),
    scene("patches-266", "spray", ALL_ROUND, Full, "266 surfaces in front of each other"),
    scene("trim-many-holes", "plate", ALL_ROUND, Standard, "100 round holes, a pixel wide or so, in a bent plate"),
    scene("trim-across-seam", "window", HOLLOW, Smoke, "holes across a cylinder's seam, edges beyond the domain"),
    allowing(0.01, scene("trim-over-pole", "cap", ALL_ROUND, Standard, "edges round one pole and into the other")),
    scene("trim-nested-islands", "islands", FROM_ABOVE, Smoke, "an island in a hole, and a hole in the island"),
    scene("trim-cusp", "cusp", FROM_ABOVE, Standard, "edges that turn back on themselves in a cusp"),
    scene("trim-sliver", "sliver", FROM_ABOVE, Standard, "material 1e-4 of the domain wide, far below a pixel"),
    scene("trim-text", "text", FROM_ABOVE, Standard, "letters cut out: hundreds of quadratic pieces"),
    scene("trim-many-pieces", "pieces", ALL_ROUND, Full, "16 faces of 50 trims each"),
    scene("trim-shared-edge", "seam-pair", ALL_ROUND, Standard, "two trimmed faces with an edge in common"),
    masked(scene("masks-across-seam", "window", HOLLOW, Standard, "the same as trim-across-seam, by masks")),
    masked(scene("masks-nested-islands", "islands", FROM_ABOVE, Smoke, "the same as trim-nested-islands, by masks")),
    masked(scene("masks-sliver", "sliver", FROM_ABOVE, Full, "a waist narrower than any texel")),
];

/// One picture that is drawn and compared, by name; what a scene of the corpus comes to in a suite.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct CaseKey {
    /// The scene.
    pub scene: String,
    /// The viewpoint.
    pub viewpoint: String,
    /// The technique.
    pub technique: String,
    /// The scheme of programs.
    pub scheme: String,
}

impl fmt::Display for CaseKey {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}/{}/{}", self.scene, self.viewpoint, self.technique, self.scheme)
    }
}

/// Everything that a run of some scenes comes to, by which its report is recognised.
#[derive(Debug, Clone, PartialEq)]
pub struct Corpus {
    /// The suite.
    pub suite: Suite,
    /// Its scenes, in order.
    pub scenes: Vec<SceneInfo>,
    /// Its cases, in order.
    pub cases: Vec<PlannedCase>,
    /// A 64-bit FNV-1a hash of all of it, and of the models' own hashes.
    pub hash: String,
}

/// A case before it is run.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedCase {
    /// Which.
    pub key: CaseKey,
    /// Side of its square picture, pixels.
    pub side: usize,
    /// The options of `pixel` and `compare` that show it: model, camera, size, plan.
    pub options: String,
}

impl Corpus {
    /// What `scenes` are in a suite, drawn by a path. One whose model cannot be read is a single case, which will say why.
    pub fn new(suite: Suite, scenes: &[&'static Scene], path: Path) -> Self {
        let (side, viewport) = (suite.side(), suite.viewport());
        let mut corpus = Self { suite, scenes: vec![], cases: vec![], hash: String::new() };
        let mut hash = files::Hash::new();
        let mut add = |text: &str| {
            hash.add(text.as_bytes());
            hash.add(&[0]);
        };
        for scene in scenes {
            let model = scene.open();
            let info = SceneInfo::of(scene);
            let hash = model.as_ref().map_or_else(String::clone, Model::hash);
            for text in [&info.name, &info.model, &info.stresses, &info.unbounded_share.to_string(), &hash] {
                add(text);
            }
            corpus.scenes.push(info);
            let Ok(model) = model else {
                let key = scene.unread(suite);
                add(&key.to_string());
                corpus.cases.push(PlannedCase { key, side, options: scene.model.to_owned() });
                continue;
            };
            for &viewpoint in suite.viewpoints(scene) {
                let camera = viewpoint.camera(&model, viewport);
                for plan in suite.plans_by(scene, path) {
                    let key = scene.key(viewpoint, plan);
                    let options = scene.options(&camera, viewport, plan);
                    add(&format!("{key} {options}"));
                    corpus.cases.push(PlannedCase { key, side, options });
                }
            }
        }
        corpus.hash = hash.to_string();
        corpus
    }
}

/// A scene of a report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneInfo {
    /// Its name.
    pub name: String,
    /// Name of its model, or the path of its file.
    pub model: String,
    /// What it stresses.
    pub stresses: String,
    /// The share of covered pixels that may have no verdict for want of a bound.
    pub unbounded_share: f64,
}

impl SceneInfo {
    fn of(scene: &Scene) -> Self {
        Self {
            name: scene.name.to_owned(),
            model: scene.model.to_owned(),
            stresses: scene.stresses.to_owned(),
            unbounded_share: scene.unbounded_share,
        }
    }
}

impl Suite {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Smoke => "smoke",
            Self::Standard => "standard",
            Self::Full => "full",
        }
    }

    /// Side of its square pictures, in pixels: software Vulkan is slow at small triangles with heavy fragments.
    pub fn side(self) -> usize {
        match self {
            // The same, so that the smoke suite is a part of the standard one.
            Self::Smoke | Self::Standard => 64,
            Self::Full => 128,
        }
    }

    /// The size of its pictures.
    pub fn viewport(self) -> Viewport {
        Viewport::new(self.side(), self.side()).expect("a legal size")
    }

    /// The scenes that it runs.
    pub fn scenes(self) -> Vec<&'static Scene> {
        let rank = |suite: Suite| suite as usize;
        SCENES.iter().filter(|scene| rank(scene.least) <= rank(self)).collect()
    }

    /// The viewpoints from which it looks at a scene.
    pub fn viewpoints(self, scene: &Scene) -> &'static [Viewpoint] {
        match self {
            Self::Smoke => &scene.viewpoints[..1],
            Self::Standard => &scene.viewpoints[..3],
            Self::Full => scene.viewpoints,
        }
    }

    /// How it draws each view of a scene.
    pub fn plans(self, scene: &Scene) -> Vec<Plan> {
        let trimmed = models::TRIMMED.iter().any(|(name, _)| *name == scene.model);
        let schemes: &[Scheme] = match self {
            Self::Smoke => &[Scheme::Specialised],
            // Trims are looked up by the same text in both.
            Self::Standard if trimmed => &[Scheme::Specialised],
            Self::Standard | Self::Full => &[Scheme::Specialised, Scheme::General],
        };
        let trim = if scene.masked { Trimming::Texture(MaskOptions::default()) } else { Trimming::Exact };
        let plan = |technique| schemes.iter().map(move |&scheme| Plan { technique, scheme, trim, ..Plan::default() });
        scene.techniques.iter().copied().flat_map(plan).collect()
    }

    /// The same by another path.
    pub fn plans_by(self, scene: &Scene, path: Path) -> Vec<Plan> {
        self.plans(scene).into_iter().map(|plan| Plan { path, ..plan }).collect()
    }
}

impl Scene {
    /// A model file as a scene.
    pub const fn of_file(path: &'static str) -> Self {
        allowing(0.01, scene(path, path, ALL_ROUND, Smoke, "a model file"))
    }

    /// Opens its model.
    ///
    /// # Errors
    /// Where it cannot be read, or there is nothing to look at: why, in words.
    pub fn open(&self) -> Result<Model, String> {
        let model = named::document(self.model).map_err(|error| error.to_string())?.model;
        let size = model.hull().diagonal();
        if 0.0 < size && size.is_finite() { Ok(model) } else { Err(format!("its box is {size} across")) }
    }

    /// The one case of a scene whose model cannot be read.
    pub fn unread(&self, suite: Suite) -> CaseKey {
        self.key(self.viewpoints[0], suite.plans(self)[0])
    }

    /// The options of `pixel` and `compare` that show it.
    pub fn options(&self, camera: &Camera, viewport: Viewport, plan: Plan) -> String {
        format!("{} {}", quoted(self.model), command_options(camera, viewport, plan))
    }

    /// The key of this scene as seen from `viewpoint`, drawn by `plan`.
    pub fn key(&self, viewpoint: Viewpoint, plan: Plan) -> CaseKey {
        CaseKey {
            scene: self.name.to_owned(),
            viewpoint: viewpoint.name().to_owned(),
            technique: plan.technique.name().to_owned(),
            scheme: scheme_name(plan.scheme).to_owned(),
        }
    }
}

/// A scheme's name on the command line.
pub fn scheme_name(scheme: Scheme) -> &'static str {
    match scheme {
        Scheme::Specialised => "specialised",
        Scheme::General => "general",
    }
}

impl Viewpoint {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Framed => "framed",
            Self::Above => "above",
            Self::Grazing => "grazing",
            Self::EdgeOn => "edge-on",
            Self::Inside => "inside",
            Self::Orthographic => "orthographic",
            Self::Close => "close",
        }
    }

    /// The camera that looks at `model` from here.
    pub fn camera(self, model: &Model, viewport: Viewport) -> Camera {
        let (center, size) = (model.hull().center(), model.hull().diagonal());
        let framing = Camera::framing(model, viewport);
        let wide = Projection::Perspective { fov_deg: 45.0 };
        let (eye, target, up, projection) = match self {
            Self::Framed => return framing,
            Self::Above => (center + size * DVec3::Z, center, DVec3::Y, wide),
            Self::Grazing => (center + size * DVec3::new(1.0, 0.2, 0.06), center, DVec3::Z, wide),
            Self::EdgeOn => (center + size * DVec3::new(0.3, -1.1, 0.008), center, DVec3::Z, wide),
            Self::Inside => {
                let eye = center + size * DVec3::new(0.02, 0.03, 0.05);
                (eye, eye + size * DVec3::new(0.4, 0.3, -0.15), DVec3::Z, wide)
            }
            Self::Orthographic => (framing.eye(), center, DVec3::Z, Projection::Orthographic { height: 0.7 * size }),
            Self::Close => (center + (framing.eye() - center) * 0.4, center, DVec3::Z, wide),
        };
        Camera::look_at(eye, target, up, projection).expect("finite, distinct, and up is across the view")
    }
}

/// A word as a shell takes it for one.
fn quoted(word: &str) -> Cow<'_, str> {
    let is_plain = |c: char| c.is_alphanumeric() || "._/-+,:@".contains(c);
    if word.chars().all(is_plain) { word.into() } else { format!("'{}'", word.replace('\'', r"'\''")).into() }
}

/// The options of `pixel` and `compare` that stand for a camera, a size and a plan.
pub fn command_options(camera: &Camera, viewport: Viewport, plan: Plan) -> String {
    let facts = serde_json::json!(camera);
    let [eye, target, up] = ["eye", "target", "up"].map(|name| {
        let vector = facts[name].as_array().expect("a camera is written with its three vectors");
        vector.iter().map(|x| x.to_string()).collect::<Vec<_>>().join(" ")
    });
    let projection = match camera.projection() {
        Projection::Perspective { fov_deg } => format!("--fov {fov_deg}"),
        Projection::Orthographic { height } => format!("--ortho {height}"),
    };
    let path = if plan.path == Path::Strict { " --path strict" } else { "" };
    format!(
        "--eye {eye} --target {target} --up {up} {projection} --size {}x{} --technique {} --scheme {} --trim {}{path}",
        viewport.width(),
        viewport.height(),
        plan.technique.name(),
        scheme_name(plan.scheme),
        plan.trim.name()
    )
}

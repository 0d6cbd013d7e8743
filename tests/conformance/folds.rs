//! Technique `exact` beside folds, where a ray meets one piece up to three times.

use glam::DVec3;
use pipeline::Technique;
use pipeline::newton::{Outcome, Sight, solve};
use raycast::Caster;
use scene::{Camera, Projection, Viewport};
use xtask::stage::{Plan, Stage};

/// A model, a view, and a pixel of 512 × 512 at which a search that starts at both ends of the hull ends twice at roots
/// that a third one hides.
const HIDDEN: [(&str, bool, [usize; 2]); 5] = [
    ("torus", false, [508, 167]),
    ("quintic-quadratic", true, [502, 270]),
    ("quintic-quadratic", false, [318, 331]),
    ("septic", false, [389, 365]),
    ("septic", false, [386, 364]),
];

#[test]
fn a_root_beyond_the_fold_hides_those_that_the_first_searches_find() {
    let viewport = Viewport::new(512, 512).expect("a legal size");
    for (name, is_orthographic, [x, y]) in HIDDEN {
        let model = formats::builtin(name).expect("built in");
        let camera = if is_orthographic {
            let eye = Camera::framing(&model, viewport).eye();
            let projection = Projection::Orthographic { height: 1.5 };
            Camera::look_at(eye, model.hull().center(), DVec3::Z, projection).expect("legal")
        } else {
            let projection = Projection::Perspective { fov_deg: 60.0 };
            let target = DVec3::new(0.0, 0.0, 0.2);
            Camera::look_at(DVec3::new(1.2, -0.4, 0.1), target, DVec3::Z, projection).expect("legal")
        };
        let plan = Plan { technique: Technique::Exact, ..Plan::default() };
        let stage = Stage::new(&model, camera, viewport, plan).expect("a stage");
        let at = [x as f64 + 0.5, y as f64 + 0.5];
        let sees = |piece: &pipeline::PieceRecord| {
            let sight = Sight::new(&stage.views[piece.face as usize], at.map(|x| x as f32));
            match solve(&stage.scene, piece, &sight).outcome {
                Outcome::Hit { uv, depth } => Some((depth, uv, piece.face as usize)),
                Outcome::Miss | Outcome::Unconverged => None,
            }
        };
        let found = stage.proxy.pieces.iter().filter_map(sees);
        let (_, uv, face) = found.max_by(|a, b| a.0.total_cmp(&b.0)).expect("something is seen");
        let caster = Caster::new(&model);
        let first = caster.all(&camera.ray(viewport, at[0], at[1])).hits[0];
        let domain = stage.scene.frames[face].domain;
        let local = [(first.uv.x, 0), (first.uv.y, 1)].map(|(t, k)| (t - domain[k][0]) / (domain[k][1] - domain[k][0]));
        let off = [0, 1].map(|k| (local[k] - f64::from(uv[k])).abs());
        assert!(face == first.face.0 as usize && off[0].max(off[1]) < 1e-3, "{name} ({x}, {y}): {uv:?}, not {local:?}");
    }
}

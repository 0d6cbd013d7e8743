//! Searches of technique `exact` that go in step end as each does alone.

use lanes::levels;
use pipeline::{PackedScene, Scheme, Sight};
use scene::{Camera, Viewport};
use techniques::exact::Hulls;
use techniques::exact::newton::{Outcome, solve};
use techniques::exact::together::solve_many;

/// Tells zeros of either sign and NaNs apart.
fn bits(outcome: Outcome) -> [u32; 4] {
    match outcome {
        Outcome::Hit { uv: [u, v], depth } => [0, u.to_bits(), v.to_bits(), depth.to_bits()],
        Outcome::Miss => [1, 0, 0, 0],
        Outcome::Unconverged => [2, 0, 0, 0],
    }
}

#[test]
fn many_searches_end_as_each_does_alone_on_every_width() {
    let viewport = Viewport::new(32, 32).unwrap();
    let (mut hits, mut misses) = (0, 0);
    // A fold and collapsed sides search again; degrees 3, 5 and others have programs of their own.
    for name in ["teapot", "fold", "lens", "petal", "degree-5x5", "degree-2x8"] {
        let model = models::builtin(name).expect("built in");
        let camera = Camera::framing(&model, viewport);
        for scheme in [Scheme::General, Scheme::Specialised] {
            let scene = PackedScene::new(&model, scheme).unwrap();
            let views = scene.views(&model, &camera, viewport);
            let hulls = Hulls::new(&model, &scene, &camera, viewport).unwrap();
            let step = hulls.pieces.len().div_ceil(60);
            for piece in hulls.pieces.iter().step_by(step) {
                let at = |i: usize| [(i % 16) as f32 * 2.0 + 0.5, (i / 16) as f32 * 2.0 + 0.5];
                let sights: Vec<Sight> = (0..256).map(|i| Sight::new(&views[piece.face as usize], at(i))).collect();
                let alone: Vec<_> = sights.iter().map(|sight| solve(&scene, piece, sight).outcome).collect();
                hits += alone.iter().filter(|outcome| matches!(outcome, Outcome::Hit { .. })).count();
                misses += alone.iter().filter(|outcome| matches!(outcome, Outcome::Miss)).count();
                let alone: Vec<_> = alone.into_iter().map(bits).collect();
                for level in levels() {
                    let mut together = vec![];
                    solve_many(level, &scene, piece, &sights, &mut together);
                    assert_eq!(together.into_iter().map(bits).collect::<Vec<_>>(), alone, "{name} {level:?}");
                }
            }
        }
    }
    assert!(hits > 300 && misses > 1000, "{hits} hits and {misses} misses");
}

//! Searches of several pixels on one piece, in step.
//!
//! The surface is evaluated at all their places at once, on vectors as wide as the processor has; each then decides by itself, as
//! [`super::newton`] says. A search that is over makes room for the next pixel's.

use super::newton::{Outcome, Walk, seeds};
use super::place::{Points, Problem};
use super::record::PieceRecord;
use lanes::{Level, run};
use nurbs::MAX_ORDER;
use pipeline::{PackedScene, Sight};

/// How many searches go in step.
const WIDTH: usize = 8;

/// The nearest points of a piece on the rays of several pixels, in their order: what [`solve`](super::newton::solve) says of each, to the bit.
///
/// The first search of each is made in step with others; where it does not end the matter, the rest is as there.
pub fn solve_many(level: Level, scene: &PackedScene, piece: &PieceRecord, sights: &[Sight], out: &mut Vec<Outcome>) {
    let face = &scene.faces()[piece.face as usize];
    match [face.degree_u, face.degree_v] {
        [3, 3] => together::<4>(level, scene, piece, sights, out),
        [5, 5] => together::<6>(level, scene, piece, sights, out),
        _ => together::<MAX_ORDER>(level, scene, piece, sights, out),
    }
}

/// A search of one pixel among others.
struct Walker<'a> {
    problem: Problem<'a>,
    seeds: [[f32; 2]; 2],
    /// Which of the pixels.
    pixel: usize,
    uv: [f32; 2],
    walk: Option<Walk>,
}

#[inline(always)]
fn together<const CAPACITY: usize>(
    level: Level,
    scene: &PackedScene,
    piece: &PieceRecord,
    sights: &[Sight],
    out: &mut Vec<Outcome>,
) {
    let first = out.len();
    out.resize(first + sights.len(), Outcome::Miss);
    let mut coming = sights.iter().enumerate().filter_map(|(pixel, sight)| {
        let (seeds, nearest_w) = seeds(piece, sight)?;
        let problem = Problem::new(scene, piece, sight, nearest_w);
        let uv = problem.queue(seeds).seeds[0];
        Some(Walker { problem, seeds, pixel, uv, walk: None })
    });
    let mut walkers: [Option<Walker>; WIDTH] = std::array::from_fn(|_| coming.next());
    let face = &scene.faces()[piece.face as usize];
    let degree = [face.degree_u, face.degree_v].map(|p| p as usize);
    let mut uv = [[0.0; 2]; WIDTH];
    while walkers.iter().any(Option::is_some) {
        for (uv, walker) in uv.iter_mut().zip(&walkers) {
            *uv = walker.as_ref().map_or(*uv, |walker| walker.uv);
        }
        let points = run(level, Points::<CAPACITY, WIDTH> { scene, piece, degree, uv });
        for (lane, slot) in walkers.iter_mut().enumerate() {
            let Some(walker) = slot else { continue };
            let at = walker.problem.seen(walker.uv, points.map(|x| x.map(|x| x.0[lane])), true);
            let end = match &mut walker.walk {
                Some(walk) => walk.advance(piece, at),
                None => walker.walk.insert(Walk::new(piece, at)).judge(piece, true, false),
            };
            match (end, &walker.walk) {
                (Some(end), _) => {
                    let solution = walker.problem.search_all::<CAPACITY>(walker.seeds, Some(end));
                    out[first + walker.pixel] = solution.outcome;
                    *slot = coming.next();
                }
                (None, walk) => walker.uv = walk.as_ref().map_or(walker.uv, |walk| walk.uv),
            }
        }
    }
}

//! Pictures that are right but for the order of their pixels: mirrored, flipped, transposed.

use super::fault::Fault;
use super::view::{Hypothesis, Seen, View, mostly};
use glam::DVec2;

/// A pixel may lie this far beside its place, pixels, to be tried: chords and snapping.
const BESIDE_PX: f64 = 1.0;

/// The orders that may be: each takes the pixel that is stored at (x, y) to where it belongs.
pub(super) fn hypotheses<'a>(view: &'a View, samples: &[Seen]) -> impl Iterator<Item = Hypothesis> + use<'a> {
    let viewport = view.buffer.viewport();
    let (width, height) = (viewport.width(), viewport.height());
    type Order = Box<dyn Fn(usize, usize) -> [usize; 2]>;
    let orders: [(Fault, Order); 4] = [
        (Fault::Mirrored, Box::new(move |x, y| [width - 1 - x, y])),
        (Fault::RowsFlipped, Box::new(move |x, y| [x, height - 1 - y])),
        (Fault::HalfTurned, Box::new(move |x, y| [width - 1 - x, height - 1 - y])),
        // The memory of an array by columns, read by rows; of a square picture it is its transpose.
        (Fault::Transposed, Box::new(move |x, y| [(y * width + x) / height, (y * width + x) % height])),
    ];
    let fits = |order: &Order| {
        mostly(samples, |seen| {
            let [x, y] = order(seen.center.x as usize, seen.center.y as usize);
            let belongs = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            seen.place.is_some_and(|place| place.distance(belongs) <= BESIDE_PX)
        })
    };
    let found: Vec<(Fault, Order)> = orders.into_iter().filter(|(_, order)| fits(order)).collect();
    found.into_iter().map(move |(fault, order)| {
        let mut hits = vec![None; viewport.pixels()];
        for y in 0..height {
            for x in 0..width {
                let [column, row] = order(x, y);
                hits[row * width + column] = view.buffer.get(x, y).copied();
            }
        }
        view.hypothesis(fault, view.made(|x, y| hits[y * width + x]))
    })
}

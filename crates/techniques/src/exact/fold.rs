//! Where a ray that met a piece near a fold, or passed it there, may meet it again. Twin of `shaders/exact/fold.wgsl`.
//!
//! Near a fold both derivatives of the offset run along one line, nearly. On a curve through the piece the offset keeps
//! to the direction of the stronger one but for its **height** above that line, so the ray meets the piece where the
//! height is zero. The curve is followed by the weaker parameter, straight in (u, v) and as it starts: a place beside
//! it has the height of the place on it, to first order. Height times w is nearly a cubic of that parameter, known from
//! its values and slopes at the start and where the curve leaves the piece. Where the cubic changes its sign, the next
//! search begins; a root that is known already is divided out before.

use super::place::{BEYOND, Place, Problem, extent, searched};

/// Searches begin again at these shares of a piece: in its middle, and near its corners.
pub const RESTARTS: [[f32; 2]; 5] = [[0.5, 0.5], [0.125, 0.125], [0.125, 0.875], [0.875, 0.125], [0.875, 0.875]];

/// Room for the two seeds that the hull gives and, for the end of each, the three roots of the cubics on either side; and for the
/// restarts.
pub const QUEUE: usize = 2 + 2 * 2 * 3 + RESTARTS.len();

/// Parts into which the curve between the start and its end is cut: two roots in one of them are not told apart.
pub const SAMPLES: u32 = 8;

/// A start farther than this from the curve, as a share of the piece, is evaluated again on it.
pub const ASIDE: f32 = 1.0 / 16.0;

/// The curve is followed in a direction where it goes on for at least this share of the piece.
pub const SHORT: f32 = 1.0 / 8.0;

/// Seeds of searches, in their order.
pub struct Queue {
    /// Of these the first `count`.
    pub seeds: [[f32; 2]; QUEUE],
    /// How many there are.
    pub count: usize,
}

impl Queue {
    /// Where rounding changes a cubic's sign more often than three times, it is near one root all the while.
    pub fn push(&mut self, seed: [f32; 2]) {
        if self.count < QUEUE {
            self.seeds[self.count] = seed;
            self.count += 1;
        }
    }
}

/// Adds seeds where the piece is met again, as far as can be told from the `end` of a search.
#[inline(always)]
pub fn again<const CAPACITY: usize>(problem: &Problem, end: &Place, is_met: bool, queue: &mut Queue) {
    let extent = extent(problem.piece);
    let rectangle = &problem.piece.rectangle;
    let mut start = *end;
    if aside(&start).abs() > ASIDE {
        let k = stronger(&start);
        let [low, high] = searched(problem.piece);
        start.uv[k] = (start.uv[k] + aside(&start) * extent[k]).max(low[k]).min(high[k]);
        start = problem.place::<CAPACITY>(start.uv, true);
    }
    let strong = stronger(&start);
    let mut share = [0, 1].map(|k| (start.uv[k] - rectangle[k]) / extent[k]);
    share[strong] += aside(&start);
    let [aa, ab, bb] = products(&start);
    if aa.max(bb) == 0.0 {
        return;
    }
    let direction = if strong == 0 { [-ab / aa, 1.0] } else { [1.0, -ab / bb] };
    // How far the curve runs in the part that may be searched, in shares of the piece by the weaker parameter.
    let (mut least, mut greatest) = (f32::MIN, f32::MAX);
    for k in 0..2 {
        if direction[k] != 0.0 {
            let low = (-BEYOND - share[k]) / direction[k];
            let high = (1.0 + BEYOND - share[k]) / direction[k];
            least = least.max(low.min(high));
            greatest = greatest.min(low.max(high));
        }
    }
    if least >= greatest {
        return;
    }
    let on = |t: f32| [0, 1].map(|k| rectangle[k] + (share[k] + t * direction[k]) * extent[k]);
    let [height, slope] = height(&start, strong, direction);
    for k in 0..2 {
        let last = if k == 0 { least } else { greatest };
        if (k == 0 && least > -SHORT) || (k == 1 && greatest < SHORT) {
            continue;
        }
        let [last_height, last_slope] = self::height(&problem.place::<CAPACITY>(on(last), true), strong, direction);
        // Hermite: height + t (slope + t (square + t cube)).
        let chord = (last_height - height) / last;
        let square = (3.0 * chord - 2.0 * slope - last_slope) / last;
        let cube = (slope + last_slope - 2.0 * chord) / (last * last);
        let mut was_above = if is_met { slope > 0.0 } else { height > 0.0 };
        for sample in 1..=SAMPLES {
            let t = last * (sample as f32 / SAMPLES as f32);
            let divided = slope + t * (square + t * cube);
            let is_above = if is_met { divided > 0.0 } else { height + t * divided > 0.0 };
            if is_above != was_above {
                queue.push(on(last * ((sample as f32 - 0.5) / SAMPLES as f32)));
            }
            was_above = is_above;
        }
    }
}

/// The squares of the offset's derivatives and, between them, their product.
fn products(at: &Place) -> [f32; 3] {
    let Place { along_u: a, along_v: b, .. } = *at;
    [a[0] * a[0] + a[1] * a[1], a[0] * b[0] + a[1] * b[1], b[0] * b[0] + b[1] * b[1]]
}

/// The parameter along which the offset changes more.
fn stronger(at: &Place) -> usize {
    let [aa, _, bb] = products(at);
    if aa > bb { 0 } else { 1 }
}

/// How far the curve is along the stronger parameter, as a share of the piece.
fn aside(at: &Place) -> f32 {
    let [aa, _, bb] = products(at);
    let along = if aa > bb { at.along_u } else { at.along_v };
    let squared = aa.max(bb);
    if squared > 0.0 { -(at.offset[0] * along[0] + at.offset[1] * along[1]) / squared } else { 0.0 }
}

/// Height times w at a place, and its derivative along the curve.
fn height(at: &Place, strong: usize, direction: [f32; 2]) -> [f32; 2] {
    let (along, weaker) = if strong == 0 { (at.along_u, at.along_v) } else { (at.along_v, at.along_u) };
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
    if length == 0.0 {
        return [0.0; 2];
    }
    let above = |p: [f32; 2]| (p[0] * along[1] - p[1] * along[0]) / length;
    let recedes = at.recedes[0] * direction[0] + at.recedes[1] * direction[1];
    [above(at.offset) * at.w, (above(weaker) + above(at.offset) * recedes) * at.w]
}

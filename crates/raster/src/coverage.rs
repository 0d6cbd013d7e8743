//! Coverage: which pixel centres a snapped triangle holds, by integer edge functions and the top-left rule.

use crate::rect::Rect;
use crate::setup::Triangle;

/// Calls `visit` with every pixel of `rect` whose centre the triangle covers, row by row.
///
/// Of each row the columns are worked out and not looked for: a long sliver lies in many tiles, and covers little of each.
pub fn for_each_covered(triangle: &Triangle, rect: Rect, mut visit: impl FnMut(i32, i32)) {
    let rect = rect.intersection(triangle.bounds());
    if rect.is_empty() {
        return;
    }
    let edges = triangle.edges();
    let steps = edges.map(|e| e.step());
    // Values less what the top-left rule asks for: covered where none is negative.
    let mut row = edges.map(|e| e.at(rect.left, rect.top) - e.least());
    let [columns, rows] = [rect.right - rect.left - 1, rect.bottom - rect.top - 1].map(i64::from);
    let greatest = |i: usize| row[i] + (steps[i][0] * columns).max(0) + (steps[i][1] * rows).max(0);
    if (0..3).any(|i| greatest(i) < 0) {
        return;
    }
    for y in rect.top..rect.bottom {
        if let Some([first, last]) = columns_of(row, steps.map(|step| step[0]), columns) {
            for x in rect.left + first as i32..=rect.left + last as i32 {
                visit(x, y);
            }
        }
        row = std::array::from_fn(|i| row[i] + steps[i][1]);
    }
}

/// The first and the last column, of 0 … `last`, in which none of three values is negative that begin as `values` and grow by `steps`
/// from column to column.
#[inline]
fn columns_of(values: [i64; 3], steps: [i64; 3], last: i64) -> Option<[i64; 2]> {
    let (mut low, mut high) = (0, last);
    for (value, step) in values.into_iter().zip(steps) {
        let end = value + step * last;
        if value < 0 {
            if end < 0 {
                return None;
            }
            low = low.max((step - 1 - value) / step);
        } else if end < 0 {
            high = high.min(value / -step);
        }
    }
    (low <= high).then_some([low, high])
}

/// Whether the triangle covers the centre of one pixel.
pub fn covers(triangle: &Triangle, x: i32, y: i32) -> bool {
    triangle.edges().iter().all(|e| e.at(x, y) >= e.least())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::SUBPIXEL_ONE;
    use crate::vertex::Corner;
    use proptest::prelude::*;

    /// Pixels a side of the pictures drawn here.
    const SIDE: i32 = 24;

    const WHOLE: Rect = Rect { left: 0, top: 0, right: SIDE, bottom: SIDE };

    /// A triangle with corners in whole snapped units.
    fn triangle(units: [[i32; 2]; 3]) -> Option<Triangle> {
        let position = |p: [i32; 2]| p.map(|u| u as f32 / SUBPIXEL_ONE as f32);
        Triangle::new(units.map(|p| Corner { position: position(p), depth: 0.5, inverse_w: 1.0 }), [0.0; 2])
    }

    fn covered(units: [[i32; 2]; 3]) -> Vec<(i32, i32)> {
        let mut pixels = vec![];
        if let Some(triangle) = triangle(units) {
            for_each_covered(&triangle, WHOLE, |x, y| pixels.push((x, y)));
        }
        pixels
    }

    /// The rule in other words: a centre on an edge belongs to the triangle into which it moves when it goes right by
    /// 2⁻²³ units and down by 2⁻⁴⁶. Cross products of units below 2^21 are whole and their changes smaller than one;
    /// where they vanish, the step to the right decides unless the edge is level.
    fn covers_by_moving([a, b, c]: [[i32; 2]; 3], x: i32, y: i32) -> bool {
        let scaled = |units: i32| i128::from(units) << 46;
        let p = [scaled(x * 256 + 128) + (1 << 23), scaled(y * 256 + 128) + 1];
        let side = |from: [i32; 2], to: [i32; 2]| {
            let d = [i128::from(to[0] - from[0]), i128::from(to[1] - from[1])];
            (d[0] * (p[1] - scaled(from[1])) - d[1] * (p[0] - scaled(from[0]))).signum()
        };
        let sides = [side(a, b), side(b, c), side(c, a)];
        sides == [1; 3] || sides == [-1; 3]
    }

    /// A coordinate around the picture; a third of them in line with pixel centres, a third on whole pixels.
    fn coordinate() -> impl Strategy<Value = i32> {
        prop_oneof![-2000..8000i32, (-4..30i32).prop_map(|k| 256 * k + 128), (-4..30i32).prop_map(|k| 256 * k)]
    }

    fn point() -> impl Strategy<Value = [i32; 2]> {
        [coordinate(), coordinate()]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn coverage_is_what_exact_rationals_say(corners in [point(), point(), point()]) {
            let pixels = covered(corners);
            for y in 0..SIDE {
                for x in 0..SIDE {
                    let expected = covers_by_moving(corners, x, y);
                    prop_assert_eq!(pixels.contains(&(x, y)), expected, "pixel {} {}", x, y);
                    prop_assert_eq!(triangle(corners).is_some_and(|t| covers(&t, x, y)), expected);
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn a_triangulated_grid_covers_every_centre_exactly_once(
            cells in 1..7usize,
            jitter in prop::collection::vec([-1.0..1.0f64, -1.0..1.0f64], 64),
            grain in prop_oneof![Just(1i32), Just(128), Just(256)],
            choice in prop::collection::vec(0..24u8, 98),
            start in [0..700i32, 0..700i32],
        ) {
            // Corners move by under a third of a cell, so no triangle turns over; coarse grains meet centres often.
            let length = 5000 / (256 * cells as i32) * 256;
            let at = |i: usize, j: usize| -> [i32; 2] {
                let inner = |k: usize| k > 0 && k < cells;
                let move_by = |axis: usize, k: usize| {
                    let free = if inner(k) { jitter[8 * i + j][axis] * 0.3 * f64::from(length) } else { 0.0 };
                    start[axis] + k as i32 * length + (free as i32) / grain * grain
                };
                [move_by(0, i), move_by(1, j)]
            };
            let mut count = vec![0; (SIDE * SIDE) as usize];
            for i in 0..cells {
                for j in 0..cells {
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    let way = choice[i * cells + j];
                    let halves = if way & 1 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [d, b, c]] };
                    for mut corners in halves {
                        corners.rotate_left(usize::from(way / 8));
                        if way & 2 != 0 {
                            corners.swap(1, 2);
                        }
                        covered(corners).into_iter().for_each(|(x, y)| count[(y * SIDE + x) as usize] += 1);
                    }
                }
            }
            for y in 0..SIDE {
                for x in 0..SIDE {
                    let inside = |pixel: i32, axis: usize| {
                        let center = 256 * pixel + 128;
                        start[axis] <= center && center < start[axis] + cells as i32 * length
                    };
                    let expected = i32::from(inside(x, 0) && inside(y, 1));
                    prop_assert_eq!(count[(y * SIDE + x) as usize], expected, "pixel {} {}", x, y);
                }
            }
        }

        #[test]
        fn a_closed_fan_around_a_centre_covers_it_exactly_once(
            rim in prop::collection::vec([-2500..2500i32, -2500..2500i32], 3..14),
            on_axis in prop::collection::vec(0..4u8, 14),
        ) {
            // Sorted around the hub, with some corners straight above, below or beside it.
            let hub = [12 * 256 + 128; 2];
            let mut rim: Vec<[i32; 2]> = rim.into_iter().zip(on_axis).map(|(p, axis)| match axis {
                0 => [p[0], 0],
                1 => [0, p[1]],
                _ => p,
            }).filter(|p| *p != [0, 0]).collect();
            rim.sort_by(|a, b| f64::from(a[1]).atan2(f64::from(a[0])).total_cmp(&f64::from(b[1]).atan2(f64::from(b[0]))));
            let cross = |a: [i32; 2], b: [i32; 2]| i64::from(a[0]) * i64::from(b[1]) - i64::from(a[1]) * i64::from(b[0]);
            // No gap of half a turn or more, and not all on one ray.
            let dot = |a: [i32; 2], b: [i32; 2]| i64::from(a[0]) * i64::from(b[0]) + i64::from(a[1]) * i64::from(b[1]);
            let pairs = || (0..rim.len()).map(|i| (rim[i], rim[(i + 1) % rim.len()]));
            let closed = pairs().any(|(a, b)| cross(a, b) > 0)
                && pairs().all(|(a, b)| cross(a, b) > 0 || (cross(a, b) == 0 && dot(a, b) > 0));
            prop_assume!(closed);
            let mut count = vec![0; (SIDE * SIDE) as usize];
            for i in 0..rim.len() {
                let at = |p: [i32; 2]| [hub[0] + p[0], hub[1] + p[1]];
                let corners = [hub, at(rim[i]), at(rim[(i + 1) % rim.len()])];
                covered(corners).into_iter().for_each(|(x, y)| count[(y * SIDE + x) as usize] += 1);
            }
            prop_assert_eq!(count[(12 * SIDE + 12) as usize], 1);
            prop_assert!(count.iter().all(|&n| n <= 1));
        }
    }
}

//! How much of a surface the loops of a face need: the rectangle of its own parameters that becomes a spline.

use super::closed::Closed;
use super::shape::Shape;
use super::source::FaceError;
use glam::DVec2;

/// Room beside loops that do not run along the side of a patch, as a share of their extent.
const ROOM: f64 = 1.0 / 16.0;

/// A share of a period below which two parameters are one.
const SAME: f64 = 1e-9;

/// The rectangle of the surface's parameters that a patch has to cover; loops are moved into it by whole periods.
pub(super) fn rectangle(shape: &Shape, loops: &mut [Closed]) -> Result<[[f64; 2]; 2], FaceError> {
    let mut rectangle = shape.natural();
    let periods = shape.periods();
    let is_spline = matches!(shape, Shape::Spline { .. });
    // A surface that ends or closes by itself goes on around loops that are holes alone.
    let greatest = loops.iter().max_by(|a, b| a.area().abs().total_cmp(&b.area().abs()));
    let is_finite = rectangle.iter().flatten().all(|end| end.is_finite());
    let is_around = is_finite
        && loops.iter().all(|l| l.turns == [0.0; 2])
        && greatest.is_none_or(|l| l.area() < 0.0 && !l.has_seam());
    for axis in [0, 1] {
        let natural = rectangle[axis];
        if is_spline {
            // Each to where its middle is inside.
            if let Some(period) = periods[axis] {
                for closed in loops.iter_mut() {
                    let [low, high] = closed.extent(axis);
                    let mut by = DVec2::ZERO;
                    by[axis] = -((0.5 * (low + high) - natural[0]) / period).floor() * period;
                    closed.shift(by);
                }
            }
            continue;
        }
        rectangle[axis] = match periods[axis] {
            Some(period) => closed_range(axis, period, natural, is_around, loops),
            None => open_range(axis, natural, shape.apex().filter(|_| axis == 1), is_around, loops),
        };
        if !(rectangle[axis][0].is_finite() && rectangle[axis][1].is_finite()) {
            return Err(FaceError::Endless(['u', 'v'][axis]));
        }
    }
    Ok(rectangle)
}

/// The range of a parameter in which the surface is closed.
fn closed_range(axis: usize, period: f64, natural: [f64; 2], is_around: bool, loops: &mut [Closed]) -> [f64; 2] {
    let other = 1 - axis;
    let ring = loops.iter().position(|l| l.turns[axis] != 0.0);
    if loops.is_empty() || (is_around && ring.is_none()) {
        return [natural[0], natural[0] + period];
    }
    let across: Vec<usize> = (0..loops.len()).filter(|i| loops[*i].turns[other] != 0.0).collect();
    // The loop that is largest along the parameter comes first, the others follow into the period that it begins.
    let length = |l: &Closed| {
        let [low, high] = l.extent(axis);
        high - low
    };
    let first = ring.unwrap_or_else(|| {
        (0..loops.len()).max_by(|a, b| length(&loops[*a]).total_cmp(&length(&loops[*b]))).expect("there is one")
    });
    let start = match ring {
        Some(ring) => loops[ring].parts[0].ends()[0][axis],
        None => loops[first].extent(axis)[0],
    };
    for i in 0..loops.len() {
        let [low, high] = loops[i].extent(axis);
        let mut by = DVec2::ZERO;
        by[axis] = -((0.5 * (low + high) - start) / period + SAME).floor() * period;
        if i != first {
            loops[i].shift(by);
        }
    }
    if ring.is_some() {
        return [start, start + period];
    }
    if !across.is_empty() {
        // Rings the other way around: between a lower one with material above it and the next there is a band.
        for _ in 0..across.len() {
            let lowest =
                across.iter().copied().min_by(|a, b| loops[*a].extent(axis)[0].total_cmp(&loops[*b].extent(axis)[0]));
            let Some(lowest) = lowest.filter(|i| !material_above(axis, &loops[*i])) else { break };
            let mut by = DVec2::ZERO;
            by[axis] = period;
            loops[lowest].shift(by);
        }
        if across.len() % 2 == 1 {
            return [start, start + period];
        }
    }
    let [low, high] = with_room(axis, loops);
    if period * (1.0 - SAME) <= high - low {
        let least = loops.iter().map(|l| l.extent(axis)[0]).fold(f64::INFINITY, f64::min);
        return [least, least + period];
    }
    [low, high]
}

/// The range of a parameter that is not closed; at `apex` the surface is a point.
fn open_range(axis: usize, natural: [f64; 2], apex: Option<f64>, is_around: bool, loops: &[Closed]) -> [f64; 2] {
    if loops.is_empty() || is_around {
        return natural;
    }
    let [mut low, mut high] = with_room(axis, loops);
    let rings: Vec<&Closed> = loops.iter().filter(|l| l.turns[1 - axis] != 0.0).collect();
    let by = |a: &&&Closed, b: &&&Closed| a.extent(axis)[0].total_cmp(&b.extent(axis)[0]);
    if let Some(lowest) = rings.iter().min_by(by).filter(|ring| !material_above(axis, ring)) {
        let end = apex.filter(|apex| *apex <= lowest.extent(axis)[0]);
        low = end.unwrap_or(natural[0]);
    }
    if let Some(highest) = rings.iter().max_by(by).filter(|ring| material_above(axis, ring)) {
        let end = apex.filter(|apex| highest.extent(axis)[1] <= *apex);
        high = end.unwrap_or(natural[1]);
    }
    // A cone ends at its apex, though there be room beyond.
    if let Some(apex) = apex {
        let middle = loops
            .iter()
            .map(|l| l.extent(axis))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let middle = 0.5 * (middle[0] + middle[1]);
        if apex < middle { low = low.max(apex) } else { high = high.min(apex) }
    }
    [low.max(natural[0]), high.min(natural[1])]
}

/// Whether a ring has material where `axis`, the parameter across it, is greater: on its left.
fn material_above(axis: usize, ring: &Closed) -> bool {
    (0.0 < ring.turns[1 - axis]) == (axis == 1)
}

/// The extent of all loops, with room beside it where no part runs straight along its side.
fn with_room(axis: usize, loops: &[Closed]) -> [f64; 2] {
    let extents = loops.iter().map(|l| l.extent(axis));
    let [low, high] = extents.fold([f64::INFINITY, f64::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let slack = SAME * (high - low).max(SAME * low.abs().max(high.abs()));
    let straight = |side: f64| loops.iter().flat_map(|l| l.straight(axis)).find(|value| (value - side).abs() <= slack);
    let room = ROOM * (high - low);
    [straight(low).unwrap_or(low - room), straight(high).unwrap_or(high + room)]
}

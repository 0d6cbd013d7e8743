//! Which borders meet along an edge: as the file says, or found by matching them in space.
//!
//! Trims to which a file gives one edge number are neighbours, however far apart they run; those of one face that follow each
//! other along the edge are one border. All others are matched, also those whose number no other face has: each is cut where the end of another comes within the reach, and parts whose ends and inner points lie within the reach of
//! each other are neighbours. A border that meets two others one after the other has a T-junction between them.
//! What matching finds is measured, not proven; what is then said of the edges it finds is.

use crate::border::Border;
use crate::borders::Given;
use glam::DVec3;
use std::collections::BTreeMap;

/// Shares of a part's length at which it must lie near another.
const INNER: [f64; 3] = [0.25, 0.5, 0.75];

/// A border that is shorter than this share of the reach has no direction, and is a point though a file numbers it.
const POINT: f64 = 1e-9;

/// The most cuts of one border by ends of others; a border that more ends come near is cut no further.
const MOST_CUTS: usize = 1 << 12;

/// How neighbours were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// By the edge's number in the file.
    File(i64),
    /// By their place in space.
    Matched,
}

/// Borders that meet along an edge: two, or more where the model is no manifold there. The first runs forwards.
pub struct Group<'m> {
    /// How they were found.
    pub source: Source,
    /// All run the same way.
    pub borders: Vec<Border<'m>>,
}

/// A place where the end of one border lies within another.
pub struct TJunction<'m> {
    /// The border that goes on.
    pub through: Border<'m>,
    /// One that ends there.
    pub ending: Border<'m>,
    /// The place on the border that goes on.
    pub position: DVec3,
}

/// What was found.
pub struct Neighbours<'m> {
    /// Those that meet others.
    pub groups: Vec<Group<'m>>,
    /// Those, or parts of those, that meet none.
    pub free: Vec<Border<'m>>,
    /// Borders that are points in space, up to the reach: sides at poles, slits.
    pub points: Vec<Border<'m>>,
    /// Ends within other borders.
    pub junctions: Vec<TJunction<'m>>,
}

/// Finds the neighbours among all borders of a model; `reach` in model units.
pub fn neighbours(given: Vec<Given<'_>>, reach: f64) -> Neighbours<'_> {
    let mut numbered: BTreeMap<i64, Vec<Border>> = BTreeMap::new();
    let (mut points, mut loose) = (vec![], vec![]);
    for Given { border, edge } in given {
        let is_point = border.length() <= reach;
        match edge {
            _ if is_point && edge.is_none() => points.push(border),
            Some(edge) => numbered.entry(edge).or_default().push(border),
            None => loose.push(border),
        }
    }
    let mut groups = vec![];
    for (edge, trims) in numbered {
        let borders = whole(trims, reach);
        if borders.iter().any(|border| border.length() <= POINT * reach) {
            points.extend(borders);
        } else if borders.len() > 1 {
            groups.push(Group { source: Source::File(edge), borders: aligned(borders) });
        } else {
            let border = borders.into_iter().next().expect("one");
            let is_point = border.length() <= reach;
            if is_point { points.push(border) } else { loose.push(border) }
        }
    }
    let (parts, junctions) = parts(&loose, reach, &mut points);
    let mut free = vec![];
    for borders in matched(parts, reach) {
        if borders.len() > 1 {
            groups.push(Group { source: Source::Matched, borders: aligned(borders) });
        } else {
            free.extend(borders);
        }
    }
    Neighbours { groups, free, points, junctions }
}

/// An edge's trims as borders: where a reader cuts an edge in several trims, one after the other on a face, they are one.
fn whole(trims: Vec<Border<'_>>, reach: f64) -> Vec<Border<'_>> {
    let mut borders: Vec<Border> = vec![];
    for next in trims {
        match borders.last_mut() {
            Some(last) if last.face == next.face && goes_on(last, &next, reach) => *last = last.joined(&next),
            _ => borders.push(next),
        }
    }
    borders
}

/// Whether `next` begins where `border` ends and goes on from there; at a seam it would come back.
fn goes_on(border: &Border, next: &Border, reach: f64) -> bool {
    let way = 0.5 * border.length().min(next.length());
    let before = border.at(border.at_length(border.length() - way)).position;
    let after = next.at(next.at_length(way)).position;
    border.ends()[1].distance(next.ends()[0]) <= reach && way < before.distance(after)
}

/// The same borders, all running as the first does.
fn aligned(mut borders: Vec<Border<'_>>) -> Vec<Border<'_>> {
    let (first, others) = borders.split_first_mut().expect("a group has a border");
    for other in others {
        if is_against(first, other) {
            *other = other.reversed();
        }
    }
    borders
}

/// Whether two borders along one edge run against each other.
fn is_against(a: &Border, b: &Border) -> bool {
    const SHARES: [f64; 4] = [0.0, 0.25, 0.75, 1.0];
    let point = |border: &Border, share: f64| border.at(border.at_length(share * border.length())).position;
    let apart = |turn: &dyn Fn(f64) -> f64| -> f64 {
        SHARES.iter().map(|&share| point(a, share).distance(point(b, turn(share)))).sum()
    };
    apart(&|share| 1.0 - share) < apart(&|share| share)
}

/// The borders cut where others end.
fn parts<'m>(
    borders: &[Border<'m>],
    reach: f64,
    points: &mut Vec<Border<'m>>,
) -> (Vec<Border<'m>>, Vec<TJunction<'m>>) {
    let mut ends: Vec<(DVec3, usize)> =
        borders.iter().enumerate().flat_map(|(i, border)| border.ends().map(|end| (end, i))).collect();
    ends.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.1.cmp(&b.1)));
    let (mut parts, mut junctions) = (vec![], vec![]);
    for border in borders {
        let hull = border.hull();
        let (min, max) = (hull.min - reach, hull.max + reach);
        let mut cuts: Vec<(f64, usize)> = vec![];
        let from = ends.partition_point(|(end, _)| end.x < min.x);
        for (end, ending) in ends[from..].iter().take_while(|(end, _)| end.x <= max.x) {
            if !(min.cmple(*end).all() && end.cmple(max).all()) || MOST_CUTS <= cuts.len() {
                continue;
            }
            let t = border.nearest(*end);
            let along = border.length_to(t);
            let is_inside = reach < along && along < border.length() - reach;
            if is_inside && border.at(t).position.distance(*end) <= reach {
                cuts.push((t, *ending));
            }
        }
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        cuts.dedup_by(|b, a| border.length_to(b.0) - border.length_to(a.0) <= reach);
        let junction = |&(t, ending): &(f64, usize)| TJunction {
            through: border.clone(),
            ending: borders[ending].clone(),
            position: border.at(t).position,
        };
        junctions.extend(cuts.iter().map(junction));
        let all: Vec<f64> = [0.0].into_iter().chain(cuts.iter().map(|cut| cut.0)).chain([border.end()]).collect();
        for pair in all.windows(2) {
            let part = if cuts.is_empty() { border.clone() } else { border.part(pair[0], pair[1]) };
            if part.length() <= reach { points.push(part) } else { parts.push(part) }
        }
    }
    (parts, junctions)
}

/// Sets of parts that lie on each other.
fn matched(parts: Vec<Border<'_>>, reach: f64) -> Vec<Vec<Border<'_>>> {
    let key = |border: &Border| border.ends().iter().map(|end| end.x).sum::<f64>();
    let mut order: Vec<(f64, Border)> = parts.into_iter().map(|part| (key(&part), part)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut taken = vec![false; order.len()];
    let mut sets: Vec<Vec<usize>> = vec![];
    for i in 0..order.len() {
        if taken[i] {
            continue;
        }
        let mut set = vec![i];
        let near = (i + 1..order.len()).take_while(|j| order[*j].0 - order[i].0 <= 2.0 * reach);
        for j in near {
            if !taken[j] && is_along(&order[i].1, &order[j].1, reach) {
                taken[j] = true;
                set.push(j);
            }
        }
        sets.push(set);
    }
    let mut all: Vec<Option<Border>> = order.into_iter().map(|(_, part)| Some(part)).collect();
    sets.into_iter().map(|set| set.into_iter().filter_map(|i| all[i].take()).collect()).collect()
}

/// Whether ends and inner points of two parts lie within the reach of each other.
fn is_along(a: &Border, b: &Border, reach: f64) -> bool {
    let [[a0, a1], [b0, b1]] = [a.ends(), b.ends()];
    let near = |p: DVec3, q: DVec3| p.distance(q) <= reach;
    let ends = near(a0, b0) && near(a1, b1) || near(a0, b1) && near(a1, b0);
    let inner = |share: &f64| {
        let point = a.at(a.at_length(share * a.length())).position;
        near(b.at(b.nearest(point)).position, point)
    };
    ends && INNER.iter().all(inner)
}

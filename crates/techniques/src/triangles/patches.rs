//! Which Bézier patches of its surface a face comes to: faces of one surface are many, and each is small.

use scene::Region;
use std::ops::Range;

/// The spans in u and in v that a face comes to, and one more on either side: all of them where no loops bound it.
pub fn spans_of(region: Option<&Region>, breaks: &[Vec<f64>; 2]) -> [Range<usize>; 2] {
    [0, 1].map(|k| {
        let (starts, ends) = (&breaks[k][..breaks[k].len() - 1], &breaks[k][1..]);
        let Some(hull) = region.map(Region::hull) else { return 0..starts.len() };
        let first = ends.partition_point(|end| *end < hull.min[k]);
        let beyond = starts.partition_point(|start| *start <= hull.max[k]);
        first.saturating_sub(1)..(beyond + 1).min(starts.len())
    })
}

/// The patches, row-major in u, on ranges of spans in u and in v, where there are `columns` spans in v.
pub fn patches_on(spans: &[Range<usize>; 2], columns: usize) -> impl Iterator<Item = usize> {
    let [us, vs] = spans.clone();
    us.flat_map(move |k| vs.clone().map(move |l| k * columns + l))
}

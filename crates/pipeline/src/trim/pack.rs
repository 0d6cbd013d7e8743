//! Regions in f32: intervals, edges and pieces.

use crate::edge::pack::Leaf;
use crate::packed::{GREATEST_COUNT, Numbers, PackError};
use glam::{DVec2, DVec3};
use nurbs::BezierCurve;
use scene::Region;

/// Indices are kept as f32, which holds whole numbers up to here.
const GREATEST_INDEX: usize = 1 << 24;

/// Steps of a secant search at most; it ends earlier wherever a curve is not wild.
const STEPS: usize = 64;

/// A piece in local parameters, turned so that v rises.
struct Rising {
    curve: BezierCurve,
    /// Ends in v as both pieces that meet there have them.
    low: f32,
    high: f32,
    /// Index of its first number.
    index: usize,
    /// How far off f32 may take it.
    band: DVec2,
}

/// A piece in an interval.
struct Edge {
    piece: usize,
    /// u at the interval's lower and upper end.
    ends: [f64; 2],
}

impl Numbers {
    /// Appends a region: pieces and edges to the points; to the knots the ends of the intervals, and for each the index of
    /// its first edge, with one more behind the last. Returns where those stand, how many intervals there are, and the band
    /// along the edges in which f32 may take either side, in local parameters.
    ///
    /// Where fragments look for edges, their tree follows in points and knots ([`crate::edge`]).
    pub(crate) fn push_region(&mut self, region: &Region, edges: bool) -> Result<(u32, u32, DVec2), PackError> {
        let (pieces, leaves) = self.push_pieces(region, edges);
        let mut ends: Vec<f32> = pieces.iter().flat_map(|piece| [piece.low, piece.high]).collect();
        ends.sort_by(f32::total_cmp);
        ends.dedup();
        let mut by_start: Vec<usize> = (0..pieces.len()).collect();
        by_start.sort_by(|&a, &b| pieces[a].low.total_cmp(&pieces[b].low));
        let mut waiting = by_start.into_iter().peekable();
        let mut starts = vec![];
        let mut active: Vec<Edge> = vec![];
        for interval in ends.windows(2) {
            let [low, high] = [interval[0], interval[1]];
            active.retain(|edge| pieces[edge.piece].high > low);
            for edge in &mut active {
                edge.ends[0] = edge.ends[1];
            }
            while let Some(piece) = waiting.next_if(|&piece| pieces[piece].low == low) {
                let u = pieces[piece].curve.start().x;
                active.push(Edge { piece, ends: [u, u] });
            }
            for edge in &mut active {
                edge.ends[1] = pieces[edge.piece].u_at(high);
            }
            active.sort_by(|a, b| {
                let middle = |edge: &Edge| pieces[edge.piece].u_at(0.5 * (low + high));
                let sum = |edge: &Edge| edge.ends[0] + edge.ends[1];
                sum(a).total_cmp(&sum(b)).then_with(|| middle(a).total_cmp(&middle(b)))
            });
            starts.push(self.points.len());
            for Edge { piece, ends: [a, b] } in &active {
                let Rising { band, index, ref curve, .. } = pieces[*piece];
                let (least, greatest) = (a.min(*b) - band.x, a.max(*b) + band.x);
                let turn = if curve.end().x < curve.start().x { -1.0 } else { 1.0 };
                self.points.push([(least as f32).next_down(), (greatest as f32).next_up(), index as f32, turn]);
            }
            if self.points.len() > GREATEST_INDEX.min(GREATEST_COUNT) {
                return Err(PackError::TooLarge {
                    what: "control points and trim edges",
                    count: self.points.len(),
                    greatest: GREATEST_INDEX,
                });
            }
        }
        starts.push(self.points.len());
        let trims = self.knots.len();
        let intervals = ends.len().saturating_sub(1);
        if intervals == 0 {
            // Nothing of it is as high as f32 can tell: one interval that no parameter is in.
            self.knots.extend([0.0, 0.0, starts[0] as f32, starts[0] as f32]);
        } else {
            self.knots.extend(ends);
            self.knots.extend(starts.into_iter().map(|start| start as f32));
        }
        if edges {
            self.push_tree(leaves);
        }
        if intervals == 0 {
            return Ok((trims as u32, 1, DVec2::splat(f64::from(f32::EPSILON))));
        }
        let band = pieces.iter().fold(DVec2::ZERO, |most, piece| most.max(piece.band));
        Ok((trims as u32, intervals as u32, band))
    }

    /// Appends all pieces that rise or fall by what f32 can tell, and where the scene is to know of edges, those that do
    /// not and are edges; returns the former, and a leaf for each edge.
    ///
    /// Of each: (u, v, 1 / Δu, 1 / Δv) of its box; then its homogeneous control points in that box, 0 … 1, times their
    /// binomial coefficients, the first with the degree behind it.
    fn push_pieces(&mut self, region: &Region, edges: bool) -> (Vec<Rising>, Vec<Leaf>) {
        let (origin, size) = (region.domain().min, region.domain().size());
        let (mut pieces, mut leaves) = (vec![], vec![]);
        for piece in region.pieces() {
            let is_edge = edges && region.is_edge(piece);
            let local = |c: &DVec3| ((c.truncate() - origin * c.z) / size).extend(c.z);
            let curve =
                BezierCurve::new(piece.curve.control().iter().map(local).collect()).expect("as legal as before");
            let curve = if piece.winding() < 0 { curve.reversed() } else { curve };
            let [low, high] = [curve.start(), curve.end()].map(|end| end.y.clamp(0.0, 1.0) as f32);
            if low >= high && !is_edge {
                continue;
            }
            let index = self.points.len();
            let least = curve.start().min(curve.end());
            let [u, v] = [least.x as f32, low];
            let extent = (curve.end() - curve.start()).abs();
            let per = |extent: f64| if extent > f64::from(f32::MIN_POSITIVE) { (1.0 / extent) as f32 } else { 0.0 };
            let per = [per(extent.x), per(extent.y)];
            self.points.push([u, v, per[0], per[1]]);
            let degree = curve.degree();
            let mut binomial = 1.0;
            for (i, c) in curve.control().iter().enumerate() {
                let x = (c.x - f64::from(u) * c.z) * f64::from(per[0]) * binomial;
                let y = (c.y - f64::from(v) * c.z) * f64::from(per[1]) * binomial;
                let last = if i == 0 { degree as f64 } else { 0.0 };
                self.points.push([x, y, c.z * binomial, last].map(|x| x as f32));
                binomial *= (degree - i) as f64 / (i + 1) as f64;
            }
            let band = band(&curve);
            if is_edge {
                let hull = curve.hull();
                let [least, greatest] = [(hull.min - band).to_array(), (hull.max + band).to_array()];
                let [[u0, v0], [u1, v1]] =
                    [least.map(|t| (t as f32).next_down()), greatest.map(|t| (t as f32).next_up())];
                leaves.push(Leaf { hull: [u0, v0, u1, v1], piece: index });
            }
            if low < high {
                pieces.push(Rising { band, curve, low, high, index });
            }
        }
        (pieces, leaves)
    }
}

impl Rising {
    /// u where the piece is as high as `v`.
    fn u_at(&self, v: f32) -> f64 {
        if v <= self.low {
            return self.curve.start().x;
        }
        if v >= self.high {
            return self.curve.end().x;
        }
        let v = f64::from(v);
        // The secant method between two sides, of which the older counts half each time it stays (Illinois).
        let (mut low, mut high) = ([0.0, self.curve.start().y - v], [1.0, self.curve.end().y - v]);
        for _ in 0..STEPS {
            let t = (low[0] * high[1] - high[0] * low[1]) / (high[1] - low[1]);
            if !(low[0] < t && t < high[0]) {
                break;
            }
            let c = self.curve.point(t);
            let above = c.y - v;
            if above.abs() <= 1e-14 {
                return c.x;
            }
            if above < 0.0 {
                low = [t, above];
                high[1] *= 0.5;
            } else {
                high = [t, above];
                low[1] *= 0.5;
            }
        }
        self.curve.point(0.5 * (low[0] + high[0])).x
    }
}

/// How far off the fragment's arithmetic may see a piece, in local parameters.
///
/// In units u = 2⁻²⁴: narrowing its corner and the fragment's distance from it, u each of 1; three more for the fragment's
/// parameters, which are made of a span's. Of the piece's own size, one for each narrowed control point, and of Horner's scheme
/// three for each degree, all of them times what the weights can magnify; a division, and the last of the bisections.
fn band(curve: &BezierCurve) -> DVec2 {
    const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
    let size = curve.hull().size();
    UNIT * (DVec2::splat(6.0) + (3 * curve.degree() + 8) as f64 * curve.weight_ratio() * size)
}

//! Whether a hit's parameters are material: in f64, by bisection of the region's monotone pieces.

use glam::DVec2;
use nurbs::{BezierCurve, Rectangle};
use scene::Region;

/// Bisections of a piece: enough for every bit of its parameter.
const BISECTIONS: u32 = 60;

/// What can be said of a point of a trimmed domain that is known to a band.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// All of the band is material.
    Material,
    /// None of it is.
    Cut,
    /// An edge passes through it.
    Edge,
}

/// Where the rectangle `uv` ± `band` is. Beyond the domain all is cut; on its border a point counts as its neighbour inside.
pub(crate) fn place(region: &Region, uv: DVec2, band: DVec2) -> Place {
    let Rectangle { min, max } = region.domain();
    if (uv + band).cmplt(min).any() || (uv - band).cmpgt(max).any() {
        return Place::Cut;
    }
    let uv = uv.clamp(min, max.map(f64::next_down));
    let mut winding = 0;
    for piece in region.pieces() {
        let [start, end] = [piece.curve.start(), piece.curve.end()];
        let (low, high) = (start.min(end), start.max(end));
        if low.cmple(uv + band).all() && high.cmpge(uv - band).all() && passes(&piece.curve, uv, band) {
            return Place::Edge;
        }
        // The ray toward +u meets a piece that is all on the right, or that bends around the point.
        if low.y <= uv.y && uv.y < high.y && uv.x < high.x && (uv.x < low.x || at_height(&piece.curve, uv.y).x > uv.x) {
            winding += piece.winding();
        }
    }
    if winding != 0 { Place::Material } else { Place::Cut }
}

/// Places on a piece at which its distance is taken before the least are looked at closely.
const SAMPLES: usize = 32;

/// Thirds of the way between such places that are cut off, one after the other.
const SECTIONS: u32 = 40;

/// Whether an edge of the region comes within `radius` of what `distance` measures from.
pub(crate) fn edge_passes(region: &Region, distance: impl Fn(DVec2) -> f64, radius: f64) -> bool {
    region.pieces().iter().any(|piece| least(|t| distance(piece.curve.point(t)), [0.0, 1.0], SAMPLES).0 <= radius)
}

/// The least that is found of a function between two ends, and where: of `samples` steps, and about each place that has
/// less than its neighbours by ternary search.
pub(crate) fn least(of: impl Fn(f64) -> f64, [start, end]: [f64; 2], samples: usize) -> (f64, f64) {
    let place = |i: usize| start + (end - start) * i as f64 / samples as f64;
    let values: Vec<f64> = (0..=samples).map(|i| of(place(i))).collect();
    let mut least = (values[0], start);
    for i in 0..=samples {
        let [before, after] = [i.saturating_sub(1), (i + 1).min(samples)];
        if values[i] < least.0 {
            least = (values[i], place(i));
        }
        if values[before] < values[i] || values[after] < values[i] {
            continue;
        }
        let [mut low, mut high] = [place(before), place(after)];
        for _ in 0..SECTIONS {
            let third = (high - low) / 3.0;
            let [a, b] = [low + third, high - third];
            let [at_a, at_b] = [of(a), of(b)];
            for (value, t) in [(at_a, a), (at_b, b)] {
                if value < least.0 {
                    least = (value, t);
                }
            }
            if at_a < at_b { high = b } else { low = a }
        }
    }
    least
}

/// Whether a monotone piece whose box meets the rectangle passes through it: by what it spans in u while it is as high.
fn passes(curve: &BezierCurve, uv: DVec2, band: DVec2) -> bool {
    let [a, b] = [uv.y - band.y, uv.y + band.y].map(|v| at_height(curve, v).x);
    // A level piece is as high all along.
    let level = curve.start().y == curve.end().y;
    let [a, b] = if level { [curve.start().x, curve.end().x] } else { [a, b] };
    a.min(b) <= uv.x + band.x && a.max(b) >= uv.x - band.x
}

/// The point of a monotone piece at v, or its nearer end.
fn at_height(curve: &BezierCurve, v: f64) -> DVec2 {
    let rises = curve.end().y > curve.start().y;
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let t = 0.5 * (low + high);
        if (curve.point(t).y <= v) == rises { low = t } else { high = t }
    }
    curve.point(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::FaceId;

    #[test]
    fn a_place_is_material_cut_or_on_the_edge() {
        let model = models::builtin("islands").expect("built in");
        let region = model.region(FaceId(0)).expect("trimmed");
        let size = region.domain().size();
        let places: Vec<(DVec2, Place)> = (0..2000)
            .map(|i| {
                let share = DVec2::new(0.754_877_666_246_69, 0.569_840_290_998_05) * f64::from(i);
                let uv = region.domain().min + share.fract() * size;
                (uv, place(region, uv, 1e-9 * size))
            })
            .collect();
        let share = |kind| places.iter().filter(|(_, p)| *p == kind).count() as f64 / places.len() as f64;
        let expected = region.area() / (size.x * size.y);
        assert!((share(Place::Material) - expected).abs() < 0.03, "{} of {expected}", share(Place::Material));
        assert_eq!(share(Place::Edge), 0.0);
        for piece in region.pieces() {
            assert_eq!(place(region, piece.curve.point(0.3), 1e-9 * size), Place::Edge);
        }
        // A band as wide as the domain has an edge in it wherever it is.
        assert!(places.iter().all(|(uv, _)| place(region, *uv, size) == Place::Edge));
    }
}

//! Whether a hit's parameters are material: in f64, by bisection of the region's monotone pieces.

use glam::DVec2;
use nurbs::BezierCurve;
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

/// Where the rectangle `uv` ± `band` is.
pub(crate) fn place(region: &Region, uv: DVec2, band: DVec2) -> Place {
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
        let model = formats::builtin("islands").expect("built in");
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

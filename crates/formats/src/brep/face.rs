//! A face of a file as a face of a scene: loops put together in the surface's own parameters, the part of the surface
//! that they need as a spline, and trims on it.

use super::closed::Closed;
use super::fit::fitting;
use super::inverse::Inverter;
use super::patch::Patch;
use super::rectangle::rectangle;
use super::shape::Shape;
use super::source::{FaceError, Found, Made, Source};
use glam::DVec2;
use scene::{Face, Loop};

/// Edges farther from their surface than this many tolerances, and than this share of the face's size, are not its own.
const OFF_TOLERANCES: f64 = 100.0;
const OFF_SHARE: f64 = 0.01;

/// A gap is measured along the surface, which is a little longer than the straight way through a vertex.
const ALONG: f64 = 1.01;

/// Puts a face together.
///
/// # Errors
/// Where an edge is not on the surface, where the surface is endless and the loops do not bound it, and where numbers
/// are not usable.
pub(crate) fn make(source: &Source) -> Result<Made, FaceError> {
    let size = size(source);
    let tolerance = fitting(source.tolerance, size);
    let inverter = Inverter::new(&source.shape, size);
    let mut found = Found { off: source.off, ..Found::default() };
    let mut loops = vec![];
    for bound in source.bounds.iter().filter(|bound| !bound.uses.is_empty()) {
        loops.push(Closed::new(source, bound, &inverter, tolerance, &mut found)?);
    }
    let most = (OFF_TOLERANCES * source.tolerance).max(OFF_SHARE * size);
    if most < found.gap {
        return Err(FaceError::OffSurface { gap: found.gap, most });
    }
    if !loops.iter().flat_map(|l| &l.parts).all(|part| part.path.uv.iter().all(|uv| uv.is_finite())) {
        return Err(FaceError::NotFinite);
    }
    let rectangle = rectangle(&source.shape, &mut loops)?;
    let patch = Patch::new(&source.shape, rectangle)?;
    let named = source.bounds.iter().filter(|bound| bound.outer).count();
    let greatest = loops.iter().map(|l| l.area().abs()).fold(0.0, f64::max);
    let ends = source.shape.periods() == [None; 2];
    let mut bounds = vec![];
    for closed in &loops {
        // Where none is named, or several are, the direction says it; the greatest is never a hole of a surface that ends.
        let is_greatest = closed.area().abs() == greatest;
        let by_area = 0.0 < closed.area() || (is_greatest && (ends || closed.has_seam()));
        let outer = if named == 1 { closed.outer } else { by_area };
        let mut trims = vec![];
        let mut before = closed.parts.last();
        for part in &closed.parts {
            let own = part.trims(source, &inverter, &patch, tolerance, &mut found)?;
            let first = trims.len();
            trims.extend(own);
            // A vertex that is farther from its edges than the file's tolerance says how far they may be from each other.
            let off = before.map_or(0.0, |before| before.vertices()[1]).max(part.vertices()[0]);
            if source.tolerance < off && off <= most {
                trims[first].vertex_tolerance = Some(off * ALONG);
                found.vertex = found.vertex.max(off);
            }
            before = Some(part);
        }
        bounds.push(Loop { outer, trims });
    }
    let face = Face { surface: 0, reversed: !source.same_sense, tolerance: source.tolerance, loops: bounds };
    Ok(Made { surface: patch.surface, face, found })
}

/// The diagonal of the box of the face's edges, or of its surface.
fn size(source: &Source) -> f64 {
    let pieces = source.bounds.iter().flat_map(|bound| &bound.uses).filter_map(|u| u.space.as_ref());
    let edges = nurbs::Hull::of(pieces.flat_map(|piece| (0..=8).map(|k| piece.point(f64::from(k) / 8.0))));
    let of_surface = match &source.shape {
        Shape::Spline { surface, .. } => surface.hull().diagonal(),
        shape => {
            let corner = |uv: [f64; 2]| shape.point(DVec2::from_array(uv.map(|t| if t.is_finite() { t } else { 0.0 })));
            let [[u0, u1], [v0, v1]] = shape.natural();
            let middle = 0.5 * (u0 + u1);
            nurbs::Hull::of([[u0, v0], [u1, v1], [middle, v0], [middle, v1]].map(corner)).diagonal()
        }
    };
    let of_edges = if edges.min.is_finite() { edges.diagonal() } else { 0.0 };
    of_edges.max(of_surface).max(f64::MIN_POSITIVE)
}

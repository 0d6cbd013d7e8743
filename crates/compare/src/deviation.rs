//! How far across the ray a candidate's point may lie from what the reference shows, before any rounding of S itself.

use crate::seams::Seams;
use crate::vertex_normals::VertexNormals;
use nurbs::{BezierPatch, Surface};
use rayon::prelude::*;
use scene::{Camera, Model, Viewport};
use std::f64::consts::SQRT_2;
use std::sync::Arc;

/// Vertices snap to 1/256 pixel, each coordinate by at most half of it; a viewport transform in f32 adds less than
/// the other half up to 16384 pixels.
pub const SNAP_PX: f64 = 1.0 / 256.0;

/// What is left of [`SNAP_PX`] for the viewport transform where corners go to the nearest 256th of a pixel along both sides.
const TRANSFORM_PX: f64 = SNAP_PX - SQRT_2 / 512.0;

/// How far corners may be off, pixels, that a grid moves by `moves_px` along each side; [`SNAP_PX`] where that is less.
fn corners_px(moves_px: f64) -> f64 {
    SNAP_PX.max(SQRT_2 * moves_px + TRANSFORM_PX)
}

/// Interpolated parameters may be off by this many units of 2⁻²⁴ of what they run over, 0 … 1: WGSL states no accuracy of
/// interpolation. Of the models of the conformance tests, none needs more on llvmpipe or an H100.
pub const ATTRIBUTE_ULPS: f64 = 16.0;

/// A renderer that finds the point on the pixel's own ray, rather than on a triangle's, may be this far off, pixels.
pub const EXACT_PX: f64 = 0.01;

/// Loops are followed at the point on the pixel's own ray by every technique, to this, pixels: what a face is drawn too far
/// ([`pipeline::sight::NEAR_PX`]), what technique `exact` leaves of the way to that point, and rounding of positions.
pub const EDGE_PX: f64 = 0.01;

/// A pixel of flat triangles has no verdict where its bound comes to this many times the chord that was asked for.
///
/// Where a pixel's size is right, at a face's nearest depth, the bound is the chord and a fiftieth more; twice as much holds
/// 60° off the view's axis, where a model unit covers twice the pixels.
pub const TRIANGLES_MULTIPLE: f64 = 2.0;

/// A pixel of technique `exact` has no verdict where its bound comes to this many times [`EXACT_PX`].
///
/// All of it but a quarter is for the rounding of S, seen there: at 64 × 64 pixels it is a hundredth of that for bicubic
/// surfaces, and three hundredths for degree 9.
pub const EXACT_MULTIPLE: f64 = 4.0;

/// The share of covered pixels in which a renderer of this program that solves for the surface may end without an answer.
pub const UNANSWERED_SHARE: f64 = 1e-3;

/// What the accuracy of interpolated parameters amounts to on each Bézier piece of a model's surfaces, model units.
#[derive(Debug, Clone, PartialEq)]
pub struct Interpolation {
    /// Pieces in the order of [`Surface::bezier_patches`].
    per_surface: Arc<Vec<Vec<f64>>>,
    /// Of each face.
    surfaces: Vec<usize>,
}

impl Interpolation {
    /// Of parameters that are 0 … 1 on each piece: [`ATTRIBUTE_ULPS`] of it at its greatest speeds.
    pub fn of(model: &Model) -> Self {
        Self::with(model, true)
    }

    /// Of parameters that are those of the whole domain: [`ATTRIBUTE_ULPS`] of it at the greatest speeds of each piece.
    pub fn of_domain(model: &Model) -> Self {
        Self::with(model, false)
    }

    fn with(model: &Model, local: bool) -> Self {
        let per_surface = Arc::new(model.surfaces().par_iter().map(|surface| attributes_of(surface, local)).collect());
        Self { per_surface, surfaces: model.faces().iter().map(|face| face.surface).collect() }
    }

    /// On a piece of a face.
    pub(crate) fn at(&self, face: usize, piece: usize) -> f64 {
        self.per_surface[self.surfaces[face]][piece]
    }
}

/// What a renderer says its pixels show, which a comparison holds it to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Claims {
    /// A point of a flat triangle on the pixel's ray, with S at its parameters off by the chord at most.
    Chord,
    /// The point on the ray itself, or in a few pixels no answer.
    OnRay,
}

impl Claims {
    /// The share of covered pixels in which a renderer of this program may end without an answer, and say so.
    pub fn unanswered_share(self) -> f64 {
        match self {
            Self::Chord => 0.0,
            Self::OnRay => UNANSWERED_SHARE,
        }
    }
}

/// The allowance of a pair of renderers.
#[derive(Debug, Clone, PartialEq)]
pub struct Deviation {
    /// Per face: the greatest distance of a flat proxy triangle from S at its (u, v), model units; a number for each Bézier
    /// piece of its surface, in the order of [`Surface::bezier_patches`], or one for all of them. Empty where both
    /// renderers draw the same triangles, or none.
    pub chord: Vec<Vec<f64>>,
    /// Per face and piece: the chord bound of the triangles that are drawn, even where it does not count between two
    /// renderers of the same ones, model units. It holds the pixels at an edge of the triangles: snapping may put a pixel's
    /// centre outside the triangle that covers it, and a renderer then follows the triangle's plane beyond the edge.
    pub edge_chord: Vec<Vec<f64>>,
    /// What the accuracy of interpolated parameters amounts to, once for each side that interpolates them.
    pub interpolation: Vec<Interpolation>,
    /// Whether triangles go on beyond a bounded face's border and show the border's point there.
    pub has_skirts: bool,
    /// Pixels: snapping of vertices; [`EXACT_PX`] where there are none.
    pub snap_px: f64,
    /// The part of it that is the candidate's own corners, if it has any.
    pub corners_px: f64,
    /// How near an edge of a face that loops bound may pass the centre of a pixel that is shown the wrong side of it, pixels.
    pub edge_px: f64,
    /// The least bound with which a pixel has no verdict, pixels.
    pub limit_px: f64,
    /// Of a candidate that shows the points of its triangles and the normals interpolated over them: the cells.
    pub vertex_normals: Option<VertexNormals>,
    /// Whether the candidate searches for roots, so that a nearer surface that it does not show is one that it missed.
    pub is_searched: bool,
    /// The share of covered pixels in which the candidate may say that it found no answer.
    pub unanswered_share: f64,
    /// Per face and piece, as [`Self::chord`]: the distance of what is drawn from the model that it stands for, model units; it
    /// is a part of both chords. Empty where the model itself is drawn.
    pub stand_in: Vec<Vec<f64>>,
    /// Where triangles meet vertex on vertex: between faces there no pixel may be left out.
    pub seams: Arc<Seams>,
    /// All of it in words.
    pub text: String,
}

impl Deviation {
    /// A rasterizer of flat triangles, asked to stay within `asked_px` pixels, against the surface itself. `chord` holds
    /// what they keep: for each face a number for each piece, or one.
    pub fn of_proxy(interpolation: &Interpolation, chord: &[Vec<f64>], asked_px: f64) -> Self {
        Self {
            chord: chord.to_vec(),
            edge_chord: chord.to_vec(),
            interpolation: vec![interpolation.clone()],
            has_skirts: true,
            snap_px: SNAP_PX,
            corners_px: SNAP_PX,
            edge_px: EDGE_PX,
            // A chord below 1/100 pixel cannot be asked for in earnest: vertices snap to 1/256.
            limit_px: TRIANGLES_MULTIPLE * asked_px.max(EXACT_PX),
            vertex_normals: None,
            is_searched: false,
            unanswered_share: 0.0,
            stand_in: vec![],
            seams: Arc::default(),
            text: format!(
                "chord bound of the tessellation (Filip, Magedson & Markot 1986) + {SNAP_PX} px of vertex snapping + \
                 {ATTRIBUTE_ULPS} ulp of interpolated parameters; rounding of S: its proven interval"
            ),
        }
    }

    /// Two rasterizers of the same triangles, whose chord bounds are given as for [`Self::of_proxy`].
    pub fn of_same_proxy(interpolation: &Interpolation, chord: &[Vec<f64>], asked_px: f64) -> Self {
        Self {
            chord: vec![],
            snap_px: 2.0 * SNAP_PX,
            edge_px: 2.0 * EDGE_PX,
            text: format!(
                "the same triangles, so no chord but at their edges: {} px of vertex snapping + {ATTRIBUTE_ULPS} ulp of interpolated \
                 parameters; rounding of S: its proven interval",
                2.0 * SNAP_PX
            ),
            ..Self::of_proxy(interpolation, chord, asked_px)
        }
    }

    /// A rasterizer of flat triangles that are not known, but said to stay within `chord_px` pixels of S at their (u, v),
    /// pixels being measured at the nearest depth of each face's control points ([`Camera::pixel_at`]).
    ///
    /// `chord_px` is what the caller allows, not what a G-buffer says of itself.
    pub fn of_claimed_chord(model: &Model, camera: &Camera, viewport: Viewport, chord_px: f64) -> Self {
        let chord = |face: usize| vec![chord_px * camera.pixel_at(viewport, model.surfaces()[face].hull())];
        let chord: Vec<Vec<f64>> = model.faces().iter().map(|face| chord(face.surface)).collect();
        Self {
            edge_px: chord_px + SNAP_PX,
            text: format!(
                "claimed chord of {chord_px} px at each face's nearest depth + {SNAP_PX} px of vertex snapping + \
                 {ATTRIBUTE_ULPS} ulp of interpolated parameters"
            ),
            ..Self::of_proxy(&Interpolation::of_domain(model), &chord, chord_px)
        }
    }

    /// A renderer that solves for the point on the pixel's ray, against another that does: [`EXACT_PX`], and no chord.
    ///
    /// Rounding of the parameters found is not allowed anything beside it.
    pub fn exact() -> Self {
        Self {
            chord: vec![],
            edge_chord: vec![],
            interpolation: vec![],
            has_skirts: false,
            snap_px: EXACT_PX,
            corners_px: 0.0,
            edge_px: EDGE_PX,
            limit_px: EXACT_MULTIPLE * EXACT_PX,
            vertex_normals: None,
            is_searched: false,
            unanswered_share: 0.0,
            stand_in: vec![],
            seams: Arc::default(),
            text: format!("{EXACT_PX} px from the pixel's ray"),
        }
    }

    /// A renderer of this program against the surface itself, by what its technique claims; as of [`Self::of_proxy`].
    pub fn against_surface(claims: Claims, interpolation: &Interpolation, chord: &[Vec<f64>], asked_px: f64) -> Self {
        let unanswered_share = claims.unanswered_share();
        match claims {
            Claims::Chord => Self::of_proxy(interpolation, chord, asked_px),
            Claims::OnRay => Self { is_searched: true, unanswered_share, ..Self::exact() },
        }
    }

    /// Two renderers of this program against each other, alike.
    pub fn between_twins(claims: Claims, interpolation: &Interpolation, chord: &[Vec<f64>], asked_px: f64) -> Self {
        match claims {
            Claims::Chord => Self::of_same_proxy(interpolation, chord, asked_px),
            Claims::OnRay => {
                let one = Self::against_surface(claims, interpolation, chord, asked_px);
                one.either(&one)
            }
        }
    }

    /// The same where the candidate shows what its triangles carry.
    pub fn with_vertex_normals(self, vertex_normals: VertexNormals) -> Self {
        let text = format!(
            "{}; position and normal: those of flat triangles, within the chord and a cone of the cell's normals",
            self.text
        );
        Self { vertex_normals: Some(vertex_normals), text, ..self }
    }

    /// The same where both renderers' triangles, if they have any, meet so.
    pub fn meeting(self, seams: Arc<Seams>) -> Self {
        Self { seams, ..self }
    }

    /// The same where the candidate's corners go to a grid that moves them by `moves_px` along each side at most, as was measured
    /// on the adapter that drew them. A finer one than is assumed takes nothing away.
    ///
    /// What a G-buffer says of its adapter is no measurement.
    pub fn on_grid(self, moves_px: f64) -> Self {
        if self.corners_px == 0.0 {
            return self;
        }
        let corners_px = corners_px(moves_px);
        let snap_px = self.snap_px - self.corners_px + corners_px;
        let text =
            format!("{}; the candidate's corners: {corners_px:.4} px, by its adapter's grid as measured", self.text);
        Self { snap_px, corners_px, text, ..self }
    }

    /// What two renderers may differ by, each of which has an allowance of its own against the surface.
    pub fn either(&self, other: &Self) -> Self {
        Self {
            chord: sums(&self.chord, &other.chord),
            edge_chord: sums(&self.edge_chord, &other.edge_chord),
            interpolation: self.interpolation.iter().chain(&other.interpolation).cloned().collect(),
            has_skirts: self.has_skirts || other.has_skirts,
            snap_px: self.snap_px + other.snap_px,
            corners_px: other.corners_px,
            edge_px: self.edge_px + other.edge_px,
            limit_px: self.limit_px + other.limit_px,
            vertex_normals: other.vertex_normals.clone(),
            is_searched: other.is_searched,
            unanswered_share: self.unanswered_share.max(other.unanswered_share),
            stand_in: sums(&self.stand_in, &other.stand_in),
            seams: if self.seams == other.seams { self.seams.clone() } else { Arc::default() },
            text: if self.text == other.text {
                format!("on either side {}", self.text)
            } else {
                format!("both of: {} | {}", self.text, other.text)
            },
        }
    }

    /// The chord of a piece of a face, model units.
    pub(crate) fn chord_at(&self, face: usize, piece: usize) -> f64 {
        of_piece(&self.chord, face, piece)
    }

    /// How far what is drawn is from the model on a piece of a face, model units.
    pub(crate) fn stand_in_at(&self, face: usize, piece: usize) -> f64 {
        of_piece(&self.stand_in, face, piece)
    }

    /// The chord at the edges of the triangles.
    pub(crate) fn edge_chord_at(&self, face: usize, piece: usize) -> f64 {
        of_piece(&self.edge_chord, face, piece)
    }

    /// What interpolation of parameters amounts to on a piece of a face, model units.
    pub(crate) fn attribute_at(&self, face: usize, piece: usize) -> f64 {
        self.interpolation.iter().map(|side| side.at(face, piece)).sum()
    }
}

/// The number of a piece in a list of one for each, or of one for all; none in an empty list.
fn of_piece(faces: &[Vec<f64>], face: usize, piece: usize) -> f64 {
    let Some(pieces) = faces.get(face) else { return 0.0 };
    if let [all] = pieces[..] { all } else { pieces[piece] }
}

/// Numbers of pieces, added up.
pub(crate) fn sums(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let faces = a.len().max(b.len());
    let pieces = |face: usize| {
        let count = [a, b].iter().filter_map(|of| of.get(face)).map(Vec::len).max().unwrap_or(0);
        (0..count).map(|piece| of_piece(a, face, piece) + of_piece(b, face, piece)).collect()
    };
    (0..faces).map(pieces).collect()
}

/// [`ATTRIBUTE_ULPS`] of the piece that parameters are local to, or of the whole domain.
fn attributes_of(surface: &Surface, local: bool) -> Vec<f64> {
    let of_piece = |patch: &BezierPatch| {
        let bounds = patch.derivative_bounds();
        let [width, height] = if local { patch.domain } else { surface.domain() }.map(|[start, end]| end - start);
        ATTRIBUTE_ULPS / (1u64 << 24) as f64 * (bounds.u * width + bounds.v * height)
    };
    surface.bezier_patches().iter().map(of_piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_takes_its_own_number_or_the_one_for_all_and_two_sides_add_up() {
        let model = models::builtin("surface").expect("built in");
        let pieces = model.surfaces()[0].bezier_patches().len();
        let each: Vec<f64> = (0..pieces).map(|piece| 1.0 + piece as f64).collect();
        let of = |chord: Vec<f64>| Deviation::of_proxy(&Interpolation::of(&model), &[chord], 0.25);
        let (one, all) = (of(each), of(vec![0.5]));
        assert_eq!((one.chord_at(0, pieces - 1), all.chord_at(0, pieces - 1)), (pieces as f64, 0.5));
        let both = one.either(&all).either(&Deviation::exact());
        assert_eq!(both.chord_at(0, 2), 3.5);
        assert_eq!(both.attribute_at(0, 2), 2.0 * one.attribute_at(0, 2));
        assert_eq!(both.limit_px, 1.0 + EXACT_MULTIPLE * EXACT_PX);
        assert_eq!(Deviation::exact().chord_at(0, 2), 0.0);
    }

    #[test]
    fn only_a_grid_that_is_coarser_than_assumed_widens_what_corners_are_allowed() {
        let model = models::builtin("surface").expect("built in");
        let of = || Deviation::of_proxy(&Interpolation::of(&model), &[vec![0.5]], 0.25);
        for moves_px in [0.0, 1.0 / 8192.0, 1.0 / 512.0] {
            assert_eq!(of().on_grid(moves_px).snap_px, SNAP_PX, "{moves_px}");
        }
        // Down to a 256th; to the nearest 16th.
        let [down, coarse] = [1.0 / 256.0, 1.0 / 32.0].map(|moves_px| of().on_grid(moves_px));
        assert!(SQRT_2 / 256.0 < down.snap_px && down.snap_px < 1.0 / 128.0, "{}", down.snap_px);
        assert!(SQRT_2 / 32.0 < coarse.snap_px && coarse.snap_px < 1.0 / 16.0, "{}", coarse.snap_px);
        // Nothing else grows, above all not the bound from which on there is no verdict, and not a renderer's without corners.
        assert_eq!((coarse.limit_px, coarse.edge_px), (of().limit_px, of().edge_px));
        assert_eq!(Deviation::exact().on_grid(1.0 / 32.0), Deviation::exact());
        // Of two renderers the candidate's corners alone are on that grid.
        let twins = || Deviation::of_same_proxy(&Interpolation::of(&model), &[vec![0.5]], 0.25);
        assert_eq!(twins().on_grid(1.0 / 32.0).snap_px, SNAP_PX + coarse.snap_px);
    }
}

//! A model that was drawn in place of another, within a distance that is proven: its values are judged as what they are, its
//! picture by the other model, and to what that is allowed the distance is added, and nothing else.

use crate::deviation::{Deviation, sums};
use crate::difference::Difference;
use crate::evaluation::Evaluated;
use crate::setting::Setting;
use gbuffer::Hit;

/// Roundings in f64 of a position and of parameters on their way, of their sizes.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// How the drawn surfaces lie on those that they stand for.
#[derive(Debug, Clone, PartialEq)]
pub struct StandIn {
    /// The greatest distance of each surface from the one that it stands for, at equal parameters, model units.
    pub error: Vec<f64>,
    /// Of each Bézier piece of each surface, in the order of [`nurbs::Surface::bezier_patches`], the number of the piece that it
    /// lies on.
    pub pieces: Vec<Vec<usize>>,
    /// How many pieces each surface has that is stood for.
    pub counts: Vec<usize>,
    /// Of each face, its surface.
    pub surfaces: Vec<usize>,
}

impl StandIn {
    /// The greatest of the numbers of drawn pieces that lie on each piece of each face; as they are where there is none a piece.
    fn greatest(&self, drawn: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let of_face = |(face, own): (usize, &Vec<f64>)| {
            let surface = self.surfaces[face];
            if own.len() != self.pieces[surface].len() {
                return own.clone();
            }
            let mut found = vec![0.0; self.counts[surface]];
            for (piece, x) in self.pieces[surface].iter().zip(own) {
                found[*piece] = x.max(found[*piece]);
            }
            found
        };
        drawn.iter().enumerate().map(of_face).collect()
    }
}

impl Deviation {
    /// What is allowed to a picture of the drawn model against the other one: this, on the pieces of that one, and the distance.
    pub fn of_stand_in(self, stand_in: &StandIn) -> Self {
        let error: Vec<Vec<f64>> = stand_in.surfaces.iter().map(|surface| vec![stand_in.error[*surface]]).collect();
        let faces = error.len();
        let interpolated = self.interpolation.iter().map(|side| {
            let of_face =
                |face: usize| (0..stand_in.pieces[stand_in.surfaces[face]].len()).map(move |k| side.at(face, k));
            (0..faces).map(|face| of_face(face).collect()).collect::<Vec<Vec<f64>>>()
        });
        let interpolated = interpolated.map(|drawn| stand_in.greatest(&drawn)).collect::<Vec<_>>();
        let whole = |chord: &[Vec<f64>]| {
            let chord = sums(&stand_in.greatest(chord), &error);
            interpolated.iter().fold(chord, |chord, side| sums(&chord, side))
        };
        let greatest = stand_in.error.iter().copied().fold(0.0, f64::max);
        Self {
            text: format!(
                "{}; bicubic patches within {greatest:.3e} of the model's own, added to it; their normals against the model's: no bound",
                self.text
            ),
            chord: whole(&self.chord),
            edge_chord: whole(&self.edge_chord),
            interpolation: vec![],
            stand_in: error,
            ..self
        }
    }
}

impl Setting<'_> {
    /// Whether a position is as near the model's surface as one may be that stands for it: within `error` of it at a hit's own
    /// (u, v), and `radius`, by which it may be off what is drawn. A normal that stands for another has no bound.
    pub(crate) fn stood_for(&self, hit: &Hit, found: Evaluated, error: f64) -> Result<Evaluated, Difference> {
        if error == 0.0 || !found.radius.is_finite() {
            return Ok(found);
        }
        let d = self.model.surface(hit.face).first_derivatives(hit.uv.x, hit.uv.y);
        let sizes = hit.position.length() + self.size + (d.su * hit.uv.x).length() + (d.sv * hit.uv.y).length();
        let (off, allowed) = (hit.position.distance(d.s), error + found.radius + ROUNDING * sizes);
        if off > allowed {
            let detail = format!("S is {off:.3e} from the model's own at (u, v); {allowed:.3e} are allowed");
            return Err(Difference::new(self.attribution.of_position(hit, off / allowed), off / allowed, detail));
        }
        let mut shares = found.shares;
        shares.position = shares.position.map(|share| share.max(off / allowed));
        (shares.normal, shares.curvature) = (None, None);
        Ok(Evaluated { shares, ..found })
    }
}

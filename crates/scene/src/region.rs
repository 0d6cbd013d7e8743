//! The trimmed part of a face's domain, made of its loops and proven to be one.
//!
//! A [`Region`] is built with the [`Model`](crate::Model) from the loops that a file gave. Its **rule** is one: a point
//! (u, v) is material where the winding number of all its closed loops is not zero. Loops are turned so that outer
//! ones run counter-clockwise and holes clockwise, islands in holes counter-clockwise again, however deep; as they do
//! not cross, the winding number is 0 or 1 everywhere, and even-odd says the same.
//!
//! On the way: curves become Bézier segments and small gaps are healed ([`chain`]), loops that leave the domain of a
//! closed surface are repeated a period apart ([`contour`]), rings that close only around it are closed beyond the domain
//! ([`ring`]), all are searched for crossings ([`crossing`]), every loop's depth is found and its orientation made to fit
//! ([`nesting`]), and curves are cut where they turn and clamped to the domain ([`clip`]).

mod chain;
mod clip;
pub(crate) mod contour;
mod crossing;
mod frame;
mod nesting;
mod repairs;
mod ring;
mod segment;

use crate::{Face, SceneError};
use chain::Chain;
use contour::Contour;
use frame::Frame;
use nurbs::{Rectangle, Surface};

pub use clip::Piece;
pub use repairs::{Repairs, WideGap};
pub use segment::{ClosedLoop, Segment};

/// The most loops of a face: each is asked in which of the others it lies.
const MAX_LOOPS: usize = 1 << 14;

/// Share of the domain's area below which a region is rounding.
const NO_AREA: f64 = 64.0 * f64::EPSILON;

/// Relative difference of areas below which a region is its whole domain.
const WHOLE_AREA: f64 = 1e-9;

/// The trimmed part of a face's domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    domain: Rectangle,
    loops: Vec<ClosedLoop>,
    pieces: Vec<Piece>,
    area: f64,
    whole: bool,
    /// Whether the face ends at the least and at the greatest u, and at those of v: not at a seam, nor in a point.
    ends: [[bool; 2]; 2],
    repairs: Repairs,
}

impl Region {
    /// The region of `face`, number `index` of its model, on its surface; `None` where it has no loops.
    ///
    /// `extent` is the greatest distance of the model's control points from the origin, model units: gaps up to 1e-7 of
    /// it are rounding.
    ///
    /// # Errors
    /// [`SceneError::TooManyLoops`], [`SceneError::EmptyLoop`], [`SceneError::TrimCurve`], [`SceneError::TrimGap`], [`SceneError::LoopPeriod`],
    /// [`SceneError::LoopReach`], [`SceneError::OddRings`], [`SceneError::TrimsCross`], [`SceneError::LoopOverlap`],
    /// [`SceneError::TrimWork`], [`SceneError::Nesting`], [`SceneError::NoMaterial`].
    pub fn new(index: usize, face: &Face, surface: &Surface, extent: f64) -> Result<Option<Self>, SceneError> {
        if face.loops.is_empty() {
            return Ok(None);
        }
        let (loops, limit) = (face.loops.len(), MAX_LOOPS);
        if limit < loops {
            return Err(SceneError::TooManyLoops { face: index, loops, limit });
        }
        let frame = Frame::new(index, face, surface, extent);
        let mut repairs = Repairs::default();
        let mut chains = vec![];
        for (i, boundary) in face.loops.iter().enumerate() {
            match Chain::new(&frame, i, boundary, &mut repairs)? {
                Some(chain) => chains.push(chain),
                None => repairs.dropped.push(i),
            }
        }
        let (closed, rings): (Vec<Chain>, Vec<Chain>) = chains.into_iter().partition(|c| c.periods == [0, 0]);
        let mut loops = ring::close(&frame, &rings, &mut repairs)?;
        let mut contours = closed.iter().map(|chain| Contour::new(&frame, chain)).collect::<Result<Vec<_>, _>>()?;
        crossing::check(&frame, &loops, &contours, repairs.largest_gap)?;
        contours.retain(|contour| {
            let is_kept = !contour.encloses_nothing(&frame);
            if !is_kept {
                repairs.dropped.push(contour.chain.source);
            }
            is_kept
        });
        check_dropped(index, face, &repairs)?;
        nesting::place(&frame, &contours, &mut loops, &mut repairs)?;
        let pieces = clip::pieces(&frame, &loops);
        let middle = 0.5 * (frame.domain.min + frame.domain.max);
        let area: f64 = pieces.iter().map(|p| p.curve.area(middle)).sum();
        let size = frame.domain.size();
        let all = size.x * size.y;
        let whole = pieces.iter().all(|p| p.on_border) && (area - all).abs() <= WHOLE_AREA * all;
        if !whole && (pieces.iter().all(|p| p.on_border) || area <= NO_AREA * all) {
            return Err(SceneError::NoMaterial { face: index });
        }
        let ends = [0, 1].map(|axis| frame.ends(axis));
        Ok(Some(Self { domain: frame.domain, loops, pieces, area, whole, ends, repairs }))
    }

    /// The surface's domain, in its own knots' (u, v).
    pub fn domain(&self) -> Rectangle {
        self.domain
    }

    /// All closed loops, unsplit, as far out of the domain as the file draws them; where a loop crosses the seam of a
    /// closed surface, its copies a period apart too. The region is where their windings do not sum to zero.
    pub fn loops(&self) -> &[ClosedLoop] {
        &self.loops
    }

    /// The boundary inside the closed domain, cut into monotone pieces: closed chains, to the bit.
    ///
    /// What a loop does outside the domain is put on the nearest border, which changes no winding number inside. A
    /// point on the border of the domain is to be classified as its neighbour inside.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The pieces at which the face ends as it is seen: all but those along a seam, across which the surface goes on, and
    /// along a side of the domain that is a point in space.
    ///
    /// What a loop cuts off beyond a seam is not repeated on the near side of it.
    pub fn edges(&self) -> impl Iterator<Item = &Piece> {
        self.pieces.iter().filter(|piece| self.is_edge(piece))
    }

    /// Whether a piece of the region is one of its [`Self::edges`].
    pub fn is_edge(&self, piece: &Piece) -> bool {
        let [start, end] = [piece.curve.start(), piece.curve.end()];
        !piece.on_border || {
            let axis = usize::from(start.x != end.x);
            self.ends[axis][usize::from(start[axis] == self.domain.max[axis])]
        }
    }

    /// Whether the face ends, where it has material, at the side of its domain where parameter `axis` (0 = u, 1 = v) is
    /// least (0) or greatest (1): not at a seam, nor where the side is a point in space.
    pub fn ends_at(&self, axis: usize, side: usize) -> bool {
        self.ends[axis][side]
    }

    /// The area of the material inside the domain, in units of u times v, to 1e-12 of the domain's.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Whether the loops cut nothing away: they are the natural boundary.
    pub fn is_whole(&self) -> bool {
        self.whole
    }

    /// The longest gap between two trims that was closed, model units along the surface.
    pub fn largest_gap(&self) -> f64 {
        self.repairs.largest_gap
    }

    /// What was mended.
    pub fn repairs(&self) -> &Repairs {
        &self.repairs
    }

    /// The box of the pieces.
    pub fn hull(&self) -> Rectangle {
        self.pieces.iter().map(|p| p.curve.hull()).fold(Rectangle::EMPTY, Rectangle::union)
    }
}

/// Whether what is left of the loops still says where material is.
fn check_dropped(index: usize, face: &Face, repairs: &Repairs) -> Result<(), SceneError> {
    let is_left = |i: &usize| !repairs.dropped.contains(i);
    let is_outer = |i: &usize| face.loops[*i].outer;
    let all = || 0..face.loops.len();
    let lost = repairs.dropped.iter().copied().find(is_outer).filter(|_| !all().any(|i| is_left(&i) && is_outer(&i)));
    let none = repairs.dropped.first().copied().filter(|_| !all().any(|i| is_left(&i)));
    lost.or(none).map_or(Ok(()), |boundary| Err(SceneError::EmptyLoop { face: index, boundary }))
}

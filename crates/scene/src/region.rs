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
mod nesting;
mod ring;

use crate::{Face, SceneError};
use chain::Chain;
use contour::Contour;
use glam::DVec2;
use nurbs::{BezierCurve, Rectangle, Surface};

/// A gap up to this share of the model's extent is healed even where the face states a finer tolerance.
///
/// Modellers keep 1e-7 on parts of any size; files print 7 to 15 digits of numbers that grow with the distance from the
/// origin. 1e-7 is a thousandth of a pixel of a picture of 10,000 pixels a side.
const GAP_FLOOR: f64 = 1e-7;

/// What is below this share of a face's size is small, however large the tolerance: no tolerance closes a wider surface,
/// and a gap that no vertex accounts for is closed up to it.
const SMALL: f64 = 1e-3;

/// The most loops of a face: each is asked in which of the others it lies.
const MAX_LOOPS: usize = 1 << 14;

/// How often a loop may be repeated where it leaves the domain of a closed surface: a spiral of 64 turns, say.
const MAX_COPIES: usize = 64;

/// Trims within this share of the domain's length of a border of the domain lie on it.
///
/// Projected borders come out a few thousand ulp aside; 1e-10 of a domain is less than f32 parameters can hold.
const ON_BORDER: f64 = 1e-10;

/// Share of the domain's area below which a region is rounding.
const NO_AREA: f64 = 64.0 * f64::EPSILON;

/// Relative difference of areas below which a region is its whole domain.
const WHOLE_AREA: f64 = 1e-9;

/// A Bézier segment of a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// The curve, in standard form.
    pub curve: BezierCurve,
    /// Which trim of its loop it is a part of; `None` where it closes a gap or runs along the natural boundary.
    pub trim: Option<usize>,
}

impl Segment {
    fn line(start: DVec2, end: DVec2) -> Self {
        Self { curve: BezierCurve::line(start, end), trim: None }
    }

    fn translated(&self, offset: DVec2) -> Self {
        Self { curve: self.curve.translated(offset), ..*self }
    }

    fn reversed(&self) -> Self {
        Self { curve: self.curve.reversed(), ..*self }
    }
}

/// A closed loop of Bézier segments; the end of each is to the bit the start of the next.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedLoop {
    /// The segments, in the loop's (normalised) direction.
    pub segments: Vec<Segment>,
    /// How many loops it lies in: even for an outer boundary, odd for a hole.
    pub depth: usize,
    /// Which of the face's loops it was made of; `None` for the natural boundary, added where no loop bounds the face.
    pub source: Option<usize>,
}

/// A part of the region's boundary on which u and v are both monotone.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// The curve, in standard form, inside the domain; material is on its left.
    pub curve: BezierCurve,
    /// Whether it runs along a border of the domain, so that the domain's own limit does its work.
    pub on_border: bool,
    /// Which loop of [`Region::loops`] it is a part of.
    pub loop_index: usize,
    /// Which trim of that loop's source it is a part of; `None` as in [`Segment::trim`].
    pub trim: Option<usize>,
}

impl Piece {
    /// What a crossing adds to the winding number of a point on the piece's left side in u: 1 where v rises, −1 where
    /// it falls, 0 where it is constant.
    pub fn winding(&self) -> i32 {
        let (start, end) = (self.curve.start().y, self.curve.end().y);
        i32::from(start < end) - i32::from(end < start)
    }
}

/// What was mended when a region was built.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Repairs {
    /// The longest gap between two trims that was closed, model units along the surface.
    pub largest_gap: f64,
    /// Loops that ran the wrong way round.
    pub reoriented: Vec<usize>,
    /// Loops whose `outer` flag is wrong.
    pub mislabelled: Vec<usize>,
    /// Loops that leave the domain of a closed surface across its seam, or go around it.
    pub across_seam: Vec<usize>,
    /// Loops that enclose nothing, and were left out.
    pub dropped: Vec<usize>,
    /// Gaps that were closed though they are wider than the tolerances of the file.
    pub wide_gaps: Vec<WideGap>,
}

/// A gap between two trims that is wider than the file's tolerances, and was closed.
///
/// That happens where the file gives the face a tolerance and its vertices none: files keep the finest of a modeller's
/// tolerances, and its vertices' are coarser.
#[derive(Debug, Clone, PartialEq)]
pub struct WideGap {
    /// Index of the loop in the face.
    pub boundary: usize,
    /// Index of the trim after the gap.
    pub trim: usize,
    /// Length of the gap along the surface, model units.
    pub gap: f64,
    /// The tolerance that the file states, model units.
    pub tolerance: f64,
}

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

/// What all steps need to know of the face: its number, surface and tolerances.
struct Frame<'a> {
    face: usize,
    surface: &'a Surface,
    domain: Rectangle,
    /// The greatest gap that is healed without a word, model units.
    tolerance: f64,
    /// Whether a joint whose vertex has no tolerance may be wider than that.
    is_lenient: bool,
    /// [`ON_BORDER`] in parameters.
    on_border: DVec2,
    /// Whether the surface's two borders across u, and those across v, are one curve in space.
    closed: [bool; 2],
}

impl<'a> Frame<'a> {
    /// `extent` is the greatest distance of the model's control points from the origin.
    fn new(face: usize, source: &Face, surface: &'a Surface, extent: f64) -> Self {
        let [[u0, u1], [v0, v1]] = surface.domain();
        let domain = Rectangle { min: DVec2::new(u0, v0), max: DVec2::new(u1, v1) };
        let diagonal = surface.hull().diagonal();
        // A face far from the origin, or small in its model, keeps its features.
        let usual = (GAP_FLOOR * extent).min(SMALL * diagonal).max(GAP_FLOOR * diagonal);
        let tolerance = source.tolerance.max(usual);
        let is_lenient = 0.0 < source.tolerance;
        let on_border = ON_BORDER * domain.size();
        let mut frame = Self { face, surface, domain, tolerance, is_lenient, on_border, closed: [false; 2] };
        frame.closed = [0, 1].map(|axis| frame.is_closed_across(axis));
        frame
    }

    /// Whether the surface's two borders across `axis` (0 = u, 1 = v) are one curve in space: to the tolerance, and to
    /// a [`SMALL`] share of the way from the one to the other, however large that tolerance.
    fn is_closed_across(&self, axis: usize) -> bool {
        const SAMPLES: usize = 16;
        (0..=SAMPLES).all(|i| {
            let (mut low, mut high) = (self.domain.min, self.domain.max);
            let t = low[1 - axis] + (high[1 - axis] - low[1 - axis]) * i as f64 / SAMPLES as f64;
            (low[1 - axis], high[1 - axis]) = (t, t);
            let gap = self.surface.point(low.x, low.y).distance(self.surface.point(high.x, high.y));
            gap <= self.tolerance && gap <= SMALL * self.distance(low, high)
        })
    }

    /// Whether the surface has no border across `axis`: it is closed, or both its sides are points.
    fn is_unbounded(&self, axis: usize) -> bool {
        self.ends(axis) == [false; 2]
    }

    /// Whether the surface ends at its two sides across `axis`: it is not closed, and they are no points.
    fn ends(&self, axis: usize) -> [bool; 2] {
        let Rectangle { min, max } = self.domain;
        let most = self.tolerance.min(SMALL * self.surface.hull().diagonal());
        let is_point = |at: f64| {
            let (mut a, mut b) = (min, max);
            (a[axis], b[axis]) = (at, at);
            self.distance(a, b) <= most
        };
        [min, max].map(|side| !self.closed[axis] && !is_point(side[axis]))
    }

    /// The length in space of the straight segment from `a` to `b` in parameters, by chords.
    fn distance(&self, a: DVec2, b: DVec2) -> f64 {
        const CHORDS: usize = 8;
        let point = |i: usize| {
            let uv = self.wrapped(a + (b - a) * (i as f64 / CHORDS as f64));
            self.surface.point(uv.x, uv.y)
        };
        (0..CHORDS).map(|i| point(i).distance(point(i + 1))).sum()
    }

    /// The point moved by whole periods into the domain, in the directions in which the surface is closed.
    fn wrapped(&self, mut uv: DVec2) -> DVec2 {
        let Rectangle { min, max } = self.domain;
        for axis in [0, 1] {
            if self.closed[axis] && !(min[axis] <= uv[axis] && uv[axis] <= max[axis]) {
                uv[axis] = min[axis] + (uv[axis] - min[axis]).rem_euclid(max[axis] - min[axis]);
            }
        }
        uv
    }

    /// The natural boundary, counter-clockwise.
    fn boundary(&self) -> Vec<Segment> {
        let Rectangle { min, max } = self.domain;
        let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        (0..4).map(|i| Segment::line(corners[i], corners[(i + 1) % 4])).collect()
    }
}

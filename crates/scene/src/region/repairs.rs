//! What was mended of a face's loops: the steps note it, and a region tells it.

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

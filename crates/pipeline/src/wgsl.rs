//! The twin in WGSL, as text.
//!
//! WGSL needs no order of declaration, so a program is its parts put together behind a short prelude that fixes
//! what a Rust generic would: capacity, degree, and which outputs are wanted.

use crate::Technique;
use crate::packed::{Program, TrimMethod};
use nurbs::MAX_ORDER;

/// Records and bindings.
pub const LAYOUT: &str = include_str!("../../../shaders/layout.wgsl");
/// Span, basis, surface.
pub const EVAL: &str = include_str!("../../../shaders/eval.wgsl");
/// A pixel's ray and its footprint.
pub const SIGHT: &str = include_str!("../../../shaders/sight.wgsl");
/// Trimming.
pub const TRIM: &str = include_str!("../../../shaders/trim.wgsl");
/// Trimming by masks, which stands in [`TRIM`]'s place.
pub const MASK: &str = include_str!("../../../shaders/mask.wgsl");
/// Which trim edge passes by; [`NO_EDGE`] stands in its place where none is looked for.
pub const EDGE: &str = include_str!("../../../shaders/edge.wgsl");
/// What a program has in place of [`EDGE`].
pub const NO_EDGE: &str = "fn edge(face: u32, uv: vec2<f32>, at: vec2<f32>) -> u32 { return 0u; }\n";
/// What draws masks; a program of its own.
pub const ENTRY_MASK: &str = include_str!("../../../shaders/entry_mask.wgsl");
/// The fragment program.
pub const FRAGMENT: &str = include_str!("../../../shaders/fragment.wgsl");
/// The shading code, twin of `gbuffer::shade`.
pub const SHADE: &str = include_str!("../../../shaders/shade.wgsl");
/// What is made of the fragment program's answer.
pub const OUTPUT: &str = include_str!("../../../shaders/output.wgsl");
/// Entry points of technique `fragment`.
pub const ENTRY: &str = include_str!("../../../shaders/entry.wgsl");
/// Ray ∩ piece, for technique `exact`.
pub const NEWTON: &str = include_str!("../../../shaders/newton.wgsl");
/// [`crate::newton`]'s fold.
pub const FOLD: &str = include_str!("../../../shaders/fold.wgsl");
/// Entry points of technique `exact`.
pub const ENTRY_EXACT: &str = include_str!("../../../shaders/entry_exact.wgsl");

/// A file of `shaders/` that is part of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// The technique whose programs alone have it, or all of them.
    pub of: Option<Technique>,
    /// Its name.
    pub file: &'static str,
    /// Its text, which stands in a program as it is.
    pub text: &'static str,
}

/// All parts of a program, in the order in which they are put together; [`MASK`] may stand in [`TRIM`]'s place, and
/// [`NO_EDGE`] in [`EDGE`]'s.
pub const PARTS: &[Part] = &[
    Part { of: None, file: "layout.wgsl", text: LAYOUT },
    Part { of: None, file: "eval.wgsl", text: EVAL },
    Part { of: None, file: "sight.wgsl", text: SIGHT },
    Part { of: None, file: "trim.wgsl", text: TRIM },
    Part { of: None, file: "fragment.wgsl", text: FRAGMENT },
    Part { of: None, file: "shade.wgsl", text: SHADE },
    Part { of: None, file: "output.wgsl", text: OUTPUT },
    Part { of: Some(Technique::Fragment), file: "entry.wgsl", text: ENTRY },
    Part { of: Some(Technique::Exact), file: "newton.wgsl", text: NEWTON },
    Part { of: Some(Technique::Exact), file: "fold.wgsl", text: FOLD },
    Part { of: Some(Technique::Exact), file: "entry_exact.wgsl", text: ENTRY_EXACT },
    Part { of: None, file: "edge.wgsl", text: EDGE },
];

/// What a program is compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Variant {
    /// Which technique.
    pub technique: Technique,
    /// Which degrees.
    pub program: Program,
    /// Whether second derivatives and curvatures are computed.
    pub curvature: bool,
    /// Whether shading uses the normal interpolated from the vertices instead of the fragment's own; technique
    /// `exact` has none to interpolate.
    pub interpolated_normal: bool,
    /// What is done about trims.
    pub trims: TrimMethod,
}

/// The source of a variant. Entry points of technique `fragment`: `vertex`, `fragment_gbuffer`, `fragment_shaded`; the
/// kernels of technique `exact`: `bound_hulls`, `meet_small`, `meet_large`, `choose`, `resolve_gbuffer`,
/// `resolve_shaded`.
pub fn source(variant: Variant) -> String {
    let parts = PARTS.iter().filter(|part| part.of.is_none_or(|technique| technique == variant.technique));
    let text = |part: &Part| match (part.text, variant.trims) {
        (TRIM, TrimMethod::Masks) => MASK,
        (EDGE, TrimMethod::Whole | TrimMethod::Curves | TrimMethod::Masks) => NO_EDGE,
        (text, _) => text,
    };
    parts.fold(prelude(variant), |source, part| source + text(part))
}

fn prelude(variant: Variant) -> String {
    let (capacity, degree) = match variant.program {
        Program::General => (MAX_ORDER as u32, "stored".to_owned()),
        Program::Degree(p) => (p + 1, format!("{p}u")),
    };
    let Variant { curvature, interpolated_normal, trims, .. } = variant;
    let trimmed = trims != TrimMethod::Whole;
    format!(
        "const CAPACITY: u32 = {capacity}u;\n\
         const CURVATURE: bool = {curvature};\n\
         const INTERPOLATED_NORMAL: bool = {interpolated_normal};\n\
         const TRIMMED: bool = {trimmed};\n\
         fn degree(stored: u32) -> u32 {{ return {degree}; }}\n"
    )
}
